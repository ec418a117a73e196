"""Tables: wheel speeds and samples in, Parquet out. Files are written beside and renamed."""

import csv
import math
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

INDEX = "index"
INPUT = ["time", "omega_left", "omega_right"]
RUN = "run"


def lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of each line that has any, the header first; ends where there are not as many as in the header."""
    width = 0
    try:
        # What is no UTF-8 may stand in columns that are not read.
        with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
            rows = csv.reader(file)
            for row in rows:
                cells = [cell.strip() for cell in row]
                if cells in ([], [""]):
                    continue
                width = width or len(cells)
                if any("\n" in cell or "\r" in cell for cell in row):
                    sys.exit(f"{path}, line {rows.line_num}: a quote that is not closed on its line")
                if len(cells) != width:
                    sys.exit(f"{path}, line {rows.line_num}: not as many cells as the header has, {width}")
                yield rows.line_num, cells
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    except csv.Error as error:
        sys.exit(f"{path}, line {rows.line_num}: {error}")


def read(path: Path, wanted: Sequence[str] = (), gaps: Sequence[str] = ()) -> tuple[list[str], np.ndarray]:
    """Names and numbers of the columns that are wanted, or of all; ends with line and column where a cell is no finite number.

    A cell of the columns `gaps` may be empty: NaN.
    """
    below = lines(path)
    _, header = next(below, (0, []))
    names = list(wanted) or header
    if missing := [name for name in names if name not in header]:
        sys.exit(f"{path}: no column {missing[0]}; the header needs {', '.join(names)}")
    if any(header.count(name) > 1 for name in names):
        sys.exit(f"{path}: a column is named twice in {', '.join(header)}")
    places = [(name, header.index(name), name in gaps) for name in names]
    rows = [[math.nan if gap and not cells[at] else _number(path, line, name, cells[at]) for name, at, gap in places] for line, cells in below]
    if len(rows) < 1:
        sys.exit(f"{path}: there is no row below the header")
    return names, np.array(rows)


def _number(path: Path, line: int, name: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        sys.exit(f"{path}, line {line}, {name}: found `{cell}`, expected a finite number")
    return value


def read_input(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the left and right wheel speed at each; as the tool reads them, other columns may hold anything."""
    _, rows = read(path, INPUT, INPUT[1:])
    check_run(path)
    time, *speeds = map(np.ascontiguousarray, rows.T)
    if len(time) < 2:
        sys.exit(f"{path}: a drive of one row leads nowhere; give two rows or more")
    if (late := np.flatnonzero(np.diff(time) <= 0)).size:
        sys.exit(f"{path}: time {time[late[0] + 1]} s does not come after {time[late[0]]} s")
    for name, values in zip(INPUT[1:], speeds, strict=True):
        if np.isnan(values).all():
            sys.exit(f"{path}, {name}: nothing but empty cells, expected at least one number")
    return time, np.column_stack([filled(time, values) for values in speeds])


def check_run(path: Path) -> None:
    """Ends where a file holds several drives: what lies between two was not driven at the speeds between."""
    below = lines(path)
    _, header = next(below)
    if RUN not in header:
        return
    place = header.index(RUN)
    labels = ((line, cells[place]) for line, cells in below)
    _, first = next(labels)
    for line, label in labels:
        if label != first:
            sys.exit(f"{path}, line {line}, {RUN}: found `{label}`, expected `{first}` as in the first row: one drive; cut out one run")


def filled(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """NaN filled linearly, the first and the last number held beyond them: rounded as the tool does it, and np.interp does not."""
    there = np.flatnonzero(~np.isnan(values))
    values = values.copy()
    values[:there[0]], values[there[-1]:] = values[there[0]], values[there[-1]]
    rows = np.flatnonzero(np.isnan(values))
    after = np.searchsorted(there, rows)
    start, end = there[after - 1], there[after]
    share = (time[rows] - time[start]) / (time[end] - time[start])
    values[rows] = values[start] + (values[end] - values[start]) * share
    return values


def read_samples(path: Path) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of the parameters, number of each drive, and its parameters."""
    header, rows = read(path)
    numbers = rows[:, header.index(INDEX)].astype(np.uint64) if INDEX in header else np.arange(len(rows), dtype=np.uint64)
    names = [name for name in header if name != INDEX]
    return names, numbers, np.ascontiguousarray(rows[:, [header.index(name) for name in names]])


def column(values: np.ndarray) -> pa.Array:
    """Numbers, of which those that are missing are null, not NaN."""
    return pa.array(values, mask=np.isnan(values))


def texts(values: Sequence[str | None]) -> pa.Array:
    """Texts, of which those that are missing are null."""
    return pa.array(values, type=pa.string())


def write(path: Path, columns: dict[str, pa.Array | Sequence], metadata: dict[str, str]) -> None:
    """Writes Parquet; the same columns give the same bytes."""
    table = pa.table(columns).replace_schema_metadata(metadata)
    part = path.with_name(path.name + ".part")
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, part, compression="zstd")
    os.replace(part, path)
