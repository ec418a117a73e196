"""The map of where a swept vehicle ends up."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

SHARES = {0.5: "-", 0.9: "--"}  # of the drives that an ellipse holds
NOMINAL, LOST = "#d97706", "#dc2626"


def ellipse(points: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Centre, half axes and angle [rad] of the ellipse of the covariance that holds this share of the points."""
    centre = points.mean(axis=0)
    variances, axes = np.linalg.eigh(np.cov(points.T))
    distance = np.sum(((points - centre) @ axes) ** 2 / variances, axis=1)
    return centre, np.sqrt(np.quantile(distance, share) * variances), float(np.arctan2(axes[1, 0], axes[0, 0]))


def draw(path: Path, ends: np.ndarray, reached: np.ndarray, nominal: np.ndarray) -> None:
    """Density of the ends of the drives that reached the end, those that did not, and the path with nominal parameters."""
    figure = Figure(figsize=(7, 6), layout="constrained")
    axes = figure.subplots()
    there, lost = ends[reached], ends[~reached]
    if len(there):
        cells = axes.hexbin(*there.T, gridsize=60, mincnt=1, bins="log", cmap="viridis", linewidths=0.1)
        figure.colorbar(cells, label="Drives that end in a cell", shrink=0.8)
    axes.plot(*nominal.T, color=NOMINAL, label="path with nominal parameters")
    axes.plot(*nominal[0], "o", color=NOMINAL, label="start")
    axes.plot(*nominal[-1], "*", color=NOMINAL, markersize=12, markeredgecolor="white", label="its end")
    if len(lost):
        axes.plot(*lost.T, "x", color=LOST, markersize=4, label=f"bogged down: {len(lost)} of {len(ends)}")
    for share, style in SHARES.items() if len(there) > 2 else ():
        centre, half, angle = ellipse(there, share)
        axes.add_patch(Ellipse(centre, *(2 * half), angle=np.degrees(angle), fill=False, linestyle=style, color="black",
                               label=f"holds {share:.0%} of the ends"))
    axes.set(xlabel="East (m)", ylabel="North (m)", aspect="equal")
    axes.legend(frameon=False, fontsize="small", loc="upper left")
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    figure.savefig(part, dpi=110, format=path.suffix[1:] or "png")
    part.replace(path)
