"""The Python package: the same bits as the tool, errors as exceptions, interruptible. scripts/python.sh installs it."""

import json
import math
import os
import re
import signal
import subprocess
import threading
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import ugv_terrain as ugv
from ugv_terrain.gym import SkidSteerEnv

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
TOOL = TARGET / "release" / "ugv"
DRIVE = ROOT / "scripts" / "examples" / "recordings" / "drive.csv"


def tool(*arguments: object, folder: Path) -> str:
    ran = subprocess.run([TOOL, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=True)
    return ran.stdout


def wheels(seconds: float = 20.0) -> tuple[np.ndarray, np.ndarray]:
    time = np.arange(0.0, seconds, 0.05)
    left = 5.0 + 2.0 * np.sin(0.5 * time)
    return time, np.column_stack([left, 5.0 - 2.0 * np.sin(0.3 * time)])


def recorded(model: ugv.Model, seconds: float = 20.0) -> dict[str, np.ndarray]:
    time, omega = wheels(seconds)
    drive = ugv.rollout(model, time, omega)
    noise = np.random.default_rng(1).normal
    return {
        "time": time,
        "omega_left": omega[:, 0],
        "omega_right": omega[:, 1],
        "x": drive.x + noise(0.0, 0.01, time.size),
        "y": drive.y + noise(0.0, 0.01, time.size),
        "heading": drive.heading + noise(0.0, 0.003, time.size),
        "yaw_rate": drive.yaw_rate + noise(0.0, 0.003, time.size),
    }


class Descriptions(unittest.TestCase):
    def test_numbers_are_read_and_replaced_in_copies(self) -> None:
        vehicle = ugv.Vehicle(mass=520.0)
        self.assertEqual((vehicle.mass, vehicle.half_track), (520.0, ugv.Vehicle.tran2007().half_track))
        self.assertEqual(vehicle.replace(mass=490.0), ugv.Vehicle.tran2007())
        with self.assertRaisesRegex(AttributeError, "replace"):
            vehicle.mass = 1.0
        soil = ugv.Terrain("dry_sand", cohesion=500.0)
        self.assertEqual((soil.cohesion, soil.sinkage_exponent), (500.0, 1.1))
        model = ugv.Model(vehicle, soil, effects={"drag": {"coefficient": 60.0}})
        self.assertEqual(ugv.Model.from_json(model.to_json()).to_dict(), model.to_dict())
        self.assertIn("drag", dict(ugv.effects()))

    def test_what_is_wrong_is_named(self) -> None:
        for wrong, word in [
            (lambda: ugv.Vehicle(mass=-1.0), "mass"),
            (lambda: ugv.Vehicle(weight=1.0), "weight"),
            (lambda: ugv.Terrain("dry_sandd"), "dry_sand"),
            (lambda: ugv.Model(effects={"drag": {"coefficient": math.nan}}), "."),
            (lambda: ugv.rollout(ugv.Model(), [0.0, 0.0], np.zeros((2, 2))), "row 1"),
            (lambda: ugv.rollout(ugv.Model(), [0.0, 1.0], np.zeros((3, 2))), "shape"),
            (lambda: ugv.rollout(ugv.Model(), [0.0, 1.0], np.zeros((2, 2)), outputs=["x y"]), "x y"),
            (lambda: ugv.Simulation(ugv.Model(), np.zeros(5)), "6 numbers"),
            (lambda: ugv.Simulation(ugv.Model()).step(1.0, math.nan, 0.0), "omega_left"),
        ]:
            with self.subTest(word), self.assertRaisesRegex(ValueError, word):
                wrong()


class Drives(unittest.TestCase):
    def test_a_rollout_has_the_bits_of_the_tool(self) -> None:
        folder = TARGET / "test" / "python_package"
        folder.mkdir(parents=True, exist_ok=True)
        model = ugv.Model(terrain="dry_sand", effects={"grade": {"slope_east": 0.05}})
        (folder / "model.json").write_text(model.to_json())
        time, omega = wheels()
        rows = np.column_stack([time, omega])
        np.savetxt(folder / "wheels.csv", rows, "%.17g", ",", header="time,omega_left,omega_right", comments="")
        table = tool("simulate", "--input", "wheels.csv", "--model", "model.json", "--output-step", "input", "--quiet", folder=folder)
        header, *lines = table.strip().splitlines()
        columns = dict(zip(header.split(","), np.array([line.split(",") for line in lines], float).T, strict=True))
        drive = ugv.rollout(model, time, omega, outputs=["power", "rolling_resistance"])
        for name in ugv.STATES:
            np.testing.assert_array_equal(columns[name], getattr(drive, name), name)
        for name, values in drive.outputs.items():
            np.testing.assert_array_equal(columns[name], values, name)

    def test_many_are_as_one_after_the_other(self) -> None:
        models = [ugv.Model(terrain=name) for name in ugv.Terrain.presets()]
        time, omega = wheels(5.0)
        together = ugv.rollout(models, time, omega)
        for model, states in zip(models, together.states, strict=True):
            np.testing.assert_array_equal(ugv.rollout(model, time, omega).states, states)

    def test_steps_copies_and_batches_agree(self) -> None:
        model = ugv.Model(terrain="sandy_loam")
        one, batch = ugv.Simulation(model), ugv.Batch([model, model])
        twin = one.copy()
        for _ in range(20):
            state = one.step(0.05, 6.0, 7.0)
            states, errors = batch.step(0.05, [[6.0, 7.0], [7.0, 6.0]])
            self.assertEqual(errors, [None, None])
        np.testing.assert_array_equal(states[0], state)
        np.testing.assert_allclose(states[1], state * [1, -1, -1, 1, -1, -1], atol=1e-9)
        self.assertEqual(twin.time, 0.0)
        self.assertGreater(one.outputs()["power"], 0.0)
        batch.restart(1)
        np.testing.assert_array_equal(batch.states[1], np.zeros(6))

    def test_of_many_one_may_end_early(self) -> None:
        soft = ugv.Terrain("dry_sand", frictional_modulus=2000.0, cohesive_modulus=10.0)
        time, omega = wheels(5.0)
        models = [ugv.Model(terrain=soft), ugv.Model(terrain="dry_sand")]
        drives = ugv.rollout(models, time, omega)
        self.assertIsNotNone(drives.errors[0])
        self.assertIsNone(drives.errors[1])
        self.assertTrue(np.isfinite(drives.states[1]).all())
        with self.assertRaises(ugv.SimulationError):
            ugv.rollout(models[0], time, omega)

    def test_other_threads_go_on(self) -> None:
        models = [ugv.Model(terrain="dry_sand")] * 40
        time_, omega = wheels(60.0)
        counted, done = 0, threading.Event()

        def drive() -> None:
            ugv.rollout(models, time_, omega)
            done.set()

        threading.Thread(target=drive).start()
        while not done.wait(0.001):
            counted += 1
        self.assertGreater(counted, 10)

    def test_an_environment_is_one_of_gymnasium(self) -> None:
        from gymnasium.utils.env_checker import check_env

        check_env(SkidSteerEnv(), skip_render_check=True)
        environment = SkidSteerEnv()
        environment.reset(seed=3)
        environment.goal = np.array([4.0, 0.0])
        rewards, over = 0.0, False
        while not over:
            _, reward, terminated, truncated, _ = environment.step(np.array([6.0, 6.0]))
            rewards, over = rewards + reward, terminated or truncated
        self.assertTrue(terminated)
        self.assertAlmostEqual(rewards, 4.0 - environment.distance())


class Analyses(unittest.TestCase):
    def test_fit_and_score_are_those_of_the_tool(self) -> None:
        folder = TARGET / "test" / "python_package"
        steps: list[str] = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fit = ugv.fit(DRIVE, free=["friction_angle", "shear_modulus"], starts=0, progress=steps.append)
            score = ugv.score([DRIVE, DRIVE.with_name("second.csv")])
        self.assertTrue(steps)
        tool("fit", DRIVE, "--free", "friction_angle,shear_modulus", "--starts", 0, "--json", "fit.json", "--quiet",
             "--output", "fitted.json", "--force", folder=folder)
        self.assertEqual(fit.data, json.loads((folder / "fit.json").read_text()))
        fitted = ugv.Model.from_file(folder / "fitted.json")
        self.assertEqual(fit.model.to_dict(), fitted.to_dict())
        tool("score", DRIVE, DRIVE.with_name("second.csv"), "--json", "score.json", "--force", "--quiet", folder=folder)
        self.assertEqual(score.data, json.loads((folder / "score.json").read_text()))
        self.assertIn("friction_angle", fit._repr_html_())

    def test_a_diagnosis_is_that_of_the_tool(self) -> None:
        folder = TARGET / "test" / "python_package"
        plain = ugv.Model(terrain="sandy_loam")
        columns = recorded(ugv.Model(terrain="sandy_loam", effects={"drag": {"coefficient": 60.0}}))
        table = np.column_stack(list(columns.values()))
        # The name of the recording is part of the answer.
        path = folder / "recording.csv"
        np.savetxt(path, table, "%.17g", ",", header=",".join(columns), comments="")
        (folder / "plain.json").write_text(plain.to_json())
        steps: list[str] = []
        found = ugv.diagnose(columns, model=plain, progress=steps.append)
        tool("diagnose", path, "--model", "plain.json", "--output", "diagnosis", "--force", "--quiet", folder=folder)
        expected = json.loads((folder / "diagnosis" / "diagnosis.json").read_text())
        self.assertEqual({k: v for k, v in found.data.items() if k != "account"},
                         {k: v for k, v in expected.items() if k != "account"})
        self.assertGreater(len(steps), 3)
        self.assertEqual(found.candidates[0]["effect"], "drag", found)
        # A bolder claim is never likelier, and the catalogue's own formula is not blamed.
        claims = found.data["claims"]
        self.assertEqual([claim["level"] for claim in claims], ["where", "mechanism", "formula"][: len(claims)])
        likely = [claim["probability"] for claim in claims]
        self.assertEqual(likely, sorted(likely, reverse=True))
        self.assertGreater(likely[2], 0.3)
        self.assertIn("iframe", found._repr_html_())
        saved = folder / f"saved_{time.monotonic_ns()}"
        found.save(saved)
        self.assertEqual(ugv.Model.from_file(saved / "model.json").to_dict(), found.model.to_dict())
        with self.assertRaises(FileExistsError):
            found.save(saved)

    def test_a_mechanism_keeps_its_name_by_another_formula(self) -> None:
        # The catalogue's drag acts against the velocity, this one along the vehicle alone.
        other = {"residual_longitudinal": {"speed_squared": -0.03}}
        columns = recorded(ugv.Model(terrain="sandy_loam", effects=other), 30.0)
        found = ugv.diagnose(columns, model=ugv.Model(terrain="sandy_loam"))
        self.assertEqual(found.candidates[0]["effect"], "drag", found)
        where = found.data["claims"][0]
        self.assertEqual(where["name"], "resistance_along")
        self.assertGreater(where["probability"], 0.9)

    def test_pictures_are_drawn(self) -> None:
        import matplotlib

        matplotlib.use("agg")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            score = ugv.score(DRIVE)
            fit = ugv.fit(DRIVE, free=["friction_angle"], starts=0)
        time_, omega = wheels(5.0)
        drives = ugv.rollout([ugv.Model(), ugv.Model(terrain="dry_sand")], time_, omega)
        for drawn, label in [(score.plot(), "error"), (fit.plot(), "interval"), (drives.plot(), "x [m]")]:
            self.assertIn(label, drawn.get_xlabel())

    def test_several_paths_have_a_legend(self) -> None:
        import matplotlib

        matplotlib.use("agg")
        time_, omega = wheels(5.0)

        def legend(count: int, labels: list[str] | None = None) -> list[str] | None:
            shown = ugv.rollout([ugv.Model()] * count, time_, omega).plot(labels=labels).get_legend()
            return None if shown is None else [text.get_text() for text in shown.get_texts()]

        self.assertIsNone(legend(1))
        self.assertEqual(legend(2), ["0", "1"])
        self.assertEqual(legend(2, ["clay", "sand"]), ["clay", "sand"])
        self.assertIsNone(legend(21))
        self.assertEqual(len(legend(21, [f"soil {k}" for k in range(21)]) or []), 21)
        with self.assertRaisesRegex(ValueError, "1 labels for 2 paths"):
            legend(2, ["clay"])

    def test_a_frame_of_pandas_is_a_recording(self) -> None:
        import pandas

        columns = recorded(ugv.Model(terrain="sandy_loam", effects={"drag": {"coefficient": 60.0}}))
        # A missing cell, and a column that the tool does not know.
        columns["x"][7] = math.nan
        frame = pandas.DataFrame({**columns, "comment": "dry"})
        frame.index += 100
        model = ugv.Model(terrain="sandy_loam")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for ask in (
                lambda data: ugv.fit(data, model=model, free=["friction_angle"], starts=0),
                lambda data: ugv.score(data, model=model),
                lambda data: ugv.diagnose(data, model=model),
            ):
                found, same = ask(frame).data, ask(columns).data
                # Times of work differ, and the names of temporary files.
                texts = [json.dumps({k: v for k, v in data.items() if k != "account"}) for data in (found, same)]
                self.assertEqual(*(re.sub(r"[^\" ]*/ugv_terrain_[^/]*/", "", text) for text in texts))
            self.assertEqual(found["candidates"][0]["effect"], "drag")
            several = ugv.score([frame, columns], model=model)
        self.assertEqual(len(several.data["recordings"]), 2)

    def test_what_cannot_be_read_is_a_value_error_with_its_remedy(self) -> None:
        with self.assertRaisesRegex(ValueError, "wheel|omega"):
            ugv.fit({"time": [0.0, 1.0], "x": [0.0, 1.0]})
        with self.assertRaisesRegex(ValueError, "nothere.csv"):
            ugv.score("nothere.csv")
        with self.assertRaisesRegex(ValueError, "cohesion"):
            ugv.fit(DRIVE, free=["cohesio"])
        with self.assertRaises(TypeError):
            ugv.fit(3.0)

    def test_an_exception_of_the_listener_ends_the_work(self) -> None:
        def listen(step: str) -> None:
            raise RuntimeError(step)

        columns = recorded(ugv.Model(terrain="sandy_loam"), 60.0)
        for ask in (ugv.diagnose, ugv.fit):
            with self.subTest(ask.__name__), self.assertRaises(RuntimeError):
                ask(columns, vehicle="tran2007", progress=listen)

    def test_an_interrupt_ends_the_work(self) -> None:
        columns = recorded(ugv.Model(terrain="sandy_loam"), 60.0)
        began = threading.Event()

        def listen(step: str) -> None:
            began.set()

        def interrupt() -> None:
            began.wait()
            os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=interrupt)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            ugv.diagnose(columns, vehicle="tran2007", progress=listen)
        thread.join()


if __name__ == "__main__":
    unittest.main()
