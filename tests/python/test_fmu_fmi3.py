"""The FMI 3.0 FMU is the FMI 2.0 one, bit for bit, with arrays for the wheels."""

import json
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile
from collections.abc import Iterable, Sequence
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint
from pathlib import Path

import casadi
import fmpy
import numpy as np
from fmi3_support import (
    STANDARD,
    Instance3,
    fmi3,
    fmi3_path,
    model_exchange_3,
    token_of,
)
from fmpy import simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave, fmi3Constant, fmi3Dependent
from fmpy.model_description import Unknown
from fmpy.validation import validate_fmu
from fmu_support import (
    INPUTS,
    RATES,
    STATES,
    Failed,
    Instance,
    fmu,
    fmu_path,
    model_exchange,
    resources,
    scratch,
)
from lxml import etree

# Sizes of steps [s], in turn.
STEPS = (0.01, 1e-4, 0.05, 0.0037, 0.1, 1 / 30)
# Wheel speeds [rad/s], in turn: to speed, a turn, a pivot, braking, reverse.
SPEEDS = ([6.0, 6.0], [8.0, 5.0], [-3.0, 3.0], [0.5, 0.0], [-5.0, -6.0])
PARAMETERS = {"vehicle.mass": 433.3, "vehicle.com_offset": -0.05, "initial.v_x": 0.3}
STATE = [1.0, -2.0, 0.3, 1.1, 0.02, 0.1]
SLOPES = {"over": "time", "points": [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [3.0, -0.1, 0.05]]}


def bits(values: Iterable[float]) -> list[str]:
    """Numbers to the last bit."""
    return [struct.pack(">d", value).hex() for value in values]


class Pair:
    """The same vehicle through both FMUs, driven by fmpy."""

    def __init__(self, start: dict[str, float]) -> None:
        self.two, self.three = (
            kind(
                guid=each.description.guid,
                unzipDirectory=str(each.folder),
                modelIdentifier=each.description.coSimulation.modelIdentifier,
                instanceName="drive",
            )
            for kind, each in ((FMU2Slave, fmu()), (FMU3Slave, fmi3()))
        )
        for instance in (self.two, self.three):
            instance.instantiate()
        for name, value in start.items():
            (two,), (three,) = fmu().references([name]), fmi3().references([name])
            if fmu().variables[name].type == "Enumeration":
                self.two.setInteger([two], [value])
                self.three.setInt64([three], [value])
            else:
                self.two.setReal([two], [value])
                self.three.setFloat64([three], [value])
        self.two.setupExperiment(startTime=0.0)
        self.two.enterInitializationMode()
        self.three.enterInitializationMode(startTime=0.0)
        for instance in (self.two, self.three):
            instance.exitInitializationMode()
        self.time = 0.0
        # All numbers but the time, which FMI 2.0 has not as a variable.
        variables = fmi3().variables.items()
        self.names = [n for n, v in variables if v.type == "Float64" and n != "time"]
        self.scalars = [scalar for name in self.names for scalar in fmi3().scalars(name)]

    def drive(self, test: unittest.TestCase, seconds: float) -> None:
        """Drives both and compares every number after each step."""
        end, index = self.time + seconds, 0
        while self.time < end:
            speeds, size = SPEEDS[(index // 7) % len(SPEEDS)], STEPS[index % len(STEPS)]
            self.two.setReal(fmu().references(INPUTS), speeds)
            self.three.setFloat64(fmi3().references(INPUTS), speeds)
            self.two.doStep(self.time, size)
            event, stop, early, reached = self.three.doStep(self.time, size)
            test.assertEqual((event, stop, early), (False, False, False))
            self.time += size
            test.assertEqual(reached, self.time)
            self.compare(test)
            index += 1

    def compare(self, test: unittest.TestCase) -> None:
        """Compares every number."""
        references = fmu().references(self.scalars)
        one = dict(zip(self.scalars, bits(self.two.getReal(references)), strict=True))
        references = fmi3().references(self.names)
        values = self.three.getFloat64(references, len(self.scalars))
        other = dict(zip(self.scalars, bits(values), strict=True))
        test.assertEqual(one, other, f"at {self.time} s")
        (now,) = self.three.getFloat64(fmi3().references(["time"]))
        test.assertEqual(now, self.time)

    def free(self) -> None:
        """Ends both."""
        for instance in (self.two, self.three):
            instance.terminate()
            instance.freeInstance()


class Equal(unittest.TestCase):
    """What fmpy gets from both."""

    def test_every_number_has_the_same_bits_on_every_terrain(self) -> None:
        for terrain in range(1, 5):
            with self.subTest(terrain=terrain):
                pair = Pair(PARAMETERS | {"terrain": terrain})
                self.assertGreater(len(pair.scalars), 100)
                pair.compare(self)
                pair.drive(self, 2.0)
                pair.free()

    def test_states_in_the_middle_of_a_drive_lead_to_the_same_bits(self) -> None:
        pair = Pair({"terrain": 2})
        pair.drive(self, 0.5)
        two, three, time = pair.two.getFMUstate(), pair.three.getFMUState(), pair.time
        data = pair.three.serializeFMUState(three)
        self.assertEqual(data, pair.two.serializeFMUstate(two))
        pair.drive(self, 0.5)
        pair.two.setFMUstate(two)
        pair.three.setFMUState(three)
        pair.time = time
        pair.compare(self)
        pair.drive(self, 0.5)
        # As bytes, and those of the other.
        state = pair.three.deserializeFMUState(pair.two.serializeFMUstate(two))
        pair.three.setFMUState(state)
        pair.two.setFMUstate(pair.two.deSerializeFMUstate(data))
        pair.time = time
        pair.drive(self, 0.5)
        for each in (three, state):
            pair.three.freeFMUState(each)
        pair.two.freeFMUstate(two)
        pair.free()

    def test_fmpy_simulates_both_alike(self) -> None:
        common = {
            "start_values": {"terrain": 1, "omega_left": 4.0, "omega_right": 5.0},
            "stop_time": 1.0,
            "output_interval": 0.05,
        }
        own = [{}, {"use_event_mode": True}]
        for kind, more in (("CoSimulation", own), ("ModelExchange", [{}])):
            two = simulate_fmu(str(fmu().folder), fmi_type=kind, output=fmu().outputs, **common)
            for arguments in more:
                three = simulate_fmu(str(fmi3().folder), fmi_type=kind, **arguments, **common)
                self.assertEqual(bits(two["time"]), bits(three["time"]))
                self.assertEqual(three["wheel.load"].shape, (21, 8))
                for name in fmi3().outputs:
                    columns = [two[scalar] for scalar in fmi3().scalars(name)]
                    values = np.asarray(three[name]).reshape(21, -1)
                    self.assertEqual(bits(np.stack(columns, axis=1).ravel()), bits(values.ravel()))
                self.assertNotEqual(three["x"][-1], 0.0)

    def test_the_fmpy_tool_simulates_from_the_archive(self) -> None:
        result = Path(tempfile.mkdtemp(dir=scratch())) / "result.csv"
        command = [sys.executable, "-m", "fmpy", "simulate", str(fmi3_path())]
        command += ["--stop-time", "0.5", "--output-interval", "0.01"]
        command += ["--output-file", str(result)]
        command += ["--start-values", "terrain", "1", "omega_left", "4", "omega_right", "5"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("no folder", done.stdout)
        header, *rows = result.read_text().splitlines()
        self.assertEqual(len(rows), 51)
        self.assertIn("wheel.load", header)


class Description(unittest.TestCase):
    """What the archive says of itself."""

    def test_fmpy_finds_nothing_to_complain_about(self) -> None:
        self.assertEqual(validate_fmu(str(fmi3_path())), [])
        command = [sys.executable, "-m", "fmpy", "validate", str(fmi3_path())]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)

    def test_fmutool_finds_nothing_to_complain_about(self) -> None:
        tool = Path(sys.executable).parent / "fmutool"
        command = [str(tool), "-input", str(fmi3_path()), "-check"]
        # The tool leaves its files in the current folder.
        done = subprocess.run(command, cwd=scratch(), capture_output=True, text=True, check=False)
        said = (done.stdout + done.stderr).splitlines()
        self.assertEqual(done.returncode, 0, said)
        self.assertEqual([line for line in said if not line.startswith("INFO")], [])

    def test_types_have_no_description_which_older_fmpy_does_not_read(self) -> None:
        description = etree.parse(str(fmi3().folder / "modelDescription.xml"))
        types = description.findall("TypeDefinitions/*")
        self.assertEqual([dict(t.attrib) for t in types], [{"name": "Terrain"}])

    def test_the_terminals_are_as_the_schema_wants_them(self) -> None:
        schemas = Path(fmpy.__file__).parent / "schema" / "fmi3"
        schema = etree.XMLSchema(file=str(schemas / "fmi3TerminalsAndIcons.xsd"))
        file = fmi3().folder / "terminalsAndIcons" / "terminalsAndIcons.xml"
        schema.assertValid(etree.parse(str(file)))

    def test_both_archives_hold_the_same_library(self) -> None:
        three = (fmi3().folder / "binaries" / "x86_64-linux" / "ugv.so").read_bytes()
        two = (fmu().folder / "binaries" / "linux64" / "ugv.so").read_bytes()
        self.assertEqual(two, three)
        names = zipfile.ZipFile(fmi3_path()).namelist()
        self.assertIn("documentation/index.html", names)
        self.assertIn("terminalsAndIcons/icon.png", names)
        self.assertNotIn("model.png", names)
        names = zipfile.ZipFile(fmu_path()).namelist()
        self.assertIn("model.png", names)
        self.assertEqual([name for name in names if name.startswith("terminalsAndIcons")], [])

    def test_the_variables_are_those_of_fmi_2_and_the_time(self) -> None:
        names = [n for v in fmi3().variables if v != "time" for n in fmi3().scalars(v)]
        self.assertEqual(set(names), set(fmu().variables))
        for name, variable in fmi3().variables.items():
            if name == "time":
                continue
            for scalar in fmi3().scalars(name):
                other = fmu().variables[scalar]
                for attribute in ("causality", "variability", "description", "unit", "min", "max"):
                    own = getattr(variable, attribute)
                    self.assertEqual(own, getattr(other, attribute), (scalar, attribute))
            if variable.start is not None and variable.type == "Float64":
                starts = [float(fmu().variables[s].start) for s in fmi3().scalars(name)]
                self.assertEqual([float(s) for s in str(variable.start).split()], starts, name)

    def test_only_true_flags_are_set(self) -> None:
        root = etree.parse(str(fmi3().folder / "modelDescription.xml")).getroot()
        both = {
            *("modelIdentifier", "canGetAndSetFMUState", "canSerializeFMUState"),
            *("providesDirectionalDerivatives", "providesAdjointDerivatives"),
            "providesPerElementDependencies",
        }
        alone = {
            *("canHandleVariableCommunicationStepSize", "maxOutputDerivativeOrder"),
            "hasEventMode",
        }
        self.assertEqual(set(root.find("ModelExchange").attrib), both)
        self.assertEqual(set(root.find("CoSimulation").attrib), both | alone)
        self.assertIsNone(root.find("ScheduledExecution"))

    def test_dependencies_are_told_by_functions_as_well(self) -> None:
        description = fmi3().description
        running = [*description.outputs, *description.derivatives]
        self.assertEqual(len(running), len(description.initialUnknowns))
        with Instance3() as instance:
            self.compare_dependencies(instance, description.initialUnknowns)
            instance.initialize()
            self.compare_dependencies(instance, description.initialUnknowns)
            instance.do("ExitInitializationMode")
            self.compare_dependencies(instance, running)

    def compare_dependencies(self, instance: Instance3, unknowns: Iterable[Unknown]) -> None:
        """Compares what functions tell with the model description."""
        kinds = {"constant": fmi3Constant, "dependent": fmi3Dependent}
        for each in unknowns:
            reference, count = c_uint(each.variable.valueReference), c_size_t()
            instance.do("GetNumberOfVariableDependencies", reference, byref(count))
            self.assertEqual(count.value, len(each.dependencies), each.variable.name)
            size = count.value
            found = (c_size_t * size)(*[9] * size), (c_uint * size)()
            found += (c_size_t * size)(*[9] * size), (c_int * size)()
            instance.do("GetVariableDependencies", reference, *found, count)
            elements, references, others, kind = map(list, found)
            self.assertEqual(references, [v.valueReference for v in each.dependencies])
            # Where no kind is told it is the weakest.
            expected = each.dependenciesKind or ["dependent"] * size
            self.assertEqual(kind, [kinds[name] for name in expected])
            # All elements depend on all.
            self.assertEqual(elements + others, [0] * 2 * size)
            with self.assertRaisesRegex(Failed, f"there are {size} dependencies, not"):
                instance.do("GetVariableDependencies", reference, *found, c_size_t(size + 1))

    def test_the_library_has_every_function_of_the_standard(self) -> None:
        self.assertEqual(len(STANDARD), 75)
        for name in STANDARD:
            self.assertTrue(hasattr(fmi3().library, "fmi3" + name), name)
        self.assertEqual(fmi3().library.fmi3GetVersion(), b"3.0")


class Derivatives(unittest.TestCase):
    """Partial derivatives and those in time."""

    UNKNOWNS: tuple[str, ...] = (*RATES, *fmi3().outputs)
    KNOWNS: tuple[str, ...] = (*STATES, *INPUTS)

    def pair(self, start: dict[str, float]) -> tuple[Instance, Instance3]:
        """Both FMUs in model exchange at the same point."""
        two, three = model_exchange(start), model_exchange_3(start)
        for instance in (two, three):
            self.addCleanup(instance.free)
            instance.set_states(STATE)
            instance.set({"omega_left": 4.0, "omega_right": 5.0})
        return two, three

    def scalars(self) -> list[str]:
        """The unknowns by the names that FMI 2.0 has for them."""
        return [scalar for name in self.UNKNOWNS for scalar in fmi3().scalars(name)]

    def test_directional_derivatives_are_those_of_fmi_2(self) -> None:
        for start in ({"terrain": 1}, {"terrain": 4, "effects.grade.slope_east": 0.06}):
            two, three = self.pair(start)
            for known in self.KNOWNS:
                expected = two.directional(self.scalars(), [known], [1.5])
                found = three.directional(self.UNKNOWNS, [known], [1.5])
                self.assertEqual(bits(found), bits(expected), known)
                self.assertTrue(any(found))
            seeds = [0.5, -1.0, 2.0, 0.25, -0.125, 4.0, 1.0, -2.0]
            expected = two.directional(self.scalars(), self.KNOWNS, seeds)
            found = three.directional(self.UNKNOWNS, self.KNOWNS, seeds)
            self.assertEqual(bits(found), bits(expected))

    def test_adjoint_derivatives_are_the_transpose(self) -> None:
        _, three = self.pair({"terrain": 2})
        columns = [three.directional(self.UNKNOWNS, [known], [1.0]) for known in self.KNOWNS]
        matrix = np.array(columns).T
        generator = np.random.default_rng(7)
        for _ in range(3):
            seeds = generator.normal(size=len(matrix))
            found = three.adjoint(self.UNKNOWNS, self.KNOWNS, list(seeds))
            # Sums in another order.
            scale = np.abs(seeds) @ np.abs(matrix)
            np.testing.assert_array_less(np.abs(found - seeds @ matrix), 1e-13 * scale)
        self.assertEqual(three.adjoint(["v_x"], self.KNOWNS, [2.0]), [0, 0, 0, 2.0, 0, 0, 0, 0])

    def test_output_derivatives_are_those_of_fmi_2(self) -> None:
        values = {"terrain": 3, "omega_left": 6.0, "omega_right": 4.0}
        scalars = [scalar for name in fmi3().outputs for scalar in fmi3().scalars(name)]
        with Instance().start(values) as two, Instance3().start(values) as three:
            for instance in (two, three):
                instance.step(0.2)
            expected = two.output_derivatives(scalars)
            self.assertEqual(bits(three.output_derivatives(fmi3().outputs)), bits(expected))
            with self.assertRaisesRegex(Failed, "are of order 1, not 2"):
                three.output_derivatives(["x"], 2)

    def test_where_effects_are_over_time_there_is_a_derivative_by_it(self) -> None:
        with_slopes = with_effects({"grade": {"profile": SLOPES}})
        step, time = 1e-5, 0.3
        with model_exchange_3({"omega_left": 4.0, "omega_right": 5.0}, **with_slopes) as three:
            three.set_states(STATE)
            values = []
            for now in (time + step, time - step, time):
                three.do("SetTime", c_double(now))
                values.append(np.array(three.get(self.UNKNOWNS)))
            differences = (values[0] - values[1]) / (2.0 * step)
            exact = np.array(three.directional(self.UNKNOWNS, ["time"], [1.0]))
            self.assertGreater(np.abs(exact).max(), 0.1)
            # The differences' own error, and the noise of the balance over the step.
            allowed = 1e-5 * np.abs(exact).max() + 1e-6 * np.abs(values[2])
            np.testing.assert_array_less(np.abs(exact - differences), allowed + 1e-12)
            twice = three.directional(self.UNKNOWNS, ["time", "v_x"], [2.0, 1.0])
            alone = three.directional(self.UNKNOWNS, ["v_x"], [1.0])
            np.testing.assert_allclose(twice, 2.0 * exact + alone, rtol=1e-12, atol=1e-9)
            reference, count = c_uint(fmi3().variables["a_x"].valueReference), c_size_t()
            three.do("GetNumberOfVariableDependencies", reference, byref(count))
            self.assertEqual(count.value, 9)
        # Elsewhere the time does nothing.
        _, plain = self.pair({})
        self.assertFalse(any(plain.directional(self.UNKNOWNS, ["time"], [1.0])))


def with_effects(effects: dict) -> dict[str, str]:
    """Arguments of an instance whose resources have these effects."""

    def change(folder: Path) -> None:
        (folder / "effects.json").write_text(json.dumps(effects))

    folder = resources(change)
    return {"token": token_of(folder), "resources": f"{folder}/"}


class Casadi(unittest.TestCase):
    """CasADi, which takes the equations of motion (3.8 asks for no array as FMI 3.0 wants it)."""

    def test_casadi_gets_the_rates_and_their_jacobian(self) -> None:
        builder = casadi.DaeBuilder("ugv", str(fmi3().folder), {})
        self.assertEqual([str(x) for x in builder.x()], list(STATES))
        self.assertEqual([str(u) for u in builder.u()], list(INPUTS))
        function, speeds = builder.create("f", ["x", "u"], ["ode"]), [4.0, 5.0]
        jacobians = function.factory("j", ["x", "u"], ["jac:ode:x", "jac:ode:u"])
        matrices = map(np.array, jacobians(STATE, speeds))
        with model_exchange_3(dict(zip(INPUTS, speeds, strict=True))) as instance:
            instance.set_states(STATE)
            rates = np.array(function(STATE, speeds)).ravel()
            # The same point, but for the first guess.
            np.testing.assert_allclose(rates, instance.derivatives(), rtol=1e-9)
            for matrix, knowns in zip(matrices, (STATES, INPUTS), strict=True):
                for column, known in enumerate(knowns):
                    expected = instance.directional(RATES, [known], [1.0])
                    np.testing.assert_allclose(matrix[:, column], expected, rtol=1e-9, atol=1e-9)


class Events(unittest.TestCase):
    """Event mode, with and without time events."""

    EFFECTS = {
        "grade": {"slope_east": 0.1},
        "window": {"effects": ["grade"], "time": [0.25, 0.5]},
    }

    def test_model_exchange_is_told_of_the_edges_of_a_window(self) -> None:
        arguments = with_effects(self.EFFECTS)
        with Instance3("ModelExchange", **arguments).start() as instance:
            found = [instance.update()]
            for time in (0.25, 0.5):
                instance.do("EnterContinuousTimeMode")
                instance.do("SetTime", c_double(time))
                instance.do("EnterEventMode")
                found.append(instance.update())
            four = [False] * 4
            expected = [([*four, True], 0.25), ([*four, True], 0.5), ([*four, False], 0.0)]
            self.assertEqual(found, expected)

    def test_a_window_opens_in_event_mode_and_not_before(self) -> None:
        arguments = with_effects(self.EFFECTS)
        with Instance3("ModelExchange", **arguments).start().continuous() as instance:
            for edge, beyond in ((0.25, 0.3), (0.5, 0.6)):
                instance.do("SetTime", c_double(np.nextafter(edge, 0.0)))
                before = instance.derivatives()
                # A solver may try what lies beyond.
                for time in (edge, beyond, edge):
                    instance.do("SetTime", c_double(time))
                    self.assertEqual(bits(instance.derivatives()), bits(before))
                    self.assertEqual(instance.get(["time"]), [time])
                goes_on = Instance3("ModelExchange", **arguments)
                with goes_on.take_over(instance.serialize()):
                    self.assertEqual(bits(goes_on.derivatives()), bits(before))
                instance.do("EnterEventMode")
                behind = instance.derivatives()
                self.assertGreater(abs(behind[3] - before[3]), 0.5)
                instance.continuous()
                self.assertEqual(bits(instance.derivatives()), bits(behind))

    def test_steps_land_on_the_edges_themselves(self) -> None:
        arguments = with_effects(self.EFFECTS)
        two = {"guid": arguments["token"], "resources": arguments["resources"]}
        plain, used = Instance3(**arguments), Instance3(events=True, **arguments)
        with Instance(**two) as other, plain, used:
            for instance in (other, plain, used):
                instance.start({"omega_left": 5.0, "omega_right": 5.0})
            self.assertEqual(used.update(), ([False] * 5, 0.0))
            used.do("EnterStepMode")
            for _ in range(4):
                for instance in (other, plain, used):
                    instance.step(0.2)
                used.do("EnterEventMode")
                used.set({"omega_left": 5.0})
                used.update()
                used.do("EnterStepMode")
                self.assertEqual(bits(plain.outputs()), bits(used.outputs()))
                self.assertEqual(bits(plain.get(STATES)), bits(other.get(STATES)))


class Instances(unittest.TestCase):
    """Several instances, reset, logging, arrays that are set."""

    def drive(self, instance: Instance3, number: int) -> list[Sequence[float]]:
        """A drive of its own."""
        values = {"terrain": 1 + number % 4, "omega_left": 3.0 + number, "omega_right": 4.0}
        instance.start(values)
        rows = []
        for size in STEPS:
            instance.step(size)
            rows.append(instance.outputs())
        return rows

    def test_instances_do_not_know_of_each_other(self) -> None:
        alone = []
        for number in range(8):
            with Instance3() as instance:
                alone.append(self.drive(instance, number))
        self.assertEqual(len({str(rows) for rows in alone}), 8)
        instances = [Instance3().start(self.values(number)) for number in range(8)]
        for index, size in enumerate(STEPS):
            for number, instance in enumerate(instances):
                instance.step(size)
                self.assertEqual(instance.outputs(), alone[number][index])
        for instance in instances:
            instance.free()

    def values(self, number: int) -> dict[str, float]:
        """Start values of a drive."""
        return {"terrain": 1 + number % 4, "omega_left": 3.0 + number, "omega_right": 4.0}

    def test_a_reset_instance_is_like_a_new_one(self) -> None:
        with Instance3() as fresh, Instance3() as used:
            self.drive(used, 1)
            used.do("Reset")
            self.assertEqual(self.drive(used, 2), self.drive(fresh, 2))

    def test_arrays_are_set_as_a_whole(self) -> None:
        rows = [0.95, 0.31, -0.3, -0.91]
        scalars = dict(zip(fmi3().scalars("vehicle.row_positions"), rows, strict=True))
        common = {"omega_left": 4.0, "omega_right": 5.0}
        one = Instance3().start(common | {"vehicle.row_positions": rows})
        with one, Instance().start(common | scalars) as other:
            self.assertEqual(one.get(["vehicle.row_positions"]), rows)
            for instance in (one, other):
                instance.step(0.3)
            loads = fmi3().scalars("wheel.load")
            self.assertEqual(bits(one.get(["wheel.load"])), bits(other.get(loads)))

    def test_start_values_are_there_before_the_initialization(self) -> None:
        with Instance3() as instance:
            self.assertEqual(instance.get(["omega_left", "vehicle.half_track"]), [0.0, 0.61])
            self.assertEqual(len(instance.get(["vehicle.row_positions"])), 4)
            for name in ("x", "wheel.load", "der(v_x)", "time"):
                with self.assertRaisesRegex(Failed, "has no value before the initialization"):
                    instance.get([name])

    def test_what_is_logged_is_what_was_asked_for(self) -> None:
        def told(logging: bool, *named: bytes) -> list[str]:
            with Instance3(logging=logging, environment=0x1234) as instance:
                if named:
                    array = (c_char_p * len(named))(*named)
                    instance.do("SetDebugLogging", 1, c_size_t(len(named)), array)
                instance.call("ExitInitializationMode")
                instance.start().do("Terminate")
                self.assertTrue(all(m.environment == 0x1234 for m in instance.messages))
                return [message.category for message in instance.messages]

        self.assertEqual(told(False), ["logStatusError"])
        self.assertEqual(told(True), ["logStatusError", "logEvents"])
        self.assertEqual(told(False, b"logEvents"), ["logStatusError", "logEvents"])
        self.assertEqual(told(False, b"logStatusError"), ["logStatusError"])
        with Instance3() as instance, self.assertRaisesRegex(Failed, "the log categories are"):
            instance.do("SetDebugLogging", 1, c_size_t(1), (c_char_p * 1)(b"logAll"))


if __name__ == "__main__":
    unittest.main()
