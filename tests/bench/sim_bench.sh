#!/usr/bin/env bash
# How many times faster than the machine cncsim runs a program.
#
#   tests/bench/sim_bench.sh build/release/bin/cncsim [PROGRAM...]
#
# Without programs: the shipped examples, and what of the corpus lies beside the checkout.
set -euo pipefail

cncsim=${1:?"usage: sim_bench.sh CNCSIM [PROGRAM...]"}
shift
here=$(cd "$(dirname "$0")/../.." && pwd)
if [ $# -eq 0 ]; then
  set -- "$here"/config/examples/*.ngc
  for name in linuxcnc--wheels.ngc linuxcnc--Pasta.ngc nraynaud--tux.ngc bdring--arcs_arrows.nc \
    nist--c1_hello_world.ngc CauldronDevelopmentLLC--tiger.nc; do
    if [ -e "$here/../shared/corpus/gcode/$name" ]; then
      set -- "$@" "$here/../shared/corpus/gcode/$name"
    fi
  done
fi

wide=()
for axis in X Y Z; do
  wide+=(--set "AXIS_$axis.negativeLimit=-5000" --set "AXIS_$axis.positiveLimit=5000")
done

printf '%-40s %12s %10s %8s\n' program 'job time s' 'wall s' factor
for program in "$@"; do
  begin=$(date +%s%N)
  report=$("$cncsim" run "$program" --json "${wide[@]}")
  end=$(date +%s%N)
  job=$(sed -n 's/.*"job_time": *\([0-9.e+-]*\).*/\1/p' <<<"$report")
  awk -v name="$(basename "$program")" -v job="$job" -v wall="$(((end - begin) / 1000))" \
    'BEGIN { wall /= 1e6; printf "%-40s %12.1f %10.3f %8.0f\n", name, job, wall, job / wall }'
done
