#!/usr/bin/env bash
# The interpreter beside LinuxCNC's (rs274 of the Debian package linuxcnc-uspace): whole processes that
# write canonical text to /dev/null, the same programs, the same core, in turn; medians of the
# processor time.
#
#   tests/bench/peer_interpreter.sh BIN_FOLDER [RUNS [CORE]]     for example build/release/bin 5
set -euo pipefail

bin=${1:?"usage: peer_interpreter.sh BIN_FOLDER [RUNS [CORE]]"}
runs=${2:-5}
core=${3:-0}
if ! command -v rs274 >/dev/null; then
  echo "rs274 is not installed (Debian package linuxcnc-uspace): nothing to compare with."
  exit 0
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$bin/interpreter_bench" write "$folder"
echo "T1 P1 Z0 D0" >"$folder/tool.tbl"
: >"$folder/parameters.var"

# seconds COMMAND...: user and system time; what the command prints is shown if it fails.
seconds() {
  local TIMEFORMAT='%U %S'
  { time taskset -c "$core" "$@" >"$folder/out" 2>&1 || { cat "$folder/out" >&3; exit 1; }; } \
    3>&2 2>&1 | awk '{ print $1 + $2 }'
}
# rs274 keeps its tool table in $HOME.
peer() { seconds env HOME="$folder" rs274 -g -t "$folder/tool.tbl" -v "$folder/parameters.var" "$1" /dev/null; }
ours() { seconds "$bin/cncsim" check "$1" --canon /dev/null; }
median() { sort -n | awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }

# compare NAME COUNT PEERS_PROGRAM OUR_PROGRAM GOAL
compare() {
  : >"$folder/peer"
  : >"$folder/ours"
  for ((i = 0; i < runs; ++i)); do
    peer "$folder/$3" >>"$folder/peer"
    ours "$folder/$4" >>"$folder/ours"
  done
  awk -v name="$1" -v count="$2" -v goal="$5" \
    -v peer="$(median <"$folder/peer")" -v ours="$(median <"$folder/ours")" \
    'BEGIN { printf "%-6s %10.3f %10.0f %10.3f %10.0f %8.1f %6d\n", name, peer, count / peer / 1000,
             ours, count / ours / 1000, peer / ours, goal }'
}

printf '%-6s %10s %10s %10s %10s %8s %6s\n' '' 'rs274 s' 'k/s' 'cncsim s' 'k/s' ratio goal
compare lines 1000000 lines.ngc lines.ngc 10
compare arcs 200000 arcs.ngc arcs.ngc 10
compare loop 1000000 loop_for_linuxcnc.ngc loop.ngc 25
