# The whole brain, coarsely: examples/brain3d through gmsh and all the filters.

bats_require_minimum_version 1.5.0

setup_file() {
    export EXAMPLE="$BATS_TEST_DIRNAME/../examples/brain3d"
    cd "$BATS_FILE_TMPDIR" || return
    cp "$EXAMPLE"/*.geo "$EXAMPLE"/*.tsv "$EXAMPLE"/*.scene .
    for surfaces in brain3d_surfaces brain3d_skull_surfaces; do
        gzip -dc "$EXAMPLE/$surfaces.msh.gz" > $surfaces.msh
    done
    gmsh -3 -v 1 brain3d.geo -setnumber lc 30 -o brain.msh
    sed -i 's/tolerance = .*/tolerance = 1e-3/' brain3d.scene
    nodes -u mm brain.msh | ipoints | support | shapefn > table.mts
    mtled -v brain3d.scene table.mts > u.dat 2> log
}

setup() {
    cd "$BATS_FILE_TMPDIR" || return
}

@test "the brain settles in its skull: forces balance, no point is turned over, no contact node goes through" {
    mts check u.dat
    [ "$(awk '$1 == "steps" { print $2 }' log)" -lt 4000 ]
    awk -f "$BATS_TEST_DIRNAME/../pipelines/stream.awk" -f "$BATS_TEST_DIRNAME/../pipelines/brain3d/balance.awk" \
        -v scheme=coarse -v field=u.dat -v report=log | awk -F '\t' '
        !($3 > 0.7 && $4 < 1.2)       { print "J from", $3, "to", $4; failed = 1 }
        !($5 > 0.03 && $5 < 0.09)     { print "pressed in by", $5, "N"; failed = 1 }
        !($7 < 0.01 * $5)             { print $7, "N are missing"; failed = 1 }
        !($8 < 0.1 && $9 > 2)         { print $9, "contact nodes touch, the deepest by", $8, "mm"; failed = 1 }
        { rows++ }
        END { exit failed || rows != 1 }'
}

# bats test_tags=thorough
@test "the tables of the whole brain are those that its geometry gives" {
    mkdir -p made
    cp "$EXAMPLE"/{*.geo,*.msh.gz,make-tables.sh} made
    bash made/make-tables.sh
    for table in load skull; do
        paste "made/$table.tsv" "$EXAMPLE/$table.tsv" | awk '
            /^#/ { next }
            { for (i = 1; i <= NF / 2; i++) if (!(($i - $(i + NF / 2)) ^ 2 < 1e-5)) exit 1; n++ }
            END { if (n < 600) exit 1 }'
    done
}
