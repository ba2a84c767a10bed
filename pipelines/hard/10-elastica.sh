#!/bin/bash
# Row 10: a cantilever of 1 m under a dead load P at its end, bent far; the elastica for P L^2 / EI = 1, 2, 10.
#
# Poisson's ratio 0, so that plane strain does not stiffen it; thin, since the elastica neither shears nor strains. A rod that
# does both (Reissner 1972; its differential equations solved to 1e-9) has w/L of
#   .302163, .494198, .813279 at a thickness of L / 20, .301831, .493642, .811276 at L / 40, for P L^2 / EI = 1, 2, 10,
# that is .33 and .08 % more than the elastica at the largest load. Three points per cell in the
# first rows; the last ones have smoothed cells, two and four across the thickness.
. "$(dirname "$0")/common.sh"

# elastica LOAD THICKNESS NODES_ALONG NODES_ACROSS ARGUMENTS_OF_IPOINTS: leaves the result in a.dat
elastica() {
    # shellcheck disable=SC2086
    cloud -d 2 -k regular -n "$3,$4" --box "0,1,0,$2" | ipoints $5 | shapefn -o "$work/table.mts" 2> /dev/null
    dim=2 nu=0 scene "$work/a.scene" <<END
[displacement clamp]
facets = xmin
components = 0, 0
[traction end]
facets = xmax
components = 0, $(calc "-$1 * 3000 * $2 ^ 2 / 12")
[solver]
tolerance = 1e-4
END
    relax "$work/a.scene" "$work/table.mts" "$work/a.dat"
}

# end COLUMN: mean displacement of the end, downwards and inwards positive.
end() {
    calc "-($(mean_at "$work/a.dat" '$1 > 1 - 1e-9' "\$$1"))"
}

for case in '1 0.301721 0.056433' '2 0.493457 0.160642' '10 0.810609 0.554996'; do
    read -r load down inward <<< "$case"
    elastica "$load" 0.025 81 5 '-g 3'
    row 10 "elastica, PL2/EI = $load: deflection w/L (405 nodes)" "$(end 4)" "$down" elastica
    row 10 "elastica, PL2/EI = $load: shortening u/L (405 nodes)" "$(end 3)" "$inward" elastica
done

for nodes in '41 3' '81 5'; do
    # shellcheck disable=SC2086
    elastica 1 0.05 $nodes -c
    row 10 "elastica, smoothed cells, nodes along and across $nodes: deflection w/L" "$(end 4)" 0.302163 elastica
done
