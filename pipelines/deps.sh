#!/bin/bash
# Install what the project needs and what is missing. Quick and silent when nothing is. Programs may come from any
# package (gnuplot-qt is as good as gnuplot-nox, which would push it out); libraries are asked for by package.
# Open MPI is for mtled in several processes (make mpi).
# CalculiX and FreeFEM (with a BLAS that does it justice) are for comparison only: the studies need them, no program does. Python's
# are for the tests, which read what tovtk and warp write; plastimatch applies a field of warp to a scan. mricron-data has the scan of a
# head for make neurosurgery. Bodies are drawn on the screen of xvfb: where it alone is missing and cannot be had, all else works.
# deps.sh lint, fuzz, dolfinx: what make lint, make fuzz and make speed-error need, which nothing else does.
set -eu -o pipefail

# program:package
case ${1:-} in
lint)
    programs=(clang-tidy:clang-tidy cppcheck:cppcheck shellcheck:shellcheck)
    libraries=()
    ;;
fuzz)
    # The sanitizers and libFuzzer are in a package that has the version of clang in its name.
    version=$(apt-cache depends clang 2> /dev/null | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p')
    programs=(clang:clang)
    libraries=(libomp-dev "libclang-rt-$version-dev")
    ;;
dolfinx) # the peer of make speed-error; some hundred packages
    programs=()
    libraries=(python3-dolfinx)
    ;;
*)
    programs=(gcc:gcc make:make pkg-config:pkg-config gmsh:gmsh gnuplot:gnuplot-nox ccx:calculix-ccx
        FreeFem++-nw:freefem++ bats:bats shellcheck:shellcheck plastimatch:plastimatch mpirun:openmpi-bin)
    libraries=(libgsl-dev libexpat1-dev zlib1g-dev libopenmpi-dev libcmocka-dev libfreefem++ libopenblas0-serial
        python3-numpy python3-vtk9 python3-meshio python3-nibabel mricron-data xvfb xauth)
    ;;
esac

missing=()
for program in "${programs[@]}"; do
    command -v "${program%:*}" > /dev/null || missing+=("${program#*:}")
done

if ! command -v apt-get > /dev/null || ! command -v dpkg-query > /dev/null; then
    [ ${#missing[@]} -eq 0 ] && exit 0
    echo "deps: this is not Debian or Ubuntu: please install what these packages hold: ${missing[*]} ${libraries[*]}" >&2
    exit 1
fi

for package in "${libraries[@]}"; do
    case $(dpkg-query -W -f '${Status}' "$package" 2> /dev/null || true) in
    *" installed") ;;
    *) missing+=("$package") ;;
    esac
done
[ ${#missing[@]} -eq 0 ] && exit 0

# fail STATUS: but where pictures alone suffer.
fail() {
    printf '%s\n' "${missing[@]}" | grep -qvx -e xvfb -e xauth && exit "$1"
    echo "deps: without ${missing[*]} bodies are drawn on a display only" >&2
    exit 0
}
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo > /dev/null; then
        echo "deps: as root, please run: apt-get install ${missing[*]}" >&2
        fail 1
    fi
    as_root=(sudo)
fi
echo "deps: installing ${missing[*]}" >&2
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq || fail $?
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null || fail $?
