"""The system run by fmpy: as an SSP, and by a master of our own to compare with. Each gives a column for each output."""

import shutil
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import Component as SspComponent
from fmpy.ssp.ssd import ParameterSet, find_components, read_ssd

from .system import CONNECTIONS, STEP, STOP, split

Columns = dict[str, np.ndarray]


def parameters(ssp: Path) -> ParameterSet:
    """What the SSP sets, under the names that simulate_ssp wants: fmpy 0.3.32 reads bindings, but does not apply them."""
    everything = []
    for component in find_components(read_ssd(str(ssp)).system):
        for values in (values for binding in component.parameterBindings for values in binding.parameterValues):
            for parameter in values.parameters:
                parameter.name = f"{component.name}.{parameter.name}"
                everything.append(parameter)
    return ParameterSet(name="all", parameters=everything)


def run_ssp(ssp: Path, stop: float = STOP) -> Columns:
    """By fmpy's simulate_ssp."""
    # Half a step less: sums of steps must not add one. Its rows have the time at which their step began.
    rows = simulate_ssp(str(ssp), stop_time=stop - STEP / 2, step_size=STEP, parameter_set=parameters(ssp))
    outputs = {name: rows[name] for name in rows.dtype.names if name != "time"}
    return {"time": rows["time"] + STEP, **outputs}


def instantiate(component: SspComponent, folder: Path, values: ParameterSet) -> tuple[FMU2Slave, dict[str, int]]:
    """An FMU of the SSP, initialized, and its variables' references."""
    place = fmpy.extract(str(folder / component.source), unzipdir=str(folder / component.name))
    model = fmpy.read_model_description(place)
    reference = {v.name: v.valueReference for v in model.modelVariables}
    slave = FMU2Slave(guid=model.guid, unzipDirectory=place, modelIdentifier=model.coSimulation.modelIdentifier,
                      instanceName=component.name)
    slave.instantiate()
    for parameter in values.parameters:
        owner, name = split(parameter.name)
        if owner == component.name and parameter.type == "Integer":
            slave.setInteger([reference[name]], [int(parameter.value)])
        elif owner == component.name:
            slave.setReal([reference[name]], [float(parameter.value)])
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave, reference


def cosimulate(ssp: Path, stop: float = STOP) -> Columns:
    """By a master of our own: all step at once with what the others said at the end of the last step (Jacobi)."""
    folder = Path(fmpy.extract(str(ssp)))
    parts, values = find_components(read_ssd(str(ssp)).system), parameters(ssp)
    fmus = {part.name: instantiate(part, folder, values) for part in parts}

    def real(connector: str) -> float:
        slave, reference = fmus[split(connector)[0]]
        return slave.getReal([reference[split(connector)[1]]])[0]

    outputs = [f"{part.name}.{c.name}" for part in parts for c in part.connectors if c.kind == "output"]
    rows = []
    for step in range(round(stop / STEP)):
        for (owner, name), value in [(split(end), real(start)) for start, end in CONNECTIONS]:
            slave, reference = fmus[owner]
            slave.setReal([reference[name]], [value])
        for slave, _ in fmus.values():
            slave.doStep(step * STEP, STEP)
        rows.append([(step + 1) * STEP, *(real(name) for name in outputs)])
    for slave, _ in fmus.values():
        slave.terminate()
        slave.freeInstance()
    shutil.rmtree(folder)
    return dict(zip(["time", *outputs], np.array(rows).T, strict=True))


def largest_difference(one: Columns, other: Columns) -> float:
    """Largest difference of any output that both have, as a share of its largest value (or of 1)."""
    common = [name for name in one if name in other and name != "time"]
    return max(float(np.max(np.abs(one[name] - other[name])) / max(1.0, np.max(np.abs(one[name])))) for name in common)
