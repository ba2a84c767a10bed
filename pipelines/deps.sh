#!/bin/bash
# Install what the project needs and what is missing. Quick and silent when nothing is.
set -eu -o pipefail
packages=(gcc g++ make gmsh libgmsh-dev libgsl-dev libinih-dev zlib1g-dev gnuplot-nox calculix-ccx libcmocka-dev bats shellcheck)

if ! command -v apt-get > /dev/null || ! command -v dpkg-query > /dev/null; then
    for program in gcc gmsh gnuplot ccx bats; do
        command -v "$program" > /dev/null || missing=yes
    done
    [ -z "${missing:-}" ] && exit 0
    echo "deps: this is not Debian or Ubuntu: please install what these packages hold: ${packages[*]}" >&2
    exit 1
fi

missing=()
for package in "${packages[@]}"; do
    case $(dpkg-query -W -f '${Status}' "$package" 2> /dev/null || true) in
    *" installed") ;;
    *) missing+=("$package") ;;
    esac
done
[ ${#missing[@]} -eq 0 ] && exit 0

echo "deps: installing ${missing[*]}" >&2
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
