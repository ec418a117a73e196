"""Draws one case of a family: vehicle, soil, drives, effects of the size that the family wants."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from .catalogue import EFFECTS, FORMULAS
from .conditions import OTHER, condition_of
from .disturbances import NONE, Disturbances, draw_disturbances
from .drives import draw_drive, draw_pivots, draw_series
from .families import DISTURBED, EFFECTS_OF, ENOUGH, belongs, rescaled, rivals_of
from .rivals import Bench
from .sensors import Samples, Sensors, draw_samples, draw_sensors
from .signal import STEP as RULED
from .signal import Case, Ruler, Signal, project, retuned
from .simulator import COARSE, PLAIN, Drive, Setup, Undrivable, Window, simulate
from .sizes import SIZES, draw_effect
from .world import LOOSENESS, SOILS, VEHICLES, Soil, nominal_soil, true_soil

ATTEMPTS = 60
RESCALES = 3
ABSORBABLE = 0.5  # share of a signal that re-tuning takes where it is worth to go on with that
ROUGH, EXACT = 2e-4, 5e-5  # tolerances of a step while looking, and of what is recorded
STYLES = {"nothing": (0.7, 0.2, 0.1), "single": (0.65, 0.25, 0.1), "absorbed": (0.6, 0.4, 0.0),
          "lookalike": (0.4, 0.6, 0.0)}


class NoCase(Exception):
    """No draw satisfied the family."""


@dataclass
class Part:
    """One recording of a case."""

    name: str  # drive, second, unseen
    style: str
    drive: Drive
    samples: Samples
    pose: tuple[float, float, float]
    windows: dict[str, Window]


@dataclass
class Draft:
    """A case before noise is added and files are written."""

    family: str
    variant: str
    vehicle: str
    ground: str
    soil: Soil
    nominal: Soil
    sensors: Sensors
    parts: list[Part]
    effects: dict[str, dict[str, float]]
    sizes: dict[str, float]
    signals: dict[str, Signal]
    total: Signal
    per_part: dict[str, Signal]
    rivals: list[str]  # look-alikes that all recordings given cannot tell apart
    first_rivals: list[str]  # those that the first cannot
    disturbances: Disturbances = NONE

    @property
    def other(self) -> bool:
        """Whether it is of a world with other formulas."""
        return self.family.startswith(OTHER)

    def physics(self) -> dict[str, dict[str, float]]:
        """Effects that move the vehicle."""
        return {n: v for n, v in self.effects.items() if EFFECTS[n].kind != "sensor"}

    def faults(self) -> dict[str, dict[str, float]]:
        """Effects that only the sensors see."""
        return {n: v for n, v in self.effects.items() if EFFECTS[n].kind == "sensor"}

    def setup(self, part: Part) -> Setup:
        """What the simulator drives in a part."""
        return Setup(VEHICLES[self.vehicle], self.soil, self.physics(), part.windows)

    def records(self, part: Part) -> np.ndarray:
        """The true motion of a part, every STEP."""
        return simulate(self.setup(part), part.drive, part.pose, tolerance=EXACT, table=PLAIN)


def _pick_effects(rng: np.random.Generator, family: str, effect: str | None, attempt: int) -> list[str]:
    choices = EFFECTS_OF[family]
    if effect is None:
        return []
    if attempt >= 3:
        effect = str(rng.choice(choices))
    if condition_of(family) != "pair":
        return [effect]
    others = [n for n in choices if n != effect and n not in rivals_of(effect)]
    return [effect, str(rng.choice(others))]


def _pick_formulas(seed: int, index: int, attempt: int, family: str, names: list[str]) -> dict[str, int]:
    """Which formula each effect has: the catalogue's, or in another world any but that one."""
    if not family.startswith(OTHER):
        return dict.fromkeys(names, 0)
    rng = np.random.default_rng([seed, 8, index, attempt])
    return {name: int(rng.integers(1, len(FORMULAS[name]) + 1)) for name in names}


def _pick_disturbances(seed: int, index: int, family: str) -> Disturbances:
    """What the sensors of a case suffer from beside their usual noise."""
    rng = np.random.default_rng([seed, 9, index])
    wanted = family.startswith(OTHER) and (rng.random() < DISTURBED or condition_of(family) == "nothing")
    return draw_disturbances(rng) if wanted else NONE


def _anywhere(rng: np.random.Generator) -> tuple[float, float, float]:
    """A pose to start from: x, y [m], heading [rad]."""
    return rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0), rng.uniform(-math.pi, math.pi)


def _opposite(drive: Drive, rng: np.random.Generator) -> Drive:
    """The same way back: wheel speeds in reverse order, the sides swapped."""
    return replace(drive, speeds=np.ascontiguousarray(drive.speeds[::-1, ::-1]), series=draw_series(rng, drive.seconds))


def _window(rng: np.random.Generator, kind: str, drive: Drive, spot: tuple[float, float, float], radius: float) -> Window:
    if kind == "disc":
        return Window("disc", (spot[0], spot[1], radius))
    length = rng.uniform(0.18, 0.35) * drive.seconds
    begin = rng.uniform(0.1, 0.85 - length / drive.seconds) * drive.seconds
    return Window("time", (begin, begin + length))


def _through(spot: tuple[float, float, float], setup: Setup, drive: Drive, heading: float) -> tuple[float, float, float]:
    """A start from which the drive comes by the spot at 45 % of its time."""
    path = simulate(setup, drive, (0.0, 0.0, heading), tolerance=ROUGH, table=COARSE)
    at = path[int(0.45 * len(path))]
    return spot[0] - at[0], spot[1] - at[1], heading


def draw_case(seed: int, index: int, family: str, effect: str | None) -> Draft:
    """The first draw that is drivable and belongs to the family."""
    for attempt in range(ATTEMPTS):
        try:
            draft = _draw(seed, index, family, effect, attempt)
        except Undrivable:
            continue
        if draft is not None:
            return draft
    raise NoCase(f"case {index} of family {family} (effect {effect}): {ATTEMPTS} draws did not belong to it; use another seed")


def _draw(seed: int, index: int, family: str, effect: str | None, attempt: int) -> Draft | None:
    rng = np.random.default_rng([seed, 3, index, attempt])
    grid = [(v, g) for v in VEHICLES for g in SOILS]
    order = np.random.default_rng([seed, 4, index // len(grid)]).permutation(len(grid))
    vehicle, ground = grid[order[index % len(grid)]] if attempt < 4 else grid[int(rng.integers(0, len(grid)))]
    car, soil = VEHICLES[vehicle], true_soil(SOILS[ground], rng)
    nominal = nominal_soil(soil, rng)
    style = str(rng.choice(("rich", "calm", "short"), p=STYLES.get(condition_of(family), (0.8, 0.2, 0.0))))
    sensors = draw_sensors(rng)
    bare = Setup(car, soil)

    def part(name: str, drive: Drive, how: str, pose: tuple[float, float, float]) -> Part:
        return Part(name, how, drive, draw_samples(rng, sensors, drive.seconds), pose, {})

    drive = draw_drive(rng, car, style, LOOSENESS[ground])
    pose = _anywhere(rng)
    path = simulate(bare, drive, pose, tolerance=ROUGH, table=COARSE)
    at = path[int(rng.uniform(0.35, 0.65) * len(path))]
    spot = (float(at[0]), float(at[1]), float(at[2]))
    radius = rng.uniform(2.5, 4.5) * max(float(np.mean(path[:, 3])), 0.3)
    parts = [part("drive", drive, style, pose)]
    names = _pick_effects(rng, family, effect, attempt)
    formulas = _pick_formulas(seed, index, attempt, family, names)
    second = family == "lookalike" and bool(rng.random() < 0.5)
    if second:
        end = path[-1]
        if names[0] in ("grade", "drawbar"):  # the way back tells a slope from a pull
            parts.append(part("second", _opposite(drive, rng), style, (end[0], end[1], end[2] + math.pi)))
        else:
            other = draw_drive(rng, car, "rich", LOOSENESS[ground])
            parts.append(part("second", other, "rich", (end[0], end[1], end[2])))
    drive = draw_drive(rng, car, "rich", LOOSENESS[ground])
    parts.append(part("unseen", drive, "rich", _through(spot, bare, drive, rng.uniform(-math.pi, math.pi))))

    kind = str(rng.choice(("time", "disc")))
    variant = "second recording" if second else (kind if condition_of(family) == "local" else ("poor" if style == "short" else "whole"))
    if condition_of(family) == "local":
        for p in parts:
            p.windows = {names[0]: _window(rng, kind, p.drive, spot, radius)}

    low, high = SIZES[str(rng.choice(list(SIZES)))]
    sizes = {n: rng.uniform(low, high) for n in names}
    draft = Draft(family, variant, vehicle, ground, soil, nominal, sensors, parts, {}, sizes, {}, Signal(0.0, 0.0), {},
                  [], [], _pick_disturbances(seed, index, family))

    def shape() -> None:
        draft.effects = {n: draw_effect(n, [seed, 5, index, attempt, i], draft.sizes[n], car, soil,
                                        parts[0].drive.seconds, spot, formulas[n]) for i, n in enumerate(names)}

    shape()
    if not names:
        for p in parts:
            draft.records(p)
        return draft
    for trial in range(RESCALES + 1):
        _measure(draft)
        fits = belongs(family, list(draft.signals.values()))
        if fits and (family != "lookalike" or _alike(draft)):
            draft.records(parts[-1])
            return draft
        if trial == RESCALES or (fits and (draft.first_rivals or trial > 0)):
            return None
        for n in names:
            if fits:  # a look-alike that is too loud to be mistaken
                draft.sizes[n] *= rng.uniform(8.2, 10.0) / draft.signals[n].left
                continue
            if condition_of(family) in ("edge", "absorbed") or draft.signals[n].left < ENOUGH:
                new = rescaled(family, draft.signals[n], draft.sizes[n], rng)
                if new is None:
                    return None
                draft.sizes[n] = new
        shape()
    return None


def add_pivots(draft: Draft, seed: int, index: int) -> None:
    """Beside the drive a second recording of turns on the spot, where there is none; its signal is not measured."""
    if any(p.name == "second" for p in draft.parts):
        return
    rng = np.random.default_rng([seed, 7, index])
    drive = draw_pivots(rng, VEHICLES[draft.vehicle], LOOSENESS[draft.ground])
    pose = _anywhere(rng)
    samples = draw_samples(rng, draft.sensors, drive.seconds)
    draft.parts.append(Part("second", "pivots", drive, samples, pose, {}))


def _alike(draft: Draft) -> bool:
    """Whether one recording cannot tell the effect from another, and a second, where there is one, can."""
    second = any(p.name == "second" for p in draft.parts)
    return bool(draft.first_rivals) and (not second or not draft.rivals)


def beyond(change: dict[str, float], times: np.ndarray, records: np.ndarray) -> np.ndarray:
    """Which records are on the other soil of a change of terrain."""
    along = times
    if change["over"] == 2.0:
        along = records[:, 0] * math.cos(change["direction"]) + records[:, 1] * math.sin(change["direction"])
    return along > change["position"]


def _windows(draft: Draft, part: Part, ruler: Ruler) -> dict[str, Window]:
    """Where effects act in a part, if not throughout; of a change of terrain the seconds on the other soil, if in one go."""
    windows = dict(part.windows)
    if "terrain_change" in draft.effects:
        times = np.concatenate([at + RULED * np.arange(len(records)) for at, records in zip(ruler.begins, ruler.truth)])
        there = beyond(draft.effects["terrain_change"], times, np.concatenate(ruler.truth))
        edges = np.flatnonzero(np.diff(np.concatenate([[0], there.astype(int), [0]])))
        if len(edges) == 2:
            windows["terrain_change"] = Window("time", (float(times[edges[0]]), float(times[edges[1] - 1])))
    return windows


def _measure(draft: Draft) -> None:
    """Fill in the signals of the recordings that the tool is given, and which look-alikes would do as well."""
    given = [p for p in draft.parts if p.name != "unseen"]
    rulers, offs, bases, starts, soils, changes = [], [], [], [], [], []
    names = list(draft.effects)
    for p in given:
        ruler = Ruler(Case(draft.setup(p), p.drive, draft.sensors, p.samples, draft.faults(), p.pose))
        offs.append(ruler.case.setup.without(*draft.physics()))
        base, start, soil = ruler.columns(offs[-1])
        rulers.append(ruler)
        bases.append(base)
        starts.append(start)
        soils.append(soil)
        each = {n: ruler.difference([n]) for n in names}
        changes.append(each | {"": ruler.difference(names) if len(names) > 1 else each[names[0]]})

    def signal(name: str) -> Signal:
        own = [c[name] for c in changes]
        linear = project(own, starts, soils)
        if linear.left < ENOUGH or linear.absorbed < ABSORBABLE:
            return linear  # nothing hangs on it
        return replace(linear, left=min(linear.left, retuned(rulers, offs, bases, own, starts, soils)))

    draft.signals = {n: signal(n) for n in names}
    draft.total = signal("") if len(names) > 1 else draft.signals[names[0]]
    draft.per_part = {p.name: project([c[""]], [start], [soil])
                      for p, c, start, soil in zip(given, changes, starts, soils)}
    draft.rivals, draft.first_rivals = [], []
    if belongs(draft.family, list(draft.signals.values())):
        bench = Bench(rulers, starts, soils, changes, [_windows(draft, p, r) for p, r in zip(given, rulers)])
        draft.rivals = bench.rivals(names, len(given))
        draft.first_rivals = bench.rivals(names, 1) if len(given) > 1 else draft.rivals
