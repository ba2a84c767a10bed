"""Streams as objects of other packages: cells and facets, fields at nodes and cells, groups by name."""

import numpy as np

from .stream import StreamError

CELLS = {(2, 3): ("triangle", 5), (3, 4): ("tetra", 10)}
FACETS = {(2, 2): "line", (3, 3): "triangle"}
OF_CELLS = ("cells", "points", "stress", "strain", "pressure", "volume_ratio", "fibre", "J")  # first parts of names, as in tovtk


def _in_space(values):
    """Vectors in the plane with a third component, 0, as the other packages want them."""
    return np.column_stack([values, np.zeros(len(values))]) if values.ndim == 2 and values.shape[1] == 2 else values


def _parts(stream, deformed):
    """Places in 3D (m), the type of the cells, and the fields at nodes and in cells, as arrays."""
    for name in ("nodes.x", "cells") + (("u",) if deformed else ()):
        if name not in stream:
            raise StreamError(f"no section {name}")
    x, cells = np.asarray(stream["nodes.x"]), np.asarray(stream["cells"])
    kind = CELLS.get((x.shape[1], cells.shape[1]))
    if kind is None:
        raise StreamError(f"cells of {cells.shape[1]} nodes in {x.shape[1]} dimensions")
    if deformed:
        x = x + np.asarray(stream["u"])
    places = _in_space(x)
    fields = {name: _in_space(np.asarray(v)) for name, v in stream.items() if v.dtype.kind == "f" and name != "nodes.x"}
    in_cells = {name: v for name, v in fields.items() if len(v) == len(cells) and (len(cells) != len(x) or name.split(".")[0] in OF_CELLS)}
    at_nodes = {name: v for name, v in fields.items() if len(v) == len(x) and name not in in_cells}
    return places, cells, kind, at_nodes, in_cells


def to_meshio(stream, deformed=False):
    """A meshio.Mesh with the cells and, where there are some, the facets; regions and groups of facets as "gmsh:physical" with their
    names in field_data, as meshio writes them for gmsh; fields at the nodes. deformed: nodes at x + u."""
    import meshio

    places, cells, kind, at_nodes, in_cells = _parts(stream, deformed)
    blocks, groups, names = [(kind[0], cells)], [], {}
    dim = stream["nodes.x"].shape[1]
    offset = 1
    for part, group, rank in (("cells", "cells.region", dim), ("facets", "facets.set", dim - 1)):
        if part not in stream or len(stream[part]) == 0:
            continue
        if part == "facets":
            facets = np.asarray(stream[part])
            blocks.append((FACETS[(dim, facets.shape[1])], facets))
        numbers = np.asarray(stream[group]) if group in stream else np.zeros(len(stream[part]), dtype=np.int32)
        groups.append(np.asarray(numbers + offset, dtype=np.int32))
        for number, name in enumerate(stream[group].names if group in stream else []):
            names[name] = np.array([number + offset, rank])
        offset += 1 + (int(numbers.max()) if len(numbers) else 0)
    data = {"gmsh:physical": groups, "gmsh:geometrical": groups}
    if len(blocks) == 1:
        data.update({name: [values] for name, values in in_cells.items()})
    return meshio.Mesh(places, blocks, point_data=at_nodes, cell_data=data, field_data=names)


def to_vtk(stream, deformed=False):
    """A vtkUnstructuredGrid with the cells, their regions (numbers) and the fields at nodes and in cells. deformed: nodes at x + u."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid

    places, cells, kind, at_nodes, in_cells = _parts(stream, deformed)
    grid, points, array = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(places), deep=True))
    table = np.column_stack([np.full(len(cells), cells.shape[1]), cells]).astype(np.int64).ravel()
    array.SetCells(len(cells), numpy_to_vtkIdTypeArray(table, deep=True))
    grid.SetPoints(points)
    grid.SetCells(kind[1], array)
    if "cells.region" in stream:
        in_cells = {"region": np.asarray(stream["cells.region"]), **in_cells}
    for data, fields in ((grid.GetPointData(), at_nodes), (grid.GetCellData(), in_cells)):
        for name, values in fields.items():
            column = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            column.SetName(name)
            data.AddArray(column)
    return grid
