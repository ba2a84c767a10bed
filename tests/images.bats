# Images: NIfTI as nibabel makes it, of every type, version and byte order, NRRD and MetaImage written out; what the header says is what sample
# finds, and files that are not what they say are refused.

load common.bash

setup() {
    enter_loosely
    for v in {0..11}; do echo "$((v % 3)) $((v / 3 % 2)) $((v / 6))"; done > voxels
}

# values FILE [PLACES]: at places in mm, those of the voxels of `raw`; notes into said
values() { sample -i nearest -u mm -p "${2:-voxels}" "$1" 2> said | awk '!/^#/ { print $4 }'; }

# kinds: lines for raw, 20 of them, of all types, in either version and order
kinds() {
    for type in {,u}int{8,16,32,64} float{32,64}; do printf '%s\n' "type=$type" "type=$type version=2 order=>"; done
}

@test "NIfTI: every type, version and byte order, plain or compressed" {
    kinds | nifti raw
    for ((i = 1; i <= 20; i++)); do
        values $i.nii | cmp - $i.txt
        gzip -c $i.nii | values - | cmp - $i.txt
    done
    echo 'type=int64 first=1152921504606846977' | nifti raw
    refused 2 'beyond 2^53' sample -p voxels 1.nii
}

@test "written in each format and read again: type, values, version and places stay, to nibabel as well" {
    cloud -d 3 -k regular -n 3 --box 0,0.002,0,0.002,0,0.002 > cube.mts
    with_section cube.mts u f8 <(yes '0 0 0' | head -n 27) > still.mts
    { kinds | sed 's/$/ sform_code=2 srow_x.0=-.6 srow_x.1=.8 srow_x.3=1 srow_y.0=.8 srow_y.1=.6 srow_z.2=2 intent_code=1002 intent_name=what/'
        echo 'qform_code=3'; } | sed 's/$/ descrip=by_hand/' | nifti raw
    for ((i = 1; i <= 21; i++)); do
        for format in $( ((i % 2)) && echo nii.gz mha || echo nii nrrd); do # of both versions
            warp -i nearest -o a.$format $i.nii still.mts 2> note
            warp -i nearest -o $i.$format.nii a.$format still.mts 2> note
        done
    done
    /usr/bin/python3 - << 'END'
import nibabel as nib, numpy as np
for i in range(1, 22):
    a = nib.load(f"{i}.nii")
    for form in ("nii.gz", "mha") if i % 2 else ("nii", "nrrd"):
        b = nib.load(f"{i}.{form}.nii")
        assert b.get_data_dtype() == a.get_data_dtype().newbyteorder("<") and np.array_equal(np.asarray(a.dataobj), np.asarray(b.dataobj)), (i, form)
        # both are of single precision, the second by way of a quaternion
        assert np.allclose(a.affine, b.affine, atol=1e-6) and np.allclose(b.get_qform(), b.affine, atol=1e-3), (i, form)
        assert b.header["descrip"] == b"by_hand", (i, form)
        if form.startswith("nii"):
            assert type(a) == type(b) and b.header["sform_code"] == max(a.header["sform_code"], a.header["qform_code"]), (i, form)
            assert all(a.header[key] == b.header[key] for key in ("intent_code", "intent_name")), (i, form)
END
    # Between voxels, what the type cannot hold becomes the nearest that it can.
    sed '/^# u /,$s/^0 0 0/0.00025 0 0/' still.mts > moved.mts
    /usr/bin/python3 -c 'import nibabel as n, numpy as m; a = 255 * m.random.default_rng(1).integers(0, 2, (3, 3, 3))
for t in "uint8", "float64": n.save(n.Nifti1Image(a.astype(t), m.eye(4), dtype=t), t + ".nii")'
    for type in uint8 float64; do warp -i cubic -o $type.moved.nii $type.nii moved.mts 2> note; done
    /usr/bin/python3 -c 'import nibabel as n, numpy as m
a, b = (n.load(t + ".moved.nii").get_fdata() for t in ("uint8", "float64"))
assert b.min() < -5 and b.max() > 260 and m.array_equal(a, m.clip(m.rint(b), 0, 255)), (a, b)'
}

@test "NIfTI: scaling, and a slope that is none" {
    printf '%s\n' 'scl_slope=.5 scl_inter=-10' 'scl_slope=0 scl_inter=7' 'scl_slope=nan scl_inter=nan' scl_slope=inf | nifti raw
    awk '{ print $1 / 2 - 10 }' 1.txt | cmp - <(values 1.nii)
    for i in 2 3; do values $i.nii | cmp - $i.txt; done
    refused 2 scaling sample -p voxels 4.nii
}

# lie MATRIX [VOXELS]: where they lie, mm, by the rows of a matrix one after the other, as the file places
lie() {
    awk -v m="$1" '{ split(m, a, " ")
        for (r = 0; r < 12; r += 4) printf "%.12g ", a[r + 1] * $1 + a[r + 2] * $2 + a[r + 3] * $3 + a[r + 4]
        print "" }' "${2:-voxels}" > places
}

# finds FILE: the values of 1.txt are those at these places, by linear interpolation; notes into said
finds() {
    sample -u mm -p places "$1" > found 2> said
    awk '!/^#/ { print $4 }' found | paste - 1.txt |
        awk 'NF != 2 || !(($1 - $2) ^ 2 < 1e-6 * (1 + $2 * $2)) { print; bad = 1 } END { exit bad || !NR }'
}

@test "NIfTI: places by sform, before qform, before the sizes of voxels; units" {
    sizes='type=uint8 pixdim.2=2 pixdim.3=3' turned='pixdim.0=-1 qform_code=1 quatern_d=0.70710678118654757 qoffset_x=4 qoffset_y=5 qoffset_z=6'
    sform='sform_code=4 srow_x.1=-2 srow_x.3=10 srow_y.2=3 srow_y.3=20 srow_z.0=-1 srow_z.3=30'
    for version in version=1 'version=2 order=>'; do
        { echo "$sizes"; echo "$sizes $turned"; printf '%s\n' "$sizes $turned $sform xyzt_units="{0,1,2,3}; } | sed "s/^/$version /" | nifti raw
        lie '1 0 0 0 0 2 0 0 0 0 3 0'
        finds 1.nii
        grep -q 'neither sform nor qform' said
        lie '0 -2 0 4 1 0 0 5 0 0 -3 6' # a quarter turn about z, the third axis mirrored
        finds 2.nii
        [ ! -s said ]
        for unit in 3:1 4:1e3 5:1 6:1e-3; do
            lie "$(awk -v u="${unit#*:}" 'BEGIN { print 0, -2 * u, 0, 10 * u, 0, 0, 3 * u, 20 * u, -u, 0, 0, 30 * u }')"
            finds "${unit%:*}.nii"
            grep -q 'sform and qform differ' said
            [ "$(grep -c 'no unit' said)" = $((${unit%:*} == 3)) ]
        done
    done
}

@test "NIfTI: headers that contradict themselves or the data" {
    cat > cases << 'END'
more=-1|cut short: 11 values, the header says 12
more=1|more data than 12 values
bitpix=8|8 bits a voxel, but int16 has 16
datatype=32 bitpix=64|values of type 32
dim.1=-3|size -3 along dimension 1
dim.1=0|size 0 along dimension 1
dim.0=8|8 dimensions
dim.0=1|1 dimensions
dim.0=4 dim.4=20|holds 20 volumes
vox_offset=100|data from byte 100
vox_offset=1048576|cut short: 376 bytes, the header says that data begin at byte 1048576
version=2 dim.1=2147483647 dim.2=2147483647 dim.3=2147483647|more than any memory
version=2 dim.1=2147483647 dim.2=1048576 dim.3=16|cut short
version=2 dim.1=1099511627776 dim.2=1048576 dim.3=16|along dimension 1
END
    cut -d '|' -f 1 cases | nifti raw
    number=0
    while IFS='|' read -r _ message; do refused 2 "$message" sample -p voxels $((++number)).nii; done < cases
}

# cut_at BYTES FILE: so much of it does not pass for the whole
cut_at() {
    head -c "$1" "$2" > cut
    status=0
    sample -u mm -p voxels cut > found 2> said || status=$?
    read -r line < said
    [ $status -eq 2 ] && [[ $line == "sample: cut: "* ]]
}

@test "no part of a file passes for the whole, in any format; no bit of compressed data can be turned unseen" {
    printf '%s\n' 'type=float64 first=0.123456789' | nifti raw
    gzip -nc 1.nii > whole.gz
    printf 'NRRD0004\ntype: double\ndimension: 3\nsizes: 3 2 2\nencoding: raw\nendian: little\n\n' | cat - <(tail -c 96 1.nii) > 1.nrrd
    printf 'NDims = 3\nDimSize = 3 2 2\nTransformMatrix = -1 0 0 0 -1 0 0 0 1\nElementType = MET_DOUBLE\nElementDataFile = LOCAL\n' | cat - <(tail -c 96 1.nii) > 1.mha
    for file in 1.nii whole.gz 1.nrrd 1.mha; do
        values $file | cmp - 1.txt
        for ((at = $(stat -c %s $file) - 1; at >= 0; at -= 13)); do cut_at $at $file; done
    done
    /usr/bin/python3 -c 'data = open("whole.gz", "rb").read()
for bit in range(80, 8 * len(data), 11): open(f"turned.{bit}", "wb").write(data[:bit // 8] + bytes([data[bit // 8] ^ 1 << bit % 8]) + data[bit // 8 + 1:])'
    for file in turned.*; do # behind gzip's own header
        sample -i nearest -u mm -p voxels $file > found 2> said || continue
        tail -n +2 found | awk '{ print $4 }' | cmp - 1.txt && ((++silent < 4)) # a bit that says nothing, between data and checksum
    done
    # Many blocks of random bytes, cut within the checksum; two members, one behind the other, are one file.
    /usr/bin/python3 -c 'import nibabel as n, numpy as m; n.save(n.Nifti1Image(m.random.default_rng(1).integers(0, 256, (100, 100, 10), m.uint8), m.eye(4)), "1.nii")'
    gzip -c 1.nii > many.gz
    for missing in 1 2 3 4 5 6 7 8 9; do cut_at -$missing many.gz; done
    { cat many.gz; printf more; } > more.gz
    refused 2 "more.gz: " sample -p voxels more.gz
    { head -c 1000 1.nii | gzip; tail -c +1001 1.nii | gzip; } > two.gz
    values 1.nii > 1.txt
    for file in many.gz two.gz; do values $file | cmp - 1.txt; done
}

# text FORMAT LINES: the file image, nrrd or mha, of 2 x 2 x 2 values, with these lines in its header
text() {
    case $1 in
    nrrd) printf 'NRRD0005\n# a comment\ntype: short\nencoding: ascii\n%b\n\n1 -2 3 4\n7 20 -30 11\n' "$2" ;;
    mha) printf 'ObjectType = Image\nElementType = MET_SHORT\nBinaryData = False\n%b\nElementDataFile = LOCAL\n1 -2 3 4 7 20 -30 11\n' "$2" ;;
    esac > image
}

@test "NRRD and MetaImage: places, in any space and unit, by any spelling of a field" {
    for v in {0..7}; do echo "$((v % 2)) $((v / 2 % 2)) $((v / 4))"; done > corners
    printf '%s\n' 1 -2 3 4 7 20 -30 11 > 1.txt
    turned='space directions: (0,-2,0) (3,0,0) (0,0,4)\nspace origin: (10,20,30)' three='dimension: 3\nsizes: 2 2 2\nkinds: domain domain domain\n'
    sized='NDims = 3\nDimSize = 2 2 2\n'
    while IFS='|' read -r format lines matrix; do
        lines=${lines//TURNED/$turned}
        text "$format" "$([ "$format" = nrrd ] && echo "$three" || echo "$sized")$lines"
        lie "$matrix" corners
        finds image
        [ "$(grep -c 'taken to be RAS' said)" = "$([[ ${lines,,} == *'space: '* || $format = mha ]] && echo 0 || echo 1)" ]
    done << 'END'
nrrd|space: left-posterior-superior\nTURNED|0 -3 0 -10 2 0 0 -20 0 0 4 30
nrrd|Space: LPS\r\nTURNED\na:=b: 1\r|0 -3 0 -10 2 0 0 -20 0 0 4 30
nrrd|space: las\nspace units: "cm" "mm" "m"\nTURNED|0 -30 0 -100 -2 0 0 20 0 0 4000 30000
nrrd|space: RAS\nTURNED|0 3 0 10 -2 0 0 20 0 0 4 30
nrrd|space dimension: 3\nTURNED|0 3 0 10 -2 0 0 20 0 0 4 30
nrrd|spacings: 2 3 4\nunits: "mm" "" "cm"\naxis mins: 5 6 7|2 0 0 5 0 3 0 6 0 0 40 70
mha|Offset = 10 20 30\nElementSpacing = 2 3 4\nTransformMatrix = 0 -1 0 1 0 0 0 0 1|0 -3 0 -10 2 0 0 -20 0 0 4 30
mha|Position = 10 20 30\nElementSize = 2 3 4\nORIENTATION = 0 -1 0 1 0 0 0 0 1|0 -3 0 -10 2 0 0 -20 0 0 4 30
END
    sed -i 4q corners
    sed -i 4q 1.txt
    text nrrd 'dimension: 2\nsizes: 2 2\nspace: LPS\nspace directions: (2,0,0) (0,0,-3)\nspace origin: (1,2,3)'
    sed -i '$d' image
    lie '-2 0 0 -1 0 0 -2 -2 0 -3 0 3' corners
    finds image
    printf 'NDims = 2\nDimSize = 2 2\nElementType = MET_LONG\nBinaryData = 0\nElementSpacing = 2 3\nOrigin = 1 2\nElementDataFile = LOCAL\n1 -2 3 4' > image
    lie '-2 0 0 -1 0 -3 0 -2 0 0 2 0' corners
    finds image
}

@test "places of an unknown space stay in NIfTI" {
    for v in {0..7}; do echo "$((v % 2)) $((v / 2 % 2)) $((v / 4))"; done > corners
    printf '%s\n' 1 -2 3 4 7 20 -30 11 > 1.txt
    cloud -d 3 -k regular -n 2 --box 0,0.02,0,0.02,0,0.02 | with_section - u f8 <(yes '0 0 0' | head -n 8) > still.mts
    while IFS='|' read -r lines matrix stated; do
        text nrrd "dimension: 3\nsizes: 2 2 2\nkinds: domain domain domain\n$lines"
        warp -o placed.nii image still.mts 2> said
        lie "$matrix" corners
        finds placed.nii
        [ "$(grep -c 'neither sform nor qform' said)" = "$stated" ]
    done << 'END'
space dimension: 3\nspace directions: (0,2,0) (-3,0,0) (0,0,4)\nspace origin: (10,6,7)|0 -3 0 10 2 0 0 6 0 0 4 7|0
spacings: 2 3 4\naxis mins: 5 6 7|2 0 0 5 0 3 0 6 0 0 4 7|0
spacings: 2 3 4|2 0 0 0 0 3 0 0 0 0 4 0|1
END
}

@test "NRRD and MetaImage: vectors of a space turn with it, lists do not; what the header leaves open is noted" {
    while IFS='|' read -r sizes kinds space numbers axis more; do
        [[ $sizes == 3* ]] && before='none ' after='' || before='' after=' none'
        text nrrd "dimension: 4\nsizes: $sizes\n${kinds:+kinds: $kinds\n}space: $space\nspace directions: $before(1,0,0) (0,1,0) (0,0,1)$after${more:+\n$more}"
        sed -i '$d; s/^1 -2 3 4/1 2 3 4 5 6/' image
        [ "$(sample -u mm -p <(echo 0 0 0) image 2> note | awk 'NR == 2 { print $4, $5, $6 }')" = "$numbers" ]
        sample --vector -u mm -p <(echo 0 0 0) image 2> note | awk -v axis="$axis" 'NR == 2 { split(axis, a, " ")
            d = ($4 * a[1] + $5 * a[2] + $6 * a[3]) / sqrt(a[1]^2 + a[2]^2 + a[3]^2) } END { exit !(d * d > 1 - 1e-12) }'
    done << 'END'
3 2 1 1|vector domain domain domain|LPS|1 2 3|-1 -2 3
3 2 1 1|3-vector domain domain domain|RAS|-1 -2 3|1 2 3
3 2 1 1|covariant-vector space space space|LAS|1 -2 3|-1 2 3
3 2 1 1|vector domain domain domain|RAS|2 -1 3|-2 1 3|measurement frame: (0,1,0) (-1,0,0) (0,0,1)
3 2 1 1|vector domain domain domain|LPS|-2 1 3|2 -1 3|measurement frame: (0,1,0) (-1,0,0) (0,0,1)
3 2 1 1|list domain domain domain|RAS|1 2 3|1 2 3
3 2 1 1||RAS|1 2 3|1 2 3
2 1 1 3|domain domain domain list|RAS|1 3 5|1 3 5
END
    text nrrd 'dimension: 4\nsizes: 3 2 1 1\nkinds: vector domain domain domain\nspace: RAS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)'
    sed -i '$d; s/^1 -2 3 4/1 2 3 4 5 6/; s/short/uchar/' image # unsigned: a colour
    [ "$(sample -p <(echo 0 0 0) image 2> note | awk 'NR == 2 { print $4, $5, $6 }')" = "1 2 3" ]
    while IFS='|' read -r format lines message; do
        text "$format" "$lines"
        sample -p <(echo 0 0 0) image 2>&1 > found | sed 's/^sample: image: //' | cmp - <(printf "${message:+$message\n}")
    done << 'END'
nrrd|dimension: 3\nsizes: 2 2 2\nspace: LPS\nspace orign: (1,2,3)\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nmin: 1\nmin: 1|has no space origin: the first voxel lies at 0; fields that are not known, left out: space orign
mha|NDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\nColor = 1 0 0 1\nOfset = 1 2 3\nElementSizes = 1 1 1|has no Offset: the first voxel lies at 0; fields that are not known, left out: Ofset, ElementSizes
mha|NDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1 9\nOffset = 0 0 0|
END
}

@test "NRRD and MetaImage: headers that contradict themselves or the data" {
    # @n: begins, @t: as text, @s: sizes, @f: the whole header; @m, @e: of MetaImage, and its end
    n='NRRD0005\ntype: short\n' t="${n}encoding: ascii\n" s='dimension: 3\nsizes: 2 1 2\n' f="$t${s}kinds: domain domain domain\n"
    m='NDims = 3\nDimSize = 2 1 2\nElementType = MET_SHORT\nBinaryData = False\n' e='ElementDataFile = LOCAL\n1 -2 3 4'
    while IFS='|' read -r lines message; do
        for key in n t s f m e; do lines=${lines//@$key/${!key}}; done
        printf '%b' "${lines//LONG/$(printf '%0130d' 0)}" > image
        refused 2 "${message//\//|}" sample -p voxels image || { echo "$lines"; false; }
    done << 'END'
@f\n1 2 3|cut short: 3 values, the header says 4
@f\n1 2 3 4 5|more data than 4 values
@f\n1 2 3 4e9|value 3, '4e9': not of the type int16
@f|ends without an empty line
NRRD0009\n\n|NRRD0001 to NRRD0006
@nencoding: bzip2\n\n1|encoding: bzip2: one of these is read: raw gzip/gz ascii/text/txt
@n@sencoding: raw\n\n1|no endian
@n@sencoding: gzip\nendian: little\nbyte skip: -1\n\n|a skip of -1 goes with raw data only
@fbyte skip: 99\n\n1 2 3 4|cut short
@tdimension: 3\nsizes: 2 0 2\n\n|size 0
@tdimension: 3\nsizes: 2 1e8 1e8\n\n|cut short
@tdimension: 3\nsizes: 2e9 2e9 2e9\n\n|more than any memory
NRRD0005\nsizes: 2 1 2\n\n|stands in front of the number of dimensions
@fspace: left-posterior-superior-time\n\n|choose one volume
@fspace directions: (0,-2,0) (3,0,0) (0,0,4)\n\n|space directions
@fspace: LPS\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n\n1 2 3 4|space directions gives the voxels no place
@fspace: LPS\nspace units: "mm" "mm" "ell"\n\n|are read
@tdimension: 4\nsizes: 2 1 2 2\nkinds: domain domain domain domain\n\n1|dimension 4: 
@t@skinds: domain list domain\n\n|dimension 2 holds the values
@t@skinds: vector list domain\n\n|dimension 2: two or three
@fdata file: data.raw\n\n|its data, data.raw: No such file
@fSegment0_Name:=LONG\n\n|a name of more than 127 bytes
@fnonsense\n\n|'nonsense': no ':' behind a key
@m|ends without ElementDataFile
@mElementDataFile = LIST\na\nb\n|several files
@mElementType = MET_STRING\n@e|ElementType= MET_STRING: integers
@mCompressedData = True\nHeaderSize = -1\n@e|a skip of -1 goes with raw data only
@fsizes: 2 2 1\n\n1 -2\n3 4\n|sizes: 2 2 1: stands twice
@mDimSize = 2 2 1\n@e|DimSize= 2 2 1: stands twice
@mBinaryDataByteOrderMSB = True\nElementByteOrderMSB = False\n@e|contradict
@mDistanceUnits = cm\n@e|one of these is read: mm
@mCompressedData = perhaps\n@e|one of these is read
@mElementNumberOfChannels = 0\n@e|from 1 to
ObjectType = Mesh\n|one of these is read: Image
NDims = 3\nElementDataFile = LOCAL\n1|no ElementType
END
}

@test "values between the voxels: the nearest; on to half a voxel beyond the outermost; what is no number spreads no farther than it must" {
    printf '%s sform_code=1 srow_x.0=1 srow_y.1=1 srow_z.2=1\n' type=uint8 'type=float64 first=nan' | nifti raw
    for method in nearest linear cubic; do
        for place in '-0.5 0 0' '2.5 1 1' '1 -0.4 1.5' '0 1.5 0'; do sample -i $method -u mm -p <(echo "$place") 1.nii > found 2> note; done
        for place in '-0.51 0 0' '2.51 1 1' '1 1 1.6' '0 -7 0'; do
            refused 2 'outside of 1.nii' sample -i $method -u mm -p <(echo "$place") 1.nii
        done
        sample -i $method -u mm -p <(printf '%s\n' '-0.4 -0.4 -0.4' '2.4 1.3 1.4') 1.nii 2> note | awk '!/^#/ { print $4 }' |
            cmp - <(sed -n '1p; $p' 1.txt)
    done
    /usr/bin/python3 -c 'import nibabel as n, numpy as m; x, y, z = m.mgrid[:4, :3, :2]
n.save(n.Nifti1Image(x * x - x * y + 2 * y * y + 7.0 * z, m.eye(4)), "quadratic.nii")'
    printf '%s\n' '0.3 0.2 0.5' '2.6 1.7 0.9' '1.5 0.5 0.1' > places
    sample -i cubic -u mm -p places quadratic.nii 2> note | awk '!/^#/ { n++; d = $4 - ($1 * $1 - $1 * $2 + 2 * $2 * $2 + 7 * $3); bad += d * d > 1e-18 } END { exit bad || n != 3 }'
    printf '%s\n' '1.45 0.55 0.45' | values 1.nii /dev/stdin | cmp - <(sed -n 5p 1.txt)
    sample -u mm -p <(echo 1 0 0) 2.nii 2> note | awk 'NR == 2 { large = $4 > 1e300 } END { exit !large }'
    refused 2 'not finite there' sample -u mm -p <(echo 0.5 0 0) 2.nii
}
