#!/usr/bin/env python3
"""An external controller: drives target/ugv.fmu around a figure of eight through fmpy.

Every 20 ms it reads pose, velocity and yaw rate, and sets the two wheel speeds. It knows nothing of
the soil. On sand half of the outer wheels' speed is slip in a curve, so the wheel speeds of rolling
without slip (--open-loop) leave the path at once; two loops keep the vehicle on it:

1. Path: yaw_rate = speed (curvature - error / L^2 - 2 course_error / L). To first order the error
   e(s) over the distance s obeys e'' + 2 e'/L + e/L^2 = 0: it dies out within a few L.
2. Wheels: each side shall cover speed -/+ yaw_rate B over ground. What it does cover per metre that
   its wheels roll is its grip (1 - slip); dividing by the measured grip makes up for any soil.
"""

import argparse
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from matplotlib.figure import Figure

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[2] / "target"))
TERRAINS = {"dry_sand": 1, "sandy_loam": 2, "clayed_soil": 3, "dry_clay": 4}
STATE = ["x", "y", "heading", "v_x", "v_y", "yaw_rate"]
SLIP = ["wheel[1].longitudinal_slip", "wheel[2].longitudinal_slip"]  # all of a side's are equal
SIDES = np.array([-1.0, 1.0])  # left, right: a left turn slows the left side
STEP, SPACING = 0.02, 0.01  # s between two commands, m between the points of the path
SIZE, START_OFFSET = 12.0, -0.5  # m from the crossing to a loop's end, m beside it at the start
CRUISE, RAMP = 1.2, 0.5  # m/s, and m/s^2 at which it is reached from rest
SETTLED = 6.0  # s from which on the error counts: at speed, and the start made up for
LOOKAHEAD = 1.5  # m, the L above: 1 m wobbles on dry clay, 2 m nearly doubles the error
CURVATURE_LIMIT, WHEEL_LIMIT = 0.35, 15.0  # 1/m, rad/s: beyond, wheels only dig in dry sand
GRIP_TIME = 0.3  # s, low pass of the grip: 0.1 s halves the error, but passes sensor noise on
SPEED_GAIN = 0.5  # share of a side's speed error added at once, before the grip has followed


@contextmanager
def running(fmu: Path, terrain: str, **start: float) -> Iterator[tuple[FMU2Slave, dict]]:
    """The FMU, initialised and ready to step, and its variables' references by name."""
    with tempfile.TemporaryDirectory() as folder:
        fmpy.extract(str(fmu), folder)
        model = fmpy.read_model_description(folder)
        reference = {v.name: v.valueReference for v in model.modelVariables}
        name = model.coSimulation.modelIdentifier
        slave = FMU2Slave(guid=model.guid, unzipDirectory=folder, modelIdentifier=name)
        slave.instantiate()
        try:
            slave.setInteger([reference["terrain"]], [TERRAINS[terrain]])
            slave.setReal([reference[p] for p in start], start.values())
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
            slave.exitInitializationMode()
            yield slave, reference
        finally:
            slave.freeInstance()


def figure_of_eight() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position (east + i north), course and curvature at the points of a lemniscate."""
    angle = np.linspace(-0.5 * np.pi, 1.5 * np.pi, 100_001)
    curve = SIZE * np.cos(angle) * (1 + 1j * np.sin(angle)) / (1 + np.sin(angle) ** 2)
    travelled = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(curve)))])
    along = np.arange(0.0, travelled[-1], SPACING)
    course = np.interp(along, travelled, np.unwrap(np.angle(np.gradient(curve))))
    return np.interp(along, travelled, curve), course, np.gradient(course, SPACING)


def follow(fmu: Path, terrain: str, laps: int = 1, feedback: bool = True) -> np.ndarray:
    """One row per step: time, x, y, cross-track error, both wheel speeds, both slips."""
    path, course, curvature = figure_of_eight()
    start = path[0] + START_OFFSET * 1j * np.exp(1j * course[0])
    initial = {"initial.x": start.real, "initial.y": start.imag, "initial.heading": course[0]}
    rows, progress, planned, grip, omega = [], 0, 0.0, np.ones(2), np.zeros(2)
    with running(fmu, terrain, **initial) as (slave, reference):
        r, B = slave.getReal([reference[f"vehicle.{p}"] for p in ("wheel_radius", "half_track")])
        while max(progress, planned / SPACING / 2) < laps * len(path) - 1:  # or gives up
            state = slave.getReal([reference[name] for name in STATE + SLIP])
            x, y, heading, v_x, v_y, yaw_rate, *slips = state
            speed = min(CRUISE, RAMP * len(rows) * STEP)
            planned += speed * STEP
            if feedback:  # from the nearest point, searched for ahead of the last one
                ahead = np.arange(progress, progress + 50)
                progress = ahead[np.argmin(np.abs(path[ahead % len(path)] - (x + 1j * y)))]
                at = progress % len(path)
                error = ((x + 1j * y - path[at]) * np.exp(-1j * course[at])).imag
                course_error = np.angle(np.exp(1j * (heading + v_y / max(v_x, 0.2) - course[at])))
                bend = curvature[at] - error / LOOKAHEAD**2 - 2 * course_error / LOOKAHEAD
                bend = np.clip(bend, -CURVATURE_LIMIT, CURVATURE_LIMIT)
                wanted, covered = speed * (1 + SIDES * bend * B), v_x + SIDES * yaw_rate * B
                measured = np.clip(covered / np.maximum(r * omega, 0.2), 0.2, 1.5)
                grip += (measured - grip) * STEP / GRIP_TIME
                omega = (wanted / grip + SPEED_GAIN * (wanted - covered)) / r
            else:  # where the vehicle should be by now; the error from any point
                progress = int(planned / SPACING)
                error = np.min(np.abs(path - (x + 1j * y)))
                omega = speed * (1 + SIDES * curvature[progress % len(path)] * B) / r
            omega = np.clip(omega, 0.0, WHEEL_LIMIT)
            rows.append([len(rows) * STEP, x, y, error, *omega, *slips])
            slave.setReal([reference["omega_left"], reference["omega_right"]], omega)
            slave.doStep(rows[-1][0], STEP)
    return np.array(rows)


def errors(rows: np.ndarray) -> tuple[float, float]:
    """RMS and largest cross-track error [m] once the start is over."""
    error = rows[rows[:, 0] >= SETTLED, 3]
    return float(np.sqrt(np.mean(error**2))), float(np.max(np.abs(error)))


def draw(rows: np.ndarray) -> Figure:
    """The path driven against the reference; error, wheel speeds and slips over time."""
    figure = Figure(figsize=(6, 8), layout="constrained")
    panels = figure.subplot_mosaic([["map"], ["map"], ["error"], ["speed"], ["slip"]])
    path = figure_of_eight()[0]
    panels["map"].plot(path.real, path.imag, "--", color="#888888", label="reference")
    panels["map"].plot(rows[:, 1], rows[:, 2], color="#059669", label="driven")
    panels["map"].set(xlabel="East (m)", ylabel="North (m)", aspect="equal")
    panels["error"].plot(rows[:, 0], 100 * rows[:, 3], color="#059669")
    panels["error"].set(title="Distance from the path, left positive (cm)")
    panels["speed"].plot(rows[:, 0], rows[:, 4:6], label=["left", "right"])
    panels["speed"].set(title="Wheel speeds (rad/s)")
    panels["slip"].plot(rows[:, 0], 100 * rows[:, 6:8])
    panels["slip"].set(title="Longitudinal slip (%)", xlabel="Time (s)")
    for name in ("map", "speed"):
        panels[name].legend(loc="upper center", frameon=False)
    return figure


def main() -> None:
    """Reads the arguments, drives, draws, and prints one line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    add = parser.add_argument
    add("--fmu", type=Path, default=TARGET / "ugv.fmu", help="default: target/ugv.fmu")
    add("--terrain", choices=TERRAINS, default="dry_sand", help="default: dry_sand")
    add("--laps", type=int, default=1, help="figures of eight to drive (default: 1)")
    add("--open-loop", action="store_true", help="no feedback: wheel speeds without slip")
    add("--output", type=Path, default=TARGET / "demo/figure_of_eight.png", help="picture to draw")
    arguments = parser.parse_args()
    rows = follow(arguments.fmu, arguments.terrain, arguments.laps, not arguments.open_loop)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    draw(rows).savefig(arguments.output, dpi=150)
    print("{:.3f} m RMS, {:.3f} m at most beside the path".format(*errors(rows)))


if __name__ == "__main__":
    main()
