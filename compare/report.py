# SPDX-License-Identifier: Apache-2.0
"""Numbers and tables in plain text, and words about progress."""
import math
import os
import re
import subprocess
import sys
import time


_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def power(value):
    """A number as an axis says it: 0.05, 2, 300, 10⁻⁶."""
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return f"{value:g}"
    digits, exponent = f"{value:.0e}".split("e")
    raised = "10" + str(int(exponent)).translate(_RAISED)
    return raised if digits == "1" else f"{digits}·{raised}"


def rounded(value):
    """A number to one digit: 0.003, 2·10⁻⁷."""
    return power(float(f"{value:.0e}"))


def number(value):
    """A number as a table says it: three digits, and powers of ten where there are many zeros."""
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        digits = max(2 - math.floor(math.log10(abs(value))), 0) if value else 0
        return f"{value:.{min(digits, 5)}f}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}·10" + str(int(exponent)).translate(_RAISED)


def table(titles, rows):
    """Lines of a table; every cell is text. The first column is set left, the rest right."""
    cells = [titles, *rows]
    widths = [max(len(row[i]) for row in cells) for i in range(len(titles))]

    def line(row):
        first = row[0].ljust(widths[0])
        return "  ".join([first, *(c.rjust(w) for c, w in zip(row[1:], widths[1:]))]).rstrip()

    return "\n".join([line(titles), line(["-" * w for w in widths]), *(line(r) for r in rows)])


class StepFailed(Exception):
    """A program that a comparison needs has failed; the text says which, with its last words."""


class Progress:
    """One line on standard error: what is done, the percentage a program prints, the time."""

    def __init__(self, words):
        self.words = words
        self.start = time.perf_counter()
        self.live = sys.stderr.isatty()
        self.seen = ""
        if self.live:
            self.show("")

    def show(self, state, end=""):
        sys.stderr.write(f"\r{self.words} … {state.ljust(8)}{end}")
        sys.stderr.flush()

    def read(self, text):
        """Look for a percentage in a program's output."""
        found = re.findall(r"\b(\d{1,3}) ?%", text)
        self.seen = found[-1] + " %" if found else self.seen
        if self.live:
            self.show(self.seen or f"{time.perf_counter() - self.start:.0f} s")

    def done(self, state=None):
        state = state or f"{time.perf_counter() - self.start:.1f} s"
        if self.live:
            self.show(state, end="\n")
        else:
            sys.stderr.write(f"{self.words} … {state}\n")
            sys.stderr.flush()


def _stream(command, progress, log, environment, folder):
    """Run a program, its output to the file `log` and past `progress`; returns the exit status."""
    process = subprocess.Popen(command, cwd=folder, env=environment,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        while chunk := os.read(process.stdout.fileno(), 65536):
            log.write(chunk)
            progress.read(chunk.decode(errors="replace"))
        return process.wait()
    finally:
        process.kill()
        process.wait()


def _environment(changes):
    # A dump that the user asks for elsewhere would change what POV-Ray renders here.
    inherited = {name: value for name, value in os.environ.items() if name != "LIBSHADE_DUMP"}
    return {**inherited, **(changes or {})}


def step(words, command, log, environment=None, folder=None, allowed=(0,)):
    """Say what is being done, run it, say how long it took. All output goes to the file `log`.

    Returns the output; StepFailed if the exit status is not among `allowed`.
    """
    progress = Progress(words)
    try:
        with open(log, "wb") as file:
            status = _stream(command, progress, file, _environment(environment), folder)
    except OSError as error:
        progress.done("failed")
        raise StepFailed(f"{words}: {command[0]}: {error.strerror}") from error
    progress.done(None if status in allowed else "failed")
    with open(log, encoding="utf-8", errors="replace") as file:
        output = file.read()
    if status not in allowed:
        tail = "\n".join(output.splitlines()[-15:])
        raise StepFailed(f"{words}: exit status {status}; see {log}\n{tail}")
    return output


def run(main):
    """Run a script's main(); its result is the exit status. Trouble is one clear message."""
    try:
        status = main()
    except KeyboardInterrupt:
        print("\ninterrupted", file=sys.stderr)
        status = 130
    except (StepFailed, OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        status = 1
    sys.exit(status)
