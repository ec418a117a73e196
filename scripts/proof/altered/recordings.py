"""Recordings as text, and the changes that are made to them.

A sample that is not changed keeps its digits; missing ones stay missing.
"""

import csv
import math
import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from judge import files

Row = dict[str, str]
POSE = ("x", "y", "heading")
SIDES = ("omega_left", "omega_right")
ROLLS = 0.05  # rad/s
BEFORE = 2.0  # s of rest before a drive
BREAK = 3.0  # s without samples between two recordings that are driven one after the other


@dataclass(frozen=True)
class Table:
    """The rows of a recording, and the sidecar beside it."""

    rows: list[Row]
    sidecar: Path

    @classmethod
    def read(cls, data: Path, stem: str) -> "Table":
        """The recording whose name begins so."""
        found = sorted(data.glob(f"{stem}_*.csv"))
        if len(found) != 1:
            raise FileNotFoundError(f"{data}: {len(found)} recordings begin with {stem}_")
        with found[0].open(newline="") as file:
            return cls(list(csv.DictReader(file)), found[0].with_suffix(".json"))

    def write(self, path: Path) -> None:
        """Writes the recording and its sidecar."""
        lines = [",".join(self.rows[0]), *(",".join(row.values()) for row in self.rows)]
        files.write(path, "\n".join(lines) + "\n")
        shutil.copyfile(self.sidecar, path.with_suffix(".json"))

    def runs(self, count: int) -> "Table":
        """Its first runs."""
        return Table([row for row in self.rows if int(row["run"]) < count], self.sidecar)

    def driven(self, seconds: float) -> "Table":
        """So many seconds from a moment before its wheels first turn."""
        turns = (float(row["time"]) for row in self.rows for side in SIDES if row[side] and abs(float(row[side])) > ROLLS)
        start = next(turns, None)
        if start is None:
            raise ValueError(f"{self.sidecar.stem} does not drive")
        return Table([row for row in self.rows if 0 <= float(row["time"]) - start + BEFORE < seconds], self.sidecar)


def _changed(table: Table, column: str, change: Callable[[float], float]) -> Table:
    rows = [row | {column: f"{change(float(row[column])):.6g}"} if row[column] else row for row in table.rows]
    return Table(rows, table.sidecar)


def slower_left(table: Table, factor: float) -> Table:
    """The left encoders count too little."""
    return _changed(table, "omega_left", lambda value: factor * value)


def biased_gyro(table: Table, bias: float) -> Table:
    """The gyro tells more than there is."""
    return _changed(table, "yaw_rate", lambda value: value + bias)


def late_pose(table: Table, delay: float) -> Table:
    """Position and heading are told later; what was told of the moment before the first sample is not known."""
    if "run" in table.rows[0]:
        raise ValueError("a pose can be told later in a recording of one run only")
    rows = {float(row["time"]): row | dict.fromkeys(POSE, "") for row in table.rows}
    for row in table.rows:
        if row["x"]:
            told = round(float(row["time"]) + delay, 4)
            own = rows.get(told) or dict.fromkeys(row, "") | {"time": f"{told:g}"}
            rows[told] = own | {name: row[name] for name in POSE}
    return Table([rows[time] for time in sorted(rows)], table.sidecar)


def joined(parts: list[Table]) -> Table:
    """Recordings in one, driven one after the other: runs are numbered on; without runs each begins, after a break, where
    the one before it ended."""
    whole = parts[0]
    for part in parts[1:]:
        whole = _after(whole, part)
    return whole


def stretches(parts: list[Table]) -> list[list[tuple[int, float, float]]]:
    """Run, start and end of each part in the recording that they are joined to."""
    rows, result = joined(parts).rows, []
    for part in parts:
        times: dict[int, list[float]] = {}
        for row in rows[: len(part.rows)]:
            times.setdefault(int(row.get("run", 0)), []).append(float(row["time"]))
        result.append([(run, min(own), max(own)) for run, own in times.items()])
        rows = rows[len(part.rows) :]
    return result


def _after(first: Table, second: Table) -> Table:
    if "run" in first.rows[0]:
        count = 1 + max(int(row["run"]) for row in first.rows)
        return Table(first.rows + [row | {"run": str(int(row["run"]) + count)} for row in second.rows], first.sidecar)
    end, begin = _last_pose(first.rows), _last_pose(reversed(second.rows))
    shift = float(first.rows[-1]["time"]) + BREAK - float(second.rows[0]["time"])
    turn = end[2] - begin[2]
    c, s = math.cos(turn), math.sin(turn)

    def moved(row: Row) -> Row:
        row = row | {"time": f"{float(row['time']) + shift:.4f}"}
        if not row["x"]:
            return row
        dx, dy = float(row["x"]) - begin[0], float(row["y"]) - begin[1]
        place = end[0] + c * dx - s * dy, end[1] + s * dx + c * dy, float(row["heading"]) + turn
        return row | {name: f"{value:.5f}" for name, value in zip(POSE, place, strict=True)}

    return Table(first.rows + [moved(row) for row in second.rows], first.sidecar)


def _last_pose(rows: Iterable[Row]) -> list[float]:
    last = None
    for row in rows:
        last = row if row["x"] else last
    if last is None:
        raise ValueError("no pose")
    return [float(last[name]) for name in POSE]
