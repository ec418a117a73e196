"""fmuloader: its classes for FMI 2.0 and 3.0, function by function."""

import xml.etree.ElementTree
import zipfile

from fmuloader import fmi2, fmi3
from task import Task, main


def identity(task: Task, key: str) -> str:
    """The guid or token, which fmuloader leaves to its user to read."""
    with zipfile.ZipFile(task.fmu) as archive:
        return xml.etree.ElementTree.fromstring(archive.read("modelDescription.xml")).get(key)


def simulate_2(task: Task) -> None:
    slave = fmi2.Fmi2Slave(task.fmu, model_identifier="ugv")
    slave.instantiate("ugv", fmi2.Fmi2Type.CO_SIMULATION, guid=identity(task, "guid"))
    setters = {"Real": slave.set_real, "Boolean": slave.set_boolean}
    for name, value in task.start.items():
        variable = task.variables[name]
        setters.get(variable.type, slave.set_integer)([variable.reference], [value])
    slave.setup_experiment()
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    references, inputs = ([v.reference for v in some] for some in (task.outputs, task.inputs))
    rows = [[0.0, *slave.get_real(references)]]
    for begin, length, speeds in task.steps():
        slave.set_real(inputs, speeds)
        slave.do_step(begin, length)
        rows.append([begin + length, *slave.get_real(references)])
    slave.terminate()
    slave.free_instance()
    task.write(rows)


def simulate_3(task: Task, arrays: bool) -> None:
    slave = fmi3.Fmi3Slave(task.fmu, model_identifier="ugv")
    slave.instantiate_co_simulation("ugv", instantiation_token=identity(task, "instantiationToken"))
    setters = {"Float64": slave.set_float64, "Boolean": slave.set_boolean}
    for name, value in task.start.items():
        variable = task.variables[name]
        setters.get(variable.type, slave.set_int64)([variable.reference], [value])
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    outputs = [variable for variable in task.outputs if arrays or variable.size == 1]
    references, inputs = ([v.reference for v in some] for some in (outputs, task.inputs))
    rows = [[0.0, *slave.get_float64(references)]]
    for begin, length, speeds in task.steps():
        slave.set_float64(inputs, speeds)
        slave.do_step(begin, length)
        rows.append([begin + length, *slave.get_float64(references)])
    slave.terminate()
    slave.free_instance()
    task.write(rows, [name for variable in outputs for name in variable.scalars()])


main(cs=simulate_2, cs3=lambda task: simulate_3(task, arrays=False), cs3_arrays=lambda task: simulate_3(task, arrays=True))
