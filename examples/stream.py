"""A text stream as numpy arrays. Alone: its sections and their shapes, python3 stream.py u.dat; else, from stream import read."""
import sys
import numpy as np

def read(path):
    lines, sections, end = iter(open(path)), {}, ["", "", ""]
    for end in (line.split() for line in lines if line.startswith("# ")):
        if "enc=text" in end:
            name, kind, rows, cols = end[1], end[2], int(end[3]), int(end[4])
            values = [next(lines).split() for _ in range(rows)]
            sections[name] = np.array(values, dtype=kind).reshape(rows, cols)
    if end[1:] != ["end", str(len(sections))]:
        raise ValueError(f"{path}: not a whole text stream (mts text FILE makes one)")
    return sections

if __name__ == "__main__":
    for name, values in read(sys.argv[1]).items():
        print(name, values.dtype, *values.shape)
