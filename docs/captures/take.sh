#!/bin/sh
# Takes the captures in this directory and docs/images again, from a real run in a real terminal. Needs tmux.
#   docs/captures/take.sh [SCENARIO] [TEXT TO WAIT FOR]
set -eu
scenario=${1:-factory/broken_carrier}
awaited=${2:-explains it by}
here=$(cd "$(dirname "$0")" && pwd)
root=$(dirname "$(dirname "$here")")
python=$root/.venv/bin/python
screen="tmux -L muster-captures-$$"
record=$(mktemp -d)
trap '$screen kill-server 2>/dev/null || true; rm -rf "$record"' EXIT

shot() { # WIDTH HEIGHT
  $screen resize-window -t shot -x "$1" -y "$2"
  sleep 0.7
  $screen capture-pane -p -t shot >"$here/dashboard-$1x$2.txt"
  $screen capture-pane -e -p -t shot | "$python" -c '
import sys
from rich.console import Console
from rich.text import Text
width, file = int(sys.argv[1]), sys.argv[2]
console = Console(width=width, record=True, file=open("/dev/null", "w"))
console.print(Text.from_ansi(sys.stdin.read()), no_wrap=True)
console.save_svg(file, title="muster")
' "$1" "$root/docs/images/dashboard-$1x$2.svg"
}

mkdir -p "$root/docs/images"
$screen -f /dev/null new-session -d -s shot -x 80 -y 24 \
  "cd '$root' && LANG=C.UTF-8 '$python' -m ops.cli run $scenario --clock realtime:1 --record '$record'; sleep 5"
until $screen capture-pane -p -t shot | grep -q "$awaited"; do
  sleep 0.2
done
shot 80 24
shot 160 50
