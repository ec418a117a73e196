"""Co-simulation and model exchange are the same model, to fmpy and to CasADi."""

import itertools
import unittest
from ctypes import byref, c_double, c_int, c_size_t

import casadi
import numpy as np
from fmpy import simulate_fmu
from fmpy.fmi2 import fmi2EventInfo, fmi2OK
from fmu_support import INPUTS, RATES, STATES, Instance, fmu, model_exchange

# The co-simulation's error control tolerates 2e-5 m, 1e-5 rad and 1e-4 m/s or rad/s (plus 1e-4 of
# a velocity) in each of its steps, of which these drives take tens; CVode's own error is far below.
POSITION_TOLERANCE = 5e-4
HEADING_TOLERANCE = 3e-4
VELOCITY_TOLERANCE = 1.5e-3
STATE_TOLERANCES = dict(
    zip(
        STATES,
        [POSITION_TOLERANCE] * 2 + [HEADING_TOLERANCE] + [VELOCITY_TOLERANCE] * 3,
        strict=True,
    )
)
# Outputs once the start is over: d(output)/d(velocity) times the velocity's tolerance, as a share
# of the largest value.
OUTPUT_TOLERANCE = 0.03
CVODE_TOLERANCE = 1e-8
# The same code with the same arguments, but for the path that the first guess took.
SAME_POINT_TOLERANCE = 1e-9

# fmpy holds inputs between the communication points without telling CVode of their jumps: drives
# with constant inputs.
DRIVES = [
    {"omega_left": 6.0, "omega_right": 4.5},
    {"omega_left": 8.0, "omega_right": 6.0, "initial.no_slip": True},
    {"omega_left": -3.0, "omega_right": 3.0},
    {"omega_left": 1.0, "omega_right": 2.0, "initial.v_x": 2.0, "initial.yaw_rate": 0.3},
]
SECONDS = 3.0

# A state and wheel speeds to compare at.
STATE = [1.0, -2.0, 0.3, 1.1, 0.02, 0.1]
SPEEDS = [4.0, 5.0]


class Interfaces(unittest.TestCase):
    """Two ways to simulate, one result."""

    def test_cvode_gets_what_the_co_simulation_gets(self) -> None:
        for drive, terrain in itertools.product(DRIVES, range(1, 5)):
            with self.subTest(drive=drive, terrain=terrain):
                common = {
                    "filename": str(fmu().folder),
                    "start_values": {"terrain": terrain, **drive},
                    "output": fmu().outputs,
                    "stop_time": SECONDS,
                    "output_interval": 0.05,
                }
                stepped = simulate_fmu(**common, fmi_type="CoSimulation", step_size=0.01)
                solved = simulate_fmu(
                    **common,
                    fmi_type="ModelExchange",
                    solver="CVode",
                    relative_tolerance=CVODE_TOLERANCE,
                )
                np.testing.assert_allclose(stepped["time"], solved["time"], atol=1e-9)
                for name in fmu().outputs:
                    difference = np.abs(stepped[name] - solved[name])[4:].max()
                    tolerance = STATE_TOLERANCES.get(
                        name, OUTPUT_TOLERANCE * np.abs(solved[name]).max()
                    )
                    self.assertLessEqual(difference, tolerance, name)
                self.assertNotEqual(solved["x"][-1], 0.0)

    def test_casadi_gets_what_the_co_simulation_gets(self) -> None:
        builder = casadi.DaeBuilder("ugv", str(fmu().folder))
        self.assertEqual([str(x) for x in builder.x()], list(STATES))
        self.assertEqual([str(u) for u in builder.u()], list(INPUTS))
        self.assertEqual([str(y) for y in builder.y()], fmu().outputs)
        function = builder.create("f", ["x", "u"], ["ode", "y"])
        x, u = casadi.MX.sym("x", len(STATES)), casadi.MX.sym("u", len(INPUTS))
        dae = {"x": x, "u": u, "ode": function(x, u)[0]}
        times = np.linspace(0.0, SECONDS, 31)
        options = {"reltol": CVODE_TOLERANCE, "abstol": CVODE_TOLERANCE}
        integrator = casadi.integrator("i", "cvodes", dae, 0.0, times[1:], options)
        solution = integrator(x0=STATE, u=casadi.repmat(casadi.DM(SPEEDS), 1, len(times) - 1))
        initial = {f"initial.{name}": value for name, value in zip(STATES, STATE, strict=True)}
        speeds = dict(zip(INPUTS, SPEEDS, strict=True))
        with Instance().start(initial | speeds) as instance:
            for states in np.array(solution["xf"]).T:
                for _ in range(10):
                    instance.step(0.01)
                stepped = instance.get(STATES)
                for name, one, other in zip(STATES, stepped, states, strict=True):
                    self.assertAlmostEqual(one, other, delta=STATE_TOLERANCES[name], msg=name)

    def test_casadi_gets_the_same_rates_outputs_and_jacobian(self) -> None:
        function = casadi.DaeBuilder("ugv", str(fmu().folder)).create("f", ["x", "u"], ["ode", "y"])
        rates, outputs = function(STATE, SPEEDS)
        factory = function.factory("j", ["x", "u"], ["jac:ode:x", "jac:ode:u", "jac:y:x"])
        by_state, by_input, outputs_by_state = map(np.array, factory(STATE, SPEEDS))
        with model_exchange(dict(zip(INPUTS, SPEEDS, strict=True))) as instance:
            instance.set_states(STATE)
            np.testing.assert_allclose(
                np.array(rates).ravel(), instance.derivatives(), rtol=SAME_POINT_TOLERANCE
            )
            np.testing.assert_allclose(
                np.array(outputs).ravel(), instance.outputs(), rtol=SAME_POINT_TOLERANCE
            )
            for matrix, unknowns, knowns in (
                (by_state, RATES, STATES),
                (by_input, RATES, INPUTS),
                (outputs_by_state, fmu().outputs, STATES),
            ):
                for column, known in enumerate(knowns):
                    expected = instance.directional(unknowns, [known], [1.0])
                    np.testing.assert_allclose(
                        *(matrix[:, column], expected),
                        rtol=SAME_POINT_TOLERANCE,
                        atol=SAME_POINT_TOLERANCE,
                    )

    def test_states_can_be_set_one_by_one_or_together(self) -> None:
        with model_exchange() as one, model_exchange() as other:
            one.set_states(STATE)
            for name, value in zip(STATES, STATE, strict=True):
                other.set({name: value})
            self.assertEqual(one.get(STATES), STATE)
            self.assertEqual(other.get(STATES), STATE)
            self.assertEqual(one.derivatives(), other.derivatives())
            self.assertEqual(one.get(RATES), one.derivatives())

    def test_model_exchange_has_no_events(self) -> None:
        with model_exchange() as instance:
            enter, stop = c_int(1), c_int(1)
            instance.do("CompletedIntegratorStep", 1, byref(enter), byref(stop))
            self.assertEqual((enter.value, stop.value), (0, 0))
            self.assertEqual(instance.call("GetEventIndicators", None, c_size_t(0)), fmi2OK)
            instance.do("EnterEventMode")
            information = fmi2EventInfo(1, 1, 1, 1, 1, 1.0)
            instance.do("NewDiscreteStates", byref(information))
            values = [getattr(information, field) for field, _ in fmi2EventInfo._fields_]
            self.assertFalse(any(values), values)

    def test_nominals_are_the_declared_ones(self) -> None:
        nominals = (c_double * len(STATES))()
        with Instance(0) as instance:
            instance.do("GetNominalsOfContinuousStates", nominals, c_size_t(len(STATES)))
        declared = [float(fmu().variables[name].nominal) for name in STATES]
        self.assertEqual(list(nominals), declared)


if __name__ == "__main__":
    unittest.main()
