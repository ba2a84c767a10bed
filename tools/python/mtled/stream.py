"""The format mts 1 (mts(5)): reading it into numpy arrays, and writing them."""

import mmap
import os
import re
import zlib

import numpy as np

TYPES = {"i4": "<i4", "i8": "<i8", "f4": "<f4", "f8": "<f8"}
NAME = re.compile(r"[A-Za-z][A-Za-z0-9._-]{0,126}")
KEY = re.compile(r"[A-Za-z][A-Za-z0-9._-]{0,62}")
RESERVED = ("mts", "end", "crc32", "stopped")


class StreamError(ValueError):
    """What was read is no whole stream, or what is to be written cannot be a section of one."""


class Array(np.ndarray):
    """A section's numbers, of shape (rows, columns), or (rows,) with one column, and in attrs its header's keys.

    attrs are those of a whole section: parts and results of arithmetic have none.
    """

    attrs: dict

    def __new__(cls, values, **attrs):
        array = np.asarray(values).view(cls)
        array.attrs = dict(attrs)
        return array

    def __array_finalize__(self, source):
        self.attrs = {}

    @property
    def unit(self):
        """The unit of the numbers, such as "m"; None where the section does not state one."""
        return self.attrs.get("unit")

    @property
    def columns(self):
        """The names of the columns, a list; empty where there are none."""
        return _split(self.attrs.get("cols"))

    @property
    def names(self):
        """What the numbers of a section of groups stand for (names=), or the names of its rows (rows=): a list."""
        return _split(self.attrs.get("names") or self.attrs.get("rows"))


def _split(text):
    return text.split(",") if text else []


class Stream(dict):
    """Sections by name, in order, each an Array; provenance: the lines behind "# @ ", the oldest first."""

    def __init__(self, sections=(), provenance=()):
        super().__init__(sections)
        self.provenance = list(provenance)

    def mask(self, section, name):
        """Which rows of a section of groups belong to the group of this name: mask("cells.region", "tumour")."""
        names = self[section].names
        if name not in names:
            raise KeyError(f"{section}: no '{name}'; there are {', '.join(names)}")
        return np.asarray(self[section]) == names.index(name)

    def nodes_of(self, name):
        """The nodes of the node set of this name (sets.ptr, sets.idx): their numbers."""
        names = self["sets.ptr"].names
        if name not in names:
            raise KeyError(f"no node set '{name}'; there are {', '.join(names)}")
        first, behind = self["sets.ptr"][names.index(name):][:2]
        return np.asarray(self["sets.idx"][first:behind])

    def to_meshio(self, deformed=False):
        """A meshio.Mesh: see mtled.convert."""
        from .convert import to_meshio

        return to_meshio(self, deformed)

    def to_vtk(self, deformed=False):
        """A vtkUnstructuredGrid: see mtled.convert."""
        from .convert import to_vtk

        return to_vtk(self, deformed)

    def to_pyvista(self, deformed=False):
        """A pyvista.UnstructuredGrid: see mtled.convert."""
        import pyvista

        return pyvista.wrap(self.to_vtk(deformed))


def read(source, check=True):
    """Read a stream, text or binary, from a path, a binary file object or bytes.

    The sections of a binary file are mapped, not copied, and cannot be changed: use .copy(). With check=False checksums are not
    compared, so that only what is used is read from the disk. Raises StreamError for what is not a whole stream.
    """
    name = "stream"
    if isinstance(source, (str, os.PathLike)):
        name = os.fspath(source)
        with open(source, "rb") as file:
            try:
                data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
            except (ValueError, OSError):  # empty, or a pipe
                data = file.read()
    else:
        data = source if isinstance(source, (bytes, bytearray, memoryview)) else source.read()
    try:
        return _Reader(data, check).stream()
    except StreamError as error:
        raise StreamError(f"{name}: {error}") from None


class _Reader:
    """Goes through the bytes once; frame is the CRC-32 of all that is no payload."""

    def __init__(self, data, check):
        self.data = data if isinstance(data, mmap.mmap) else bytes(data)
        self.bytes = memoryview(self.data)
        self.at = 0
        self.check = check
        self.frame = 0
        self.binary = False

    def line(self):
        end = self.data.find(b"\n", self.at, self.at + (1 << 20))
        if end < 0:
            raise StreamError("cut short: not a whole stream")
        begin, self.at = self.at, end + 1
        return bytes(self.bytes[begin:end])

    def stream(self):
        if not self.data[:6] == b"# mts ":
            raise StreamError("not an mts stream")
        first = self.line()
        if first != b"# mts 1":
            raise StreamError(f"version {first[6:].decode(errors='replace')!r}: this reads version 1")
        self.frame = zlib.crc32(first + b"\n")
        stream = Stream()
        while True:
            line = self.line()
            if line.startswith(b"# end "):
                return self.end(line, stream)
            if line.startswith(b"# stopped "):
                raise StreamError("the program that wrote it stopped: " + line[10:].decode(errors="replace"))
            self.frame = zlib.crc32(line + b"\n", self.frame)
            if line.startswith(b"# @ "):
                stream.provenance.append(line[4:].decode())
            else:
                self.section(line, stream)

    def end(self, line, stream):
        match = re.fullmatch(rb"# end (\d+)(?: crc32=([0-9a-f]{8}))?", line)
        if not match or int(match[1]) != len(stream) or self.at != len(self.data):
            raise StreamError(f"the end line does not fit: {line.decode(errors='replace')}")
        frame = zlib.crc32(b"# end " + match[1], self.frame)
        if self.binary and (match[2] is None or (self.check and int(match[2], 16) != frame)):
            raise StreamError("damaged: wrong checksum at the end")
        return stream

    def section(self, line, stream):
        words = line.decode(errors="replace").split()
        match = re.fullmatch(r"# (\S+) (i4|i8|f4|f8) (\d+) (\d+)( .*)?", line.decode(errors="replace").rstrip(" "))
        if not match or not NAME.fullmatch(match[1]):
            raise StreamError(f"byte {self.at - len(line) - 1}: not the header of a section")
        name, kind, rows, columns = match[1], match[2], int(match[3]), int(match[4])
        attrs = dict(word.partition("=")[::2] for word in words[5:])
        if name in stream or columns == 0:
            raise StreamError(f"section {name}: {'stands twice' if name in stream else 'has no columns'}")
        if attrs.pop("enc", "text") == "bin":
            values = self.binary_values(line, name, kind, rows * columns)
        else:
            values = self.text_values(name, kind, rows, columns)
        stream[name] = Array(values if columns == 1 else values.reshape(rows, columns), **attrs)

    def binary_values(self, line, name, kind, count):
        self.binary = True
        size = count * int(kind[1])
        if size > len(self.data) - self.at:
            raise StreamError(f"section {name}: cut short")
        begin, self.at = self.at, self.at + size
        values = np.frombuffer(self.data, dtype=TYPES[kind], count=count, offset=begin) if count else np.zeros(0, TYPES[kind])
        after = self.line()
        check = self.line()
        self.frame = zlib.crc32(check + b"\n", self.frame)
        if after or not re.fullmatch(rb"# crc32 [0-9a-f]{8}", check):
            raise StreamError(f"section {name}: no checksum behind its values")
        if self.check and zlib.crc32(self.bytes[begin:begin + size], zlib.crc32(line + b"\n")) != int(check[8:], 16):
            raise StreamError(f"section {name}: damaged: wrong checksum")
        return values

    def text_values(self, name, kind, rows, columns):
        begin = self.at
        end = self.data.find(b"\n\n\n", begin) if rows else begin - 1
        payload = bytes(self.bytes[begin:end + 1]) if end >= 0 else b""
        if end < 0 or self.data[end + 1:end + 3] != b"\n\n" or payload.count(b"\n") != rows:
            raise StreamError(f"section {name}: not {rows} rows, and two empty lines behind them")
        self.at = end + 3
        try:
            lines = payload.decode().split("\n")[:-1]
            table = [line.split() for line in lines]
            if any(len(row) != columns for row in table):
                raise ValueError
            return np.array(table, dtype=TYPES[kind]).reshape(-1)
        except ValueError:
            raise StreamError(f"section {name}: a row without {columns} numbers of type {kind}") from None


def write(stream, target=None, text=False):
    """Write a stream (a Stream, or a dict of arrays) to a path or a binary file object, as binary or text.

    Whole numbers become i4 or i8, others f4 or f8 by their type. A path is replaced only when all is written. Without a target the
    bytes are returned.
    """
    data = _bytes_of(stream, text)
    if target is None:
        return data
    if not isinstance(target, (str, os.PathLike)):
        target.write(data)
        return None
    path = os.fspath(target)
    new = f"{path}.{os.getpid()}.new"
    try:
        with open(new, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, path)
    finally:
        if os.path.exists(new):
            os.unlink(new)
    return None


def _kind_of(name, values):
    if values.dtype.kind in "iu" and (values.dtype.itemsize < 4 or values.dtype == np.int32):
        return "i4"
    if values.dtype.kind in "iu" and (values.dtype != np.uint64 or not np.any(values > np.iinfo(np.int64).max)):
        return "i8"
    if values.dtype.kind == "f" and values.dtype.itemsize <= 8:
        return "f4" if values.dtype.itemsize <= 4 else "f8"
    raise StreamError(f"section {name}: values of type {values.dtype}, not whole numbers or real ones")


def _header(name, kind, values, attrs, text):
    if not NAME.fullmatch(name) or name in RESERVED:
        raise StreamError(f"'{name}' is not a name of a section")
    words = ["#", name, kind, *map(str, values.shape), "enc=" + ("text" if text else "bin")]
    for key, value in attrs.items():
        if not KEY.fullmatch(key) or key == "enc" or re.search(r"[\s\x00-\x1f\x7f]", str(value)):
            raise StreamError(f"section {name}: {key}={value!r} cannot be in its header")
        words.append(f"{key}={value}")
    return " ".join(words).encode()


def _bytes_of(stream, text):
    parts = [b"# mts 1\n"] + [f"# @ {line}\n".encode() for line in getattr(stream, "provenance", ())]
    parts.append(b"# @ mtled.py 1 write\n")
    length = sum(map(len, parts))
    frame = zlib.crc32(b"".join(parts))

    def add(piece, counts=True):
        nonlocal length, frame
        parts.append(piece)
        length += len(piece)
        if counts:
            frame = zlib.crc32(piece, frame)

    for name, array in stream.items():
        values = np.asarray(array)
        kind = _kind_of(name, values)
        if values.ndim not in (1, 2) or (values.ndim == 2 and values.shape[1] == 0):
            raise StreamError(f"section {name}: an array of shape {values.shape}, not of rows and columns")
        values = np.ascontiguousarray(values.reshape(len(values), -1) if values.size else values.reshape(0, max(values.shape[1:] or (1,))),
                                      dtype=TYPES[kind])
        header = _header(name, kind, values, getattr(array, "attrs", {}), text)
        if text:
            form = " ".join(["%d" if kind[0] == "i" else "%.17g" if kind == "f8" else "%.9g"] * values.shape[1]) + "\n"
            add(header + b"\n")
            add("".join(form % tuple(row) for row in values.tolist()).encode() + b"\n\n", False)
        else:
            header += b" " * (-(length + len(header) + 1) % 64) + b"\n"
            payload = values.tobytes()
            add(header)
            add(payload + b"\n", False)
            add(b"# crc32 %08x\n" % zlib.crc32(payload, zlib.crc32(header)))
    end = b"# end %d" % len(stream)
    frame = zlib.crc32(end, frame)
    return b"".join(parts) + end + (b"\n" if text else b" crc32=%08x\n" % frame)
