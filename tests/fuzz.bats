# The fuzz targets on their corpora: seeds, what fuzzing found worth keeping, and every input that once broke something.
# make fuzz looks for more.

bats_require_minimum_version 1.5.0

replay() {
    corpus=("$BATS_TEST_DIRNAME/fuzz/corpus/$1"/*)
    [ ${#corpus[@]} -ge 3 ]
    run -0 "$BUILD/fuzz/$1" "${corpus[@]}"
    [ "$output" = "${#corpus[@]} files" ]
}

@test "streams: accepted alike from file and pipe and back from both forms unchanged, or refused in one line" { replay stream; }

@test "scenes: accepted with every promise kept, or refused in one line" { replay scene; }

@test "tables, surfaces and load curves: accepted finite, or refused in one line" { replay table; }

@test "meshes: what passes the check is what it says" { for format in msh inp feb vtk; do replay $format; done; }

@test "images: what is read is what the header says, and is written and read back" { replay image; }
