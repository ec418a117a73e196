"""Directional derivatives, derivatives of outputs, derivatives of inputs."""

import itertools
import unittest
from typing import ClassVar

import numpy as np
from fmpy.fmi2 import fmi2Discard, fmi2Error
from fmu_support import INPUTS, RATES, STATES, Failed, Instance, fmu, model_exchange

# Central differences: the difference's own error grows with the square of the step, the noise of
# the balance (below 1e-12 of a value) with its inverse; 1e-5 is about where they meet.
STEP = 1e-5
# What is left of both, as a share of the derivative and of the value itself.
RELATIVE_TOLERANCE = 1e-5
VALUE_TOLERANCE = 1e-6

# x, y, heading, v_x, v_y, yaw_rate; omega_left, omega_right: driving, braking, turning on the spot,
# reversing, and nearly at rest (where forces are regularised, but smooth).
POINTS = [
    ([0.0, 0.0, 0.3, 1.1, 0.02, 0.1], [4.0, 5.0]),
    ([5.0, -2.0, -2.0, 2.0, -0.1, -0.3], [6.0, 3.0]),
    ([0.0, 0.0, 1.0, 0.01, 0.03, 0.6], [-3.0, 3.0]),
    ([0.0, 0.0, 3.0, -0.8, 0.01, 0.05], [-3.5, -3.0]),
    ([0.0, 0.0, 0.0, 0.002, 0.001, 0.003], [0.02, 0.01]),
]

# A slope and a boundary across the points; and what else changes masses and forces.
EFFECTS = [
    {
        "effects.grade.slope_east": 0.06,
        "effects.grade.slope_north": -0.1,
        "effects.terrain_change.stiffness_factor": 0.5,
        "effects.terrain_change.friction_factor": 1.3,
        "effects.terrain_change.direction": 0.4,
        "effects.terrain_change.transition": 3.0,
    },
    {
        "effects.left_right_soil.ratio": 1.3,
        "effects.payload.mass": 80.0,
        "effects.payload.left": 0.2,
        "effects.drawbar.force": 150.0,
        "effects.slip_sinkage.sinkage_growth": 0.4,
    },
]


class Directional(unittest.TestCase):
    """fmi2GetDirectionalDerivative."""

    def values(self, instance: Instance, point: np.ndarray) -> np.ndarray:
        """Everything that can be derived, at a state and wheel speeds."""
        instance.set_states(list(point[: len(STATES)]))
        instance.set(dict(zip(INPUTS, point[len(STATES) :], strict=True)))
        return np.array(instance.get(self.unknowns))

    def setUp(self) -> None:
        self.unknowns = [*RATES, *fmu().outputs]
        self.knowns = [*STATES, *INPUTS]

    def compare(self, start: dict[str, float], states: list[float], speeds: list[float]) -> None:
        """Compares the derivatives at a point with differences."""
        with model_exchange(start) as instance:
            point = np.array(states + speeds)
            nearby = 0.1 if abs(states[3]) < 0.01 else 1.0
            for index, known in enumerate(self.knowns):
                step = STEP * nearby * np.eye(len(point))[index]
                differences = self.values(instance, point + step)
                differences -= self.values(instance, point - step)
                differences /= 2.0 * STEP * nearby
                values = self.values(instance, point)
                exact = np.array(instance.directional(self.unknowns, [known], [1.0]))
                allowed = RELATIVE_TOLERANCE * np.abs(exact).max()
                allowed = allowed + VALUE_TOLERANCE * np.abs(values)
                worst = np.argmax(np.abs(exact - differences) - allowed)
                with self.subTest(start=start, point=point, known=known):
                    self.assertLessEqual(
                        abs(exact[worst] - differences[worst]),
                        allowed[worst],
                        f"{self.unknowns[worst]}: {exact[worst]}, {differences[worst]}",
                    )

    def test_they_are_the_limit_of_differences(self) -> None:
        for terrain, (states, speeds) in itertools.product(range(1, 5), POINTS):
            self.compare({"terrain": terrain}, states, speeds)

    def test_with_effects_they_are_so_too_by_place_and_heading(self) -> None:
        for effects, (states, speeds) in itertools.product(EFFECTS, POINTS):
            self.compare(effects, states, speeds)
        with model_exchange(EFFECTS[0]) as instance:
            states, speeds = POINTS[0]
            self.values(instance, np.array(states + speeds))
            for known in ("x", "y", "heading"):
                (change,) = instance.directional(["a_x"], [known], [1.0])
                self.assertGreater(abs(change), 1e-3, known)

    def test_they_are_linear_in_the_seeds(self) -> None:
        states, speeds = POINTS[1]
        seeds = [0.5, -1.0, 2.0, 0.25, -0.125, 4.0, 1.0, -2.0]
        with model_exchange() as instance:
            self.values(instance, np.array(states + speeds))
            each = [instance.directional(self.unknowns, [name], [1.0]) for name in self.knowns]
            together = instance.directional(self.unknowns, self.knowns, seeds)
            expected = np.array(seeds) @ np.array(each)
            # Sums in another order.
            scale = np.abs(np.array(seeds)) @ np.abs(np.array(each))
            np.testing.assert_array_less(np.abs(together - expected), 1e-12 * scale + 1e-300)
            # A known that is named twice counts twice.
            twice = instance.directional(self.unknowns, ["v_x", "v_x"], [1.0, 2.0])
            np.testing.assert_allclose(twice, 3.0 * np.array(each[3]), rtol=1e-12)
            self.assertEqual(instance.directional([], [], []), [])
            self.assertEqual(instance.directional(["a_x", "v_x"], [], []), [0.0, 0.0])

    def test_they_agree_with_the_dependencies_in_the_model_description(self) -> None:
        structure = [*fmu().description.outputs, *fmu().description.derivatives]
        self.assertEqual({each.variable.name for each in structure}, set(self.unknowns))
        found = []
        for states, speeds in POINTS[:2]:
            with model_exchange() as instance:
                self.values(instance, np.array(states + speeds))
                columns = [instance.directional(self.unknowns, [k], [1.0]) for k in self.knowns]
                rows = zip(self.unknowns, zip(*columns, strict=True), strict=True)
                found.append({name: dict(zip(self.knowns, row, strict=True)) for name, row in rows})
        one, other = found
        for each in structure:
            name = each.variable.name
            kinds = {
                known.name: kind
                for known, kind in zip(each.dependencies, each.dependenciesKind, strict=True)
            }
            for known in self.knowns:
                with self.subTest(name, known=known):
                    if known not in kinds:
                        self.assertEqual((one[name][known], other[name][known]), (0.0, 0.0))
                    elif kinds[known] == "constant":
                        self.assertEqual(one[name][known], other[name][known])

    def test_they_are_the_same_in_co_simulation(self) -> None:
        states, speeds = POINTS[0]
        initial = {f"initial.{name}": value for name, value in zip(STATES, states, strict=True)}
        speeds = dict(zip(INPUTS, speeds, strict=True))
        with model_exchange(speeds) as one, Instance().start(initial | speeds) as other:
            one.set_states(states)
            for known in self.knowns:
                np.testing.assert_allclose(
                    other.directional(self.unknowns, [known], [1.0]),
                    one.directional(self.unknowns, [known], [1.0]),
                    # The same point, but for the first guess.
                    rtol=1e-9,
                    atol=1e-9,
                )

    def test_what_is_no_unknown_or_known_is_refused(self) -> None:
        with model_exchange() as instance:
            for unknown, known, reason in (
                ("omega_left", "x", "is neither an output nor a state derivative"),
                ("vehicle.mass", "x", "is neither an output nor a state derivative"),
                ("a_x", "a_y", "is neither an input nor a state"),
                ("a_x", "vehicle.mass", "is neither an input nor a state"),
                ("a_x", "terrain", "is of type Enumeration"),
            ):
                with self.assertRaisesRegex(Failed, reason):
                    instance.directional([unknown], [known], [1.0])
            with self.assertRaisesRegex(Failed, "a seed cannot be NaN"):
                instance.directional(["a_x"], ["v_x"], [float("nan")])
            with self.assertRaisesRegex(Failed, "derivative at value reference .* is not finite"):
                instance.directional(["wheel[1].force_x"], ["v_x"], [1.7e308])


class Initial(unittest.TestCase):
    """fmi2GetDirectionalDerivative before the initialization ends: states are unknowns."""

    UNKNOWNS = (*STATES, "a_x", "der(v_y)", "der(yaw_rate)", "wheel[1].force_x")

    def starting(self, values: dict[str, float]) -> Instance:
        """An instance in initialization mode."""
        instance = Instance(logging=True)
        self.addCleanup(instance.free)
        instance.set({"omega_left": 4.0, "omega_right": 5.0} | values)
        instance.setup()
        instance.do("EnterInitializationMode")
        return instance

    def test_they_are_the_limit_of_differences(self) -> None:
        driving = dict(zip((f"initial.{state}" for state in STATES), POINTS[0][0], strict=True))
        for values in (driving, {"initial.no_slip": True}):
            instance = self.starting(values)
            for known in (*INPUTS, *(f"initial.{state}" for state in STATES)):
                (middle,) = instance.get([known])
                exact = np.array(instance.directional(self.UNKNOWNS, [known], [1.0]))
                found = []
                for number in (middle + STEP, middle - STEP, middle):
                    instance.set({known: number})
                    found.append(np.array(instance.get(self.UNKNOWNS)))
                differences = (found[0] - found[1]) / (2.0 * STEP)
                # Without slip most initial values do nothing.
                allowed = RELATIVE_TOLERANCE * np.abs(exact).max()
                allowed = allowed + VALUE_TOLERANCE * (1.0 + np.abs(found[2]))
                with self.subTest(values=values, known=known):
                    np.testing.assert_array_less(np.abs(exact - differences), allowed)

    def test_without_slip_the_velocities_follow_from_the_wheels(self) -> None:
        instance = self.starting({"initial.no_slip": True})
        radius, track = instance.get(["vehicle.wheel_radius", "vehicle.half_track"])
        for known, turn in (("omega_left", -1.0), ("omega_right", 1.0)):
            found = instance.directional(("v_x", "v_y", "yaw_rate"), [known], [1.0])
            np.testing.assert_allclose(
                found, [radius / 2.0, 0.0, turn * radius / (2.0 * track)], rtol=1e-15
            )

    def test_states_are_not_known_and_other_parameters_are_not_available(self) -> None:
        instance = self.starting({})
        for known, status, reason in (
            ("v_x", fmi2Error, "is neither an input nor an initial value"),
            ("vehicle.mass", fmi2Discard, "no derivatives by the parameter"),
            ("effects.grade.slope_east", fmi2Discard, "no derivatives by the parameter"),
        ):
            with self.assertRaisesRegex(Failed, reason) as failed:
                instance.directional(["a_x"], [known], [1.0])
            self.assertEqual(failed.exception.status, status)
        instance.do("ExitInitializationMode")
        instance.directional(["a_x"], ["v_x"], [1.0])
        with self.assertRaisesRegex(Failed, "is neither an input nor a state"):
            instance.directional(["a_x"], ["initial.v_x"], [1.0])


class OutputDerivatives(unittest.TestCase):
    """fmi2GetRealOutputDerivatives."""

    # Two short steps, from the middle of which the derivative is asked; the integrator's own error
    # in them is far below its tolerance, but not zero: a step without an evaluation of the forces goes on by the
    # derivatives of the last one, and errs by so many m/s^2.
    SECONDS = 1e-3
    TOLERANCE = 2e-3
    LINEAR = 5e-5

    def test_they_are_the_limit_of_differences(self) -> None:
        for terrain in range(1, 5):
            values = {"terrain": terrain, "omega_left": 6.0, "omega_right": 4.0}
            with self.subTest(terrain=terrain), Instance().start(values) as instance:
                # On the way to speed, but past the start.
                instance.step(0.2)
                # The forces at the end of a step are those of a state beside it, the more so the longer it was.
                instance.step(self.SECONDS)
                before = np.array(instance.outputs())
                instance.step(self.SECONDS)
                middle = np.array(instance.outputs())
                exact = np.array(instance.output_derivatives(fmu().outputs))
                instance.step(self.SECONDS)
                differences = (np.array(instance.outputs()) - before) / (2.0 * self.SECONDS)
                # Shares of how fast a quantity changes, and of the quantity within a second.
                allowed = self.TOLERANCE * (np.abs(exact) + np.abs(middle)) + self.LINEAR
                for name, one, other, limit in zip(
                    fmu().outputs, exact, differences, allowed, strict=True
                ):
                    self.assertLessEqual(abs(one - other), limit, f"{name}: {one}, {other}")

    def test_those_of_the_states_are_their_rates(self) -> None:
        with Instance().start({"omega_left": 6.0, "omega_right": 4.0}) as instance:
            instance.step(0.2)
            self.assertEqual(instance.output_derivatives(STATES), instance.get(RATES))

    def test_only_outputs_have_them_and_only_the_first(self) -> None:
        with Instance().start() as instance:
            for order in (0, -1):
                with self.assertRaisesRegex(Failed, f"are of order 1, not {order}"):
                    instance.output_derivatives(["x"], order)
            # What the standard has read as zero.
            self.assertEqual(instance.output_derivatives(["a_x"], 2), [0.0])
            for name in ("omega_left", "vehicle.mass"):
                with self.assertRaisesRegex(Failed, "neither an output nor a state derivative"):
                    instance.output_derivatives([name])


class InputDerivatives(unittest.TestCase):
    """fmi2SetRealInputDerivatives: inputs that are linear within a step."""

    RATES = (3.0, -2.0)
    START: ClassVar = {"omega_left": 4.0, "omega_right": 6.0, "initial.no_slip": True}
    # The error control's tolerances [m, rad, m/s], as in test_fmu_interfaces.
    TOLERANCES = (1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3)

    def drive(self, steps: int, constant: bool) -> tuple[list[float], list[float]]:
        """States and inputs after half a second of wheel speeds along `RATES`."""
        with Instance().start(self.START) as instance:
            size = 0.5 / steps
            for index in range(steps):
                if constant:
                    # The mean over the step.
                    time = (index + 0.5) * size
                    speeds = {"omega_left": 4.0 + 3.0 * time, "omega_right": 6.0 - 2.0 * time}
                    instance.set(speeds)
                else:
                    instance.set_input_derivatives(self.RATES)
                instance.step(size)
            return instance.get(STATES), instance.get(INPUTS)

    def test_inputs_are_linear_within_a_step(self) -> None:
        fine, _ = self.drive(2000, constant=True)
        coarse, _ = self.drive(1, constant=True)
        for steps in (1, 4, 50):
            states, speeds = self.drive(steps, constant=False)
            for name, one, other, limit in zip(STATES, states, fine, self.TOLERANCES, strict=True):
                self.assertAlmostEqual(one, other, delta=limit, msg=f"{name}, {steps} steps")
            np.testing.assert_allclose(speeds, [5.5, 5.0], rtol=1e-14)
        # One step with the mean speeds is no substitute.
        self.assertGreater(abs(coarse[2] - fine[2]), 10.0 * self.TOLERANCES[2])

    def test_they_serve_for_one_step(self) -> None:
        with Instance().start(self.START) as instance:
            instance.set_input_derivatives(self.RATES)
            instance.step(0.5)
            instance.step(0.5)
            self.assertEqual(instance.get(INPUTS), [5.5, 5.0])

    def test_a_refused_step_leaves_them_for_the_next(self) -> None:
        with Instance().start(self.START) as instance:
            instance.set_input_derivatives(self.RATES)
            with self.assertRaises(Failed):
                instance.step(-1.0)
            instance.time = 0.0
            instance.step(0.5)
            self.assertEqual(instance.get(INPUTS), [5.5, 5.0])

    def test_what_is_no_input_derivative_is_refused(self) -> None:
        with Instance().start(self.START) as instance:
            with self.assertRaisesRegex(Failed, "are of order 1, not 0"):
                instance.set_input_derivatives(self.RATES, order=0)
            # Those of higher orders are left out, with a warning.
            instance.messages.clear()
            instance.set_input_derivatives((0.0, 0.0), order=2)
            self.assertEqual(instance.messages, [])
            instance.set_input_derivatives(self.RATES, order=2)
            self.assertIn("of order 2 is ignored", instance.messages[0].text)
            with self.assertRaisesRegex(Failed, "cannot be NaN"):
                instance.set_input_derivatives((1.0, float("nan")))
            instance.step(0.5)
            self.assertEqual(instance.get(INPUTS), [4.0, 6.0])


if __name__ == "__main__":
    unittest.main()
