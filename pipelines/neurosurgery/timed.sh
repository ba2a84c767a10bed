#!/bin/bash
# Wall seconds of a command into a file: bash timed.sh FILE COMMAND...
set -eu -o pipefail
file=$1
shift
TIMEFORMAT=%1R
{ time bash -eu -o pipefail -c "$*" 2>&3; } 3>&2 2> "$file"
