//! Directional derivatives and derivatives in time, exact by dual numbers.

use super::calls::Mode;
use super::instance::{Failure, Instance, Outcome, broken, refuse};
use crate::declaration::{Kind, Naming, Quantity};
use crate::simulation::{State, WheelSpeeds};
use crate::vehicle::{Motion, Wrench};

/// A direction in which states, wheel speeds and the time change.
#[derive(Debug, Clone, Copy, Default)]
struct Direction {
    state: [f64; State::COUNT],
    speeds: WheelSpeeds,
    time: f64,
}

impl Direction {
    /// Adds a change of the quantity behind a reference, if it is a known. During the initialization the
    /// states are unknowns, which follow from the initial values.
    fn add(&mut self, (reference, quantity): (u32, Quantity), seed: f64, early: bool) -> Outcome {
        match quantity {
            Quantity::Input(side) => *side.of(&mut self.speeds) += seed,
            Quantity::State(index) if !early => self.state[index] += seed,
            Quantity::Initial(index) if early => self.state[index] += seed,
            Quantity::Time => self.time += seed,
            Quantity::Soil(_) | Quantity::Vehicle(_) | Quantity::Row(_) | Quantity::Effect(_)
                if early =>
            {
                return Err(Failure::Unavailable(format!(
                    "there are no derivatives by the parameter with value reference {reference}"
                )));
            }
            _ => {
                let known = if early { "an initial value" } else { "a state" };
                return refuse(format!(
                    "value reference {reference} is neither an input nor {known}"
                ));
            }
        }
        Ok(())
    }

    fn motion(&self) -> Motion {
        let [_, _, _, v_x, v_y, yaw_rate] = self.state;
        Motion {
            v_x,
            v_y,
            yaw_rate,
            omega_left: self.speeds.left,
            omega_right: self.speeds.right,
        }
    }
}

/// How the outputs change along a direction.
struct Change {
    direction: Direction,
    wrench: Wrench,
    rate: [f64; State::COUNT],
}

/// The change along a direction in which the wrench changes so.
fn change(state: State, direction: Direction, wrench: Wrench) -> Change {
    let (sin, cos) = state.heading.sin_cos();
    let [_, _, turn, v_x, v_y, yaw_rate] = direction.state;
    let (east, north) = (
        state.v_x * cos - state.v_y * sin,
        state.v_x * sin + state.v_y * cos,
    );
    let rate = [
        v_x * cos - v_y * sin - north * turn,
        v_x * sin + v_y * cos + east * turn,
        yaw_rate,
        wrench.a_x + v_y * state.yaw_rate + state.v_y * yaw_rate,
        wrench.a_y - v_x * state.yaw_rate - state.v_x * yaw_rate,
        wrench.yaw_acceleration,
    ];
    Change {
        direction,
        wrench,
        rate,
    }
}

impl Change {
    fn of(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::State(index) => Some(self.direction.state[index]),
            Quantity::Rate(index) => Some(self.rate[index]),
            other => other.in_wrench(&self.wrench),
        }
    }
}

impl Instance {
    /// How outputs and state derivatives change when inputs, states and the time change by `seeds`.
    pub(super) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        values: &mut [f64],
    ) -> Outcome {
        self.check_count(knowns, Kind::Real, seeds.len())?;
        check_seeds(seeds)?;
        let knowns = self.knowns(knowns)?.into_iter();
        let direction = self.direction(knowns.zip(seeds.iter().copied()))?;
        self.along(direction, unknowns, values)
    }

    /// How the sum of outputs and state derivatives, each times its seed, changes with each of the
    /// inputs, states and the time: one direction for each of these.
    pub(super) fn adjoint_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        values: &mut [f64],
    ) -> Outcome {
        self.check_count(unknowns, Kind::Real, seeds.len())?;
        self.check_count(knowns, Kind::Real, values.len())?;
        check_seeds(seeds)?;
        let mut column = vec![0.0; seeds.len()];
        for (known, value) in self.knowns(knowns)?.into_iter().zip(values) {
            let direction = self.direction([(known, 1.0)])?;
            self.along(direction, unknowns, &mut column)?;
            let terms = column.iter().zip(seeds).map(|(change, seed)| change * seed);
            *value = terms.sum();
            if !value.is_finite() {
                return overflow(known.0);
            }
        }
        Ok(())
    }

    /// The direction in which knowns change by their seeds.
    fn direction(
        &self,
        changes: impl IntoIterator<Item = ((u32, Quantity), f64)>,
    ) -> Outcome<Direction> {
        let early = self.core.mode == Mode::Initialization;
        let mut direction = Direction::default();
        for (known, seed) in changes {
            direction.add(known, seed, early)?;
        }
        if early {
            let initial = State::from_array(direction.state);
            let start = self.core.parameters.start(initial, direction.speeds);
            direction.state = start.to_array();
        }
        Ok(direction)
    }

    /// The quantities behind references, with the reference of each.
    fn knowns(&self, references: &[u32]) -> Outcome<Vec<(u32, Quantity)>> {
        let mut all = Vec::with_capacity(references.len());
        for reference in references {
            let (elements, _) = self.find(*reference, Kind::Real)?;
            all.extend(elements.quantities().map(|quantity| (*reference, quantity)));
        }
        Ok(all)
    }

    /// How unknowns change along a direction.
    fn along(&mut self, direction: Direction, unknowns: &[u32], values: &mut [f64]) -> Outcome {
        let simulation = self.core.simulation()?;
        let [x, y, heading, ..] = direction.state;
        let mut wrench = simulation
            .wrench_derivative(&direction.motion(), [x, y, heading])
            .map_err(broken)?
            .clone();
        if direction.time != 0.0 {
            let by_time = simulation.wrench_by_time().map_err(broken)?;
            let held = wrench.clone();
            wrench.combine([(&held, 1.0), (by_time, direction.time)].into_iter());
        }
        let change = change(simulation.state(), direction, wrench);
        self.changes(&change, unknowns, values)
    }

    /// The outputs' derivatives in time, the inputs being held.
    pub(super) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Outcome {
        let scalars = self.purpose.naming == Naming::Scalars;
        let known = |order: i32| order == 1 || (order > 1 && scalars);
        if let Some(order) = orders.iter().find(|order| !known(**order)) {
            return refuse(format!("output derivatives are of order 1, not {order}"));
        }
        let simulation = self.core.simulation()?;
        let direction = Direction {
            state: simulation.derivative().map_err(broken)?,
            ..Direction::default()
        };
        let wrench = simulation.wrench_rate().map_err(broken)?.clone();
        let change = change(simulation.state(), direction, wrench);
        self.changes(&change, references, values)?;
        if scalars {
            // FMI 2.0 requires zero for orders that the FMU does not provide.
            let pairs = values.iter_mut().zip(orders);
            pairs
                .filter(|(_, order)| **order > 1)
                .for_each(|(value, _)| *value = 0.0);
        }
        Ok(())
    }

    fn changes(&self, change: &Change, references: &[u32], values: &mut [f64]) -> Outcome {
        self.check_count(references, Kind::Real, values.len())?;
        let mut places = values.iter_mut();
        for &reference in references {
            let (elements, _) = self.find(reference, Kind::Real)?;
            for (quantity, place) in elements.quantities().zip(&mut places) {
                match change.of(quantity) {
                    Some(number) if number.is_finite() => *place = number,
                    Some(_) => return overflow(reference),
                    None => {
                        return refuse(format!(
                            "value reference {reference} is neither an output nor a state derivative"
                        ));
                    }
                }
            }
        }
        Ok(())
    }
}

fn check_seeds(seeds: &[f64]) -> Outcome {
    match seeds.iter().find(|seed| !seed.is_finite()) {
        Some(seed) => refuse(format!("a seed cannot be {seed}")),
        None => Ok(()),
    }
}

/// Finite seeds can be too large for finite derivatives.
fn overflow<T>(reference: u32) -> Outcome<T> {
    refuse(format!(
        "the derivative at value reference {reference} is not finite"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declaration::{Side, variables};
    use crate::fmu::calls::Interface;
    use crate::fmu::test_instance::{instance, running, with_effects};

    fn reference(instance: &Instance, name: &str) -> u32 {
        let all = variables(instance.configuration());
        all.iter().find(|v| v.name == name).unwrap().reference
    }

    fn derivatives(
        instance: &mut Instance,
        unknowns: &[&str],
        known: &str,
        seed: f64,
    ) -> Outcome<Vec<f64>> {
        let known = reference(instance, known);
        let unknowns: Vec<u32> = unknowns.iter().map(|n| reference(instance, n)).collect();
        let mut values = vec![f64::NAN; unknowns.len()];
        instance.directional_derivative(&unknowns, &[known], &[seed], &mut values)?;
        Ok(values)
    }

    fn starting(no_slip: bool) -> Instance {
        let mut instance = instance(Interface::CoSimulation, with_effects("{}"));
        instance.enter_initialization().unwrap();
        instance.core.parameters.no_slip = no_slip;
        for (input, speed) in Side::BOTH.into_iter().zip([4.0, 5.0]) {
            instance
                .core
                .set_real(Quantity::Input(input), speed)
                .unwrap();
        }
        instance
    }

    const STATES: [&str; State::COUNT] = ["x", "y", "heading", "v_x", "v_y", "yaw_rate"];

    #[test]
    fn without_slip_the_start_follows_from_the_wheel_speeds() {
        let mut rolling = starting(true);
        let vehicle = rolling.configuration().vehicle.clone();
        let (ahead, turn) = (
            vehicle.wheel_radius / 2.0,
            vehicle.wheel_radius / (2.0 * vehicle.half_track),
        );
        for (known, expected) in [
            ("omega_left", [0.0, 0.0, 0.0, ahead, 0.0, -turn]),
            ("omega_right", [0.0, 0.0, 0.0, ahead, 0.0, turn]),
            ("initial.heading", [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
            ("initial.v_x", [0.0; 6]),
        ] {
            let found = derivatives(&mut rolling, &STATES, known, 1.0).unwrap();
            assert_eq!(found, expected, "{known}");
        }
        let mut given = starting(false);
        let found = derivatives(&mut given, &STATES, "omega_left", 1.0).unwrap();
        assert_eq!(found, [0.0; 6]);
        let found = derivatives(&mut given, &STATES, "initial.v_x", 2.0).unwrap();
        assert_eq!(found, [0.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    }

    #[test]
    fn at_the_start_derivatives_are_the_limit_of_differences() {
        const STEP: f64 = 1e-5;
        let unknowns = ["a_x", "der(v_y)", "der(yaw_rate)", "wheel[1].force_x"];
        for (no_slip, known) in [
            (true, "omega_left"),
            (false, "omega_left"),
            (false, "initial.v_x"),
            (false, "initial.yaw_rate"),
        ] {
            let mut instance = starting(no_slip);
            let exact = derivatives(&mut instance, &unknowns, known, 1.0).unwrap();
            let known = [reference(&instance, known)];
            let read = unknowns.map(|name| reference(&instance, name));
            let mut middle = [0.0];
            instance.get_reals(&known, &mut middle).unwrap();
            let [above, below] = [STEP, -STEP].map(|step| {
                let mut values = [0.0; 4];
                instance.set_reals(&known, &[middle[0] + step]).unwrap();
                instance.get_reals(&read, &mut values).unwrap();
                values
            });
            let largest = exact.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!(largest > 0.0);
            for index in 0..4 {
                let difference = (above[index] - below[index]) / (2.0 * STEP);
                let allowed = 1e-4 * largest + 1e-6 * above[index].abs();
                assert!(
                    (exact[index] - difference).abs() < allowed,
                    "{no_slip} {known:?} {}: {}, {difference}",
                    unknowns[index],
                    exact[index]
                );
            }
        }
    }

    #[test]
    fn states_are_unknown_at_the_start_and_derivatives_by_other_parameters_are_not_available() {
        let mut early = starting(false);
        let refused = derivatives(&mut early, &["a_x"], "v_x", 1.0);
        assert!(matches!(refused, Err(Failure::Refused(_))), "{refused:?}");
        for name in ["vehicle.mass", "soil.cohesion", "effects.grade.slope_east"] {
            let refused = derivatives(&mut early, &["a_x"], name, 1.0);
            assert!(
                matches!(refused, Err(Failure::Unavailable(_))),
                "{refused:?}"
            );
        }
        let mut late = running(Interface::CoSimulation, "{}");
        for name in ["initial.v_x", "vehicle.mass"] {
            let refused = derivatives(&mut late, &["a_x"], name, 1.0);
            assert!(matches!(refused, Err(Failure::Refused(_))), "{refused:?}");
        }
        assert!(derivatives(&mut late, &["a_x"], "v_x", 1.0).is_ok());
    }

    #[test]
    fn derivatives_that_are_not_finite_are_refused() {
        let mut instance = running(Interface::CoSimulation, "{}");
        let refused = derivatives(&mut instance, &["wheel[1].force_x"], "v_x", 1.7e308);
        assert!(matches!(refused, Err(Failure::Refused(_))), "{refused:?}");
        let force = reference(&instance, "wheel[1].force_x");
        let known = reference(&instance, "v_x");
        let refused = instance.adjoint_derivative(&[force], &[known], &[1.7e308], &mut [f64::NAN]);
        assert!(matches!(refused, Err(Failure::Refused(_))), "{refused:?}");
    }
}
