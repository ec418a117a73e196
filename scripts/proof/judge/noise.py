"""What the noise of the sensors alone would do to a prediction: the error that a perfect model would be charged with."""

import copy
import math
from pathlib import Path

import numpy as np

from .prediction import root_mean_square, score
from .recording import HORIZON, Recording

DRAWS = 8


def draw(random: np.random.Generator, time: np.ndarray, channel: dict) -> np.ndarray:
    """White noise, and a Gauss-Markov part of a correlation time."""
    keep = np.exp(-np.diff(time) / channel["time"])
    coloured = np.empty(len(time))
    coloured[0] = random.normal(0.0, channel["coloured"])
    for k, kick in enumerate(random.normal(0.0, channel["coloured"], len(keep)), 1):
        coloured[k] = keep[k - 1] * coloured[k - 1] + math.sqrt(1 - keep[k - 1] ** 2) * kick
    return coloured + random.normal(0.0, channel["white"], len(time))


def floor(path: Path, channels: dict[str, dict]) -> dict:
    """Position error of a perfect model on a recording's windows: noise is drawn anew on top of the recording, and what
    it changes at start and end of a window, with the start's heading carried along, is the error."""
    base, random = Recording(path), np.random.default_rng(1)
    windows = base.windows()
    drawn: dict[int, list[float]] = {window.number: [] for window in windows}
    for _ in range(DRAWS):
        other = copy.copy(base)
        other.channels = {name: (time, values + draw(random, time, channels[name]) if name in channels else values)
                          for name, (time, values) in base.channels.items()}
        for window in windows:
            start, end = other.state(window.start), other.state(window.start + HORIZON)
            if start is None or end is None:
                continue
            turn = start.heading - window.initial.heading
            ahead, left = window.final.x - window.initial.x, window.final.y - window.initial.y
            x = end.x - window.final.x - (start.x - window.initial.x) + turn * left
            y = end.y - window.final.y - (start.y - window.initial.y) - turn * ahead
            drawn[window.number].append(math.hypot(x, y))
    return score([(number, root_mean_square(away) or 0.0) for number, away in drawn.items() if away])
