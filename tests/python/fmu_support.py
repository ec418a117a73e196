"""The FMU under test, loaded through ctypes without anything between the test and its functions.

`UGV_FMU` names the FMU; without it target/ugv.fmu serves, as scripts/package.sh leaves it.
"""

import atexit
import ctypes
import functools
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Sequence
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import NamedTuple, Protocol, Self

import fmpy
from fmpy import extract, read_model_description
from fmpy.fmi2 import (
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2CoSimulation,
    fmi2EventInfo,
    fmi2ModelExchange,
    fmi2OK,
)
from fmpy.model_description import ModelDescription, ScalarVariable

REPOSITORY = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target"))
STATES = ("x", "y", "heading", "v_x", "v_y", "yaw_rate")
RATES = tuple(f"der({name})" for name in STATES)
INPUTS = ("omega_left", "omega_right")
# Stands for the URI of the FMU's own resources.
OWN_RESOURCES = "own"
ANY_GUID = "00000000-0000-0000-0000-000000000000"
TERRAINS = {"dry_sand": 1, "sandy_loam": 2, "clayed_soil": 3, "dry_clay": 4, "custom": 5}

# The functions that the standard's header declares, without their prefix.
STANDARD = set(
    re.findall(
        r"FMI2_Export fmi2\w+TYPE\s+fmi2(\w+);",
        (Path(fmpy.__file__).parent / "c-code" / "fmi2Functions.h").read_text("latin-1"),
    )
)


def fmu_path() -> Path:
    """The FMU under test."""
    path = Path(os.environ.get("UGV_FMU") or TARGET / "ugv.fmu").absolute()
    if not path.is_file():
        raise FileNotFoundError(
            f"{path} is missing; build it with scripts/package.sh, or name another in UGV_FMU"
        )
    return path


@functools.cache
def scratch() -> Path:
    """A folder that lives as long as this process."""
    folder = tempfile.mkdtemp(prefix="ugv-fmu-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


class Fmu:
    """An unpacked FMU: its description and its library."""

    def __init__(self, path: Path) -> None:
        self.folder = Path(extract(path, unzipdir=tempfile.mkdtemp(dir=scratch())))
        self.description: ModelDescription = read_model_description(self.folder)
        self.variables: dict[str, ScalarVariable] = {
            variable.name: variable for variable in self.description.modelVariables
        }
        self.outputs = [v.name for v in self.description.modelVariables if v.causality == "output"]
        self.library = ctypes.CDLL(str(self.folder / "binaries" / "linux64" / "ugv.so"))
        self.library.fmi2Instantiate.restype = c_void_p
        for name in ("fmi2GetVersion", "fmi2GetTypesPlatform"):
            getattr(self.library, name).restype = c_char_p
        self.library.fmi2FreeInstance.restype = None

    @property
    def resources(self) -> str:
        """The URI of its resources, as fmpy writes it."""
        return (self.folder / "resources").as_uri()

    def references(self, names: Iterable[str]) -> list[int]:
        """Value references of variables."""
        return [self.variables[name].valueReference for name in names]


@functools.cache
def fmu() -> Fmu:
    """The FMU under test, unpacked once."""
    return Fmu(fmu_path())


class Message(NamedTuple):
    """What the FMU told the logger."""

    environment: int | None
    instance: str
    status: int
    category: str
    text: str


class Told(Protocol):
    """A message of either version of the standard."""

    text: str


class Failed(Exception):
    """A call that did not return OK."""

    def __init__(self, function: str, status: int, messages: Sequence[Told]) -> None:
        super().__init__(f"{function}: status {status}, {[m.text for m in messages]}")
        self.status = status
        self.text = messages[-1].text if messages else ""


class Calls:
    """The calls of an instance; each but `call` itself raises `Failed` unless it returns OK.

    `handle` is None where the FMU refused to create it; `messages` says why.
    """

    # As the version of the standard spells them.
    prefix: str
    state: str
    deserializer: str
    library: ctypes.CDLL
    handle: int | None
    messages: Sequence[Told]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.free()

    def free(self) -> None:
        """Frees the instance once."""
        handle, self.handle = self.handle, None
        getattr(self.library, self.prefix + "FreeInstance")(c_void_p(handle))

    def call(self, function: str, *arguments: object) -> int:
        """Calls a function, named without its prefix, with whatever arguments; returns its status."""
        return getattr(self.library, self.prefix + function)(c_void_p(self.handle), *arguments)

    def do(self, function: str, *arguments: object) -> None:
        """As `call`, but anything except OK raises `Failed`."""
        status = self.call(function, *arguments)
        if status != fmi2OK:
            raise Failed(self.prefix + function, status, self.messages)

    def save(self) -> c_void_p:
        """A saved state, to be freed with `free_state`."""
        state = c_void_p()
        self.do(f"Get{self.state}", byref(state))
        return state

    def restore(self, state: c_void_p) -> None:
        """Returns to a saved state."""
        self.do(f"Set{self.state}", state)

    def free_state(self, state: c_void_p) -> None:
        """Frees a saved state."""
        self.do(f"Free{self.state}", byref(state))

    def serialize(self) -> bytes:
        """The present state as bytes."""
        state, size = self.save(), c_size_t()
        self.do(f"Serialized{self.state}Size", state, byref(size))
        buffer = ctypes.create_string_buffer(size.value)
        self.do(f"Serialize{self.state}", state, buffer, size)
        self.free_state(state)
        return buffer.raw

    def deserialize(self, data: bytes) -> c_void_p:
        """The state behind bytes, to be freed with `free_state`."""
        state = c_void_p()
        self.do(self.deserializer, data, c_size_t(len(data)), byref(state))
        return state


class Instance(Calls):
    """One instance of the FMI 2.0 FMU."""

    prefix, state, deserializer = "fmi2", "FMUstate", "DeSerializeFMUstate"

    def __init__(
        self,
        kind: int = fmi2CoSimulation,
        *,
        of: Fmu | None = None,
        guid: str | None = None,
        resources: str | None = OWN_RESOURCES,
        logging: bool = False,
        name: str | None = "test",
        environment: int | None = None,
    ) -> None:
        self.fmu = of or fmu()
        self.library = self.fmu.library
        self.messages: list[Message] = []
        # Kept alive as long as the instance: C holds its address.
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.callbacks.componentEnvironment = environment
        resources = self.fmu.resources if resources == OWN_RESOURCES else resources
        self.handle: int | None = self.fmu.library.fmi2Instantiate(
            name.encode() if name is not None else None,
            kind,
            (self.fmu.description.guid if guid is None else guid).encode(),
            resources.encode() if resources is not None else None,
            byref(self.callbacks),
            0,
            int(logging),
        )
        self.time = 0.0

    def _log(
        self, environment: int, name: bytes, status: int, category: bytes, text: bytes
    ) -> None:
        message = Message(environment, name.decode(), status, category.decode(), text.decode())
        self.messages.append(message)

    def start(
        self,
        values: dict[str, float] | None = None,
        time: float = 0.0,
        stop: float | None = None,
    ) -> Self:
        """Sets start values and initializes."""
        self.set(values or {})
        self.setup(time, stop)
        self.do("EnterInitializationMode")
        self.do("ExitInitializationMode")
        return self

    def setup(self, time: float = 0.0, stop: float | None = None) -> None:
        """Tells start and stop time."""
        self.time = time
        limits = (int(stop is not None), c_double(stop or 0.0))
        self.do("SetupExperiment", 0, c_double(0.0), c_double(time), *limits)

    def set(self, values: dict[str, float]) -> None:
        """Sets variables of any type by name."""
        for name, value in values.items():
            variable = self.fmu.variables[name]
            kind = {"Real": ("Real", c_double), "Boolean": ("Boolean", c_int)}
            function, ctype = kind.get(variable.type, ("Integer", c_int))
            reference, number = c_uint(variable.valueReference), ctype(value)
            self.do("Set" + function, byref(reference), c_size_t(1), byref(number))

    def get(self, names: Sequence[str]) -> list[float]:
        """Values of variables of type Real."""
        references = self.fmu.references(names)
        values = (c_double * len(references))()
        self.do("GetReal", as_references(references), c_size_t(len(references)), values)
        return list(values)

    def outputs(self) -> list[float]:
        """Values of all outputs."""
        return self.get(self.fmu.outputs)

    def step(self, size: float) -> None:
        """One communication step from where the last one ended."""
        self.do("DoStep", c_double(self.time), c_double(size), 1)
        self.time += size

    def directional(
        self, unknowns: Sequence[str], knowns: Sequence[str], seeds: Sequence[float]
    ) -> list[float]:
        """Directional derivatives of `unknowns`."""
        values = (c_double * len(unknowns))()
        self.do(
            "GetDirectionalDerivative",
            *(as_references(self.fmu.references(unknowns)), c_size_t(len(unknowns))),
            *(as_references(self.fmu.references(knowns)), c_size_t(len(knowns))),
            *(as_reals(seeds), values),
        )
        return list(values)

    def output_derivatives(self, names: Sequence[str], order: int = 1) -> list[float]:
        """Derivatives of outputs in time."""
        count, values = len(names), (c_double * len(names))()
        references = as_references(self.fmu.references(names))
        orders = (c_int * count)(*[order] * count)
        self.do("GetRealOutputDerivatives", references, c_size_t(count), orders, values)
        return list(values)

    def set_input_derivatives(self, rates: Sequence[float], order: int = 1) -> None:
        """Rates of both wheel speeds in the next step."""
        references, orders = as_references(self.fmu.references(INPUTS)), (c_int * 2)(order, order)
        self.do("SetRealInputDerivatives", references, c_size_t(2), orders, as_reals(rates))

    # Model exchange

    def continuous(self) -> Self:
        """From event mode into continuous-time mode."""
        self.do("NewDiscreteStates", byref(fmi2EventInfo()))
        self.do("EnterContinuousTimeMode")
        return self

    def set_states(self, states: Sequence[float]) -> None:
        """Sets the continuous states."""
        self.do("SetContinuousStates", as_reals(states), c_size_t(len(states)))

    def derivatives(self) -> list[float]:
        """Rates of the continuous states."""
        rates = (c_double * len(STATES))()
        self.do("GetDerivatives", rates, c_size_t(len(STATES)))
        return list(rates)


def model_exchange(values: dict[str, float] | None = None) -> Instance:
    """An instance for model exchange, in continuous-time mode."""
    return Instance(fmi2ModelExchange).start(values).continuous()


def as_references(references: Sequence[int]) -> ctypes.Array[c_uint]:
    """Value references as C takes them."""
    return (c_uint * len(references))(*references)


def as_reals(values: Sequence[float]) -> ctypes.Array[c_double]:
    """Numbers as C takes them."""
    return (c_double * len(values))(*values)


def resources(change: Callable[[Path], None] | None = None, name: str = "resources") -> Path:
    """A changed copy of the FMU's resources."""
    folder = Path(tempfile.mkdtemp(dir=scratch())) / name
    shutil.copytree(fmu().folder / "resources", folder)
    if change:
        change(folder)
    return folder


def refusal(**arguments: str | int | None) -> str:
    """Why no instance is created."""
    with Instance(**arguments) as instance:
        if instance.handle is not None:
            raise AssertionError(f"an instance was created with {arguments}")
        return instance.messages[-1].text


def lighter(folder: Path) -> None:
    """Takes 100 kg off the vehicle and one row from under it."""
    file = folder / "vehicle.json"
    vehicle = json.loads(file.read_text())
    vehicle["mass"] -= 100.0
    vehicle["row_positions"].pop(1)
    file.write_text(json.dumps(vehicle))


def guid_of(folder: Path) -> str:
    """The guid that the library expects with these resources, from its complaint."""
    complaint = refusal(guid=ANY_GUID, resources=folder.as_uri())
    return re.search(rf"guid {ANY_GUID} is not ([0-9a-f-]{{36}}),", complaint)[1]
