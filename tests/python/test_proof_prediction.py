"""The judge of scripts/proof: states of a drive that is known exactly, errors of predictions, and a peer's selection."""

import csv
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "proof"))

from judge import noise
from judge.peers.residual import TIMES
from judge.peers.stepwise import Regression, select
from judge.prediction import errors, told_sensors
from judge.recording import Recording, Sensors


def drive(folder: Path, lever: float = 0.0, late: float = 0.0) -> Path:
    """A steady turn, after a ramp of the speed, reported by a sensor at the end of a lever, late."""
    time = np.arange(0.0, 20.0, 0.05)
    rate, state = 0.3, []
    x = y = 0.0
    for t in np.arange(0.0, 20.0, 0.001):
        if len(state) < len(time) and t >= time[len(state)] - 1e-9:
            state.append((x, y))
        v = min(1.0, t / 5)
        x, y = x + v * math.cos(rate * t) * 0.001, y + v * math.sin(rate * t) * 0.001
    path = folder / "drive.csv"
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["time", "omega_left", "omega_right", "x", "y", "heading", "yaw_rate"])
        for t, (x, y) in zip(time, state):
            c, s = math.cos(rate * t), math.sin(rate * t)
            rows.writerow([f"{t:.3f}", 3, 4, "", "", "", rate])
            rows.writerow([f"{t + late:.3f}", "", "", x + lever * c, y + lever * s, math.atan2(s, c), ""])
    return path


class Recordings(unittest.TestCase):
    """States and windows of a drive that is known exactly."""

    def test_a_state_with_the_sensors_faults_taken_out(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            told = Sensors(latency={"pose": 0.2}, lever_arm={"ahead": 0.5})
            faulty = Recording(drive(Path(folder), lever=0.5, late=0.2), told).state(12.0)
            plain = Recording(drive(Path(folder))).state(12.0)
        for state in faulty, plain:
            self.assertAlmostEqual(state.v_x, 1.0, places=2)
            self.assertAlmostEqual(state.v_y, 0.0, places=2)
            self.assertAlmostEqual(state.yaw_rate, 0.3, places=6)
            self.assertAlmostEqual(state.heading, 3.6, places=6)
        self.assertAlmostEqual(faulty.x, plain.x, places=3)

    def test_a_model_that_fails_is_charged_the_whole_way(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            windows = Recording(drive(Path(folder))).windows()
        self.assertGreater(len(windows), 5)
        perfect = errors(windows, lambda window: (window.final.x, window.final.y))
        self.assertEqual((perfect["rmse"], perfect["failed"]), (0.0, 0))
        self.assertGreater(errors(windows, lambda window: None)["rmse"], 1.0)

    def test_the_floor_of_noise(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = drive(Path(folder))
            still = {"white": 0.0, "coloured": 0.0, "time": 5.0}
            self.assertEqual(noise.floor(path, {"x": still})["rmse"], 0.0)
            steady = noise.floor(path, {"x": still | {"coloured": 0.05, "time": 1e9}})["rmse"]
            turned = noise.floor(path, {"heading": still | {"coloured": 0.01, "time": 1e9}})["rmse"]
        self.assertLess(steady, 1e-4)  # an offset that stays is no error of a prediction
        self.assertAlmostEqual(turned, 0.01 * 3.5, delta=0.025)  # heading error times the way

    def test_sensors_that_findings_tell_of(self) -> None:
        findings = [{"effect": "latency", "parameters": {"pose": {"value": 0.1}}}, {"effect": "grade", "parameters": {}}]
        self.assertEqual(told_sensors(findings), Sensors(latency={"pose": 0.1}))
        both = {"drive.ahead": {"value": 0.5}, "second.ahead": {"value": 0.7}}
        self.assertEqual(told_sensors([{"effect": "lever_arm", "parameters": both}]), Sensors(lever_arm={"ahead": 0.6}))


class Peers(unittest.TestCase):
    """Step-wise selection on residuals made by hand."""

    def test_selection_finds_the_one_effect(self) -> None:
        random = np.random.default_rng(5)
        n = len(TIMES) // 5
        shape = lambda: {("drive", k): np.column_stack([random.normal(size=(n, 4)), random.normal(size=(n, 2))]) for k in range(6)}
        base, true, other = shape(), shape(), shape()
        step = lambda by: {key: np.column_stack([base[key][:, :4] - by[key][:, :4], base[key][:, 4:]]) for key in base}
        for key in base:
            base[key][:, :4] = 0.1 * base[key][:, :4] + true[key][:, :4]
        problem = Regression(base, [step(shape())], {"grade": [step(true)], "drag": [step(other)]})
        chosen, weights = select(problem)
        self.assertEqual(chosen[0], "grade")
        self.assertGreater(weights["grade"], 0.99)
        self.assertAlmostEqual(problem.bic(["grade"])[1][0], 1.0, delta=0.1)


if __name__ == "__main__":
    unittest.main()
