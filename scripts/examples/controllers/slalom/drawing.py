"""The picture of the slalom: what was learned, and how it drives."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .drivers import Lap
from .environment import GATES, HALF_WIDTH

COLORS = {"untrained": "#d97706", "trained": "#059669", "scripted": "#2563eb"}
SMOOTHED = 50  # episodes in the curve's mean


def draw_learning(panel: Axes, episodes: np.ndarray) -> None:
    """Gates passed over the steps of training."""
    ended, _, passed = episodes.T
    panel.set(xlabel="Steps of training (thousands)", ylabel=f"Gates passed (of {GATES})", ylim=(-0.2, GATES + 0.4))
    window = min(SMOOTHED, len(episodes))
    if window == 0:  # too few steps for one to end
        return
    mean = np.convolve(passed, np.ones(window) / window, mode="valid")
    panel.plot(ended / 1000, passed, ".", color="#bbbbbb", markersize=2, label="an episode")
    panel.plot(ended[window - 1 :] / 1000, mean, color=COLORS["trained"], label=f"mean of {window}")
    panel.legend(loc="upper left", frameon=False)


def draw_laps(panel: Axes, laps: dict[str, Lap]) -> None:
    """One course, and every driver's way through it."""
    for x, y in next(iter(laps.values())).gates:
        panel.plot([x, x], [y - HALF_WIDTH, y + HALF_WIDTH], "o:", color="black", markersize=4, linewidth=0.8)
    for name, lap in laps.items():
        panel.plot(*lap.path.T, color=COLORS[name], label=name)
    panel.set(xlabel="Along the course (m)", ylabel="Beside it (m)", ylim=(-2.4, 3.4))
    panel.legend(loc="upper center", ncols=3, frameon=False)


def draw(episodes: np.ndarray, laps: dict[str, Lap]) -> Figure:
    """Learning curve and laps."""
    figure = Figure(figsize=(7, 5.5), layout="constrained")
    learning, course = figure.subplots(2)
    draw_learning(learning, episodes)
    draw_laps(course, laps)
    return figure
