"""One drive in both simulators."""

from __future__ import annotations

import json
import math
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from generator.drives import draw_series
from generator.simulator import FINE, STEP, Drive, Setup, simulate
from generator.world import VEHICLES, Soil

INTERVAL = 0.05  # s between rows that are compared


class Refused(Exception):
    """The library did not drive it; its message."""


@dataclass(frozen=True)
class Difference:
    """Largest differences of a drive: position over the path driven, heading [rad], both over what the effect moves."""

    position: float
    heading: float
    of_effect: float


def manoeuvre(seconds: float = 12.0, wheel_radius: float = 0.25) -> Drive:
    """Start, turns both ways, braking, as fast for every wheel as 4 rad/s is for one of 0.25 m: wheel speeds every 0.05 s."""
    t = np.arange(0.0, seconds + 1e-9, INTERVAL)
    mean = 4.0 * np.clip(t / 2.0, 0.0, 1.0) - 2.5 * np.clip((t - 0.75 * seconds) / 0.7, 0.0, 1.0)
    bend = 1.5 * np.sin(2.0 * math.pi * t / 7.0) * np.clip((t - 2.0) / 2.0, 0.0, 1.0)
    speeds = np.stack([mean - bend, mean + bend], axis=1) * (0.25 / wheel_radius)
    return Drive(speeds, INTERVAL, draw_series(np.random.default_rng(3), seconds), 0.05)


def turning_on_the_spot(seconds: float = 20.0, wheel_radius: float = 0.25) -> Drive:
    """Straight on with a turn on the spot to either side, as fast for every wheel as 4 rad/s is for one of 0.25 m."""
    share, left, right = np.array([  # of the time; speeds of the sides
        (0.0, 0.0, 0.0), (0.075, 4.0, 4.0), (0.2, 4.0, 4.0), (0.23, -2.5, 2.5), (0.4, -2.5, 2.5), (0.43, 4.0, 4.0),
        (0.55, 4.0, 4.0), (0.58, 2.5, -2.5), (0.75, 2.5, -2.5), (0.78, 4.0, 4.0), (0.95, 4.0, 4.0), (1.0, 0.0, 0.0)]).T
    t = np.arange(0.0, seconds + 1e-9, INTERVAL)
    speeds = np.stack([np.interp(t / seconds, share, side) for side in (left, right)], axis=1) * (0.25 / wheel_radius)
    return Drive(speeds, INTERVAL, draw_series(np.random.default_rng(3), seconds), 0.05)


def drive_library(tool: Path, vehicle: str, soil: Soil, effects: dict[str, dict[str, float]], drive: Drive) -> np.ndarray:
    """x, y, heading of `ugv simulate` at the drive's times. Raises Refused."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        times = np.arange(len(drive.speeds)) * drive.step
        np.savetxt(folder / "in.csv", np.column_stack([times, drive.speeds]), delimiter=",", comments="",
                   header="time,omega_left,omega_right")
        (folder / "vehicle.json").write_text(json.dumps(VEHICLES[vehicle].numbers()))
        (folder / "terrain.json").write_text(json.dumps(soil.numbers()))
        (folder / "effects.json").write_text(json.dumps({"format": "ugv-effects/1", **effects}))
        done = subprocess.run([tool, "simulate", "--input", folder / "in.csv", "--vehicle", folder / "vehicle.json",
                               "--terrain", folder / "terrain.json", "--effects", folder / "effects.json", "--output-step", "input",
                               "--output", folder / "out.csv", "--quiet"], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Refused(done.stderr.strip())
        return np.loadtxt(folder / "out.csv", delimiter=",", skiprows=1)[:, 3:6]


def drive_generator(vehicle: str, soil: Soil, effects: dict[str, dict[str, float]], drive: Drive) -> np.ndarray:
    """x, y, heading of the generator at the drive's times."""
    return simulate(Setup(VEHICLES[vehicle], soil, effects), drive, table=FINE, untouched=True)[:: round(drive.step / STEP), :3]


def compare(tool: Path, vehicle: str, soil: Soil, effects: dict[str, dict[str, float]], drive: Drive,
            plain: np.ndarray) -> Difference:
    """Both drive it with the effects; plain: the generator without them. Raises Refused."""
    theirs = drive_library(tool, vehicle, soil, effects, drive)
    mine = drive_generator(vehicle, soil, effects, drive)
    count = min(len(mine), len(theirs))
    difference, effect = mine[:count] - theirs[:count], mine - plain
    length = np.hypot(*np.diff(mine[:, :2], axis=0).T).sum()
    position, heading = _largest(difference)
    moved, turned = _largest(effect)
    of_effect = max(position / moved, heading / turned) if effects and moved > 0.0 and turned > 0.0 else 0.0
    return Difference(position / length, heading, of_effect)


def _largest(path: np.ndarray) -> tuple[float, float]:
    return float(np.hypot(path[:, 0], path[:, 1]).max()), float(np.abs(path[:, 2]).max())
