#!/usr/bin/python3
# The label image from the one of CGAL: make-labels.py liver.inr.gz liver_labels.nii.gz
# (Debian package libcgal-demo, in /usr/share/doc/libcgal-dev/data.tar.gz; python3-nibabel.) Run by hand; what it makes is in the repository.
import gzip
import re
import sys

import nibabel
import numpy as np

STEP = 2.5  # mm
LABELS = {255: 1, 127: 2}  # liver, right kidney

raw = gzip.open(sys.argv[1]).read()
head = dict(re.findall(r"(\w+)=([^\n]*)", raw[:256].decode("ascii", "replace")))
shape = [int(head[k]) for k in ("XDIM", "YDIM", "ZDIM")]
fine = np.frombuffer(raw, np.uint8, offset=256, count=np.prod(shape)).reshape(shape, order="F")
at = [((np.arange(n) + 0.5) * float(head[k]) / STEP).astype(int) for n, k in zip(shape, ("VX", "VY", "VZ"))]
size = [a[-1] + 1 for a in at]
place = (at[0][:, None, None] * size[1] + at[1][:, None]) * size[2] + at[2]
votes = [np.bincount(place[fine == v], minlength=np.prod(size)) for v in LABELS]
votes.insert(0, np.bincount(place.ravel(), minlength=np.prod(size)) - sum(votes))  # all else is outside
coarse = np.choose(np.argmax(votes, axis=0), [0, *LABELS.values()]).astype(np.uint8).reshape(size)
# There x points to the left of the patient, y to the back.
affine = np.diag([-STEP, -STEP, STEP, 1])
affine[:2, 3] = STEP * (size[0] // 2), STEP * (size[1] // 2)
image = nibabel.Nifti1Image(coarse, affine)
image.header.set_xyzt_units("mm")
nibabel.save(image, sys.argv[2])
