"""A gymnasium environment: drive to a goal. Derive from it, and override `reward` or `observation`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from .description import Model
from .simulation import Simulation, SimulationError


class SkidSteerEnv(gymnasium.Env):
    """A skid-steer vehicle that is to reach a goal.

    Action: speeds of the left and right wheels [rad/s], held for `step` [s]. Observation: the goal ahead and to the left
    [m], velocity ahead and to the left [m/s], yaw rate [rad/s]. Reward: metres by which the goal came nearer. An episode
    ends within `near` [m] of the goal, or where the vehicle cannot drive on; it is cut after `seconds`. `models` are
    drawn at random, one for each episode: soils that a policy has to cope with.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        models: Model | list[Model] | None = None,
        *,
        step: float = 0.1,
        seconds: float = 30.0,
        fastest: float = 8.0,
        farthest: float = 8.0,
        near: float = 0.3,
    ) -> None:
        models = models if models is not None else Model()
        self.models = [models] if isinstance(models, Model) else list(models)
        self.step_seconds, self.seconds, self.farthest, self.near = step, seconds, farthest, near
        self.action_space = spaces.Box(-fastest, fastest, (2,), np.float64)
        self.observation_space = spaces.Box(-np.inf, np.inf, (5,), np.float64)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, Any]]:
        super().reset(seed=seed)
        model = self.models[self.np_random.integers(len(self.models))]
        self.simulation = Simulation(model)
        distance = self.np_random.uniform(0.25, 1.0) * self.farthest
        angle = self.np_random.uniform(-np.pi, np.pi)
        self.goal = distance * np.array([np.cos(angle), np.sin(angle)])
        return self.observation(), {"goal": self.goal.copy()}

    def step(
        self, action: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], float, bool, bool, dict[str, Any]]:
        before = self.distance()
        stuck = None
        left, right = (float(speed) for speed in action)
        try:
            self.simulation.step(self.step_seconds, left, right)
        except SimulationError as error:
            stuck = str(error)
        there = self.distance() < self.near
        is_over = self.simulation.time >= self.seconds - 0.5 * self.step_seconds
        info = {"stuck": stuck} if stuck else {}
        return self.observation(), self.reward(before), there or stuck is not None, is_over, info

    def distance(self) -> float:
        """From the vehicle to the goal [m]."""
        return float(np.hypot(*(self.goal - self.simulation.state[:2])))

    def reward(self, before: float) -> float:
        """Of a step that began at this distance from the goal [m]."""
        return before - self.distance()

    def observation(self) -> NDArray[np.float64]:
        x, y, heading, *velocities = self.simulation.state
        ahead, left = np.cos(heading), np.sin(heading)
        east, north = self.goal - (x, y)
        return np.array([east * ahead + north * left, north * ahead - east * left, *velocities])
