# make deps: quick and silent when nothing is missing, and what it does when something is.

bats_require_minimum_version 1.5.0

setup() {
    cd "$BATS_TEST_TMPDIR"
    deps=$BATS_TEST_DIRNAME/../pipelines/deps.sh
    mkdir bin
}

# fake NAME TEXT: a program of that name in front of the others.
fake() {
    printf '#!/bin/bash\n%s\n' "$2" > "bin/$1"
    chmod +x "bin/$1"
}

@test "nothing missing: silent, and no package manager is asked" {
    fake apt-get 'echo asked >> asked'
    fake dpkg-query 'echo "install ok installed"'
    PATH=$PWD/bin:$PATH run -0 bash "$deps"
    [ -z "$output" ]
    [ ! -e asked ]
}

@test "a library is missing: it alone is installed, as root or through sudo" {
    fake apt-get 'echo "$*" >> asked'
    fake sudo '"$@"'
    fake dpkg-query '[[ $* == *libexpat1-dev* ]] || echo "install ok installed"'
    PATH=$PWD/bin:$PATH run -0 bash "$deps"
    [ "$output" = "deps: installing libexpat1-dev" ]
    grep -q '^install.* libexpat1-dev$' asked
    fake id 'echo 1000'
    fake sudo 'echo sudo >> asked; "$@"'
    PATH=$PWD/bin:$PATH run -0 bash "$deps"
    grep -qx sudo asked
}

@test "elsewhere: says what to install" {
    for program in bash awk; do ln -s "$(command -v $program)" bin; done
    PATH=$PWD/bin run -1 bash "$deps"
    [[ $output == *"not Debian"*calculix-ccx*libgsl-dev* ]]
    [ ${#lines[@]} -eq 1 ]
}

@test "a package manager that fails is a failure" {
    fake apt-get 'exit 100'
    fake sudo '"$@"'
    fake dpkg-query 'true'
    PATH=$PWD/bin:$PATH run -100 bash "$deps"
    fake dpkg-query '[[ $* == *xvfb* ]] || echo "install ok installed"' # what only pictures need
    PATH=$PWD/bin:$PATH run -0 bash "$deps"
    [ "${lines[1]}" = "deps: without xvfb bodies are drawn on a display only" ]
}
