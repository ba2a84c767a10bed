# The example of a scene of one's own: a block with a lump, from the geometry to a result that can be judged.

load common.bash

setup() {
    enter_loosely
    block=$BATS_TEST_DIRNAME/../examples/block
    gmsh -2 -v 2 "$block/block.geo" -o block.msh
    nodes -u mm block.msh | shapefn > table.mts 2> note
}

@test "block: plates are where they should be, forces balance, the lump carries more" {
    mtled "$block/block.scene" table.mts > u.dat
    mts check u.dat
    # Both plates stick: their facets' averages are exact, the nodes follow closely.
    paste <(mts print nodes.x u.dat) <(mts print u u.dat) | awk '
        function size(a) { return a < 0 ? -a : a }
        $2 == 0 { n++; if (!(size($3) < 2e-4 && size($4) < 2e-4)) bad++ }
        $2 == 0.04 { n++; if (!(size($3) < 2e-4 && size($4 + 0.004) < 2e-4)) bad++ }
        END { if (n != 62 || bad) { print n, "nodes on plates,", bad + 0, "astray"; exit 1 } }'
    # What pushes at the top pushes at the bottom. Between smooth plates and without the lump, incompressible tissue would
    # take E/3 (1/.9^3 - .9) x 60 mm = 28.3 N/m in plane strain; sticking and the lump stiffen it.
    mts print reactions u.dat | awk '
        { x += $1; y += $2; push = $2 < 0 ? -$2 : $2 }
        END { if (!(x * x + y * y < (1e-4 * push) ^ 2) || !(push > 28.3 && push < 100)) { print x, y, push; exit 1 } }'
    # The lump's mean vertical stress is the larger.
    paste <(mts print cells.region u.dat) <(mts print stress u.dat) | awk '
        { n[$1]++; s[$1] += $3 }
        END { if (!(s[0] / n[0] < 1.3 * s[1] / n[1] && s[1] < 0)) { print s[0] / n[0], s[1] / n[1]; exit 1 } }'
}

@test "block: where supports stop at the lump, the stress in it is even, to its rim" {
    # The root mean square of the difference of the vertical stress between cells of the lump that share an edge, by its mean.
    roughness() {
        paste <(mts print cells.region "$1") <(mts print cells "$1") <(mts print stress "$1") | awk '
            $1 == 0 {
                n++; sum += $6
                for (k = 2; k <= 4; k++) {
                    a = $k; b = k < 4 ? $(k + 1) : $2
                    edge = a < b ? a " " b : b " " a
                    if (edge in other) { squares += ($6 - other[edge]) ^ 2; pairs++ } else other[edge] = $6
                }
            }
            END { print sqrt(squares / pairs) / (-sum / n) }'
    }
    nodes -u mm block.msh | ipoints | support -i none | shapefn | mtled -q "$block/block.scene" > across.dat 2> note
    mtled -q "$block/block.scene" table.mts > stops.dat
    across=$(roughness across.dat)
    stops=$(roughness stops.dat)
    echo "$across $stops"
    awk -v across="$across" -v stops="$stops" 'BEGIN { exit !(stops > 0 && stops < across / 3) }'
}
