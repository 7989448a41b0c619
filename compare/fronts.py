# SPDX-License-Identifier: Apache-2.0
"""Speed against accuracy: repeated runs of `shade bench`, ties, the Pareto front and its chart.

A time is the median of several runs of the program, each of which takes the best of many rounds with
all methods in turn; its bar spans the middle half of the runs. Two methods tie in speed where the
median of their ratio, run by run, is within TIE of 1, or the middle half of the ratios holds 1; they
tie in accuracy where their errors differ by less than CLOSE of the larger, or both are below the
FLOOR, where rounding alone is left.
"""
import csv
import io
import subprocess
from dataclasses import dataclass, field

import numpy as np

import programs
import report
import style

TIE, CLOSE = 0.03, 0.02


def bench(arguments, runs, say):
    """Rows of `shade bench --csv ARGUMENTS`, as many times, with the column `run`."""
    rows = []
    for run in range(runs):
        say(f"run {run + 1} of {runs}")
        command = [programs.SHADE, "bench", "--csv", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise report.StepFailed(f"{' '.join(command)}: exit status {done.returncode}\n{done.stderr}")
        for row in csv.DictReader(io.StringIO(done.stdout)):
            rows.append({**{k: row[k] for k in ("what", "method", "distribution", "precision", "isa")},
                         "run": run, "ns": float(row["ns"]), "rounding": float(row["max_error"])})
    return rows


def command(arguments):
    return " ".join(["build/shade", "bench", *arguments])


@dataclass
class Point:
    """A method: its times run by run, in ns, and its error with the bounds of its bar."""

    word: str
    times: list
    error: float
    low: float | None = None
    high: float | None = None
    also: list = field(default_factory=list)  # those it ties with in both

    @property
    def ns(self):
        return float(np.median(self.times))

    @property
    def bar(self):
        """Lower and upper quartile of the times."""
        return tuple(float(v) for v in np.percentile(self.times, [25, 75]))


def pick(rows, **wanted):
    return [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]


def one(rows, **wanted):
    found = pick(rows, **wanted)
    if len(found) != 1:
        raise ValueError(f"{len(found)} rows with {wanted}: expected one")
    return found[0]


def times(rows, **wanted):
    """ns of each run, in order; {} matches by columns."""
    return [row["ns"] for row in sorted(pick(rows, **wanted), key=lambda r: r["run"])]


def ratio(a, b):
    """Median, lower and upper quartile of a's times over b's, run by run."""
    return tuple(float(v) for v in np.percentile(np.divide(a, b), [50, 25, 75]))


def as_fast(a, b):
    """Whether two points tie in speed."""
    if len(a.times) != len(b.times):
        return abs(a.ns / b.ns - 1) <= TIE
    middle, low, high = ratio(a.times, b.times)
    return abs(middle - 1) <= TIE or low <= 1 <= high


def as_exact(a, b, floor=0.0):
    return max(a.error, b.error) <= floor or abs(a.error - b.error) <= CLOSE * max(a.error, b.error)


def beats(a, b, floor=0.0):
    """Whether a is better in speed or accuracy, beyond ties, and worse in neither."""
    faster = a.ns < b.ns and not as_fast(a, b)
    exacter = a.error < b.error and not as_exact(a, b, floor)
    return (faster or exacter) and (faster or as_fast(a, b)) and (exacter or as_exact(a, b, floor))


def front(points, floor=0.0):
    """The Pareto front, by time. Ties in both are all of it, and named in `also`."""
    for point in points:
        point.also = [other.word for other in points if other is not point
                      and as_fast(point, other) and as_exact(point, other, floor)]
    return sorted((p for p in points if not any(beats(other, p, floor) for other in points)),
                  key=lambda p: p.ns)


def named(points):
    """Words of points as a sentence lists them."""
    words = [style.of(p if isinstance(p, str) else p.word).label for p in points]
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def chart(axes, points, title, error_label, floor=0.0, time_label="ns a sample, one core"):
    """Log-log points with bars and the front as a stepped line; what lies below `floor` stands on it."""
    best = front(points, floor)
    at = {id(p): max(p.error, floor) for p in points}
    axes.set_title(title)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for p in points:
        look, y = style.of(p.word), at[id(p)]
        low, high = p.bar
        y_bars = None if p.low is None or p.error <= floor else [[max(y - p.low, 0)], [max(p.high - y, 0)]]
        axes.errorbar(p.ns, y, xerr=[[p.ns - low], [high - p.ns]], yerr=y_bars, zorder=3, **look.bars)
    xs, ys = [p.ns for p in points], list(at.values())
    ys += [end for p in points if p.error > floor for end in (p.low, p.high) if end]  # bars stay within the frame
    wide, high = max(xs) / min(xs), max(ys) / min(ys)
    axes.set_xlim(min(xs) / (1.25 * wide**0.06), max(xs) * 1.5 * wide**0.1)
    axes.set_ylim(min(ys) / (1.3 * high**0.07), max(ys) * 1.4 * high**0.07)
    steps = [(axes.get_xlim()[1], at[id(best[-1])])]
    for here, after in zip(reversed(best[:-1]), reversed(best[1:])):
        steps += [(after.ns, at[id(after)]), (after.ns, at[id(here)])]
    steps += [(best[0].ns, at[id(best[0])]), (best[0].ns, axes.get_ylim()[1])]
    axes.plot(*zip(*steps), color=style.SOFT, linewidth=1, dashes=(3, 2), zorder=1)
    style.log_ticks(axes.xaxis)
    style.log_ticks(axes.yaxis)
    axes.set_xlabel(time_label)
    axes.set_ylabel(error_label)
    shown, written = [], set()
    for p in sorted(points, key=lambda p: p.word != "rotate"):
        if p.word not in written:
            written.update([p.word, *p.also])
            shown.append((p.ns, at[id(p)], p.word))
    bars = [[(p.ns, p.low), (p.ns, p.high)] for p in points if p.low and p.error > floor]
    style.labels(axes, shown, lines=[steps, *bars])
    return best
