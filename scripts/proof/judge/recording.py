"""A recording: its channels, the state at a moment, and windows to predict."""

import csv
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

HORIZON = 4.0  # s that are predicted
SPACING = 1.5  # s between the starts of windows
BEFORE = 40.0  # s of the course that led to a window
COURSE_STEP = 0.2  # s between its poses
MARGIN = 0.6  # s on either side that tell the state at a moment
LONGEST_GAP = 0.5  # s without wheel speeds that are bridged
STRAY = 0.15  # m from where its neighbours tell a position to be, from which on it may be an outlier
STRAY_DEVIATIONS = 6.0  # times the median distance, the same

Series = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Sensors:
    """What a model says of the sensors; the names are the catalogue's."""

    latency: dict[str, float] = field(default_factory=dict)  # pose, yaw_rate, wheels
    lever_arm: dict[str, float] = field(default_factory=dict)  # ahead, left
    yaw_rate_bias: dict[str, float] = field(default_factory=dict)  # bias
    heading_offset: dict[str, float] = field(default_factory=dict)  # offset


PERFECT = Sensors()


@dataclass(frozen=True)
class State:
    """Pose and body-frame velocities."""

    x: float
    y: float
    heading: float
    v_x: float
    v_y: float
    yaw_rate: float


@dataclass(frozen=True)
class Window:
    """Wheel speeds from a known state on, and the states that followed. Times from the start of the window."""

    number: int  # of the start, the same for every model of a recording
    start: float
    initial: State
    time: np.ndarray
    left: np.ndarray
    right: np.ndarray
    final: State
    course: np.ndarray  # x, y, heading over which the vehicle came to the initial state, the oldest first


def local(series: Series, at: float, half: float, degree: int) -> np.ndarray | None:
    """Value and derivative at a moment by a polynomial through what is near; None where too little is."""
    time, values = series
    near = slice(*np.searchsorted(time, [at - half - 1e-9, at + half + 1e-9]))
    dt = time[near] - at
    if len(dt) < degree + 2 or dt[0] > -half / 4 or dt[-1] < half / 4:
        return None
    return np.polynomial.polynomial.polyfit(dt, values[near], degree)[:2]


def distances(time: np.ndarray, place: np.ndarray) -> np.ndarray:
    """How far each position is from a quadratic through its neighbours; 0 where these are too few to tell a state."""
    away = np.zeros(len(time))
    for k, at in enumerate(time):
        fit = local((np.delete(time, k), np.delete(place, k, axis=0)), at, MARGIN, 2)
        away[k] = 0.0 if fit is None else np.hypot(*(place[k] - fit[0]))
    return away


def strays(time: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Which positions (rows of x and y) are outliers. Neighbours are so near in time that motion with accelerations within
    2.5 m/s^2 leaves their quadratic by less than `STRAY`. The worst of neighbours goes first, as it spoils their curves."""
    kept = np.arange(len(time))
    while True:
        now, away = time[kept], distances(time[kept], place[kept])
        usual = float(np.median(away[away > 0.0])) if np.any(away > 0.0) else 0.0
        far = np.flatnonzero(away > max(STRAY, STRAY_DEVIATIONS * usual))
        worst = [k for k in far if away[k] >= away[np.abs(now - now[k]) <= MARGIN].max()]
        if not worst:
            return np.delete(np.arange(len(time)), kept)
        kept = np.delete(kept, worst)


class Recording:
    """Channels without their missing samples and the position's outliers, with the sensors' faults taken out as a model
    tells them. When windows start, and which positions are outliers, is the same whatever a model tells."""

    def __init__(self, path: Path, sensors: Sensors = PERFECT) -> None:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        names = rows[0].keys()
        columns = {name: np.array([float(row[name] or "nan") for row in rows]) for name in names if name != "run"}
        if {"x", "y"} <= columns.keys():
            place = np.column_stack([columns["x"], columns["y"]])
            there = np.flatnonzero(np.isfinite(place).all(axis=1))
            out = there[strays(columns["time"][there], place[there])]
            columns["x"][out] = columns["y"][out] = np.nan
        late = {"pose": ["x", "y", "heading"], "yaw_rate": ["yaw_rate"], "wheels": ["omega_left", "omega_right"]}
        delay = {column: sensors.latency.get(key, 0.0) for key, group in late.items() for column in group}
        self.channels: dict[str, Series] = {}
        spans = []
        for name, values in columns.items():
            there = np.isfinite(values)
            if name != "time" and there.sum() > 2:
                self.channels[name] = columns["time"][there] - delay.get(name, 0.0), values[there]
                spans.append(columns["time"][there][[0, -1]])
        if "heading" in self.channels:
            time, heading = self.channels["heading"]
            self.channels["heading"] = time, np.unwrap(heading) - sensors.heading_offset.get("offset", 0.0)
        if "yaw_rate" in self.channels:
            time, rate = self.channels["yaw_rate"]
            self.channels["yaw_rate"] = time, rate - sensors.yaw_rate_bias.get("bias", 0.0)
        self.ahead, self.left = sensors.lever_arm.get("ahead", 0.0), sensors.lever_arm.get("left", 0.0)
        self.begin, self.end = max(first for first, _ in spans), min(last for _, last in spans)

    def heading(self, at: float) -> float | None:
        """Heading by the samples of a second on either side, carried over by the gyro where there is one."""
        if "yaw_rate" not in self.channels:
            fit = local(self.channels["heading"], at, MARGIN, 2)
            return None if fit is None else float(fit[0])
        time, heading = self.channels["heading"]
        near = slice(*np.searchsorted(time, [at - 1.0, at + 1.0]))
        if near.stop - near.start < 4:
            return None
        clock, rate = self.channels["yaw_rate"]
        turned = np.concatenate([[0.0], np.cumsum(np.diff(clock) * (rate[1:] + rate[:-1]) / 2)])
        return float(np.mean(heading[near] - np.interp(time[near], clock, turned)) + np.interp(at, clock, turned))

    def state(self, at: float) -> State | None:
        """The state at a moment; None where the recording does not tell it."""
        x, y = (local(self.channels[name], at, MARGIN, 2) for name in "xy")
        heading = self.heading(at)
        if x is None or y is None or heading is None:
            return None
        source = "yaw_rate" if "yaw_rate" in self.channels else "heading"
        turning = local(self.channels[source], at, MARGIN / 2 if source == "yaw_rate" else MARGIN, 2)
        if turning is None:
            return None
        rate = float(turning[0] if source == "yaw_rate" else turning[1])
        c, s = np.cos(heading), np.sin(heading)
        v = [c * x[1] + s * y[1] + rate * self.left, c * y[1] - s * x[1] - rate * self.ahead]
        for k, name in enumerate(("v_x", "v_y")):
            if name in self.channels:
                fit = local(self.channels[name], at, MARGIN / 2, 1)
                v[k] = v[k] if fit is None else fit[0]
        place = x[0] - c * self.ahead + s * self.left, y[0] - s * self.ahead - c * self.left
        return State(*map(float, (*place, heading, *v, rate)))

    def course(self) -> tuple[np.ndarray, np.ndarray]:
        """Poses x, y, heading over time, where they are known."""
        clock = np.arange(self.begin, self.end, COURSE_STEP)
        states = [(at, state) for at in clock if (state := self.state(at)) is not None]
        poses = np.array([(state.x, state.y, state.heading) for _, state in states]).reshape(-1, 3)
        return np.array([at for at, _ in states]), poses

    def wheels(self, start: float, end: float) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Wheel speeds between two moments, ends included; None where they are missing for long."""
        both = [self.channels[name] for name in ("omega_left", "omega_right")]
        inner = both[0][0][(both[0][0] > start + 1e-6) & (both[0][0] < end - 1e-6)]
        time = np.concatenate([[start], inner, [end]])
        if np.diff(time).max() > LONGEST_GAP:
            return None
        return time - start, *(np.interp(time, *series) for series in both)

    def windows(self, spacing: float = SPACING, horizon: float = HORIZON) -> list[Window]:
        """Windows in which the vehicle moves and whose ends the recording tells."""
        found = []
        clock, course = self.course()
        for number, start in enumerate(np.arange(self.begin + 1.0, self.end - horizon - 1.0 + 1e-9, spacing)):
            ends = self.state(start), self.state(start + horizon)
            wheels = self.wheels(start, start + horizon)
            if wheels is None or ends[0] is None or ends[1] is None:
                continue
            if max(np.abs(wheels[1]).mean(), np.abs(wheels[2]).mean()) > 0.05:
                before = course[(clock > start - BEFORE) & (clock < start - 1e-9)]
                found.append(Window(number, float(start), ends[0], *wheels, ends[1], before))
        return found
