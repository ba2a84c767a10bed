#!/bin/bash
# Row 7: a column of .1 m between smooth walls, under gravity; top displacement and order of convergence.
. "$(dirname "$0")/common.sh"

reference=-0.954976e-3
values=()
for n in 5 9 17; do
    cloud -d 2 -k jittered -n $(((n + 1) / 2)),$n --jitter 0.3 --seed 2 --box 0,0.05,0,0.1 | shapefn -o "$work/table.mts" 2> /dev/null
    dim=2 head='gravity = 0, -9.81' scene "$work/a.scene" <<END
[displacement walls]
facets = xmin, xmax, ymin
normal = 0
[solver]
tolerance = 1e-9
END
    relax "$work/a.scene" "$work/table.mts" "$work/a.dat"
    values+=("$(mean_at "$work/a.dat" '$2 > 0.1 - 1e-9' '$4')")
done
row 7 'column under gravity: u at the top, m (153 nodes)' "${values[2]}" $reference column
at_least 7 'column under gravity: order of convergence' "$(order_of "${values[1]}" "${values[2]}" $reference 2)" order
