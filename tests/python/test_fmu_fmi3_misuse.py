"""FMI 3.0: wrong order and wrong arguments are an error with a message, never a crash."""

import enum
import random
import unittest
from ctypes import (
    byref,
    c_bool,
    c_double,
    c_int,
    c_int64,
    c_size_t,
    c_uint,
    c_void_p,
    create_string_buffer,
)

from fmi3_support import (
    STANDARD,
    Instance3,
    fmi3,
    model_exchange_3,
    refusal_3,
)
from fmpy.fmi3 import fmi3Error, fmi3OK
from fmu_support import ANY_GUID, INPUTS, Failed, Instance, as_reals, as_references

NULL = c_void_p()
ZERO, ONE, TWO, SIX = (c_size_t(count) for count in (0, 1, 2, 6))
EIGHT = c_size_t(8)
# References that are there in FMI 2.0 (the second row, the second wheel), and some that never are.
UNKNOWN = (1001, 2016, 2018, 100, 399, 401, 999, 2008, 2**31, 2**32 - 1)
NAN = float("nan")


class Mode(enum.Flag):
    """Where an instance stands."""

    INSTANTIATED = enum.auto()
    INITIALIZATION = enum.auto()
    STEP = enum.auto()
    STEP_EVENT = enum.auto()
    EVENT = enum.auto()
    CONTINUOUS = enum.auto()
    TERMINATED = enum.auto()
    ERROR = enum.auto()


EARLY = Mode.INSTANTIATED | Mode.INITIALIZATION
EXCHANGE = Mode.EVENT | Mode.CONTINUOUS
RUNNING = Mode.STEP | Mode.STEP_EVENT | EXCHANGE
OVER = Mode.TERMINATED | Mode.ERROR
READABLE = Mode.INITIALIZATION | RUNNING | OVER
ANY = EARLY | RUNNING | OVER
NEVER = Mode(0)
# Of the modes that both interfaces know, in model exchange alone.
ALONE = Mode.INITIALIZATION | EXCHANGE | OVER

REAL, REALS, LOADS = as_reals([0.0]), as_reals([0.0] * 6), as_reals([0.0] * 8)
NUMBER, FLAG, ORDER = (c_int64 * 1)(1), (c_bool * 1)(False), (c_int * 1)(1)
INPUT, OUTPUT, STATE, TERRAIN, NO_SLIP, LOAD = (
    as_references(fmi3().references([name]))
    for name in ("omega_left", "a_x", "v_x", "terrain", "initial.no_slip", "wheel.load")
)
NO_TYPES = [
    *("Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "UInt64", "String"),
]
CLOCKS = {
    "GetClock": 1,
    "SetClock": 1,
    "GetIntervalDecimal": 2,
    "GetIntervalFraction": 3,
    "GetShiftDecimal": 1,
    "GetShiftFraction": 2,
    "SetIntervalDecimal": 1,
    "SetIntervalFraction": 2,
    "SetShiftDecimal": 1,
    "SetShiftFraction": 2,
}
# What this FMU has not, and says so.
UNSUPPORTED = {
    "EnterConfigurationMode": (),
    "ExitConfigurationMode": (),
    "EvaluateDiscreteStates": (),
    "ActivateModelPartition": (c_uint(1), c_double(0.0)),
}


class Kept:
    """A state and its bytes, from an instance that has yet to be initialized: it fits any other.

    And that of an instance after an error.
    """

    instance: Instance3
    state: c_void_p
    data: bytes
    error: bytes
    buffer = create_string_buffer(20_000)
    place = c_void_p()


def setUpModule() -> None:
    """Saves the states that the calls are about."""
    Kept.instance = Instance3()
    Kept.state = Kept.instance.save()
    Kept.data = Kept.instance.serialize()
    with Instance().start() as other:
        # There are no forces at the wheel speeds that the step would lead to.
        other.set_input_derivatives((1e300, 0.0))
        other.call("DoStep", c_double(0.0), c_double(0.01), 1)
        Kept.error = other.serialize()


def tearDownModule() -> None:
    """Frees what the calls have left."""
    Kept.instance.free_state(Kept.state)
    Kept.instance.free_state(Kept.place)
    Kept.instance.free()


def table() -> dict[str, tuple[tuple[object, ...], Mode, bool]]:
    """Each function on an instance: right arguments, its modes, whether model exchange has it alone."""
    start = (c_bool(False), c_double(0), c_double(0), c_bool(False), c_double(0))
    room = c_size_t(len(Kept.buffer))
    bytes_ = (Kept.data, c_size_t(len(Kept.data)), byref(Kept.place))
    flags = tuple(byref(c_bool()) for _ in range(5))
    # States are known once the initialization is over.
    partial = (OUTPUT, ONE, INPUT, ONE, REAL, ONE, REALS, ONE)
    step = (c_double(0.0), c_double(0.01), c_bool(True), *flags[:3], byref(c_double()))
    dependencies = (c_uint(OUTPUT[0]), *[(c_size_t * 8)()] * 4, EIGHT)
    both = {
        "SetDebugLogging": ((True, ZERO, None), ANY),
        "EnterInitializationMode": (start, Mode.INSTANTIATED),
        "ExitInitializationMode": ((), Mode.INITIALIZATION),
        "Terminate": ((), RUNNING),
        "Reset": ((), ANY),
        "GetFloat64": ((INPUT, ONE, REAL, ONE), ANY),
        "GetInt64": ((TERRAIN, ONE, NUMBER, ONE), ANY),
        "GetBoolean": ((NO_SLIP, ONE, FLAG, ONE), ANY),
        "SetFloat64": ((INPUT, ONE, REAL, ONE), EARLY | RUNNING),
        # Whatever is no Float64 is a parameter.
        "SetInt64": ((TERRAIN, ONE, NUMBER, ONE), EARLY),
        "SetBoolean": ((NO_SLIP, ONE, FLAG, ONE), EARLY),
        "GetBinary": ((None, ZERO, None, None, ZERO), ANY),
        "SetBinary": ((None, ZERO, None, None, ZERO), EARLY | RUNNING),
        "GetFMUState": ((byref(Kept.place),), ANY),
        "SetFMUState": ((Kept.state,), ANY),
        "FreeFMUState": ((byref(c_void_p()),), ANY),
        "SerializedFMUStateSize": ((Kept.state, byref(c_size_t())), ANY),
        "SerializeFMUState": ((Kept.state, Kept.buffer, room), ANY),
        "DeserializeFMUState": (bytes_, ANY),
        "GetDirectionalDerivative": (partial, READABLE),
        "GetAdjointDerivative": (partial, READABLE),
        "GetNumberOfVariableDependencies": ((c_uint(OUTPUT[0]), byref(c_size_t())), ANY),
        # At the start there are more of them than eight.
        "GetVariableDependencies": (dependencies, RUNNING | OVER),
        "GetOutputDerivatives": ((OUTPUT, ONE, ORDER, REAL, ONE), Mode.STEP | OVER),
        "DoStep": (step, Mode.STEP),
        "EnterStepMode": ((), Mode.STEP_EVENT),
        "EnterEventMode": ((), EXCHANGE | Mode.STEP),
        "UpdateDiscreteStates": ((*flags, byref(c_double())), Mode.EVENT | Mode.STEP_EVENT),
        "EnterContinuousTimeMode": ((), Mode.EVENT),
        "CompletedIntegratorStep": ((c_bool(True), *flags[:2]), Mode.CONTINUOUS),
        "SetTime": ((c_double(1.0),), EXCHANGE),
        "SetContinuousStates": ((REALS, SIX), Mode.CONTINUOUS),
    }
    for kind in NO_TYPES:
        both["Get" + kind] = ((None, ZERO, None, ZERO), ANY)
        both["Set" + kind] = ((None, ZERO, None, ZERO), EARLY | RUNNING)
    for name, count in CLOCKS.items():
        modes = ANY if name.startswith("Get") else EARLY | RUNNING
        both[name] = ((None, ZERO, *[None] * count), modes)
    both |= {name: (arguments, NEVER) for name, arguments in UNSUPPORTED.items()}
    alone = {
        "GetContinuousStateDerivatives": ((REALS, SIX), ALONE),
        "GetEventIndicators": ((None, ZERO), ALONE),
        "GetContinuousStates": ((REALS, SIX), ALONE),
        "GetNominalsOfContinuousStates": ((REALS, SIX), ALONE),
        "GetNumberOfContinuousStates": ((byref(c_size_t()),), ANY),
        "GetNumberOfEventIndicators": ((byref(c_size_t()),), ANY),
    }
    rows = {name: (*row, False) for name, row in both.items()}
    return rows | {name: (*row, True) for name, row in alone.items()}


APART = {
    *("GetVersion", "FreeInstance", "InstantiateModelExchange", "InstantiateCoSimulation"),
    "InstantiateScheduledExecution",
}


def instance_in(mode: Mode, kind: str) -> Instance3:
    """A new instance that stands in a mode."""
    if mode == Mode.CONTINUOUS:
        return model_exchange_3()
    instance = Instance3(kind, events=mode in Mode.STEP_EVENT | Mode.INITIALIZATION)
    if mode == Mode.INITIALIZATION:
        instance.initialize()
    elif mode == Mode.ERROR:
        instance.take_over(Kept.error)
    elif mode != Mode.INSTANTIATED:
        instance.start()
    if mode == Mode.TERMINATED:
        instance.do("Terminate")
        instance.messages.clear()
    if mode == Mode.STEP:
        # One that could enter event mode.
        instance.free()
        instance = Instance3(kind, events=True).start()
        instance.update()
        instance.do("EnterStepMode")
    return instance


# Of co-simulation alone, in modes that both interfaces have.
NOT_FOR = {"GetOutputDerivatives": ("ModelExchange",)}


def kinds(mode: Mode) -> list[str]:
    """The interfaces that know a mode."""
    if mode in Mode.STEP | Mode.STEP_EVENT:
        return ["CoSimulation"]
    return ["ModelExchange"] if mode in EXCHANGE else ["CoSimulation", "ModelExchange"]


class Order(unittest.TestCase):
    """Every function in every mode."""

    def test_a_call_succeeds_in_its_modes_and_is_refused_in_all_others(self) -> None:
        for function, (arguments, modes, alone) in table().items():
            for mode in Mode:
                for kind in kinds(mode):
                    with (
                        self.subTest(function, mode=mode, kind=kind),
                        instance_in(mode, kind) as instance,
                    ):
                        status = instance.call(function, *arguments)
                        errors = [m.text for m in instance.messages if m.status == fmi3Error]
                        foreign = kind == "CoSimulation" if alone else kind in NOT_FOR.get(function, ())
                        if mode in modes and not foreign:
                            self.assertEqual((status, errors), (fmi3OK, []))
                        else:
                            self.assertEqual((status, len(errors)), (fmi3Error, 1))
                            self.assertIn(f"fmi3{function}", errors[0])

    def test_the_table_has_every_function_of_the_standard(self) -> None:
        self.assertEqual(set(table()) | APART, STANDARD)

    def test_events_are_for_those_who_said_so(self) -> None:
        with Instance3().start() as instance:
            with self.assertRaisesRegex(Failed, "a co-simulation without event mode"):
                instance.do("EnterEventMode")
            instance.step(0.1)
            with Instance3(events=True).start() as other:
                data = other.serialize()
            with self.assertRaisesRegex(Failed, "saved in event mode, which this instance"):
                instance.take_over(data)

    def test_what_is_not_supported_says_why(self) -> None:
        with Instance3().start() as instance:
            for function, arguments in UNSUPPORTED.items():
                self.assertEqual(instance.call(function, *arguments), fmi3Error)
                self.assertRegex(instance.messages[-1].text, f"fmi3{function}: .*(no )")


class Random(unittest.TestCase):
    """Whatever is called, with whatever missing: a status and no crash."""

    CALLS = 30_000
    BY_VALUE = (bool, c_bool, c_double, c_size_t, c_uint)

    def test_random_calls_return_ok_or_an_error_with_a_message(self) -> None:
        generator = random.Random(20071121)
        rows, time = table(), as_references(fmi3().references(["time"]))
        names = sorted(rows)
        instances = [
            Instance3("ModelExchange") if number % 3 == 0 else Instance3(events=number % 2 == 0)
            for number in range(6)
        ]
        succeeded = set()
        for _ in range(self.CALLS):
            instance = generator.choice(instances)
            # What ends a simulation comes less often.
            name = generator.choice(names)
            if name in ("Terminate", "Reset") and generator.random() < 0.8:
                continue
            arguments = list(rows[name][0])
            # What an earlier call has left there.
            REAL[0], REALS[:] = 1.0, [0.0] * 6
            if name == "DoStep":
                now = c_double()
                instance.call("GetFloat64", time, ONE, byref(now), ONE)
                arguments[0] = now
            places = [p for p, a in enumerate(arguments) if not isinstance(a, self.BY_VALUE)]
            if places and generator.random() < 0.2:
                arguments[generator.choice(places)] = None
            instance.messages.clear()
            status = instance.call(name, *arguments)
            self.assertIn(status, (fmi3OK, fmi3Error), name)
            if status == fmi3OK:
                succeeded.add(name)
            else:
                self.assertTrue(instance.messages, name)
        self.assertEqual(succeeded, set(names) - set(UNSUPPORTED))
        for instance in instances:
            instance.free()


class Creation(unittest.TestCase):
    """Instances that are not created, and why."""

    def test_wrong_arguments_are_named(self) -> None:
        for kind in ("CoSimulation", "ModelExchange"):
            self.assertIn("instantiation token", refusal_3(kind, token=ANY_GUID))
            self.assertIn("instance name is a null", refusal_3(kind, name=None))
            self.assertIn("relative", refusal_3(kind, resources="relative/folder"))
        self.assertIn("no scheduled execution", refusal_3("ScheduledExecution"))
        self.assertIn("no intermediate update", refusal_3(intermediate=[0]))
        # The reason is told even where nothing else is.
        self.assertIn("instantiation token", refusal_3(token=ANY_GUID, logging=False))

    def test_without_a_logger_nothing_is_said(self) -> None:
        library, token = fmi3().library, fmi3().description.guid.encode()
        create = library.fmi3InstantiateModelExchange
        handle = c_void_p(create(b"x", token, None, False, True, None, None))
        self.assertIsNotNone(handle.value)
        self.assertEqual(library.fmi3Terminate(handle), fmi3Error)
        library.fmi3FreeInstance(handle)
        self.assertIsNone(create(b"x", None, None, False, True, None, None))


class Arguments(unittest.TestCase):
    """NULL, wrong references, wrong numbers of values."""

    def test_every_function_survives_a_null_instance(self) -> None:
        functions = STANDARD - APART
        self.assertEqual(len(functions), 70)
        for function in functions:
            # No function has more arguments than these.
            status = getattr(fmi3().library, "fmi3" + function)(NULL, *[NULL] * 8)
            self.assertEqual(status, fmi3Error, function)
        fmi3().library.fmi3FreeInstance(NULL)

    def test_null_arrays_and_results_are_refused(self) -> None:
        inputs, reals = as_references(fmi3().references(INPUTS)), as_reals([1.0, 2.0])
        orders, flags = (c_int * 2)(1, 1), (c_bool * 2)()
        size, state = byref(c_size_t()), Kept.state
        # With None where a pointer has to be and is not.
        calls = [
            ("GetFloat64", (None, TWO, reals, TWO)),
            ("GetFloat64", (inputs, TWO, None, TWO)),
            ("SetFloat64", (None, TWO, reals, TWO)),
            ("SetFloat64", (inputs, TWO, None, TWO)),
            ("GetInt64", (TERRAIN, ONE, None, ONE)),
            ("SetInt64", (TERRAIN, ONE, None, ONE)),
            ("GetBoolean", (NO_SLIP, ONE, None, ONE)),
            ("SetBoolean", (NO_SLIP, ONE, None, ONE)),
            ("GetBinary", (None, ONE, None, None, ONE)),
            ("GetOutputDerivatives", (OUTPUT, ONE, None, REAL, ONE)),
            ("GetOutputDerivatives", (OUTPUT, ONE, orders, None, ONE)),
            ("GetDirectionalDerivative", (None, ONE, STATE, ONE, REAL, ONE, REAL, ONE)),
            ("GetDirectionalDerivative", (OUTPUT, ONE, None, ONE, REAL, ONE, REAL, ONE)),
            ("GetDirectionalDerivative", (OUTPUT, ONE, STATE, ONE, None, ONE, REAL, ONE)),
            ("GetAdjointDerivative", (OUTPUT, ONE, STATE, ONE, REAL, ONE, None, ONE)),
            ("GetNumberOfVariableDependencies", (c_uint(OUTPUT[0]), None)),
            ("GetVariableDependencies", (c_uint(OUTPUT[0]), None, None, None, None, EIGHT)),
            ("GetFMUState", (None,)),
            ("SetFMUState", (None,)),
            ("SerializedFMUStateSize", (None, size)),
            ("SerializedFMUStateSize", (state, None)),
            ("SerializeFMUState", (state, None, c_size_t(100_000))),
            ("DeserializeFMUState", (None, ONE, byref(c_void_p()))),
            ("DeserializeFMUState", (Kept.data, c_size_t(len(Kept.data)), None)),
            ("SetDebugLogging", (True, ONE, None)),
            ("DoStep", (c_double(0), c_double(0.01), True, None, flags, flags, REAL)),
            ("DoStep", (c_double(0), c_double(0.01), True, flags, flags, flags, None)),
        ]
        calls += [("Get" + kind, (None, ONE, None, ONE)) for kind in NO_TYPES]
        calls += [(name, (None, ONE, *[None] * count)) for name, count in CLOCKS.items()]
        with Instance3().start() as instance:
            for function, arguments in calls:
                with self.subTest(function, arguments=arguments):
                    self.assertEqual(instance.call(function, *arguments), fmi3Error)
                    self.assertRegex(instance.messages[-1].text, f"fmi3{function}: .*null pointer")
            # No step was made, and nothing is left broken.
            self.assertEqual(instance.get(["time"]), [0.0])
            self.assertEqual(instance.call("FreeFMUState", None), fmi3OK)
            instance.step(0.01)

    def test_the_number_of_values_has_to_be_that_of_the_variables(self) -> None:
        both = as_references(fmi3().references(["wheel.load", "omega_left"]))
        nine = as_reals([0.0] * 9)
        with Instance3("ModelExchange").start() as instance:
            instance.do("GetFloat64", both, TWO, nine, c_size_t(9))
            self.assertGreater(nine[7], 0.0)
            for count in (0, 1, 2, 8):
                for function, arguments in (
                    ("GetFloat64", (both, TWO, nine, c_size_t(count))),
                    ("SetFloat64", (both, TWO, nine, c_size_t(count))),
                ):
                    self.assertEqual(instance.call(function, *arguments), fmi3Error)
                    message = f"the variables have 9 values, not {count}"
                    self.assertIn(message, instance.messages[-1].text)
            seeds = (STATE, ONE, REAL, ONE)
            for function, arguments in (
                ("GetDirectionalDerivative", (LOAD, ONE, *seeds, LOADS, ONE)),
                ("GetDirectionalDerivative", (LOAD, ONE, STATE, ONE, REALS, TWO, LOADS, EIGHT)),
                ("GetAdjointDerivative", (LOAD, ONE, *seeds, REAL, ONE)),
                ("GetAdjointDerivative", (LOAD, ONE, STATE, ONE, LOADS, EIGHT, LOADS, TWO)),
                ("GetInt64", (TERRAIN, ONE, (c_int64 * 2)(), TWO)),
                ("SetBoolean", (NO_SLIP, ONE, FLAG, ZERO)),
            ):
                self.assertEqual(instance.call(function, *arguments), fmi3Error, function)
                self.assertRegex(instance.messages[-1].text, "have [18] values?, not|values, not")
            instance.do("GetDirectionalDerivative", LOAD, ONE, *seeds, LOADS, EIGHT)
            for count in (0, 5, 7):
                array = as_reals([0.5] * count)
                for function in ("GetContinuousStates", "GetContinuousStateDerivatives"):
                    self.assertEqual(instance.call(function, array, c_size_t(count)), fmi3Error)
                    self.assertIn(f"not {count}", instance.messages[-1].text)
            self.assertEqual(instance.call("GetEventIndicators", REAL, ONE), fmi3Error)

    def test_unknown_references_and_types_that_do_not_fit_are_refused(self) -> None:
        known = fmi3().references(["omega_left"])
        numbers, flags = (c_int64 * 2)(1, 1), (c_bool * 2)()
        with Instance3().start() as instance:
            for reference in UNKNOWN:
                references, values = as_references([*known, reference]), as_reals([1.0, 2.0])
                for function, array in (
                    ("GetFloat64", values),
                    ("SetFloat64", values),
                    ("GetInt64", numbers),
                    ("SetInt64", numbers),
                    ("GetBoolean", flags),
                    ("SetBoolean", flags),
                    *(("Get" + kind, None) for kind in NO_TYPES),
                ):
                    values[0] = 1.0
                    status = instance.call(function, references, TWO, array, TWO)
                    self.assertEqual(status, fmi3Error, (function, reference))
                    self.assertIn("value reference", instance.messages[-1].text)
                status = instance.call(
                    "GetNumberOfVariableDependencies", c_uint(reference), byref(c_size_t())
                )
                self.assertEqual(status, fmi3Error)
            # A refused call has changed nothing.
            self.assertEqual(instance.get(INPUTS), [0.0, 0.0])
            for reference in (INPUT, TERRAIN):
                arguments = (c_uint(reference[0]), byref(c_size_t()))
                status = instance.call("GetNumberOfVariableDependencies", *arguments)
                self.assertEqual(status, fmi3Error)

    def test_values_that_make_no_sense_are_refused(self) -> None:
        with Instance3() as instance:
            for name, value, reason in (
                ("vehicle.mass", NAN, "cannot be set to NaN"),
                ("vehicle.row_positions", [0.9, 0.3, NAN, -0.9], "cannot be set to NaN"),
                ("terrain", 6, "terrain 6 is not one of 1 to 5"),
                ("terrain", 2**40, "is not one of 1 to 5"),
                ("x", 1.0, "is computed and cannot be set"),
                ("time", 1.0, "is computed and cannot be set"),
                ("wheel.load", [1.0] * 8, "is computed and cannot be set"),
                ("effects.grade.slope_east", 0.4, "outside its range"),
            ):
                with self.subTest(name), self.assertRaisesRegex(Failed, reason):
                    instance.set({name: value})
            with self.assertRaisesRegex(Failed, "start time"):
                instance.initialize(NAN)
            instance.start(stop=0.3)
            for name in ("vehicle.mass", "vehicle.row_positions"):
                value = instance.get([name])
                with self.assertRaisesRegex(Failed, "only be set before the end"):
                    instance.set({name: value})
            for size, reason in ((0.0, "is not positive"), (NAN, "is not positive"), (0.4, "stop")):
                with self.assertRaisesRegex(Failed, reason):
                    instance.step(size)
            instance.time = 0.1
            with self.assertRaisesRegex(Failed, "is not the current time"):
                instance.step(0.1)
            instance.time = 0.0
            instance.step(0.3)
            with self.assertRaisesRegex(Failed, "a seed cannot be NaN"):
                instance.adjoint(["a_x"], ["v_x"], [NAN])
            with self.assertRaisesRegex(Failed, "is neither an input nor a state"):
                instance.adjoint(["a_x"], ["wheel.load"], [1.0])
            with self.assertRaisesRegex(Failed, "neither an output nor a state derivative"):
                instance.directional(["omega_left"], ["v_x"], [1.0])

    def test_a_step_that_fails_tells_how_far_it_came(self) -> None:
        with Instance3().start({"omega_left": 5.0, "omega_right": 5.0}) as instance:
            instance.step(0.1)
            instance.set({"omega_left": 1e200})
            reached, flags = c_double(9.0), [c_bool() for _ in range(3)]
            results = (*map(byref, flags), byref(reached))
            arguments = (c_double(0.1), c_double(0.1), c_bool(True), *results)
            self.assertEqual(instance.call("DoStep", *arguments), fmi3Error)
            self.assertEqual(reached.value, 0.1)
            with self.assertRaisesRegex(Failed, "is not allowed after an error"):
                instance.step(0.1)
            instance.do("Reset")
            instance.start({"omega_left": 5.0}).step(0.1)


if __name__ == "__main__":
    unittest.main()
