"""Drives an FMU through fmpy as told and prints every output to the last bit.

Standard input: JSON, `{"fmu": FILE, "drives": [{"read": [NAMES], "do": [OPERATIONS]}, ...]}`.
Operations: `["start", {NAME: VALUE}]`, `["load", FILE]` (go on from a stored state),
`["store", FILE]`, `["speeds", LEFT, RIGHT]`, `["rates", LEFT, RIGHT]` (for the next step),
`["step", SECONDS]`, `["save"]`, `["restore"]`.
After each start, load, step and restore: one line of the time and the variables to read, each
as the 16 hexadecimal digits of its bits.
"""

import json
import shutil
import struct
import sys
from pathlib import Path
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2LastSuccessfulTime
from fmpy.model_description import ModelDescription

READ_AFTER = {"start", "load", "step", "restore"}


class Drive:
    """One instance and what happens to it."""

    def __init__(self, description: ModelDescription, folder: str, read: list[str]) -> None:
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.inputs = self.references(["omega_left", "omega_right"])
        self.outputs = self.references(read)
        self.saved = None
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="drive",
        )
        self.fmu.instantiate()

    def references(self, names: list[str]) -> list[int]:
        """Value references of variables."""
        return [self.variables[name].valueReference for name in names]

    def time(self) -> float:
        """The time that the last step reached."""
        return self.fmu.getRealStatus(fmi2LastSuccessfulTime)

    def start(self, values: dict[str, float]) -> None:
        """Sets start values and initializes."""
        for name, value in values.items():
            kind = self.variables[name].type
            setter = {"Real": self.fmu.setReal, "Boolean": self.fmu.setBoolean}
            setter.get(kind, self.fmu.setInteger)(self.references([name]), [value])
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def load(self, file: str) -> None:
        """Goes on from a state that another process stored."""
        state = self.fmu.deSerializeFMUstate(Path(file).read_bytes())
        self.fmu.setFMUstate(state)
        self.fmu.freeFMUstate(state)

    def store(self, file: str) -> None:
        """Leaves the state for another process."""
        state = self.fmu.getFMUstate()
        Path(file).write_bytes(self.fmu.serializeFMUstate(state))
        self.fmu.freeFMUstate(state)

    def speeds(self, left: float, right: float) -> None:
        """Sets the wheel speeds."""
        self.fmu.setReal(self.inputs, [left, right])

    def rates(self, left: float, right: float) -> None:
        """Sets the rates of the wheel speeds in the next step."""
        self.fmu.setRealInputDerivatives(self.inputs, [1, 1], [left, right])

    def step(self, seconds: float) -> None:
        """One communication step."""
        self.fmu.doStep(self.time(), seconds)

    def save(self) -> None:
        """Saves the state in memory."""
        self.saved = self.fmu.getFMUstate()

    def restore(self) -> None:
        """Returns to the saved state."""
        self.fmu.setFMUstate(self.saved)
        self.fmu.freeFMUstate(self.saved)

    def read(self) -> str:
        """The time and the outputs as bits."""
        values = [self.time(), *self.fmu.getReal(self.outputs)]
        return " ".join(struct.pack(">d", value).hex() for value in values)


def main() -> None:
    """Carries out what standard input says."""
    task: dict[str, Any] = json.load(sys.stdin)
    answers = sys.stdout
    # fmpy prints what the FMU logs there.
    sys.stdout = sys.stderr
    description = read_model_description(task["fmu"])
    folder = extract(task["fmu"])
    try:
        for each in task["drives"]:
            drive = Drive(description, folder, each["read"])
            for operation, *arguments in each["do"]:
                getattr(drive, operation)(*arguments)
                if operation in READ_AFTER:
                    print(drive.read(), file=answers)
            drive.fmu.terminate()
            drive.fmu.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
