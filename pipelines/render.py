#!/usr/bin/python3
"""A picture of a deformed body in 3D, whole and cut, coloured by its displacement: render.py [OPTION]... U.dat OUT.png

VTK draws it (Debian: python3-vtk9), without a screen through xvfb-run. U.dat is a stream with cells and u, as mtled writes it.
Blue: the outline before; on a cut the line where the plane met the body at rest.
"""
import argparse
import os
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools" / "python"))
COLOURS = "fcfdbf fec488 fb8761 e55064 b5367a 812581 4f127b 1c1044".split()  # light to dark
BEFORE, PALE, AFTER, MARK, BLACK = "2874a6", "dcebf5", "5b2a1c", "1fa35c", "000000"
MM = 1e3  # drawn in millimetres


def rgb(colour):
    return [int(colour[i:i + 2], 16) / 255 for i in (0, 2, 4)]


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


def triangles(places, corners):
    """Triangles between places (N x 3, mm) as vtkPolyData."""
    data, points, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(support.numpy_to_vtk(np.ascontiguousarray(places, dtype=float), deep=True))
    table = np.column_stack([np.full(len(corners), 3), corners]).astype(np.int64).ravel()
    cells.SetCells(len(corners), support.numpy_to_vtkIdTypeArray(table, deep=True))
    data.SetPoints(points)
    data.SetPolys(cells)
    return data


def chain(data, *filters):
    """The output of filters one behind the other."""
    for each in filters:
        if data is not None:
            each.SetInputData(data)
        each.Update()
        data = each.GetOutput()
    return data


def made(kind, **values):
    """An object of VTK with some of its values set."""
    thing = getattr(vtk, "vtk" + kind)()
    for name, value in values.items():
        getattr(thing, "Set" + name)(value)
    return thing


class Body:
    """The body in mm: `rest` with the vectors u and their lengths, its surface, and the surface moved."""

    def __init__(self, stream):
        for name in ("nodes.x", "cells", "u"):
            if name not in stream:
                raise ValueError(f"no section {name}")
        for name in ("nodes.x", "u"):
            stream[name] = MM * stream[name]
        if stream["nodes.x"].shape[1] != 3:
            raise ValueError("a body in the plane; gnuplot draws those")
        self.rest = stream.to_vtk()
        self.length = np.linalg.norm(np.asarray(stream["u"]), axis=1)
        column = support.numpy_to_vtk(self.length, deep=True)
        column.SetName("length")
        self.rest.GetPointData().SetScalars(column)
        self.rest.GetPointData().SetActiveVectors("u")
        self.surface = chain(self.rest, made("DataSetSurfaceFilter"))
        self.places = np.vstack([stream["nodes.x"], stream["nodes.x"] + stream["u"]])
        self.stream = stream

    def moved(self, data, angle):
        """The surface of a part of the body where it comes to lie, smooth but for edges of more than an angle."""
        return chain(data, made("WarpVector"), made("DataSetSurfaceFilter"), made("PolyDataNormals", FeatureAngle=angle))

    def rim(self, name):
        """The edge of a group of facets, where it comes to lie."""
        facets = np.asarray(self.stream["facets"])[self.stream.mask("facets.set", name)]
        x = np.asarray(self.stream["nodes.x"]) + np.asarray(self.stream["u"])
        edges = dict(FeatureEdges=False, NonManifoldEdges=False, ManifoldEdges=False)
        return chain(triangles(x, facets), made("FeatureEdges", BoundaryEdges=True, **edges))


class Panel:
    """A part of the window, seen from the direction `toward`."""

    def __init__(self, window, at, toward, up, title):
        self.renderer = made("Renderer", Background=(1, 1, 1), Viewport=at)
        self.toward, self.size = unit(toward), [(at[2] - at[0]) * window.GetSize()[0], window.GetSize()[1]]
        up = up or ((0, 1, 0) if abs(self.toward[2]) > 0.99 else (0, 0, 1))
        self.right = unit(np.cross(up, self.toward))
        self.up = np.cross(self.toward, self.right)
        for x, y, z, part in ((-0.4, 0.5, 1, 0.8), (0.9, -0.1, 0.8, 0.35)):
            light = made("Light", Intensity=part)
            light.SetLightTypeToCameraLight()
            light.SetPosition(x, y, z)
            self.renderer.AddLight(light)
        window.AddRenderer(self.renderer)
        self.text(title, 0.5, 0.945, 22)

    def look(self, places, scale=None):
        """Aim the camera at all places; the scale is half the height of the picture, mm."""
        across, upward = places @ self.right, places @ self.up
        width, height = np.ptp(across), np.ptp(upward)
        self.scale = scale or 0.57 * max(height, width * self.size[1] / self.size[0])
        camera = self.renderer.GetActiveCamera()
        centre = (across.max() - width / 2) * self.right + (upward.max() - height / 2) * self.up
        centre = centre + self.toward * (places @ self.toward).mean()
        self.far = 2 * np.ptp(places, axis=0).max()
        camera.SetFocalPoint(centre)
        camera.SetPosition(centre + self.far * self.toward)
        camera.SetViewUp(self.up)
        camera.ParallelProjectionOn()
        camera.SetParallelScale(self.scale)
        return self.scale

    def add(self, data, colours=None, colour=BLACK, width=2.5, lift=0):
        """Draw data, coloured by length or in one colour; lines are lifted towards the viewer."""
        mapper = made("PolyDataMapper", ScalarVisibility=colours is not None)
        mapper.SetInputData(data)
        actor = made("Actor", Mapper=mapper, Position=lift * self.toward)
        if colours is not None:
            mapper.SetLookupTable(colours)
            mapper.UseLookupTableScalarRangeOn()
        style = actor.GetProperty()
        style.SetColor(rgb(colour))
        style.SetLineWidth(width)
        style.SetAmbient(0.3)
        style.SetDiffuse(0.8)
        style.SetSpecular(0.06)
        style.SetLighting(colours is not None)
        self.renderer.AddActor(actor)

    def text(self, text, x, y, size):
        actor = made("TextActor", Input=text)
        actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        actor.SetPosition(x, y)
        style = actor.GetTextProperty()
        style.SetFontSize(size)
        style.SetColor(0, 0, 0)
        style.SetJustificationToCentered()
        self.renderer.AddViewProp(actor)

    def scale_bar(self):
        """A length that is round, at the lower left."""
        pixels = self.size[1] / (2 * self.scale)
        length = rounded(0.25 * self.size[0] / pixels)
        points, cells, line = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
        for x, y in ((0, 6), (0, -6), (0, 0), (length * pixels, 0), (length * pixels, 6), (length * pixels, -6)):
            points.InsertNextPoint(40 + x, 56 + y, 0)
        cells.InsertNextCell(6)
        for i in range(6):
            cells.InsertCellPoint(i)
        line.SetPoints(points)
        line.SetLines(cells)
        mapper = vtk.vtkPolyDataMapper2D()
        mapper.SetInputData(line)
        actor = made("Actor2D", Mapper=mapper)
        actor.GetProperty().SetColor(0, 0, 0)
        actor.GetProperty().SetLineWidth(3)
        self.renderer.AddViewProp(actor)
        self.text(f"{length:g} mm", (40 + length * pixels / 2) / self.size[0], 0.02, 20)


def rounded(value):
    """1, 2 or 5 times a power of ten, not above the value."""
    power = 10.0 ** np.floor(np.log10(value))
    return power * max(step for step in (1, 2, 5) if step * power <= value * (1 + 1e-9))


def lookup(most):
    table = made("LookupTable", NumberOfTableValues=256, Range=(0, most))
    stops = np.array([rgb(colour) for colour in COLOURS])
    for i in range(256):
        at = i / 255 * (len(stops) - 1)
        table.SetTableValue(i, *[np.interp(at, range(len(stops)), stops[:, c]) for c in range(3)], 1)
    return table


def legend(window, at, colours, step):
    renderer = made("Renderer", Background=(1, 1, 1), Viewport=at)
    bar = made("ScalarBarActor", LookupTable=colours, NumberOfLabels=1 + round(colours.GetRange()[1] / step), LabelFormat="%.4g", UnconstrainedFontSize=True, BarRatio=0.3)
    bar.SetPosition(0.05, 0.15)
    bar.SetPosition2(0.9, 0.66)
    bar.GetLabelTextProperty().ShallowCopy(made("TextProperty", Color=(0, 0, 0), FontSize=20))
    title = made("TextActor", Input="displacement,\nmm")
    title.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    title.SetPosition(0.05, 0.83)
    title.GetTextProperty().SetColor(0, 0, 0)
    title.GetTextProperty().SetFontSize(17)
    renderer.AddViewProp(bar)
    renderer.AddViewProp(title)
    window.AddRenderer(renderer)


def whole(panel, body, colours, rims, marks):
    # Of thick lines behind the body as it was only the outline remains.
    panel.add(chain(body.surface, made("ExtractEdges")), colour=BEFORE, width=7, lift=-panel.far)
    panel.add(body.surface, colour=PALE, lift=-panel.far / 2)
    panel.add(body.moved(body.rest, 80), colours)
    for name in rims:
        panel.add(body.rim(name), width=4, lift=1)
    for place in marks:
        for way in (panel.right, panel.up):
            ends = [place - 0.05 * panel.scale * way, place + 0.05 * panel.scale * way]
            panel.add(chain(None, made("LineSource", Point1=ends[0], Point2=ends[1])), colour=MARK, width=5, lift=panel.far / 2)


def cut(panel, body, colours, plane, rigid):
    clipped = chain(body.rest, made("TableBasedClipDataSet", ClipFunction=plane, InsideOut=True))
    lines = chain(body.surface, made("Cutter", CutFunction=plane))
    panel.add(body.moved(clipped, 30), colours)
    panel.add(lines, colour=BEFORE, lift=panel.far / 2)
    panel.add(chain(lines, made("WarpVector")), colour=AFTER, width=2, lift=panel.far / 2)
    for path in rigid:
        corners = np.loadtxt(path).reshape(-1, 3)
        surface = triangles(corners, np.arange(len(corners)).reshape(-1, 3))
        panel.add(chain(surface, made("Cutter", CutFunction=plane)), width=4, lift=panel.far / 2)


def numbers(count):
    def read(text):
        values = [float(word) for word in text.split(",")]
        if len(values) != count:
            raise argparse.ArgumentTypeError(f"{text}: {count} numbers are wanted")
        return values
    return read


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stream", metavar="U.dat")
    parser.add_argument("picture", metavar="OUT.png")
    parser.add_argument("--view", type=numbers(3), default=[1, -2, 1], metavar="X,Y,Z", help="where the whole body is seen from (1,-2,1)")
    parser.add_argument("--cut", type=numbers(4), metavar="X,Y,Z,MM", help="a second picture without what lies beyond the plane, at rest")
    parser.add_argument("--cut-view", type=numbers(3), metavar="X,Y,Z", help="where that is seen from (from beyond the plane)")
    parser.add_argument("--up", type=numbers(3), metavar="X,Y,Z", help="what is up (z; y where that is seen from above)")
    parser.add_argument("--most", type=float, metavar="MM", help="the displacement of the darkest colour (the largest)")
    parser.add_argument("--rim", action="append", default=[], metavar="FACETS", help="a group of facets whose edge is drawn")
    parser.add_argument("--mark", action="append", default=[], type=numbers(3), metavar="X,Y,Z", help="a place, mm, that gets a cross")
    parser.add_argument("--rigid", action="append", default=[], metavar="TABLE", help="triangles, mm, to be drawn on the cut")
    parser.add_argument("--frame", type=int, metavar="N", help="the body in that frame")
    parser.add_argument("--title", default="before (blue) and after")
    parser.add_argument("--cut-title", default="cut")
    return parser.parse_args()


def draw(given):
    stream = mtled.read(given.stream)
    if given.frame is not None:
        stream["u"] = stream[f"u.frame.{given.frame}"]
    body = Body(stream)
    pathlib.Path(given.picture).touch()  # can it be written?
    step = rounded((given.most or body.length.max()) / 4)
    colours = lookup(given.most or step * np.ceil(body.length.max() / step))
    window = made("RenderWindow", OffScreenRendering=1, MultiSamples=8, Size=(1500 if given.cut else 850, 700))
    ends = (0, 0.455, 0.91) if given.cut else (0, 0.84)
    panel = Panel(window, (ends[0], 0, ends[1], 1), given.view, given.up, given.title)
    scale = panel.look(body.places)
    whole(panel, body, colours, given.rim, given.mark)
    if given.cut:
        normal = unit(given.cut[:3])
        plane = made("Plane", Normal=normal, Origin=given.cut[3] * normal)
        second = Panel(window, (ends[1], 0, ends[2], 1), given.cut_view or normal, given.up, given.cut_title)
        scale = max(scale, second.look(body.places))
        for each in (panel, second):
            each.look(body.places, scale)
        cut(second, body, colours, plane, given.rigid)
    panel.scale_bar()
    legend(window, (ends[-1], 0, 1, 1), colours, step)
    window.Render()
    chain_end = made("WindowToImageFilter", Input=window, ReadFrontBuffer=False)
    writer = made("PNGWriter", FileName=given.picture, CompressionLevel=9)
    writer.SetInputConnection(chain_end.GetOutputPort())
    writer.Write()
    if writer.GetErrorCode():
        raise OSError(f"{given.picture}: not written")


if __name__ == "__main__":
    asked = arguments()
    if not os.environ.get("DISPLAY"):
        try:
            os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable, *sys.argv])
        except FileNotFoundError:
            sys.exit("render.py: no screen and no xvfb-run: apt-get install xvfb xauth")
    try:
        import vtk
        from vtk.util import numpy_support as support

        import mtled
        vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_ERROR)
    except ImportError as error:
        sys.exit(f"render.py: {error}: apt-get install python3-vtk9 python3-numpy")
    try:
        draw(asked)
    except (OSError, ValueError, KeyError, mtled.StreamError) as error:
        text = error.args[0] if isinstance(error, KeyError) else str(error)
        sys.exit(f"render.py: {text if asked.stream in text or asked.picture in text else asked.stream + ': ' + text}")
