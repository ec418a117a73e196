"""The slalom: gates on dry sand, driven through by the FMU.

An action is a pair of wheel speeds, held for 0.2 s. The driver sees, in the vehicle's own frame, the next two gates,
its velocities and the slip of either side; no map, no heading, and nothing of the soil. On this sand the outer wheels slip
by more than half in a curve, so that wheel speeds and motion have little to do with each other.
"""

import os
import tempfile
from pathlib import Path
from typing import Any

import fmpy
import gymnasium
import numpy as np
from fmpy.fmi2 import FMU2Slave
from gymnasium import spaces

FMU = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).resolve().parents[4] / "target")) / "ugv.fmu"
DRY_SAND = 1
STEP = 0.2  # s between two actions
GATES, SPACING = 6, 6.0  # m from one gate to the next, along the course
OFFSET, SPREAD = 0.8, 0.2  # m that gates lie beside the course, alternately left and right, and by chance
HALF_WIDTH = 0.5  # m beside a gate's middle, within which the centre of mass must pass
WHEEL_LIMIT = 12.0  # rad/s
STRAY = 4.0  # m beside the course: given up
PASSED, MISSED = 5.0, -5.0  # reward of a gate; a metre nearer to the next one is worth 1
SLIP_COST = 0.05  # of either side's slip, each step
STATE = ["x", "y", "heading", "v_x", "v_y", "yaw_rate", "wheel[1].longitudinal_slip", "wheel[2].longitudinal_slip"]
LARGEST = 20.0  # of an observation
SCALE = np.array([SPACING, 1.0, SPACING, 1.0, 1.0, 0.1, 0.3, 1.0, 1.0])  # to numbers near 1


class UgvSlalom(gymnasium.Env[np.ndarray, np.ndarray]):
    """Observation: next gate ahead and left, the one after it, v_x, v_y, yaw rate, slips left and right; scaled.
    Action: wheel speeds left and right, -1 standing still to 1 at 12 rad/s."""

    metadata = {"render_modes": []}  # noqa: RUF012
    action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
    observation_space = spaces.Box(-LARGEST, LARGEST, (9,), np.float32)

    def __init__(self, fmu: Path = FMU) -> None:
        if not Path(fmu).is_file():
            raise FileNotFoundError(f"{fmu} is missing; build it with scripts/package.sh")
        self._folder = tempfile.TemporaryDirectory()
        fmpy.extract(str(fmu), self._folder.name)
        model = fmpy.read_model_description(self._folder.name)
        reference = {v.name: v.valueReference for v in model.modelVariables}
        self._outputs, self._inputs = [reference[n] for n in STATE], [reference["omega_left"], reference["omega_right"]]
        self._slave = FMU2Slave(guid=model.guid, unzipDirectory=self._folder.name, modelIdentifier=model.coSimulation.modelIdentifier)
        self._slave.instantiate()
        self._slave.setInteger([reference["terrain"]], [DRY_SAND])
        self._slave.setupExperiment(startTime=0.0)
        self._slave.enterInitializationMode()
        self._slave.exitInitializationMode()
        # Every episode starts from here: restoring a state is faster than initializing an FMU.
        self._beginning = self._slave.getFMUstate()

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """At rest at the origin, heading along the course; new gates."""
        super().reset(seed=seed)
        self._slave.setFMUstate(self._beginning)
        side = self.np_random.choice([-1.0, 1.0]) * (-1.0) ** np.arange(GATES)
        beside = side * OFFSET + self.np_random.uniform(-SPREAD, SPREAD, GATES)
        self.gates = np.column_stack([SPACING * np.arange(1, GATES + 1), beside])
        self._time, self._next = 0.0, 0
        self._state = np.array(self._slave.getReal(self._outputs))
        return self._observation(), self._info()

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Holds the wheel speeds for 0.2 s."""
        speeds = 0.5 * WHEEL_LIMIT * (np.clip(np.asarray(action, dtype=float), -1.0, 1.0) + 1.0)
        self._slave.setReal(self._inputs, speeds)
        self._slave.doStep(self._time, STEP)
        self._time += STEP
        before, self._state = self._state, np.array(self._slave.getReal(self._outputs))
        gate = self.gates[self._next]
        reward = float(np.hypot(*(gate - before[:2])) - np.hypot(*(gate - self._state[:2])))
        reward -= SLIP_COST * float(np.sum(np.abs(self._state[6:8])))
        ended = abs(self._state[1]) > STRAY or self._state[0] < -STRAY
        if before[0] < gate[0] <= self._state[0]:
            share = (gate[0] - before[0]) / (self._state[0] - before[0])
            beside = before[1] + share * (self._state[1] - before[1]) - gate[1]
            passed = abs(beside) <= HALF_WIDTH
            reward += PASSED if passed else MISSED
            self._next += int(passed)
            ended |= not passed or self._next == GATES
        return self._observation(), reward, bool(ended), False, self._info()

    def close(self) -> None:
        """Frees the FMU."""
        if self._slave is not None:
            self._slave.freeFMUstate(self._beginning)
            self._slave.terminate()
            self._slave.freeInstance()
            self._slave = None
            self._folder.cleanup()

    def _observation(self) -> np.ndarray:
        x, y, heading, *motion = self._state
        # Behind the last gate the course goes on straight.
        beyond = self.gates[-1] + np.array([[SPACING, 0.0], [2 * SPACING, 0.0]])
        ahead = np.concatenate([self.gates, beyond])[self._next : self._next + 2] - [x, y]
        turned = (ahead[:, 0] + 1j * ahead[:, 1]) * np.exp(-1j * heading)
        seen = np.concatenate([np.column_stack([turned.real, turned.imag]).ravel(), motion])
        return np.clip(seen / SCALE, -LARGEST, LARGEST).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        pose = {name: float(value) for name, value in zip(("x", "y", "heading"), self._state[:3], strict=True)}
        return {"time": self._time, **pose, "gates_passed": self._next, "finished": self._next == GATES}
