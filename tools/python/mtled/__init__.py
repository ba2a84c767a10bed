"""Streams of the mtled programs as numpy arrays, and the programs in a pipe.

    import mtled
    u = mtled.read("u.dat")["u"]                     # an array, m; u.unit is "m"
    result = mtled.pipe("nodes", "-u", "mm", "body.msh").shapefn().mtled("scene").read()
    print(result["reactions"], result["reactions"].names)

read and write take the two forms of a stream, text and binary (mts(5)). A program that fails raises ToolError with its own line.
"""

from .pipe import Pipe, ToolError, pipe
from .stream import Array, Stream, StreamError, read, write

__all__ = ["Array", "Pipe", "Stream", "StreamError", "ToolError", "pipe", "read", "write"]
