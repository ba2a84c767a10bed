# What make install and make deb leave is complete: programs that run, pages, completions, a library to link with.

load common.bash

setup() {
    enter
    tools=()
    for file in "$top"/tools/*.c; do tools+=("$(basename "$file" .c)"); done
}

# make GOALS, of the build under test.
build() { make -C "$top" BUILD="$(realpath --relative-to "$top" "$BUILD")" "$@" > log 2>&1 || { tail log; return 1; }; }

# Flags that a program needs to be linked with the library as it was built.
compile_flags=(-std=c11 -Wall -Werror)
case $BUILD in
*-san) compile_flags+=(-fsanitize=address,undefined) ;;
*-coverage) compile_flags+=(--coverage) ;;
esac

@test "install: every program, its page and its completion, below DESTDIR and PREFIX" {
    build install DESTDIR="$PWD/tree" PREFIX=/opt/mtled
    for tool in "${tools[@]}"; do
        [ "$(tree/opt/mtled/bin/$tool --version)" = "$($tool --version)" ]
        grep -q "^.TH ${tool^^} 1" "tree/opt/mtled/share/man/man1/$tool.1"
        bash -n "tree/opt/mtled/share/bash-completion/completions/$tool"
    done
    [ "$(ls tree/opt/mtled/share/man/man5 | xargs)" = "mtled-scene.5 mts.5" ]
    [ "$(ls tree)" = opt ]
    [ "$(ls tree/opt/mtled | xargs)" = "bin include lib share" ]
    run -1 grep -r "$PWD" tree/opt/mtled/lib/pkgconfig
    cloud -d 2 -k regular -n 4 --box 0,0.1,0,0.1 > square.mts
    if python3 -c 'import numpy' 2> /dev/null; then
        [ "$(PYTHONPATH=$(echo tree/opt/mtled/lib/python3*/dist-packages) python3 -c 'import mtled; print(mtled.read("square.mts")["nodes.x"].shape)')" = "(16, 2)" ]
    fi
}

@test "install: a program of ten lines is built with the library by pkg-config" {
    build install-library PREFIX="$PWD/root"
    cat > tiny.c << 'END'
#include "approx/points/cloud.h"
#include "io/stream/stream.h"
int main(void)
{
    struct stream stream;
    struct error error;
    double x[] = {0, 0, 1, 0, 0, 0.5};
    stream_init(&stream);
    bool failed = stream_put(&stream, "nodes.x", TYPE_F8, 3, 2, "unit=m cols=x,y", x, false, &error) != STATUS_OK ||
        stream_write(&stream, stdout, false, &error) != STATUS_OK;
    stream_free(&stream);
    return failed;
}
END
    export PKG_CONFIG_PATH=$PWD/root/lib/pkgconfig
    gcc "${compile_flags[@]}" tiny.c -o tiny $(pkg-config --cflags --libs mtled)
    ./tiny > tiny.mts
    [ "$(mts print nodes.x tiny.mts)" = $'0 0\n1 0\n0 0.5' ]
    [ "mts $(pkg-config --modversion mtled)" = "$(mts --version)" ]
    # Every header stands on its own, and none of the private ones is there.
    find root/include/mtled -name '*.h' -printf '%P\n' | sort > headers
    [ "$(wc -l < headers)" -ge 40 ]
    run -1 grep -riE '(private to|inside of) lib/' root/include
    sed 's/.*/#include "&"/' headers | while IFS= read -r line; do
        gcc "${compile_flags[@]}" -D_GNU_SOURCE -fsyntax-only -x c $(pkg-config --cflags mtled) - <<< "$line" || { echo "$line"; exit 1; }
    done
}

# complete WORDS...: what is offered for the last of the words.
complete_words() {
    local function=_mtled_$1
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    COMPREPLY=()
    "$function"
    echo "${COMPREPLY[*]}"
}

@test "completion: every option of every program, choices, commands; the rest is left to bash" {
    for tool in "${tools[@]}"; do
        $tool -h | awk -f "$top/tools/completion.awk" > $tool.bash
        source ./$tool.bash
        [ "$(complete -p $tool)" = "complete -o default -F _mtled_$tool $tool" ]
        # What the text explains is what is offered.
        $tool -h | awk '/^Options:/ { on = 1; next } /^$/ { on = 0 } on && /^ ? ? ? ? ? ?-/' |
            sed 's/^ *//; s/   *.*//' | grep -oE '(^|[ ,])--?[A-Za-z][-a-z]*' | tr -d ' ,' | grep -vx -e -h | sort > explained # voxels has a -h of its own
        complete_words $tool - | tr ' ' '\n' | grep -vxE -e '-h|--help|--version' | sort > offered
        [ -s offered ]
        cmp explained offered
    done
    [ "$(complete_words tovtk -o '')" = "" ]
    [ "$(complete_words tovtk --te)" = --text ]
    [ "$(complete_words cloud -k '')" = "regular jittered halton graded" ]
    [ "$(complete_words support -b m)" = "mls1 mls2 mmls2" ]
    [ "$(complete_words nodes -u '')" = "" ] # a unit, or a number
    [ "$(complete_words mts '')" = "list print text binary check recover keep drop" ]
    [ "$(complete_words mts keep '')" = "" ]
}

# bats test_tags=thorough
@test "deb: unpacked elsewhere it computes a scene; its dependencies are there, with dpkg-shlibdeps and without" {
    command -v dpkg-deb > /dev/null || skip "not Debian" # where there are no such packages
    build deb DEB="$PWD/mtled.deb"
    dpkg-deb -x mtled.deb root
    [ -s root/usr/lib/python3/dist-packages/mtled/stream.py ]
    for tool in "${tools[@]}"; do
        [ -x "root/usr/bin/$tool" ]
        [ -s "root/usr/share/man/man1/$tool.1.gz" ]
        grep -q " $tool$" "root/usr/share/bash-completion/completions/$tool"
    done
    block quasi-static > block.scene
    { held_below; printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.005\n'; } >> block.scene
    cloud -d 2 -k regular -n 4 --box 0,0.1,0,0.1 | mtled block.scene 2> note | bare > expected
    (
        PATH=$PWD/root/usr/bin:/usr/bin:/bin
        [ "$(command -v mtled)" = "$PWD/root/usr/bin/mtled" ]
        cloud -d 2 -k regular -n 4 --box 0,0.1,0,0.1 | mtled block.scene 2> note | bare > found
    )
    cmp expected found
    dpkg-deb -f mtled.deb Depends > depends
    tr ',' '\n' < depends | sed 's/^ *//; s/ .*//' | sort -u > names
    for library in libgsl libexpat zlib libgomp; do grep -q "^$library" names; done
    run ! grep -q gmsh names # it makes the meshes, a program of its own
    [ "$(dpkg-deb -f mtled.deb Recommends)" = "gmsh, python3-numpy" ]
    [ "$(dpkg-deb -f mtled.deb Version)" = "$(mts --version | cut -d ' ' -f 2)" ]
    rm -rf root/usr/share/doc
    gunzip root/usr/share/man/man*/*
    DERIVE=1 bash "$top/pipelines/install/deb.sh" root 0.2.0 derived.deb
    # By the libraries' own packages: without those that dpkg-shlibdeps knows to be in the C library's.
    dpkg-deb -f derived.deb Depends | tr ',' '\n' | sed 's/^ *//; s/ .*//' | sort -u > derived
    for name in $(cat names); do grep -qx "$name" derived || { echo "no $name in: $(cat derived)"; false; }; done
    if command -v apt-get > /dev/null; then
        apt-get -s -o Debug::NoLocking=1 install ./mtled.deb > simulated 2>&1 || { cat simulated; false; }
        grep -q '^Inst mtled' simulated
    fi
}
