# What is the same for all programs: usage text, version, refusals, and the man page made from the text.

load common.bash

setup() {
    enter_loosely
    tools=()
    for file in "$top"/tools/*.c; do tools+=("$(basename "$file" .c)"); done
    [ ${#tools[@]} -ge 10 ]
}

@test "-h tells name, usage, options and examples on standard output, no line wider than 102; --version the name; an unknown option is refused" {
    for tool in "${tools[@]}"; do
        run -0 --separate-stderr "$tool" -h
        [ -z "$stderr" ]
        [[ ${lines[0]} == "$tool - "* ]]
        [[ ${lines[1]} == "usage: $tool "* ]]
        grep -qx 'Options:' <<< "$output"
        grep -qx 'Examples:' <<< "$output"
        awk 'length($0) > 102 || /[ \t]$/ || /\t/ { print FILENAME ": " $0; exit 1 }' <<< "$output"
        "$tool" --help | cmp - <(printf '%s\n' "$output")
        run -0 --separate-stderr "$tool" --version
        [[ $output =~ ^$tool\ [0-9]+\.[0-9]+\.[0-9]+$ ]]
        refused 2 no-such-option "$tool" --no-such-option
    done
    version=$(mts --version | cut -d ' ' -f 2)
    [ "$(sed -n 's/^version: //p' "$top/CITATION.cff")" = "$version" ]
    [ "$(grep -m 1 '^## ' "$top/CHANGELOG.md" | cut -d ' ' -f 2)" = "$version" ]
}

@test "options: letters together, values attached, -- before operands; twice, with or without a value where it must not: refused" {
    cloud -d 2 -k regular -n 4 --box 0,1,0,1 > -odd
    support -vk2 --basis=mls1 -- -odd 2> note | mts print facepoint.idx > together
    support --verbose --factor 2 -b mls1 ./-odd 2> note | mts print facepoint.idx | cmp - together
    while IFS='|' read -r arguments message; do
        refused 2 "$message" support $arguments ./-odd < /dev/null
    done << 'END'
-k 1 --factor 2|option --factor given twice
-vv|option -v given twice
--verbose=1|option --verbose=1 takes no value
-vz|unknown option -z in -vz (see -h)
--fact 1|unknown option --fact (see -h)
--operand 1|unknown option --operand (see -h)
END
    for last in -k --factor; do refused 2 "option $last lacks its value" support ./-odd $last; done
    run -2 --separate-stderr support ./-odd -- -k
    [[ $stderr == *"-k"* && $stderr != *lacks* ]]
}

@test "every option of the usage line is explained, and every explained option is in the usage line" {
    for tool in "${tools[@]}"; do
        "$tool" -h > text
        awk -v tool="$tool" '
            /^usage:/ { usage = 1 }
            /^$/ { usage = 0 }
            usage { line = line " " $0; next }
            { rest = rest " " $0 " " }
            END {
                while (match(line, /[[ |]--?[A-Za-z][-a-z]*/)) {
                    option = substr(line, RSTART + 1, RLENGTH - 1)
                    line = substr(line, RSTART + RLENGTH)
                    if (index(rest, " " option ",") == 0 && index(rest, " " option " ") == 0) {
                        print tool ": " option " is not explained"
                        exit 1
                    }
                }
            }' text
    done
}

# Options are asked for by name in the program's own files, or where several programs share them: of supports and shape functions, of
# comparisons, of images. -o and -t are looked at where a stream is written.
@test "every option that a usage text declares is one that the program reads" {
    for tool in "${tools[@]}"; do
        shared=()
        [ ! -d "$top/tools/$tool" ] || shared+=("$top/tools/$tool"/*.c)
        grep -qE 'radius_parse|mls_parse' "$top/tools/$tool.c" && shared+=("$top/tools/common/stage_options.c")
        grep -q comparison_field "$top/tools/$tool.c" && shared+=("$top/tools/common/comparison.c")
        grep -q tool_image_method "$top/tools/$tool.c" && shared+=("$top/tools/common/images/images.c")
        for name in $("$tool" -h | sed -n '/^Options:/,/^$/s/^\(  -.,\|     \) --\([a-z-]*\).*/\2/p'); do
            [ "$name" = output ] || { [ "$name" = text ] && grep -qE 'tool_(write|copy)[(]|tool->text|comparison_field' "$top/tools/$tool.c"; } ||
                sed '/^static const char usage/,/;$/d' "$top/tools/$tool.c" "${shared[@]}" | has "\"$name\"" ||
                { echo "$tool: --$name"; false; }
        done
    done
}

@test "man pages: the parts that make one, no blank paragraphs, and groff has no complaint where it is there" {
    for tool in "${tools[@]}"; do
        "$tool" -h | awk -f "$top/tools/man.awk" > "$tool.1"
        [ "$(head -n 1 "$tool.1")" = ".TH ${tool^^} 1 \"\" mtled" ]
        for part in NAME SYNOPSIS DESCRIPTION OPTIONS EXAMPLES 'EXIT STATUS' 'SEE ALSO'; do
            [ "$(grep -cx ".SH $part" "$tool.1")" -eq 1 ] || { echo "$tool: $part"; false; }
        done
        awk '/^\.SH/ { heading = 1; next } heading && /^\.PP/ { exit 1 } { heading = 0 }' "$tool.1"
        # Words of the text are words of the page.
        [ "$(grep -c . "$tool.1")" -ge "$("$tool" -h | grep -c .)" ]
    done
    grep -q 'mtled\\-scene (5)' mtled.1
    grep -q '^.fBnodes.x.fR (f8; N x dim; ' "$BUILD/man/man5/mts.5"
    if command -v groff > /dev/null; then
        for page in ./*.1 "$BUILD"/man/man5/*.5; do
            groff -man -ww -Tascii "$page" 2> warnings > /dev/null
            [ ! -s warnings ] || { echo "$page: $(head -n 1 warnings)"; false; }
        done
    fi
}

@test "mtled-scene(5): the example runs on the brain section" {
    page=$top/tools/mtled-scene.5
    cp "$top"/examples/brain2d/{load,skull}.tsv .
    awk '/^\.SH EXAMPLE/ { example = 1 } /^\.fi/ { on = 0 } on; example && /^\.nf/ { on = 1 }' "$page" |
        sed 's/\\-/-/g' > sample.scene
    gmsh -2 -v 2 "$top/examples/brain2d/brain2d.geo" -o body.msh
    nodes -u mm body.msh | shapefn 2> note | mtled sample.scene > u.dat
    mts check u.dat
    [ "$(mts list u.dat | grep -c '^u\.frame\.')" -eq 11 ]
    tovtk -o frames.pvd u.dat
    [ "$(grep -c '<DataSet' frames.pvd)" -ge 10 ]
}

@test "no program can start another one, but mtled, which mtled-mpi replaces under mpirun" {
    for tool in "${tools[@]}"; do
        nm -D "$BUILD/bin/$tool" > imports
        grep -q ' U ' imports
        [ "$tool" != mtled ] || sed -i '/ U execv@/d' imports
        run -1 grep -E ' U (system|popen|f?exec(l|le|lp|v|ve|vp|vpe)|execveat|fork|vfork|posix_spawnp?|wordexp)(@|$)' imports
    done
}

@test "mtled-scene(5) has every section and key that a scene may have, and no other" {
    refused() { # what is allowed instead of the last line of a scene
        printf '[scene]\ndim = 2\nanalysis = quasi-static\n%b\n' "$1" > wrong.scene
        mtled wrong.scene < /dev/null 2>&1 | sed -n 's/.*: allowed are //p' | tr -d ,
    }
    for kind in $(refused '[nonsense]'); do
        case $kind in
            scene) keys=$(refused 'zzz = 1') ;;
            initial | output | solver) keys=$(refused "[$kind]\nzzz = 1") ;;
            *) keys=$(refused "[$kind x]\nzzz = 1") ;;
        esac
        for key in $keys; do echo "$kind $key"; done
    done | sort > allowed
    [ "$(cut -d ' ' -f 1 allowed | sort -u | wc -l)" -ge 10 ]
    # Keys are bold behind .TP; a list may serve several kinds.
    awk '/^\.S[SH]/ { line = $0; count = 0; while (match(line, /\[[a-z]+/)) { kind[++count] = substr(line, RSTART + 1, RLENGTH - 1)
                       line = substr(line, RSTART + RLENGTH) } }
         tag && /^\.B / { gsub(/,/, ""); for (k = 1; k <= count; k++) for (i = 2; i <= NF; i++) print kind[k], $i }
         { tag = /^\.TP/ }' "$top/tools/mtled-scene.5" | sort > told
    [ -z "$(comm -23 allowed told)" ] || { comm -23 allowed told; false; }
    # Those of the loads, described in one list, are keys of one of them.
    join -v 2 <(sed 's/.* //' allowed | sort -u) <(comm -13 allowed told | sed 's/.* //' | sort -u) > unknown
    [ ! -s unknown ] || { cat unknown; false; }
}
