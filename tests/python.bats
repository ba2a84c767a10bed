# The Python package: streams as arrays, the programs in a pipe, other packages' objects.

load common.bash

setup() {
    enter
    export PYTHONPATH=$top/tools/python PYTHONDONTWRITEBYTECODE=1 MTLED_BIN=$BUILD/bin
    pressed_block > block.scene
    printf '[output]\nreactions = yes\n' >> block.scene
    cloud -d 2 -k jittered -n 5 --box 0,0.1,0,0.1 --jitter 0.2 > cloud.mts
}

python() { /usr/bin/python3 -c "import mtled, numpy as np
$1"; }

@test "read and write: every section as mts prints it, both forms whole and to the bit; written again the same" {
    shapefn cloud.mts 2> note | mtled block.scene > u.dat
    mts binary u.dat > u.mts
    python 'a, b = mtled.read("u.dat"), mtled.read("u.mts")
assert list(a) == list(b) and all(a[k].tobytes() == b[k].tobytes() and a[k].attrs == b[k].attrs for k in a)
assert a["u"].unit == "m" and a["u"].columns == ["x", "y"] and a["reactions"].names == ["bottom", "top"]
assert a.mask("cells.region", "body").all() and a["facets.set"].dtype == np.int32
mtled.write(a, "again.mts"); mtled.write(b, "again.dat", text=True)
mtled.write({"u": a["u"][:0], "k": np.arange(3)}, "small.mts")'
    for stream in again.mts again.dat small.mts; do mts check $stream; done
    cmp <(bare u.dat) <(bare again.dat)
    cmp <(bare u.dat) <(mts text again.mts | bare)
    [ "$(mts list small.mts | cut -f 1-4 | xargs)" = "u f8 0 2 k i8 3 1" ]
}

@test "half a stream, a flipped bit and what is none are refused" {
    shapefn cloud.mts 2> note | mtled block.scene > u.dat
    mts binary u.dat > u.mts
    python 'text, binary = open("u.dat", "rb").read(), open("u.mts", "rb").read()
def refused(data):
    try:
        mtled.read(data)
    except mtled.StreamError:
        return True
for data in (text, binary):
    assert all(refused(data[:cut]) for cut in range(0, len(data) - 1, 37))
assert all(refused(binary[:k] + bytes([binary[k] ^ 4]) + binary[k + 1:]) for k in range(0, len(binary), 41))
assert refused(text.replace(b"\n0 1 ", b"\n0 1 1 ", 1)) or b"\n0 1 " not in text
for bad in ({"end": np.zeros(2)}, {"u": np.zeros((2, 2, 2))}, {"u": np.array(["a"])}, {"u": mtled.Array(np.zeros(1), unit="a b")}):
    try:
        mtled.write(bad)
        raise SystemExit(1)
    except mtled.StreamError:
        pass'
}

@test "the pipe: the bytes of the shell's; a program that fails raises with its own line" {
    ipoints cloud.mts | support | shapefn | mtled block.scene > shell.dat
    python 'line = mtled.pipe("ipoints", "cloud.mts").support().shapefn()
line.mtled("block.scene").save("python.dat")
result = line.mtled("block.scene").read()
assert (result["u"] == mtled.pipe(line.read()).mtled("block.scene").read()["u"]).all()
notes = []
mtled.pipe("shapefn", "cloud.mts").mtled("block.scene").run(notes.append)
assert any("ran with defaults" in note for note in notes)'
    cmp shell.dat python.dat
    run -1 --separate-stderr python 'mtled.pipe("nodes", "-u", "mm", "none.msh").shapefn().mtled("block.scene").save("no.dat")'
    [ "${stderr_lines[-1]}" = "mtled.pipe.ToolError: nodes: none.msh: No such file or directory" ]
    run -1 --separate-stderr python 'mtled.pipe("shapefn", "cloud.mts").mtled("none.scene").read()'
    [ "${stderr_lines[-1]}" = "mtled.pipe.ToolError: mtled: none.scene: No such file or directory" ]
    [ -z "$(find . -name 'no.dat*')" ]
}

@test "meshio and VTK: cells, groups by name, the displacement, the deformed body" {
    shapefn cloud.mts 2> note | mtled block.scene > u.dat
    python 's = mtled.read("u.dat")
mesh, grid = s.to_meshio(), s.to_vtk(deformed=True)
assert len(mesh.cells_dict["triangle"]) == len(s["cells"]) == grid.GetNumberOfCells()
assert {"body", "ymin", "ymax"} <= set(mesh.field_data) and (mesh.point_data["u"][:, :2] == s["u"]).all()
ymax = mesh.cell_data_dict["gmsh:physical"]["line"] == mesh.field_data["ymax"][0]
assert (mesh.points[mesh.cells_dict["line"][ymax]][:, :, 1] == .1).all()
assert abs(grid.GetBounds()[3] - (s["nodes.x"] + s["u"])[:, 1].max()) < 1e-12
mesh.write("u.msh", file_format="gmsh22", binary=False)'
    nodes -u m u.msh > back.mts 2> note
    cmp <(mts print cells u.dat) <(mts print cells back.mts)
    [[ "$(mts list back.mts)" == *ymax* ]]
}

@test "the lines of README.md" {
    mkdir build
    ln -s "$top/examples" .
    gmsh -2 -v 1 examples/block/block.geo -o build/block.msh
    awk '/^```/ { on = $0 == "```python"; next } on' "$top/README.md" > lines.py
    [[ $(/usr/bin/python3 lines.py) == 0.00[34]*" m ['bottom', 'top']" ]]
}

@test "the parameter study of the examples: forces that grow, a picture" {
    /usr/bin/python3 "$top/examples/block/study.py" study.png > said
    awk '{ if (!($5 > last)) exit bad = 1; last = $5 } END { exit bad || NR != 5 }' said
    [ "$(head -c 4 study.png | tail -c 3)" = PNG ]
}
