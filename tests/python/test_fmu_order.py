"""Which function may be called when: the standard's tables (FMI 2.0.5, 3.2.3 and 4.2.4), whole."""

import enum
import unittest
from ctypes import byref, c_double, c_int, c_size_t, c_void_p, create_string_buffer

from fmpy.fmi2 import fmi2CoSimulation, fmi2Error, fmi2EventInfo, fmi2ModelExchange, fmi2OK
from fmu_support import STANDARD, Instance, as_reals, as_references, fmu, model_exchange


class Mode(enum.Flag):
    """Where an instance stands."""

    INSTANTIATED = enum.auto()
    INITIALIZATION = enum.auto()
    STEP_COMPLETE = enum.auto()
    EVENT = enum.auto()
    CONTINUOUS = enum.auto()
    TERMINATED = enum.auto()
    ERROR = enum.auto()


EARLY = Mode.INSTANTIATED | Mode.INITIALIZATION
EXCHANGE = Mode.EVENT | Mode.CONTINUOUS
RUNNING = Mode.STEP_COMPLETE | EXCHANGE
OVER = Mode.TERMINATED | Mode.ERROR
READABLE = Mode.INITIALIZATION | RUNNING | OVER
ANY = EARLY | RUNNING | OVER
NEVER = Mode(0)

ZERO, ONE, SIX = c_size_t(0), c_size_t(1), c_size_t(6)
REAL, REALS, EVENT = as_reals([0.0]), as_reals([0.0] * 6), fmi2EventInfo()
ORDER, NUMBER, FLAG = (c_int * 1)(1), (c_int * 1)(1), (c_int * 1)(0)
INPUT, OUTPUT, TERRAIN, NO_SLIP = (
    as_references(fmu().references([name]))
    for name in ("omega_left", "a_x", "terrain", "initial.no_slip")
)


class Kept:
    """A state and its bytes, from an instance that has yet to be initialized: it fits any other."""

    instance: Instance
    state: c_void_p
    data: bytes
    buffer = create_string_buffer(20_000)
    place = c_void_p()


def setUpModule() -> None:
    """Saves the state that the calls are about."""
    Kept.instance = Instance()
    Kept.state = Kept.instance.save()
    Kept.data = Kept.instance.serialize()


def tearDownModule() -> None:
    """Frees what the calls have left."""
    Kept.instance.free_state(Kept.state)
    Kept.instance.free_state(Kept.place)
    Kept.instance.free()


def table() -> dict[str, tuple[tuple[object, ...], Mode]]:
    """Each function that needs an instance: right arguments, and the modes in which it succeeds."""
    start = (0, c_double(0.0), c_double(0.0), 0, c_double(0.0))
    room = c_size_t(len(Kept.buffer))
    bytes_ = (Kept.data, c_size_t(len(Kept.data)), byref(Kept.place))
    return {
        "SetDebugLogging": ((0, ZERO, None), ANY),
        "SetupExperiment": (start, Mode.INSTANTIATED),
        "EnterInitializationMode": ((), Mode.INSTANTIATED),
        "ExitInitializationMode": ((), Mode.INITIALIZATION),
        "Terminate": ((), RUNNING),
        "Reset": ((), ANY),
        "GetReal": ((INPUT, ONE, REAL), READABLE),
        "GetInteger": ((TERRAIN, ONE, NUMBER), READABLE),
        "GetBoolean": ((NO_SLIP, ONE, FLAG), READABLE),
        "GetString": ((None, ZERO, None), READABLE),
        "SetReal": ((INPUT, ONE, REAL), EARLY | RUNNING),
        # Whatever is no Real is a parameter.
        "SetInteger": ((TERRAIN, ONE, NUMBER), EARLY),
        "SetBoolean": ((NO_SLIP, ONE, FLAG), EARLY),
        "SetString": ((None, ZERO, None), EARLY | RUNNING),
        "GetFMUstate": ((byref(Kept.place),), ANY),
        "SetFMUstate": ((Kept.state,), ANY),
        "FreeFMUstate": ((byref(c_void_p()),), ANY),
        "SerializedFMUstateSize": ((Kept.state, byref(c_size_t())), ANY),
        "SerializeFMUstate": ((Kept.state, Kept.buffer, room), ANY),
        "DeSerializeFMUstate": (bytes_, ANY),
        # States are known once the initialization is over.
        "GetDirectionalDerivative": ((OUTPUT, ONE, INPUT, ONE, REAL, REALS), READABLE),
        "SetRealInputDerivatives": ((INPUT, ONE, ORDER, REAL), EARLY | Mode.STEP_COMPLETE),
        "GetRealOutputDerivatives": ((OUTPUT, ONE, ORDER, REAL), Mode.STEP_COMPLETE | OVER),
        "DoStep": ((c_double(0.0), c_double(0.01), 1), Mode.STEP_COMPLETE),
        # A step is over when fmi2DoStep returns.
        "CancelStep": ((), NEVER),
        "GetRealStatus": ((2, byref(c_double())), Mode.STEP_COMPLETE | OVER),
        "GetBooleanStatus": ((3, byref(c_int())), Mode.STEP_COMPLETE | OVER),
        "EnterEventMode": ((), EXCHANGE),
        "NewDiscreteStates": ((byref(EVENT),), Mode.EVENT),
        "EnterContinuousTimeMode": ((), Mode.EVENT),
        "CompletedIntegratorStep": ((1, byref(c_int()), byref(c_int())), Mode.CONTINUOUS),
        "SetTime": ((c_double(1.0),), EXCHANGE),
        "SetContinuousStates": ((REALS, SIX), Mode.CONTINUOUS),
        "GetDerivatives": ((REALS, SIX), EXCHANGE | OVER),
        "GetEventIndicators": ((None, ZERO), Mode.INITIALIZATION | EXCHANGE | OVER),
        "GetContinuousStates": ((REALS, SIX), Mode.INITIALIZATION | EXCHANGE | OVER),
        "GetNominalsOfContinuousStates": ((REALS, SIX), EARLY | EXCHANGE | OVER),
    }


# Of the one interface alone, in modes that both have.
ONLY = {
    **dict.fromkeys(
        ("SetRealInputDerivatives", "GetRealOutputDerivatives", "GetRealStatus", "GetBooleanStatus"),
        fmi2CoSimulation,
    ),
    **dict.fromkeys(
        (
            "GetDerivatives",
            "GetEventIndicators",
            "GetContinuousStates",
            "GetNominalsOfContinuousStates",
        ),
        fmi2ModelExchange,
    ),
}
# Need no instance, or make and free it, or (fmi2GetXStatus) discard whatever is asked.
APART = {
    *("GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance"),
    *("GetStatus", "GetIntegerStatus", "GetStringStatus"),
}


def instance_in(mode: Mode, interface: int) -> Instance:
    """A new instance that stands in a mode."""
    if mode == Mode.CONTINUOUS:
        return model_exchange()
    instance = Instance(interface)
    if mode == Mode.INITIALIZATION:
        instance.setup()
        instance.do("EnterInitializationMode")
    elif mode != Mode.INSTANTIATED:
        instance.start()
    if mode == Mode.TERMINATED:
        instance.do("Terminate")
    if mode == Mode.ERROR:
        # There are no forces at the wheel speeds that the step would lead to.
        instance.set_input_derivatives((1e300, 0.0))
        instance.call("DoStep", c_double(0.0), c_double(0.01), 1)
        instance.messages.clear()
    return instance


def interfaces(mode: Mode) -> list[int]:
    """The interfaces that know a mode."""
    if mode in Mode.STEP_COMPLETE | Mode.ERROR:
        return [fmi2CoSimulation]
    return [fmi2ModelExchange] if mode in EXCHANGE else [fmi2CoSimulation, fmi2ModelExchange]


class Order(unittest.TestCase):
    """Every function in every mode."""

    def test_a_call_succeeds_in_its_modes_and_is_refused_in_all_others(self) -> None:
        for function, (arguments, modes) in table().items():
            for mode in Mode:
                for interface in interfaces(mode):
                    with (
                        self.subTest(function, mode=mode, interface=interface),
                        instance_in(mode, interface) as instance,
                    ):
                        status = instance.call(function, *arguments)
                        texts = [message.text for message in instance.messages]
                        if mode in modes and ONLY.get(function, interface) == interface:
                            self.assertEqual((status, texts), (fmi2OK, []))
                        else:
                            self.assertEqual((status, len(texts)), (fmi2Error, 1))
                            self.assertIn(f"fmi2{function}", texts[0])

    def test_the_table_has_every_function_of_the_standard(self) -> None:
        self.assertEqual(len(STANDARD), 44)
        self.assertEqual(set(table()) | APART, STANDARD)


if __name__ == "__main__":
    unittest.main()
