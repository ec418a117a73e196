//! Directional derivatives and derivatives in time, exact by dual numbers.

use super::instance::{Instance, Outcome, broken, refuse};
use super::values::{total, wheel_field};
use crate::declaration::{Kind, Quantity};
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
    /// Adds a change of a quantity; whether it is one that can be chosen.
    fn add(&mut self, quantity: Quantity, seed: f64) -> bool {
        match quantity {
            Quantity::Input(0) => self.speeds.left += seed,
            Quantity::Input(_) => self.speeds.right += seed,
            Quantity::State(index) => self.state[index] += seed,
            Quantity::Time => self.time += seed,
            _ => return false,
        }
        true
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
        Some(match quantity {
            Quantity::State(index) => self.direction.state[index],
            Quantity::Rate(index) => self.rate[index],
            Quantity::Total(index) => total(&self.wrench, index),
            Quantity::Wheel(wheel, field) => wheel_field(&self.wrench.wheels[wheel], field),
            _ => return None,
        })
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
        let mut direction = Direction::default();
        for ((reference, quantity), seed) in self.knowns(knowns)?.into_iter().zip(seeds) {
            if !seed.is_finite() {
                return refuse(format!("a seed cannot be {seed}"));
            }
            if !direction.add(quantity, *seed) {
                return no_known(reference);
            }
        }
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
        if let Some(seed) = seeds.iter().find(|seed| !seed.is_finite()) {
            return refuse(format!("a seed cannot be {seed}"));
        }
        let mut column = vec![0.0; seeds.len()];
        for ((reference, quantity), value) in self.knowns(knowns)?.into_iter().zip(values) {
            let mut direction = Direction::default();
            if !direction.add(quantity, 1.0) {
                return no_known(reference);
            }
            self.along(direction, unknowns, &mut column)?;
            *value = column
                .iter()
                .zip(seeds)
                .map(|(change, seed)| change * seed)
                .sum();
        }
        Ok(())
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
        if let Some(order) = orders.iter().find(|order| **order != 1) {
            return refuse(format!("output derivatives are of order 1, not {order}"));
        }
        let simulation = self.core.simulation()?;
        let direction = Direction {
            state: simulation.derivative().map_err(broken)?,
            ..Direction::default()
        };
        let wrench = simulation.wrench_rate().map_err(broken)?.clone();
        let change = change(simulation.state(), direction, wrench);
        self.changes(&change, references, values)
    }

    fn changes(&self, change: &Change, references: &[u32], values: &mut [f64]) -> Outcome {
        self.check_count(references, Kind::Real, values.len())?;
        let mut places = values.iter_mut();
        for reference in references {
            let (elements, _) = self.find(*reference, Kind::Real)?;
            for (quantity, place) in elements.quantities().zip(&mut places) {
                match change.of(quantity) {
                    Some(number) => *place = number,
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

fn no_known<T>(reference: u32) -> Outcome<T> {
    refuse(format!(
        "value reference {reference} is neither an input nor a state"
    ))
}
