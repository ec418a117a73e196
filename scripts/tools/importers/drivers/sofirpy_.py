"""sofirpy: the FMU connected to a model of Python's that holds the wheel speeds."""

from pathlib import Path
from typing import ClassVar

from sofirpy import SimulationEntity, simulate
from task import STEP, Task, main


class Speeds(SimulationEntity):
    """The wheel speeds; after a step, those of the next one."""

    task: ClassVar[Task]

    def __init__(self) -> None:
        self.time = 0.0

    def set_parameter(self, parameter_name: str, parameter_value: float) -> None:
        raise NotImplementedError

    def get_parameter_value(self, parameter_name: str) -> float:
        return self.task.speeds(self.time)[["left", "right"].index(parameter_name)]

    def do_step(self, time: float) -> None:
        self.time = time + STEP


def drive(task: Task) -> None:
    Speeds.task = task
    names = [variable.name for variable in task.outputs]
    sides = zip(task.inputs, ("left", "right"), strict=True)
    links = [{"parameter_name": v.name, "connect_to_system": "speeds", "connect_to_external_parameter": side} for v, side in sides]
    result = simulate(stop_time=task.drive[-1][0], step_size=STEP, fmu_paths={"ugv": Path(task.fmu)}, model_classes={"speeds": Speeds},
                      connections_config={"ugv": links}, start_values={"ugv": dict(task.start)}, parameters_to_log={"ugv": names})
    table = result[["time", *(f"ugv.{name}" for name in names)]]
    task.write(table.itertuples(index=False))


main(cs=drive)
