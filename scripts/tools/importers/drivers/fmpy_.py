"""fmpy: `simulate_fmu`."""

import fmpy
import numpy as np
from task import INPUTS, STEP, Task, main


def held(task: Task) -> np.ndarray:
    """The wheel speeds with two samples at each step, between which they jump."""
    rows = [sample for begin, length, speeds in task.steps() for sample in ((begin, *speeds), (begin + length, *speeds))]
    return np.array(rows, dtype=[(name, float) for name in ("time", *INPUTS)])


def simulate(task: Task, kind: str, **more: object) -> None:
    names = [variable.name for variable in task.outputs]
    result = fmpy.simulate_fmu(str(task.fmu), fmi_type=kind, start_time=0, stop_time=task.drive[-1][0], output_interval=STEP,
                               input=held(task), start_values=dict(task.start), output=names, **more)
    task.write([row["time"], *np.concatenate([np.ravel(row[name]) for name in names])] for row in result)


main(
    cs=lambda task: simulate(task, "CoSimulation"),
    me=lambda task: simulate(task, "ModelExchange", solver="CVode", relative_tolerance=1e-8),
)
