#!/bin/bash
# case.sh CASES TEMPLATE STREAM FOLDER CASE: one case of a sweep (see sweep.sh), by its name or as row=N, N from 1. Leaves in FOLDER
# CASE.scene, CASE.log, and CASE.dat, which is there when it is whole; or CASE.failed, with the status and the last message of mtled.
# Done already: nothing happens. Killed: the same command goes on from CASE.ckpt, to the same bytes. Two at once: one waits for the other.
set -eu -o pipefail
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
[ $# -eq 5 ] || { echo "usage: case.sh CASES TEMPLATE STREAM FOLDER CASE" >&2; exit 2; }
cases=$1 template=$2 stream=$3 folder=$4 name=$5
scripts=$(dirname "$0")

mkdir -p "$folder"
case $name in
row=*)
    name=$(awk -f "$scripts/scene.awk" -v list=1 -v stream="$stream" "$cases" "$template" | sed -n "${name#row=}p")
    [ -n "$name" ] || { echo "sweep: $cases: no $5" >&2; exit 2; }
    ;;
esac
at=$folder/$name
# The programs that are started inherit the lock: it lasts as long as the last of them.
exec 9> "$at.lock"
flock 9

awk -f "$scripts/scene.awk" -v wanted="$name" -v stream="$stream" \
    -v folder="$(realpath --relative-to "$folder" "$(dirname "$template")")" "$cases" "$template" > "$at.scene.new"
stream=$(sed -n '1s/^# stream //p' "$at.scene.new")
if cmp -s "$at.scene.new" "$at.scene"; then
    rm "$at.scene.new"
else
    rm -f "$at.dat" "$at.ckpt"
    mv "$at.scene.new" "$at.scene"
fi
if [ -e "$at.dat" ] && [ ! "$stream" -nt "$at.dat" ] && [ ! "$(command -v mtled)" -nt "$at.dat" ]; then
    exit 0
fi

# What a killed mtled may have left.
rm -f "$at.failed" "$folder/.$name.dat."??????
status=0
mtled -q -c "$at.ckpt" -o "$at.dat" "$at.scene" "$stream" 2> "$at.log" || status=$?
# A checkpoint of another cloud or version: from the beginning.
if [ $status -eq 2 ] && [ -e "$at.ckpt" ]; then
    rm -f "$at.ckpt"
    status=0
    mtled -q -c "$at.ckpt" -o "$at.dat" "$at.scene" "$stream" 2> "$at.log" || status=$?
fi
[ $status -ne 0 ] || exit 0
rm -f "$at.dat"
# Ended by a signal: neither done nor failed.
[ $status -le 128 ] || exit $status
printf '%s\t%s\n' $status "$(grep . "$at.log" | tail -n 1 | tr '\t' ' ')" > "$at.failed.new"
mv "$at.failed.new" "$at.failed"
echo "sweep: $name: $(tail -n 1 "$at.log")" >&2
exit $status
