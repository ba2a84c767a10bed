"""Read vtu files as those do who look at them: by VTK, as ParaView does, and by meshio.

vtu.py arrays FILE             name, points|cells|field, components and names of each array; VTK and meshio must agree on all
vtu.py values FILE NAME        the rows of an array, by VTK
vtu.py largest FILE NAME       the largest eigenvalue of a tensor of cells, as vtkTensorGlyph colours its glyphs
"""

import sys

try:
    import meshio
    import numpy as np
    import vtkmodules.vtkCommonCore
except ImportError as missing:
    sys.exit(f"vtu.py: {missing}: please install python3-vtk9 and python3-meshio (make deps)")
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkFiltersCore import vtkCellCenters, vtkTensorGlyph
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


def read(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    if reader.GetErrorCode() != 0:
        sys.exit(f"{path}: VTK: error {reader.GetErrorCode()}")
    return reader.GetOutput()


def arrays(data):
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)  # None for strings, which meshio cannot read either
        yield array.GetName(), array


def same(what, vtk_array, other):
    mine = vtk_to_numpy(vtk_array)
    if mine.size != other.size or not np.array_equal(mine.ravel(), other.ravel(), equal_nan=True):
        sys.exit(f"{what}: VTK and meshio differ")


def list_arrays(path):
    grid, mesh = read(path), meshio.read(path, file_format="vtu")
    same("points", grid.GetPoints().GetData(), mesh.points)
    nodes = np.concatenate([block.data.ravel() for block in mesh.cells])
    same("cells", grid.GetCells().GetConnectivityArray(), nodes)
    kinds = [
        ("points", grid.GetPointData(), mesh.point_data),
        ("cells", grid.GetCellData(), {k: np.concatenate(v) for k, v in mesh.cell_data.items()}),
        ("field", grid.GetFieldData(), mesh.field_data),
    ]
    for kind, data, other in kinds:
        if data.GetNumberOfArrays() != len(other):
            sys.exit(f"{path}: VTK has {data.GetNumberOfArrays()} arrays of {kind}, meshio {len(other)}")
        for name, array in arrays(data):
            same(name, array, np.asarray(other[name]))
            columns = range(array.GetNumberOfComponents())
            print(name, kind, len(columns), *(array.GetComponentName(c) or "-" for c in columns))


def find(path, name):
    grid = read(path)
    for data in (grid.GetPointData(), grid.GetCellData(), grid.GetFieldData()):
        if data.GetArray(name) is not None:
            return data.GetArray(name)
    sys.exit(f"{path}: no array {name}")


def largest_eigenvalues(path, name):
    centres, glyph = vtkCellCenters(), vtkTensorGlyph()
    sphere = vtkSphereSource()
    sphere.SetThetaResolution(3)
    sphere.SetPhiResolution(3)
    sphere.Update()
    centres.SetInputData(read(path))
    glyph.SetInputConnection(centres.GetOutputPort())
    glyph.SetSourceConnection(sphere.GetOutputPort())
    glyph.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, name)
    glyph.ExtractEigenvaluesOn()
    glyph.ColorGlyphsOn()
    glyph.SetColorModeToEigenvalues()
    glyph.Update()
    values = vtk_to_numpy(glyph.GetOutput().GetPointData().GetScalars())
    return values[:: sphere.GetOutput().GetNumberOfPoints()]  # one of each glyph


def main(command, path, name=None):
    if command == "arrays":
        list_arrays(path)
    elif command == "values":
        for row in vtk_to_numpy(find(path, name)).reshape(find(path, name).GetNumberOfTuples(), -1):
            print(*(repr(value.item()) for value in row))
    elif command == "largest":
        for value in largest_eigenvalues(path, name):
            print(repr(value.item()))
    else:
        sys.exit(__doc__)


main(*sys.argv[1:])
