"""What recordings say: fits, scores, diagnoses. The answers are those of the tool, to the bit."""

from __future__ import annotations

import csv
import html
import json
import os
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _native
from .description import Model, Terrain, Vehicle

Recording = str | os.PathLike[str] | Mapping[str, Any] | Any
"""A path (CSV or a robot's log), or columns by name: a dict of sequences, or a DataFrame. Columns: time [s],
omega_left, omega_right [rad/s], and any of x, y [m], heading [rad], v_x, v_y [m/s], yaw_rate [rad/s], run."""

Progress = Callable[[str], object]
"""Is given each step's name at its start. An exception that it raises ends the work."""


def _write_table(columns: Any, path: Path) -> None:
    if hasattr(columns, "to_csv"):
        columns.to_csv(path, index=False)
        return
    if not isinstance(columns, Mapping):
        raise TypeError(f"a recording is a path, a DataFrame or a dict of columns, not {type(columns).__name__}")
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


class _Question:
    """Files for what is in memory, as long as the work lasts."""

    def __init__(self, command: str) -> None:
        self.arguments = [command]
        self._folder = tempfile.TemporaryDirectory(prefix="ugv_terrain_")

    def __enter__(self) -> _Question:
        return self

    def __exit__(self, *_: object) -> None:
        self._folder.cleanup()

    def _file(self, name: str, text: str) -> str:
        path = Path(self._folder.name) / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    def recordings(self, recordings: Recording | Sequence[Recording]) -> None:
        """One recording or several. Those in memory are called recording, recording2, ..."""
        several = isinstance(recordings, Sequence) and not isinstance(recordings, str)
        for place, one in enumerate(recordings if several else [recordings]):
            if isinstance(one, (str, os.PathLike)):
                self.arguments.append(os.fspath(one))
                continue
            path = Path(self._folder.name) / f"recording{place + 1 if place else ''}.csv"
            _write_table(one, path)
            self.arguments.append(str(path))

    def model(
        self,
        vehicle: Vehicle | str | None,
        terrain: Terrain | str | None,
        effects: Mapping[str, Any] | None,
        model: Model | None,
    ) -> None:
        if isinstance(vehicle, Vehicle):
            vehicle = self._file("vehicle.json", json.dumps(vehicle.to_dict()))
        self.option("vehicle", vehicle)
        if isinstance(terrain, Terrain):
            terrain = self._file("terrain.json", json.dumps(terrain.to_dict()))
        self.option("terrain", terrain)
        if effects is not None:
            self.option("effects", self._file("effects.json", json.dumps(dict(effects))))
        if model is not None:
            self.option("model", self._file("model.json", model.to_json()))

    def option(self, name: str, value: object) -> None:
        if value is not None:
            self.arguments.append(f"--{name}={value}")

    def answer(self, progress: Progress | None) -> dict[str, str]:
        texts, notes = _native.answer(self.arguments, progress)
        for note in notes:
            warnings.warn(note, stacklevel=4)
        return texts


class _Answer:
    """What a command found: `data` is its JSON, `summary` the text that the tool prints."""

    def __init__(self, data: dict[str, Any], summary: str) -> None:
        self.data = data
        self.summary = summary

    def __repr__(self) -> str:
        return self.summary

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.summary)}</pre>"


class Diagnosis(_Answer):
    """What the model left out. `data` is diagnosis.json (format ugv-diagnosis/1)."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        super().__init__(json.loads(texts["diagnosis.json"]), texts["summary"])
        self._texts = dict(texts)

    @property
    def verdict(self) -> str:
        """missing_physics, sensor_fault, nothing_missing, ambiguous, insufficient_data, ..."""
        return self.data["verdict"]

    @property
    def statement(self) -> str:
        """The finding in a sentence."""
        return self.data["statement"]

    @property
    def findings(self) -> list[dict[str, Any]]:
        return self.data["findings"]

    @property
    def candidates(self) -> list[dict[str, Any]]:
        """All that may be missing, the likeliest first, with probabilities."""
        return self.data["candidates"]

    @property
    def model(self) -> Model:
        """The refitted soil with the findings."""
        return Model.from_json(self._texts["model.json"])

    @property
    def report(self) -> str:
        """The report, an HTML page."""
        return self._texts["report.html"]

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes diagnosis.json, model.json and report.html; refuses a folder that has one of them."""
        folder = Path(folder)
        files = {name: text for name, text in self._texts.items() if name != "summary"}
        for name in files:
            if (folder / name).exists():
                raise FileExistsError(f"{folder / name} exists; name another folder")
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")

    def _repr_html_(self) -> str:
        page = html.escape(self.report, quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:80vh;border:0" title="report"></iframe>'

    def plot(self, axes: Any = None) -> Any:
        """Draws the probabilities of what may be missing; needs matplotlib. Returns the axes."""
        likely = [one for one in self.candidates if one["probability"] >= 0.005]
        names = [one["effect"] for one in likely]
        return _bars(axes, names, [one["probability"] for one in likely], "probability")


class Fit(_Answer):
    """Fitted numbers with intervals. `data` is the JSON of `ugv fit` (format ugv-fit/1)."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        super().__init__(json.loads(texts["fit.json"]), texts["summary"])
        self._model = texts["model.json"]

    @property
    def model(self) -> Model:
        return Model.from_json(self._model)

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Estimates with 90 % intervals, in SI units."""
        return self.data["parameters"]

    def plot(self, axes: Any = None) -> Any:
        """Draws each interval as a share of the prior's; needs matplotlib. Returns the axes."""
        names = [one["name"] for one in self.parameters]
        widths = [one["width_over_prior"] for one in self.parameters]
        return _bars(axes, names, widths, "width of the interval over the prior's")


class Score(_Answer):
    """Errors of models in prediction. `data` is the JSON of `ugv score` (format ugv-score/1)."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        super().__init__(json.loads(texts["score.json"]), texts["summary"])

    @property
    def recordings(self) -> list[dict[str, Any]]:
        return self.data["recordings"]

    def plot(self, axes: Any = None) -> Any:
        """Draws the median position errors of the first recording; needs matplotlib. Returns the axes."""
        models = [one for one in self.recordings[0]["models"] if one.get("position_m")]
        errors = [one["position_m"]["median"]["value"] for one in models]
        return _bars(axes, [one["model"] for one in models], errors, "median position error [m]")


def _bars(axes: Any, names: Sequence[str], values: Sequence[float], label: str) -> Any:
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.figure().add_subplot()
    axes.barh(list(names)[::-1], list(values)[::-1])
    axes.set_xlabel(label)
    return axes


def diagnose(
    recordings: Recording | Sequence[Recording],
    *,
    vehicle: Vehicle | str | None = None,
    terrain: Terrain | str | None = None,
    effects: Mapping[str, Any] | None = None,
    model: Model | None = None,
    seed: int = 1,
    within: float | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Finds the physics that the model leaves out, as `ugv diagnose` does.

    `vehicle` is a description, or the name of a preset such as "tran2007" (the paper's). Without one, that of NAME.json
    beside NAME.csv is taken, and a recording without one is refused. Without a terrain, that of NAME.json is taken, or
    else clayed_soil. `within` [s] limits the time, plus 10 % or 2 s. Ctrl-C ends the work within about a second. Notes
    of the reader become warnings. Raises ValueError for input that cannot be diagnosed.
    """
    with _Question("diagnose") as question:
        question.recordings(recordings)
        question.model(vehicle, terrain, effects, model)
        question.option("seed", seed)
        question.option("within", within)
        question.option("jobs", jobs)
        return Diagnosis(question.answer(progress))


def fit(
    recordings: Recording | Sequence[Recording],
    *,
    free: Sequence[str] = (),
    sensors: Sequence[str] | None = None,
    vehicle: Vehicle | str | None = None,
    terrain: Terrain | str | None = None,
    effects: Mapping[str, Any] | None = None,
    model: Model | None = None,
    segment: float | None = None,
    starts: int | None = None,
    seed: int = 1,
    half: bool = False,
    robust: bool = True,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fits soil, vehicle and sensor parameters to recordings, as `ugv fit` does; its options say what each means."""
    with _Question("fit") as question:
        question.recordings(recordings)
        question.model(vehicle, terrain, effects, model)
        question.option("free", ",".join(free) or None)
        question.option("sensors", None if sensors is None else ",".join(sensors) or "none")
        question.option("segment", segment)
        question.option("starts", starts)
        question.option("seed", seed)
        question.option("jobs", jobs)
        question.arguments += ["--half"] * half + ["--not-robust"] * (not robust)
        return Fit(question.answer(progress))


def score(
    recordings: Recording | Sequence[Recording],
    *,
    vehicle: Vehicle | str | None = None,
    terrain: Terrain | str | None = None,
    effects: Mapping[str, Any] | None = None,
    model: Model | None = None,
    horizon: float | None = None,
    spacing: float | None = None,
    heading: str | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Score:
    """Compares predictions of soil models and kinematics with recordings, as `ugv score` does."""
    with _Question("score") as question:
        question.recordings(recordings)
        question.model(vehicle, terrain, effects, model)
        question.option("horizon", horizon)
        question.option("spacing", spacing)
        question.option("heading", heading)
        question.option("jobs", jobs)
        return Score(question.answer(progress))
