//! Exact derivatives of the wrench and of what is remembered, in any direction: motion, place,
//! memory, or a parameter of vehicle, soil or effects.
//!
//! By the implicit function theorem on the balance: at held entry angles and specific force the
//! residuals are differentiated by dual numbers, then the step that restores the balance is added.

use super::direction::Direction;
use super::loads::spread_loads;
use super::solve::{Altered, Prepared};
use super::{Chassis, Environment, Situation, Surroundings};
use crate::contact::{Detail, FORCE_COUNT, WheelForces, WheelMemory};
use crate::scalar::{Dual, Scalar};
use crate::vehicle::newton::solve_2x2;
use crate::vehicle::wrench::by_side;
use crate::vehicle::{
    Balance, ModelParameter, Motion, Specification, VehicleModel, WheelOutputs, Wrench,
};

/// Directions are taken so many at a time.
const CHUNK: usize = 4;
type Lane = Dual<f64, CHUNK>;

/// The derivative in one direction.
#[derive(Debug, Clone, Default)]
pub(crate) struct Differentiated {
    pub wrench: Wrench,
    /// Of the rates of the remembered numbers.
    pub memory_rates: Vec<f64>,
}

/// A list of directions, with the chassis differentiated by those that are parameters.
#[derive(Debug, Clone, Default)]
pub(crate) struct Directions {
    list: Vec<Direction>,
    /// Whether derivatives are taken with fewer nodes in each contact.
    coarse: bool,
    chassis: Vec<Chassis<Lane>>,
    /// The same outside of the effects' window, where they have one.
    outside: Vec<Chassis<Lane>>,
}

impl Directions {
    pub fn new(altered: &Altered, list: Vec<Direction>) -> Self {
        let chassis = differentiated(&altered.chassis, &altered.specification, &list, |_| true);
        let effects = &altered.specification.effects;
        // What is off there has no derivatives either.
        let felt = |parameter| match parameter {
            ModelParameter::Effect(name) => !effects.is_windowed(name.effect()),
            _ => true,
        };
        let outside = altered.outside.iter().flat_map(|outside| {
            let own = differentiated(&outside.chassis, &outside.specification, &list, felt);
            let pairs = own.into_iter().zip(&chassis);
            pairs.map(|(own, inside)| own.remembering_like(inside))
        });
        Self {
            outside: outside.collect(),
            chassis,
            list,
            coarse: false,
        }
    }

    /// Takes derivatives with fewer nodes in each contact.
    pub fn coarsen(&mut self) {
        self.coarse = true;
    }

    pub fn list(&self) -> &[Direction] {
        &self.list
    }

    /// Differentiates at a solved balance; one result for each direction.
    pub fn differentiate(
        &self,
        model: &VehicleModel,
        altered: &Altered,
        motion: &Motion,
        surroundings: &Surroundings,
        balance: &Balance,
        results: &mut Vec<Differentiated>,
    ) {
        results.resize_with(self.list.len(), Differentiated::default);
        // A balance that was saved and taken up again has no slopes of its loads.
        let mut loads = vec![[0.0; 3]; balance.wheels.len()];
        altered
            .prepare(motion, surroundings, model.regularisation())
            .distribute(balance.acceleration, &mut loads);
        let at = Point {
            model,
            altered,
            motion,
            surroundings,
            balance,
            loads,
            detail: if self.coarse {
                Detail::Coarse
            } else {
                Detail::Full
            },
        };
        let slopes = at.slopes();
        let chunks = self.list.chunks(CHUNK).zip(results.chunks_mut(CHUNK));
        let chassis = match altered.outside_at(surroundings) {
            Some(_) => &self.outside,
            None => &self.chassis,
        };
        for ((list, results), chassis) in chunks.zip(chassis) {
            at.chunk(list, chassis, &slopes, results);
        }
    }
}

impl VehicleModel {
    /// The directions to differentiate in, prepared; a model without effects has none.
    pub(crate) fn directions(&self, list: Vec<Direction>) -> Directions {
        match self.altered() {
            Some(altered) => Directions::new(altered, list),
            None => Directions::default(),
        }
    }
}

/// The chassis for each chunk of directions, differentiated by those that are `felt` parameters.
fn differentiated(
    chassis: &Chassis<f64>,
    specification: &Specification,
    list: &[Direction],
    felt: impl Fn(ModelParameter) -> bool,
) -> Vec<Chassis<Lane>> {
    let constant: Chassis<Lane> = chassis.lift(specification);
    let chunks = list.chunks(CHUNK).map(|chunk| {
        if !chunk.iter().any(|d| matches!(d, Direction::Parameter(_))) {
            return constant.clone();
        }
        Chassis::new(specification, |parameter| {
            let mut directions = chunk.iter();
            let place = directions.position(|d| *d == Direction::Parameter(parameter))?;
            let value = parameter.get(specification);
            felt(parameter).then(|| Dual::variable(value, place))
        })
    });
    chunks.collect()
}

/// Where is differentiated.
struct Point<'a> {
    model: &'a VehicleModel,
    altered: &'a Altered,
    motion: &'a Motion,
    surroundings: &'a Surroundings<'a>,
    balance: &'a Balance,
    /// Each wheel's load and its derivatives by the ground's specific force.
    loads: Vec<[f64; 3]>,
    detail: Detail,
}

impl Point<'_> {
    /// Slopes of each wheel's forces by its entry angle, with the forces themselves.
    fn slopes(&self) -> Vec<WheelForces<Dual<f64, 1>>> {
        let prepared = self.prepared();
        let wheel = |(index, wheel): (usize, &crate::vehicle::balance::BalancedWheel)| {
            if wheel.load <= 0.0 {
                return WheelForces::zero();
            }
            let contact = self.model.contact();
            let level = self.model.level();
            prepared.wheel(level, contact, index, wheel.entry_angle, self.detail)
        };
        self.balance.wheels.iter().enumerate().map(wheel).collect()
    }

    fn prepared(&self) -> Prepared<'_> {
        let regularisation = self.model.regularisation();
        self.altered
            .prepare(self.motion, self.surroundings, regularisation)
    }

    fn situation(&self, list: &[Direction]) -> Situation<Lane> {
        let mut at = Situation::<Lane>::new(self.motion, self.surroundings, &self.altered.layout);
        for (place, direction) in list.iter().enumerate() {
            let slot = match *direction {
                Direction::Velocity(axis) => &mut at.velocity[axis],
                Direction::YawRate => &mut at.yaw_rate,
                Direction::WheelSpeed(side) => &mut at.wheel_speeds[side],
                Direction::Position(axis) => &mut at.position[axis],
                Direction::Heading => &mut at.heading,
                Direction::Time => &mut at.time,
                Direction::Memory(index) if self.altered.layout.owner(index).is_none() => {
                    &mut at.distance
                }
                Direction::Memory(_) | Direction::Parameter(_) => continue,
            };
            slot.eps[place] = 1.0;
        }
        at
    }

    fn memory(&self, list: &[Direction], wheel: usize) -> WheelMemory<Lane> {
        let layout = &self.altered.layout;
        let values = layout.wheel(self.surroundings.memory, wheel).to_array();
        let mut values = values.map(Lane::constant);
        for (place, direction) in list.iter().enumerate() {
            if let Direction::Memory(index) = direction
                && let Some((owner, field)) = layout.owner(*index)
                && owner == wheel
            {
                values[field].eps[place] = 1.0;
            }
        }
        WheelMemory::from_array(values)
    }

    /// Whether a wheel's forces at a held entry angle depend on none of the directions.
    fn untouched(&self, list: &[Direction], wheel: usize) -> bool {
        let placeless = self.altered.chassis.effects.terrain_change.is_none();
        list.iter().all(|direction| match direction {
            Direction::Memory(index) => self
                .altered
                .layout
                .owner(*index)
                .is_some_and(|(owner, _)| owner != wheel),
            Direction::Position(_) | Direction::Heading => {
                placeless && !list.iter().any(Direction::changes_soil)
            }
            other => !other.reaches_wheels(),
        })
    }

    fn chunk(
        &self,
        list: &[Direction],
        chassis: &Chassis<Lane>,
        slopes: &[WheelForces<Dual<f64, 1>>],
        results: &mut [Differentiated],
    ) {
        let effects = &self.altered.specification.effects;
        let regularisation = self.model.regularisation();
        let situation = self.situation(list);
        let environment = chassis.environment(&situation, effects, regularisation.travel_speed);
        let count = slopes.len();
        let memories: Vec<_> = (0..count).map(|wheel| self.memory(list, wheel)).collect();
        let mut held = Vec::with_capacity(count);
        for (index, wheel) in self.balance.wheels.iter().enumerate() {
            if wheel.load <= 0.0 {
                held.push([Lane::constant(0.0); FORCE_COUNT]);
                continue;
            }
            if self.untouched(list, index) {
                let values = slopes[index].to_array();
                held.push(values.map(|force| Lane::constant(force.re)));
                continue;
            }
            let law = chassis.law(&situation, effects.boundary, index);
            let motion = chassis.wheel_motion(&situation, index);
            let entry = Lane::constant(wheel.entry_angle);
            let forces = self.model.contact().altered_forces(
                self.model.level(),
                &law,
                &motion,
                &memories[index],
                entry,
                self.detail,
            );
            held.push(forces.to_array());
        }
        let closed = self.close(chassis, &environment, slopes, &held);
        let totals = chassis.totals(&environment, situation.yaw_rate, &closed.forces);
        let mut rates = Vec::new();
        let wheels: Vec<_> = closed.entry_angles.iter().copied().zip(memories).collect();
        self.altered.layout.rates(
            chassis,
            &situation,
            &wheels,
            self.surroundings.tracks,
            effects.boundary,
            &mut rates,
        );
        let outputs = (0..count).map(|index| {
            chassis.outputs(
                &situation,
                regularisation,
                effects.boundary,
                index,
                closed.loads[index],
                closed.entry_angles[index],
                &wheels[index].1,
                &closed.forces[index],
            )
        });
        let outputs: Vec<_> = outputs.collect();
        let torques = by_side(closed.forces.iter().map(|force| force.torque.re));
        for (place, result) in results.iter_mut().enumerate() {
            let wrench = &mut result.wrench;
            wrench.a_x = totals.acceleration[0].eps[place];
            wrench.a_y = totals.acceleration[1].eps[place];
            wrench.yaw_acceleration = totals.yaw_acceleration.eps[place];
            wrench.rolling_resistance = totals.rolling_resistance.eps[place];
            wrench.turning_moment = totals.turning_moment.eps[place];
            wrench.turning_resistance_moment = totals.turning_resistance_moment.eps[place];
            wrench.wheels.resize(count, WheelOutputs::default());
            for (wheel, outputs) in wrench.wheels.iter_mut().zip(&outputs) {
                *wheel = WheelOutputs::from_array(outputs.map(|output| output.eps[place]));
            }
            let turned = situation.wheel_speeds.map(|speed| speed.eps[place]);
            wrench.set_axle_derivatives(self.motion, torques, turned);
            result.memory_rates.clear();
            result
                .memory_rates
                .extend(rates.iter().map(|r| r.eps[place]));
        }
    }

    /// Restores the balance: from the forces' derivatives at held entry angles and specific force
    /// to those along the solution.
    fn close(
        &self,
        chassis: &Chassis<Lane>,
        environment: &Environment<Lane>,
        slopes: &[WheelForces<Dual<f64, 1>>],
        held: &[[Lane; FORCE_COUNT]],
    ) -> Closed {
        let count = slopes.len();
        let specific = self.balance.acceleration;
        let places: Vec<_> = (0..count).map(|index| chassis.arm(index)).collect();
        let targets = chassis.load_targets(environment, specific.map(Lane::constant));
        let mut loads = vec![Lane::constant(0.0); count];
        spread_loads(&places, &targets, &mut loads);
        let mass = chassis.mass.re;
        let lightest = self.model.lightest_load(Some(&self.prepared()));
        let mut entry_angles: Vec<_> = self
            .balance
            .wheels
            .iter()
            .map(|wheel| Lane::constant(wheel.entry_angle))
            .collect();
        let mut forces: Vec<[Lane; FORCE_COUNT]> = held.to_vec();
        let along = |values: &[f64; FORCE_COUNT]| {
            let f = WheelForces::from_array(*values);
            [f.thrust - f.compaction, f.lateral]
        };
        for place in 0..CHUNK {
            let mut residual = specific.map(|s| -chassis.mass.eps[place] * s);
            let mut matrix = [[mass, 0.0], [0.0, mass]];
            let mut held_changes = vec![[0.0; FORCE_COUNT]; count];
            let mut by_load = vec![[0.0; FORCE_COUNT]; count];
            for index in 0..count {
                let share = self.balance.wheels[index].share;
                let fixed = held[index].map(|force| force.eps[place]);
                let slope = slopes[index].to_array().map(|force| force.eps[0]);
                let growth = WheelForces::from_array(slope).vertical;
                let entry = if growth > 0.0 {
                    -WheelForces::from_array(fixed).vertical / growth
                } else {
                    0.0
                };
                held_changes[index] =
                    std::array::from_fn(|k| share * (fixed[k] + slope[k] * entry));
                by_load[index] = if share < 1.0 {
                    slopes[index].to_array().map(|force| force.re / lightest)
                } else if growth > 0.0 {
                    slope.map(|by_entry| by_entry / growth)
                } else {
                    [0.0; FORCE_COUNT]
                };
                let (change, growth) = (along(&held_changes[index]), along(&by_load[index]));
                let direct = loads[index].eps[place];
                let [_, by_x, by_y] = self.loads[index];
                for row in 0..2 {
                    residual[row] += change[row] + growth[row] * direct;
                    matrix[row][0] -= growth[row] * by_x;
                    matrix[row][1] -= growth[row] * by_y;
                }
            }
            let [s_x, s_y] = solve_2x2(matrix, residual);
            for index in 0..count {
                let wheel = &self.balance.wheels[index];
                let [_, by_x, by_y] = self.loads[index];
                let load = loads[index].eps[place] + by_x * s_x + by_y * s_y;
                loads[index].eps[place] = load;
                let growth = slopes[index].vertical.eps[0];
                let fixed = WheelForces::from_array(held[index].map(|force| force.eps[place]));
                let followed = if wheel.share < 1.0 { 0.0 } else { load };
                if growth > 0.0 {
                    entry_angles[index].eps[place] = (followed - fixed.vertical) / growth;
                }
                for k in 0..FORCE_COUNT {
                    forces[index][k].eps[place] = held_changes[index][k] + by_load[index][k] * load;
                    forces[index][k].re = wheel.share * slopes[index].to_array()[k].re;
                }
            }
        }
        Closed {
            loads,
            entry_angles,
            forces: forces.into_iter().map(WheelForces::from_array).collect(),
        }
    }
}

/// Loads, entry angles and forces along the solution.
struct Closed {
    loads: Vec<Lane>,
    entry_angles: Vec<Lane>,
    forces: Vec<WheelForces<Lane>>,
}
