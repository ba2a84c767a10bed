# The texts: what they say the commands print is what these print, their figures are those of the result files, and they name what is there.

load common.bash

setup() {
    enter_loosely
    texts="README.md CONTRIBUTING.md examples/README.md pipelines/README.md"
}

same() { awk -v tolerance=0.25 "${@:3}" -f "$BATS_TEST_DIRNAME/same.awk" "$1" "$2"; }

# A text without what its commands print: that alone depends on the version of gmsh, which makes the meshes.
without_output() { awk '/^```/ { inside = $0 == "```console" } !inside || /^[$>`]/' "$1"; }

up_to_date() {
    local text=$top/$1 digits=0
    if [ -z "${DISPLAY:-}" ] && ! command -v xvfb-run > /dev/null; then # no picture of a body
        grep -v '^[$] pipelines/render.py' "$text" > text
        text=$PWD/text
    fi
    grep -qx "gmsh.$(gmsh --version 2>&1)" "$top/pipelines/results/made_with.tsv" && digits=1
    bash "$top/pipelines/readme.sh" < "$text" > new
    diff <(without_output "$text") <(without_output new)
    same "$text" new -v digits=$digits
}

@test "what voxels and tag say in examples/neurosurgery/README.md is what they print" {
    text=examples/neurosurgery/README.md
    cd "$top"
    (
        N=examples/neurosurgery
        # Its line, up to tag.
        eval "$(sed -n '/^voxels -v /,/^ *tag /p' $text | sed '$ s/ |$//')" > /dev/null
    ) 2> "$BATS_TEST_TMPDIR/said"
    cd "$BATS_TEST_TMPDIR"
    grep -E '^(voxels|tag): ' "$top/$text" > shown
    [ "$(wc -l < shown)" -ge 6 ]
    while IFS= read -r line; do
        grep -qxF "$line" said || { echo "not printed: $line"; cat said; false; }
    done < shown
}

@test "figures, tables and commands in README.md are up to date (else: make readme)" { up_to_date README.md; }
@test "the same of examples/README.md" {
    [ "$(grep -c '^\$ ' "$top/examples/README.md")" -ge 15 ]
    up_to_date examples/README.md
}
@test "the same of pipelines/README.md" {
    [ "$(grep -c '^<!-- study ' "$top/pipelines/README.md")" -ge 4 ]
    up_to_date pipelines/README.md
}

@test "files that the texts point to exist" {
    for text in $texts lib/README.md examples/brain2d/README.md; do
        grep -oE '\]\([^)#]+\)' "$top/$text" | sed 's/^](//; s/)$//' | grep -v '^http' > links || true
        while IFS= read -r link; do
            [ -s "$top/$(dirname "$text")/$link" ] || { echo "$text: no $link"; false; }
        done < links
    done
    grep -q liver.png <(grep -o 'pictures/.*png' "$top/README.md")
    cat "$top"/README.md "$top"/*/README.md "$top"/examples/*/README.md > all
    for picture in "$top"/examples/*/pictures/*.png; do
        grep -q "/$(basename "$picture"))" all
    done
}

# constants: NAME PLACE for each name of lib/CONSTANTS.md, a line for each file that it may stand in.
constants() {
    awk -F ' [|] ' 'sub(/^[|] `/, "`") {
        rest = ""
        for (n = split($1, name, "`"); n > 1; n--) if (name[n] == "" || n % 2 == 0) rest = rest " " name[n]
        folder = ""
        for (i = 1; i <= split($2, place, ", "); i++) {
            if (match(place[i], /.*\//)) { folder = substr(place[i], 1, RLENGTH); place[i] = substr(place[i], RLENGTH + 1) }
            sub(/^lib\//, "", folder)
            split(rest, each, " ")
            for (k in each) print each[k], folder ~ /^tools/ ? folder place[i] : "lib/" folder place[i]
        }
    }' "$top/lib/CONSTANTS.md"
}

@test "constants: each name of the table stands in one of the files that it names" {
    constants > names
    [ "$(wc -l < names)" -gt 50 ]
    while read -r name place; do
        [ -s "$top/$place" ] || { echo "lib/CONSTANTS.md: no $place"; false; }
        grep -qw -e "$name" "$top/$place" && echo "$name"
    done < names | sort -u > found
    [ -z "$(cut -d ' ' -f 1 names | sort -u | comm -23 - found)" ] || { cut -d ' ' -f 1 names | sort -u | comm -23 - found; false; }
}

# Round-off, 1e-6 and below, is none of them, nor are mathematical constants and limits of formats.
@test "constants: each real number that lib and tools name has a row with its place" {
    constants | sort -u > names
    (cd "$top" && grep -nE '^static const double ' lib/*/*.c lib/*/*/*.c tools/{common,mtled,tovtk,voxels,warp}/*.c tools/common/*/*.c) | sed -E 's/:[0-9]+:static const double/ /; s/;.*//' |
        while read -r place rest; do
            tr , '\n' <<< "$rest" | sed -nE "s|^ *([a-z_0-9]+) = *-?([0-9.]+(e-?[0-9]+)?).*|\1 $place \2|p"
        done | awk '$3 > 1.5e-6 && $3 < 1e15 { print $1, $2 }' | grep -vE '^(pi|full_turn) ' | sort -u > code
    [ "$(wc -l < code)" -gt 80 ]
    comm -23 code names > missing
    [ ! -s missing ] || { cat missing; false; }
}

@test "equations that headers cite are those of lib/README.md" {
    cat "$top"/lib/*/*.[ch] "$top"/lib/*/*/*.[ch] | tr -s ' *\n' ' ' | grep -oE 'equations? \([0-9]+\)( to \([0-9]+\))?( and \([0-9]+\))? of lib/README.md' |
        grep -oE '\([0-9]+\)' | sort -u > cited
    [ "$(wc -l < cited)" -ge 10 ]
    while IFS= read -r number; do
        grep -qE "^    .* [(]${number//[()]/}[)]\$" "$top/lib/README.md" || { echo "lib/README.md: no equation $number"; false; }
    done < cited
}

@test "every program has a line in README.md" {
    for file in "$top"/tools/*.c; do
        grep -q "^| \`$(basename "$file" .c)\` |" "$top/README.md"
    done
}

@test "the layers of lib/ include only what lib/README.md lets them" {
    includes() { grep -rhoE '^#include "[a-z]+/' "$top/lib/$1" | sed 's/.*"//; s|/||' | sort -u; }
    for layer in base approx solid io stages; do
        awk -F '|' -v layer=" \`$layer\` " '$2 == layer { gsub(/[`, ]+/, " ", $4); print layer, $4; exit }' "$top/lib/README.md" > allowed
        [ -s allowed ]
        includes "$layer" > found
        [ -s found ]
        while IFS= read -r other; do
            grep -qw "$other" allowed || { echo "lib/$layer includes $other"; false; }
        done < found
    done
}

# modules LAYER: those of its table in lib/README.md, in that order.
modules() { awk -F '[|`]' -v head="| module of \`$1\` |" 'index($0, head) == 1 { on = 1; next } !/^[|]/ { on = 0 } on && $3 ~ /^[a-z]+$/ { print $3 }' "$top/lib/README.md"; }

@test "a module includes only those above it in its table in lib/README.md, and no folder lacks a row" {
    for layer in approx solid io tools/common; do
        folder=$top/lib/$layer
        [ "$layer" = tools/common ] && folder=$top/tools/common
        modules $layer > rows
        diff <(sort rows) <(find "$folder" -mindepth 1 -maxdepth 1 -type d -printf '%f\n' | sort)
        : > above
        while IFS= read -r module; do
            echo "$module" >> above
            grep -rhE '^#include "' "$folder/$module" | sed -nE "s#^.include \"${layer/#tools*/}/?([a-z]+)/.*#\1#p" | sort -u > found
            [ "$layer" = tools/common ] && { grep -xFf rows found > kept || true; mv kept found; }
            run -1 grep -vxFf above found
        done < rows
        [ "$(wc -l < above)" -ge 2 ]
    done
}

@test "every section that a tool writes has a line in lib/README.md" {
    cloud -d 2 -k regular -n 4 --box 0,1,0,1 | shapefn 2> note > table.mts
    printf '[scene]\ndim = 2\nanalysis = quasi-static\n[material all]\nregion = body\nE = 3000\nnu = 0.4\nrho = 1000\nfibre = 1, 0\nactive = 1\ncurve = linear\n' > all.scene
    printf '[displacement low]\nfacets = ymin\ncomponents = 0, 0\n[displacement high]\nfacets = ymax\ncomponents = 0, -0.01\n' >> all.scene
    printf '[contact wall]\nfacets = xmax\nrigid = wall.tsv\nunit = m\nside = left\n' >> all.scene
    printf '[output]\nframes = 1\nstress = yes\nstrain = yes\npressure = yes\nvolume_ratio = yes\nfibre = yes\nreactions = yes\nmoments = yes\ngaps = yes\nenergy = yes\n' >> all.scene
    printf '2 -1\n2 2\n' > wall.tsv
    mtled all.scene table.mts > u.dat
    interp -f u --deformed -t <(mts drop '*.frame.*' u.dat | shapefn 2> note) > deformed.dat
    fieldcmp -m map.mts u.dat u.dat > /dev/null
    for stream in table.mts u.dat deformed.dat map.mts; do
        mts list $stream | cut -f 1 | sed 's/[.]frame[.].*/.frame.K/'
    done | sort -u > names
    for name in u.frame.K stress.frame.K gaps.frame.K reactions.frames moments.frames energy.frames stress strain pressure volume_ratio fibre reactions moments gaps energy difference x.deformed; do
        grep -qx "$name" names
    done
    while IFS= read -r name; do
        grep -q "^|[^|]*\`$name\`" "$top/lib/README.md" || { echo "lib/README.md: no $name"; false; }
    done < names
}
