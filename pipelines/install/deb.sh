#!/bin/bash
# deb.sh ROOT VERSION PACKAGE: the package of what lies under ROOT, whose dependencies are the libraries of its programs.
# DERIVE=1: as on a machine without dpkg-shlibdeps, by the packages that the libraries came in, of any version.
set -eu -o pipefail
root=$1 version=$2 package=$3
here=$(dirname "${BASH_SOURCE[0]}")

derive() {
    local library
    objdump -p "$root"/usr/bin/* | awk '$1 == "NEEDED" { print $2 }' | sort -u | while IFS= read -r library; do
        dpkg -S "*/$library" | sed 's/:.*//' | sort -u
    done | sort -u | paste -s -d , | sed 's/,/, /g'
}

# dpkg-shlibdeps wants to stand in the folder of a source package, with what goes into a package below debian/.
ask_dpkg() {
    local work
    work=$(mktemp -d)
    trap 'rm -rf "$work"' RETURN
    mkdir "$work/debian"
    ln -s "$(realpath "$root")" "$work/debian/mtled"
    printf 'Source: mtled\n\nPackage: mtled\nArchitecture: any\n' > "$work/debian/control"
    (cd "$work" && dpkg-shlibdeps -O debian/mtled/usr/bin/* | sed 's/^shlibs:Depends=//')
}

mkdir "$root/DEBIAN"
strip --strip-unneeded "$root"/usr/bin/*
gzip -9 -n "$root"/usr/share/man/man*/*
install -D -m 644 "$here/../../LICENSE" "$root/usr/share/doc/mtled/copyright"
if command -v dpkg-shlibdeps > /dev/null && [ -z "${DERIVE:-}" ]; then
    depends=$(ask_dpkg)
else
    depends=$(derive)
fi
[ -n "$depends" ] || { echo "deb.sh: no package has the libraries of the programs" >&2; exit 1; }
# barcode has a program sample, libghc-wai-app-static-dev a program warp.
cat > "$root/DEBIAN/control" << END
Package: mtled
Version: $version
Architecture: $(dpkg --print-architecture)
Maintainer: mtled <mtled@localhost>
Installed-Size: $(du -sk "$root/usr" | cut -f 1)
Depends: $depends
Recommends: gmsh, python3-numpy
Conflicts: barcode, libghc-wai-app-static-dev
Section: science
Priority: optional
Description: meshless simulation of soft tissue by small programs in a pipe
 Displacements, forces and stresses of soft, nearly incompressible tissue under
 large deformations, from a cloud of nodes: shape functions by Modified Moving
 Least Squares, forces and stepping by Meshless Total Lagrangian Explicit
 Dynamics. Each stage is one program that reads a stream and writes a stream.
END
dpkg-deb -z3 --build --root-owner-group "$root" "$package"
