"""Soils and vehicles, and the nominal soil that a recording is given."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

import numpy as np

from .catalogue import MAX_ROWS, I, off_vector

GRAVITY = 9.81


@dataclass(frozen=True)
class Soil:
    """Parameters of (1) to (6) in SI units and degrees."""

    cohesive_modulus: float
    frictional_modulus: float
    sinkage_exponent: float
    cohesion: float
    friction_angle_deg: float
    shear_modulus: float

    def numbers(self) -> dict[str, float]:
        """As a terrain's JSON."""
        return asdict(self)


# Table I of Tran et al. 2007
SOILS = {
    "dry_sand": Soil(990.0, 1528430.0, 1.1, 1040.0, 28.0, 0.01),
    "sandy_loam": Soil(5270.0, 1515040.0, 0.7, 1720.0, 29.0, 0.025),
    "clayed_soil": Soil(13190.0, 692150.0, 0.5, 4140.0, 13.0, 0.006),
    "dry_clay": Soil(12700.0, 1555950.0, 0.13, 68950.0, 34.0, 0.006),
}


# how much harder than on firm clay one must steer
LOOSENESS = {"dry_sand": 1.6, "sandy_loam": 1.2, "clayed_soil": 1.4, "dry_clay": 1.0}


@dataclass(frozen=True)
class Vehicle:
    """Geometry and inertia in SI units; rows from the front, relative to their centroid."""

    mass: float
    yaw_inertia: float
    wheel_radius: float
    wheel_width: float
    row_positions: tuple[float, ...]
    half_track: float
    com_offset: float
    com_height: float

    def numbers(self) -> dict[str, float | list[float]]:
        """As a vehicle's JSON."""
        return {**asdict(self), "row_positions": list(self.row_positions)}

    @property
    def wheels(self) -> int:
        """How many wheels."""
        return 2 * len(self.row_positions)


def _box_inertia(mass: float, length: float, width: float) -> float:
    return mass * (length**2 + width**2) / 12.0


VEHICLES = {
    "tran": Vehicle(490.0, 309.43, 0.25, 0.246, (0.915, 0.305, -0.305, -0.915), 0.61, 0.17, 0.35),
    "scout": Vehicle(75.0, _box_inertia(75, 0.85, 0.62), 0.165, 0.12, (0.25, -0.25), 0.29, 0.02, 0.2),
    "ranger": Vehicle(160.0, _box_inertia(160, 1.1, 0.8), 0.19, 0.15, (0.32, -0.32), 0.36, -0.03, 0.27),
    "hexa": Vehicle(310.0, _box_inertia(310, 1.5, 1.0), 0.22, 0.18, (0.55, 0.0, -0.55), 0.48, 0.05, 0.33),
    "mule": Vehicle(640.0, _box_inertia(640, 1.9, 1.3), 0.3, 0.26, (0.68, 0.0, -0.68), 0.62, -0.06, 0.45),
    "hauler": Vehicle(1100.0, _box_inertia(1100, 2.3, 1.5), 0.36, 0.32, (0.75, -0.75), 0.78, 0.08, 0.55),
    "octo": Vehicle(2000.0, _box_inertia(2000, 3.2, 1.8), 0.42, 0.38, (1.35, 0.45, -0.45, -1.35), 0.92, 0.1, 0.7),
}


def parameter_vector(vehicle: Vehicle, soil: Soil) -> np.ndarray:
    """Vehicle and soil in the simulator's parameter vector, all effects off."""
    p = off_vector()
    p[I.mass], p[I.yaw_inertia] = vehicle.mass, vehicle.yaw_inertia
    p[I.wheel_radius], p[I.wheel_width] = vehicle.wheel_radius, vehicle.wheel_width
    p[I.half_track], p[I.com_offset], p[I.com_height] = vehicle.half_track, vehicle.com_offset, vehicle.com_height
    rows = vehicle.row_positions
    if not 2 <= len(rows) <= MAX_ROWS:
        raise ValueError(f"row_positions has {len(rows)} rows; give 2 to {MAX_ROWS}")
    p[I.rows] = len(rows)
    p[I.row0 : I.row0 + len(rows)] = rows
    set_soil(p, soil, vehicle.wheel_width)
    return p


def set_soil(p: np.ndarray, soil: Soil, wheel_width: float) -> None:
    """Write a soil into the parameter vector: k = k_c / b + k_phi."""
    p[I.k] = soil.cohesive_modulus / wheel_width + soil.frictional_modulus
    p[I.n], p[I.c] = soil.sinkage_exponent, soil.cohesion
    p[I.tan_phi], p[I.shear_k] = math.tan(math.radians(soil.friction_angle_deg)), soil.shear_modulus


def true_soil(base: Soil, rng: np.random.Generator) -> Soil:
    """A soil of the preset's kind: no two fields have the same numbers."""
    def about(x: float, spread: float) -> float:
        return x * math.exp(spread * rng.uniform(-1.0, 1.0))

    return Soil(about(base.cohesive_modulus, 0.1), about(base.frictional_modulus, 0.15),
                about(base.sinkage_exponent, 0.08), about(base.cohesion, 0.15),
                base.friction_angle_deg + rng.uniform(-1.5, 1.5), about(base.shear_modulus, 0.15))


def nominal_soil(truth: Soil, rng: np.random.Generator) -> Soil:
    """What the recording says of the soil: moduli and cohesion 30 to 60 % off, degrees in phi, another exponent."""
    def wrong(x: float, low: float, high: float) -> float:
        share = rng.uniform(low, high)
        return x * (1.0 + share) if rng.random() < 0.5 else x * (1.0 - share)

    angle = rng.uniform(2.0, 4.0) * (1 if rng.random() < 0.5 else -1)
    return replace(
        truth, cohesive_modulus=wrong(truth.cohesive_modulus, 0.3, 0.6),
        frictional_modulus=wrong(truth.frictional_modulus, 0.3, 0.6),
        sinkage_exponent=wrong(truth.sinkage_exponent, 0.08, 0.2), cohesion=wrong(truth.cohesion, 0.3, 0.6),
        friction_angle_deg=truth.friction_angle_deg + angle, shear_modulus=wrong(truth.shear_modulus, 0.3, 0.6))
