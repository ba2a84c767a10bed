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
    section 'narrow f4 3 2 enc=text' '0.100000001 -0' '3.40282347e+38 1.17549435e-38' '1.40129846e-45 16777216'
    section 'D-x_1 f8 4 2 enc=text text=a=b' '2.2250738585072014e-308 2.2250738585072009e-308' '0.33333333333333331 1e+22' '9.9999999999999992e+22 -inf' '-1.7976931348623157e+308 5'
    section 'whole i4 2 2 enc=text' '0 -1' '-2147483648 2147483647'
    echo '# end 7'
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

@test "provenance is quoted for a shell: as the command's words it gives these again" {
    small > data
    words=(keep "[!'x]*" $'[!\n"$\\~]*' '*')
    mts "${words[@]:0:2}" data | mts "${words[@]:0:1}" "${words[2]}" | mts keep '*' -t > out
    [ "$(grep -c '^# @ mts [0-9.]* mts keep ' out)" -eq 3 ]
    for n in 1 2 3; do
        eval "set -- $(sed -n "$((2 + n))s/^# @ mts [0-9.]* mts //p" out)"
        [ "$1" = keep ]
        [ "$2" = "${words[n]}" ]
    done
}

@test "streams by hand or by awk: blanks and tabs, any spelling of a number, no enc=" {
    printf '# mts 1\n# @ awk\n#  x  f8\t2 3 \tunit=m \n 1\t2.50  +.5e1 \n-inf NaN -nan\n \n\t\n# end 1\n' > loose
    [ "$(mts print x loose | tr '\n' ' ')" = "1 2.5 5 -inf nan nan " ]
    mts list -v loose | has -x '# @ awk'
    mts list loose | has $'^x\tf8\t2\t3\tunit=m$'
}

@test "what is no stream is refused, from a file and from a pipe, by a line that says where" {
    # @h: begins with a section of two rows; @t: ends it; @1: begins
    h='# mts 1\n# x f8 2 2 enc=text unit=m\n' t='\n\n# end 1\n' one='# mts 1\n'
    while IFS='|' read -r bytes message; do
        bytes=${bytes//@h/$h}
        bytes=${bytes//@t/$t}
        printf '%b' "${bytes//@1/$one}" > bytes
        mts list bytes > out 2> said || [ $? -eq 2 ]
        mts list < bytes > out 2> from_file || [ $? -eq 2 ]
        mts list < <(cat bytes) > out 2> from_pipe || [ $? -eq 2 ]
        for name in said from_file from_pipe; do
            [[ $(cat $name) == "mts: "*"$message"* && $(wc -l < $name) -eq 1 ]] || { echo "$bytes: $(cat $name)"; false; }
        done
    done << 'END'
|empty: no stream arrived
# mts 2\n# end 0\n|stream version '2'
# mts 1\r\n# end 0\r\n|CR LF
\xef\xbb\xbf@1# end 0\n|byte order mark
$MeshFormat\n4.1 0 8\n|run nodes
x\ty\n0\t1\n|not an mts stream
@1# end 1\n|0 sections, the end line says 1
@1# end -0\n|is not '# end COUNT'
@1# end 0 \n|is not '# end COUNT'
@1# end 0\n\n|goes on behind its end line
@1# end 0\n@1# end 0\n|two streams
@h1 2\n3 4\n@t# end 1\n|goes on
@h1 2\n3\n@t|x: row 1: 1 numbers instead of 2
@h1 2\n\n@t|x: row 1: 0 numbers instead of 2
@h1 2\n3 4 5\n@t|x: row 1: more than 2 numbers
@h1 2\n3 4\n5 6\n@t|x: more than 2 rows
@h1 2\n3 4\n\n# end 1\n|not two blank lines
@h1 2\n3 4\n\n\n@t|stands where a section header
@h1 2\n@t|x: row 1: 0 numbers instead of 2
@h1 2\n# end 1\n|fewer rows than the 2 announced
@h1 2\n3 1,5\n@t|x: row 1: '1,5': write a decimal point
@h1 2\r\n3 4\r\n@t|x: row 0: '2?' is not a number
@h1 2\n3 four\n@t|x: row 1: 'four' is not a number of type f8
@h1 2\n3 1e999\n@t|'1e999' is not a number
@h1 2\n3 4\0\n@t|'4' is not a number
@h1 2\n3 4\n\n\n# @ late\n# end 1\n|a provenance line behind a section
@h1 2\n3 4\n\n\n# x f8 0 1\n\n\n# end 2\n|x: this section stands twice
@1# @ a\r\n# end 0\n|control character
@1# @ \033[2J\n# end 0\n|control character
@1# x f8 0 1 enc=text enc=text\n@t|one encoding
@1# x f8 0 1 enc=hex\n@t|one encoding
@1# x f8 0 1 unit\n@t|'unit' in the header is not key=value
@1# x f8 0 1 a=1 a=2\n@t|attribute a given twice
@1# x f9 0 1\n@t|type 'f9'
@1# x f8 -1 1\n@t|'-1' is not a number of rows
@1# x f8 1.5 1\n@t|'1.5' is not a number of rows
@1# x f8 1 0\n@t|out of bounds
@1# x f8 1\n@t|'' is not a number of columns
@1# x/y f8 0 1\n@t|'x/y' is no section name
@1# mts f8 0 1\n@t|'mts' is reserved
@1# 1x f8 0 1\n@t|is no section name
@1nodes\n@t|'nodes' stands where a section header
@1# x i4 1 1\n2147483648\n@t|'2147483648' is not a number of type i4
@1# x i8 1 1\n9223372036854775808\n@t|is not a number of type i8
@1# x f4 1 1\n1e39\n@t|'1e39' is not a number of type f4
@1# x f8 9000000000000000000 1000000\n@t|out of bounds
@1# x f8 100000000000 1\n1\n@t|x: row 1: 0 numbers
@1# x f8 100000000000 1 enc=bin                          \n@t|x: row 1 of 100000000000: cut short
@1# x f8 1 1 enc=bin\n@t|not a multiple of 64
END
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
    [[ "$output" == *"# end 7"* ]]
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
