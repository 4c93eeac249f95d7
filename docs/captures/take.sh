#!/bin/sh
# Takes the captures in this directory and docs/images again, from real runs in a real terminal. Needs tmux.
#   docs/captures/take.sh                                    all of them
#   docs/captures/take.sh live SCENARIO NAME TEXT ...        of one run: each NAME when its TEXT is on the screen
#   docs/captures/take.sh recorded SCENARIO NAME TEXT ...    of a recording of it, made in fast mode
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(dirname "$(dirname "$here")")
python=$root/.venv/bin/python
screen="tmux -L muster-captures-$$"
record=$(mktemp -d)
trap '$screen kill-server 2>/dev/null || true; rm -rf "$record"' EXIT
trap 'exit 1' INT TERM

shot() { # NAME WIDTH HEIGHT
  $screen resize-window -t shot -x "$2" -y "$3"
  sleep 0.7
  $screen capture-pane -p -t shot >"$here/$1-$2x$3.txt"
  case $1 in dashboard | *-carrying) ;; *) return ;; esac # the others are text alone
  $screen capture-pane -e -p -t shot | "$python" -c '
import sys
from rich.console import Console
from rich.text import Text
width, file = int(sys.argv[1]), sys.argv[2]
console = Console(width=width, record=True, file=open("/dev/null", "w"))
console.print(Text.from_ansi(sys.stdin.read()), no_wrap=True)
console.save_svg(file, title="muster")
' "$2" "$root/docs/images/$1-$2x$3.svg"
}

take() { # COMMAND NAME TEXT ...
  $screen -f /dev/null new-session -d -s shot -x 80 -y 24 "cd '$root' && LANG=C.UTF-8 '$python' -m ops.cli $1"
  shift
  while [ $# -gt 0 ]; do
    until $screen capture-pane -p -t shot | grep -q -- "$2"; do
      sleep 0.1
      $screen has-session -t shot 2>/dev/null || { echo "it is over, and there was no: $2" >&2; exit 1; }
    done
    $screen send-keys -t shot Space # a replay stands still, a run does not
    shot "$1" 80 24
    shot "$1" 160 50
    $screen send-keys -t shot Space
    shift 2
  done
  $screen send-keys -t shot q
  while $screen has-session -t shot 2>/dev/null; do
    sleep 0.2
  done
}

live() { # SCENARIO NAME TEXT ...
  scenario=$1
  shift
  take "run $scenario --clock realtime:1 --record '$record/$1'" "$@"
}

recorded() { # SCENARIO NAME TEXT ...
  "$python" -m ops.cli run "$1" --headless --record "$record/$2" >"$record/log"
  shift
  take "replay '$record/$1' --speed 2" "$@"
}

mkdir -p "$root/docs/images"
if [ $# -gt 0 ]; then
  "$@"
else
  live factory/broken_carrier thinking "gap [1-9]" dashboard "explains it by"
  recorded housekeeping/three_rooms three_rooms-hallway "r1 of bedroom under way" three_rooms-carrying "»r1=pan"
  recorded housekeeping/heavy_pillow heavy_pillow-offer "offers to help" heavy_pillow-helped "»r1=" \
    heavy_pillow-back "»r2="
fi
