"""Every effect the generator knows: its parameters, where they are off, and how it is counted.

Names, units and ranges of the `physics` and `sensor` effects are those of the catalogue in docs/reference/effects.md;
`outside` effects are not in that catalogue.
"""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass

import numpy as np

MAX_ROWS = 4
SERIES = 3  # columns of the random series that an effect may read: wind east, wind north, brake


@dataclass(frozen=True)
class Effect:
    """One effect. `parameters` maps a name to (off value, low, high); `switches` are those that turn it on."""

    kind: str
    parameters: dict[str, tuple[float, float, float]]
    switches: tuple[str, ...]


def _physics(switches: str, **parameters: tuple[float, float, float]) -> Effect:
    return Effect("physics", parameters, tuple(switches.split()))


def _sensor(switches: str, **parameters: tuple[float, float, float]) -> Effect:
    return Effect("sensor", parameters, tuple(switches.split()))


def _outside(switches: str, **parameters: tuple[float, float, float]) -> Effect:
    return Effect("outside", parameters, tuple(switches.split()))


EFFECTS: dict[str, Effect] = {
    "grade": _physics("slope_east slope_north", slope_east=(0, -0.3, 0.3), slope_north=(0, -0.3, 0.3)),
    "terrain_change": _physics(
        "cohesion_factor friction_factor stiffness_factor shear_modulus_factor",
        cohesion_factor=(1, 0.02, 50), friction_factor=(1, 0.1, 5), stiffness_factor=(1, 0.02, 50),
        shear_modulus_factor=(1, 0.1, 10), position=(0, -1e6, 1e6), direction=(0, -7, 7),
        transition=(0.5, 0.001, 1000), over=(2, 0, 2)),
    "left_right_soil": _physics("ratio", ratio=(1, 0.1, 10)),
    "bulldozing": _physics("lateral frontal", lateral=(0, 0, 3), frontal=(0, 0, 3), unit_weight=(16000, 5000, 30000)),
    "slip_sinkage": _physics("exponent_growth sinkage_growth", exponent_growth=(0, 0, 1), sinkage_growth=(0, 0, 1.4)),
    "multipass": _physics("memory", memory=(0, 0, 1), stiffness_ratio=(10, 1.5, 100)),
    "elastic_rebound": _physics("share", share=(0, 0, 1)),
    "stress_peak": _physics("a0 a1", a0=(0.5, 0.2, 0.6), a1=(0, 0, 0.4)),
    "tyre_compliance": _physics("pressure", pressure=(2e6, 15000, 2e6)),
    "shear_anisotropy": _physics("modulus_ratio strength_ratio", modulus_ratio=(1, 0.3, 3), strength_ratio=(1, 0.5, 2)),
    "transient_shear": _physics("relaxation", relaxation=(0, 0, 5)),
    "rate_dependent_soil": _physics("forward lateral", forward=(0, 0, 5000), lateral=(0, 0, 10000)),
    "drag": _physics("coefficient", coefficient=(0, 0, 200)),
    "drawbar": _physics("force", force=(0, 0, 20000), hitch_behind=(1, -10, 10), hitch_height=(0.3, 0, 5)),
    "payload": _physics("mass", mass=(0, 0, 1e5), ahead=(0, -20, 20), left=(0, -10, 10), height=(0.5, 0, 10)),
    "com_shift": _physics("ahead left", ahead=(0, -1, 1), left=(0, -1, 1)),
    "wheel_radius": _physics("left right", left=(1, 0.8, 1.1), right=(1, 0.8, 1.1)),
    "latency": _sensor("pose yaw_rate wheels", pose=(0, 0, 1), yaw_rate=(0, 0, 1), wheels=(0, 0, 1)),
    "lever_arm": _sensor("ahead left", ahead=(0, -3, 3), left=(0, -3, 3)),
    "yaw_rate_bias": _sensor("bias", bias=(0, -0.2, 0.2)),
    "heading_offset": _sensor("offset", offset=(0, -0.5, 0.5)),
    # wind of a mean and correlated gusts [m/s] on side and front, k = rho C_d A / 2 [N s^2/m^2], pressure point ahead [m]
    "gusts": _outside("side", side=(0, 0, 20), front=(0, 0, 20), point_ahead=(0, -1, 1)),
    # share of the speed that the last wheel of one side loses while its brake sticks; side 1 left, -1 right
    "sticky_brake": _outside("loss", loss=(0, 0, 1), side=(1, -1, 1)),
    # spring towards a rut [N/m] of a half width [m], along a line on the map: direction [rad], offset [m]
    "rut_guidance": _outside("stiffness", stiffness=(0, 0, 1e5), width=(0.4, 0.05, 5), direction=(0, -7, 7),
                             offset=(0, -100, 100)),
    # a load on the vehicle that moves: its share of the mass, natural frequency [rad/s], damping ratio
    "slosh": _outside("share", share=(0, 0, 0.4), frequency=(4, 0.5, 20), damping=(0.1, 0.01, 1)),
    # trailer with its own heading: resistance [N], mass [kg], hitch behind the centroid [m], drawbar to axle [m]
    "trailer": _outside("resistance mass", resistance=(0, 0, 5000), mass=(0, 0, 1000), hitch=(0.8, 0, 5),
                        length=(1.2, 0.3, 5)),
    # crust: stiffness factor while whole, load at which it breaks as a share of the mean wheel load, slip speed [m/s]
    "crust": _outside("strength", strength=(0, 0, 5), breaking_load=(1, 0.2, 3), breaking_speed=(0.3, 0.02, 3)),
    # washboard: amplitude of the wheel loads at resonance, wave length [m], resonance [rad/s]
    "wheel_hop": _outside("amplitude", amplitude=(0, 0, 0.9), wavelength=(0.7, 0.1, 5), resonance=(15, 3, 60)),
    # cable to a point on the map: tension [N] and its growth [N/m]
    "tether": _outside("tension growth", tension=(0, 0, 2000), growth=(0, 0, 200), anchor_x=(0, -1e3, 1e3),
                       anchor_y=(0, -1e3, 1e3)),
    # friction of the soil that falls with the slip speed: share lost, speed [m/s]
    "polished_soil": _outside("loss", loss=(0, 0, 0.8), speed=(0.5, 0.02, 5)),
}

_VEHICLE = ["mass", "yaw_inertia", "wheel_radius", "wheel_width", "half_track", "com_offset", "com_height", "rows"]
_VEHICLE += [f"row{i}" for i in range(MAX_ROWS)]
_SOIL = ["k", "n", "c", "tan_phi", "shear_k"]
_SLOTS = _VEHICLE + _SOIL + [f"{effect}_{p}" for effect, e in EFFECTS.items() for p in e.parameters]

Slots = namedtuple("Slots", _SLOTS)
I = Slots(*range(len(_SLOTS)))  # where each number lies in the parameter vector


def slot(effect: str, parameter: str) -> int:
    """Index of an effect's parameter in the parameter vector."""
    return int(getattr(I, f"{effect}_{parameter}"))


def off_vector() -> np.ndarray:
    """The parameter vector with all effects off; vehicle and soil are still zero."""
    vector = np.zeros(len(_SLOTS))
    for effect, e in EFFECTS.items():
        for parameter, (off, _, _) in e.parameters.items():
            vector[slot(effect, parameter)] = off
    return vector


def public_name(effect: str) -> str:
    """The name in the truth: `outside:...` for an effect that the catalogue does not have."""
    return f"outside:{effect}" if EFFECTS[effect].kind == "outside" else effect


def names_of(kind: str) -> list[str]:
    """All effects of one kind."""
    return [name for name, e in EFFECTS.items() if e.kind == kind]
