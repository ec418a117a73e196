"""Speed control of the FMU with a limit on slip, as an SSP: builds it, runs it with and without the limit, and draws both.

Writes slip_control.ssp (and without_limit.ssp), the controller's and the driver's FMU, and the picture into --output.
"""

import argparse
import csv
import os
import subprocess
import tempfile
from pathlib import Path

import fmpy
import numpy as np

from .drawing import draw
from .masters import Columns, cosimulate, largest_difference, run_ssp
from .system import NO_LIMIT, SAND_FROM, STEP, STOP, Setting, build_ssp

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[4] / "target"))
SLIP, SPEED = "ugv.wheel[1].longitudinal_slip", "ugv.v_x"
WORKER = Path(__file__).with_name("libcosim.py")


def run_libcosim(ssp: Path, python: Path, names: list[str]) -> Columns:
    """By libcosim, in the Python that has it."""
    with tempfile.TemporaryDirectory() as folder:
        fmpy.extract(str(ssp), f"{folder}/ssp")
        result = Path(folder) / "result.csv"
        command = [str(python), str(WORKER), f"{folder}/ssp", str(round(STOP / STEP)), str(STEP), str(result), *names]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"slip_control: libcosim did not run {ssp}:\n{done.stdout}{done.stderr}")
        with result.open(newline="") as file:
            header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


def tell(name: str, columns: Columns) -> None:
    """One line on a run: where it came to, and its largest slip once it is on the loose sand."""
    loose = columns["ugv.x"] > SAND_FROM
    slip = f"slip on the loose sand at most {columns[SLIP][loose].max():.3f}" if loose.any() else "the loose sand was not reached"
    print(f"{name}: {columns['ugv.x'][-1]:.2f} m after {columns['time'][-1]:.0f} s, at {columns[SPEED][-1]:.2f} m/s; {slip}")


def main() -> None:
    """Reads the arguments, builds, runs, compares, draws."""
    parser = argparse.ArgumentParser(prog="controllers.sh slip_control", description=__doc__)
    add = parser.add_argument
    add("--ugv", type=Path, default=TARGET / "ugv.fmu", metavar="FMU", help="the vehicle [default: target/ugv.fmu]")
    add("--slip-limit", type=float, default=0.2, metavar="S", help="of the driving wheels, 0 to 1 [default: %(default)s]")
    add("--libcosim", type=Path, metavar="PYTHON", help="compare with libcosim, in a Python that has libcosimpy")
    add("--output", type=Path, default=TARGET / "controllers", metavar="DIR", help="[default: target/controllers]")
    arguments = parser.parse_args()
    if not arguments.ugv.is_file():
        parser.error(f"{arguments.ugv} is not there; build it with scripts/package.sh")
    if not 0.0 < arguments.slip_limit < NO_LIMIT:
        parser.error(f"--slip-limit {arguments.slip_limit} is not between 0 and {NO_LIMIT:g}")
    runs = {}
    for name, limit in (("slip_control", arguments.slip_limit), ("without_limit", NO_LIMIT)):
        ssp = arguments.output / f"{name}.ssp"
        build_ssp(ssp, arguments.ugv, Setting(limit))
        runs[name] = run_ssp(ssp)
        tell(name, runs[name])
        print(f"  differs from a master of our own by {largest_difference(cosimulate(ssp), runs[name]):.1e}")
        if arguments.libcosim:
            outputs = [output for output in runs[name] if output.startswith("ugv.") and "omega" not in output]
            other = run_libcosim(ssp, arguments.libcosim, outputs)
            print(f"  differs from libcosim by {largest_difference(other, runs[name]):.1e}")
    picture = arguments.output / "slip_control.png"
    draw(runs["slip_control"], runs["without_limit"], arguments.slip_limit).savefig(picture, dpi=100)
    print(f"{picture}: drawn")


if __name__ == "__main__":
    main()
