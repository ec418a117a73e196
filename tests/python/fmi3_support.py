"""The FMI 3.0 FMU under test, through ctypes without anything between the test and its functions.

`UGV_FMI3` names the FMU; without it the one serves that scripts/package.sh leaves beside that of FMI 2.0
(`UGV_FMU`), or else target/ugv-fmi3.fmu.
"""

import ctypes
import functools
import os
import re
import tempfile
from collections.abc import Iterable, Sequence
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import NamedTuple, Self

import fmpy
from fmpy import extract, read_model_description
from fmpy.fmi3 import fmi3LogMessageCallback
from fmpy.model_description import ModelDescription, ScalarVariable
from fmu_support import ANY_GUID, STATES, TARGET, Calls, as_reals, as_references, scratch

# The functions that the standard's header declares, without their prefix.
STANDARD = set(
    re.findall(
        r"FMI3_Export fmi3\w+TYPE\s+fmi3(\w+);",
        (Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h").read_text("latin-1"),
    )
)


def fmi3_path() -> Path:
    """The FMU under test."""
    two = Path(os.environ.get("UGV_FMU") or TARGET / "ugv.fmu")
    beside = two.with_name(f"{two.stem}-fmi3.fmu")
    default = beside if beside.is_file() else TARGET / "ugv-fmi3.fmu"
    path = Path(os.environ.get("UGV_FMI3") or default).absolute()
    if not path.is_file():
        raise FileNotFoundError(
            f"{path} is missing; build it with scripts/package.sh, or name another in UGV_FMI3"
        )
    return path


class Fmu3:
    """An unpacked FMU: its description and its library."""

    def __init__(self, path: Path) -> None:
        self.folder = Path(extract(path, unzipdir=tempfile.mkdtemp(dir=scratch())))
        self.description: ModelDescription = read_model_description(self.folder)
        self.variables: dict[str, ScalarVariable] = {
            variable.name: variable for variable in self.description.modelVariables
        }
        self.outputs = [v.name for v in self.description.modelVariables if v.causality == "output"]
        self.library = ctypes.CDLL(str(self.folder / "binaries" / "x86_64-linux" / "ugv.so"))
        for kind in ("ModelExchange", "CoSimulation", "ScheduledExecution"):
            getattr(self.library, "fmi3Instantiate" + kind).restype = c_void_p
        self.library.fmi3GetVersion.restype = c_char_p
        self.library.fmi3FreeInstance.restype = None

    @property
    def resources(self) -> str:
        """The path of its resources, as fmpy writes it."""
        return str(self.folder / "resources") + os.path.sep

    def references(self, names: Iterable[str]) -> list[int]:
        """Value references of variables."""
        return [self.variables[name].valueReference for name in names]

    def size(self, name: str) -> int:
        """Number of elements of a variable."""
        shape = self.variables[name].shape
        return shape[0] if shape else 1

    def scalars(self, name: str) -> list[str]:
        """What the elements of a variable are called in the FMI 2.0 FMU."""
        if not self.variables[name].shape:
            return [name]
        numbers = range(1, self.size(name) + 1)
        if name.startswith("wheel."):
            return [name.replace("wheel.", f"wheel[{number}].") for number in numbers]
        return [f"{name}[{number}]" for number in numbers]


@functools.cache
def fmi3() -> Fmu3:
    """The FMU under test, unpacked once."""
    return Fmu3(fmi3_path())


class Message(NamedTuple):
    """What the FMU told the logger."""

    environment: int | None
    status: int
    category: str
    text: str


class Instance3(Calls):
    """One instance of the FMI 3.0 FMU."""

    prefix, state, deserializer = "fmi3", "FMUState", "DeserializeFMUState"

    def __init__(
        self,
        kind: str = "CoSimulation",
        *,
        events: bool = False,
        token: str | None = None,
        resources: str | None = None,
        logging: bool = True,
        name: str | None = "test",
        environment: int | None = None,
        intermediate: Sequence[int] = (),
    ) -> None:
        self.fmu = fmi3()
        self.library = self.fmu.library
        self.messages: list[Message] = []
        # Kept alive as long as the instance: C holds its address.
        self.callback = fmi3LogMessageCallback(self._log)
        token = self.fmu.description.guid if token is None else token
        resources = self.fmu.resources if resources is None else resources
        first = (
            name.encode() if name is not None else None,
            token.encode(),
            resources.encode(),
            c_bool(False),
            c_bool(logging),
        )
        last: tuple[object, ...] = (c_void_p(environment), self.callback)
        if kind == "CoSimulation":
            variables = as_references(intermediate)
            count = c_size_t(len(intermediate))
            first = (*first, c_bool(events), c_bool(False), variables, count)
            last = (*last, None)
        if kind == "ScheduledExecution":
            last = (*last, None, None, None)
        create = getattr(self.fmu.library, "fmi3Instantiate" + kind)
        self.handle: int | None = create(*first, *last)
        self.time = 0.0

    def _log(self, environment: int, status: int, category: bytes, text: bytes) -> None:
        self.messages.append(Message(environment, status, category.decode(), text.decode()))

    def initialize(self, time: float = 0.0, stop: float | None = None) -> None:
        """Begins the initialization."""
        self.time = time
        limits = (c_bool(stop is not None), c_double(stop or 0.0))
        self.do("EnterInitializationMode", c_bool(False), c_double(0.0), c_double(time), *limits)

    def start(
        self,
        values: dict[str, float | Sequence[float]] | None = None,
        time: float = 0.0,
        stop: float | None = None,
    ) -> Self:
        """Sets start values and initializes."""
        self.set(values or {})
        self.initialize(time, stop)
        self.do("ExitInitializationMode")
        return self

    def set(self, values: dict[str, float | Sequence[float]]) -> None:
        """Sets variables of any type by name."""
        kinds = {"Float64": ("Float64", c_double), "Boolean": ("Boolean", c_bool)}
        for name, value in values.items():
            function, ctype = kinds.get(self.fmu.variables[name].type, ("Int64", c_int64))
            numbers = list(value) if isinstance(value, Sequence) else [value]
            array = (ctype * len(numbers))(*numbers)
            reference = byref(c_uint(self.fmu.variables[name].valueReference))
            self.do("Set" + function, reference, c_size_t(1), array, c_size_t(len(numbers)))

    def get(self, names: Sequence[str]) -> list[float]:
        """Values of variables of type Float64, arrays in a row."""
        references, count = self.fmu.references(names), sum(map(self.fmu.size, names))
        values = (c_double * count)()
        places = (as_references(references), c_size_t(len(references)))
        self.do("GetFloat64", *places, values, c_size_t(count))
        return list(values)

    def outputs(self) -> list[float]:
        """Values of all outputs."""
        return self.get(self.fmu.outputs)

    def step(self, size: float) -> None:
        """One communication step from where the last one ended."""
        flags, reached = [c_bool(True) for _ in range(3)], c_double()
        results = (*map(byref, flags), byref(reached))
        self.do("DoStep", c_double(self.time), c_double(size), c_bool(True), *results)
        if any(flag.value for flag in flags):
            raise AssertionError("a step does not end early, nor need an event, nor end it all")
        self.time = reached.value

    def partial(
        self, function: str, unknowns: Sequence[str], knowns: Sequence[str], seeds: Sequence[float]
    ) -> list[float]:
        """Directional or adjoint derivatives."""
        results = knowns if function == "GetAdjointDerivative" else unknowns
        count = sum(map(self.fmu.size, results))
        values = (c_double * count)()
        self.do(
            function,
            *(as_references(self.fmu.references(unknowns)), c_size_t(len(unknowns))),
            *(as_references(self.fmu.references(knowns)), c_size_t(len(knowns))),
            *(as_reals(seeds), c_size_t(len(seeds)), values, c_size_t(count)),
        )
        return list(values)

    def directional(
        self, unknowns: Sequence[str], knowns: Sequence[str], seeds: Sequence[float]
    ) -> list[float]:
        """Directional derivatives of `unknowns`."""
        return self.partial("GetDirectionalDerivative", unknowns, knowns, seeds)

    def adjoint(
        self, unknowns: Sequence[str], knowns: Sequence[str], seeds: Sequence[float]
    ) -> list[float]:
        """Adjoint derivatives by `knowns`."""
        return self.partial("GetAdjointDerivative", unknowns, knowns, seeds)

    def output_derivatives(self, names: Sequence[str], order: int = 1) -> list[float]:
        """Derivatives of outputs in time."""
        count = sum(map(self.fmu.size, names))
        values = (c_double * count)()
        places = (as_references(self.fmu.references(names)), c_size_t(len(names)))
        orders = (c_int * len(names))(*[order] * len(names))
        self.do("GetOutputDerivatives", *places, orders, values, c_size_t(count))
        return list(values)

    def take_over(self, data: bytes) -> Self:
        """Goes on from the state behind bytes."""
        state = self.deserialize(data)
        self.restore(state)
        self.free_state(state)
        return self

    def update(self) -> tuple[list[bool], float]:
        """Handles an event: the five flags, and when the next one is."""
        flags, time = [c_bool(True) for _ in range(5)], c_double()
        self.do("UpdateDiscreteStates", *map(byref, flags), byref(time))
        return [flag.value for flag in flags], time.value

    def continuous(self) -> Self:
        """From event mode into continuous-time mode."""
        self.update()
        self.do("EnterContinuousTimeMode")
        return self

    def set_states(self, states: Sequence[float]) -> None:
        """Sets the continuous states."""
        self.do("SetContinuousStates", as_reals(states), c_size_t(len(states)))

    def derivatives(self) -> list[float]:
        """Rates of the continuous states."""
        rates = (c_double * len(STATES))()
        self.do("GetContinuousStateDerivatives", rates, c_size_t(len(STATES)))
        return list(rates)


def model_exchange_3(values: dict[str, float] | None = None, **arguments: str) -> Instance3:
    """An instance for model exchange, in continuous-time mode."""
    return Instance3("ModelExchange", **arguments).start(values).continuous()


def refusal_3(kind: str = "CoSimulation", **arguments: object) -> str:
    """Why no instance is created."""
    with Instance3(kind, **arguments) as instance:
        if instance.handle is not None:
            raise AssertionError(f"an instance was created with {arguments}")
        return instance.messages[-1].text


def token_of(folder: Path) -> str:
    """The token that the library expects with these resources, from its complaint."""
    complaint = refusal_3(token=ANY_GUID, resources=f"{folder}{os.path.sep}")
    return re.search(rf"token {ANY_GUID} is not ([0-9a-f-]{{36}}),", complaint)[1]
