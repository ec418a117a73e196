"""SSP through fmpy: a system of one FMU, its inputs and outputs connected to the system's."""

import zipfile
from pathlib import Path

from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import Parameter, ParameterSet
from task import STEP, Task, main

TYPE = '<ssc:Real xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"/>'


def system(task: Task, folder: Path) -> Path:
    """The archive: the FMU and how it is connected."""
    own = [*task.inputs, *task.outputs]
    connectors = "".join(f'<ssd:Connector name="{v.name}" kind="{v.causality}">{TYPE}</ssd:Connector>' for v in own)
    into = "".join(f'<ssd:Connection startConnector="{v.name}" endElement="ugv" endConnector="{v.name}"/>' for v in task.inputs)
    out = "".join(f'<ssd:Connection startElement="ugv" startConnector="{v.name}" endConnector="{v.name}"/>' for v in task.outputs)
    structure = f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" version="1.0" name="drive">
<ssd:System name="drive"><ssd:Connectors>{connectors}</ssd:Connectors>
<ssd:Elements><ssd:Component name="ugv" type="application/x-fmu-sharedlibrary" source="resources/ugv.fmu">
<ssd:Connectors>{connectors}</ssd:Connectors></ssd:Component></ssd:Elements>
<ssd:Connections>{into}{out}</ssd:Connections></ssd:System></ssd:SystemStructureDescription>"""
    path = folder / "drive.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", structure)
        archive.write(task.fmu, "resources/ugv.fmu")
    return path


def simulate(task: Task, lead: float, late: float) -> None:
    """fmpy hands inputs over a step late, which `lead` makes up for; a row carries the time at which its step begins: `late`."""
    parameters = ParameterSet(name="start")
    for name, value in task.start.items():
        parameters.parameters.append(Parameter(name=f"ugv.{name}", type="Real", value=value))
    signals = {v.name: (lambda time, side=side: task.speeds(time + lead)[side]) for side, v in enumerate(task.inputs)}
    path = system(task, task.output.parent)
    result = simulate_ssp(str(path), stop_time=task.drive[-1][0], step_size=STEP, parameter_set=parameters, input=signals)
    names = [f"ugv.{variable.name}" for variable in task.outputs]
    task.write([row["time"] + late, *(row[name] for name in names)] for row in result)


main(
    cs=lambda task: simulate(task, lead=STEP, late=STEP),
    inputs=lambda task: simulate(task, lead=0.0, late=STEP),
    times=lambda task: simulate(task, lead=STEP, late=0.0),
)
