#!/usr/bin/env python3
"""Drives FMUs with a recording's wheel speeds through fmpy, from its first pose on, and draws where they go beside where the vehicle went.

Nothing of the recording but its first pose and its wheel speeds reaches the FMUs: what is left of the distance between the curves is
the model's, added up over the whole drive.
"""

import argparse
import csv
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import fmpy
import numpy as np
from matplotlib import rcParams
from matplotlib.figure import Figure

STEP = 0.01  # s between two settings of the wheel speeds
STANDSTILL = 0.05  # rad/s
COLORS = ["#d97706", "#059669", "#2563eb", "#9333ea"]


NEEDED = ("omega_left", "omega_right", "x", "y", "heading")

Series = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Followed:
    """How far an FMU is from the recorded path [m]."""

    name: str
    rms: float
    last: float
    seconds: float

    def __str__(self) -> str:
        return f"{self.name}: {self.rms:.3f} m RMS, {self.last:.3f} m after {self.seconds:.0f} s"


class Refused(Exception):
    """What the user has to put right."""


def read(path: Path) -> dict[str, Series]:
    """Times from the first row on, as `ugv simulate` counts them, and values of each column that is needed; cells may be empty."""
    try:
        lines = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error) as error:
        raise Refused(f"{path}: no CSV in UTF-8 ({error})") from error
    header = [name.strip() for name in lines[0]] if lines else []
    for name in ("time", *NEEDED):
        if name not in header:
            raise Refused(f"{path}: line 1: there is no column {name}; needed are time, {', '.join(NEEDED)}")
    told: dict[str, list[tuple[float, float]]] = {name: [] for name in NEEDED}
    last, first, run = -math.inf, math.nan, None
    for number, cells in enumerate(lines[1:], 2):
        if not any(cells):
            continue
        if len(cells) != len(header):
            raise Refused(f"{path}: line {number}: {len(cells)} cells, not {len(header)} as in the header")
        row = dict(zip(header, cells, strict=True))
        values = {name: finite(row[name], f"{path}: line {number}: {name}") for name in NEEDED if row[name].strip()}
        time = finite(row["time"], f"{path}: line {number}: time")
        if time <= last:
            raise Refused(f"{path}: line {number}: time {time:.12g} is not after {last:.12g}; cut out one run")
        if last == -math.inf:
            first, run = time, row.get("run")
        if row.get("run") != run:
            raise Refused(f"{path}: line {number}: run {row['run']} follows run {run}; cut out one run")
        last = time
        for name, value in values.items():
            told[name].append((time - first, value))
    for name, samples in told.items():
        if len(samples) < 2:
            raise Refused(f"{path}: fewer than two values of {name}")
    return {name: tuple(np.array(samples).T) for name, samples in told.items()}


def finite(text: str, place: str) -> float:
    """The number in a cell."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise Refused(f"{place} is `{text}`, not a finite number")
    return value


def drive(fmu: Path, recording: dict[str, Series], seconds: float) -> np.ndarray:
    """Time, east and north of an FMU."""
    wheels = [recording[name] for name in ("omega_left", "omega_right")]
    pose = {name: recording[name] for name in ("x", "y", "heading")}
    pose["heading"] = pose["heading"][0], np.unwrap(pose["heading"][1])
    begin = max(time[0] for time, _ in [*wheels, *pose.values()])  # where the vehicle is known to be
    end = min(begin + seconds, *(time[-1] for time, _ in wheels))
    clock = np.arange(begin, end, STEP)
    if len(clock) < 2:
        raise Refused("the recording has no two moments with both wheel speeds; name one that is longer")
    speeds = [np.interp(clock, *series) for series in wheels]
    kind = [("time", float), ("omega_left", float), ("omega_right", float)]
    signals = np.array(list(zip(clock, *speeds, strict=True)), dtype=kind)
    start = {f"initial.{name}": np.interp(begin, *series) for name, series in pose.items()}
    start |= {"omega_left": speeds[0][0], "omega_right": speeds[1][0]}
    start["initial.no_slip"] = bool(max(abs(speed[0]) for speed in speeds) > STANDSTILL)
    try:
        result = fmpy.simulate_fmu(str(fmu), start_time=begin, stop_time=clock[-1], output_interval=STEP, input=signals,
                                   start_values=start, output=["x", "y"], fmi_type="CoSimulation")
    except Exception as error:  # fmpy raises whatever the archive, its description or its library give rise to
        raise Refused(f"{fmu}: {error}; name an FMU that `ugv package` made for this platform") from error
    return np.array([result["time"], result["x"], result["y"]])


def save(figure: Figure, path: Path) -> None:
    """Writes the picture beside and renames it."""
    part = path.with_name(f".{path.name}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(part, dpi=150)
        part.replace(path)
    except (OSError, ValueError) as error:
        part.unlink(missing_ok=True)
        raise Refused(f"{path} cannot be written ({error}); name another picture with --output") from error


def follow(recording: Path, fmus: list[Path], seconds: float) -> tuple[Figure, list[Followed]]:
    """Drives and draws; how far each FMU gets from the path."""
    followed = []
    series = read(recording)
    figure = Figure(figsize=(6, 7), layout="constrained")
    ground, error = figure.subplots(2, height_ratios=[3, 1])
    (time, east), (other, north) = series["x"], series["y"]
    north = np.interp(time, other, north)
    shown = time < time[0] + seconds
    ground.plot(east[shown], north[shown], color=rcParams["text.color"], linewidth=3, alpha=0.35, label=f"recorded: {recording.name}")
    for fmu, color in zip(fmus, COLORS * len(fmus), strict=False):
        clock, x, y = drive(fmu, series, seconds)
        at = shown & (time >= clock[0]) & (time <= clock[-1])
        if not at.any():
            raise Refused(f"{recording}: no pose while the wheel speeds are there")
        away = np.hypot(np.interp(time[at], clock, x) - east[at], np.interp(time[at], clock, y) - north[at])
        ground.plot(x, y, color=color, label=fmu.name)
        error.plot(time[at], away, color=color)
        followed.append(Followed(fmu.name, float(np.sqrt(np.mean(away**2))), float(away[-1]), float(time[at][-1] - time[at][0])))
    ground.set(xlabel="East (m)", ylabel="North (m)", aspect="equal")
    ground.legend(frameon=False)
    error.set(xlabel="Time (s)", ylabel="Distance (m)")
    return figure, followed


def main() -> None:
    """Reads the arguments, and does what they say."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    add = parser.add_argument
    add("recording", type=Path, help="recording (CSV) with wheel speeds and pose, of one run")
    add("fmus", type=Path, nargs="+", metavar="FMU", help="FMUs, as `ugv package` makes them")
    add("--seconds", type=float, default=60.0, help="how long to drive [default: 60]")
    add("--output", type=Path, default=Path("target/follow.png"), help="picture to draw [default: target/follow.png]")
    arguments = parser.parse_args()
    for path in (arguments.recording, *arguments.fmus):
        if not path.is_file():
            parser.error(f"{path} is not there")
    if not 0.0 < arguments.seconds < math.inf:
        parser.error(f"--seconds {arguments.seconds} is no time to drive; give more than 0")
    if arguments.output.is_dir():
        parser.error(f"--output {arguments.output} is a folder; name a picture, such as {arguments.output / 'follow.png'}")
    try:
        figure, followed = follow(arguments.recording, arguments.fmus, arguments.seconds)
        save(figure, arguments.output)
        print(*followed, sep="\n")
    except Refused as error:
        sys.exit(f"follow_recording: {error}")


if __name__ == "__main__":
    main()
