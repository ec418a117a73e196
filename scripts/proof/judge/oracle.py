"""What one who knows the effect gains: soil and the effects' strengths fitted, from the true ones on, to the recordings
that the tool got."""

import json
import subprocess
import tempfile
from pathlib import Path

from generator.conditions import condition_of

from .gauge import told_by, windows
from .prediction import SENSOR_EFFECTS, Sensors, means

SOIL = ["cohesion", "friction_angle", "frictional_modulus", "sinkage_exponent", "shear_modulus"]
SENSOR_NAMES = {
    ("latency", "pose"): "pose_latency",
    ("latency", "wheels"): "wheel_latency",
    ("lever_arm", "ahead"): "lever_arm_x",
    ("lever_arm", "left"): "lever_arm_y",
    ("yaw_rate_bias", "bias"): "yaw_rate_bias",
    ("heading_offset", "offset"): "heading_offset",
}


def fit(tool: Path, recordings: list[Path], model: Path, free: list[str] = SOIL, sensors: list[str] | None = None,
        effects: dict | None = None, terrain: dict | None = None) -> dict:
    """Fits with `ugv fit` from the terrain of the recordings or this one on, writes the model, and gives the report."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [str(tool), "fit", *map(str, recordings), "--free", ",".join(free), "--starts", "0", "--jobs", "1",
                   "--sensors", ",".join(sensors or []) or "none", "--output", str(model), "--json", str(report), "--force"]
        if effects:
            path = Path(folder) / "effects.json"
            path.write_text(json.dumps({"format": "ugv-effects/1", **effects}))
            command += ["--effects", str(path)]
        if terrain:
            path = Path(folder) / "terrain.json"
            path.write_text(json.dumps(terrain))
            command += ["--terrain", str(path)]
        done = subprocess.run([*command, "--quiet"], capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "fit failed")
        return json.loads(report.read_text())


def knowable(truth: dict) -> bool:
    """Whether the truth is in the catalogue, and acts everywhere or on a place of the map: seconds of a drive do not fit
    segments, each with a beginning of its own."""
    effects = truth["effects"]
    if condition_of(truth["family"]) == "local" and not windows(truth):
        return False
    inside = all(e["kind"] != "outside" and e["parameters"].get("over", "place") == "place" for e in effects)
    return bool(effects) and inside and all(window["kind"] == "disc" for window in windows(truth))


def active(effect: dict) -> list[str]:
    """The strengths that turn it on."""
    return [key for key, off in effect["off"].items() if effect["parameters"].get(key, off) != off]


def place(effect: dict, drive: str) -> dict | None:
    """The disc on the map in which it acts in a drive, as a window of the effects' file."""
    window = (effect.get("windows") or {}).get(drive)
    return window and {"effects": [effect["effect"]], "place": dict(zip(("x", "y", "radius"), window["numbers"]))}


def oracle(tool: Path, recordings: list[Path], truth: dict, model: Path) -> Sensors:
    """Fits as one who knows the effects would, begun at the true soil and strengths: a search from further off may end
    elsewhere. Gives what it says of the sensors."""
    free, sensors, effects, told = list(SOIL), [], {}, {}
    for effect in map(told_by, truth["effects"]):
        name, parameters = effect["effect"], effect["parameters"]
        if name in SENSOR_EFFECTS:
            told[name] = dict(parameters)
            sensors += [SENSOR_NAMES[name, key] for key in active(effect) if (name, key) in SENSOR_NAMES]
        else:
            effects[name] = parameters
            free += [f"{name}.{key}" for key in active(effect)]
            if window := place(effect, "drive"):
                effects["window"] = window
    report = fit(tool, recordings, model, free, sensors, effects, truth["true_terrain"])
    fitted = means({p["name"]: p for p in report["parameters"] if p["kind"] == "sensor"})
    for (name, key), fitted_name in SENSOR_NAMES.items():
        if fitted_name in fitted and key in told.get(name, {}):
            told[name][key] = fitted[fitted_name]
    for effect in truth["effects"]:
        if window := place(effect, "unseen"):
            fitted_model = json.loads(model.read_text())
            fitted_model["effects"]["window"] = window
            model.write_text(json.dumps(fitted_model))
    return Sensors(**told)
