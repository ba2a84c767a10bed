"""The programs in a pipe: pipe("nodes", "-u", "mm", "body.msh").shapefn().mtled("scene").read()."""

import os
import shutil
import subprocess
import tempfile

from . import stream as streams


class ToolError(RuntimeError):
    """A program ended with a status other than 0. tool, status and message (its last line) say which, how and why; a status below 0 is
    the number of the signal that ended it."""

    def __init__(self, tool, status, message):
        super().__init__(message or f"{tool}: ended with status {status}")
        self.tool, self.status, self.message = tool, status, message


def program(tool):
    """The path of a program: in MTLED_BIN, in the build of the tree that this file lies in, or on PATH."""
    here = os.path.dirname(os.path.abspath(__file__))
    tree = os.path.normpath(os.path.join(here, "../../../build/bin"))
    for folder in (os.environ.get("MTLED_BIN"), tree):
        if folder and os.access(os.path.join(folder, tool), os.X_OK):
            return os.path.join(folder, tool)
    found = shutil.which(tool)
    if found is None:
        raise FileNotFoundError(f"no program '{tool}': build it (make), or set MTLED_BIN to the folder of the programs")
    return found


def pipe(first, *arguments):
    """A pipe that begins with a program and its arguments, or with a stream (a Stream or a dict of arrays)."""
    if isinstance(first, dict):
        return Pipe((), first)
    return Pipe([(first, *arguments)])


class Pipe:
    """Stages to be run. Nothing runs before read, save or run; a pipe can be run again, and used as the start of several others.

    .NAME(ARGUMENTS...) appends the program NAME; so does stage(NAME, ARGUMENTS...). Arguments that are no text are written by str.
    """

    def __init__(self, stages, source=None):
        self.stages = [tuple(map(_text, stage)) for stage in stages]
        self.source = source
        self.notes = []

    def stage(self, tool, *arguments):
        return Pipe([*self.stages, (tool, *arguments)], self.source)

    def __getattr__(self, tool):
        if tool.startswith("_"):
            raise AttributeError(tool)
        return lambda *arguments: self.stage(tool, *arguments)

    def read(self, note=None):
        """Run, and read what the last program writes: a Stream."""
        return streams.read(self.run(note))

    def save(self, path, note=None):
        """Run, and write what the last program writes to a file, which appears only when all have succeeded."""
        new = f"{os.fspath(path)}.{os.getpid()}.new"
        try:
            with open(new, "wb") as file, self._output(note) as output:
                shutil.copyfileobj(output, file)
            os.replace(new, path)
        finally:
            if os.path.exists(new):
                os.unlink(new)

    def run(self, note=None):
        """Run, and return what the last program writes, as bytes.

        note: called with each line that a program writes on standard error, as it comes (progress, notes); without it these are kept in
        notes. The first program that fails raises ToolError, and those behind it do not run.
        """
        with self._output(note) as output:
            return output.read()

    def _output(self, note):
        """What the last program writes, as a file. Each program reads all of its input before it writes: they run one after the other."""
        if not self.stages:
            raise ValueError("a pipe without a program")
        self.notes = []
        if self.source is None:
            source = open(os.devnull, "rb")
        else:
            source = tempfile.TemporaryFile()
            streams.write(self.source, source)
        for stage in self.stages:
            source.seek(0)
            with source:
                source = self._stage(stage, source, note or self.notes.append)
        source.seek(0)
        return source

    def _stage(self, stage, source, note):
        """What one program writes, as a file."""
        target, line = tempfile.TemporaryFile(), ""
        with subprocess.Popen([program(stage[0]), *stage[1:]], stdin=source, stdout=target, stderr=subprocess.PIPE) as process:
            try:
                for line in process.stderr:
                    line = line.decode(errors="replace").rstrip("\n")
                    note(line)
            except BaseException:
                process.kill()
                target.close()
                raise
        if process.returncode != 0:
            target.close()
            raise ToolError(stage[0], process.returncode, line)
        return target


def _text(argument):
    return argument if isinstance(argument, str) else os.fspath(argument) if isinstance(argument, os.PathLike) else str(argument)
