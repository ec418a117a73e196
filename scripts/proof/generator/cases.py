"""Cases as files: recordings with their sidecars, and the sealed truth (format ugv-proof-truth/1)."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import numpy as np

from .catalogue import EFFECTS, FORMULAS, mechanisms, public_name
from .drafts import Draft, NoCase, Part, add_pivots, beyond, draw_case
from .drives import SERIES_STEP
from .families import answer, effect_of, family_of
from .sensors import record
from .simulator import STEP, Undrivable
from .world import VEHICLES

OVER = ("time", "distance", "place")
SOURCE = "simulated by scripts/proof"
LICENCE = "MIT OR Apache-2.0"


def case_name(index: int) -> str:
    """A name that tells nothing."""
    return f"case_{index:04d}"


def is_complete(folder: Path, index: int, pivots: bool = False) -> bool:
    """Whether a case is there with its truth, and with a second recording where pivots are asked for."""
    case = folder / case_name(index)
    whole = (case / "second.csv").is_file() if pivots else case.is_dir()
    return whole and (folder / "sealed" / f"{case_name(index)}.json").is_file()


def make_case(folder: Path, seed: int, index: int, only: str | None = None, pivots: bool = False, mix: str = "usual") -> None:
    """Draw a case and write it; what is half written is never seen under its name."""
    family = only or family_of(seed, index, mix)
    draft = draw_case(seed, index, family, effect_of(seed, index, family, only, mix))
    if pivots:
        add_pivots(draft, seed, index)
    name = case_name(index)
    part_folder = folder / f"{name}.part"
    shutil.rmtree(part_folder, ignore_errors=True)
    part_folder.mkdir(parents=True)
    acts: dict[str, list[dict]] = {}
    for number, part in enumerate(draft.parts):
        records = draft.records(part)
        rng = np.random.default_rng([seed, 6, index, number])
        text = record(rng, part.drive, records, STEP, draft.sensors, part.samples, draft.faults(),
                      draft.disturbances, np.random.default_rng([seed, 10, index, number]))
        (part_folder / f"{part.name}.csv").write_text(text)
        (part_folder / f"{part.name}.json").write_text(json.dumps(_sidecar(draft), indent=1) + "\n")
        acts[part.name] = [{"effect": public_name(n), "intervals": _intervals(draft, part, n, records)}
                           for n in draft.effects]
    sealed = folder / "sealed" / f"{name}.json"
    sealed.parent.mkdir(exist_ok=True)
    write_json(sealed, _truth(draft, seed, name, acts))
    shutil.rmtree(folder / name, ignore_errors=True)
    os.replace(part_folder, folder / name)


def try_case(task: tuple[Path, int, int, str | None, bool, str]) -> tuple[int, str]:
    """Make (folder, seed, index, family or None, whether with pivots, mix); the index, and what went wrong."""
    index = task[2]
    try:
        make_case(*task)
    except (NoCase, Undrivable, OSError) as error:  # told with the case; the others go on
        return index, f"{type(error).__name__}: {error}"
    return index, ""


def write_json(path: Path, content: dict) -> None:
    """Written beside and renamed."""
    beside = path.with_suffix(".part")
    beside.write_text(json.dumps(content, indent=1) + "\n")
    os.replace(beside, path)


def _sidecar(draft: Draft) -> dict:
    return {"vehicle": VEHICLES[draft.vehicle].numbers(), "terrain": draft.nominal.numbers(),
            "sensors": draft.sensors.text(), "source": SOURCE, "licence": LICENCE}


def _runs(inside: np.ndarray) -> list[list[float]]:
    """Seconds from..to where a mask over the records holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])))
    return [[round(a * STEP, 3), round((b - 1) * STEP, 3)] for a, b in zip(edges[::2], edges[1::2])]


def _intervals(draft: Draft, part: Part, effect: str, records: np.ndarray) -> list[list[float]]:
    """When an effect acts in a recording."""
    times = np.arange(len(records)) * STEP
    values = draft.effects[effect]
    if effect in part.windows:
        window = part.windows[effect]
        if window.kind == "time":
            return _runs((times >= window.numbers[0]) & (times < window.numbers[1]))
        x, y, radius = window.numbers
        return _runs((records[:, 0] - x) ** 2 + (records[:, 1] - y) ** 2 <= radius**2)
    if effect == "terrain_change":
        return _runs(beyond(values, times, records))
    if effect == "sticky_brake":
        return _runs(np.interp(times, np.arange(len(part.drive.series)) * SERIES_STEP, part.drive.series[:, 2]) > 0.5)
    return [[0.0, round(float(times[-1]), 3)]]


def _effect(draft: Draft, name: str) -> dict:
    signal, s = draft.signals[name], draft.sizes[name]
    parameters: dict[str, float | str] = dict(draft.effects[name])
    if "over" in parameters:
        parameters["over"] = OVER[int(parameters["over"])]
    e = EFFECTS[name]
    entry = {"effect": public_name(name), "kind": e.kind,
             "size": "small" if s < 0.75 else ("medium" if s < 1.45 else "large"),
             "parameters": parameters, "off": {p: float(e.parameters[p][0]) for p in e.switches},
             "signal": signal.numbers(), "absorbed": round(signal.absorbed, 5)}
    windows = {p.name: {"kind": p.windows[name].kind, "numbers": list(p.windows[name].numbers)}
               for p in draft.parts if name in p.windows}
    if draft.other:
        entry["acts_by"] = FORMULAS[name][int(parameters.pop("formula")) - 1]
    return entry | ({"windows": windows} if windows else {})


def _truth(draft: Draft, seed: int, name: str, acts: dict[str, list[dict]]) -> dict:
    right = answer(draft.family, list(draft.effects), draft.parts[0].style, sorted(draft.rivals))
    drives = {}
    for part in draft.parts:
        drives[part.name] = {"seconds": round(part.drive.seconds, 3), "style": part.style, "acts": acts[part.name]}
        if part.name != "unseen":
            signal = draft.per_part.get(part.name)
            drives[part.name]["signal"] = signal.numbers() if signal else {"raw": 0.0, "left": 0.0}
    if draft.first_rivals != draft.rivals:
        drives["drive"]["rivals"] = draft.first_rivals
    noise, more = draft.sensors.numbers(), {}
    if draft.other:
        noise["disturbances"] = draft.disturbances.numbers()
        more = {"formula": {n: int(v["formula"]) for n, v in draft.effects.items()},
                "mechanism": {n: mechanisms(n, v) for n, v in draft.effects.items()}}
    return {"format": "ugv-proof-truth/1", "case": name, "seed": seed, "family": draft.family, "variant": draft.variant,
            "vehicle": draft.vehicle, "vehicle_numbers": VEHICLES[draft.vehicle].numbers(), "ground": draft.ground,
            "true_terrain": draft.soil.numbers(), "nominal_terrain": draft.nominal.numbers(),
            "noise": noise, "effects": [_effect(draft, n) for n in draft.effects], "drives": drives,
            "signal_left": round(draft.total.left, 4), "expected": right.expected, "names": right.names,
            "rivals": right.rivals, **more}
