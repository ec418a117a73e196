"""FMUGym: an environment whose actions are the wheel speeds and whose observations are the outputs."""

from typing import Any

import numpy as np
from fmugym.fmugym import FMUGym
from fmugym.fmugym_config import FMUGymConfig, VarSpace
from task import STEP, STEPS, Task, Variable, main

WIDE = (-1e6, 1e6)


class Environment(FMUGym):
    """What FMUGym asks its users to write, with start values that are not random."""

    start: dict[int, float] = {}

    def _noisy_init(self) -> dict[int, float]:
        return self.start

    def compute_reward(self, *_: Any) -> float:
        return 0.0


class Random(FMUGym):
    """FMUGym's own random start values."""

    def compute_reward(self, *_: Any) -> float:
        return 0.0


def configuration(task: Task, outputs: list[Variable], random: list[str]) -> FMUGymConfig:
    boxes = {"inputs": [v.name for v in task.inputs], "outputs": [v.name for v in outputs], "random_vars": random}
    spaces = {kind: VarSpace(kind) for kind in boxes}
    for kind, names in boxes.items():
        for name in names:
            spaces[kind].add_var_box(name, *WIDE)
    times = {"stop_time": STEPS * STEP, "sim_step_size": STEP, "action_step_size": STEP}
    return FMUGymConfig(fmu_path=str(task.fmu), **times, **spaces)


def simulate(task: Task, arrays: bool = False) -> None:
    outputs = [variable for variable in task.outputs if arrays or variable.size == 1]
    Environment.start = {task.variables[name].reference: value for name, value in task.start.items()}
    environment = Environment(configuration(task, outputs, []))
    observation, _ = environment.reset()
    rows = [[0.0, *observation]]
    for begin, length, speeds in task.steps():
        observation, _, terminated, cut, _ = environment.step(np.array(speeds))
        if terminated or cut:
            raise SystemExit(f"FMUGym ends the episode at {begin} s")
        rows.append([begin + length, *observation])
    environment.close()
    task.write(rows, [name for variable in outputs for name in variable.scalars()])


def randomise(task: Task) -> None:
    Random(configuration(task, task.outputs, ["initial.x"]))


main(cs=simulate, cs_arrays=lambda task: simulate(task, arrays=True), random=randomise)
