#!/usr/bin/python3
# The surface of the liver from a label image: python3 make-surface.py liver.inr.gz liver_surface.stl
# (Debian packages libcgal-demo for the image, in data.tar.gz of /usr/share/doc/libcgal-dev, and python3-vtk9.)
# Run by hand; what it makes is in the repository.
import gzip
import re
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import (vtkFlyingEdges3D, vtkPolyDataConnectivityFilter, vtkQuadricDecimation,
                                       vtkWindowedSincPolyDataFilter)
from vtkmodules.vtkImagingCore import vtkImageResample
from vtkmodules.vtkImagingGeneral import vtkImageGaussianSmooth
from vtkmodules.vtkIOGeometry import vtkSTLWriter

raw = gzip.open(sys.argv[1]).read()
head = dict(re.findall(r"(\w+)=([^\n]*)", raw[:256].decode("ascii", "replace")))
size = [int(head[k]) for k in ("XDIM", "YDIM", "ZDIM")]
label = np.frombuffer(raw, np.uint8, offset=256, count=size[0] * size[1] * size[2])
liver = (label == 255).astype(np.float32)  # 127 is the right kidney, 84 and 85 a piece of vein
image = vtkImageData()
image.SetDimensions(size)
image.SetSpacing([float(head[k]) for k in ("VX", "VY", "VZ")])
image.GetPointData().SetScalars(numpy_to_vtk(liver, deep=True))

smooth, coarse, surface = vtkImageGaussianSmooth(), vtkImageResample(), vtkFlyingEdges3D()
largest, even, fewer = vtkPolyDataConnectivityFilter(), vtkWindowedSincPolyDataFilter(), vtkQuadricDecimation()
smooth.SetStandardDeviations(4, 4, 2)  # voxels: 2.5 mm
for axis in range(3):
    coarse.SetAxisOutputSpacing(axis, 2)
surface.SetValue(0, 0.5)
largest.SetExtractionModeToLargestRegion()
even.SetNumberOfIterations(30)
fewer.SetTargetReduction(0.93)
smooth.SetInputData(image)
for before, after in zip((smooth, coarse, surface, largest, even), (coarse, surface, largest, even, fewer)):
    after.SetInputConnection(before.GetOutputPort())
writer = vtkSTLWriter()
writer.SetFileName(sys.argv[2])
writer.SetFileTypeToBinary()
writer.SetInputConnection(fewer.GetOutputPort())
writer.Write()
print(fewer.GetOutput().GetNumberOfCells(), "triangles")
