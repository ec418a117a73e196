"""Start values, terrains, parameters that are refused, start and stop time."""

import json
import unittest
from ctypes import c_double, c_int, c_uint

from fmpy.fmi2 import fmi2OK
from fmu_support import INPUTS, STATES, TERRAINS, Failed, Instance, fmu

# r and 2 B of the vehicle that the FMU is packaged with.
VEHICLE = json.loads((fmu().folder / "resources" / "vehicle.json").read_text())
SOILS = json.loads((fmu().folder / "resources" / "terrains.json").read_text())
SPEEDS = {"omega_left": 4.0, "omega_right": 6.0}


def driven(values: dict[str, float], late: dict[str, float] | None = None) -> list[float]:
    """Outputs after a few steps with values set before, and `late` ones in initialization."""
    with Instance() as instance:
        instance.set(values)
        instance.setup()
        instance.do("EnterInitializationMode")
        instance.set(late or {})
        instance.do("ExitInitializationMode")
        outputs = instance.outputs()
        for _ in range(5):
            instance.step(0.02)
        return outputs + instance.outputs()


class StartValues(unittest.TestCase):
    """Values set before the simulation starts."""

    def test_values_start_as_described(self) -> None:
        starts = {
            name: float(variable.start)
            for name, variable in fmu().variables.items()
            if variable.start is not None and variable.type == "Real"
        }
        self.assertGreater(len(starts), 20)
        with Instance().start() as instance:
            values = instance.get(list(starts))
            self.assertEqual(dict(zip(starts, values, strict=True)), starts)
            kind, yes = c_int(), c_int(1)
            for function, name, value in (
                ("GetInteger", "terrain", kind),
                ("GetBoolean", "initial.no_slip", yes),
            ):
                (reference,) = fmu().references([name])
                instance.do(function, (c_uint * 1)(reference), 1, (c_int * 1).from_buffer(value))
            self.assertEqual(kind.value, int(fmu().variables["terrain"].start))
            self.assertEqual(yes.value, 0)

    def test_values_count_before_and_in_initialization_mode(self) -> None:
        pose = {"initial.x": 3.0, "initial.heading": 1.0, "initial.v_x": 0.7}
        values = SPEEDS | pose | {"terrain": 1, "vehicle.mass": 400.0}
        early, late = driven(values), driven({}, values)
        self.assertEqual(early, late)
        self.assertEqual(early[:4], [3.0, 0.0, 1.0, 0.7])
        for name in values:
            left_out = {key: value for key, value in values.items() if key != name}
            self.assertNotEqual(driven(left_out), early, name)
        self.assertEqual(driven({"vehicle.mass": 300.0, "terrain": 2}, values), early)

    def test_reading_in_between_changes_nothing(self) -> None:
        values = SPEEDS | {"terrain": 1, "initial.no_slip": True}
        for names in (list(values), list(reversed(values))):
            with self.subTest(names), Instance() as instance:
                instance.setup()
                instance.do("EnterInitializationMode")
                for name in names:
                    instance.outputs()
                    instance.set({name: values[name]})
                instance.do("ExitInitializationMode")
                read = instance.outputs()
                self.assertEqual(read, driven(values)[: len(read)])

    def test_no_slip_starts_at_the_rolling_velocities(self) -> None:
        values = {"initial.no_slip": True, "initial.v_x": 9.0, "initial.y": 2.0}
        radius, track = VEHICLE["wheel_radius"], 2.0 * VEHICLE["half_track"]
        for early, late in (({}, SPEEDS), (SPEEDS, {})):
            states = driven(values | early, late)[: len(STATES)]
            ahead, turn = radius * (4.0 + 6.0) / 2.0, radius * (6.0 - 4.0) / track
            self.assertEqual(states, [0.0, 2.0, 0.0, ahead, 0.0, turn])
        # Later wheel speeds change the velocities no more.
        with Instance().start(values | SPEEDS) as instance:
            instance.set({"omega_left": 0.0})
            self.assertEqual(instance.get(["v_x", "yaw_rate"]), [ahead, turn])

    def test_each_terrain_is_its_soil(self) -> None:
        seen = []
        for name, soil in SOILS.items():
            outputs = driven(SPEEDS | {"terrain": TERRAINS[name]})
            custom = {f"soil.{key}": value for key, value in soil.items()}
            self.assertEqual(driven(SPEEDS | {"terrain": 5} | custom), outputs, name)
            # The soil's parameters are the custom terrain's alone.
            self.assertEqual(
                driven(SPEEDS | {"terrain": TERRAINS[name], "soil.cohesion": 9.0}), outputs
            )
            self.assertNotIn(outputs, seen)
            seen.append(outputs)
        self.assertEqual(len(seen), 4)

    def test_terrains_beyond_the_enumeration_are_refused(self) -> None:
        with Instance() as instance:
            for number in (0, 6, -1):
                with self.assertRaisesRegex(Failed, f"terrain {number} is not one of 1 to 5"):
                    instance.set({"terrain": number})


class BadParameters(unittest.TestCase):
    """Values that describe no vehicle or soil."""

    def test_a_bad_parameter_is_named_with_value_unit_and_range(self) -> None:
        for name, value, expected in (
            ("vehicle.mass", -1.0, "mass = -1 kg is outside its range (0, 10000000] kg"),
            ("vehicle.mass", 0.0, "mass = 0 kg is outside its range (0, 10000000] kg"),
            ("vehicle.yaw_inertia", 0.0, "yaw_inertia = 0 kg m^2"),
            (
                "vehicle.wheel_radius",
                -0.25,
                "wheel_radius = -0.25 m is outside its range (0, 10] m",
            ),
            ("vehicle.wheel_width", 2.0, "wheel_width = 2 m is outside its range (0, 1.22] m"),
            ("vehicle.half_track", 21.0, "half_track = 21 m is outside its range (0, 20] m"),
            ("vehicle.com_offset", 3.0, "com_offset = 3 m is outside its range (-0.915, 0.915) m"),
            ("vehicle.com_height", -0.1, "com_height = -0.1 m is outside its range [0, 20] m"),
            ("vehicle.row_positions[2]", 1.0, "row_positions = 1 m is outside its range"),
            ("soil.cohesion", -1.0, "cohesion = -1 Pa is outside its range [0, 100000000] Pa"),
            ("soil.friction_angle_deg", 90.0, "friction_angle_deg = 90 deg is outside its range"),
            ("soil.sinkage_exponent", 0.0, "sinkage_exponent = 0 is outside its range (0, 3]"),
            ("soil.shear_modulus", 0.0, "shear_modulus = 0 m is outside its range (0, 1] m"),
        ):
            with self.subTest(name), Instance() as instance:
                with self.assertRaises(Failed) as failed:
                    instance.start({"terrain": 5, name: value})
                self.assertIn(expected, failed.exception.text)
                self.assertEqual(instance.messages[-1].category, "logStatusError")
                # Back to the values that it came with.
                instance.do("Reset")
                instance.start(SPEEDS).step(0.01)

    def test_a_bogged_vehicle_is_an_error_and_reset_frees_it(self) -> None:
        mud = {"terrain": 5, "soil.frictional_modulus": 2e4, "soil.cohesive_modulus": 0.0}
        with Instance() as instance:
            with self.assertRaisesRegex(Failed, "bogged: wheel 1 sinks to its axle"):
                instance.start(mud)
            with self.assertRaisesRegex(Failed, "fmi2DoStep is not allowed after an error"):
                instance.step(0.01)
            instance.do("Reset")
            instance.start(SPEEDS)
            outputs = instance.outputs()
            for _ in range(5):
                instance.step(0.02)
            self.assertEqual(outputs + instance.outputs(), driven(SPEEDS))

    def test_forces_that_do_not_exist_are_an_error(self) -> None:
        with Instance().start(SPEEDS) as instance:
            instance.step(0.02)
            instance.set({"omega_left": 1e200})
            with self.assertRaises(Failed) as failed:
                instance.step(0.02)
            self.assertIn("at 0.02 s", failed.exception.text)
            # What was reached can be asked for: the step did not begin.
            self.assertGreater(instance.get(["x"])[0], 0.0)
            instance.do("Reset")
            instance.start(SPEEDS).step(0.02)


class Times(unittest.TestCase):
    """Communication points, start and stop time."""

    def test_a_start_time_shifts_nothing_but_the_time(self) -> None:
        outputs = []
        for time in (0.0, -7.0, 512.0):
            with Instance().start(SPEEDS, time) as instance:
                for _ in range(8):
                    instance.step(1.0 / 64.0)
                value = c_double()
                instance.do("GetRealStatus", 2, (c_double * 1).from_buffer(value))
                self.assertEqual(value.value, time + 0.125)
                outputs.append(instance.outputs())
        self.assertEqual(outputs[0], outputs[1])
        self.assertEqual(outputs[0], outputs[2])

    def test_the_last_step_may_be_off_by_rounding(self) -> None:
        for steps, size, stop in (
            (10, 0.1, 1.0),
            (100, 0.009999999999999995, 1.0),
            (3, 0.1, 0.3),
            (1, 0.30000000000000004, 0.3),
            (7, 0.1 + 1e-9, 0.7),
        ):
            with self.subTest(size=size), Instance().start(SPEEDS, 0.0, stop) as instance:
                for index in range(steps):
                    # As importers count: the point is the product, not the sum.
                    instance.time = index * size
                    instance.step(size)

    def test_a_step_past_the_stop_time_is_refused(self) -> None:
        with Instance().start(SPEEDS, 0.0, 0.3) as instance:
            instance.step(0.2)
            with self.assertRaisesRegex(Failed, "a step to 0.4 s passes the stop time 0.3 s"):
                instance.step(0.2)
            instance.step(0.1)
            with self.assertRaisesRegex(Failed, "passes the stop time"):
                instance.step(1e-3)

    def test_without_a_stop_time_there_is_no_end(self) -> None:
        with Instance() as instance:
            instance.do("SetupExperiment", 0, c_double(0), c_double(0), 0, c_double(0.5))
            instance.do("EnterInitializationMode")
            instance.do("ExitInitializationMode")
            instance.step(1.0)

    def test_times_that_make_no_sense_are_refused(self) -> None:
        nan, infinity = float("nan"), float("inf")
        for start, stop in ((nan, 1.0), (infinity, None), (1.0, 0.5), (0.0, nan)):
            refused = self.assertRaisesRegex(Failed, "(start|stop) time")
            with self.subTest(start=start, stop=stop), Instance() as instance, refused:
                instance.setup(start, stop)

    def test_steps_that_make_no_sense_are_refused_and_change_nothing(self) -> None:
        with Instance().start(SPEEDS) as instance, Instance().start(SPEEDS) as other:
            for each in (instance, other):
                each.step(0.1)
            for point, size, reason in (
                (0.1, -0.1, "is not positive"),
                (0.1, 0.0, "is not positive"),
                (0.1, float("nan"), "is not positive"),
                (0.1, float("inf"), "is not positive"),
                (0.1, 1.1e6, "of 1100000 s is longer than 1000000 s"),
                (0.0, 0.1, "is not the current time 0.1 s"),
                (0.2, 0.1, "is not the current time 0.1 s"),
                (float("nan"), 0.1, "is not the current time 0.1 s"),
            ):
                refused = self.assertRaisesRegex(Failed, reason)
                with self.subTest(point=point, size=size), refused:
                    instance.do("DoStep", c_double(point), c_double(size), 1)
            for each in (instance, other):
                each.step(0.1)
            self.assertEqual(instance.outputs(), other.outputs())

    def test_inputs_are_read_as_they_were_set(self) -> None:
        with Instance().start(SPEEDS) as instance:
            self.assertEqual(instance.get(INPUTS), [4.0, 6.0])
            instance.step(0.1)
            instance.set({"omega_left": -2.0})
            self.assertEqual(instance.get(INPUTS), [-2.0, 6.0])
            self.assertEqual(instance.call("Terminate"), fmi2OK)
            self.assertEqual(instance.get(INPUTS), [-2.0, 6.0])


if __name__ == "__main__":
    unittest.main()
