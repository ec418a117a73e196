//! Directional derivatives and derivatives in time, exact by dual numbers.

use super::instance::{Failure, Instance, Outcome, refuse, total, wheel_field};
use crate::declaration::{Kind, Quantity};
use crate::simulation::{SimulationError, State, WheelSpeeds};
use crate::vehicle::{Motion, Wrench};

/// A direction in which states and wheel speeds change.
#[derive(Debug, Clone, Copy, Default)]
struct Direction {
    state: [f64; State::COUNT],
    speeds: WheelSpeeds,
}

impl Direction {
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
    /// How outputs and state derivatives change when inputs and states change by `seeds`.
    pub(super) fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        values: &mut [f64],
    ) -> Outcome {
        let mut direction = Direction::default();
        for (reference, seed) in knowns.iter().zip(seeds) {
            let (quantity, _) = self.find(*reference, Kind::Real)?;
            if !seed.is_finite() {
                return refuse(format!("a seed cannot be {seed}"));
            }
            match quantity {
                Quantity::Input(0) => direction.speeds.left += seed,
                Quantity::Input(_) => direction.speeds.right += seed,
                Quantity::State(index) => direction.state[index] += seed,
                _ => {
                    return refuse(format!(
                        "value reference {reference} is neither an input nor a state"
                    ));
                }
            }
        }
        let simulation = self.core.simulation()?;
        let [x, y, heading, ..] = direction.state;
        let wrench = simulation
            .wrench_derivative(&direction.motion(), [x, y, heading])
            .map_err(broken)?
            .clone();
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
            speeds: WheelSpeeds::default(),
        };
        let wrench = simulation.wrench_rate().map_err(broken)?.clone();
        let change = change(simulation.state(), direction, wrench);
        self.changes(&change, references, values)
    }

    fn changes(&self, change: &Change, references: &[u32], values: &mut [f64]) -> Outcome {
        for (reference, value) in references.iter().zip(values) {
            let (quantity, _) = self.find(*reference, Kind::Real)?;
            match change.of(quantity) {
                Some(number) => *value = number,
                None => {
                    return refuse(format!(
                        "value reference {reference} is neither an output nor a state derivative"
                    ));
                }
            }
        }
        Ok(())
    }
}

fn broken(error: SimulationError) -> Failure {
    Failure::Broken(error.to_string())
}
