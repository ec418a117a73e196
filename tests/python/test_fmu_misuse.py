"""Wrong arguments: an error with a message through the logger, never a crash."""

import unittest
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_void_p

from fmpy.fmi2 import fmi2Discard, fmi2Error, fmi2ModelExchange, fmi2OK
from fmu_support import (
    INPUTS,
    STANDARD,
    Failed,
    Instance,
    as_reals,
    as_references,
    fmu,
    model_exchange,
)

NULL = c_void_p()
ZERO, TWO = c_size_t(0), c_size_t(2)
UNKNOWN = (1, 999, 1004, 2008, 2000 + 16 * 8, 2**31, 2**32 - 1)
NAN, INFINITY = float("nan"), float("inf")


class NullPointers(unittest.TestCase):
    """NULL where the standard has no place for it, and where it has."""

    def test_every_function_survives_a_null_component(self) -> None:
        functions = STANDARD - {"GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance"}
        self.assertEqual(len(functions), 40)
        for function in functions:
            # No function has more arguments than these.
            status = getattr(fmu().library, "fmi2" + function)(NULL, *[NULL] * 6)
            self.assertEqual(status, fmi2Error, function)
        fmu().library.fmi2FreeInstance(NULL)

    def test_null_arrays_are_refused_unless_they_are_empty(self) -> None:
        inputs, reals = as_references(fmu().references(INPUTS)), as_reals([1.0, 2.0])
        integers = (c_int * 2)(1, 1)
        outputs = as_references(fmu().references(["a_x", "a_y"]))
        for function, arguments in {
            "GetReal": (inputs, TWO, reals),
            "SetReal": (inputs, TWO, reals),
            "GetInteger": (inputs, TWO, integers),
            "SetInteger": (inputs, TWO, integers),
            "GetBoolean": (inputs, TWO, integers),
            "SetBoolean": (inputs, TWO, integers),
            "GetString": (inputs, TWO, None),
            "SetString": (inputs, TWO, None),
            "SetRealInputDerivatives": (inputs, TWO, integers, reals),
            "GetRealOutputDerivatives": (outputs, TWO, integers, reals),
            "GetDirectionalDerivative": (outputs, TWO, inputs, TWO, reals, reals),
        }.items():
            with self.subTest(function), Instance().start() as instance:
                empty = [argument if isinstance(argument, int) else None for argument in arguments]
                empty = [ZERO if a is TWO else e for a, e in zip(arguments, empty, strict=True)]
                self.assertEqual(instance.call(function, *empty), fmi2OK)
                for position, argument in enumerate(arguments):
                    if argument is TWO or (argument is None):
                        continue
                    with_null = list(arguments)
                    with_null[position] = None
                    self.assertEqual(instance.call(function, *with_null), fmi2Error, position)
                    self.assertIn(f"fmi2{function}: ", instance.messages[-1].text)

    def test_null_results_and_states_are_refused(self) -> None:
        with Instance().start() as instance:
            saved = instance.save()
            for function, arguments in (
                ("GetFMUstate", (None,)),
                ("SetFMUstate", (None,)),
                ("SerializedFMUstateSize", (None, byref(c_size_t()))),
                ("SerializedFMUstateSize", (saved, None)),
                ("SerializeFMUstate", (None, c_char_p(b"1"), c_size_t(1))),
                ("SerializeFMUstate", (saved, None, c_size_t(100_000))),
                ("DeSerializeFMUstate", (None, c_size_t(100), byref(c_void_p()))),
                ("DeSerializeFMUstate", (data := instance.serialize(), c_size_t(len(data)), None)),
                ("GetRealStatus", (2, None)),
                ("GetBooleanStatus", (3, None)),
                ("SetDebugLogging", (1, c_size_t(1), None)),
                ("SetDebugLogging", (1, c_size_t(1), (c_char_p * 1)(None))),
            ):
                with self.subTest(function, arguments=arguments):
                    self.assertEqual(instance.call(function, *arguments), fmi2Error)
                    self.assertIn("null pointer", instance.messages[-1].text)
            self.assertEqual(instance.call("FreeFMUstate", None), fmi2OK)
            self.assertEqual(instance.call("FreeFMUstate", byref(c_void_p())), fmi2OK)
            instance.free_state(saved)

    def test_null_arrays_of_states_are_refused(self) -> None:
        with model_exchange() as instance:
            for function in (
                "SetContinuousStates",
                "GetContinuousStates",
                "GetDerivatives",
                "GetNominalsOfContinuousStates",
            ):
                self.assertEqual(instance.call(function, None, c_size_t(6)), fmi2Error, function)
                for count in (0, 5, 7):
                    array = as_reals([0.5] * count)
                    self.assertEqual(instance.call(function, array, c_size_t(count)), fmi2Error)
                    self.assertIn(f"not {count}", instance.messages[-1].text)
            self.assertEqual(instance.call("CompletedIntegratorStep", 1, None, None), fmi2Error)
            self.assertEqual(instance.call("GetEventIndicators", None, c_size_t(1)), fmi2Error)
            instance.do("EnterEventMode")
            self.assertEqual(instance.call("NewDiscreteStates", None), fmi2Error)


class Values(unittest.TestCase):
    """References that are not there, types that do not fit, numbers that are none."""

    def test_unknown_references_are_refused(self) -> None:
        known = fmu().references(["omega_left"])
        with Instance().start() as instance:
            for reference in UNKNOWN:
                if reference in fmu().references(fmu().variables):
                    continue
                references, values = as_references([*known, reference]), as_reals([1.0, 2.0])
                integers = (c_int * 2)(1, 1)
                for function, arguments in (
                    ("GetReal", (values,)),
                    ("SetReal", (values,)),
                    ("GetInteger", (integers,)),
                    ("SetInteger", (integers,)),
                    ("GetBoolean", (integers,)),
                    ("SetBoolean", (integers,)),
                    ("GetString", ((c_char_p * 2)(),)),
                    ("SetString", ((c_char_p * 2)(),)),
                    ("SetRealInputDerivatives", (integers, values)),
                    ("GetRealOutputDerivatives", (integers, values)),
                ):
                    # The first one is known, to Real.
                    values[0] = 1.0
                    status = instance.call(function, references, TWO, *arguments)
                    self.assertEqual(status, fmi2Error, (function, reference))
                    self.assertIn("value reference", instance.messages[-1].text)
            # A refused call has changed nothing.
            self.assertEqual(instance.get(INPUTS), [0.0, 0.0])

    def test_a_type_that_does_not_fit_is_refused(self) -> None:
        with Instance() as instance:
            instance.setup()
            instance.do("EnterInitializationMode")
            for name in ("omega_left", "a_x", "terrain", "initial.no_slip", "vehicle.mass"):
                references = as_references(fmu().references([name]))
                own = {"Real": "Real", "Boolean": "Boolean"}.get(
                    fmu().variables[name].type, "Integer"
                )
                for kind, values in (
                    ("Real", as_reals([1.0])),
                    ("Integer", (c_int * 1)(1)),
                    ("Boolean", (c_int * 1)(1)),
                    ("String", (c_char_p * 1)(b"1")),
                ):
                    if kind == own:
                        continue
                    for function in ("Get" + kind, "Set" + kind):
                        status = instance.call(function, references, c_size_t(1), values)
                        self.assertEqual(status, fmi2Error, (function, name))

    def test_numbers_that_are_not_finite_are_refused(self) -> None:
        with Instance() as early:
            for name in ("omega_left", "vehicle.mass", "initial.x", "soil.cohesion"):
                for value in (NAN, INFINITY, -INFINITY):
                    with self.assertRaisesRegex(Failed, "cannot be set to (NaN|-?inf)"):
                        early.set({name: value})
            early.start().step(0.01)
        with Instance(fmi2ModelExchange, logging=True).start().continuous() as instance:
            for value in (NAN, INFINITY):
                # A solver may try it, and take it back.
                with self.assertRaisesRegex(Failed, "heading = (NaN|inf) is not finite") as failed:
                    instance.set_states([0.0, 0.0, value, 0.0, 0.0, 0.0])
                self.assertEqual(failed.exception.status, fmi2Discard)
                with self.assertRaisesRegex(Failed, "is not finite") as failed:
                    instance.do("SetTime", c_double(value))
                self.assertEqual(failed.exception.status, fmi2Error)
            self.assertEqual(instance.get(["heading"]), [0.0])

    def test_what_a_solver_tries_in_vain_is_discarded(self) -> None:
        state, rates = [0.0, 0.0, 0.3, 1.1, 0.02, 0.1], as_reals([0.0] * 6)
        for logging in (False, True):
            instance = Instance(fmi2ModelExchange, logging=logging).start().continuous()
            with self.subTest(logging=logging), instance:
                instance.set_states(state)
                before = instance.derivatives()
                # There are no forces at such a wheel speed.
                instance.set({"omega_left": 1e300})
                self.assertEqual(instance.call("GetDerivatives", rates, c_size_t(6)), fmi2Discard)
                with self.assertRaises(Failed) as failed:
                    instance.get(["a_x"])
                self.assertEqual(failed.exception.status, fmi2Discard)
                told = [(m.status, m.category) for m in instance.messages]
                self.assertEqual(told, [(fmi2Discard, "logStatusDiscard")] * 2 if logging else [])
                # The next trial is one like any other.
                instance.set({"omega_left": 0.0})
                for now, then in zip(instance.derivatives(), before, strict=True):
                    self.assertAlmostEqual(now, then, delta=1e-8)
                instance.do("EnterEventMode")

    def test_what_is_computed_cannot_be_set(self) -> None:
        with Instance() as instance:
            for mode in ("Instantiated", "Initialization", "Running"):
                for name in ("x", "a_x", "wheel[3].load", "der(x)"):
                    refused = self.assertRaisesRegex(Failed, "is computed and cannot be set")
                    with self.subTest(name, mode=mode), refused:
                        instance.set({name: 1.0})
                if mode == "Instantiated":
                    instance.do("EnterInitializationMode")
                if mode == "Initialization":
                    instance.do("ExitInitializationMode")
        refused = self.assertRaisesRegex(Failed, "is computed and cannot be set")
        with model_exchange() as exchange, refused:
            exchange.set({"a_x": 1.0})

    def test_parameters_are_fixed_after_the_initialization(self) -> None:
        with Instance().start() as instance:
            for name in ("vehicle.mass", "initial.x", "soil.cohesion", "vehicle.row_positions[1]"):
                with self.assertRaisesRegex(Failed, "only be set before the end of the initial"):
                    instance.set({name: 1.0})
            for name in ("terrain", "initial.no_slip"):
                with self.assertRaisesRegex(Failed, "only be set before the end of the initial"):
                    instance.set({name: 1})

    def test_an_unknown_log_category_is_refused(self) -> None:
        with Instance() as instance:
            categories = (c_char_p * 2)(b"logEvents", b"logAll")
            status = instance.call("SetDebugLogging", 1, c_size_t(2), categories)
            self.assertEqual(status, fmi2Error)
            self.assertIn("logStatusError", instance.messages[-1].text)
            instance.start().do("Terminate")
            self.assertEqual(len(instance.messages), 1)


class Status(unittest.TestCase):
    """fmi2GetXStatus: what is not there is discarded."""

    def test_only_the_time_and_the_end_can_be_had(self) -> None:
        with Instance(logging=True).start() as instance:
            instance.step(0.25)
            time, flag = c_double(), c_int(1)
            instance.do("GetRealStatus", 2, byref(time))
            self.assertEqual(time.value, 0.25)
            instance.do("GetBooleanStatus", 3, byref(flag))
            self.assertEqual(flag.value, 0)
            has = {("GetRealStatus", 2), ("GetBooleanStatus", 3)}
            names = ("DoStepStatus", "PendingStatus", "LastSuccessfulTime", "Terminated")
            for function, place in (
                ("GetStatus", c_int()),
                ("GetRealStatus", c_double()),
                ("GetIntegerStatus", c_int()),
                ("GetBooleanStatus", c_int()),
                ("GetStringStatus", c_char_p()),
            ):
                for kind, name in enumerate(names):
                    if (function, kind) in has:
                        continue
                    with self.subTest(function, kind=name):
                        self.assertEqual(instance.call(function, kind, byref(place)), fmi2Discard)
                        self.assertIn(f"fmi2{name}", instance.messages[-1].text)
                self.assertEqual(instance.call(function, 4, byref(place)), fmi2Error)
                self.assertIn("no status kind 4", instance.messages[-1].text)


if __name__ == "__main__":
    unittest.main()
