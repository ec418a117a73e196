#!/usr/bin/env python3
"""Drives the FMU with many sets of parameters on Dask workers, and writes a Parquet table of where each drive ends.

The sets come from a table that `ugv sweep --samples-only` writes: one row per drive, a column for each parameter, by the FMU's names.
The numbers are those of `ugv sweep --table`, bit for bit, wherever and in whatever order the drives are done.
"""

import argparse
import hashlib
import json
import math
import os
import sys
import tempfile
import time
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np

from scale import cluster, picture, table
from scale.fmu import RESULTS, Sweep, WrongParameters

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[2] / "target"))
TERRAINS = {"dry_sand": 1, "sandy_loam": 2, "clayed_soil": 3, "dry_clay": 4, "custom": 5}
STATE = ["x", "y", "heading", "v_x", "v_y", "yaw_rate"]
VELOCITIES = {"initial.v_x", "initial.v_y", "initial.yaw_rate"}
BATCH_STEPS = 50_000  # of a piece of work: about a second
EPILOG = """\
examples:
  ugv sweep --vary soil.cohesion=log-normal:1040,1.3 --samples 10000 --samples-only --output samples.csv
  target/venv/bin/python scripts/examples/sweep.py --input drive.csv --table samples.csv --terrain dry_sand --output ends.parquet --map ends.png
  target/venv/bin/python scripts/examples/sweep.py --input drive.csv --table samples.csv --fmu mine.fmu --scheduler tcp://10.0.0.1:8786 --output ends.parquet

A vehicle, soil or effects of your own: package an FMU with them (ugv package --model model.json --output mine.fmu).
A drive that does not reach the end has the reason in the column `error`; its other columns tell of the last row that it reached.
"""


def resource(fmu: Path, name: str) -> dict:
    """One of the FMU's resources."""
    with zipfile.ZipFile(fmu) as archive:
        return json.loads(archive.read(f"resources/{name}"))


def fixed(fmu: Path, terrain: str | None, initial: list[str], names: list[str]) -> dict[str, float | int | bool]:
    """What is set in all drives: the terrain, the rest of the soil where some of it differs, and the start."""
    values: dict[str, float | int | bool] = {}
    if any(name.startswith("soil.") for name in names):
        own = resource(fmu, "terrain.json")
        terrain = terrain or own["selected"]
        soil = own["custom"] if terrain == "custom" else resource(fmu, "terrains.json")[terrain]
        values |= {f"soil.{name}": float(value) for name, value in soil.items()}
        terrain = "custom"
    if terrain:
        values["terrain"] = TERRAINS[terrain]
    for word in initial:
        key, value = (part.strip() for part in word.partition("=")[::2])
        if word == "no-slip":
            values["initial.no_slip"] = True
        elif f"initial.{key}" in values and key in STATE:
            sys.exit(f"--initial sets {key} twice")
        elif key in STATE and is_finite(value):
            values[f"initial.{key}"] = float(value)
        else:
            sys.exit(f"--initial {word}: expected no-slip, or KEY=NUMBER with one of {', '.join(STATE)}")
    taken = VELOCITIES if "initial.no_slip" in values else set()
    if both := sorted(taken & values.keys()):
        sys.exit(f"--initial sets {both[0].removeprefix('initial.')} beside no-slip, which sets it too")
    for name in names:
        if name in taken or (name.startswith("initial.") and name in values):
            sys.exit(f"{name} differs from drive to drive, and --initial sets it too; leave it out of one of them")
    return {name: value for name, value in values.items() if name not in names}


def is_finite(text: str) -> bool:
    """Whether a text is a finite number."""
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def check_names(fmu: Path, names: list[str], path: Path) -> None:
    """Ends at a column that is no parameter of the FMU."""
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    known = {v.name for v in variables if v.causality == "parameter" and v.type == "Real"}
    if unknown := [name for name in names if name not in known]:
        sys.exit(f"{path}: `{unknown[0]}` is no parameter of {fmu}; they are in its documentation (soil.*, vehicle.*, initial.*, "
                 "effects.*, of which those that remember must be on when it is packaged)")


def check_outputs(parser: argparse.ArgumentParser, outputs: list[Path], inputs: list[Path]) -> None:
    """Ends where what is written would replace what is read, or cannot be written: known before the drives, not after them."""
    taken = {path.resolve() for path in inputs}
    for path in outputs:
        if path.resolve() in taken:
            parser.error(f"{path} is read as well, or written twice; take another name")
        taken.add(path.resolve())
        if path.is_dir():
            parser.error(f"{path} is a folder; name a file in it")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=path.parent).close()
        except OSError as error:
            parser.error(f"{path} cannot be written ({error.strerror}); name another file")


def digest(path: Path) -> str:
    """Tells one file from another."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def main() -> None:
    """Reads the arguments, drives, writes, and prints a line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0], epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--input", type=Path, required=True, metavar="FILE.csv", help="wheel speeds: time,omega_left,omega_right")
    add("--table", type=Path, required=True, metavar="FILE.csv", help="parameters: one row per drive")
    add("--output", type=Path, required=True, metavar="FILE.parquet", help="where each drive ends")
    add("--fmu", type=Path, default=TARGET / "ugv.fmu", help="FMU of FMI 2.0 [default: target/ugv.fmu]")
    add("--terrain", choices=TERRAINS, help="[default: the FMU's]; the parameters soil.* begin with its values")
    add("--initial", nargs="+", action="extend", default=[], metavar="KEY=VALUE|no-slip", help="where it starts, as for ugv simulate")
    add("--map", type=Path, metavar="FILE.png", help="draw where the vehicle ends up")
    add("--batch", type=cluster.at_least_one, metavar="N", help="drives in a piece of work [default: as many as take about a second]")
    add("--quiet", action="store_true", help="no progress")
    cluster.add_arguments(parser)
    arguments = parser.parse_args()
    for path in (arguments.input, arguments.table, arguments.fmu):
        if not path.is_file():
            parser.error(f"{path} is not there" + ("; scripts/package.sh builds it" if path == arguments.fmu else ""))
    if arguments.map and picture.kind(arguments.map) not in picture.KINDS:
        parser.error(f"--map {arguments.map}: no picture ends in {arguments.map.suffix}; there are {', '.join(sorted(picture.KINDS))}")
    check_outputs(parser, [path for path in (arguments.output, arguments.map) if path], [arguments.input, arguments.table, arguments.fmu])

    clock, speeds = table.read_input(arguments.input)
    names, numbers, values = table.read_samples(arguments.table)
    check_names(arguments.fmu, names, arguments.table)
    common = fixed(arguments.fmu, arguments.terrain, arguments.initial, names)
    sweep = Sweep(arguments.fmu.read_bytes(), clock, speeds, names, common)
    size = arguments.batch or max(1, BATCH_STEPS // len(clock))
    pieces = [(numbers[at:at + size], values[at:at + size]) for at in range(0, len(values), size)]
    begin = time.monotonic()
    try:
        results = cluster.with_progress("sweep", cluster.do_all(arguments, sweep, pieces), len(pieces), arguments.quiet)
        blocks = [block for _, block in sorted(results, key=lambda result: result[0])]
        if any(isinstance(block, cluster.Lost) for block in blocks):
            sys.exit("sweep: a piece of work took its workers down, one after the other; give them more memory, or a smaller --batch")
    except (WrongParameters, RuntimeError) as error:
        sys.exit(f"sweep: {error}")
    passed = time.monotonic() - begin

    kept = np.concatenate([block for block, _ in blocks])
    errors = [error for _, block in blocks for error in block]
    columns = {table.INDEX: numbers} | dict(zip(names, map(table.column, values.T), strict=True))
    columns |= dict(zip(RESULTS, map(table.column, kept.T), strict=True)) | {"error": table.texts(errors)}
    made_of = {key: digest(path) for key, path in (("fmu", arguments.fmu), ("input", arguments.input), ("table", arguments.table))}
    table.write(arguments.output, columns, {"ugv-sweep/1": json.dumps(made_of | {"fixed": common})})
    failed = sum(error is not None for error in errors)
    print(f"{len(errors)} drives of {clock[-1] - clock[0]:.2f} s in {passed:.2f} s, {len(errors) / passed:.0f} per second; "
          f"{failed} did not reach the end")
    if arguments.map:
        where = [1 + STATE.index(name) for name in ("x", "y")]
        picture.draw(arguments.map, kept[:, where], np.array([error is None for error in errors]),
                     nominal(arguments, sweep))


def nominal(arguments: argparse.Namespace, sweep: Sweep) -> np.ndarray:
    """The path with the parameters that all those in the table vary about."""
    common = fixed(arguments.fmu, arguments.terrain, arguments.initial, [])
    with tempfile.TemporaryDirectory() as folder:
        plain = replace(sweep, names=[], fixed=common)
        plain.setup(Path(folder))
        return plain.vehicle.path(np.empty(0))


if __name__ == "__main__":
    main()
