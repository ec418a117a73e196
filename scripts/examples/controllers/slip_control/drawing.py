"""The picture of slip-limited speed control."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .masters import Columns
from .system import SAND_FROM

WITH, WITHOUT, GREY = "#059669", "#d97706", "#666666"


def enter_sand(panel: Axes, columns: Columns) -> None:
    """Marks when the vehicle comes to the loose sand, if it does."""
    if columns["ugv.x"].max() > SAND_FROM:
        panel.axvline(float(np.interp(SAND_FROM, columns["ugv.x"], columns["time"])), color=GREY, linewidth=0.8, linestyle=":")


def draw(limited: Columns, unlimited: Columns, slip_limit: float) -> Figure:
    """Speed, wheel speed, slip and sinkage over time, with and without the limit."""
    figure = Figure(figsize=(7, 7.5), layout="constrained")
    speed, wheels, slip, sinkage = figure.subplots(4, sharex=True)
    panels = ((speed, "ugv.v_x", 1.0), (wheels, "slip_control.omega_left", 1.0),
              (slip, "ugv.wheel[1].longitudinal_slip", 100.0), (sinkage, "ugv.wheel[1].sinkage", 100.0))
    for panel, name, factor in panels:
        panel.plot(unlimited["time"], factor * unlimited[name], color=WITHOUT, label="without a limit")
        panel.plot(limited["time"], factor * limited[name], color=WITH, label=f"slip limit {100 * slip_limit:.0f} %")
        enter_sand(panel, limited)
    speed.plot(limited["time"], limited["driver.speed_demand"], "--", color=GREY, label="demand")
    slip.axhline(100 * slip_limit, color=GREY, linewidth=0.8, linestyle="--")
    speed.set(ylabel="Speed (m/s)", title="A slope of 3° of dry sand, loose after 5 m (dotted)")
    wheels.set(ylabel="Wheel speed (rad/s)")
    slip.set(ylabel="Slip (%)")
    sinkage.set(ylabel="Sinkage of\na front wheel (cm)", xlabel="Time (s)", xlim=(0, limited["time"][-1]))
    figure.legend(*speed.get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    return figure
