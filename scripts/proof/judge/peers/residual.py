"""What peers that model residuals learn from: how the velocities of the re-tuned model differ from the recorded ones."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..prediction import Simulator, errors
from ..recording import HORIZON, SPACING, Recording, Window

STEP = 0.1  # s
TIMES = np.arange(0.0, HORIZON + 1e-9, STEP)
SETTLING = 0.5  # s after a window's start that are not learned from
LEAST = 0.9  # error over that without a residual, on data not learned from, from which on something was detected
VELOCITIES = ("v_x", "v_y", "yaw_rate")
FEATURES = ("v_x", "v_y", "yaw_rate", "slip", "turning_slip", "east", "north")


@dataclass(frozen=True)
class Track:
    """One window: the re-tuned model's motion, and how far the recorded velocities are from it."""

    window: Window
    base: np.ndarray  # the model's velocities at TIMES
    features: np.ndarray  # at TIMES
    residual: np.ndarray | None  # recorded minus base; None where it is not known


def features(window: Window, base: np.ndarray, heading: np.ndarray, radius: float, half_track: float) -> np.ndarray:
    """The model's state, and by how much the rims are faster than the ground [m/s, rad/s]."""
    left, right = (radius * np.interp(TIMES, window.time, wheel) for wheel in (window.left, window.right))
    slip, turning = (left + right) / 2 - base[:, 0], (right - left) / (2 * half_track) - base[:, 2]
    return np.column_stack([base, slip, turning, np.cos(heading), np.sin(heading)])


def tracks(recording: Recording, simulator: Simulator, vehicle: dict, spacing: float, measured: bool = True) -> list[Track]:
    """Windows of a recording with the model's motion; windows that the model cannot drive are left out."""
    found = []
    for window in recording.windows(spacing):
        motion = simulator.motion(window)
        if motion is None:
            continue
        base = np.column_stack([np.interp(TIMES, motion["time"], motion[name]) for name in VELOCITIES])
        heading = np.interp(TIMES, motion["time"], motion["heading"])
        residual = None
        if measured:
            states = [recording.state(window.start + t) for t in TIMES]
            if any(state is None for state in states):
                continue
            residual = np.array([[getattr(state, name) for name in VELOCITIES] for state in states]) - base
        found.append(Track(window, base, features(window, base, heading, vehicle["wheel_radius"], vehicle["half_track"]), residual))
    return found


def end(track: Track, residual: np.ndarray) -> tuple[float, float]:
    """Where the vehicle is at the window's end with these residual velocities on top of the model's."""
    v_x, v_y, rate = (track.base + residual).T
    initial = track.window.initial
    heading = initial.heading + np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * STEP)])
    c, s = np.cos(heading), np.sin(heading)
    return (initial.x + float(np.trapezoid(v_x * c - v_y * s, dx=STEP)), initial.y + float(np.trapezoid(v_x * s + v_y * c, dx=STEP)))


Residuals = Callable[[Sequence[Track]], list[np.ndarray]]


def rmse(some: Sequence[Track], residuals: Sequence[np.ndarray]) -> float:
    """Position error at the windows' ends."""
    places = iter([end(track, residual) for track, residual in zip(some, residuals)])
    value = errors([track.window for track in some], lambda _: next(places))["rmse"]
    return float("inf") if value is None else value


def nothing(some: Sequence[Track]) -> list[np.ndarray]:
    """No residual."""
    return [np.zeros((len(TIMES), 3)) for _ in some]


def learn(tool: Path, given: Sequence[Path], model: Path, vehicle: dict) -> tuple[list[Track], list[Track]]:
    """Tracks to learn from, and those of each recording's last third to choose by."""
    simulator, learning, choosing = Simulator(tool, model), [], []
    for path in given:
        own = tracks(Recording(path), simulator, vehicle, HORIZON / 2)
        split = own[0].window.start + 2 / 3 * (own[-1].window.start - own[0].window.start) if own else 0.0
        learning += [track for track in own if track.window.start + HORIZON <= split + HORIZON / 2]
        choosing += [track for track in own if track.window.start > split + HORIZON / 2]
    return learning, choosing


def on_unseen(tool: Path, unseen: Path, model: Path, vehicle: dict, residuals: Residuals) -> dict:
    """Errors on the unseen recording, on the same windows as everyone."""
    recording, simulator = Recording(unseen), Simulator(tool, model)
    windows = recording.windows()
    driven = tracks(recording, simulator, vehicle, SPACING, measured=False)
    places = {track.window.number: end(track, residual) for track, residual in zip(driven, residuals(driven))}
    return errors(windows, lambda window: places.get(window.number))
