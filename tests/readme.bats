# README.md: what it says the commands print is what they print, and it names what is there.

bats_require_minimum_version 1.5.0

setup() {
    cd "$BATS_TEST_TMPDIR"
    top=$BATS_TEST_DIRNAME/..
}

same() { awk -v tolerance="${3:-0.25}" -f "$BATS_TEST_DIRNAME/same.awk" "$1" "$2"; }

# The tables of studies are left out: they take minutes, and tell of this machine.
without_studies() { sed '/^<!-- stud/,/^<!-- end/d' "$1"; }

@test "commands and table of tools in README.md are up to date (else: make readme)" {
    STUDIES=$PWD/none bash "$top/pipelines/readme.sh" < "$top/README.md" > new
    [ "$(grep -c '^\$ ' new)" -ge 15 ]
    same <(without_studies "$top/README.md") <(without_studies new)
}

@test "a number, a word or a line that changed is noticed; another size of blanks is not" {
    printf 'points\t1247\nu is -1.5e-3 m\n' > text
    same text text
    printf 'points  1250 \nu is -1.52e-3 m\n' > near
    same text near
    printf 'points\t1247\nu is -2.8e-3 m\n' > far
    run -1 same text far
    printf 'points\t1247\nu is 1.5e-3 m\n' > sign
    run -1 same text sign
    printf 'points\t1247\nv is -1.5e-3 m\n' > word
    run -1 same text word
    printf 'points\t1247\n' > short
    run -1 same text short
    printf 'points\t1247\nu is nan m\n' > nan
    run -1 same text nan
    run -1 same missing missing
}

@test "a command in README.md that fails is noticed" {
    printf '```console\n$ echo 1; false\n2\n```\n' > bad.md
    run -1 --separate-stderr bash "$top/pipelines/readme.sh" < bad.md
    [ "${lines[2]}" = 1 ]
    [[ $stderr == *'status 1: echo 1; false'* ]]
}

@test "files that the texts point to exist" {
    for text in README.md lib/README.md examples/brain2d/README.md; do
        grep -oE '\]\([^)#]+\)' "$top/$text" | sed 's/^](//; s/)$//' | grep -v '^http' > links || true
        while IFS= read -r link; do
            [ -s "$top/$(dirname "$text")/$link" ] || { echo "$text: no $link"; false; }
        done < links
    done
    grep -q section.png <(grep -o 'pictures/.*png' "$top/README.md")
}

@test "pictures are PNG files below 200 KB" {
    find "$top/examples" -name '*.png' > pictures
    [ "$(wc -l < pictures)" -ge 4 ]
    while IFS= read -r picture; do
        [ "$(head -c 4 "$picture" | tail -c 3)" = PNG ]
        [ "$(wc -c < "$picture")" -lt 200000 ]
    done < pictures
}

@test "every program has a line in README.md" {
    for file in "$top"/tools/*.c; do
        grep -q "^| \`$(basename "$file" .c)\` |" "$top/README.md"
    done
}

@test "the rooms of lib/ include only what lib/README.md lets them" {
    includes() { grep -rhoE '^#include "[a-z]+/' "$top/lib/$1" | sed 's/.*"//; s|/||' | sort -u; }
    for room in base approx solid io; do
        awk -F '|' -v room=" \`$room\` " '$2 == room { gsub(/[`, ]+/, " ", $4); print room, $4; exit }' "$top/lib/README.md" > allowed
        [ -s allowed ]
        includes "$room" > found
        [ -s found ]
        while IFS= read -r other; do
            grep -qw "$other" allowed || { echo "lib/$room includes $other"; false; }
        done < found
    done
}

@test "every section that a tool writes has a line in lib/README.md" {
    cloud -d 2 -k regular -n 4 --box 0,1,0,1 | shapefn 2> note > table.mts
    printf '[scene]\ndim = 2\nanalysis = quasi-static\n[material all]\nregion = body\nE = 3000\nnu = 0.4\nrho = 1000\n' > all.scene
    printf '[displacement low]\nfacets = ymin\ncomponents = 0, 0\n[displacement high]\nfacets = ymax\ncomponents = 0, -0.01\n' >> all.scene
    printf '[contact wall]\nfacets = xmax\nrigid = wall.tsv\nunit = m\nside = left\n' >> all.scene
    printf '[output]\nframes = 1\nstress = yes\nstrain = yes\npressure = yes\nvolume_ratio = yes\nreactions = yes\nmoments = yes\ngaps = yes\nenergy = yes\n' >> all.scene
    printf '2 -1\n2 2\n' > wall.tsv
    mtled all.scene table.mts > u.dat
    interp -f u --deformed -t <(mts drop '*.frame.*' u.dat | shapefn 2> note) > deformed.dat
    fieldcmp -m map.mts u.dat u.dat > /dev/null
    for stream in table.mts u.dat deformed.dat map.mts; do
        mts list $stream | cut -f 1 | sed 's/[.]frame[.].*/.frame.K/'
    done | sort -u > names
    for name in u.frame.K stress.frame.K gaps.frame.K reactions.frames moments.frames energy.frames stress strain pressure volume_ratio reactions moments gaps energy difference x.deformed; do
        grep -qx "$name" names
    done
    while IFS= read -r name; do
        grep -q "^|[^|]*\`$name\`" "$top/lib/README.md" || { echo "lib/README.md: no $name"; false; }
    done < names
}
