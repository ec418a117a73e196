"""Tables: wheel speeds and samples in, Parquet out. Files are written beside and renamed."""

import csv
import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

INDEX = "index"
INPUT = ["time", "omega_left", "omega_right"]


def read(path: Path) -> tuple[list[str], np.ndarray]:
    """Header and numbers of a CSV file; ends with line and column where a cell is no finite number."""
    try:
        with path.open(newline="") as file:
            lines = csv.reader(file)
            header = [name.strip() for name in next(lines, [])]
            rows = [[_number(path, lines.line_num, name, cell) for name, cell in zip(header, cells, strict=True)] for cells in lines]
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    except ValueError:
        sys.exit(f"{path}, line {lines.line_num}: not as many cells as the header has, {len(header)}")
    if len(rows) < 1:
        sys.exit(f"{path}: there is no row below the header")
    if len(set(header)) < len(header):
        sys.exit(f"{path}: a column is named twice in {', '.join(header)}")
    return header, np.array(rows)


def _number(path: Path, line: int, name: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        sys.exit(f"{path}, line {line}, {name}: found `{cell}`, expected a finite number")
    return value


def read_input(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the left and right wheel speed at each."""
    header, rows = read(path)
    if missing := [name for name in INPUT if name not in header]:
        sys.exit(f"{path}: no column {missing[0]}; the header needs {', '.join(INPUT)}")
    time, *speeds = (np.ascontiguousarray(rows[:, header.index(name)]) for name in INPUT)
    if len(time) < 2:
        sys.exit(f"{path}: a drive of one row leads nowhere; give two rows or more")
    if (late := np.flatnonzero(np.diff(time) <= 0)).size:
        sys.exit(f"{path}: time {time[late[0] + 1]} s does not come after {time[late[0]]} s")
    return time, np.column_stack(speeds)


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
