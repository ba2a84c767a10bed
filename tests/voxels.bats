# voxels: from a label image to the stream that nodes writes.

load common.bash

setup() { enter_loosely; }

phantom() { "$BUILD/tests/helper/phantom" "$@"; }

# names SECTION FILE: the names in its header, a line each
names() { mts list "$2" | awk -F '\t' -v name="$1" '$1 == name { sub(/.*names=/, "", $5); print $5 }' | tr , '\n'; }

# said LABEL: "BEFORE AFTER" in ml, of the report in `said`
said() {
    sed -nE "s/^voxels: $1: ([0-9.e+-]+) ml of voxels, ([0-9.e+-]+) ml of cells.*/\1 \2/p" said
}

# near A B SHARE
near() {
    awk -v a="$1" -v b="$2" -v share="$3" 'BEGIN { d = a / b - 1; exit !(d < share && -d < share) }'
}

# press BODY: held within 12 % of the low end of its longest side, pushed by a tenth of the length at the other end
press() {
    tag -f held=low:long,12% -f pushed=high:long,12% "$1" > named.mts 2> said.groups
    local push
    push=$(mts print nodes.x "$1" | awk '
        { for (k = 1; k <= NF; k++) { if (NR == 1 || $k < low[k]) low[k] = $k; if (NR == 1 || $k > high[k]) high[k] = $k } }
        END {
            axis = 1
            for (k = 2; k <= NF; k++) if (high[k] - low[k] > (high[axis] - low[axis]) * (1 + 1e-6)) axis = k
            for (k = 1; k <= NF; k++) printf "%s%.9g", (k > 1 ? ", " : ""), (k == axis ? -.1 * (high[k] - low[k]) : 0)
        }')
    {
        block quasi-static | sed "s/dim = 2/dim = ${2:-3}/; s/= body/= $(names cells.region "$1" | paste -sd ,)/; s/0.45/0.49/"
        printf '[displacement held]\nfacets = held\ncomponents = %s\n' "$([ "${2:-3}" = 3 ] && echo 0, 0, 0 || echo 0, 0)"
        printf '[displacement pushed]\nfacets = pushed\ncomponents = %s\n' "$push"
    } > press.scene
    shapefn named.mts 2> said.shapefn | mtled press.scene > u.dat
    mts check u.dat
}

@test "a sphere: a valid stream, its volume, and the compression of it runs" {
    phantom sphere > sphere.nii.gz
    voxels -h 6mm -v sphere.nii.gz > body.mts 2> said
    run -1 grep border said
    [ -z "$(mts check body.mts)" ]
    [ "$(names cells.region body.mts)" = label_1 ]
    [ "$(names facets.set body.mts)" = "label_1|outside" ]
    read -r before after < <(said label_1)
    near "$after" "$before" 0.01
    near "$after" 57.9 0.01
    grep -q "voxels: one connected body" said
    grep -qE "voxels: spacing 0.006 m: [0-9]+ nodes, [0-9]+ cells, dihedral angles from [0-9.]+ to [0-9.]+ degrees" said
    grep -q "0 of them more than 0.6" said
    press body.mts
}

@test "folded layers thinner than the spacing: in seconds, with each step on a terminal, and with the layers' volumes" {
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
x, y, z = 2 * np.pi / 18 * (np.mgrid[:60, :60, :60] - 30)
g = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
label = np.where(g < -0.5, 1, np.where(g < 0.5, 2, 3)) * (x * x + y * y + z * z < 89)
image = nib.Nifti1Image(label.astype(np.uint8), np.eye(4))
image.header.set_xyzt_units("mm")
nib.save(image, "folded.nii")
END
    (ulimit -t 8 && script -qefc 'voxels -v -h 5mm -o folded.mts folded.nii' terminal > ignored) # 16 s where each step searches anew
    grep -q "voxels: moving nodes onto interfaces" terminal
    tr '\r' '\n' < terminal > said
    read -r before after < <(said label_2)
    near "$after" "$before" 0.01 # .025 where nodes that cannot move count as if they did
    [ -z "$(mts check folded.mts | grep -v 'connected bodies$')" ]
}

@test "neither the number of threads matters, nor whether a file or a pipe is read" {
    phantom blobs 5 1,1,2 > image.nii.gz
    for threads in 1 2 3; do
        OMP_NUM_THREADS=$threads voxels -h 5mm --fine 2.5mm:label_1 image.nii.gz 2> said | mts print nodes.x > "$threads"
    done
    cmp 1 2
    cmp 1 3
    voxels -h 5mm image.nii.gz 2> said | mts print cells > cells
    gunzip -c image.nii.gz | voxels - -h 5mm 2> said | mts print cells | cmp cells -
}

@test "a segmentation of 3D Slicer names its labels: the stream is that of the same labels with a table" {
    nifti ball ball.nii.gz
    printf '2 Left_lung\n5 tumour__solid\n' > names
    voxels -h 6mm -l names ball.nii.gz | mts text | bare > expected
    for layers in 1 2; do
        shared=$(nifti segments ball.nii.gz ball.seg.nrrd $layers 'Left lung' 'tumour, solid')
        voxels -h 6mm ball.seg.nrrd 2> said | mts text | bare | cmp expected -
        grep -q "names are changed to what scenes can hold, as 'Left lung' to Left_lung" said
        [ $layers = 1 ] || has "segments overlap in $shared voxels, first 'Left lung' and 'tumour, solid': the later is taken" said
    done
    voxels -h 6mm -l <(printf '1 Left_lung\n2 tumour__solid\n') ball.seg.nrrd 2> said | mts text | bare | cmp expected -
    nifti segments ball.nii.gz ball.seg.nrrd 1 lung lung
    [ "$(voxels -h 6mm ball.seg.nrrd 2> said | names cells.region - | xargs)" = "lung lung_2" ]
    sed 's/^Segment1_LabelValue:=5/Segment1_LabelValue:=6/' ball.seg.nrrd > other.seg.nrrd
    voxels -h 6mm other.seg.nrrd 2> said | mts check
    grep -q "segment 'lung' has no voxel; .* voxels have a label of no segment: left out" said
    refused 2 "ball.seg.nrrd: a segmentation on top of others: give it first" voxels -h 6mm ball.nii.gz ball.seg.nrrd
    sed 's/^Segment1_LabelValue:=5/Segment1_LabelValue:=2/' ball.seg.nrrd > other.seg.nrrd
    refused 2 "segments 'lung' and 'lung' have the same label, 2" voxels -h 6mm other.seg.nrrd
    sed 's/^Segment1_Layer:=0/Segment1_Layer:=1/' ball.seg.nrrd > other.seg.nrrd
    refused 2 "segment 'lung' is in layer 1 of 1 (from 0)" voxels -h 6mm other.seg.nrrd
    sed 's/:=Binary/:=Fractional/' ball.seg.nrrd > other.seg.nrrd
    refused 2 "convert it to a binary labelmap" voxels -h 6mm other.seg.nrrd
}

@test "an atlas of 50 labels merged to 5 by a table; labels dropped, cavities named" {
    phantom atlas > atlas.nii.gz
    printf '# regions\n1-10 a\n11,12-20 b # all of them\n21-30 c\n31-40\td\n* e\n' > five
    voxels -h 4mm -v -l five atlas.nii.gz > body.mts 2> said
    [ -z "$(mts check body.mts)" ]
    [ "$(names cells.region body.mts | tr '\n' ' ')" = "a b c d e " ]
    names sets.ptr body.mts | has -x 'a|b'
    for name in a b c d e; do
        read -r before after < <(said $name)
        near "$after" "$before" 0.01
    done
    printf '1-25 near\n26-49 hole -\n50 -\n' > cavity
    voxels -h 4mm -v -l cavity atlas.nii.gz > body.mts 2> said
    [ "$(names cells.region body.mts)" = near ]
    [ "$(names facets.set body.mts | tr '\n' ' ')" = "near|outside near|hole " ]
    grep -q "voxels: hole: .* ml of voxels, left out" said
}

@test "thin parts that the lattice loses, and gaps that it fills, are reported" {
    phantom thin > thin.nii.gz
    refused 2 "no label 'skull'" voxels -h 6mm --fine 3mm:skull thin.nii.gz
    refused 2 "is not less than the spacing" voxels -h 6mm --fine 6mm thin.nii.gz
    voxels -h 6mm thin.nii.gz 2> said > coarse.mts
    grep -qE "voxels: label_2: 2\.[0-9]+ ml are lost in parts thinner than the spacing" said
    printf '1 body\n2 fluid -\n' > names
    voxels -h 6mm -l names thin.nii.gz 2> said > coarse.mts
    grep -qE "^voxels: fluid: [12]\.[0-9]+ ml of gaps and cavities narrower than the spacing are filled: see --fine$" said
    voxels -h 6mm --fine 1.5mm:fluid -l names thin.nii.gz 2> said > fine.mts
    run -1 grep "are filled" said
    grep -q "^voxels: 2 connected bodies" said
}

@test "a bar between two balls that the lattice loses leaves two bodies; --fine keeps it" {
    phantom bar > bar.nii.gz
    voxels -h 5mm bar.nii.gz 2> said > body.mts
    grep -q "^voxels: 2 connected bodies, .*: --largest keeps that one; a smaller -h, or --fine, keeps thin connections$" said
    voxels -h 5mm --fine 1.25mm bar.nii.gz 2> said > body.mts
    run -1 grep "connect" said
}

# sizes LEAST GRADATION X Y Z: a stream of sizes over 100 mm about the origin, LEAST at a place, growing with the distance (mm)
sizes() {
    cloud -d 3 -k regular -n 21 --box -0.05,0.05,-0.05,0.05,-0.05,0.05 -t -o cloud.dat
    with_section cloud.dat size f8 <(mts print nodes.x cloud.dat | awk -v s="$1" -v g="$2" -v x="$3" -v y="$4" -v z="$5" \
        '{ print s / 1e3 + g * sqrt(($1 - x / 1e3) ^ 2 + ($2 - y / 1e3) ^ 2 + ($3 - z / 1e3) ^ 2) }') unit=m
}

@test "--sizes: bad ones are refused in a line" {
    phantom sphere > image.nii.gz
    phantom sphere@slice > slice.nii.gz
    sizes 2 0.3 0 0 0 > sizes.dat
    refused 2 "for bodies in space" voxels -h 4mm --sizes <(cloud -d 2 -k regular -n 3 --box 0,1,0,1 | with_section - size f8 <(yes 1 | head -n 9)) slice.nii.gz
    refused 2 "cells in 3D, the image is of a body in 2D" voxels -h 4mm --sizes sizes.dat slice.nii.gz
    refused 2 "run sizefield -b" voxels -h 4mm --sizes <(mts drop size sizes.dat) image.nii.gz
    refused 2 "cells" voxels -h 4mm --sizes <(mts drop cells sizes.dat) image.nii.gz
    refused 2 "9260 rows for 9261 nodes" voxels -h 4mm --sizes <(shortened size sizes.dat) image.nii.gz
    for bad in 0 -1e-3 nan inf; do
        awk -v bad=$bad '/^# / { on = $2 == "size"; n = 0 } on && NF == 1 && ++n == 8 { $1 = bad } { print }' sizes.dat > bad.dat
        refused 2 "size: row 7: " voxels -h 4mm --sizes bad.dat image.nii.gz
        [[ "$stderr" == *"is not finite and positive"* ]]
    done
    refused 2 "the sizes lie elsewhere" voxels -h 4mm --sizes <(cloud -d 3 -k regular -n 3 --box 1,2,1,2,1,2 | with_section - size f8 <(yes 0.002 | head -n 27)) image.nii.gz
    sizes 0.05 0.3 0 0 0 > many.dat
    refused 2 "more than 67108864 lattice points" voxels -h 4mm --sizes many.dat image.nii.gz
    sizes 0.001 0.3 0 0 0 > tiny.dat
    refused 2 "a size of 1e-06 m: at least 1/128 of the spacing" voxels -h 4mm --sizes tiny.dat image.nii.gz
    # What sizes leave out is reported.
    sizes 2 0.3 0 0 0 | awk '/^# / { on = $2 == "nodes.x" } on && NF == 3 { $1 += 0.05 } { print }' > aside.dat
    voxels -h 8mm --sizes aside.dat image.nii.gz 2> said > body.mts
    grep -qE "voxels: [45][0-9.]* % of the body lie beyond the sizes" said
}

@test "a slice, its own or chosen from a body" {
    phantom two@slice > slice.nii.gz
    voxels -h 4mm -v slice.nii.gz > flat.mts 2> said
    mts list flat.mts | has 'cols=x,y$'
    [ -z "$(mts check flat.mts)" ]
    press flat.mts 2
    phantom two > body.nii.gz
    voxels -h 4mm -s z=0.3mm body.nii.gz 2> said | cmp <(mts print nodes.x) <(mts print nodes.x flat.mts)
    voxels -h 4mm -s x=-0.005 body.nii.gz > sagittal.mts 2> said
    [ -z "$(mts check sagittal.mts)" ]
    [ "$(names cells.region sagittal.mts)" = label_1 ]
    refused 2 "the slices lie from" voxels -h 4mm -s y=80mm body.nii.gz
    refused 2 "not a place on an axis" voxels -h 4mm -s w=8mm body.nii.gz
    refused 2 "not a place on an axis" voxels -h 4mm -s 8mm body.nii.gz
    refused 2 "for bodies in space" voxels -h 4mm --fine 2mm slice.nii.gz
    { printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 9 1\nencoding: ascii\nspace: RAS\nspace origin: (0,0,0)\n'
        printf 'space directions: (2,0,0) (0,1.6,1.2) (0,-1.2,1.6)\n\n' && yes 1 | head -n 81; } > oblique.nrrd
    refused 2 'the slice is oblique to the axes of the world: resample it first' voxels -h 4mm oblique.nrrd
}

@test "a body that the image cuts off" {
    phantom sphere > sphere.nii.gz
    voxels -h 6mm -s z=0 sphere.nii.gz > flat.mts 2> said
    run -1 grep border said
    /usr/bin/python3 - << 'END'
import gzip
data = bytearray(gzip.open("sphere.nii.gz").read())
data[352:354] = (1).to_bytes(2, "little") # a corner
gzip.open("cut.nii.gz", "w").write(bytes(data))
END
    voxels -h 6mm cut.nii.gz 2> said | mts check
    grep -q "voxels: label_1 reaches the border of the image: the body ends there" said
}

# volume FILE: that within the triangles of a table, ml
volume() {
    awk '{
        v = $1 * ($5 * $9 - $6 * $8) - $2 * ($4 * $9 - $6 * $7) + $3 * ($4 * $8 - $5 * $7)
        sum += v / 6e-6
    } END { printf "%.5g", sum }' "$1"
}

@test "parts of the boundary: tag names them, in a ball or by a mask, on whose rim nodes lie" {
    phantom sphere > sphere.nii.gz
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
image = nib.load("sphere.nii.gz")
z = (image.affine @ np.vstack([np.indices(image.shape).reshape(3, -1), np.ones(image.shape).reshape(1, -1)]))[2].reshape(image.shape)
nib.save(nib.Nifti1Image(((np.asarray(image.dataobj) > 0) & (z > 14)).astype(np.uint8), None, image.header), "mask.nii.gz")
END
    voxels -h 5mm sphere.nii.gz | tag -f 'cap=ball:0,0,0.024,0.014' | mts list | has 'names=label_1|outside,cap'
    voxels -h 5mm sphere.nii.gz 9=mask.nii.gz | tag -r label_1=all --replace -f 'part=label_9|outside' -d 'label_9|outside' > body.mts 2> said
    [ -z "$(mts check body.mts)" ]
    [ "$(names cells.region body.mts)" = label_1 ]
    paste <(mts print facets.set body.mts) <(mts print facets body.mts) | awk '
        NR == FNR { x[FNR - 1] = $1; y[FNR - 1] = $2; z[FNR - 1] = $3; next }
        { for (i = 2; i <= 4; i++) { on[$i, $1] = 1; node[$i] = 1 } }
        END {
            for (k in node) if (on[k, 0] && on[k, 1]) { n++; d = z[k] - .0145; mean += d; square += d * d }
            print n, mean / n, sqrt(square / n); exit !(n > 12 && sqrt(square / n) < 0.0012)
        }' <(mts print nodes.x body.mts) -
}

@test "the surface of a label as a table for contact, at a gap" {
    phantom two > two.nii.gz
    voxels -h 5mm --surface label_1 two.nii.gz > one.tsv
    voxels -h 5mm --surface label_1 -v two.nii.gz 2> said > again.tsv
    cmp one.tsv again.tsv
    read -r before after < <(said label_1)
    near "$(volume one.tsv)" "$before" 0.01
    voxels -h 5mm --surface 'label_1|outside' two.nii.gz > skin.tsv
    voxels -h 5mm --surface 'label_1|label_2' -o inner.tsv two.nii.gz
    cmp <(sort one.tsv) <(sort skin.tsv inner.tsv)
    phantom sphere > sphere.nii.gz
    voxels -h 4mm --surface 'label_1|outside' --gap 2mm sphere.nii.gz > gap.tsv
    near "$(volume gap.tsv)" 73.6 0.02 # of a sphere of 26 mm
    voxels -h 4mm --surface 'label_1|outside' sphere.nii.gz > touching.tsv
    paste gap.tsv touching.tsv | awk '{
        for (k = 1; k < 9; k += 3) {
            d = sqrt(($k - $(k + 9)) ^ 2 + ($(k + 1) - $(k + 10)) ^ 2 + ($(k + 2) - $(k + 11)) ^ 2)
            if (!(d > 1.99e-3 && d < 2.2e-3)) exit 1
        }
    }'
    phantom two@slice > slice.nii.gz
    voxels -h 4mm --surface label_2 slice.nii.gz > curve.tsv
    [ "$(head -n 1 curve.tsv)" = "$(tail -n 1 curve.tsv)" ]
    voxels -h 4mm --surface 'label_2|label_1' slice.nii.gz | awk 'NF == 0 { exit 1 }' # one curve, in one piece
    refused 2 "no label 'skull'" voxels -h 5mm --surface skull two.nii.gz
    refused 2 "no label 'skull'" voxels -h 5mm --surface 'label_1|skull' two.nii.gz
    refused 2 "these labels do not touch" voxels -h 5mm --surface 'label_1|label_1' two.nii.gz
    refused 2 "--gap goes with --surface" voxels -h 5mm --gap 1mm two.nii.gz
    refused 2 "--surface goes without -t" voxels -h 5mm -t --surface label_1 two.nii.gz

    { block quasi-static | sed 's/dim = 2/dim = 3/; s/= body/= label_1/'
        printf '[displacement held]\nfacets = held\ncomponents = 0, 0, 0.001\n'
        printf '[contact skull]\nfacets = label_1|outside\nrigid = gap.tsv\nunit = m\nside = back\n'; } > slide.scene
    # A body with a furrow narrower than twice the gap moves freely in it, where the surface is set nearer.
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
x, y, z = np.mgrid[:44, :40, :30]
label = (x > 5) & (x < 38) & (y > 5) & (y < 34) & (z > 5) & (z < 24) & ~((abs(x - 22) < 4) & (z > 11))
image = nib.Nifti1Image(label.astype(np.uint8), np.eye(4))
image.header.set_xyzt_units("mm")
nib.save(image, "furrow.nii")
END
    voxels -h 4mm --surface label_1 --gap 6mm furrow.nii > gap.tsv 2> said
    grep -qE "^voxels: --gap: [0-9]+ nodes are moved by less, the first at \([-0-9., ]+\) m: " said
    voxels -h 4mm furrow.nii | tag -f held=low:z,20% > body.mts 2> said
    shapefn body.mts 2> said.shapefn | mtled slide.scene > u.dat
}

@test "images and masks on one grid are joined, later ones on top; another grid is refused" {
    phantom two > two.nii.gz
    phantom sphere 1 2 > sphere.nii.gz
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
image = nib.load("two.nii.gz")
value = np.asarray(image.dataobj)
def save(name, value):
    nib.save(nib.Nifti1Image(value, None, image.header), name)
for name, values in dict(none=0 * value, half=value / 2, far=value * 3e9, low=value * (value == 1)).items(): save(name + ".nii", values)
save("mask.nii", 7 * (value == 2).astype(np.int16))
save("whole.nii", value + (value == 2))
END
    cmp <(voxels -h 6mm low.nii 3=mask.nii | mts print cells.region) <(voxels -h 6mm whole.nii | mts print cells.region)
    voxels -h 6mm whole.nii 9=none.nii 2> said | mts print cells.region | cmp <(voxels -h 6mm whole.nii | mts print cells.region)
    grep -qx "voxels: 9=none.nii: all voxels are 0: nothing of it lies on top" said
    refused 2 "half.nii: voxel " voxels -h 6mm low.nii half.nii
    refused 2 "labels are whole numbers from 0 to 2147483647" voxels -h 6mm low.nii far.nii
    refused 2 "sphere.nii.gz: another grid than that of the first image: resample it" voxels -h 6mm low.nii sphere.nii.gz
}

@test "pairs of .hdr and .img are read; what a pair does not prove is refused" {
    phantom two > two.nii.gz
    voxels -h 6mm two.nii.gz > one.mts
    /usr/bin/python3 -c 'import nibabel as nib; nib.save(nib.Nifti1Pair.from_image(nib.load("two.nii.gz")), "two.img")'
    cmp <(mts print nodes.x one.mts) <(voxels -h 6mm two.hdr | mts print nodes.x)
    gzip -k two.hdr two.img
    cmp <(mts print nodes.x one.mts) <(voxels -h 6mm two.hdr.gz | mts print nodes.x)
    refused 2 "two.img: is no image of NIfTI, NRRD or MetaImage: save it as .nii.gz; of a pair give the header's file" voxels -h 6mm two.img
    refused 2 "standard input: is a header whose data are in a file of their own" voxels -h 6mm - < two.hdr
    printf x >> two.img
    refused 2 "two.hdr: its data, two.img: more data than " voxels -h 6mm two.hdr
    rm two.img
    refused 2 "two.hdr: its data, two.img: No such file" voxels -h 6mm two.hdr
}

@test "labels rounded by a scaling or to single precision are whole; others are refused with their digits" {
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
value = np.zeros((20, 20, 20))
value[2:18, 2:18, 2:18], value[6:12, 6:12, 6:12] = 1, 4
def save(name, value, dtype):
    image = nib.Nifti1Image(value, np.eye(4))
    image.header.set_xyzt_units("mm")
    image.set_data_dtype(dtype)
    nib.save(image, name)
save("whole.nii", value, np.float64)
for name in "uint8", "int16":
    save(name + ".nii", value.astype(np.float32), np.dtype(name))  # scaled: 1.004, 1.00002
save("single.nii", np.nextafter(value.astype(np.float32), np.float32(9)), np.float32)
save("other.nii", value + 1.5e-5, np.float32)
END
    voxels -h 3mm whole.nii > whole.mts
    for kind in uint8 int16 single; do
        cmp <(mts print nodes.x whole.mts) <(voxels -h 3mm $kind.nii | mts print nodes.x)
    done
    refused 2 "voxel 0 0 0 is 1.499999962e-05: labels are whole" voxels -h 3mm other.nii
}

@test "images that are none of labels, impossible sizes, and tables: one clear line" {
    phantom sphere@scan > scan.nii.gz
    refused 2 "labels are whole numbers from 0 to 2147483647: is it a scan" voxels -h 6mm scan.nii.gz
    phantom sphere@rgb > rgb.nii.gz
    refused 2 "3 values at each voxel: not a label image" voxels -h 6mm rgb.nii.gz
    phantom sphere@empty > empty.nii.gz
    refused 2 "all voxels are 0: no label" voxels -h 6mm empty.nii.gz
    phantom sphere@metres > metres.nii.gz
    refused 2 "the labels are 83.1 m across: give the unit of the file's lengths, as -u mm" voxels -h 6mm metres.nii.gz
    phantom sphere > sphere.nii.gz
    voxels -h 6mm -u mm metres.nii.gz 2> said | cmp <(mts print cells) <(voxels -h 6mm sphere.nii.gz | mts print cells)
    refused 2 "the spacing is missing: give -h LENGTH" voxels sphere.nii.gz
    refused 2 "-h: ' mm' is none of m, cm, mm, um" voxels -h '6 mm' sphere.nii.gz
    refused 2 "lattice points over the labels: larger" voxels -h 6um sphere.nii.gz
    refused 2 "no lattice point lies in a label: smaller" voxels -h 6m sphere.nii.gz
    refused 2 "smaller? -h 5 is 5 m: give a unit, as -h 5mm" voxels -h 5 sphere.nii.gz
    refused 2 "missing.nii.gz" voxels -h 6mm missing.nii.gz
    head -c 2000 sphere.nii.gz > cut.nii.gz
    refused 2 "cut.nii.gz: " voxels -h 6mm cut.nii.gz

    while IFS='=' read -r rows message; do
        printf "$rows" > table
        refused 2 "$message" voxels -h 6mm -l table sphere.nii.gz
    done << 'END'
2 other\n=table: no row for label 1
1 body\n2 other\n='other' is empty: no voxel has a label of that name
1 -\n=the table keeps no label
1 body\n1-3 other\n=table:2: label 1 stands in another row already
1\n=table:1: a row is LABELS NAME
1 body of water\n=table:1: a row is LABELS NAME
1 outside\n=table:1: 'outside' is what no label names
1 a|b\n=table:1: 'a|b': no commas
3-1 body\n=table:1: label: 1 is not within
x body\n=table:1: label: 'x'
1 body\n2 body -\n=table:2: 'body' is kept in one row and left out in another
* body\n* other\n=table:2: a second row for all other labels
# nothing\n=table: names no label
1 body=table:1:
END
    seq 30001 | sed 's/$/ body/' > table
    refused 2 "table:30001: more than 30000 labels" voxels -h 6mm -l table sphere.nii.gz
}
