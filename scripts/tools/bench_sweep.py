#!/usr/bin/env python3
"""Compares what a drive costs by `ugv sweep`, by scripts/examples/sweep.py alone and by its Dask workers: processor time, so that it may share the machine.

The three take turns on the same table; each also does a table of one drive, which tells what starting it costs.
"""

import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))


def cost(command: list[str | Path]) -> tuple[float, float]:
    """Seconds of processor, of the process and all that it started, and of the clock."""
    before, begin = os.times(), time.monotonic()
    ended = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if ended.returncode:
        sys.exit(f"{' '.join(map(str, command))}: {ended.stderr}")
    after = os.times()
    used = after.children_user + after.children_system - before.children_user - before.children_system
    return used, time.monotonic() - begin


def commands(tool: Path, arguments: argparse.Namespace, folder: Path) -> dict[str, Callable[[Path], list[str | Path]]]:
    """What is compared, as a function of the table."""
    common = ["--input", arguments.input, "--terrain", arguments.terrain, "--quiet"]
    script = [sys.executable, ROOT / "scripts" / "examples" / "sweep.py", *common, "--fmu", arguments.fmu, "--output", folder / "ends.parquet"]
    return {"ugv sweep": lambda table: [tool, "sweep", *common, "--output", folder / "ends.csv", "--force", "--table", table],
            "sweep.py --serial": lambda table: [*script, "--serial", "--table", table],
            "sweep.py": lambda table: [*script, "--table", table]}


def main() -> None:
    """Measures and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    add = parser.add_argument
    add("--input", type=Path, required=True, metavar="FILE.csv", help="wheel speeds")
    add("--table", type=Path, required=True, metavar="FILE.csv", help="parameters, as ugv sweep --samples-only writes them")
    add("--terrain", default="clayed_soil", help="default: clayed_soil")
    add("--drives", type=int, default=400, help="how many of the table's (default: 400)")
    add("--rounds", type=int, default=5, help="turns of each (default: 5)")
    add("--fmu", type=Path, default=TARGET / "ugv.fmu", help="default: target/ugv.fmu")
    add("--tool", type=Path, default=TARGET / "release" / "ugv", help="default: target/release/ugv")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, arguments.table.open(newline="") as file:
        folder = Path(name)
        lines = list(islice(csv.reader(file), arguments.drives + 1))
        tables = {}
        for count in (1, len(lines) - 1):
            tables[count] = folder / f"{count}.csv"
            tables[count].write_text("".join(",".join(line) + "\n" for line in lines[:count + 1]))
        one, many = tables
        measured: dict[str, list[tuple[float, float, float]]] = {}
        for _ in range(arguments.rounds):
            for label, command in commands(arguments.tool, arguments, folder).items():
                (start, _), (used, clock) = (cost(command(tables[count])) for count in (one, many))
                measured.setdefault(label, []).append(((used - start) / (many - one), start, clock))
    base = [row[0] for row in measured["ugv sweep"]]
    print(f"{many} drives, {arguments.rounds} rounds; in brackets: the lowest and the highest round")
    for label, rows in measured.items():
        drive, start, clock = (statistics.median(column) for column in zip(*rows, strict=True))
        ratios = sorted(row[0] / other for row, other in zip(rows, base, strict=True))
        print(f"{label:18} {1e3 * drive:6.2f} ms of processor per drive, {statistics.median(ratios):.2f} of ugv sweep's "
              f"[{ratios[0]:.2f}, {ratios[-1]:.2f}]; {start:.2f} s to start; {clock:.1f} s on the clock")


if __name__ == "__main__":
    main()
