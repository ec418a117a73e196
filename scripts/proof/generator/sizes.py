"""How strong an effect is drawn: parameters that a size s scales, 1 being typical of this vehicle on this soil."""

from __future__ import annotations

import itertools
import math

import numpy as np

from .catalogue import EFFECTS
from .world import GRAVITY, Soil, Vehicle

SIZES = {"small": (0.35, 0.65), "medium": (0.8, 1.25), "large": (1.6, 2.4)}


def rigid_limit(vehicle: Vehicle, soil: Soil) -> float:
    """Pressure [Pa] below which a tyre is not rigid on this soil (Wong 2.5, after Bekker)."""
    k = soil.cohesive_modulus / vehicle.wheel_width + soil.frictional_modulus
    n, load = soil.sinkage_exponent, vehicle.mass * GRAVITY / vehicle.wheels
    flat = 3.0 * load / ((3.0 - n) * vehicle.wheel_width * math.sqrt(2.0 * vehicle.wheel_radius))
    return k ** (1.0 / (2.0 * n + 1.0)) * flat ** (2.0 * n / (2.0 * n + 1.0))


def draw_effect(effect: str, seed: list[int], s: float, vehicle: Vehicle, soil: Soil, seconds: float,
                spot: tuple[float, float, float], formula: int = 0) -> dict[str, float]:
    """Parameters of a size. The same seed gives the same shape at every s. spot: x, y, heading somewhere on the path."""
    rng = np.random.default_rng(seed)
    values = _SHAPES[effect](rng, s, vehicle, soil, seconds, spot)
    if formula:
        values = _by_formula(effect, formula, values, s, vehicle)
    drawn = {name: float(min(max(value, EFFECTS[effect].parameters[name][1]), EFFECTS[effect].parameters[name][2]))
             for name, value in values.items()}
    return drawn | ({"formula": float(formula)} if formula else {})


def _by_formula(effect: str, formula: int, values: dict[str, float], s: float, vehicle: Vehicle) -> dict[str, float]:
    """The strengths that make another formula move the vehicle about as far as the catalogue's of that size."""
    times = FORMULA_SIZES.get((effect, formula), 1.0)
    if effect == "tyre_compliance":  # W / (b r pressure) = 0.2 s
        load = vehicle.mass * GRAVITY / vehicle.wheels
        return {"pressure": 5.0 * load / (vehicle.wheel_width * vehicle.wheel_radius * s * times)}
    if effect == "multipass":
        values = {"memory": 0.5 * s, "stiffness_ratio": values["stiffness_ratio"]}
    return {name: EFFECTS[effect].parameters[name][0] + times * (value - EFFECTS[effect].parameters[name][0])
            if name in EFFECTS[effect].switches else value for name, value in values.items()}


def ways(effect: str, s: float, vehicle: Vehicle, soil: Soil, seconds: float) -> list[tuple[dict[str, float], bool]]:
    """All that an effect of a size can do, as the sum of its ways: each with whether it works in one direction only.

    One way for each parameter that turns it on; a load or a pull that may be anywhere is the sum of those at the corners
    of where it may be; a memory of ruts that of a soft and a stiff one.
    """
    nowhere = (0.0, 0.0, 0.0)
    if effect in _CORNERS:
        drawn = draw_effect(effect, [7, 0], s, vehicle, soil, seconds, nowhere)
        corners = itertools.product(*([(name, value) for value in values(vehicle)]
                                      for name, values in _CORNERS[effect].items()))
        return [(drawn | dict(corner), True) for corner in corners]
    found: dict[str, tuple[dict[str, float], bool]] = {}
    for i in range(DRAWS):
        drawn = draw_effect(effect, [7, i], s, vehicle, soil, seconds, nowhere)
        for name in EFFECTS[effect].switches:
            off, low, high = EFFECTS[effect].parameters[name]
            if name not in found and drawn.get(name, off) != off:
                alone = {n: v for n, v in drawn.items() if n == name or n not in EFFECTS[effect].switches}
                found[name] = alone, off in (low, high)
    return list(found.values())


def _sign(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _either(rng: np.random.Generator, first: dict[str, float], second: dict[str, float]) -> dict[str, float]:
    """One, the other, or both."""
    which = rng.integers(0, 3)
    return first if which == 0 else (second if which == 1 else first | second)


def _grade(rng, s, vehicle, soil, seconds, spot):
    toward = rng.uniform(0.0, 2.0 * math.pi)
    return {"slope_east": 0.05 * s * math.cos(toward), "slope_north": 0.05 * s * math.sin(toward)}


def _terrain_change(rng, s, vehicle, soil, seconds, spot):
    softer = _sign(rng)
    powers = {"cohesion_factor": 0.5, "friction_factor": 0.18, "stiffness_factor": 0.6, "shear_modulus_factor": -0.35}
    values = {name: math.exp(softer * p * s * rng.uniform(0.5, 1.0)) for name, p in powers.items()}
    if rng.random() < 0.6:
        direction = spot[2] + rng.uniform(-0.6, 0.6)
        position = spot[0] * math.cos(direction) + spot[1] * math.sin(direction)
        return values | {"over": 2.0, "direction": direction, "position": position, "transition": rng.uniform(0.3, 1.0)}
    return values | {"over": 0.0, "position": seconds * rng.uniform(0.35, 0.65), "transition": rng.uniform(0.3, 1.5)}


def _bulldozing(rng, s, vehicle, soil, seconds, spot):
    shape = {"unit_weight": rng.uniform(14000.0, 18000.0)}
    return shape | _either(rng, {"lateral": 0.8 * s}, {"frontal": 0.3 * s})


def _slip_sinkage(rng, s, vehicle, soil, seconds, spot):
    return {"exponent_growth": 0.2 * s} if rng.random() < 0.5 else {"sinkage_growth": 0.6 * s}


def _multipass(rng, s, vehicle, soil, seconds, spot):
    return {"memory": 1.0 - 0.5 * math.exp(-s), "stiffness_ratio": 4.0 * math.exp(0.7 * s)}


def _stress_peak(rng, s, vehicle, soil, seconds, spot):
    a_0 = {"a0": 0.5 - 0.07 * s}
    return a_0 | ({"a1": 0.12 * s} if rng.random() < 0.5 else {})


def _tyre(rng, s, vehicle, soil, seconds, spot):
    return {"pressure": rigid_limit(vehicle, soil) * 0.95 * math.exp(-0.22 * s)}


def _anisotropy(rng, s, vehicle, soil, seconds, spot):
    up, stronger = _sign(rng), _sign(rng)
    return _either(rng, {"modulus_ratio": math.exp(0.4 * s * up)}, {"strength_ratio": math.exp(0.18 * s * stronger)})


def _rate(rng, s, vehicle, soil, seconds, spot):
    share = s * vehicle.mass / 490.0
    return _either(rng, {"forward": 90.0 * share}, {"lateral": 160.0 * share})


def _drawbar(rng, s, vehicle, soil, seconds, spot):
    return {"force": 0.04 * s * vehicle.mass * GRAVITY, "hitch_behind": max(vehicle.row_positions) + rng.uniform(0.1, 0.5),
            "hitch_height": rng.uniform(0.6, 1.0) * vehicle.com_height}


def _payload(rng, s, vehicle, soil, seconds, spot):
    return {"mass": 0.12 * s * vehicle.mass, "ahead": rng.uniform(-0.6, 0.6) * max(vehicle.row_positions),
            "left": rng.uniform(-0.5, 0.5) * vehicle.half_track, "height": rng.uniform(1.0, 1.6) * vehicle.com_height}


def _com_shift(rng, s, vehicle, soil, seconds, spot):
    ahead = {"ahead": _sign(rng) * 0.12 * s * max(vehicle.row_positions)}
    return _either(rng, ahead, {"left": _sign(rng) * 0.08 * s * vehicle.half_track})


def _wheel_radius(rng, s, vehicle, soil, seconds, spot):
    return _either(rng, {"left": 1.0 - 0.02 * s * rng.uniform(0.6, 1.2)}, {"right": 1.0 - 0.02 * s * rng.uniform(0.6, 1.2)})


def _latency(rng, s, vehicle, soil, seconds, spot):
    which = rng.integers(0, 3)
    if which == 0:
        return {"pose": 0.2 * s}
    return {"wheels": 0.12 * s} if which == 1 else {"pose": 0.2 * s, "yaw_rate": 0.06 * s}


def _lever_arm(rng, s, vehicle, soil, seconds, spot):
    toward = rng.uniform(0.0, 2.0 * math.pi)
    return {"ahead": 0.3 * s * math.cos(toward), "left": 0.3 * s * math.sin(toward)}


def _gusts(rng, s, vehicle, soil, seconds, spot):
    side = 4.0 * s * (vehicle.mass / 490.0) ** (2.0 / 3.0)
    return {"side": side, "front": 0.4 * side, "point_ahead": rng.uniform(-0.3, 0.3) * max(vehicle.row_positions)}


def _rut(rng, s, vehicle, soil, seconds, spot):
    direction = spot[2] + rng.uniform(-0.15, 0.15)
    offset = -spot[0] * math.sin(direction) + spot[1] * math.cos(direction) + rng.uniform(-0.3, 0.3)
    return {"stiffness": 0.25 * s * vehicle.mass * GRAVITY, "width": rng.uniform(0.4, 0.9), "direction": direction,
            "offset": offset}


def _tether(rng, s, vehicle, soil, seconds, spot):
    toward, far = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(8.0, 20.0)
    weight = vehicle.mass * GRAVITY
    return {"tension": 0.012 * s * weight, "growth": 0.0012 * s * weight, "anchor_x": spot[0] + far * math.cos(toward),
            "anchor_y": spot[1] + far * math.sin(toward)}


# what the strengths of another formula are multiplied by, measured: tests/python/test_proof_formulas.py
FORMULA_SIZES = {
    ("terrain_change", 2): 1.6, ("left_right_soil", 1): 0.75, ("left_right_soil", 2): 1.8, ("left_right_soil", 3): 0.7,
    ("bulldozing", 2): 0.7, ("bulldozing", 3): 1.7, ("slip_sinkage", 1): 2.0, ("slip_sinkage", 2): 1.4, ("slip_sinkage", 3): 0.4,
    ("multipass", 1): 0.4, ("multipass", 3): 0.4, ("elastic_rebound", 3): 1.5, ("stress_peak", 1): 0.65, ("stress_peak", 2): 2.0,
    ("tyre_compliance", 1): 1.5, ("tyre_compliance", 2): 2.0, ("tyre_compliance", 3): 2.0, ("shear_anisotropy", 1): 1.8,
    ("shear_anisotropy", 2): 1.4, ("shear_anisotropy", 3): 0.7, ("transient_shear", 1): 0.5, ("transient_shear", 2): 0.7,
    ("rate_dependent_soil", 1): 0.5, ("rate_dependent_soil", 2): 0.5, ("rate_dependent_soil", 3): 2.0}
DRAWS = 20  # in which each parameter of an effect is on at least once
# where a load may lie, a hitch be, how stiff a rut be
_CORNERS = {
    "payload": {"ahead": lambda v: (max(v.row_positions), min(v.row_positions)),
                "left": lambda v: (v.half_track, -v.half_track), "height": lambda v: (v.com_height, 2.0 * v.com_height)},
    "drawbar": {"hitch_behind": lambda v: (max(v.row_positions), max(v.row_positions) + 0.8),
                "hitch_height": lambda v: (0.3 * v.com_height, 1.3 * v.com_height)},
    "multipass": {"stiffness_ratio": lambda v: (4.0, 25.0)},
}
_SHAPES = {
    "grade": _grade, "terrain_change": _terrain_change,
    "left_right_soil": lambda rng, s, *_: {"ratio": math.exp(0.35 * s * _sign(rng))},
    "bulldozing": _bulldozing, "slip_sinkage": _slip_sinkage, "multipass": _multipass,
    "elastic_rebound": lambda rng, s, *_: {"share": 0.2 * s},
    "stress_peak": _stress_peak, "tyre_compliance": _tyre, "shear_anisotropy": _anisotropy,
    "transient_shear": lambda rng, s, *_: {"relaxation": s},
    "rate_dependent_soil": _rate,
    "drag": lambda rng, s, vehicle, *_: {"coefficient": 15.0 * s * (vehicle.mass / 490.0) ** (2.0 / 3.0)},
    "drawbar": _drawbar, "payload": _payload, "com_shift": _com_shift, "wheel_radius": _wheel_radius,
    "latency": _latency, "lever_arm": _lever_arm,
    "yaw_rate_bias": lambda rng, s, *_: {"bias": 0.012 * s * _sign(rng)},
    "heading_offset": lambda rng, s, *_: {"offset": 0.035 * s * _sign(rng)},
    "gusts": _gusts,
    "sticky_brake": lambda rng, s, *_: {"loss": 0.2 * s, "side": _sign(rng)},
    "rut_guidance": _rut,
    "slosh": lambda rng, s, *_: {"share": 0.13 * s, "frequency": rng.uniform(2.5, 5.0), "damping": rng.uniform(0.05, 0.2)},
    "trailer": lambda rng, s, vehicle, *_: {
        "resistance": 0.035 * s * vehicle.mass * GRAVITY, "mass": 0.12 * s * vehicle.mass,
        "hitch": max(vehicle.row_positions) + 0.3, "length": rng.uniform(0.8, 1.6)},
    "crust": lambda rng, s, *_: {"strength": s, "breaking_load": rng.uniform(0.85, 1.1),
                                 "breaking_speed": rng.uniform(0.1, 0.4)},
    "wheel_hop": lambda rng, s, *_: {"amplitude": 0.35 * s, "wavelength": rng.uniform(0.5, 0.9),
                                     "resonance": rng.uniform(6.0, 12.0)},
    "tether": _tether,
    "polished_soil": lambda rng, s, *_: {"loss": 0.2 * s, "speed": rng.uniform(0.2, 0.6)},
}
