"""libcosimpy: libcosim's fixed-step algorithm, an override manipulator and a last-value observer."""

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
from task import STEP, Task, main

NANOSECONDS = 1e9


def simulate(task: Task) -> None:
    execution = CosimExecution.from_step_size(round(STEP * NANOSECONDS))
    slave = execution.add_local_slave(CosimLocalSlave(fmu_path=str(task.fmu), instance_name="ugv"))
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(manipulator)
    setters = {"Real": execution.real_initial_value, "Boolean": execution.boolean_initial_value}
    for name, value in task.start.items():
        variable = task.variables[name]
        if not setters.get(variable.type, execution.integer_initial_value)(slave, variable.reference, value):
            raise SystemExit(f"libcosim refuses the start value of {name}")
    references, rows = [variable.reference for variable in task.outputs], []
    for begin, length, speeds in task.steps():
        if not manipulator.slave_real_values(slave, [variable.reference for variable in task.inputs], speeds):
            raise SystemExit(f"libcosim refuses the wheel speeds at {begin} s")
        if not execution.step():
            raise SystemExit(f"libcosim's step at {begin} s fails: {execution.status()}")
        rows.append([begin + length, *observer.last_real_values(slave, references)])
    task.write(rows)


main(cs=simulate, enumeration=simulate)
