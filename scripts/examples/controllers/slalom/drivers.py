"""Drivers to compare with, and one lap of a driver."""

from collections.abc import Callable
from dataclasses import dataclass

import gymnasium
import numpy as np

from .environment import SCALE, WHEEL_LIMIT

Driver = Callable[[np.ndarray], np.ndarray]
WHEEL_RADIUS, HALF_TRACK = 0.25, 0.61  # m
CRUISE = 1.2  # m/s
TURN_GAIN = 3.0  # rad/s more between the sides for each rad/s that the yaw rate is too small
SIDES = np.array([-1.0, 1.0])  # left, right: a left turn slows the left side
CURVATURE_LIMIT = 0.35  # 1/m: beyond, wheels only dig in dry sand


def straight(_: np.ndarray) -> np.ndarray:
    """Equal wheel speeds."""
    return wheels(np.full(2, CRUISE / WHEEL_RADIUS))


def scripted(observation: np.ndarray) -> np.ndarray:
    """The cubic through the next gate that leaves it towards the one after, by feedback of yaw rate and slips."""
    ahead, left, ahead_after, left_after, v_x, _, yaw_rate, *slips = observation * SCALE
    distance = max(np.hypot(ahead, left), 0.5)
    # Of the Hermite cubic from here, straight ahead, to the gate, with the direction of the gate after it.
    bend = (6 * left / distance - 2 * left_after / np.hypot(ahead_after, left_after)) / distance
    bend = np.clip(bend, -CURVATURE_LIMIT, CURVATURE_LIMIT)
    wanted = CRUISE * (1 + SIDES * bend * HALF_TRACK)
    grip = np.clip(1 - np.array(slips), 0.3, 1.2)
    return wheels(wanted / grip / WHEEL_RADIUS + TURN_GAIN * SIDES * (bend * v_x - yaw_rate))


def wheels(speeds: np.ndarray) -> np.ndarray:
    """The action of wheel speeds [rad/s]."""
    return np.clip(2 * speeds / WHEEL_LIMIT - 1, -1.0, 1.0).astype(np.float32)


@dataclass(frozen=True)
class Lap:
    """A driver's way through a course."""

    gates: np.ndarray
    path: np.ndarray
    reward: float
    passed: int
    seconds: float
    finished: bool


def lap(environment: gymnasium.Env, driver: Driver, seed: int) -> Lap:
    """Drives the course of a seed."""
    observation, info = environment.reset(seed=seed)
    path, total, ended = [(info["x"], info["y"])], 0.0, False
    while not ended:
        observation, reward, terminated, truncated, info = environment.step(driver(observation))
        path.append((info["x"], info["y"]))
        total, ended = total + reward, terminated or truncated
    gates = environment.unwrapped.gates.copy()
    return Lap(gates, np.array(path), total, info["gates_passed"], info["time"], info["finished"])
