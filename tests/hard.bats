# Hard cases that take seconds, all of the validation set (lib/CONSTANTS.md), and what compares them with their limits. `make hard` runs
# the rest.

bats_require_minimum_version 1.5.0

setup_file() {
    export hard=$BATS_TEST_DIRNAME/../pipelines/hard
    export limits=$hard/tolerances.tsv
}

# passes CASE: all rows of a script pass, and there are some.
passes() {
    bash "$hard/$1.sh" > "$BATS_TEST_TMPDIR/rows"
    cat "$BATS_TEST_TMPDIR/rows"
    [ -s "$BATS_TEST_TMPDIR/rows" ]
    run ! grep -vP '\tpass$' "$BATS_TEST_TMPDIR/rows"
}

@test "column under gravity" { passes 07-column; }
@test "thick and inflated cylinders" { passes 08-cylinder; }
@test "elastica" { passes 10-elastica; }
@test "Cook's membrane" { passes 11-cook; }
@test "vibrations, spin, release" { passes 13-dynamics; }
@test "traps for supports" { passes 21-supports; }
@test "contact: pressed, dragged, released" { passes 22-contact; }
@test "slit" { passes 24-slit; }
@test "reactions on curved faces" { passes 27-curved; }
@test "redundant conditions" { passes 28-redundant; }
@test "supports and membranes" { passes 35-around; }

# rows TEXT: what these lines of a script print.
rows_of() {
    printf '. "%s/common.sh"\n%s\n' "$hard" "$1" > "$BATS_TEST_TMPDIR/case.sh"
    bash "$BATS_TEST_TMPDIR/case.sh"
}

@test "rows: beyond the limit, not a number, or without a limit" {
    [[ $(rows_of 'row 1 x 1.0009 1 penetration') == *pass ]]
    [[ $(rows_of 'row 1 x 1.0011 1 penetration') == *FAIL ]]
    [[ $(rows_of 'row 1 x nan 1 penetration') == *FAIL ]]
    [[ $(rows_of 'row 1 x "" 1 penetration') == *FAIL ]]
    [[ $(rows_of 'at_least 1 x 0.49 released') == *FAIL ]]
    [[ $(rows_of 'at_most 1 x 2.1 locking') == *FAIL ]]
    [[ $(rows_of 'at_most 1 x 1.9 locking') == *pass ]]
    run --separate-stderr rows_of 'row 1 x 1 1 no-such'
    [ "$status" -ne 0 ]
    [ -z "$output" ]
    [[ $stderr == *"tolerances.tsv has no limit 'no-such'"* ]]
}
