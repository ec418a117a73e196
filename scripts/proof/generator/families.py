"""The families of cases: what each may contain, what a right answer to it is, and when a draw belongs to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .catalogue import FORMULAS, names_of, public_name
from .conditions import condition_of
from .signal import Signal

MIX = {"nothing": 15, "single": 25, "absorbed": 10, "edge": 8, "local": 10, "pair": 8, "lookalike": 8, "outside": 8,
       "sensor": 6, "vehicle": 2}
# The same conditions in other worlds: effects by other formulas than the catalogue's, sensors with other noise
OTHER_MIX = {"other_nothing": 15, "other_single": 40, "other_absorbed": 15, "other_local": 15, "other_pair": 15}
MIXES = {"usual": MIX, "other": OTHER_MIX}
FAMILIES = (*MIX, *OTHER_MIX)
DISTURBED = 0.5  # share of the cases of other worlds with other noise; with nothing missing all of them

_VEHICLE = ("payload", "com_shift", "wheel_radius")
_SOIL = tuple(n for n in names_of("physics") if n not in _VEHICLE)
EFFECTS_OF = {
    "nothing": (),
    "single": _SOIL + _VEHICLE,
    "absorbed": ("multipass", "drawbar", "elastic_rebound", "stress_peak", "slip_sinkage", "rate_dependent_soil",
                 "bulldozing", "tyre_compliance", "drag", "shear_anisotropy"),
    "edge": _SOIL + ("payload", "com_shift"),
    "local": ("grade", "drawbar", "left_right_soil", "rate_dependent_soil", "bulldozing", "drag", "shear_anisotropy",
              "slip_sinkage"),
    "pair": ("grade", "drawbar", "left_right_soil", "bulldozing", "drag", "rate_dependent_soil", "multipass", "com_shift",
             "terrain_change", "shear_anisotropy"),
    "lookalike": ("rate_dependent_soil", "drag", "multipass", "drawbar", "elastic_rebound", "payload", "com_shift",
                  "wheel_radius", "latency", "lever_arm", "grade"),
    "outside": tuple(names_of("outside")),
    "sensor": tuple(names_of("sensor")),
    "vehicle": _VEHICLE,
}
EFFECTS_OF |= {family: tuple(n for n in EFFECTS_OF[condition_of(family)] if n in FORMULAS) for family in OTHER_MIX}

# groups that one recording may not tell apart
_ALIKE = (
    ("rate_dependent_soil", "drag", "drawbar"),
    ("multipass", "drawbar", "elastic_rebound", "stress_peak", "tyre_compliance", "rate_dependent_soil"),
    ("payload", "com_shift"),
    ("bulldozing", "shear_anisotropy", "rate_dependent_soil"),
    ("wheel_radius", "left_right_soil"),
    ("latency", "lever_arm"),
    ("slip_sinkage", "multipass", "stress_peak"),
    ("bulldozing", "drawbar"),
)
# what is confined to some seconds or a place is told by how it begins and ends, and by little else: any of these there
_THERE = (*EFFECTS_OF["local"], "terrain_change", "stress_peak", "wheel_radius", "com_shift")
_LOOKALIKE_RIVALS = {"grade": ("drawbar", "rate_dependent_soil"), "wheel_radius": ("left_right_soil",)}
ENOUGH = 8.0
HIDDEN = 0.9


def rivals_of(effect: str) -> list[str]:
    """Names that one recording may not tell from the effect's."""
    found = {name for group in _ALIKE if effect in group for name in group} | set(_LOOKALIKE_RIVALS.get(effect, ()))
    return sorted(found - {effect})


def rivals_there(effect: str) -> list[str]:
    """Names that may not be told from the effect's where both are confined to the same seconds or place."""
    return sorted(set(_THERE) - {effect})


def family_of(seed: int, index: int, mix: str = "usual") -> str:
    """The family of a case: every hundred cases hold the mix exactly, shuffled by the seed."""
    names = [name for name, share in MIXES[mix].items() for _ in range(share)]
    block = np.random.default_rng([seed, 1, index // 100]).permutation(len(names))
    return names[block[index % 100]]


def effect_of(seed: int, index: int, family: str, only: str | None, mix: str = "usual") -> str | None:
    """The effect of a case: a family goes round its effects in an order of the seed."""
    choices = EFFECTS_OF[family]
    if not choices:
        return None
    turn = index if only else sum(family_of(seed, i, mix) == family for i in range(index))
    order = np.random.default_rng([seed, 2, FAMILIES.index(family), turn // len(choices)]).permutation(len(choices))
    return choices[order[turn % len(choices)]]


@dataclass(frozen=True)
class Answer:
    """What is right to say of a case."""

    expected: list[str]
    names: list[str]
    rivals: list[str]


def answer(family: str, effects: list[str], style: str, rivals: list[str]) -> Answer:
    """By family; rivals: the look-alikes that these recordings cannot tell from the effects."""
    family = condition_of(family)
    names = [n if not public_name(n).startswith("outside") else "unknown" for n in effects]
    also = ["ambiguous"] if rivals else []
    if family == "nothing":
        right = Answer(["nothing_missing"], ["nothing_missing"], [])
    elif family == "edge":
        right = Answer(["missing_physics", "ambiguous", "nothing_missing", "insufficient_data"],
                       names + ["nothing_missing"], rivals)
    elif family == "outside":
        right = Answer(["unknown_physics"], ["unknown"], [])
    elif family == "sensor" or (family == "lookalike" and effects[0] in EFFECTS_OF["sensor"]):
        right = Answer(["sensor"] + also, names, rivals)
    else:
        right = Answer(["missing_physics"] + also, names, rivals)
    if style == "short" and "insufficient_data" not in right.expected:
        right.expected.append("insufficient_data")
    return right


def belongs(family: str, signals: list[Signal]) -> bool:
    """Whether a draw satisfies its family's condition; signals of each effect, in all recordings given."""
    family = condition_of(family)
    if family == "nothing":
        return True
    if family == "edge":
        return 2.0 <= signals[0].left <= ENOUGH
    if family == "absorbed" and signals[0].absorbed <= HIDDEN:
        return False
    return all(signal.left >= ENOUGH for signal in signals)


def rescaled(family: str, signal: Signal, s: float, rng: np.random.Generator) -> float | None:
    """A size that should belong where s did not; None where none is worth a try."""
    family = condition_of(family)
    if family == "edge":
        wanted = rng.uniform(2.8, 7.0)
    elif family == "absorbed" and signal.absorbed <= HIDDEN:
        return None
    else:
        wanted = rng.uniform(10.0, 16.0)
    new = s * wanted / max(signal.left, 1e-3)
    return new if 0.005 <= new <= 3.0 else None
