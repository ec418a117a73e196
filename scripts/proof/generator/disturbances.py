"""Errors of sensors that are neither white nor a first-order process: reflected satellite signals, a heading that wanders,
scale factors. The noise model of a tool need not have them."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

import numpy as np

GYRO_SCALE = (0.01, 0.02)  # share, either sign
WHEEL_SCALE = (0.003, 0.007)
JUMP = (0.08, 0.35)  # m
JUMP_SECONDS = (1.0, 5.0)
JUMPS_EVERY = (12.0, 30.0)  # s
WANDER = (0.0005, 0.0015)  # rad after a second, growing with the root of the time
KINDS = ("jumps_every", "wander", "gyro_scale", "wheel_scale")


@dataclass(frozen=True)
class Disturbances:
    """What one set of sensors suffers from; 0 is off. The same in all recordings of a case."""

    jumps_every: float = 0.0  # s between jumps of the position, on average
    wander: float = 0.0  # rad / sqrt(s) of the heading
    gyro_scale: float = 0.0  # relative error of the yaw rate
    wheel_scale: float = 0.0  # relative error of both wheel speeds

    def numbers(self) -> dict[str, float]:
        """For the truth."""
        return asdict(self)

    @property
    def some(self) -> bool:
        """Whether there is any."""
        return any(asdict(self).values())

    def disturb(self, rng: np.random.Generator, values: dict[str, np.ndarray], pose_times: np.ndarray) -> None:
        """Adds them to the channels of one recording."""
        if self.jumps_every:
            at = float(rng.exponential(self.jumps_every))
            while at < pose_times[-1]:
                length, size, toward = rng.uniform(*JUMP_SECONDS), rng.uniform(*JUMP), rng.uniform(0.0, 2.0 * math.pi)
                there = (pose_times >= at) & (pose_times < at + length)
                values["x"][there] += size * math.cos(toward)
                values["y"][there] += size * math.sin(toward)
                at += length + float(rng.exponential(self.jumps_every))
        if self.wander:
            steps = np.sqrt(np.diff(pose_times, prepend=pose_times[0])) * rng.normal(0.0, self.wander, len(pose_times))
            values["heading"] += np.cumsum(steps)
        values["yaw_rate"] *= 1.0 + self.gyro_scale


NONE = Disturbances()


def draw_disturbances(rng: np.random.Generator) -> Disturbances:
    """One kind or more, each as likely as not."""
    drawn = Disturbances(rng.uniform(*JUMPS_EVERY), rng.uniform(*WANDER),
                         float(rng.choice((-1.0, 1.0))) * rng.uniform(*GYRO_SCALE),
                         float(rng.choice((-1.0, 1.0))) * rng.uniform(*WHEEL_SCALE))
    kept = rng.random(len(KINDS)) < 0.5
    kept[int(rng.integers(0, len(KINDS)))] = True
    return replace(drawn, **{name: 0.0 for name, keep in zip(KINDS, kept) if not keep})
