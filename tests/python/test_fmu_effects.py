"""Effects: their parameters, the file that switches them on, and states of their own."""

import json
import unittest
from ctypes import byref, c_double, c_size_t, c_uint
from pathlib import Path

import numpy as np
from fmpy.fmi2 import fmi2ModelExchange
from fmu_support import (
    Failed,
    Instance,
    fmu,
    guid_of,
    model_exchange,
    refusal,
    resources,
)

SPEEDS = {"omega_left": 5.0, "omega_right": 6.5}
SLOPES = {"over": "time", "points": [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [3.0, -0.1, 0.05]]}
REMEMBERING = {
    "format": "ugv-effects/1",
    "grade": {"profile": SLOPES},
    "multipass": {"memory": 1.0},
    "transient_shear": {"relaxation": 1.0},
}
# Parameters that say how an effect acts which another one switches on.
SHAPES = {
    "terrain_change": {"position", "direction", "transition"},
    "bulldozing": {"unit_weight"},
    "drawbar": {"hitch_behind", "hitch_height"},
    "payload": {"ahead", "left", "height"},
}
# The first parameter of the sixth effect, which the plain FMU does not have.
MULTIPASS = 500 + 16 * 5


def with_effects(effects: dict) -> dict[str, str]:
    """Arguments of an instance whose resources have these effects."""

    def change(folder: Path) -> None:
        (folder / "effects.json").write_text(json.dumps(effects))

    folder = resources(change)
    return {"guid": guid_of(folder), "resources": folder.as_uri()}


def driven(values: dict[str, float]) -> list[float]:
    """Outputs after half a second."""
    with Instance().start(SPEEDS | values) as instance:
        instance.step(0.5)
        return instance.outputs()


class Parameters(unittest.TestCase):
    """`effects.*`."""

    def test_each_of_them_changes_the_drive_and_at_its_start_value_does_not(self) -> None:
        plain = driven({})
        effects = {
            name: variable
            for name, variable in fmu().variables.items()
            if name.startswith("effects.")
        }
        self.assertGreater(len(effects), 30)
        for name in effects:
            start = float(effects[name].start)
            self.assertEqual(driven({name: start}), plain, name)
        for name, variable in effects.items():
            start, low, high = (float(number) for number in (variable.start, variable.min, variable.max))
            far = start + 0.05 * ((high if start < high else low) - start)
            # A tyre of nearly 2 MPa is as rigid as none.
            value = 6e4 if name.endswith("pressure") else far
            _, effect, parameter = name.split(".")
            self.assertEqual(driven({name: value}) == plain, parameter in SHAPES.get(effect, ()), name)

    def test_a_slope_pulls_downhill(self) -> None:
        """Standing wheels hold it but for a creep of the regularisation."""
        with Instance() as instance:
            instance.start({"effects.grade.slope_east": 0.1, "effects.grade.slope_north": 0.05})
            pull = [-9.81 * slope for slope in (0.1, 0.05)]
            np.testing.assert_allclose(instance.get(["a_x", "a_y"]), pull, rtol=0.02)

    def test_a_value_out_of_range_is_refused_at_once_and_changes_nothing(self) -> None:
        with Instance() as instance:
            for value in (0.31, -0.31):
                with self.assertRaises(Failed) as failed:
                    instance.set({"effects.grade.slope_east": value})
                expected = f"grade.slope_east = {value} rad is outside its range [-0.3, 0.3] rad"
                self.assertIn(expected, failed.exception.text)
            instance.start(SPEEDS)
            instance.step(0.5)
            self.assertEqual(instance.outputs(), driven({}))

    def test_effects_that_remember_are_no_variables_while_off(self) -> None:
        self.assertNotIn("effects.multipass.memory", fmu().variables)
        with Instance() as instance, self.assertRaisesRegex(Failed, "there is no variable"):
            value = c_double(1.0)
            instance.do("SetReal", byref(c_uint(MULTIPASS)), c_size_t(1), byref(value))


class File(unittest.TestCase):
    """`effects.json` in the resources."""

    def test_a_wrong_file_is_named_with_what_is_wrong(self) -> None:
        for content, expected in (
            ("{", "resources/effects.json: "),
            ('{"grad": {}}', "the nearest known one is `grade`"),
            ('{"drag": {"coefficient": -1}}', "drag.coefficient = -1 N s^2/m^2 is outside"),
        ):
            folder = resources(lambda folder: (folder / "effects.json").write_text(content))  # noqa: B023
            complaint = refusal(resources=folder.as_uri())
            self.assertIn("resources/effects.json", complaint)
            self.assertIn(expected, complaint)

    def test_a_profile_over_time_counts_from_the_start_time_given(self) -> None:
        arguments = with_effects({"grade": {"profile": SLOPES}})
        for time, slope in ((0.0, 0.0), (0.25, 0.05), (0.5, 0.1)):
            for of_kind in ({}, {"kind": fmi2ModelExchange}):
                with Instance(**arguments, **of_kind).start({}, time) as instance:
                    self.assertAlmostEqual(instance.get(["a_x"])[0], -9.81 * slope, delta=0.01)


class Remembering(unittest.TestCase):
    """Effects with states of their own."""

    def test_there_is_no_model_exchange(self) -> None:
        arguments = with_effects(REMEMBERING)
        complaint = refusal(kind=fmi2ModelExchange, **arguments)
        self.assertIn("supports co-simulation only: with multipass, transient_shear", complaint)
        with Instance(**arguments).start(SPEEDS) as instance:
            instance.step(0.5)
            self.assertNotEqual(instance.outputs(), driven({}))
            state = instance.save()
            with Instance() as other, self.assertRaisesRegex(Failed, "with other effects"):
                other.restore(state)
            instance.free_state(state)
        # Where nothing but parameters differ, and before the initialization, when the modes of both
        # interfaces are the same.
        with Instance(**with_effects({"multipass": {"memory": 1.0}})) as early:
            state = early.save()
            with model_exchange() as other, self.assertRaisesRegex(Failed, "the other interface"):
                other.restore(state)
            early.free_state(state)

    def test_a_window_on_the_map_has_no_model_exchange(self) -> None:
        drag = {"drag": {"coefficient": 30.0}}
        place = {"effects": ["drag"], "place": {"x": 1.0, "y": 0.0, "radius": 2.0}}
        arguments = with_effects(drag | {"window": place})
        complaint = refusal(kind=fmi2ModelExchange, **arguments)
        self.assertIn("supports co-simulation only: with a window on the map", complaint)
        with Instance(**arguments).start(SPEEDS) as instance:
            instance.step(0.5)
        # One in time is told as time events.
        arguments = with_effects(drag | {"window": {"effects": ["drag"], "time": [1.0, 2.0]}})
        with Instance(fmi2ModelExchange, **arguments) as instance:
            self.assertIsNotNone(instance.handle)

    def test_a_state_goes_with_what_is_remembered(self) -> None:
        arguments = with_effects(REMEMBERING)
        with Instance(**arguments).start(SPEEDS) as one, Instance(**arguments) as other:
            one.step(0.6)
            state = other.deserialize(one.serialize())
            other.restore(state)
            other.free_state(state)
            other.time = one.time
            for size in (0.01, 0.3):
                one.step(size)
                other.step(size)
                self.assertEqual(one.outputs(), other.outputs())

    def test_output_derivatives_know_the_time_and_what_is_remembered(self) -> None:
        # The forces at the end of a short step are those of a state some 1e-8 beside: 1e-5 in a difference over 2 ms.
        seconds, tolerance, beside = 1e-3, 2e-3, 3e-5
        place = {"grade": {"profile": {"over": "distance", "points": [[0, 0, 0], [3, 0.1, 0.1]]}}}
        for effects in (REMEMBERING, place):
            arguments = with_effects(effects)
            with Instance(**arguments).start(SPEEDS) as instance:
                instance.step(0.2)
                # The forces at the end of a step are those of a state beside it, the more so the longer it was.
                instance.step(seconds)
                before = np.array(instance.outputs())
                instance.step(seconds)
                middle = np.array(instance.outputs())
                exact = np.array(instance.output_derivatives(fmu().outputs))
                instance.step(seconds)
                differences = (np.array(instance.outputs()) - before) / (2.0 * seconds)
                allowed = tolerance * (np.abs(exact) + np.abs(middle)) + beside
                for name, one, other, limit in zip(
                    fmu().outputs, exact, differences, allowed, strict=True
                ):
                    self.assertLessEqual(abs(one - other), limit, f"{name}: {one}, {other}")


if __name__ == "__main__":
    unittest.main()
