#!/bin/bash
# fuzz.sh PROGRAMS OUT SECONDS TARGET...: fuzz each target for so long, one after the other; see fuzz.mk.
set -u -o pipefail
programs=$1 out=$2 seconds=$3
shift 3
mkdir -p "$out"
[ -f "$out/runs.tsv" ] || : > "$out/runs.tsv"
broken=0
export ASAN_OPTIONS=quarantine_size_mb=16 OMP_NUM_THREADS=1
TIMEFORMAT='%U %S'

for target in "$@"; do
    mkdir -p "$out/$target"
    log=$out/$target.log
    # The words that a reader knows are those of its source.
    case $target in table) readers=files ;; msh | inp | feb | vtk) readers=mesh ;; *) readers=$target ;; esac
    grep -hv '^#include' lib/io/$readers/*.c | grep -oE '"[]A-Za-z0-9_.:*$#=<>[ -]{1,32}"' | sort -u > "$out/$target.dict"
    # The longest input is many times the longest of the corpus; what takes 10 s or 256 MB for it is at fault.
    { time "$programs/$target" -max_total_time="$seconds" -max_len=8192 -timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=256 \
        -print_final_stats=1 -dict="$out/$target.dict" -artifact_prefix="$out/$target-" \
        "$out/$target" "tests/fuzz/corpus/$target" > "$log" 2>&1; } 2> "$out/time" || broken=1
    awk -v target="$target" -v seconds="$(awk '{ print $1 + $2 }' "$out/time")" '
        / inline 8-bit counters/ { for (i = 1; i < NF; i++) if ($i == "modules" || $i == "module") { all = $(i + 1); sub(/[^0-9]*/, "", all) } }
        / cov: / { for (i = 1; i < NF; i++) if ($i == "cov:") edges = $(i + 1) }
        /stat::number_of_executed_units/ { runs = $2 }
        /stat::peak_rss_mb/ { peak = $2 }
        / ERROR: | runtime error: |not so: / { found++ }
        END { printf "%s\t%d\t%.0f\t%d\t%d\t%d\t%d\n", target, seconds, runs, edges, all, peak, found }
    ' "$log" >> "$out/runs.tsv"
done

# All runs of a target together.
awk -F '\t' -v OFS='\t' '
    BEGIN { print "target", "cpu_seconds", "executions", "edges", "edges_linked", "peak_MB", "findings" }
    !($1 in runs) { name[++count] = $1 }
    { time[$1] += $2; runs[$1] += $3; if ($4 > edges[$1]) edges[$1] = $4; all[$1] = $5; if ($6 > peak[$1]) peak[$1] = $6; found[$1] = $7 }
    END { for (i = 1; i <= count; i++) { t = name[i]; printf "%s\t%d\t%.0f\t%d\t%d\t%d\t%d\n", t, time[t], runs[t], edges[t], all[t], peak[t], found[t] } }
' "$out/runs.tsv" | tee "$out/fuzz.tsv"
ls "$out"/*-crash-* "$out"/*-leak-* "$out"/*-timeout-* "$out"/*-oom-* 2> /dev/null && broken=1
exit "$broken"
