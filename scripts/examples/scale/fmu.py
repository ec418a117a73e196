"""Drives of the FMU through fmpy: one instance in each thread, reset between two drives.

The FMU is stepped from row to row of the input with the wheel speeds and their rates, as `ugv sweep` steps the library, and what is
kept of a drive is added up in the same order: the numbers are the same to the last bit.
"""

import hashlib
import io
import threading
from ctypes import POINTER, Array, c_double, c_int, c_uint, c_void_p, cast, sizeof
from dataclasses import dataclass, field
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

STATE = ["x", "y", "heading", "v_x", "v_y", "yaw_rate"]
RESULTS = ["time", *STATE, "distance", "largest_slip", "mean_slip", "largest_sinkage", "resistance_work"]
INPUTS = ["omega_left", "omega_right"]
FAILED = 2  # of FMI's status, the first that is worse than a warning
MISSING = float("nan")


class WrongParameters(ValueError):
    """Parameters that describe no vehicle, soil or effect."""


@dataclass(frozen=True)
class Sweep:
    """A job: drives with the same wheel speeds and other parameters."""

    fmu: bytes
    time: np.ndarray  # s, of each row
    speeds: np.ndarray  # rad/s, left and right in each row
    names: list[str]  # parameters that differ from drive to drive
    fixed: dict[str, float | int | bool]  # those that do not, where they are not the FMU's own
    name: str = field(init=False)

    def __post_init__(self) -> None:
        told = repr((self.names, self.fixed)).encode()
        content = self.fmu + self.time.tobytes() + self.speeds.tobytes() + told
        object.__setattr__(self, "name", f"sweep-{hashlib.sha256(content).hexdigest()[:16]}")

    def setup(self, folder: Path) -> None:
        fmpy.extract(io.BytesIO(self.fmu), str(folder))
        object.__setattr__(self, "folder", folder)
        object.__setattr__(self, "threads", threading.local())

    def do(self, piece: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, list[str | None]]:
        """Results of drives in a block, given their numbers and parameters; and why they did not reach the end."""
        results, errors = [], []
        for index, values in zip(*piece, strict=True):
            try:
                result, error = self.vehicle.drive(values)
            except WrongParameters as wrong:
                raise WrongParameters(f"sample {index}: {wrong}") from None
            results.append(result)
            errors.append(error)
        return np.array(results), errors

    @property
    def vehicle(self) -> "Vehicle":
        """This thread's instance of the FMU."""
        if not hasattr(self.threads, "vehicle"):
            self.threads.vehicle = Vehicle(self.folder, self)
        return self.threads.vehicle


class Vehicle:
    """An instance of the FMU. Its functions are called with arrays that are made once: a drive has thousands of steps."""

    def __init__(self, folder: Path, sweep: Sweep) -> None:
        model = fmpy.read_model_description(str(folder))
        self.sweep, self.message = sweep, ""
        self.variables = {variable.name: variable for variable in model.modelVariables}
        self.slave = FMU2Slave(guid=model.guid, unzipDirectory=str(folder), modelIdentifier=model.coSimulation.modelIdentifier)
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(self._hear)
        self.slave.instantiate(callbacks=callbacks)
        self.component = c_void_p(self.slave.component)
        slips, sinkages = ([n for n in self.variables if n.endswith(f"].{what}")] for what in ("longitudinal_slip", "sinkage"))
        self.outputs = [*STATE, "rolling_resistance", *slips, *sinkages]
        self.slips, self.sinkages = (slice(7, 7 + len(slips)), slice(7 + len(slips), len(self.outputs)))
        self.rows = np.zeros((len(sweep.time), len(self.outputs)))
        self.rates = np.diff(sweep.speeds, axis=0) / np.diff(sweep.time)[:, None]

    def _hear(self, environment: int, name: bytes, status: int, category: bytes, text: bytes) -> None:
        if status >= FAILED:
            self.message = text.decode().partition(": ")[2]

    def references(self, names: list[str]) -> Array:
        return (c_uint * len(names))(*(self.variables[name].valueReference for name in names))

    def begin(self, values: np.ndarray) -> str | None:
        """Resets, sets parameters and the first wheel speeds, and initialises; why it cannot drive at all."""
        slave, fixed = self.slave, self.sweep.fixed
        slave.reset()
        reals = dict(zip(self.sweep.names, values, strict=True)) | dict(zip(INPUTS, self.sweep.speeds[0], strict=True))
        reals |= {name: value for name, value in fixed.items() if type(value) is float}
        try:
            for name, value in fixed.items():
                reference = [self.variables[name].valueReference]
                if type(value) is bool:
                    slave.setBoolean(reference, [value])
                elif type(value) is int:
                    slave.setInteger(reference, [value])
            slave.setReal([self.variables[name].valueReference for name in reals], list(reals.values()))
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
            # Builds the model: whatever is wrong with the parameters comes out here.
            self.rows[0, :len(STATE)] = slave.getReal([self.variables[name].valueReference for name in STATE])
        except FMICallException:
            raise WrongParameters(self.message) from None
        try:
            slave.exitInitializationMode()
        except FMICallException:
            return self.message
        return None

    def along(self) -> tuple[int, str | None]:
        """Drives on from the beginning: how many rows it reached, their outputs being in `rows`, and why no more."""
        dll, this, step, point = self.slave.dll, self.component, c_double, c_double
        get, wanted, count = dll.fmi2GetReal, self.references(self.outputs), len(self.outputs)
        inputs, orders = self.references(INPUTS), (c_int * 2)(1, 1)
        pointer, width = POINTER(c_double), sizeof(c_double)
        where = [array.ctypes.data for array in (self.rows, self.sweep.speeds, self.rates)]

        def row(array: int, number: int, columns: int) -> object:
            return cast(where[array] + number * columns * width, pointer)

        if get(this, wanted, count, row(0, 0, count)) >= FAILED:
            return 0, self.message
        time = self.sweep.time
        for number in range(1, len(time)):
            before = number - 1
            failed = (dll.fmi2SetReal(this, inputs, 2, row(1, before, 2)) >= FAILED
                      or dll.fmi2SetRealInputDerivatives(this, inputs, 2, orders, row(2, before, 2)) >= FAILED
                      or dll.fmi2DoStep(this, point(time[before] - time[0]), step(time[number] - time[before]), 1) >= FAILED
                      or get(this, wanted, count, row(0, number, count)) >= FAILED)
            if failed:
                return number, self.message
        return len(time), None

    def drive(self, values: np.ndarray) -> tuple[list[float], str | None]:
        """What is kept of a drive (RESULTS), and why it did not reach the end."""
        error = self.begin(values)
        reached, error = (0, error) if error else self.along()
        return self.kept(reached), error

    def kept(self, reached: int) -> list[float]:
        """RESULTS of the rows that were reached; sums in the order of `ugv sweep`, and no hypot, whose last bit differs."""
        rows, last = self.rows[:reached], max(reached - 1, 0)
        time = self.sweep.time[:last + 1]
        power = rows[:, 6] * np.abs(rows[:, 3])
        (east, north), slips = np.diff(rows[:, :2], axis=0).T, np.abs(rows[1:, self.slips]).ravel()
        slip = [slips.max(), total(slips) / len(slips)] if len(slips) else [MISSING, MISSING]
        work = total(0.5 * (power[:-1] + power[1:]) * np.diff(time)) if reached else 0.0
        sinkage = np.max(rows[:, self.sinkages], initial=0.0)
        values = [time[-1] - time[0], *self.rows[last, :len(STATE)], total(np.sqrt(east * east + north * north)), *slip, sinkage, work]
        return [float(value) + 0.0 for value in values]

    def path(self, values: np.ndarray) -> np.ndarray:
        """East and north in every row that is reached."""
        reached = 0 if self.begin(values) else self.along()[0]
        return self.rows[:reached, :2].copy()


def total(values: np.ndarray) -> float:
    """Sum from the first to the last, each rounded: np.sum adds in another order."""
    return np.cumsum(values)[-1] if len(values) else 0.0
