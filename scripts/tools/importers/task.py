"""What every importer is to do, and how it tells what came of it. Needs nothing but Python: each importer has an environment of its own."""

import argparse
import csv
import json
import math
import xml.etree.ElementTree
import zipfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

STEP = 0.01  # s: the wheel speeds are constant within it
STEPS = 1000
INPUTS = ["omega_left", "omega_right"]

# Dry sand, a heavier vehicle that tows, a pose of its own. The velocities hold only if the Boolean is not set: who does not set it deviates.
START: dict[str, float | int | bool] = {
    "terrain": 1,
    "vehicle.mass": 520.0,
    "effects.drawbar.force": 60.0,
    "initial.x": 2.0,
    "initial.y": -1.0,
    "initial.heading": 0.5,
    "initial.v_x": 0.4,
    "initial.yaw_rate": 0.1,
    "initial.no_slip": True,
}

ENUMERATION = "terrain"  # of the start values


def starts() -> dict[str, dict[str, float | int | bool]]:
    """The start values for importers that set all, all but enumerations, or numbers alone."""
    plain = {name: value for name, value in START.items() if name != ENUMERATION}
    return {"all": START, "plain": plain, "reals": {name: value for name, value in START.items() if isinstance(value, float)}}


# Seconds, and the left and right wheel speed (rad/s) that are reached at their end.
PHASES = [
    (0.2, 0.0, 0.0),  # at rest, so that it does not matter who sets the first speeds when
    (1.3, 6.0, 6.0),
    (1.0, 4.5, 7.0),
    (1.0, 7.0, 4.5),
    (1.0, 6.0, 6.0),
    (1.0, 0.0, 0.0),
    (1.5, -4.0, -5.0),
    (1.0, -3.0, 3.0),
    (1.0, -3.0, 3.0),
    (0.5, 0.0, 0.0),
    (0.5, 0.0, 0.0),
]


def manoeuvre() -> list[tuple[float, float, float]]:
    """Time and wheel speeds, smoothly from phase to phase; the last row is the end."""
    rows, begin, before = [], 0.0, (0.0, 0.0)
    for seconds, *after in PHASES:
        for number in range(round(seconds / STEP)):
            share = (1 - math.cos(math.pi * number * STEP / seconds)) / 2
            left, right = (a + (b - a) * share for a, b in zip(before, after, strict=True))
            rows.append((round(begin + number * STEP, 2), round(left, 6), round(right, 6)))
        begin, before = begin + seconds, after
    return [*rows, (STEPS * STEP, *before)]


@dataclass
class Variable:
    """A variable as the FMU's description has it; elements of an array carry the names of FMI 2.0."""

    name: str
    reference: int
    type: str
    causality: str
    size: int = 1

    def scalars(self) -> list[str]:
        """What its elements are called in FMI 2.0."""
        if not self.name.startswith("wheel."):
            return [self.name]
        return [self.name.replace("wheel.", f"wheel[{number + 1}].") for number in range(self.size)]


def variables(fmu: Path) -> dict[str, Variable]:
    """The variables of an FMU, read without the importer."""
    with zipfile.ZipFile(fmu) as archive:
        root = xml.etree.ElementTree.fromstring(archive.read("modelDescription.xml"))
    found = []
    for element in root.find("ModelVariables"):
        size = math.prod(int(dimension.get("start")) for dimension in element.findall("Dimension"))
        kind = element.tag if element.tag != "ScalarVariable" else element[0].tag
        about = (element.get("name"), int(element.get("valueReference")), kind, element.get("causality", "local"))
        found.append(Variable(*about, size))
    return {variable.name: variable for variable in found}


class Task:
    """The FMU, the drive, and where the motion goes."""

    def __init__(self, fmu: Path, drive: Path, output: Path) -> None:
        self.fmu, self.output = fmu, output
        self.variables = variables(fmu)
        self.inputs = [self.variables[name] for name in INPUTS]
        self.outputs = [variable for variable in self.variables.values() if variable.causality == "output"]
        with (drive / "drive.csv").open(newline="") as file:
            self.drive = [tuple(map(float, row.values())) for row in csv.DictReader(file)]
        self.start: dict[str, float | int | bool] = json.loads((drive / "start.json").read_text())

    def speeds(self, time: float) -> tuple[float, float]:
        """The wheel speeds of the step that begins at a time, which may be off by rounding."""
        return self.drive[min(round(time / STEP), STEPS)][1:]

    def steps(self) -> Iterable[tuple[float, float, list[float]]]:
        """Begin, length and wheel speeds of each step."""
        for (time, *speeds), (end, *_) in zip(self.drive, self.drive[1:], strict=False):
            yield time, end - time, speeds

    def write(self, rows: Iterable[Sequence[float]], names: Sequence[str] | None = None) -> None:
        """Leaves the motion: time and outputs."""
        scalars = names or [name for variable in self.outputs for name in variable.scalars()]
        with self.output.open("w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["time", *scalars])
            table.writerows([repr(float(value)) for value in row] for row in rows)


def main(**drives: Callable[[Task], None]) -> None:
    """Carries out one of a driver's drives, as the arguments say."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=drives)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("drive", type=Path, help="folder with drive.csv and start.json")
    parser.add_argument("output", type=Path, help="motion to write, CSV")
    arguments = parser.parse_args()
    drives[arguments.what](Task(arguments.fmu, arguments.drive, arguments.output))
