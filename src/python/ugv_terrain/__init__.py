"""Wheel-terrain model of a skid-steer vehicle (Tran, Kwok, Scheding & Ha 2007): simulate it, fit it, and ask what it
leaves out.

Everything is in SI units and radians. Positions are east and north, headings counterclockwise from east; velocities are
ahead and to the left.

>>> import ugv_terrain as ugv
>>> drive = ugv.rollout(ugv.Model(terrain="dry_sand"), [0.0, 2.0], [[8.0, 6.0], [8.0, 6.0]])
>>> bool(drive.x[-1] > 1.0 and drive.heading[-1] < 0.0)
True
"""

from ._native import SimulationError, effects
from .analysis import Diagnosis, Fit, Score, diagnose, fit, score
from .description import Model, Terrain, Vehicle
from .simulation import STATES, Batch, Rollout, Simulation, rollout

__all__ = [
    "STATES",
    "Batch",
    "Diagnosis",
    "Fit",
    "Model",
    "Rollout",
    "Score",
    "Simulation",
    "SimulationError",
    "Terrain",
    "Vehicle",
    "diagnose",
    "effects",
    "fit",
    "rollout",
    "score",
]
