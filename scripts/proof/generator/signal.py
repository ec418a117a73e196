"""How loud an effect is in a recording, and how much of it re-tuning the soil would hide.

Predictions start anew every 5 s. Their changes with the effect, the soil's parameters (log scale) and the starts come
from differences of the simulator, are whitened by the true noise, and projected by QR. What re-tuning leaves is what the
least squares leave within the soils that there are, at first, and then once the soil has gone where they lead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import lsq_linear

from .catalogue import EFFECTS
from .sensors import Samples, Sensors, interpolate, report, sample_times
from .simulator import COARSE, Drive, Setup, Snapshot, Undrivable, Window, begin, drive_on, make_world
from .world import Soil

STRETCH = 5.0  # s
STEP = 0.05  # s between records
TOLERANCE = 2e-4
SETTLED = 1.5  # s after which a changed start velocity has become a moved and turned path
PROBE = 0.02  # of a soil parameter
ROUNDS = 12  # of re-tuning
FARTHEST = 1.2  # logarithm of what a soil parameter may be multiplied by
DAMPING = 0.05  # of the largest column, to begin with
ENDED = 2.0  # sigma: what is left does not matter any more
SOIL_PROBES = ("k", "sinkage_exponent", "cohesion", "friction_angle_deg", "shear_modulus")


@dataclass(frozen=True)
class Signal:
    """Sizes in standard deviations of the noise: starts free; starts and soil free."""

    raw: float
    left: float

    @property
    def absorbed(self) -> float:
        """Share of the power that re-tuning the soil takes."""
        return 1.0 - (self.left / self.raw) ** 2 if self.raw > 0.0 else 0.0

    def numbers(self) -> dict[str, float]:
        """For the truth."""
        return {"raw": round(self.raw, 4), "left": round(self.left, 4)}


def _scaled(soil: Soil, name: str, factor: float) -> Soil:
    if name == "k":
        return replace(soil, cohesive_modulus=soil.cohesive_modulus * factor,
                       frictional_modulus=soil.frictional_modulus * factor)
    return replace(soil, **{name: getattr(soil, name) * factor})


@dataclass
class Case:
    """A drive of a vehicle with its sensors: the place where signals are measured."""

    setup: Setup
    drive: Drive
    sensors: Sensors
    samples: Samples
    faults: dict[str, dict[str, float]]
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Ruler:
    """Measures signals on one drive. Raises Undrivable."""

    def __init__(self, case: Case):
        self.case = case
        self.channels = list(case.sensors.channels)
        self.begins = np.arange(0.0, case.drive.seconds - 0.5, STRETCH)
        world = make_world(case.setup, case.drive, COARSE)
        snapshot = begin(world, case.pose)
        self.snapshots: list[Snapshot] = []
        self.truth: list[np.ndarray] = []
        for at in self.begins:
            self.snapshots.append(snapshot.copy())
            self.truth.append(drive_on(world, snapshot, at, self._length(at), TOLERANCE, STEP))
        factors: dict[str, np.ndarray] = {}
        for name in self.channels:
            times = sample_times(case.samples, name)
            key = f"{case.sensors.channels[name]}{len(times)}"
            if key not in factors:
                factors[key] = cholesky(case.sensors.channels[name].covariance(times), lower=True)
            factors[name] = factors[key]
        self.factors = {name: factors[name] for name in self.channels}
        self.without: dict[tuple[str, ...], list[np.ndarray]] = {}

    def _length(self, at: float) -> float:
        left = self.case.drive.seconds - at
        return min(STRETCH, np.floor(left / STEP + 1e-6) * STEP)

    def predict(self, setup: Setup, drive: Drive) -> list[np.ndarray]:
        """Stretches from the true starts."""
        key = tuple(setup.effects)
        ours = all(values is self.case.setup.effects.get(name) for name, values in setup.effects.items())
        usual = drive is self.case.drive and setup.soil is self.case.setup.soil and ours
        if usual and key in self.without:
            return self.without[key]
        world = make_world(setup, drive, COARSE)
        stretches = [drive_on(world, snapshot.copy(), at, self._length(at), TOLERANCE, STEP)
                     for at, snapshot in zip(self.begins, self.snapshots)]
        if usual:
            self.without[key] = stretches
        return stretches

    def observe(self, stretches: list[np.ndarray], faults: dict[str, dict[str, float]]) -> dict[str, np.ndarray]:
        """What the sensors would report without noise."""
        parts: dict[str, list[np.ndarray]] = {name: [] for name in self.channels}
        rows = math.ceil(max([0.0, *faults.get("latency", {}).values()]) / STEP)
        before = None
        for at, records in zip(self.begins, stretches):
            wheels, poses = self._within(self.case.samples.wheel_times, at), self._within(self.case.samples.pose_times, at)
            lead = at - rows * STEP
            local = Samples(self.case.samples.wheel_times[wheels] - lead, self.case.samples.pose_times[poses] - lead)
            earlier = _backwards(records[0], rows) if before is None else before[len(before) - 1 - rows : -1]
            for name, values in report(np.concatenate([earlier, records]), STEP, local, self.channels, faults).items():
                parts[name].append(values)
            before = records if stretches is self.truth else None
        return {name: np.concatenate(p) for name, p in parts.items()}

    def _within(self, times: np.ndarray, at: float) -> np.ndarray:
        last = at == self.begins[-1]
        return (times >= at) & ((times < at + STRETCH) | last)

    def whiten(self, change: dict[str, np.ndarray]) -> np.ndarray:
        """Stacked over the channels."""
        return np.concatenate([solve_triangular(self.factors[n], change[n], lower=True) for n in self.channels])

    def _change(self, a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> np.ndarray:
        return self.whiten({n: a[n] - b[n] for n in self.channels})

    def starts(self, off: Setup, base: list[np.ndarray]) -> np.ndarray:
        """Columns of the stretches' starts around predictions: place, heading, velocities."""
        world = make_world(off, self.case.drive, COARSE)
        times = {n: sample_times(self.case.samples, n) for n in self.channels}
        columns = []
        for at, snapshot, records in zip(self.begins, self.snapshots, base):
            inside = {n: self._within(times[n], at) for n in self.channels}
            rows = {n: interpolate(records, STEP, times[n][inside[n]] - at) for n in self.channels}
            moved = [self._moved(rows, records, direction) for direction in range(3)]
            length = min(SETTLED, self._length(at))
            count = int(round(length / STEP))
            for j in range(3):
                trial = snapshot.copy()
                trial.state[3 + j] += 0.02
                probe = drive_on(world, trial, at, length, TOLERANCE, STEP)
                short = (probe - records[: count + 1]) / 0.02
                x, y, turn = short[-1, :3]
                column = {}
                for n in self.channels:
                    t = times[n][inside[n]] - at
                    index = ("x", "y", "heading", "v_x", "v_y", "yaw_rate").index(n)
                    early = np.interp(t, np.arange(count + 1) * STEP, short[:, index])
                    late = np.zeros_like(early)
                    if n == "x":
                        late = x - turn * (rows[n][:, 1] - records[count, 1])
                    elif n == "y":
                        late = y + turn * (rows[n][:, 0] - records[count, 0])
                    elif n == "heading":
                        late = np.full_like(early, turn)
                    column[n] = np.where(t <= length, early, late)
                moved.append(column)
            for column in moved:
                full = {n: np.zeros(len(times[n])) for n in self.channels}
                for n in self.channels:
                    full[n][inside[n]] = column[n]
                columns.append(self.whiten(full))
        return np.stack(columns, 1)

    def _moved(self, rows: dict[str, np.ndarray], records: np.ndarray, direction: int) -> dict[str, np.ndarray]:
        column = {n: np.zeros(len(rows[n])) for n in self.channels}
        if direction < 2:
            column["xy"[direction]][:] = 1.0
        else:
            column["x"] = -(rows["x"][:, 1] - records[0, 1])
            column["y"] = rows["y"][:, 0] - records[0, 0]
            column["heading"] = np.ones(len(rows["heading"]))
        return column

    def columns(self, off: Setup) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
        """Predictions with the effects off, what the starts can change as `span`, and the soil's columns."""
        base = self.predict(off, self.case.drive)
        return base, span(self.starts(off, base)), self.soil_columns(off, base)

    def soil_columns(self, off: Setup, base: list[np.ndarray]) -> np.ndarray:
        """Changes by the soil's parameters (log scale) around predictions."""
        seen = self.observe(base, {})
        soil = []
        for name in SOIL_PROBES:
            probed = self.predict(replace(off, soil=_scaled(off.soil, name, 1.0 + PROBE)), self.case.drive)
            soil.append(self._change(self.observe(probed, {}), seen) / PROBE)
        return np.stack(soil, 1)

    def moved(self, off: Setup, base: list[np.ndarray], to: Setup) -> tuple[list[np.ndarray], np.ndarray]:
        """Predictions on another soil, and how they differ."""
        there = self.predict(to, self.case.drive)
        return there, self._change(self.observe(there, {}), self.observe(base, {}))

    def difference(self, names: list[str]) -> np.ndarray:
        """Whitened change of the recording by some of the effects."""
        physics = [n for n in names if EFFECTS[n].kind != "sensor"]
        faults = {n: v for n, v in self.case.faults.items() if n not in names}
        late = self.case.faults.get("latency", {}).get("wheels", 0.0) if "latency" in names else 0.0
        drive = self._delayed(late)
        without = self.truth if not physics and late == 0.0 else self.predict(self.case.setup.without(*physics), drive)
        return self._change(self.observe(self.truth, self.case.faults), self.observe(without, faults))

    def response(self, effect: str, values: dict[str, float], window: Window | None = None) -> np.ndarray:
        """Whitened change of the recording by an effect that is added to the model without any, throughout or in a window."""
        bare = self.case.setup.without(*self.case.setup.effects)
        base = self.observe(self.predict(bare, self.case.drive), {})
        if EFFECTS[effect].kind != "sensor":
            added = replace(bare, effects={effect: values}, windows={effect: window} if window else {})
            return self._change(self.observe(self.predict(added, self.case.drive), {}), base)
        drive = self._delayed(values.get("wheels", 0.0) if effect == "latency" else 0.0)
        return self._change(base, self.observe(self.predict(bare, drive), {})) + self._change(
            self.observe(self.predict(bare, self.case.drive), {effect: values}), base)

    def _delayed(self, late: float) -> Drive:
        """The drive as wheel speeds that come late tell it."""
        drive = self.case.drive
        if late == 0.0:
            return drive
        grid = np.arange(len(drive.speeds)) * drive.step
        return replace(drive, speeds=np.stack([np.interp(grid - late, grid, drive.speeds[:, i]) for i in range(2)], 1))


def _backwards(record: np.ndarray, rows: int) -> np.ndarray:
    """Where a vehicle would come from that has always driven as it does in a record."""
    earlier = np.repeat(record[None], rows, axis=0)
    earlier[:, 6:9] = 0.0
    for row in range(rows - 1, -1, -1):
        next_row = earlier[row + 1] if row + 1 < rows else record
        heading = next_row[2] - 0.5 * STEP * record[5]
        c, s = math.cos(heading), math.sin(heading)
        earlier[row, 0] = next_row[0] - STEP * (record[3] * c - record[4] * s)
        earlier[row, 1] = next_row[1] - STEP * (record[3] * s + record[4] * c)
        earlier[row, 2] = next_row[2] - STEP * record[5]
    return earlier


def span(columns: np.ndarray) -> np.ndarray:
    """Orthonormal columns that reach what these reach."""
    return np.linalg.qr(columns)[0]


def _freed(parts: list[np.ndarray], starts: list[np.ndarray]) -> np.ndarray:
    """Vectors or columns of each drive without what its starts explain (each a `span`), stacked."""
    return np.concatenate([part - q @ (q.T @ part) for part, q in zip(parts, starts)])


def _left(signal: np.ndarray, columns: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Size of what the columns leave of a vector, each times a factor between two."""
    lengths = np.linalg.norm(columns, axis=0)
    moving = lengths > 0.0
    if not moving.any():
        return float(np.linalg.norm(signal))
    scaled, lengths = columns[:, moving] / lengths[moving], lengths[moving]
    q, r = np.linalg.qr(np.column_stack([scaled, signal]))
    bounds = low[moving] * lengths, high[moving] * lengths
    return float(np.sqrt(2.0 * lsq_linear(r[:, :-1], r[:, -1], bounds, method="bvls").cost))


def project(signals: list[np.ndarray], starts: list[np.ndarray], soils: list[np.ndarray]) -> Signal:
    """Sizes over several drives: starts (each a `span`) are each drive's own, the soil is shared and stays within the
    soils that there are."""
    signal, soil = _freed(signals, starts), _freed(soils, starts)
    farthest = np.full(soil.shape[1], FARTHEST)
    return Signal(float(np.linalg.norm(signal)), _left(signal, soil, -farthest, farthest))


def retuned(rulers: list[Ruler], offs: list[Setup], bases: list[list[np.ndarray]], signals: list[np.ndarray],
            starts: list[np.ndarray], soils: list[np.ndarray]) -> float:
    """Size of what is left of a signal where the soil, shared by the drives, is re-tuned as far as that leads.

    Levenberg and Marquardt; an upper bound, for the rounds are few.
    """
    steps, damping = np.zeros(len(SOIL_PROBES)), DAMPING
    residual, columns = _freed(signals, starts), _freed(soils, starts)
    left = float(np.linalg.norm(residual))
    for _ in range(ROUNDS):
        held = np.vstack([columns, np.eye(len(steps)) * damping * np.linalg.norm(columns, axis=0).max()])
        step = np.linalg.lstsq(held, np.concatenate([residual, np.zeros(len(steps))]), rcond=None)[0]
        trial = np.clip(steps + step, -FARTHEST, FARTHEST)
        try:
            soil = offs[0].soil
            for name, by in zip(SOIL_PROBES, trial):
                soil = _scaled(soil, name, float(np.exp(by)))
            there = [replace(off, soil=soil) for off in offs]
            moved = [r.moved(off, base, to) for r, off, base, to in zip(rulers, offs, bases, there)]
            tried = _freed([signal - change for signal, (_, change) in zip(signals, moved)], starts)
            size = float(np.linalg.norm(tried))
        except Undrivable:
            size = np.inf
        if size >= left:
            damping *= 5.0
            continue
        gained, left, steps, residual, damping = left - size, size, trial, tried, 0.2 * damping
        if gained < 0.02 * left or left < ENDED:
            break
        try:
            columns = _freed([r.soil_columns(to, base) for r, to, (base, _) in zip(rulers, there, moved)], starts)
        except Undrivable:
            break
    return left


def left_beside(signals: list[np.ndarray], starts: list[np.ndarray], soils: list[np.ndarray],
                others: list[np.ndarray], one_sided: list[bool]) -> float:
    """Size of what the soil and another effect, shared by the drives, leave: columns that are one-sided only added."""
    soil = _freed(soils, starts)
    farthest = np.full(soil.shape[1], FARTHEST)
    low = np.concatenate([-farthest, np.where(one_sided, 0.0, -np.inf)])
    high = np.concatenate([farthest, np.full(len(one_sided), np.inf)])
    return _left(_freed(signals, starts), np.column_stack([soil, _freed(others, starts)]), low, high)
