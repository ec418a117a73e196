"""The judge of scripts/proof: states of a drive that is known exactly, errors of predictions, and a peer's selection."""

import csv
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "proof"))

from judge import noise, oracle, prediction
from judge.peers import residual, stepwise
from judge.peers.residual import TIMES
from judge.peers.stepwise import Candidate, Regression, select
from judge.prediction import compared, errors, on_unseen, score, told_sensors
from judge.recording import Recording, Sensors, strays


def drive(folder: Path, lever: float = 0.0, late: float = 0.0, away: tuple = (), gap: tuple = (0.0, 0.0)) -> Path:
    """A steady turn, after a ramp of the speed, reported by a sensor at the end of a lever, late; with outliers of the
    position (number of the sample, metres), and no pose in a gap."""
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
        for k, (t, (x, y)) in enumerate(zip(time, state)):
            c, s = math.cos(rate * t), math.sin(rate * t)
            rows.writerow([f"{t:.3f}", 3, 4, "", "", "", rate])
            x += dict(away).get(k, 0.0)
            if gap[0] < t < gap[1]:
                continue
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

    def test_a_window_knows_the_course_that_led_to_it(self) -> None:
        told = Sensors(latency={"pose": 0.2}, lever_arm={"ahead": 0.5})
        with tempfile.TemporaryDirectory() as folder:
            windows = Recording(drive(Path(folder), lever=0.5, late=0.2), told).windows()
            plain = Recording(drive(Path(folder))).windows()
        of = {window.number: window for window in windows}
        for window in plain:
            course, initial = of[window.number].course, window.initial
            self.assertLess(len(course), 200)
            step = math.dist(course[-1][:2], (initial.x, initial.y))
            self.assertLess(step, 0.21)
            self.assertLess(abs(course[-1][2] - initial.heading), 0.061)
            # A circle of 1 m/s and 0.3 rad/s since the ramp's end.
            if window.start > 9.0:
                ago = course[-10:]
                self.assertAlmostEqual(ago[-1][2] - ago[0][2], 9 * 0.2 * 0.3, places=5)
                self.assertAlmostEqual(math.dist(ago[-1][:2], ago[0][:2]), 2 / 0.3 * math.sin(0.27), places=2)

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

    def test_outliers_of_the_position_are_left_out_for_everyone(self) -> None:
        away = ((100, 0.35), (103, -0.5), (240, 1.2))
        with tempfile.TemporaryDirectory() as folder:
            clean, told = Recording(drive(Path(folder))), Sensors(latency={"pose": 0.1})
            spoilt = Recording(drive(Path(folder), away=away))
            late = Recording(drive(Path(folder), away=away, late=0.1), told)
        for one in spoilt, late:
            self.assertEqual([len(clean.channels[name][0]) - len(one.channels[name][0]) for name in ("x", "y", "heading")], [3, 3, 0])
            for at in 5.0, 12.0:
                self.assertAlmostEqual(one.state(at).x, clean.state(at).x, places=3)
                self.assertAlmostEqual(one.state(at).v_x, clean.state(at).v_x, places=3)
        self.assertEqual([window.number for window in spoilt.windows()], [window.number for window in clean.windows()])

    def test_real_motion_is_no_outlier(self) -> None:
        def turn(t: np.ndarray) -> np.ndarray:  # 2 m/s on a circle of 1.5 m
            return 1.5 * np.column_stack([np.cos(2 / 1.5 * t), np.sin(2 / 1.5 * t)])

        def pivots(t: np.ndarray) -> np.ndarray:  # to and fro on the spot at up to 1.5 rad/s, a sensor half a metre ahead
            angle = 1.5 * 2 / np.pi * np.sin(np.pi / 2 * t)
            return 0.5 * np.column_stack([np.cos(angle), np.sin(angle)])

        def starts(t: np.ndarray) -> np.ndarray:  # to 2 m/s and to rest again with 2.5 m/s^2, every 8 s
            v = np.clip(np.minimum(2.5 * (t % 8 - 2), 2.5 * (6 - t % 8)), 0.0, 2.0)
            return np.column_stack([np.concatenate([[0.0], np.cumsum(np.diff(t) * (v[1:] + v[:-1]) / 2)]), 0.0 * t])

        def kinks(t: np.ndarray) -> np.ndarray:  # from rest to 1.5 m/s at once
            return np.column_stack([1.5 * np.clip(t - 20.0, 0.0, None), 0.0 * t])

        fine, random = np.arange(0.0, 40.0, 0.01), np.random.default_rng(2)
        for motion in turn, pivots, starts, kinks:
            for rate in 1.0, 2.0, 3.0, 3.5, 4.0, 5.0, 10.0:
                for jitter in 0.0, 0.02:
                    time = np.unique(np.arange(0.03, 39.9, 1 / rate) + jitter * random.uniform(size=len(np.arange(0.03, 39.9, 1 / rate))))
                    time = time[(time < 15.0) | (time > 15.9)]
                    place = np.column_stack([np.interp(time, fine, column) for column in motion(fine).T])
                    with self.subTest(motion.__name__, rate=rate, jitter=jitter):
                        self.assertEqual(strays(time, place).tolist(), [])

    def test_windows_are_the_same_whatever_a_model_says_of_the_sensors(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = drive(Path(folder), gap=(8.0, 9.4))
            plain, late = ({w.number: w.start for w in Recording(path, told).windows()}
                           for told in (Sensors(), Sensors(latency={"pose": 0.6})))
            self.assertNotEqual(plain.keys(), late.keys())
            common = plain.keys() & late.keys()
            self.assertGreater(len(common), 4)
            self.assertEqual([plain[k] for k in common], [late[k] for k in common])
            with mock.patch.object(prediction, "Simulator", lambda *_: lambda window: (window.final.x, window.final.y)):
                scored = on_unseen(Path("ugv"), Path("model"), path, Sensors(latency={"pose": 0.6}))
            self.assertEqual(set(scored["errors"]), {str(number) for number in common})
            still = {"white": 0.0, "coloured": 0.0, "time": 5.0}
            self.assertEqual(set(noise.floor(path, {"x": still})["errors"]), {str(number) for number in plain})

    def test_models_are_compared_over_the_windows_that_all_have(self) -> None:
        own, retuned, best = score([(1, 0.1), (2, 0.2)]), score([(0, 9.0), (1, 0.3), (2, 0.4)]), score([(0, 5.0), (2, 0.1), (3, 7.0)])
        found = compared({"own": own, "retuned": retuned, "oracle": best, "nominal": None})
        self.assertEqual(found, {"own": 0.2, "retuned": 0.4, "oracle": 0.1, "nominal": None})
        # What has no window is no model, and takes none from the others.
        self.assertEqual(compared({"own": score([]), "retuned": score([(0, 0.3)])}), {"own": None, "retuned": 0.3})
        # Of earlier judges there is one number; it is compared with its like.
        before = {"rmse": 0.5, "windows": 3, "failed": 0}
        self.assertEqual(compared({"own": before, "retuned": before, "oracle": None}), {"own": 0.5, "retuned": 0.5, "oracle": None})
        self.assertEqual(compared({"own": before, "retuned": retuned}), {"own": 0.5, "retuned": None})

    def test_sensors_that_findings_tell_of(self) -> None:
        findings = [{"effect": "latency", "parameters": {"pose": {"value": 0.1}}}, {"effect": "grade", "parameters": {}}]
        self.assertEqual(told_sensors(findings), Sensors(latency={"pose": 0.1}))
        both = {"drive.ahead": {"value": 0.5}, "second.ahead": {"value": 0.7}}
        self.assertEqual(told_sensors([{"effect": "lever_arm", "parameters": both}]), Sensors(lever_arm={"ahead": 0.6}))


class Peers(unittest.TestCase):
    """Step-wise selection on residuals made by hand, and what peers fit and predict."""

    def test_windows_of_a_peer_go_by_their_starts(self) -> None:
        class Still:
            """A model that never moves, and tells when each window began."""

            def __init__(self, *_: object) -> None:
                self.starts = starts

            def motion(self, window: object) -> dict:
                self.starts.append(window.start)
                return {"time": [0.0, 4.0]} | {name: [0.0, 0.0] for name in ("x", "y", "heading", "yaw_rate")}

        with tempfile.TemporaryDirectory() as folder, mock.patch.object(stepwise, "Simulator", Still):
            path, found = drive(Path(folder), gap=(5.1, 5.65)), []
            for told in Sensors(), Sensors(latency={"pose": 0.6}):
                starts: list[float] = []
                keys = stepwise.samples(Path("ugv"), [path], Path("model"), told).keys()
                self.assertEqual(len(keys), len(starts))
                found.append(dict(zip(keys, starts)))
        self.assertTrue(found[0].keys() & found[1].keys())
        for key in found[0].keys() & found[1].keys():
            self.assertEqual(found[0][key], found[1][key])

    def test_an_effect_with_which_the_model_cannot_drive_is_left_out(self) -> None:
        random = np.random.default_rng(6)
        shape = lambda n: {("drive", k): random.normal(size=(8, 6)) for k in range(n)}
        problem = Regression(shape(8), [shape(8)], {"grade": [shape(7)], "drag": [shape(8), shape(2)], "payload": [{}]})
        self.assertEqual((set(problem.columns), len(problem.windows)), ({"grade"}, 7))

    def test_tracks_of_two_recordings_are_not_taken_for_one_another(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            window = Recording(drive(Path(folder))).windows()[2]
        tracks = [residual.Track(window, base, base, None) for base in (np.zeros((len(TIMES), 3)), np.full((len(TIMES), 3), 1.0))]
        alone = [residual.rmse([track], residual.nothing([track])) for track in tracks]
        self.assertGreater(abs(alone[0] - alone[1]), 0.1)
        self.assertAlmostEqual(residual.rmse(tracks, residual.nothing(tracks)), math.sqrt((alone[0] ** 2 + alone[1] ** 2) / 2))

    def test_what_was_selected_is_fitted_from_the_retuned_soil_on(self) -> None:
        soil, fits = {"cohesion": 123.0}, []
        drag = Candidate("drag", {"linear": 40.0}, {"linear": 0.0}, {"linear": (0.0, 900.0)})
        problem = mock.Mock()
        problem.bic.return_value = (0.0, np.array([0.5]))

        def fit(_tool: Path, _given: list, model: Path, *_: object) -> dict:
            fits.append(_[2:])
            model.write_text("{}")
            return {"parameters": [{"name": "drag.linear", "kind": "model", "value": 30.0, "low": 20.0, "high": 40.0}]}

        with tempfile.TemporaryDirectory() as folder:
            model = Path(folder) / "retuned_model.json"
            model.write_text(json.dumps({"terrain": soil}))
            asked = (Path("ugv"), [Path("drive.csv")], Path("unseen.csv"), model)
            with mock.patch.multiple(stepwise, catalogue=lambda _: [drag], regression=lambda *_: problem, fit=fit,
                                     select=lambda _: (["drag"], {"drag": 1.0}), on_unseen=lambda *_: score([(0, 0.1)])):
                first = stepwise.stepwise(*asked)
                self.assertEqual(fits, [({"drag": {"linear": 20.0}}, soil)])
                # An answer that is there is kept: what it selected is fitted again, from what was found on.
                again = stepwise.stepwise(*asked, first["answer"])
        self.assertEqual(fits[1], ({"drag": {"linear": 30.0}}, soil))
        self.assertEqual(again, first)

    def test_what_each_recording_tells_of_its_sensors_is_kept(self) -> None:
        def fit(*_: object) -> dict:
            numbers = {"kind": "sensor", "low": 0.0, "high": 1.0}
            return {"parameters": [{"name": f"{name}.lever_arm_x", "value": value} | numbers for name, value in (("drive", 0.3), ("second", 0.5))]}

        arm = Candidate("lever_arm", {"ahead": 0.3}, {"ahead": 0.0}, {"ahead": (-3.0, 3.0)})
        with mock.patch.object(stepwise, "fit", fit):
            findings = stepwise.refit(Path("ugv"), [], Path("model.json"), [arm], [{}], {})
        self.assertEqual([(key, p["value"]) for key, p in findings[0]["parameters"].items()], [("drive.ahead", 0.3), ("second.ahead", 0.5)])
        self.assertEqual(told_sensors(findings), Sensors(lever_arm={"ahead": 0.4}))
        # As the oracle does.
        truth = {"effects": [{"effect": "lever_arm", "kind": "sensor", "parameters": {"ahead": 0.4}, "off": {"ahead": 0.0, "left": 0.0}}],
                 "true_terrain": {}}
        with mock.patch.object(oracle, "fit", fit):
            self.assertEqual(oracle.oracle(Path("ugv"), [], truth, Path("model.json")), Sensors(lever_arm={"ahead": 0.4}))

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
