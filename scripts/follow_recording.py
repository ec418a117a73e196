#!/usr/bin/env python3
"""Drives FMUs with a recording's wheel speeds through fmpy, from its first pose on, and draws where they go beside where the vehicle went.

Nothing of the recording but its first pose and its wheel speeds reaches the FMUs: what is left of the distance between the curves is
the model's, added up over the whole drive.
"""

import argparse
import csv
import sys
from pathlib import Path

import fmpy
import numpy as np
from matplotlib.figure import Figure

STEP = 0.01  # s between two settings of the wheel speeds
STANDSTILL = 0.05  # rad/s
COLORS = ["#d97706", "#059669", "#2563eb", "#9333ea"]


def column(rows: list[dict[str, str]], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of a column's samples."""
    told = [(float(row["time"]), float(row[name])) for row in rows if row.get(name)]
    if len(told) < 2:
        sys.exit(f"follow_recording: the recording has no {name}")
    time, values = np.array(told).T
    return time, values


def drive(fmu: Path, rows: list[dict[str, str]], seconds: float) -> np.ndarray:
    """Time, east and north of an FMU."""
    wheels = [column(rows, name) for name in ("omega_left", "omega_right")]
    begin = max(time[0] for time, _ in wheels)
    end = min(begin + seconds, *(time[-1] for time, _ in wheels))
    clock = np.arange(begin, end, STEP)
    speeds = [np.interp(clock, *series) for series in wheels]
    kind = [("time", float), ("omega_left", float), ("omega_right", float)]
    signals = np.array(list(zip(clock, *speeds, strict=True)), dtype=kind)
    start = {f"initial.{name}": values[0] for name in ("x", "y", "heading") for _, values in [column(rows, name)]}
    start |= {"omega_left": speeds[0][0], "omega_right": speeds[1][0]}
    start["initial.no_slip"] = bool(max(abs(speed[0]) for speed in speeds) > STANDSTILL)
    result = fmpy.simulate_fmu(str(fmu), start_time=begin, stop_time=clock[-1], output_interval=STEP, input=signals,
                               start_values=start, output=["x", "y"], fmi_type="CoSimulation")
    return np.array([result["time"], result["x"], result["y"]])


def main() -> None:
    """Reads the arguments, drives, draws, and prints a line for each FMU."""
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
    with arguments.recording.open(newline="") as file:
        rows = list(csv.DictReader(file))
    figure = Figure(figsize=(6, 7), layout="constrained")
    ground, error = figure.subplots(2, height_ratios=[3, 1])
    (time, east), (_, north) = column(rows, "x"), column(rows, "y")
    shown = time < time[0] + arguments.seconds
    ground.plot(east[shown], north[shown], color="black", linewidth=3, alpha=0.35, label=f"recorded: {arguments.recording.name}")
    for fmu, color in zip(arguments.fmus, COLORS * len(arguments.fmus), strict=False):
        clock, x, y = drive(fmu, rows, arguments.seconds)
        at = shown & (time >= clock[0]) & (time <= clock[-1])
        away = np.hypot(np.interp(time[at], clock, x) - east[at], np.interp(time[at], clock, y) - north[at])
        ground.plot(x, y, color=color, label=fmu.name)
        error.plot(time[at], away, color=color)
        print(f"{fmu.name}: {np.sqrt(np.mean(away**2)):.3f} m RMS, {away[-1]:.3f} m after {time[at][-1] - time[at][0]:.0f} s")
    ground.set(xlabel="East (m)", ylabel="North (m)", aspect="equal")
    ground.legend(frameon=False)
    error.set(xlabel="Time (s)", ylabel="Distance (m)")
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(arguments.output, dpi=150)


if __name__ == "__main__":
    main()
