#!/usr/bin/env bash
# The real cncgui on a real (virtual) display against a real server: it connects, a click on Reset
# switches the machine's drives on, the window shows something, it ends when told to, and one that is
# started while a program asks shows the question and answers it by a click on OK.
#
#   display_test.sh BIN_FOLDER OUTPUT_FOLDER
set -euo pipefail

if [ -z "${UNDER_XVFB:-}" ]; then
  export UNDER_XVFB=1
  exec xvfb-run -a -s "-screen 0 1024x768x24" "$0" "$@"
fi

bin=$1
out=$2
work=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$work"' EXIT
export CNC_SERVER="unix://$work/server.sock"
export XDG_RUNTIME_DIR=$work

fail() {
  echo "FAILED: $1" >&2
  cat "$work"/*.log >&2
  exit 1
}
# until_true SECONDS COMMAND...
until_true() {
  local tries=$((10 * $1))
  shift
  for _ in $(seq "$tries"); do
    "$@" >/dev/null 2>&1 && return 0
    sleep 0.1
  done
  return 1
}
# grep reads to the end: with -q it would break the pipe of a cncctl that still writes.
state_is() { "$bin/cncctl" status | grep "^state *$1" >/dev/null; }

"$bin/cncserver" --data "$work/data" --socket "$work/server.sock" --listen 127.0.0.1:0 \
  --set AXIS_X.positiveLimit=80 --set AXIS_Y.positiveLimit=80 --set AXIS_Z.negativeLimit=-20 \
  >"$work/server.log" 2>&1 &
until_true 10 state_is needs_reset || fail "the server did not start"

"$bin/cncgui" >"$work/gui.log" 2>&1 &
gui=$!
until_true 15 xdotool search --onlyvisible --name . || fail "no window came up"
# The button is enabled once the window has connected: click until it acts.
click_reset() {
  xdotool mousemove 130 727 click 1
  sleep 0.3
  state_is needs_homing
}
until_true 15 click_reset || fail "a click on Reset did not reset the machine"

xwd -root -silent -out "$out/cncgui.xwd"
colours=$(tail -c +4096 "$out/cncgui.xwd" | od -An -v -tx4 -w4 | sort -u | wc -l)
[ "$colours" -gt 50 ] || fail "the screen shows only $colours colours"

kill -TERM "$gui"
until_true 5 sh -c "! kill -0 $gui" || fail "cncgui did not end on SIGTERM"

"$bin/cncctl" home || fail "the machine did not home"
printf 'dlgmsg "Go on?"\nmsg "answered by "#5398\nM30\n' >"$work/job.nc"
"$bin/cncctl" load "$work/job.nc" && "$bin/cncctl" run || fail "the job did not start"
until_true 10 state_is question || fail "the job did not ask"
"$bin/cncgui" >"$work/gui.log" 2>&1 &
# The key is there once the window has connected and the dialog lies over the program list.
click_ok() {
  xdotool mousemove 146 190 click 1
  sleep 0.3
  state_is ready
}
until_true 15 click_ok || fail "a click on OK did not answer the question"
"$bin/cncctl" messages | grep "answered by 1" >/dev/null || fail "the program did not see OK"
echo "connected, reset by a click, $colours colours, question answered by a click"
