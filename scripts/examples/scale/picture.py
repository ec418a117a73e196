"""The map of where a swept vehicle ends up."""

from pathlib import Path

import numpy as np
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.ndimage import gaussian_filter

SHARES = {0.9: "--", 0.5: "-"}  # of the drives that a region holds
CELLS, SMOOTHING = 160, 4.0  # cells along the map's longer side, and how many of them a drive is spread over
NOMINAL, LOST = "#d97706", "#dc2626"
KINDS = set(FigureCanvasBase.get_supported_filetypes())


def kind(path: Path) -> str:
    """What a picture is written as: PNG where its name does not tell."""
    return path.suffix[1:].lower() or "png"


def density(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """East and north of square cells, drives in each, and the same smoothed; a margin without any lies around."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = max(1e-3, float(np.max(high - low))) / CELLS
    edges = [np.arange(low[axis] - 10 * size, high[axis] + 10 * size, size) for axis in (0, 1)]
    counts = np.histogram2d(*points.T, bins=edges)[0].T
    east, north = (0.5 * (edge[:-1] + edge[1:]) for edge in edges)
    return east, north, counts, gaussian_filter(counts, SMOOTHING, mode="constant")


def level(counts: np.ndarray, smoothed: np.ndarray, share: float) -> float:
    """The density that bounds the smallest region with this share of all drives."""
    falling = np.argsort(smoothed, axis=None)[::-1]
    held = np.cumsum(counts.ravel()[falling])
    return float(smoothed.ravel()[falling[np.searchsorted(held, share * held[-1])]])


def draw(path: Path, ends: np.ndarray, reached: np.ndarray, nominal: np.ndarray) -> None:
    """Density of the ends of the drives that reached the end, those that did not, and the path with nominal parameters."""
    figure = Figure(figsize=(7, 5.5), layout="constrained")
    axes = figure.subplots()
    there, lost = ends[reached], ends[~reached]
    entries = []
    if len(there) > 2:
        cells = axes.hexbin(*there.T, gridsize=70, mincnt=1, bins="log", cmap="Blues", linewidths=0.1)
        figure.colorbar(cells, label="drives that end in a cell", shrink=0.7)
        east, north, counts, smoothed = density(there)
        for share, style in SHARES.items():
            axes.contour(east, north, smoothed, levels=[level(counts, smoothed, share)], colors="black", linestyles=style, linewidths=1)
            entries.append(Line2D([], [], color="black", linestyle=style, linewidth=1, label=f"smallest region with {share:.0%} of the ends"))
    if len(lost):
        entries += axes.plot(*lost.T, "x", color=LOST, markersize=4, label=f"did not reach the end: {len(lost)} of {len(ends)}")
    if len(nominal):  # none where the vehicle cannot stand with nominal parameters
        entries += axes.plot(*nominal.T, color=NOMINAL, label="path with nominal parameters")
        axes.plot(*nominal[0], "o", color=NOMINAL)
        axes.plot(*nominal[-1], "*", color=NOMINAL, markersize=14, markeredgecolor="white")
    axes.set(xlabel="East (m)", ylabel="North (m)", aspect="equal")
    figure.legend(handles=entries, loc="outside upper center", ncols=2, frameon=False, fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    figure.savefig(part, dpi=100, format=kind(path))
    part.replace(path)
