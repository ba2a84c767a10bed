"""Images for the tests, made and read by nibabel, apart from the programs' own reader.

nifti.py smooth FILE [WAY]     the test image of smooth waves around a cube of 60 mm, 76 x 76 x 76 voxels of 1 mm; WAY: oblique
                               (anisotropic, turned, left-handed), swapped (axes in another order and direction), coarse
nifti.py ball FILE             labels: a ball of 20 mm radius, 2, and within 14 mm 5, in that cube; the axes turned
nifti.py step FILE LOW HIGH    a slice around a square of 100 mm: LOW where x < 50 mm, else HIGH
nifti.py same A B TOLERANCE    fails unless the values agree to TOLERANCE and type, size and places are equal
nifti.py moved SCAN RESULT     rms error of the moved test image, and that of the interpolation alone, inside the cube
nifti.py fields TO BACK        largest distance from x of the place that TO and then BACK lead to, in voxels, inside the cube
nifti.py volumes FILE          label and ml
nifti.py change IN OUT WHAT    OUT: IN as int16 scaled, as RGB, with a NaN, a middle slice, elsewhere
nifti.py segments IN OUT LAYERS NAME...   labels as 3D Slicer writes a segmentation; in 2 layers the first segment overlaps the second
nifti.py value FILE I J K ...   the values of voxels, a line each
nifti.py raw < LINES           1.nii, 2.nii, ...: 3 x 2 x 2 voxels, as each line says: type=, version=2, order=> (bytes), first= (value), more=
                               (bytes), and FIELD= or FIELD.INDEX= of the header, whatever sense that makes; 1.txt: the values
"""

import gzip
import sys

import nibabel as nib
import numpy as np

SIDE = 0.06


def displacement(x):
    """The field that the tests' bodies are moved by, m, at x, m: it vanishes at the sides of the cube."""
    s = np.clip(x / SIDE, 0, 1)
    bump = np.prod(np.sin(np.pi * s), axis=-1)
    return 0.004 * np.stack([0.3 * bump, -0.5 * bump * np.cos(2 * s[..., 0]), -bump], axis=-1)


def reference(x):
    """The place that moves to x."""
    place = x.copy()
    for _ in range(25):  # each leaves less than a quarter of what is missing
        place = x - displacement(place)
    return place


def scan(x):
    return 100 + 50 * np.sin(300 * x[..., 0]) * np.cos(200 * x[..., 1] + 1) + 30 * np.sin(250 * x[..., 2])


def places(image):
    """World places of the voxels, m."""
    index = np.stack(np.meshgrid(*[np.arange(n) for n in image.shape[:3]], indexing="ij"), axis=-1)
    return (index @ image.affine[:3, :3].T + image.affine[:3, 3]) * 1e-3


def inside(x, margin=0.002):
    return np.all((x > margin) & (x < SIDE - margin), axis=-1)


def make(path, values, affine):
    image = nib.Nifti1Image(values, affine)
    image.header.set_xyzt_units("mm")
    image.set_qform(affine, 1)
    image.set_sform(affine, 1)
    nib.save(image, path)


def grid(way):
    affine = np.eye(4)
    affine[:3, 3] = -8
    size = (76, 76, 76)
    if way == "coarse":
        affine[:3, :3] *= 2
        size = (38, 38, 38)
    if way in ("oblique", "turned"):
        c, s = np.cos(0.4), np.sin(0.4)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        size = (90, 60, 110) if way == "oblique" else (77, 77, 77)
        affine[:3, :3] = turn @ np.diag([-1.2, 1.9, 0.9] if way == "oblique" else [1, 1, 1])
        affine[:3, 3] = 30 - affine[:3, :3] @ (np.array(size) / 2)
    return size, affine


def cube_image(way=""):
    size, affine = grid(way)
    return nib.Nifti1Image(np.zeros(size, np.float32), affine)


def smooth(path, way=""):
    image = cube_image(way)
    values = scan(places(image)).astype(np.float32)
    affine = image.affine
    if way == "swapped":  # k, -i, j
        affine = affine @ np.array([[0, -1.0, 0, values.shape[0] - 1], [0, 0, 1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
        values = np.ascontiguousarray(values.transpose(2, 0, 1)[:, ::-1, :])
    make(path, values, affine)


def ball(path):
    image = cube_image("turned")
    radius = np.linalg.norm(places(image) - SIDE / 2, axis=-1)
    make(path, (2 * (radius < 0.02) + 3 * (radius < 0.014)).astype(np.int16), image.affine)


def step(path, low, high):
    affine = np.eye(4)
    affine[:3, 3] = -5.5, -5.5, 7
    values = np.full((111, 111, 1), float(low), np.float32)
    values[56:] = float(high)
    make(path, values, affine)


def same(first, second, tolerance):
    a, b = nib.load(first), nib.load(second)
    if a.shape != b.shape or a.get_data_dtype() != b.get_data_dtype():
        sys.exit(f"{a.shape} {a.get_data_dtype()}, {b.shape} {b.get_data_dtype()}")
    if not np.allclose(a.affine, b.affine, rtol=0, atol=1e-5):
        sys.exit("other places")
    x, y = np.asarray(a.dataobj), np.asarray(b.dataobj)
    if x.dtype.fields:
        x, y = (np.stack([v[n] for n in "RGB"]).astype(int) for v in (x, y))
    if not np.allclose(x, y, rtol=0, atol=float(tolerance), equal_nan=True):
        sys.exit(f"differ by {np.nanmax(np.abs(x - y.astype(float)))}")


def trilinear(values, v):
    low = np.clip(np.floor(v).astype(int), 0, np.array(values.shape[:3]) - 2)
    t = v - low
    total = 0
    for corner in range(8):
        bits = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        weight = np.prod(np.where(bits == 1, t, 1 - t), axis=-1)
        index = low + bits
        value = values[index[..., 0], index[..., 1], index[..., 2]]
        total = total + (weight if value.ndim == weight.ndim else weight[..., None]) * value
    return total


def to_voxels(image, x):
    inverse = np.linalg.inv(image.affine)
    return x * 1e3 @ inverse[:3, :3].T + inverse[:3, 3]


def moved(source, result):
    a, b = nib.load(source), nib.load(result)
    x = places(b)
    within = inside(x)
    place = reference(x[within])
    exact, best = scan(place), trilinear(a.get_fdata(), to_voxels(a, place))
    print("%.6g %.6g" % tuple(np.sqrt(np.mean((v - exact) ** 2)) for v in (b.get_fdata()[within], best)))


def fields(to, back):
    a, b = nib.load(to), nib.load(back)
    assert a.header["dim"].tolist() == [5, *a.shape[:3], 1, 3, 1, 1] and a.header["intent_code"] == 1007
    assert a.get_data_dtype() == np.float32
    ras = np.array([-1e-3, -1e-3, 1e-3])
    x = places(a)
    within = inside(x)
    x = x[within]
    first = x + a.get_fdata()[:, :, :, 0][within] * ras
    second = first + trilinear(b.get_fdata()[:, :, :, 0], to_voxels(b, first)) * ras
    error = np.linalg.norm((second - x) @ np.linalg.inv(a.affine)[:3, :3].T * 1e3, axis=-1)
    place = np.linalg.norm(first - reference(x), axis=-1) * 1e3
    print("%.6g %.6g" % (error.max(), place.max()))


def volumes(path):
    image = nib.load(path)
    labels, counts = np.unique(np.asarray(image.dataobj), return_counts=True)
    for label, count in zip(labels, counts):
        print(label, count * abs(np.linalg.det(image.affine[:3, :3])) * 1e-3)


def change(source, path, what):
    a = nib.load(source)
    values = a.get_fdata()
    if what == "scaled":  # nibabel scales when it writes: the stored numbers are put in as they are
        header = nib.Nifti1Image(values.astype(np.int16), a.affine, a.header).header
        header.set_data_dtype(np.int16)
        header.set_xyzt_units("mm")
        header["scl_slope"], header["scl_inter"], header["vox_offset"] = 0.25, 3, 352
        with open(path, "wb") as file:
            file.write(header.binaryblock + b"\0\0\0\0" + np.round(values * 4).astype("<i2").tobytes(order="F"))
        return
    if what == "rgb":
        colours = np.zeros(values.shape, dtype=[("R", "u1"), ("G", "u1"), ("B", "u1")])
        for name, factor in zip("RGB", (1, 0.5, 0.25)):
            colours[name] = np.clip(values * factor, 0, 255)
        image = nib.Nifti1Image(colours, a.affine)
    elif what == "nan":
        values[38, 38, 38] = np.nan
        image = nib.Nifti1Image(values.astype(np.float32), a.affine)
    elif what == "slice":
        image = nib.Nifti1Image(values[:, :, 38:39].astype(np.float32), a.affine)
    elif what == "sagittal":
        image = nib.Nifti1Image(values[38:39].astype(np.float32), a.affine)
    elif what == "coronal":
        image = nib.Nifti1Image(values[:, 38, :, None].astype(np.float32), a.affine[:, [0, 2, 1, 3]])
    elif what == "far":
        shift = np.eye(4)
        shift[:3, 3] = 500
        image = nib.Nifti1Image(values.astype(np.float32), shift @ a.affine)
    else:
        sys.exit(f"no change '{what}'")
    image.header.set_xyzt_units("mm")
    nib.save(image, path)


def segments(source, path, layers, *names):
    a, layers = nib.load(source), int(layers)
    labels = np.asarray(a.dataobj).astype(np.uint8)
    numbers = np.unique(labels)[1:]
    data = np.zeros((layers, *labels.shape), np.uint8)
    head = []
    for s, number in enumerate(numbers):
        layer, value = (s % 2, s // 2 + 1) if layers == 2 else (0, number)
        data[layer][labels == number] = value
        pairs = {"ID": f"id{s}", "Name": names[s], "LabelValue": value, "Layer": layer, "Color": "1 0 0", "Extent": "0 9 0 9 0 9"}
        head += [f"Segment{s}_{key}:={pair}" for key, pair in pairs.items()]
    if layers == 2:
        data[0][:50][labels[:50] == numbers[1]] = 1
        print(np.sum(labels[:50] == numbers[1]))
    lps = np.diag([-1, -1, 1]) @ a.affine[:3]
    columns = ["(%.17g,%.17g,%.17g)" % tuple(lps[:, c]) for c in range(4)]
    first = (["list"], ["none"], [layers]) if layers == 2 else ([], [], [])
    head = ["NRRD0004", "type: unsigned char", f"dimension: {3 + len(first[0])}", "space: left-posterior-superior",
            "sizes: " + " ".join(map(str, first[2] + list(labels.shape))), "space directions: " + " ".join(first[1] + columns[:3]),
            "kinds: " + " ".join(first[0] + ["domain"] * 3), "encoding: gzip", "space origin: " + columns[3],
            "Segmentation_MasterRepresentation:=Binary labelmap", *head, "", ""]
    with open(path, "wb") as file:
        file.write("\n".join(head).encode() + gzip.compress((data if layers == 2 else data[0]).tobytes("F")))


def value(path, *voxels):
    image = nib.load(path)
    values = image.get_fdata()
    values = values.reshape(values.shape + (1,) * (3 - values.ndim))
    for voxel in range(0, len(voxels), 3):
        print(*["%.9g" % v for v in np.atleast_1d(values[tuple(map(int, voxels[voxel : voxel + 3]))]).ravel()])


def raw():
    for line, text in enumerate(sys.stdin, 1):
        given = dict(word.split("=") for word in text.split())
        kind = nib.Nifti2Header if given.pop("version", 1) == "2" else nib.Nifti1Header
        header, dtype = kind(endianness=given.pop("order", "<")), np.dtype(given.pop("type", "int16"))
        ends = np.finfo(dtype) if dtype.kind == "f" else np.iinfo(dtype)
        least, most = (ends.tiny, ends.max) if dtype.kind == "f" else (max(ends.min, -(2**53)), min(ends.max, 2**53))
        values = np.array([least, most, 0, 1, 2, 100, 7, 3, 11, 5, 120, 9], dtype)
        values[0] = dtype.type(given.pop("first", values[0]))
        more = int(given.pop("more", 0))
        header.set_data_dtype(dtype)
        header.set_data_shape((3, 2, 2))
        header["xyzt_units"], header["vox_offset"] = 2, header.single_vox_offset
        for field, number in given.items():
            name, _, index = field.partition(".")
            number = number if header[name].dtype.kind == "S" else int(number) if number.lstrip("-").isdigit() else float(number)
            header[name] = number if index == "" else [*header[name][: int(index)], number, *header[name][int(index) + 1 :]]
        data = header.binaryblock + bytes(4) + values.astype(header.get_data_dtype() if "datatype" not in given else dtype).tobytes()
        with open(f"{line}.nii", "wb") as file:
            file.write(data[: len(data) + more] if more < 0 else data + bytes(more))
        np.savetxt(f"{line}.txt", values.astype(float), "%.17g")


if __name__ == "__main__":
    {"smooth": smooth, "ball": ball, "step": step, "same": same, "moved": moved, "fields": fields, "volumes": volumes,
     "change": change, "segments": segments, "value": value, "raw": raw}[sys.argv[1]](*sys.argv[2:])
