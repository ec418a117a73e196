"""How far a motion that an importer wrote is from the library's own."""

import csv
import math
from bisect import bisect
from dataclasses import dataclass
from pathlib import Path

SAME_TIME = 1e-6  # s: importers add up their steps


class Unfit(Exception):
    """A motion that cannot be compared."""


@dataclass(frozen=True)
class Deviation:
    """The largest deviation of all, as a share of that output's largest value (or of 1)."""

    share: float
    output: str
    time: float
    outputs: int
    rows: int

    def __str__(self) -> str:
        if self.share == 0.0:
            return "none: the same bits"
        return f"{self.share:.1e} (`{self.output}` at {self.time:g} s)"


Rows = dict[float, dict[str, float]]


def number(path: Path, line: int, name: str, text: str | None) -> float:
    try:
        value = float(text)
    except (TypeError, ValueError):
        raise Unfit(f"{path}:{line}: {name} is {text!r}, not a number") from None
    if not math.isfinite(value):
        raise Unfit(f"{path}:{line}: {name} is {value}")
    return value


def read(path: Path, side: str | None = None) -> Rows:
    """Rows by time; of the library's motion those of one side of each step."""
    rows = {}
    with path.open(newline="", encoding="utf-8") as file:
        for line, row in enumerate(csv.DictReader(file), 2):
            if row.pop("side", side) == side:
                values = {name: number(path, line, name, text) for name, text in row.items()}
                rows[values.pop("time")] = values
    if not rows:
        raise Unfit(f"{path} has no row")
    return rows


def compare(motion: Rows, native: Rows, first: int = 0, omitted: int = 0) -> Deviation:
    """The deviation of a motion from the library's.

    The motion needs a row for each of the library's from number `first` on, and each of its outputs but `omitted` ones.
    """
    outputs = list(next(iter(native.values())))
    if unknown := set(next(iter(motion.values()))) - set(outputs):
        raise Unfit(f"the motion has columns that are no outputs: {', '.join(sorted(unknown)[:3])}")
    there = [name for name in outputs if name in next(iter(motion.values()))]
    if len(outputs) - len(there) != omitted:
        missing = [name for name in outputs if name not in there]
        raise Unfit(f"the motion lacks {len(missing)} of {len(outputs)} outputs ({', '.join(missing[:3])} ...), expected {omitted}")
    times, sampled, nearest = sorted(native)[first:], sorted(motion), {}
    for time in times:
        after = bisect(sampled, time)
        found = min(sampled[max(0, after - 1) : after + 1], key=lambda other: abs(other - time))
        if abs(found - time) > SAME_TIME:
            raise Unfit(f"the motion has no row at {time:g} s; the nearest is at {found!r} s")
        nearest[time] = found
    scale = {name: max(1.0, *(abs(row[name]) for row in native.values())) for name in there}
    worst = max((abs(motion[nearest[time]][name] - native[time][name]) / scale[name], name, time) for time in times for name in there)
    return Deviation(*worst, len(there), len(times))
