"""A vehicle on its ground, driven by wheel speeds: the simulator as seen from Python."""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass, field

import numpy as np

from .catalogue import EFFECTS, MAX_ROWS, SERIES, I, off_vector, slot
from .contact import rule
from .stepper import AUX, MARK, MARKED, MARKS, MET, STATE, run
from .world import GRAVITY, Soil, Vehicle, parameter_vector

STEP = 0.025  # s between records
TOLERANCE = 2e-5  # m/s and rad/s, of a step
FINE, PLAIN, COARSE = rule(24, 5), rule(12, 3), rule(8, 2)

World = namedtuple("World", "p off window_of windows drive series steps table")


class Undrivable(Exception):
    """The vehicle bogs down, or a wheel has no steady contact."""


@dataclass(frozen=True)
class Window:
    """Where an effect acts: seconds from..to, or a disc on the map."""

    kind: str  # "time" or "disc"
    numbers: tuple[float, ...]  # from, to; or x, y, radius

    def row(self) -> list[float]:
        """As the stepper reads it."""
        return [1.0 if self.kind == "time" else 2.0, *self.numbers, 0.0][:4]


@dataclass
class Setup:
    """Vehicle, soil and the effects that are on: {effect: {parameter: value}}."""

    vehicle: Vehicle
    soil: Soil
    effects: dict[str, dict[str, float]] = field(default_factory=dict)
    windows: dict[str, Window] = field(default_factory=dict)

    def without(self, *names: str) -> Setup:
        """The same with some effects off."""
        return Setup(self.vehicle, self.soil, {k: v for k, v in self.effects.items() if k not in names}, self.windows)


@dataclass
class Snapshot:
    """All that the simulator carries from one moment to the next."""

    state: np.ndarray
    tracks: np.ndarray
    start: np.ndarray

    def copy(self) -> Snapshot:
        """One that can be driven on by itself."""
        return Snapshot(self.state.copy(), self.tracks.copy(), self.start.copy())


@dataclass
class Drive:
    """True wheel speeds [rad/s] (left, right) every `step` seconds, and the random series that outside effects read."""

    speeds: np.ndarray
    step: float
    series: np.ndarray = field(default_factory=lambda: np.zeros((2, SERIES)))
    series_step: float = 0.05

    @property
    def seconds(self) -> float:
        """Its length."""
        return (len(self.speeds) - 1) * self.step


def make_world(setup: Setup, drive: Drive, table: np.ndarray = FINE) -> World:
    """The arrays that the stepper reads."""
    p = parameter_vector(setup.vehicle, setup.soil)
    window_of = np.full(len(p), -1, dtype=np.int64)
    windows = []
    for effect, values in setup.effects.items():
        for parameter, value in values.items():
            p[slot(effect, parameter)] = value
        if effect in setup.windows:
            for parameter in EFFECTS[effect].parameters:
                window_of[slot(effect, parameter)] = len(windows)
            windows.append(setup.windows[effect].row())
    off = p.copy()
    gated = window_of >= 0
    off[gated] = off_vector()[gated]
    rows = np.array(windows, dtype=float).reshape((-1, 4))
    return World(p, off, window_of, rows, np.ascontiguousarray(drive.speeds, dtype=float), drive.series,
                 np.array([drive.step, drive.series_step]), table)


def begin(world: World, pose: tuple[float, float, float] = (0.0, 0.0, 0.0),
          velocity: tuple[float, float, float] = (0.0, 0.0, 0.0), untouched: bool = False) -> Snapshot:
    """A vehicle that came here straight, its first row's tracks behind it; or one on untouched ground."""
    p = world.p
    wheels = 2 * int(p[I.rows])
    state = np.zeros(STATE)
    state[0:3], state[3:6] = pose, velocity
    state[AUX + 4] = pose[2]
    tracks = np.zeros((2 * MAX_ROWS, MARKS, 3))
    if not untouched:
        load, diameter = p[I.mass] * GRAVITY / wheels, 2.0 * p[I.wheel_radius]
        depth = (3.0 * load / ((3.0 - p[I.n]) * p[I.k] * p[I.wheel_width] * np.sqrt(diameter))) ** (2.0 / (2.0 * p[I.n] + 1.0))
        c, s = np.cos(pose[2]), np.sin(pose[2])
        along = p[I.row0] - p[I.com_offset] - np.arange(MARKS)[::-1] * MARK
        for wheel, left in enumerate((p[I.half_track], -p[I.half_track])):
            east, north = pose[0] + along * c - left * s, pose[1] + along * s + left * c
            tracks[wheel] = np.stack([east, north, np.full(MARKS, depth)], 1)
            state[MARKED + wheel] = MARKS
        state[MET + 2 : MET + wheels] = depth
    return Snapshot(state, tracks, np.zeros(2 * wheels + 2))


def drive_on(world: World, snapshot: Snapshot, time: float, seconds: float, tolerance: float = TOLERANCE,
             step: float = STEP) -> np.ndarray:
    """Drive on from a snapshot (which moves on). Rows every `step`: pose, velocities, their rates."""
    count = int(round(seconds / step))
    records = np.empty((count + 1, 9))
    reached = run(world, time, count, step, snapshot.state, snapshot.tracks, snapshot.start, tolerance, records)
    if reached <= count or not np.isfinite(records).all():
        raise Undrivable(f"no steady contact at {time + reached * step:.2f} s; choose slower speeds or firmer soil")
    return records


def simulate(setup: Setup, drive: Drive, pose: tuple[float, float, float] = (0.0, 0.0, 0.0),
             velocity: tuple[float, float, float] = (0.0, 0.0, 0.0), tolerance: float = TOLERANCE,
             table: np.ndarray = FINE, untouched: bool = False) -> np.ndarray:
    """A whole drive from a pose; `untouched`: from ground on which no wheel was before."""
    world = make_world(setup, drive, table)
    return drive_on(world, begin(world, pose, velocity, untouched), 0.0, drive.seconds, tolerance)
