# The stream through pipes and files, on the command line; the programs of mts(5).

load common.bash

setup() {
    mkdir "$BATS_TEST_TMPDIR/work"
    cd "$BATS_TEST_TMPDIR/work"
    page=$BATS_TEST_DIRNAME/../tools/mts.5
}

# The text between the marks of NAME in the man page, with what roff needs taken off.
from_page() {
    sed -n "/^\.\\\\\" begin $1\$/,/^\.\\\\\" end $1\$/p" "$page" | sed -e 1d -e '$d' \
        -e 's/\\-/-/g' -e "s/\\\\(aq/'/g" -e 's/\\(ha/^/g' -e 's/\\(ti/~/g' -e 's/\\(ga/`/g' -e 's/^\\&//' -e 's/\\e/\\/g'
}

small() {
    printf '%s\n' '# mts 1' "# @ test 1 test 'a b'"
    section 'nodes.x f8 3 2 enc=text unit=m cols=x,y' '0.10000000000000001 -0' '4.9406564584124654e-324 1.7976931348623157e+308' 'nan inf'
    section 'stranger i8 2 1 enc=text key=value' 9223372036854775807 -9223372036854775808
    section 'u f8 3 2 enc=text unit=m cols=x,y' '0.5 1' '0.25 -2' '3 4'
    section 'none i4 0 3 enc=text'
    echo '# end 4'
}

# About 5 MB, more than any buffer.
large() {
    awk 'BEGIN { srand(1); print "# mts 1\n# x f8 100000 3 enc=text"
        for (i = 0; i < 100000; i++) print rand(), i, -rand() * 1e-9; print "\n\n# end 1" }' | mts text
}

@test "text to binary and back gives the same bytes, from a file and from a pipe" {
    for make in small large; do
        $make > text
        mts binary text > binary
        mts binary < text | cmp - binary
        cat text | mts binary | cmp - binary
        mts text binary | cmp - text
        mts text < binary | cmp - text
        cat binary | mts text | cmp - text
        cat binary | mts binary | cmp - binary
        mts binary text -o output
        cmp output binary
    done
}

@test "a stream in slow small pieces is the same stream" {
    small | mts binary > binary
    { while IFS= read -r -n 100 -d '' piece || [ -n "$piece" ]; do printf %s "$piece"; done < <(small); } | mts text | cmp - <(small)
    { head -c 70 binary; sleep 0.05; tail -c +71 binary | head -c 200; sleep 0.05; tail -c +271 binary; } | mts binary | cmp - binary
}

@test "provenance names neither the input file nor the output file" {
    small > 'in put'
    mts keep -o out 'u' 'in put'
    mts keep u < 'in put' | cmp - out
    mts keep 'u*,node?.x' < 'in put' | mts list -v > list
    grep -qxF "# @ $(mts --version) mts keep 'u*,node?.x'" list
    mts keep -to out u 'in put'
    mts keep -tonot u 'in put'
    mts keep -t u --output=nut < 'in put'
    mts keep u --output nit -t 'in put'
    cmp out not
    cmp out nut
    [ "$(sed -n 3p out)" = "# @ $(mts --version) mts keep -t u" ]
    [ "$(sed -n 3p nit)" = "# @ $(mts --version) mts keep u -t" ]
    grep -qxF "# @ test 1 test 'a b'" list
}

@test "-o replaces the file behind a link and keeps its mode; input and output may be one file" {
    small > data
    ln -s data link
    chmod 640 data
    mts binary data -o link
    [ -L link ]
    [ "$(stat -c %a data)" = 640 ]
    small | mts binary | cmp - data
    (umask 027 && mts text data -o new)
    [ "$(stat -c %a new)" = 640 ]
    run -2 --separate-stderr mts text data -o .
    [[ "$stderr" == "mts: .: is a directory" ]]
    mts text data -o /dev/null
    [ -c /dev/null ]
}

@test "closed standard streams are errors, and no file takes their place" {
    small > text
    run -3 --separate-stderr bash -c 'mts list text >&-'
    [[ "$stderr" == "mts: standard output: "* ]]
    run -3 bash -c 'mts binary text >&-'
    run bash -c 'mts list <&-'
    [ "$status" -ne 0 ]
    run -2 bash -c 'mts list /nonexistent 2>&-'
    small | cmp - text
}

@test "no binary to a terminal, no stream from one" {
    small > text
    run -2 script -qefc 'mts binary text' /dev/null
    [[ "$output" == *"no binary to a terminal"* ]]
    run -0 script -qefc 'mts text text' /dev/null
    [[ "$output" == *"# end 4"* ]]
    run -2 script -qefc 'mts list' /dev/null
    [[ "$output" == *"standard input is a terminal"* ]]
}

@test "gnuplot finds a section by its name" {
    small > text
    run -0 gnuplot -e "set table '/dev/stdout'; plot 'text' index 'u ' using 1:2"
    [[ "$output" == *"0.25"*"-2"* ]]
    [[ "$output" != *"922337"* ]]
}

@test "the sample stream of mts(5) is one" {
    from_page sample.mts > sample
    mts text sample | cmp - sample
    run -0 mts check sample
    [ "$output" = "" ]
}

@test "the awk filter of mts(5) runs" {
    from_page scale.awk > scale.awk
    small | awk -v factor=1000 -f scale.awk | mts print u | cmp - <(printf '500 1000\n250 -2000\n3000 4000\n')
    small | awk -v factor=1 -f scale.awk | grep -v '^# @ scale' | cmp - <(small)
    small | mts binary > binary
    run -2 --separate-stderr awk -v factor=1000 -f scale.awk binary
    [ "$stderr" = "scale.awk: binary: run mts text" ]
}

@test "the C filter of mts(5) compiles without warnings and runs" {
    from_page scale.c > scale.c
    ${CC:-cc} -std=gnu11 -Wall -Wextra -Werror -O1 -o scale scale.c -lz
    small | mts binary > binary
    ./scale 1000 < binary > scaled
    mts print u scaled | cmp - <(printf '500 1000\n250 -2000\n3000 4000\n')
    ./scale 1 < binary | mts text | grep -v '^# @ scale' | cmp - <(small)
    large | mts binary | ./scale 2 | mts print x | cmp - <(large | mts print x)
    # It notices what the reader of the library notices: cut short, damaged.
    size=$(stat -c %s binary)
    for length in 5 100 $((size - 60)) $((size - 1)); do
        head -c $length binary > short
        run -2 bash -c './scale 2 < short > result'
        run -2 mts list result
    done
    sed 's/stranger/stranges/' binary > damaged
    run -2 bash -c './scale 2 < damaged'
}

@test "the sections of the manual are those that the library knows" {
    awk -F '|' '/^## Sections/ { on = 1 } /^Results/ { exit } on && /^\| `/ { gsub(/[` ]/, "", $2); gsub(/,/, "\n", $2); print $2 }' \
        "$BATS_TEST_DIRNAME/../lib/README.md" | sort > manual
    sed -n 's/^ *{"\([^"]*\)", TYPE.*MADE_WITH_\([A-Z]*\)},/\1 \2/p' "$BATS_TEST_DIRNAME/../lib/io/stream/sections.c" |
        awk '$2 != "RESULTS" { print $1 }' | sort > library
    [ "$(wc -l < library)" -gt 30 ]
    diff manual library
}
