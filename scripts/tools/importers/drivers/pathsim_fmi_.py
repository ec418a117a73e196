"""PathSim: its block of an FMU fed by two sources."""

from pathsim import Connection, Simulation
from pathsim.blocks import Scope, Source
from pathsim.solvers import RKDP54
from pathsim_fmi import CoSimulationFMU, ModelExchangeFMU
from pathsim_fmi.wrapper import FMUWrapper
from task import STEP, Task, main

TOLERANCE = 1e-7


def allow_enumerations() -> None:
    """pathsim-fmi refuses start values of enumerations: here they become the integers that they are."""
    plain = FMUWrapper.set_variable

    def set_variable(self: FMUWrapper, name: str, value: float) -> None:
        variable = self.variable_map[name]
        if variable.type == "Enumeration":
            variable.type = "Int64" if self.fmi_version.startswith("3.") else "Integer"
        plain(self, name, value)

    FMUWrapper.set_variable = set_variable


def co_simulate(task: Task, late: float) -> None:
    """One run; the block gives at each time what the FMU has a step later, which `late` makes up for."""
    allow_enumerations()
    block = CoSimulationFMU(str(task.fmu), start_values=dict(task.start), dt=STEP)
    sources = [Source(lambda time, side=side: task.speeds(time)[side]) for side in range(len(task.inputs))]
    scope = Scope()
    links = [Connection(source, block[side]) for side, source in enumerate(sources)]
    links += [Connection(block[number], scope[number]) for number in range(len(task.outputs))]
    Simulation([*sources, block, scope], links, dt=STEP, log=False).run(task.drive[-1][0])
    times, values = scope.read()
    task.write([time + late, *row] for time, row in zip(times, values.T, strict=True))


def integrate(task: Task) -> None:
    """The solver begins anew in each step, where the wheel speeds jump."""
    allow_enumerations()
    block = ModelExchangeFMU(str(task.fmu), start_values=dict(task.start))
    held = list(task.drive[0][1:])
    sources = [Source(lambda _, side=side: held[side]) for side in range(len(task.inputs))]
    links = [Connection(source, block[side]) for side, source in enumerate(sources)]
    options = {"Solver": RKDP54, "tolerance_lte_abs": TOLERANCE, "tolerance_lte_rel": TOLERANCE}
    simulation = Simulation([*sources, block], links, dt=STEP / 10, log=False, **options)
    rows = []
    for begin, length, speeds in task.steps():
        held[:] = speeds
        simulation.run(duration=length, reset=False)
        rows.append([begin + length, *block.outputs.to_array()])
    task.write(rows)


def enumeration(task: Task) -> None:
    CoSimulationFMU(str(task.fmu), start_values=dict(task.start), dt=STEP)


main(cs=lambda task: co_simulate(task, STEP), early=lambda task: co_simulate(task, 0.0), me=integrate, enumeration=enumeration)
