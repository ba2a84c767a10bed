#!/usr/bin/python3
"""measured.py OUTPUT INPUT COMMAND...: a command from file to file (INPUT "-": none). Prints, separated by tabs: seconds of processor, seconds
of wall time, peak memory, peak of what is not a mapped file (looked at every 10 ms), bytes written, and its status. What it says goes to OUTPUT.log."""
import os
import subprocess
import sys
import time


def anonymous(process):
    """Bytes now in memory that belong to no file."""
    try:
        with open(f"/proc/{process}/status", encoding="ascii") as lines:
            return next((1024 * int(line.split()[1]) for line in lines if line.startswith("RssAnon")), 0)
    except OSError:
        return 0


def main():
    name, source, command = sys.argv[1], sys.argv[2], sys.argv[3:]
    most, started = 0, time.monotonic()
    with open("/dev/null" if source == "-" else source, "rb") as given, open(name, "wb") as out, open(name + ".log", "wb") as log:
        process = subprocess.Popen(command, stdin=given, stdout=out, stderr=log)
        while True:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            if ended:
                break
            most = max(most, anonymous(process.pid))
            time.sleep(0.01)
    print(f"{usage.ru_utime + usage.ru_stime:.3f}", f"{time.monotonic() - started:.1f}", 1024 * usage.ru_maxrss, most, os.path.getsize(name), os.waitstatus_to_exitcode(status), sep="\t")


main()
