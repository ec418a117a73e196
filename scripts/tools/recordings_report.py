#!/usr/bin/env python3
"""Writes the tables of docs/explanation/recordings.md from the recordings in UGV_DATA.

1. Of each vehicle one drive is diagnosed: the longest that was driven in one run. Its mended model predicts every other recording of
   that vehicle, unchanged, beside kinematics of the same drive and kinematics fitted in place.
2. Every claim of a diagnosis is compared: slopes with the withheld pitch and roll, latencies with what the data's authors state, wheel
   radii with the turns of the vehicle's other drives.
3. The soil is fitted to one half of every recording and judged on the other.

Diagnoses have no time limit, so that the page does not depend on the machine. They are kept in the folder of --work for the same tool
and recording. Parts that are not asked for keep their text.
"""

import argparse
import csv
import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
DATA = Path(os.environ.get("UGV_DATA", ROOT.parent / "shared" / "data"))
PAGE = ROOT / "docs" / "explanation" / "recordings.md"
MODELS = {
    "no_slip": "no-slip",
    "two_parameter": "two-parameter",
    "three_parameter": "three-parameter",
    "nominal_soil": "nominal soil",
    "given_model": "fitted soil",
}
PARTS = ("transfer", "claims", "fits")
STANDING = 0.1  # slower wheels stand still [rad/s]
LONGEST_GAP = 1.5  # between wheel speeds [s]; over a longer one nobody knows whether the wheels turned
LEVEL = 0.01  # accuracy of the recorded slope [rad]: pitch and roll against the recorded height
TURN = 2.0  # over which turns and wheel angles are compared [s]: long against latencies
ROLLED = 0.5  # with less than this on both sides the vehicle stands [rad]
TRUE, FALSE, UNKNOWN, MISSED = "true", "false", "cannot be known", "missed"

Row = dict[str, str]


@dataclass(frozen=True)
class Recording:
    """A recording with its sidecar."""

    path: Path
    about: dict[str, Any]
    rows: list[Row] = field(repr=False)

    @property
    def name(self) -> str:
        return self.path.stem

    @property
    def label(self) -> str:
        """A short name for tables."""
        return " ".join(self.name.replace("_warthog", "").split("_2024")[0].split("_"))

    @property
    def short(self) -> str:
        """Its first word."""
        return self.name.split("_")[0]

    @classmethod
    def read(cls, path: Path) -> "Recording":
        sidecar = path.with_suffix(".json")
        about = json.loads(sidecar.read_text()) if sidecar.exists() else {}
        with path.open(newline="") as file:
            return cls(path, about, list(csv.DictReader(file)))

    def runs(self) -> list[list[Row]]:
        """Rows of each run. A clock that goes back starts another one, as the tool reads it."""
        runs: list[list[Row]] = []
        for row in self.rows:
            last = runs[-1][-1] if runs else None
            if last is None or last.get("run") != row.get("run") or float(row["time"]) < float(last["time"]):
                runs.append([])
            runs[-1].append(row)
        return runs

    def wheels(self) -> list[tuple[float, float, float]]:
        """Intervals between wheel speeds: length [s], and the latest speeds of both sides at their start [rad/s]."""
        found = []
        for run in self.runs():
            before: tuple[float, str, str] | None = None
            for row in run:
                if not (row["omega_left"] or row["omega_right"]):
                    continue
                time, left, right = float(row["time"]), row["omega_left"], row["omega_right"]
                if before is not None:
                    start, *sides = before
                    left, right = left or sides[0], right or sides[1]
                    if all(sides) and time - start <= LONGEST_GAP:
                        found.append((time - start, *map(float, sides)))
                before = (time, left, right)
        return found

    def driven(self) -> float:
        """Seconds of turning wheels."""
        return sum(seconds for seconds, *sides in self.wheels() if max(map(abs, sides)) > STANDING)

    def fastest(self) -> float:
        """The rims' mean speed that is exceeded for 1 % of the driven time [m/s]."""
        radius = self.about.get("vehicle", {}).get("wheel_radius", math.nan)
        speeds = sorted((abs(left + right) / 2 * radius, seconds) for seconds, left, right in self.wheels() if max(abs(left), abs(right)) > STANDING)
        rest = 0.01 * sum(seconds for _, seconds in speeds)
        while len(speeds) > 1 and speeds[-1][1] <= rest:
            rest -= speeds.pop()[1]
        return speeds[-1][0] if speeds else 0.0


def vehicles(recordings: Iterable[Recording]) -> list[list[Recording]]:
    """Recordings of the same vehicle."""
    groups: dict[str, list[Recording]] = {}
    for recording in recordings:
        groups.setdefault(json.dumps(recording.about.get("vehicle"), sort_keys=True), []).append(recording)
    return list(groups.values())


def richest(recordings: Sequence[Recording]) -> Recording:
    """The drive to diagnose, by its input alone: of those in one run, or else of all, the one that was driven longest."""
    in_one_run = [recording for recording in recordings if len(recording.runs()) == 1]
    return max(in_one_run or recordings, key=lambda recording: (recording.driven(), recording.name))


class Tool:
    """`ugv`, and the folder in which its answers are kept."""

    def __init__(self, path: Path, work: Path, jobs: int | None) -> None:
        self.path, self.work, self.jobs = path, work, jobs
        self.mark = hashlib.sha256(path.read_bytes()).hexdigest()
        work.mkdir(parents=True, exist_ok=True)

    def version(self) -> str:
        """Name and version, without the platform."""
        said = subprocess.run([self.path, "--version"], check=True, capture_output=True, text=True).stdout
        return " ".join(said.split()[:2])

    def run(self, *arguments: object, check: bool = True) -> bool:
        """Runs the tool; whether it succeeded."""
        threads = ["--jobs", str(self.jobs)] if self.jobs else []
        done = subprocess.run([self.path, *map(str, arguments), *threads, "--quiet"], check=False, capture_output=True, text=True)
        if check and done.returncode:
            sys.exit(f"recordings_report: ugv {' '.join(map(str, arguments))} failed: {done.stderr.strip()}")
        return done.returncode == 0

    def diagnosed(self, recording: Recording) -> Path:
        """The folder of a recording's diagnosis: the kept one of this tool, or a new one."""
        sidecar = recording.path.with_suffix(".json")
        content = b"".join(path.read_bytes() for path in (recording.path, sidecar) if path.exists())
        mark = hashlib.sha256(self.mark.encode() + content).hexdigest()[:12]
        folder = self.work / f"{recording.name}-{mark}"
        if not (folder / "diagnosis.json").exists():
            part = folder.with_name(folder.name + ".part")
            shutil.rmtree(part, ignore_errors=True)
            self.run("diagnose", recording.path, "--within", "none", "--output", part)
            part.rename(folder)
        return folder

    def scored(self, path: Path, *arguments: object) -> dict[str, Any]:
        """The results of `ugv score` on a recording."""
        answer = self.work / f"{path.parent.name}.{path.stem}.score.json"
        self.run("score", path, *arguments, "--json", answer, "--force")
        (scored,) = json.loads(answer.read_text())["recordings"]
        return scored

    def doubled(self, recording: Recording) -> Path:
        """A copy of a recording in which every run is followed by a copy of itself: `ugv score` then fits kinematics to the
        whole recording, as `ugv diagnose` fits to the whole recording.
        """
        names = ["run", *(name for name in recording.rows[0] if name != "run")]
        rows = [row | {"run": str(2 * number + copy)} for number, run in enumerate(recording.runs()) for copy in (0, 1) for row in run]
        return self.copy(recording, "doubled", names, rows, recording.about)

    def with_vehicle(self, recording: Recording, radius: float, track: float) -> Path:
        """A copy of a recording whose vehicle has this radius and track: its kinematics without slip are those of these two."""
        about = recording.about | {"vehicle": recording.about["vehicle"] | {"wheel_radius": radius, "half_track": track / 2}}
        return self.copy(recording, "transferred", list(recording.rows[0]), recording.rows, about)

    def copy(self, recording: Recording, folder: str, names: list[str], rows: list[Row], about: dict[str, Any]) -> Path:
        path = self.work / folder / recording.path.name
        path.parent.mkdir(exist_ok=True)
        with path.open("w", newline="") as file:
            writer = csv.DictWriter(file, names, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        path.with_suffix(".json").write_text(json.dumps(about))
        return path


def value(estimate: Any) -> float:
    """The value of an estimate, which has an interval."""
    return estimate["value"] if isinstance(estimate, dict) else estimate


def model_of(scored: dict[str, Any], name: str) -> dict[str, Any]:
    return next(model for model in scored["models"] if model["model"] == name)


# Median and 95th percentile in position [m] and in heading [rad].
Errors = dict[str, tuple[float, float]]


def errors(model: dict[str, Any]) -> Errors | None:
    """The errors of a model; `None` if it was not fitted."""
    if not model.get("position_m"):
        return None
    return {channel: (value(model[channel]["median"]), value(model[channel]["p95"])) for channel in ("position_m", "heading_rad")}


def cell(found: Errors | None) -> str:
    """Median and 95th percentile of both errors."""
    if found is None:
        return "not fitted"
    metres, radians = found["position_m"], found["heading_rad"]
    return f"{metres[0]:.2f} / {metres[1]:.2f}, {radians[0]:.3f} / {radians[1]:.2f}"


# 1. One drive diagnosed, the others predicted.


@dataclass(frozen=True)
class Prediction:
    """Errors on a recording: of the mended model, of kinematics of the diagnosed drive, of kinematics fitted in place."""

    label: str
    fastest: float
    windows: int
    failed: int
    mended: Errors
    transferred: Errors
    in_place: Errors | None


def transfer(tool: Tool, recordings: Sequence[Recording]) -> tuple[Recording, tuple[float, float], list[Prediction]]:
    """The diagnosed drive of a vehicle, its effective radius and track, and the predictions of the others."""
    reference = richest(recordings)
    model = tool.diagnosed(reference) / "model.json"
    kinematics = model_of(tool.scored(tool.doubled(reference)), "two_parameter")["parameters"]
    radius, track = value(kinematics["wheel_radius_m"]), value(kinematics["track_m"])
    predictions = []
    for other in recordings:
        if other is reference:
            continue
        scored = tool.scored(other.path, "--model", model)
        moved = tool.scored(tool.with_vehicle(other, radius, track))
        if scored["counted"] != moved["counted"]:
            sys.exit(f"recordings_report: {other.name}: models were judged by {scored['counted']} and {moved['counted']} windows")
        mended, transferred = model_of(scored, "given_model"), model_of(moved, "no_slip")
        predictions.append(Prediction(other.label, other.fastest(), scored["counted"], mended["failed"], errors(mended) or {}, errors(transferred) or {},
                                      errors(model_of(scored, "two_parameter"))))
    return reference, (radius, track), predictions


def pair(found: Errors | None, channel: str) -> str:
    """Median and 95th percentile."""
    if not found:
        return "not fitted"
    digits = 2 if channel == "position_m" else 3
    return " / ".join(f"{number:.{digits}f}" for number in found[channel])


def better(predictions: Sequence[Prediction], channel: str, which: int, other: Callable[[Prediction], Errors | None]) -> str:
    """On how many of the recordings the mended model has the smaller error."""
    pairs = [(prediction.mended[channel][which], rival[channel][which]) for prediction in predictions if (rival := other(prediction))]
    return f"{sum(mine < rival for mine, rival in pairs)} of {len(pairs)}"


def transfer_text(reference: Recording, kinematics: tuple[float, float], predictions: Sequence[Prediction], picture: str) -> str:
    """Table, counts and picture."""
    lines = [
        f"Diagnosed: {reference.label}, driven {reference.driven():.0f} s, the longest drive in one run. Kinematics of the same drive: effective radius "
        f"{kinematics[0]:.3f} m, effective track {kinematics[1]:.2f} m. Each cell has median / 95th percentile, 5 s ahead.",
        "",
        f"| recording (windows) | fastest \\[m/s\\] | mended model of {reference.short} \\[m\\] | kinematics of {reference.short} \\[m\\] | kinematics in place \\[m\\] | "
        f"mended model of {reference.short} \\[rad\\] | kinematics of {reference.short} \\[rad\\] | kinematics in place \\[rad\\] |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for p in predictions:
        cells = [pair(found, channel) for channel in ("position_m", "heading_rad") for found in (p.mended, p.transferred, p.in_place)]
        failed = f", {p.failed} failed" if p.failed else ""
        lines.append(f"| {p.label} ({p.windows}{failed}) | {p.fastest:.1f} | {' | '.join(cells)} |")
    lines += ["", "On how many recordings the mended model has the smaller error:", "", "| against | median \\[m\\] | 95 % \\[m\\] | median \\[rad\\] | 95 % \\[rad\\] |", "|---|---|---|---|---|"]
    rivals = ((f"kinematics of {reference.short}", lambda p: p.transferred), ("kinematics in place", lambda p: p.in_place))
    for name, rival in rivals:
        counts = [better(predictions, channel, which, rival) for channel in ("position_m", "heading_rad") for which in (0, 1)]
        lines.append(f"| {name} | {' | '.join(counts)} |")
    lines += ["", f"![Median and 95th percentile of the error 5 s ahead on every recording, for the three models]({picture})"]
    return "\n".join(lines)


def draw(reference: Recording, predictions: Sequence[Prediction], path: Path) -> None:
    """Median and 95th percentile of each recording and model, joined by a line."""
    import matplotlib as mpl  # noqa: PLC0415 - the tests of the tables need no pictures

    mpl.use("svg")
    from matplotlib import pyplot as plt  # noqa: PLC0415

    plt.rcParams |= {"svg.hashsalt": "ugv", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3, "axes.axisbelow": True}
    shown = ((f"mended model of {reference.short}", "#d97706", lambda p: p.mended), (f"kinematics of {reference.short}", "#3b82f6", lambda p: p.transferred),
             ("kinematics fitted in place", "#777777", lambda p: p.in_place))
    figure, axes = plt.subplots(1, 2, figsize=(8.4, 0.9 + 0.42 * len(predictions)), sharey=True, layout="constrained")
    for one, (channel, title) in zip(axes, (("position_m", "position error after 5 s [m]"), ("heading_rad", "heading error after 5 s [rad]")), strict=True):
        for place, (name, colour, of) in enumerate(shown):
            for row, prediction in enumerate(predictions):
                if found := of(prediction):
                    y = row + 0.24 * (place - 1)
                    one.plot(found[channel], (y, y), color=colour, linewidth=1.6)
                    one.plot(found[channel][0], y, "o", color=colour, markersize=5, label=name if row == 0 else None)
                    one.plot(found[channel][1], y, "|", color=colour, markersize=7, markeredgewidth=1.6)
        one.set_xscale("log")
        one.xaxis.set_major_formatter(mpl.ticker.FuncFormatter(lambda number, _: f"{number:g}"))
        one.set_xlabel(title)
    axes[0].set_yticks(range(len(predictions)), [p.label for p in predictions])
    axes[0].invert_yaxis()
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    figure.savefig(path, metadata={"Date": None, "Creator": None})
    plt.close(figure)


# 2. Claims against what was withheld.


@dataclass(frozen=True)
class Slope:
    """Recorded poses with pitch and roll. The pitch counts nose down, the roll left side up [rad]."""

    time: np.ndarray
    x: np.ndarray
    y: np.ndarray
    heading: np.ndarray
    pitch: np.ndarray
    roll: np.ndarray

    @classmethod
    def read(cls, recording: Recording, withheld: Path) -> "Slope | None":
        """`None` where nothing was withheld."""
        if not withheld.exists():
            return None
        with withheld.open(newline="") as file:
            rows = [own | other for own, other in zip(recording.rows, csv.DictReader(file), strict=True)]
        names = ("time", "x", "y", "heading", "pitch", "roll")
        full = [[float(row[name]) for name in names] for row in rows if all(row[name] for name in names)]
        return cls(*np.array(full).T) if full else None

    def fit(self, chosen: np.ndarray | None = None) -> np.ndarray:
        """How much the ground rises towards east and north [rad]: least squares of pitch and roll. The sensor's mounting is fitted to
        the whole drive, and the slope to the chosen rows.
        """
        sin, cos, ones, none = np.sin(self.heading), np.cos(self.heading), np.ones_like(self.heading), np.zeros_like(self.heading)
        ahead, left = np.column_stack([cos, sin, ones, none]), np.column_stack([-sin, cos, none, ones])
        whole = np.linalg.lstsq(np.vstack([ahead, left]), np.concatenate([-self.pitch, self.roll]), rcond=None)[0]
        if chosen is None:
            return whole[:2]
        rows = np.vstack([ahead[chosen, :2], left[chosen, :2]])
        return np.linalg.lstsq(rows, np.concatenate([-self.pitch[chosen] - whole[2], self.roll[chosen] - whole[3]]), rcond=None)[0]

    def within(self, finding: dict[str, Any]) -> np.ndarray | None:
        """The rows in which a finding acts; `None` for the whole drive."""
        if not finding.get("local"):
            return None
        chosen = np.zeros(len(self.time), dtype=bool)
        for where in finding["where"]:
            if patch := where.get("patch"):
                chosen |= np.hypot(self.x - patch["east"], self.y - patch["north"]) <= patch["radius"]
            else:
                chosen |= (self.time >= where["start"]) & (self.time <= where["end"])
        return chosen


def stated(about: dict[str, Any], sensor: str) -> tuple[float, float] | None:
    """The range of a latency that the data's authors state [s]."""
    found = re.search(r"trails? the gyro by ([\d.]+)-([\d.]+) s", about.get("sensors", {}).get(sensor, ""))
    return (float(found[1]), float(found[2])) if found else None


def rolled_ratio(recording: Recording) -> float | None:
    """How much farther the right wheels roll than the left ones: least squares of the turns by the gyro over the wheels' angles, robust
    against wheels that slip. Neither pose nor model is in it. `None` without a gyro.
    """
    angles, turns = [], []
    for run in recording.runs():
        series = {}
        for name in ("omega_left", "omega_right", "yaw_rate"):
            known = np.array([(float(row["time"]), float(row[name])) for row in run if row.get(name)]).reshape(-1, 2)
            time, rate = known.T
            series[name] = (time, np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(time))])[: len(time)])
        if not all(len(time) for time, _ in series.values()):
            continue
        first, last = max(time[0] for time, _ in series.values()), min(time[-1] for time, _ in series.values())
        if last - first < TURN:
            continue
        at = np.arange(first, last - TURN, TURN / 2)
        left, right, turned = (np.interp(at + TURN, *series[name]) - np.interp(at, *series[name]) for name in series)
        moving = np.abs(left) + np.abs(right) > ROLLED
        angles.append(np.column_stack([right, -left, np.ones_like(left)])[moving])
        turns.append(turned[moving])
    if not turns or sum(map(len, turns)) < 10:
        return None
    rows, wanted = np.vstack(angles), np.concatenate(turns)
    weights = np.ones_like(wanted)
    for _ in range(10):
        solution = np.linalg.lstsq(rows * weights[:, None], wanted * weights, rcond=None)[0]
        distance = np.abs(wanted - rows @ solution)
        weights = np.sqrt(np.minimum(1.0, 2 * np.median(distance) / np.maximum(distance, 1e-12)))
    return float(solution[0] / solution[1])


@dataclass(frozen=True)
class Claim:
    """What a diagnosis claims, what is recorded, and whether it is true."""

    recording: str
    what: str
    probability: float | None
    claimed: str
    recorded: str
    verdict: str

    def row(self) -> str:
        sure = "" if self.probability is None else f"{100 * self.probability:.0f} %"
        return f"| {self.recording} | {self.what} | {sure} | {self.claimed} | {self.recorded} | {self.verdict} |"


def slope_verdict(claimed: np.ndarray, recorded: np.ndarray) -> str:
    """True if the claim is nearer to the recorded slope than level ground is. Below the accuracy of what is recorded nobody knows."""
    if max(np.hypot(*claimed), np.hypot(*recorded)) < LEVEL:
        return UNKNOWN
    return TRUE if np.hypot(*(claimed - recorded)) < np.hypot(*recorded) else FALSE


def latency_verdict(claimed: dict[str, float], known: tuple[float, float] | None) -> str:
    """True if the 90 % interval meets the stated range."""
    if known is None:
        return UNKNOWN
    return TRUE if claimed["low"] <= known[1] and claimed["high"] >= known[0] else FALSE


def vector(slope: np.ndarray) -> str:
    """Rise towards east and north."""
    return f"{slope[0]:+.3f} east, {slope[1]:+.3f} north rad"


def ratio_claim(parameters: dict[str, Any], others: Sequence[float]) -> tuple[str, str, str]:
    """Claimed and recorded ratio of the right wheels' radius to the left ones', and whether the interval has the others' median."""
    left, right = parameters["left"], parameters["right"]
    low, high = right["low"] / left["high"], right["high"] / left["low"]
    text = f"right/left {right['value'] / left['value']:.3f} ({low:.3f} to {high:.3f})"
    if not others:
        return text, "", UNKNOWN
    middle = float(np.median(others))
    return text, f"{middle:.3f} ({min(others):.3f} to {max(others):.3f}) on {len(others)} others", TRUE if low <= middle <= high else FALSE


def claims(recording: Recording, diagnosis: dict[str, Any], truth: Slope | None, others: Sequence[float] = ()) -> list[Claim]:
    """Every finding of a diagnosis; at last the slope if none is claimed and one is recorded. `others` are the ratios of rolled distances
    of the vehicle's other drives.
    """
    found: list[Claim] = []
    has_slope = False
    for finding in diagnosis["findings"]:
        effect, probability, parameters = finding["effect"], finding["probability"], finding["parameters"]
        rest = finding.get("ambiguous_with") or []
        name = f"`{effect}`" + (f" or {', '.join(f'`{other}`' for other in rest)}" if rest else "") + (", local" if finding.get("local") else "")
        if {"slope_east", "slope_north"} & parameters.keys():
            claimed = np.array([value(parameters.get(axis, 0.0)) for axis in ("slope_east", "slope_north")])
            chosen = truth.within(finding) if truth else None
            if truth is None or (chosen is not None and not chosen.any()):
                found.append(Claim(recording.label, name, probability, vector(claimed), "", UNKNOWN))
            else:
                recorded = truth.fit(chosen)
                found.append(Claim(recording.label, name, probability, vector(claimed), vector(recorded), slope_verdict(claimed, recorded)))
            has_slope |= not finding.get("local")
        elif effect == "latency":
            for sensor in ("pose", "wheels"):
                if sensor in parameters:
                    claimed, known = parameters[sensor], stated(recording.about, sensor)
                    text = f"{claimed['value']:.2f} s ({claimed['low']:.2f} to {claimed['high']:.2f})"
                    found.append(Claim(recording.label, f"{name} of the {sensor}", probability, text, f"{known[0]} to {known[1]} s" if known else "",
                                       latency_verdict(claimed, known)))
        elif effect == "wheel_radius" and {"left", "right"} <= parameters.keys():
            found.append(Claim(recording.label, name, probability, *ratio_claim(parameters, others)))
        else:
            numbers = [f"{key.split('.')[-1]} {value(number):.3g} {number.get('unit', '').removeprefix('1')}".strip() for key, number in parameters.items()]
            found.append(Claim(recording.label, name, probability, ", ".join(numbers) if len(numbers) < 4 else f"{len(numbers)} numbers", "", UNKNOWN))
    if truth is not None and not has_slope and np.hypot(*(recorded := truth.fit())) >= LEVEL:
        found.append(Claim(recording.label, "no slope of the whole ground", None, "level", vector(recorded), MISSED))
    return found


def claims_text(found: Sequence[tuple[Recording, dict[str, Any], list[Claim]]]) -> str:
    """Table of errors on held-out data, table of claims, and their count."""
    lines = ["| recording | driven | ahead | position \\[m\\] | heading \\[rad\\] | gain |", "|---|---|---|---|---|---|"]
    for recording, diagnosis, _ in found:
        held_out = diagnosis["fit"].get("held_out")
        if not held_out:
            lines.append(f"| {recording.label} | {recording.driven():.0f} s | not held out | | | |")
            continue
        columns = [" / ".join(f"{held_out[model][key]:.{digits}f}" for model in ("nominal", "retuned", "augmented"))
                   for key, digits in (("position_rmse_m", 3), ("heading_rmse_rad", 3))]
        gain = held_out["gain"]
        lines.append(f"| {recording.label} | {recording.driven():.0f} s | {held_out['horizon']:.1f} s | {' | '.join(columns)} | {gain['value']:.3f} ({gain['standard_error']:.3f}) |")
    all_claims = [claim for _, _, own in found for claim in own]
    lines += ["", "| recording | claim | probability | claimed | recorded or stated | verdict |", "|---|---|---|---|---|---|", *(claim.row() for claim in all_claims), ""]
    counts = [f"{name}: {sum(claim.verdict == name for claim in all_claims)}" for name in (TRUE, FALSE, UNKNOWN, MISSED)]
    return "\n".join([*lines, f"Claims by verdict: {', '.join(counts)}."])


# 3. Soils fitted in place.


SOIL = {"friction_angle": ("friction angle \\[rad\\], 90 %", 1.0, "{:.3f}"), "shear_modulus": ("shear modulus K \\[mm\\], 90 %", 1e3, "{:.2f}")}


def soil(report: dict[str, Any]) -> str:
    """The 90 % intervals of the parameters that planar motion determines."""
    found = {parameter["name"].split(".")[-1]: parameter for parameter in report["parameters"]}
    cells = []
    for name, (_, factor, form) in SOIL.items():
        cells.append(" to ".join(form.format(factor * found[name][end]) for end in ("low", "high")) if name in found else "")
    return " | ".join(cells)


def fitted(tool: Tool, path: Path, label: str) -> tuple[str, str]:
    """A row of each table: the errors, and the soil. A star marks what is too short to halve."""
    model, report = (tool.work / f"{path.stem}.{kind}.json" for kind in ("model", "fit"))
    fit = ("fit", path, "--starts", 0, "--output", model, "--json", report, "--force")
    halved = tool.run(*fit, "--half", check=False) or not tool.run(*fit)
    scored = tool.scored(path, "--model", model)
    cells = {entry["model"]: cell(errors(entry)) for entry in scored["models"]}
    label += "" if halved else "*"
    row = f"| {label} ({scored['judged']}) | {' | '.join(cells.get(name, '') for name in MODELS)} |"
    return row, f"| {label} | {soil(json.loads(report.read_text()))} |"


def fits_text(rows: Sequence[tuple[str, str]]) -> str:
    lines = [f"| recording (windows) | {' | '.join(MODELS.values())} |", "|---|" + "---|" * len(MODELS), *(row for row, _ in rows)]
    return "\n".join([*lines, "", f"| recording | {' | '.join(head for head, *_ in SOIL.values())} |", "|---|" + "---|" * len(SOIL), *(row for _, row in rows)])


# The page.


def marks(part: str) -> tuple[str, str]:
    return f"<!-- written by recordings_report.py: {part} -->", f"<!-- end of {part} -->"


def insert(page: str, part: str, text: str) -> str:
    """The page with another text between the marks of a part."""
    start, end = marks(part)
    before, found, rest = page.partition(start)
    _, closed, after = rest.partition(end)
    if not found or not closed:
        sys.exit(f"recordings_report: the page has no {start} ... {end}")
    return f"{before}{start}\n{text}\n{end}{after}"


def provenance(tool: Tool) -> str:
    today = datetime.now(UTC)
    return f"{today.day} {today:%B %Y}, {tool.version()}."


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", type=Path, default=TARGET / "release" / "ugv", help="the tool [default: target/release/ugv, of scripts/package.sh]")
    parser.add_argument("--data", type=Path, default=DATA, help="has recordings/ and multibody/ [default: $UGV_DATA or ../shared/data beside the project]")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its picture is beside it [default: docs/explanation/recordings.md]")
    parser.add_argument("--work", type=Path, default=TARGET / "recordings", help="keeps diagnoses [default: target/recordings]")
    parser.add_argument("--only", action="append", choices=PARTS, help="writes this part alone; repeatable")
    parser.add_argument("--jobs", type=int, help="threads of the tool [default: one per processor]")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> None:
    """Writes the parts one after the other, so that an interrupted run leaves what was done."""
    asked = parse(arguments)
    folder = asked.data / "recordings"
    paths = sorted(folder.glob("*.csv"))
    if not paths:
        sys.exit(f"recordings_report: skipped, there are no recordings in {folder}; UGV_DATA names the folder that holds recordings/")
    if not asked.tool.exists():
        sys.exit(f"recordings_report: there is no {asked.tool}; scripts/package.sh builds it, or name one with --tool")
    if not asked.out.exists():
        sys.exit(f"recordings_report: there is no page {asked.out}; it needs the marks of docs/explanation/recordings.md")
    tool, recordings = Tool(asked.tool, asked.work, asked.jobs), [Recording.read(path) for path in paths]
    done = provenance(tool)

    def write(part: str, text: str) -> None:
        asked.out.write_text(insert(asked.out.read_text(), part, f"{done}\n\n{text}"))

    parts = asked.only or PARTS
    if "transfer" in parts:
        texts = []
        for number, own in enumerate(group for group in vehicles(recordings) if len(group) > 1):
            reference, kinematics, predictions = transfer(tool, own)
            picture = asked.out.with_name(f"{asked.out.stem}{number or ''}.svg")
            draw(reference, predictions, picture)
            texts.append(transfer_text(reference, kinematics, predictions, picture.name))
        write("transfer", "\n\n".join(texts))
    if "claims" in parts:
        found = []
        ratios = {recording.name: rolled_ratio(recording) for recording in recordings}
        for recording in recordings:
            others = [ratio for other in recordings if other.about.get("vehicle") == recording.about.get("vehicle") and other is not recording
                      if (ratio := ratios[other.name]) is not None]
            # Slopes can be compared where pitch and roll were withheld.
            if truth := Slope.read(recording, folder / "withheld" / recording.path.name):
                diagnosis = json.loads((tool.diagnosed(recording) / "diagnosis.json").read_text())
                found.append((recording, diagnosis, claims(recording, diagnosis, truth, others)))
        write("claims", claims_text(found))
    if "fits" in parts:
        rows = [fitted(tool, recording.path, recording.label) for recording in recordings]
        write("fits", fits_text(rows))
        if others := sorted((asked.data / "multibody").glob("*.csv")):
            write("multibody", fits_text([fitted(tool, path, path.stem.replace("_", " ")) for path in others]))


if __name__ == "__main__":
    main()
