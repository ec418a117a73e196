"""Step-wise selection by BIC under independent errors.

Residuals are the recorded minus the re-tuned model's position, heading and yaw rate every half second of windows of four
seconds, each begun at the recorded state. Every effect of the catalogue and every sensor fault (laws without a name and
changes of terrain, whose place is not known, excepted) is simulated at the size that `ugv effects` prints; what that
changes, as a straight line in the size, are its columns. Soil (1 % steps) and each window's start (place, heading) are
in every regression. An effect with which the model cannot drive a quarter of the windows is left out. Effects enter one
after another while that lowers n log(RSS) + k log n, all samples counting as independent. Those selected are then
refitted fully together with the soil, from the re-tuned one on, by `ugv fit`. Probabilities are the weights exp(-BIC /
2) of the models with one effect and of that with none.
"""

import json
import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..oracle import SENSOR_NAMES, SOIL, fit
from ..prediction import SENSOR_EFFECTS, Simulator, on_unseen, told_sensors
from ..recording import HORIZON, PERFECT, Recording, Sensors

EVERY = 0.5  # s between residuals
MOST = 3  # effects that may enter
LOST = 0.25  # of the windows; an effect that costs more of them is left out
LEFT_OUT = ("terrain_change", "residual_longitudinal", "residual_lateral", "residual_yaw")
SOIL_STEP = 0.01
SOIL_KEYS = ("cohesion", "friction_angle_deg", "frictional_modulus", "sinkage_exponent", "shear_modulus")
Samples = dict[tuple[str, int], np.ndarray]


@dataclass(frozen=True)
class Candidate:
    """An effect, at a size to try; where its strengths are off, and how far they may go."""

    name: str
    sizes: dict[str, float]
    off: dict[str, float]
    ranges: dict[str, tuple[float, float]]

    def only(self, key: str) -> dict[str, float]:
        """All parameters, with one strength on."""
        return self.sizes | {name: value for name, value in self.off.items() if name != key}

    def at(self, shares: np.ndarray) -> dict[str, float]:
        """All parameters, with the strengths at shares of the size to try."""
        sizes = {key: off + share * (self.sizes[key] - off) for (key, off), share in zip(self.off.items(), shares)}
        return self.sizes | {key: float(np.clip(value, *self.ranges[key])) for key, value in sizes.items()}


def catalogue(tool: Path) -> list[Candidate]:
    """What `ugv effects` knows."""
    listed = subprocess.run([str(tool), "effects"], capture_output=True, text=True, check=True)
    names = re.findall(r"^  (\w+): lifts", listed.stdout + listed.stderr, re.MULTILINE)
    found = []
    for name in names:
        if name not in LEFT_OUT:
            told = subprocess.run([str(tool), "effects", name], capture_output=True, text=True, check=True)
            told_of = re.findall(r"^ugv:   (\w+): .*; (\S+) to (\S+).*, off at ([-\d.e]+)", told.stderr, re.MULTILINE)
            off = {key: float(value) for key, _, _, value in told_of}
            ranges = {key: (float(low), float(high)) for key, low, high, _ in told_of}
            found.append(Candidate(name, json.loads(told.stdout)[name], off, ranges))
    return found


def samples(tool: Path, given: list[Path], model: Path, sensors: Sensors = PERFECT) -> Samples:
    """Recorded minus predicted (x, y, heading, yaw rate), and the predicted way (x, y), of every window."""
    simulator, found = Simulator(tool, model), {}
    times = np.arange(EVERY, HORIZON + 1e-9, EVERY)
    for path in given:
        recording = Recording(path, sensors)
        for window in recording.windows(HORIZON):
            states = [recording.state(window.start + t) for t in times]
            if any(state is None for state in states) or (motion := simulator.motion(window)) is None:
                continue
            names = ("x", "y", "heading", "yaw_rate")
            recorded = np.array([[getattr(state, name) for name in names] for state in states])
            predicted = np.column_stack([np.interp(times, motion["time"], motion[name]) for name in names])
            way = predicted[:, :2] - [window.initial.x, window.initial.y]
            found[path.stem, window.number] = np.column_stack([recorded - predicted, way])
    return found


class Regression:
    """The residuals and what explains them, starts of windows projected out, every channel in its own standard deviation."""

    def __init__(self, base: Samples, soil: list[Samples], effects: dict[str, list[Samples]]) -> None:
        def keeps(own: Samples) -> bool:
            return len(own.keys() & base.keys()) >= (1 - LOST) * len(base)

        effects = {name: group for name, group in effects.items() if all(map(keeps, group))}
        everyone = [base, *soil, *(own for group in effects.values() for own in group)]
        self.windows = sorted(set.intersection(*(set(own) for own in everyone)))
        self.base = base
        self.scale = np.ones(4)
        y = self.stack(base)
        self.scale = np.tile(y.reshape(-1, 4).std(0) + 1e-12, len(y) // 4)
        self.y = y / self.scale
        self.n = len(y)
        self.soil = np.array([self.change(own) for own in soil]).T
        self.columns = {name: np.array([self.change(own) for own in group]).T for name, group in effects.items()}

    def stack(self, own: Samples) -> np.ndarray:
        """All windows in one column, less what another place and heading at their starts would do."""
        parts = []
        for key in self.windows:
            values, way = own[key][:, :4], self.base[key][:, 4:]
            n = len(way)
            starts = np.zeros((n, 4, 3))
            starts[:, 0, 0] = starts[:, 1, 1] = starts[:, 2, 2] = 1.0
            starts[:, 0, 2], starts[:, 1, 2] = -way[:, 1], way[:, 0]
            matrix, flat = starts.reshape(4 * n, 3), values.reshape(4 * n)
            parts.append(flat - matrix @ np.linalg.lstsq(matrix, flat, rcond=None)[0])
        return np.concatenate(parts)

    def change(self, own: Samples) -> np.ndarray:
        """What a step of a parameter takes off the residuals."""
        return self.y - self.stack(own) / self.scale

    def bic(self, names: list[str]) -> tuple[float, np.ndarray]:
        """BIC of a model with these effects, and the sizes of theirs as shares of those tried."""
        matrix = np.column_stack([self.soil, *(self.columns[name] for name in names)])
        solved = np.linalg.lstsq(matrix, self.y, rcond=1e-8)[0]
        rss = float(np.sum((self.y - matrix @ solved) ** 2))
        k = matrix.shape[1] + 3 * len(self.windows)
        return self.n * np.log(rss / self.n) + k * np.log(self.n), solved[self.soil.shape[1]:]


def regression(tool: Path, given: list[Path], model: Path, candidates: list[Candidate]) -> Regression:
    """Simulates every candidate."""
    told = json.loads(model.read_text())
    with tempfile.TemporaryDirectory() as folder:
        changed = Path(folder) / "model.json"

        def simulate(key: str, value: dict) -> Samples:
            changed.write_text(json.dumps(told | {key: value}))
            return samples(tool, given, changed)

        soil = [simulate("terrain", told["terrain"] | {key: told["terrain"][key] * (1 + SOIL_STEP)}) for key in SOIL_KEYS]
        effects = {}
        for candidate in candidates:
            trials = [candidate.only(key) for key in candidate.off]
            if candidate.name in SENSOR_EFFECTS:
                effects[candidate.name] = [samples(tool, given, model, Sensors(**{candidate.name: trial})) for trial in trials]
            else:
                effects[candidate.name] = [simulate("effects", {candidate.name: trial}) for trial in trials]
        return Regression(samples(tool, given, model), soil, effects)


def select(problem: Regression) -> tuple[list[str], dict[str, float]]:
    """The effects that enter, in order, and the probabilities of one effect or none."""
    chosen: list[str] = []
    best = problem.bic([])[0]
    single = {"nothing_missing": best} | {name: problem.bic([name])[0] for name in problem.columns}
    while len(chosen) < MOST:
        trials = {name: problem.bic([*chosen, name])[0] for name in problem.columns if name not in chosen}
        name = min(trials, key=lambda name: trials[name])
        if trials[name] >= best:
            break
        best = trials[name]
        chosen.append(name)
    lowest = min(single.values())
    weights = {name: float(np.exp(-(value - lowest) / 2)) for name, value in single.items()}
    return chosen, {name: weight / sum(weights.values()) for name, weight in weights.items()}


def begins(chosen: list[Candidate], shares: np.ndarray) -> list[dict[str, float]]:
    """Parameters of what was selected, where a fit begins."""
    ends = np.cumsum([len(candidate.off) for candidate in chosen])
    return [candidate.at(own) for candidate, own in zip(chosen, np.split(shares, ends[:-1]))]


def told(chosen: list[Candidate], findings: list[dict]) -> list[dict[str, float]]:
    """The same of what was found before."""
    values = [{key: p["value"] for key, p in finding["parameters"].items()} for finding in findings]
    return [candidate.sizes | own for candidate, own in zip(chosen, values)]


def refit(tool: Path, given: list[Path], model: Path, chosen: list[Candidate], begin: list[dict[str, float]], terrain: dict) -> list[dict]:
    """Fits what was selected, from these parameters and this terrain on; writes the model and gives the findings."""
    effects, free, sensors = {}, list(SOIL), []
    for candidate, parameters in zip(chosen, begin):
        if candidate.name in SENSOR_EFFECTS:
            sensors += [name for (effect, _), name in SENSOR_NAMES.items() if effect == candidate.name]
        else:
            effects[candidate.name] = parameters
            free += [f"{candidate.name}.{key}" for key in candidate.off]
    report = fit(tool, given, model, free, sensors, effects, terrain)
    names = {SENSOR_NAMES.get((candidate.name, key), f"{candidate.name}.{key}"): (candidate.name, key)
             for candidate in chosen for key in candidate.off}
    parameters: dict[str, dict[str, dict]] = {candidate.name: {} for candidate in chosen}
    for p in report["parameters"]:
        # A sensor of one of several recordings is told with the recording before it, here as in the findings of the tool.
        recording, dot, last = ("", "", p["name"]) if p["kind"] == "model" else p["name"].rpartition(".")
        if last in names:
            effect, key = names[last]
            parameters[effect][recording + dot + key] = {field: p[field] for field in ("value", "low", "high")}
    return [{"effect": effect, "parameters": own} for effect, own in parameters.items()]


def predicted(tool: Path, given: list[Path], unseen: Path, model: Path, chosen: list[Candidate],
              begin: list[dict[str, float]]) -> tuple[list[dict], dict]:
    """What was selected, fitted, and the errors on the unseen recording: the re-tuned model's where it cannot be fitted."""
    findings: list[dict] = []
    with tempfile.TemporaryDirectory() as folder:
        fitted = Path(folder) / "model.json"
        try:
            if chosen:
                findings = refit(tool, given, fitted, chosen, begin, json.loads(model.read_text())["terrain"])
        except RuntimeError:
            findings = [{"effect": candidate.name} for candidate in chosen]
        ready = fitted if fitted.exists() else model
        return findings, on_unseen(tool, ready, unseen, told_sensors(findings))


def stepwise(tool: Path, given: list[Path], unseen: Path, model: Path, said: dict | None = None) -> dict:
    """The peer's answer, and its errors on the unseen recording; of what it said before, those of what it selected."""
    candidates = {candidate.name: candidate for candidate in catalogue(tool)}
    if said is not None:
        fitted = [finding for finding in said["findings"] if finding.get("parameters")]
        chosen = [candidates[finding["effect"]] for finding in fitted]
        return {"answer": said, "unseen": predicted(tool, given, unseen, model, chosen, told(chosen, fitted))[1]}
    problem = regression(tool, given, model, list(candidates.values()))
    names, probabilities = select(problem)
    chosen = [candidates[name] for name in names]
    begin = begins(chosen, problem.bic(names)[1]) if names else []
    findings, errors = predicted(tool, given, unseen, model, chosen, begin)
    for finding in findings:
        finding["probability"] = probabilities[finding["effect"]]
    first = names[0] if names else ""
    verdict = "sensor" if first in SENSOR_EFFECTS else "missing_physics" if first else "nothing_missing"
    listed = [{"effect": name, "probability": p} for name, p in probabilities.items()]
    return {"answer": {"verdict": verdict, "findings": findings, "candidates": listed}, "unseen": errors}
