"""The programs in a pipe: pipe("nodes", "-u", "mm", "body.msh").shapefn().mtled("scene").read()."""

import os
import shutil
import subprocess
import threading

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
            with open(new, "wb") as file:
                self._run(note, file)
            os.replace(new, path)
        finally:
            if os.path.exists(new):
                os.unlink(new)

    def run(self, note=None):
        """Run, and return what the last program writes, as bytes.

        note: called with each line that a program writes on standard error, as it comes (progress, notes); without it these are kept in
        notes. The first program that fails raises ToolError.
        """
        return self._run(note, subprocess.PIPE)

    def _run(self, note, target):
        if not self.stages:
            raise ValueError("a pipe without a program")
        self.notes = []
        before = None
        processes, threads, lines = [], [], []
        if self.source is not None:
            before = subprocess.PIPE
        try:
            for number, stage in enumerate(self.stages):
                last = number + 1 == len(self.stages)
                process = subprocess.Popen(
                    [program(stage[0]), *stage[1:]],
                    stdin=before if before is not None else subprocess.DEVNULL,
                    stdout=target if last else subprocess.PIPE,
                    stderr=subprocess.PIPE,
                )
                if number > 0:
                    before.close()  # the program before gets SIGPIPE when this one ends
                before = process.stdout
                processes.append(process)
                lines.append([])
                threads.append(threading.Thread(target=self._listen, args=(process.stderr, lines[-1], note)))
                threads[-1].start()
            if self.source is not None:
                threads.append(threading.Thread(target=_feed, args=(processes[0].stdin, self.source)))
                threads[-1].start()
            output = processes[-1].stdout.read() if target is subprocess.PIPE else None
        except BaseException:
            for process in processes:
                process.kill()
            raise
        finally:
            for process in processes:
                process.wait()
            for thread in threads:
                thread.join()
            for process in processes:
                for file in (process.stdout, process.stderr):
                    if file is not None:
                        file.close()
        self._judge(processes, lines)
        return output

    def _listen(self, file, lines, note):
        for line in file:
            text = line.decode(errors="replace").rstrip("\n")
            lines.append(text)
            if note is None:
                self.notes.append(text)
            else:
                note(text)

    def _judge(self, processes, lines):
        """Raise what the first failure says; a program that could not write on fails because of one behind it."""
        failed = [k for k, process in enumerate(processes) if process.returncode != 0]
        causes = [k for k in failed if processes[k].returncode not in (-13, 141)] or failed
        if causes:
            k = causes[0]
            raise ToolError(self.stages[k][0], processes[k].returncode, lines[k][-1] if lines[k] else "")


def _text(argument):
    return argument if isinstance(argument, str) else os.fspath(argument) if isinstance(argument, os.PathLike) else str(argument)


def _feed(file, source):
    try:
        with file:
            streams.write(source, file)
    except BrokenPipeError:
        pass  # the program says why it did not read on
