"""How far a motion that an importer wrote is from the library's own."""

import csv
import math
from bisect import bisect
from dataclasses import dataclass
from pathlib import Path

SAME_TIME = 1e-6  # s: importers add up their steps
STATES = {"x", "y", "heading", "v_x", "v_y", "yaw_rate"}
MOTION, FORCES = "pose and velocities", "forces and slips"


class Unfit(Exception):
    """A motion that cannot be compared."""


@dataclass(frozen=True)
class Deviation:
    """The largest deviation of some outputs, as a share of that output's largest value (or of 1)."""

    share: float
    output: str
    time: float

    def __str__(self) -> str:
        if self.share == 0.0:
            return "same bits"
        return f"{self.share:.1e} (`{self.output}`, {self.time:g} s)"


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


def compare(motion: Rows, native: Rows, first: int = 0, omitted: int = 0) -> dict[str, Deviation]:
    """The deviations of a motion from the library's: of pose and velocities (`MOTION`), and of all other outputs (`FORCES`).

    The motion needs a row for each of the library's from number `first` on, and each of its outputs but `omitted` ones.
    """
    outputs, columns = list(next(iter(native.values()))), next(iter(motion.values()))
    if unknown := set(columns) - set(outputs):
        raise Unfit(f"the motion has columns that are no outputs: {', '.join(sorted(unknown)[:3])}")
    missing = [name for name in outputs if name not in columns]
    if len(missing) != omitted:
        raise Unfit(f"the motion lacks {len(missing)} of {len(outputs)} outputs ({', '.join(missing[:3])}), expected {omitted}")
    times, nearest = sorted(native)[first:], same_times(motion, sorted(native)[first:])
    worst = {}
    for group, chosen in (MOTION, STATES), (FORCES, set(outputs) - STATES):
        for name in chosen & set(columns):
            scale = max(1.0, *(abs(row[name]) for row in native.values()))
            largest = max((abs(motion[nearest[time]][name] - native[time][name]) / scale, name, time) for time in times)
            worst[group] = max(worst.get(group, largest), largest)
    return {group: Deviation(*found) for group, found in worst.items()}


def same_times(motion: Rows, times: list[float]) -> dict[float, float]:
    """The motion's time for each of the library's."""
    sampled, nearest = sorted(motion), {}
    for time in times:
        after = bisect(sampled, time)
        found = min(sampled[max(0, after - 1) : after + 1], key=lambda other: abs(other - time))
        if abs(found - time) > SAME_TIME:
            raise Unfit(f"the motion has no row at {time:g} s; the nearest is at {found!r} s")
        nearest[time] = found
    return nearest
