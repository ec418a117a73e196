"""scripts/examples/controllers/slalom: the gymnasium environment and its scripted driver. Training is run by hand (docs/how-to/controllers.md)."""

import os
import sys
import unittest
import warnings
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "examples"))

import controllers.slalom
from controllers.slalom.drivers import Lap, lap, scripted, straight
from controllers.slalom.environment import GATES, HALF_WIDTH, PASSED, SCALE

FMU = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "ugv.fmu"
COURSES = range(5)


def make() -> gymnasium.Env:
    return gymnasium.make("UgvSlalom-v0", fmu=FMU)


class Slalom(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.environment = make()
        cls.addClassCleanup(cls.environment.close)

    def laps(self, driver: controllers.slalom.drivers.Driver) -> list[Lap]:
        return [lap(self.environment, driver, seed) for seed in COURSES]

    def test_gymnasium_finds_nothing_wrong(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            environment = make()
            self.addCleanup(environment.close)
            check_env(environment.unwrapped, skip_render_check=True)

    def test_the_scripted_driver_gets_through_and_driving_straight_does_not(self) -> None:
        for driven in self.laps(scripted):
            self.assertTrue(driven.finished)
            self.assertGreater(driven.reward, GATES * PASSED)
        for driven in self.laps(straight):
            self.assertEqual(driven.passed, 0)
            self.assertFalse(driven.finished)

    def test_gates_count_only_between_their_posts(self) -> None:
        for driver in (scripted, straight):
            for driven in self.laps(driver):
                x, y = driven.path.T
                reached = driven.gates[driven.gates[:, 0] <= x[-1]]
                beside = np.abs(np.interp(reached[:, 0], x, y) - reached[:, 1])
                self.assertEqual(driven.passed, np.sum(beside <= HALF_WIDTH))

    def test_a_seed_gives_the_same_lap_to_the_bit(self) -> None:
        first, second = lap(self.environment, scripted, 3), lap(self.environment, scripted, 3)
        other = make()
        self.addCleanup(other.close)
        for again in (second, lap(other, scripted, 3)):
            np.testing.assert_array_equal(first.path, again.path)
            self.assertEqual(first.reward, again.reward)
        self.assertTrue(np.any(lap(self.environment, scripted, 4).gates != first.gates))

    def test_observations_are_in_the_vehicle_s_frame(self) -> None:
        observation, _ = self.environment.reset(seed=5)
        gates = self.environment.unwrapped.gates
        np.testing.assert_allclose(observation[:4] * SCALE[:4], gates[:2].ravel(), rtol=1e-6)
        for _ in range(10):  # to the left
            observation, *_, info = self.environment.step(np.array([-0.4, 0.8], dtype=np.float32))
        self.assertGreater(info["heading"], 0.1)
        away = (gates[:2] - [info["x"], info["y"]]) @ [1, 1j] * np.exp(-1j * info["heading"])
        np.testing.assert_allclose(observation[:4] * SCALE[:4], np.column_stack([away.real, away.imag]).ravel(), rtol=1e-5)


if __name__ == "__main__":
    unittest.main()
