"""How the force on the pressed block depends on the stiffness of its lump: a parameter study, with a plot by gnuplot.

From the top of the repository: PYTHONPATH=tools/python python3 examples/block/study.py [PICTURE.png]
"""

import os
import subprocess
import sys
import tempfile

import mtled

here = os.path.dirname(os.path.abspath(__file__))
picture = sys.argv[1] if len(sys.argv) > 1 else "study.png"
scene = open(os.path.join(here, "block.scene")).read()

with tempfile.TemporaryDirectory() as folder:
    mesh, varied = os.path.join(folder, "block.msh"), os.path.join(folder, "varied.scene")
    subprocess.run(["gmsh", "-2", "-v", "1", os.path.join(here, "block.geo"), "-o", mesh], check=True)
    table = mtled.pipe("nodes", "-u", "mm", mesh).shapefn().read()  # once for all scenes
    rows = []
    for stiffness in (1000, 3000, 9000, 27000, 81000):
        with open(varied, "w") as file:
            file.write(scene.replace("E = 9000", f"E = {stiffness}"))
        result = mtled.pipe(table).mtled(varied).read()
        force = result["reactions"][result["reactions"].names.index("bottom")][1]
        rows.append(f"{stiffness} {force:.4f}")
        print(f"lump of {stiffness / 1000:g} kPa: {force:.2f} {result['reactions'].unit}")

plot = f"set terminal pngcairo; set output '{picture}'; set logscale x; set xlabel 'E of the lump, Pa'; set ylabel 'force, N/m'; "
subprocess.run(["gnuplot", "-e", plot + "plot '-' with linespoints notitle"], input="\n".join(rows) + "\ne\n", text=True, check=True)
