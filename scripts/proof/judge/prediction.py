"""Predicting windows of a recording with a model of `ugv`, four seconds ahead."""

import json
import math
import statistics
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from .recording import PERFECT, Recording, Sensors, Window

SENSOR_EFFECTS = ("latency", "lever_arm", "yaw_rate_bias", "heading_offset")
Motion = dict[str, np.ndarray]
Predictor = Callable[[Window], tuple[float, float] | None]


class Simulator:
    """`ugv simulate` of one model."""

    def __init__(self, tool: Path, model: Path) -> None:
        self.tool, self.model = tool, model

    def motion(self, window: Window) -> Motion | None:
        """The motion at the window's times; None where the vehicle cannot drive on."""
        with tempfile.TemporaryDirectory() as folder:
            return self._motion(window, Path(folder) / "course.csv")

    def _motion(self, window: Window, course: Path) -> Motion | None:
        begin = ["--settled"]
        if len(window.course):
            np.savetxt(course, window.course, delimiter=",", header="x,y,heading", comments="")
            begin = ["--course", str(course)]
        initial = [f"{key}={value!r}" for key, value in vars(window.initial).items()]
        table = zip(window.time, window.left, window.right)
        text = "time,omega_left,omega_right\n" + "".join(f"{t:.6f},{a:.8g},{b:.8g}\n" for t, a, b in table)
        command = [str(self.tool), "simulate", "--input", "-", "--model", str(self.model), "--initial", *initial, *begin]
        done = subprocess.run([*command, "--output-step", "input", "--output", "-", "--quiet"], input=text, capture_output=True, text=True, check=False)
        if done.returncode:
            return None
        head, *lines = done.stdout.splitlines()
        values = np.array([line.split(",") for line in lines])
        wanted = {"time", "x", "y", "heading", "v_x", "v_y", "yaw_rate"}
        return {name: values[:, k].astype(float) for k, name in enumerate(head.split(",")) if name in wanted}

    def __call__(self, window: Window) -> tuple[float, float] | None:
        motion = self.motion(window)
        return None if motion is None else (float(motion["x"][-1]), float(motion["y"][-1]))


def root_mean_square(values: Sequence[float]) -> float | None:
    """None of nothing."""
    return math.sqrt(sum(value * value for value in values) / len(values)) if values else None


def score(away: Sequence[tuple[int, float]], failed: int = 0) -> dict:
    """A model's errors, in all and by the number of the window."""
    rmse = root_mean_square([error for _, error in away])
    return {"rmse": rmse, "windows": len(away), "failed": failed, "errors": {str(number): error for number, error in away}}


def compared(scores: Mapping[str, dict | None]) -> dict[str, float | None]:
    """Position errors of models ("own", "retuned" and more) over the windows that all of them have. Earlier judges told no
    errors by the window and chose windows otherwise: what they scored is compared with its like alone."""
    there = {key: one for key, one in scores.items() if one and one["rmse"] is not None}
    lead = there.get("own") or there.get("retuned") or {}
    alike = {key: one for key, one in there.items() if ("errors" in one) == ("errors" in lead)}
    result: dict[str, float | None] = dict.fromkeys(scores)
    if "errors" in lead:
        common = set.intersection(*(set(one["errors"]) for one in alike.values()))
        return result | {key: root_mean_square([one["errors"][number] for number in common]) for key, one in alike.items()}
    return result | {key: one["rmse"] for key, one in alike.items()}


def errors(windows: Sequence[Window], predict: Predictor) -> dict:
    """Position errors at the end of windows; where a model fails, as if the vehicle had stayed where it was."""
    failed, away = 0, []
    for window in windows:
        place = predict(window)
        if place is None or not all(map(math.isfinite, place)):
            failed, place = failed + 1, (window.initial.x, window.initial.y)
        away.append((window.number, math.dist(place, (window.final.x, window.final.y))))
    return score(away, failed)


def on_unseen(tool: Path, model: Path, recording: Path, sensors: Sensors = PERFECT) -> dict:
    """Errors of a model, and what it says of the sensors, on the windows that a recording has as it is, too."""
    plain = {window.number for window in Recording(recording).windows()}
    return errors([window for window in Recording(recording, sensors).windows() if window.number in plain], Simulator(tool, model))


def means(parameters: Mapping[str, dict]) -> dict[str, float]:
    """Values by their last names; of what each of several recordings has for itself the mean."""
    each: dict[str, list[float]] = {}
    for name, p in parameters.items():
        each.setdefault(name.rpartition(".")[2], []).append(p["value"])
    return {name: statistics.fmean(values) for name, values in each.items()}


def told_sensors(findings: Sequence[dict]) -> Sensors:
    """What findings say of the sensors; of what each of several recordings has for itself the mean."""
    sensors = [finding for finding in findings if finding["effect"] in SENSOR_EFFECTS]
    return Sensors(**{finding["effect"]: means(finding.get("parameters") or {}) for finding in sensors})


def nominal_model(tool: Path, recording: Path, to: Path) -> None:
    """Writes the model as the recording's sidecar tells it."""
    told = json.loads(recording.with_suffix(".json").read_text())
    with tempfile.TemporaryDirectory() as folder:
        parts = []
        for key in ("vehicle", "terrain"):
            path = Path(folder) / f"{key}.json"
            path.write_text(json.dumps(told[key]))
            parts += [f"--{key}", str(path)]
        done = subprocess.run([str(tool), "model", *parts], capture_output=True, text=True, check=True)
    to.write_text(done.stdout)
