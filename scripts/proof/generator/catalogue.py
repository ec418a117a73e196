"""Every effect the generator knows: its parameters, where they are off, its formulas, and how it is counted.

Names, units and ranges of the `physics` and `sensor` effects are those of the catalogue in docs/reference/effects.md;
`outside` effects are not in that catalogue. The hidden parameter `formula` chooses how an effect acts: 0 as the catalogue
has it, 1 and more otherwise (FORMULAS).
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


# How the same mechanism may act by other formulas, beginning with formula 1. Strengths keep the catalogue's names and
# off values; their units are those that the formula needs. v_0 = 1 m/s, s is the slip, p = W / W_mean a wheel's load over
# the mean, z its sinkage, i its row, counted from the one that leads.
FORMULAS: dict[str, tuple[str, ...]] = {
    "terrain_change": (
        "factors change linearly over three transitions",
        "the whole vehicle changes at once, by where its reference point is, and 1 - exp(-u) beyond the line",
        "the sinkage exponent changes, n times stiffness_factor^-0.35, and the friction; modulus and cohesion stay"),
    "left_right_soil": (
        "one side alone is weaker, the other is the terrain",
        "the modulus k by ratio, the shear modulus K by 1/sqrt(ratio); strength is the same on both sides",
        "cohesion and friction by ratio^0.7; the same stiffness on both sides"),
    "bulldozing": (
        "Rankine's passive pressure on the chord of the wheel's side and on its face, with tanh(v / 0.05 m/s)",
        "in proportion to the load: 0.7 W (z / r)^0.8 with the direction of travel",
        "Rankine's pressure with the squares of the side-slip angle's sine and cosine; rear rows meet 40 % of it"),
    "slip_sinkage": (
        "n and the sinkage grow with twice the square of the slip, up to 1",
        "the modulus falls as exp(-growth abs(i)) with the slip along the wheel alone",
        "the compaction resistance grows with the slip, the sinkage does not"),
    "multipass": (
        "rear rows have the compaction resistance of the first times exp(-memory i)",
        "k grows with the passes as 1 + 3 memory (1 - exp(-i)), wherever the tracks lie (after Holm 1969)",
        "cohesion times 1 + 0.5 memory i, K over it: compacted soil is stronger, not stiffer"),
    "elastic_rebound": (
        "exit angle 1.4 share theta_1 exp(-5 abs(i)): soil that is slipped on springs back less",
        "exit angle 0.3 share rad, whatever the entry angle",
        "a share of the compaction resistance is given back; the contact ends at its lowest point"),
    "stress_peak": (
        "the shift of the peak is in proportion to the load, its growth to the square of the slip",
        "the shift of the peak fades with the slip as 1 - abs(i), its growth is tanh(3 abs(i)) / 2",
        "the shift grows as sqrt(theta_1 / 0.4), its growth is with the signed slip: braking moves the peak back"),
    "tyre_compliance": (
        "radius r (1 + 2 W / (b r pressure)), of the load at the moment",
        "half of that, and a width b (1 + W / (2 b r pressure))",
        "a quarter of that, and a flexing loss W sqrt(W / (b r pressure)) / 20 (form after Bekker and Semonin 1975)"),
    "shear_anisotropy": (
        "ratios come in with the side-slip angle: 1 + 2 (ratio - 1) abs(sin beta)",
        "the first row alone meets it whole, later rows 30 %: passing wheels break the structure",
        "strength along and across is the terrain's over and times sqrt(ratio), and so is the modulus"),
    "transient_shear": (
        "relaxation over a rim's travel of 0.4 r relaxation, whatever the contact angle",
        "relaxation over a time of 0.25 s relaxation",
        "the motion across and the turning lag alone, over a rim's travel of 0.8 r relaxation (a tyre's relaxation length)"),
    "rate_dependent_soil": (
        "v_0 (v / v_0)^0.6",
        "0.3 v_0 ln(1 + v / 0.1 m/s): an activated process (Eyring 1936)",
        "v_0 p (v / v_0)^1.3: a loaded wheel is braked more"),
    "drag": (
        "(v / v_0)^1.5",
        "along the vehicle alone, 0.6 v / v_0 + 0.5 (v / v_0)^2 (form of Davis 1926)",
        "along and across by themselves, the side with 2.5 times the area (cross-flow principle), and at its middle"),
    "drawbar": (
        "along the vehicle at the centre of mass: no moment and no load moved",
        "with (v / v_0)^0.4, at the hitch",
        "0.6 + 0.6 exp(-(v / 0.3 m/s)^2) + 0.25 v / v_0, at the hitch: Stribeck's curve of a sledge"),
}


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
_SLOTS += [f"{effect}_formula" for effect in FORMULAS]

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


# The coarse class of what an effect does, by the strength that is on ("" any other): where a user would look for the cause.
_MECHANISMS: dict[str, dict[str, str]] = {
    # a push down the slope, whatever the wheels do
    "grade": {"": "gravity"},
    # both sides of a line, or of the vehicle, have another soil: the ground is not the same everywhere
    "terrain_change": {"": "ground_changes"},
    "left_right_soil": {"": "ground_changes"},
    # a wedge before the wheel brakes, one beside it holds against side motion and turning
    "bulldozing": {"frontal": "resistance_along", "lateral": "resistance_side_or_turning"},
    "rate_dependent_soil": {"forward": "resistance_along", "lateral": "resistance_side_or_turning"},
    # only what is sheared across the wheel differs
    "shear_anisotropy": {"": "resistance_side_or_turning"},
    # forces that hold the vehicle back, with speed or without
    "drag": {"": "resistance_along"},
    "drawbar": {"": "resistance_along"},
    # shapes of the contact: they move the balance of compaction resistance and thrust along the wheel
    "elastic_rebound": {"": "resistance_along"},
    "tyre_compliance": {"": "resistance_along"},
    # the same contact shape, but its place is the slip's: a1 is the growth with slip, and a0 alone is a shape
    "stress_peak": {"a0": "resistance_along", "a1": "ground_memory_or_slip"},
    # the soil answers to how it was slipped on, driven over or sheared before
    "slip_sinkage": {"": "ground_memory_or_slip"},
    "multipass": {"": "ground_memory_or_slip"},
    "transient_shear": {"": "ground_memory_or_slip"},
    "payload": {"": "weight_or_place"},
    "com_shift": {"": "weight_or_place"},
    "wheel_radius": {"": "rolling_radius"},
    # what moves no vehicle
    "latency": {"": "sensor"},
    "lever_arm": {"": "sensor"},
    "yaw_rate_bias": {"": "sensor"},
    "heading_offset": {"": "sensor"},
    # outside the catalogue: a pull whose direction the map gives, as a slope's does
    "gusts": {"": "gravity"},
    "tether": {"": "gravity"},
    # a wheel that turns more slowly than the encoder has it
    "sticky_brake": {"": "rolling_radius"},
    "rut_guidance": {"": "resistance_side_or_turning"},
    # loads that move, from side to side or from wheel to wheel
    "slosh": {"": "weight_or_place"},
    "wheel_hop": {"": "weight_or_place"},
    "trailer": {"": "resistance_along"},
    # soil that gives way when it is slipped on
    "crust": {"": "ground_memory_or_slip"},
    "polished_soil": {"": "ground_memory_or_slip"},
}
MECHANISMS = tuple(dict.fromkeys(name for classes in _MECHANISMS.values() for name in classes.values()))


def mechanisms(effect: str, parameters: dict[str, float] | None = None) -> list[str]:
    """Classes of an effect: of the strengths that are on in `parameters`, or all that it may have. None of other names."""
    effect = effect.removeprefix("outside:")
    if effect not in EFFECTS:
        return []
    classes, declared = _MECHANISMS[effect], EFFECTS[effect]
    off = {p: declared.parameters[p][0] for p in declared.switches}
    on = [p for p in declared.switches if (parameters or {}).get(p, off[p]) != off[p]]
    return sorted({classes.get(p) or classes[""] for p in on} if on else set(classes.values()))


def names_of(kind: str) -> list[str]:
    """All effects of one kind."""
    return [name for name, e in EFFECTS.items() if e.kind == kind]
