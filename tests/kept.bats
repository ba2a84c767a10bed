# voxels: what is left out of the body moves no surface.

load common.bash

cells() { sed -nE "s/^voxels: $1: .* ml of voxels, ([0-9.e+-]+) ml of cells.*/\1/p" said; } # LABEL: ml, of the report in `said`

@test "bodies and specks that are left out, and cavities that are filled, move no surface" {
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
at = 2 * np.stack(np.mgrid[:32, :32, :32], -1)
one = (np.linalg.norm(at - 16, axis=-1) < 13).astype(np.uint8)
several, specks, holes = one.copy(), one.copy(), one.copy()
for corner in range(1, 8):
    centre = 16 + 32 * np.array([corner & 1, corner >> 1 & 1, corner >> 2])
    several[np.linalg.norm(at - centre, axis=-1) < 12] = 1 + (corner == 7)
specks[20:30:5, 4:30:5, 4:30:5] = specks[21:31:5, 4:30:5, 4:30:5] = 1
holes[6:11:2, 6:11:2, 6:11:2] = 0
for name, label in dict(one=one, several=several, specks=specks, holes=holes).items():
    image = nib.Nifti1Image(label, np.diag([2, 2, 2, 1]))
    image.header.set_xyzt_units("mm")
    nib.save(image, name + ".nii")
END
    for image in one specks holes several; do
        [ $image != several ] || set -- --largest
        voxels -h 4mm -v "$@" -o one.mts $image.nii 2> said
        cells label_1 >> volumes
    done
    grep -qE "^voxels: label_1: [0-9.]+ of [0-9.]+ ml lie in bodies that --largest leaves out$" said
    grep -qE "^voxels: label_2: ([0-9.]+) of \1 ml lie in bodies that --largest leaves out$" said
    run -1 grep "lost" said
    awk 'NR == 1 { ball = $1 } { print $1 / ball; bad += ($1 / ball - 1) ^ 2 > 1e-6 } END { exit bad || NR < 4 || ball < 8 }' volumes
}
