"""CasADi: the equations of motion (model exchange) in its own CVODES, interval by interval."""

import casadi
import numpy as np
from task import Task, main

TOLERANCE = 1e-7  # the FMU solves for loads and entry angles itself, to 1e-9: much tighter, CVODES meets that noise and gives up


def initial(task: Task, names: list[str]) -> list[float]:
    """The first states: without slip at wheel speeds of nothing it stands still."""
    still = {"v_x", "v_y", "yaw_rate"} if task.start.get("initial.no_slip") else set()
    return [0.0 if name in still else float(task.start.get(f"initial.{name}", 0.0)) for name in names]


def simulate(task: Task, outputs: bool = True) -> None:
    builder = casadi.DaeBuilder("ugv", str(task.fmu), {})
    for name, value in task.start.items():
        builder.set([name], [float(value)])
    kinds = ["ode", "y"] if outputs else ["ode"]
    function = builder.create("f", ["x", "u"], kinds)
    names = [str(state) for state in builder.x()]
    x, u = casadi.MX.sym("x", len(names)), casadi.MX.sym("u", len(task.inputs))
    times, speeds = np.array(task.drive)[:, 0], np.array(task.drive)[:-1, 1:].T
    dae = {"x": x, "u": u, "ode": function(x, u)[0] if outputs else function(x, u)}
    options = {"reltol": TOLERANCE, "abstol": TOLERANCE}
    integrator = casadi.integrator("i", "cvodes", dae, times[0], times[1:], options)
    solution = np.array(integrator(x0=initial(task, names), u=speeds)["xf"])
    if not outputs:
        task.write(([time, *state] for time, state in zip(times[1:], solution.T, strict=True)), names)
        return
    wanted = np.array(function.map(len(times) - 1)(solution, speeds)[1])
    task.write([time, *row] for time, row in zip(times[1:], wanted.T, strict=True))


main(me=simulate, me3=lambda task: simulate(task, outputs=False), me3_outputs=simulate)
