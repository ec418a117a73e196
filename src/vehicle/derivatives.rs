//! Exact derivatives of the wrench and of what is remembered, in any direction: motion, place,
//! memory, or a parameter of vehicle, soil or effects.

use super::newton::solve_2x2;
use super::prepared::Prepared;
use super::situation::Situation;
use super::{Balance, Chassis, ModelParameter, Specification, VehicleModel, WheelOutputs, Wrench};
use crate::contact::{Detail, FORCE_COUNT, MOST_INPUTS, REACH, Wheel, WheelForces, WheelMemory};
use crate::effects::Displacement;
use crate::scalar::{Dual, Scalar};

/// Directions, and inputs of a wheel, are taken so many at a time.
const CHUNK: usize = 5;
type Lane = Dual<f64, CHUNK>;

/// What is varied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Direction {
    /// V_X or V_Y.
    Velocity(usize),
    YawRate,
    /// Left or right.
    WheelSpeed(usize),
    /// East or north.
    Position(usize),
    Heading,
    Time,
    /// One of the remembered numbers.
    Memory(usize),
    Parameter(ModelParameter),
}

impl Direction {
    /// The five components of [`Motion`](super::Motion).
    pub const MOTION: [Self; 5] = [
        Self::Velocity(0),
        Self::Velocity(1),
        Self::YawRate,
        Self::WheelSpeed(0),
        Self::WheelSpeed(1),
    ];
    /// Position and heading.
    pub const POSE: [Self; 3] = [Self::Position(0), Self::Position(1), Self::Heading];
}

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
    work: Work,
}

/// Memory that carries nothing from one call to the next.
#[derive(Debug, Clone, Default)]
struct Work {
    /// Every wheel of the first chunk of directions, then of the next.
    wheels: Vec<Wheel<Lane>>,
    gradients: Vec<Gradient>,
    /// Each wheel's load and its derivatives by the ground's specific force: values, and of one chunk.
    loads: Vec<[f64; 3]>,
    lane_loads: Vec<[Lane; 3]>,
    /// Each wheel's forces, at held entry angles, and along the solution.
    held: Vec<[Lane; FORCE_COUNT]>,
    forces: Vec<WheelForces<Lane>>,
    rates: Vec<Lane>,
}

/// One wheel's forces and their derivatives by its own inputs, in the order of [`Wheel::map`].
#[derive(Debug, Clone, Copy)]
struct Gradient {
    forces: [f64; FORCE_COUNT],
    by: [[f64; FORCE_COUNT]; MOST_INPUTS],
    /// The inputs (as bits) that some direction changes.
    wanted: u32,
}

impl Gradient {
    const ZERO: Self = Self {
        forces: [0.0; FORCE_COUNT],
        by: [[0.0; FORCE_COUNT]; MOST_INPUTS],
        wanted: 0,
    };

    /// Of a wheel by the inputs that some of its copies vary, and by its reach.
    fn of<'a>(
        model: &VehicleModel,
        copies: impl Iterator<Item = &'a Wheel<Lane>>,
        detail: Detail,
    ) -> Self {
        let mut gradient = Self::ZERO;
        gradient.wanted = 1 << REACH;
        let mut first = None;
        for copy in copies {
            let mut input = 0;
            copy.map(|number| {
                gradient.wanted |= u32::from(!number.is_constant()) << input;
                input += 1;
            });
            first = first.or(Some(copy));
        }
        let Some(wheel) = first else {
            return Self::ZERO;
        };
        let mut left = gradient.wanted;
        while left != 0 {
            let mut chunk = [0; CHUNK];
            let mut count = 0;
            while count < CHUNK && left != 0 {
                chunk[count] = left.trailing_zeros();
                left &= left - 1;
                count += 1;
            }
            let mut input = 0;
            let varied = wheel.map(|number| {
                let place = chunk[..count].iter().position(|one| *one == input);
                input += 1;
                place.map_or(Lane::constant(number.re), |place| {
                    Dual::variable(number.re, place)
                })
            });
            let forces = model
                .contact()
                .forces(model.level(), &varied, detail)
                .to_array();
            gradient.forces = forces.map(|force| force.re);
            for (place, input) in chunk[..count].iter().enumerate() {
                gradient.by[*input as usize] = forces.map(|force| force.eps[place]);
            }
        }
        gradient
    }

    /// The derivatives of the forces in the directions in which the wheel's inputs change.
    fn along(&self, wheel: &Wheel<Lane>) -> [Lane; FORCE_COUNT] {
        let mut forces = self.forces.map(Lane::constant);
        let mut input = 0;
        wheel.map(|number| {
            if self.wanted & (1 << input) != 0 && !number.is_constant() {
                for (force, by) in forces.iter_mut().zip(&self.by[input]) {
                    for (sum, change) in force.eps.iter_mut().zip(number.eps) {
                        *sum += by * change;
                    }
                }
            }
            input += 1;
        });
        forces
    }
}

impl Directions {
    pub fn new(model: &VehicleModel, list: Vec<Direction>) -> Self {
        let effects = model.effects();
        // What is off outside of the effects' window has no derivatives there either.
        let felt = |parameter| match parameter {
            ModelParameter::Effect(name) => !effects.is_windowed(name.effect()),
            _ => true,
        };
        let chassis = differentiated(model.specification(), &list, |_| true);
        let outside = model.outside().into_iter().flat_map(|outside| {
            let specification = model.specification().with_effects(outside.effects.clone());
            let own = differentiated(&specification, &list, felt);
            let pairs = own.into_iter().zip(&chassis);
            pairs.map(|(own, inside)| own.remembering_like(inside))
        });
        Self {
            outside: outside.collect(),
            chassis,
            list,
            coarse: false,
            work: Work::default(),
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
    ///
    /// # Algorithm
    /// 1. For each direction the inputs of every wheel are differentiated: its motion, what it remembers, its soil and
    ///    shape. Cheap, by dual numbers.
    /// 2. Each wheel's forces are differentiated by those of its own inputs that some direction changes, five at a time,
    ///    and by its entry angle: the dear part, which does not grow with the number of directions.
    /// 3. The chain rule gives the forces' derivatives at held entry angles and specific force.
    /// 4. The implicit function theorem on the balance (22), (28), (19), (20) adds the step that restores it.
    /// 5. Accelerations, outputs and the rates of what is remembered follow.
    pub fn differentiate(
        &mut self,
        at: &Prepared,
        balance: &Balance,
        results: &mut Vec<Differentiated>,
    ) {
        results.resize_with(self.list.len(), Differentiated::default);
        let count = balance.wheels.len();
        let detail = if self.coarse {
            Detail::Coarse
        } else {
            Detail::Full
        };
        let all_chassis = if at.is_outside {
            &self.outside
        } else {
            &self.chassis
        };
        let work = &mut self.work;
        work.loads.resize(count, [0.0; 3]);
        // A balance that was saved and taken up again has no slopes of its loads.
        at.distribute(balance.acceleration, &mut work.loads);
        work.wheels.clear();
        for (list, chassis) in self.list.chunks(CHUNK).zip(all_chassis) {
            let situation = situation(at, list);
            for (index, standing) in balance.wheels.iter().enumerate() {
                let reach = Lane::constant(standing.entry_angle);
                let memory = memory(at, list, index);
                work.wheels
                    .push(chassis.wheel(&situation, index, reach, memory));
            }
        }
        work.gradients.clear();
        for (index, standing) in balance.wheels.iter().enumerate() {
            work.gradients.push(if standing.load > 0.0 {
                let copies = work.wheels.iter().skip(index).step_by(count);
                Gradient::of(at.model, copies, detail)
            } else {
                Gradient::ZERO
            });
        }
        let chunks = self.list.chunks(CHUNK).zip(results.chunks_mut(CHUNK));
        for (place, ((list, results), chassis)) in chunks.zip(all_chassis).enumerate() {
            let wheels = place * count..(place + 1) * count;
            work.chunk(at, balance, list, chassis, wheels, results);
        }
    }
}

impl Work {
    fn chunk(
        &mut self,
        at: &Prepared,
        balance: &Balance,
        list: &[Direction],
        chassis: &Chassis<Lane>,
        wheels: std::ops::Range<usize>,
        results: &mut [Differentiated],
    ) {
        let model = at.model;
        let regularisation = model.contact().regularisation();
        let situation = situation(at, list);
        let environment =
            chassis.environment(&situation, model.effects(), regularisation.travel_speed);
        let specific = balance.acceleration.map(Lane::constant);
        self.lane_loads
            .resize(wheels.len(), [Lane::constant(0.0); 3]);
        chassis.distribute(&environment, specific, &mut self.lane_loads);
        let wheels = &mut self.wheels[wheels];
        let pairs = self.gradients.iter().zip(&*wheels);
        self.held.clear();
        self.held
            .extend(pairs.map(|(gradient, wheel)| gradient.along(wheel)));
        self.forces.resize(wheels.len(), WheelForces::zero());
        let closing = Closing {
            balance,
            gradients: &self.gradients,
            loads: &self.loads,
            held: &self.held,
            lightest: at.lightest_load(),
            mass: chassis.mass,
        };
        for place in 0..list.len() {
            closing.restore(place, wheels, &mut self.lane_loads, &mut self.forces);
        }
        let totals = chassis.totals(&environment, &situation, &self.forces);
        self.rates.clear();
        let (layout, wheel) = (model.layout(), |index: usize| wheels[index]);
        layout.rates(chassis, &situation, wheel, at.tracks, &mut self.rates);
        for (place, result) in results.iter_mut().enumerate() {
            let wrench = &mut result.wrench;
            wrench.set_totals(totals.map(|total| total.eps[place]));
            wrench.wheels.resize(wheels.len(), WheelOutputs::default());
            result.memory_rates.clear();
            let rates = self.rates.iter().map(|rate| rate.eps[place]);
            result.memory_rates.extend(rates);
        }
        // What a remembered number does to the outputs matters to the tracks alone.
        let remembered = list.iter().all(|one| matches!(one, Direction::Memory(_)));
        if remembered && !model.has_ruts() {
            return;
        }
        for (index, wheel) in wheels.iter().enumerate() {
            let (load, forces) = (self.lane_loads[index][0], &self.forces[index]);
            let outputs = chassis.outputs(wheel, regularisation, load, forces);
            for (place, result) in results.iter_mut().enumerate() {
                let own = outputs.map(|output| output.eps[place]);
                result.wrench.wheels[index] = WheelOutputs::from_array(own);
            }
        }
    }
}

/// What restores the balance: from the forces' derivatives at held entry angles and specific force
/// to those along the solution.
struct Closing<'a> {
    balance: &'a Balance,
    gradients: &'a [Gradient],
    /// Each wheel's load and its derivatives by the specific force.
    loads: &'a [[f64; 3]],
    held: &'a [[Lane; FORCE_COUNT]],
    /// The load below which forces fade \[N\].
    lightest: f64,
    mass: Lane,
}

impl Closing<'_> {
    /// A wheel's forces' changes in a direction while it goes on carrying the same load, and for each newton of load.
    fn changes(&self, index: usize, place: usize) -> [[f64; FORCE_COUNT]; 2] {
        let (share, gradient) = (self.balance.wheels[index].share, &self.gradients[index]);
        let fixed = self.held[index].map(|force| force.eps[place]);
        let slope = &gradient.by[REACH];
        let growth = vertical(slope);
        let entry = if growth > 0.0 {
            -vertical(&fixed) / growth
        } else {
            0.0
        };
        let held = std::array::from_fn(|k| share * (fixed[k] + slope[k] * entry));
        // By the entry angle, or, of a light wheel, by the share of its forces that act.
        let by_load = if share < 1.0 {
            gradient.forces.map(|force| force / self.lightest)
        } else if growth > 0.0 {
            slope.map(|by_entry| by_entry / growth)
        } else {
            [0.0; FORCE_COUNT]
        };
        [held, by_load]
    }

    /// Writes the derivatives of entry angles, loads and forces in one direction.
    #[allow(
        clippy::needless_range_loop,
        reason = "several lists of wheels at once"
    )]
    fn restore(
        &self,
        place: usize,
        wheels: &mut [Wheel<Lane>],
        loads: &mut [[Lane; 3]],
        forces: &mut [WheelForces<Lane>],
    ) {
        let specific = self.balance.acceleration;
        let mass = self.mass.re;
        let mut residual = specific.map(|s| -self.mass.eps[place] * s);
        let mut matrix = [[mass, 0.0], [0.0, mass]];
        for index in 0..wheels.len() {
            let [held, by_load] = self.changes(index, place).map(|change| horizontal(&change));
            let direct = loads[index][0].eps[place];
            let [_, by_x, by_y] = self.loads[index];
            for row in 0..2 {
                residual[row] += held[row] + by_load[row] * direct;
                matrix[row][0] -= by_load[row] * by_x;
                matrix[row][1] -= by_load[row] * by_y;
            }
        }
        let [s_x, s_y] = solve_2x2(matrix, residual);
        for index in 0..wheels.len() {
            let (standing, gradient) = (&self.balance.wheels[index], &self.gradients[index]);
            let [held, by_load] = self.changes(index, place);
            let [_, by_x, by_y] = self.loads[index];
            let load = loads[index][0].eps[place] + by_x * s_x + by_y * s_y;
            loads[index][0].eps[place] = load;
            let growth = vertical(&gradient.by[REACH]);
            if growth > 0.0 {
                let fixed = self.held[index].map(|force| force.eps[place]);
                let followed = if standing.share < 1.0 { 0.0 } else { load };
                wheels[index].reach.eps[place] = (followed - vertical(&fixed)) / growth;
            }
            let mut numbers = forces[index].to_array();
            for k in 0..FORCE_COUNT {
                numbers[k].re = standing.share * gradient.forces[k];
                numbers[k].eps[place] = held[k] + by_load[k] * load;
            }
            forces[index] = WheelForces::from_array(numbers);
        }
    }
}

fn vertical(forces: &[f64; FORCE_COUNT]) -> f64 {
    WheelForces::from_array(*forces).vertical
}

fn horizontal(forces: &[f64; FORCE_COUNT]) -> [f64; 2] {
    let forces = WheelForces::from_array(*forces);
    [forces.thrust - forces.compaction, forces.lateral]
}

/// Where the vehicle is and how it moves, differentiated by the directions that change it.
fn situation(at: &Prepared, list: &[Direction]) -> Situation<Lane> {
    let mut situation = at.situation.map(Lane::constant);
    for (place, direction) in list.iter().enumerate() {
        let slot = match *direction {
            Direction::Velocity(axis) => &mut situation.velocity[axis],
            Direction::YawRate => &mut situation.yaw_rate,
            Direction::WheelSpeed(side) => &mut situation.wheel_speeds[side],
            Direction::Position(axis) => &mut situation.position[axis],
            Direction::Heading => &mut situation.heading,
            Direction::Time => &mut situation.time,
            Direction::Memory(index) if at.model.layout().owner(index).is_none() => {
                &mut situation.distance
            }
            Direction::Memory(_) | Direction::Parameter(_) => continue,
        };
        slot.eps[place] = 1.0;
    }
    situation
}

/// What a wheel remembers, differentiated by the directions that change it.
fn memory(at: &Prepared, list: &[Direction], wheel: usize) -> WheelMemory<Lane> {
    let layout = at.model.layout();
    let mut values = layout.wheel(at.memory, wheel).map(Lane::constant);
    for (place, direction) in list.iter().enumerate() {
        if let Direction::Memory(index) = direction
            && let Some((owner, field)) = layout.owner(*index)
            && owner == wheel
        {
            values[field].eps[place] = 1.0;
        }
    }
    let [forward, lateral, yaw, rim, pressed] = values;
    WheelMemory {
        displacement: Displacement {
            forward,
            lateral,
            yaw,
            rim,
        },
        pressed,
    }
}

/// The chassis for each chunk of directions, differentiated by those that are `felt` parameters. All of them have the
/// effects that any of the directions is a parameter of.
fn differentiated(
    specification: &Specification,
    list: &[Direction],
    felt: impl Fn(ModelParameter) -> bool,
) -> Vec<Chassis<Lane>> {
    let place = |chunk: &[Direction], parameter: ModelParameter| {
        let varied = Direction::Parameter(parameter);
        chunk.iter().position(|direction| *direction == varied)
    };
    let chunks = list.chunks(CHUNK).map(|chunk| {
        Chassis::new(specification, |parameter| {
            place(list, parameter).filter(|_| felt(parameter))?;
            let value = parameter.get(specification);
            Some(
                place(chunk, parameter)
                    .map_or(Lane::constant(value), |place| Dual::variable(value, place)),
            )
        })
    });
    chunks.collect()
}

/// Farthest that accelerations are predicted \[m/s^2\]: slopes are steep next to standstill.
const LONGEST_PREDICTION: f64 = 2.0;

/// How a balance changes with the motion: derivatives by the five components of [`Motion`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trend {
    pub acceleration: [[f64; 5]; 2],
    pub entry_angles: Vec<[f64; 5]>,
}

impl Trend {
    pub(crate) fn of_wheels(count: usize) -> Self {
        Self {
            acceleration: [[0.0; 5]; 2],
            entry_angles: vec![[0.0; 5]; count],
        }
    }

    /// Takes the derivatives of the wrench in those directions that are of the motion.
    pub(crate) fn take(&mut self, list: &[Direction], results: &[Differentiated]) {
        for (direction, result) in list.iter().zip(results) {
            let place = Direction::MOTION.iter().position(|one| one == direction);
            let Some(place) = place else { continue };
            let wrench = &result.wrench;
            self.acceleration[0][place] = wrench.a_x;
            self.acceleration[1][place] = wrench.a_y;
            for (slopes, wheel) in self.entry_angles.iter_mut().zip(&wrench.wheels) {
                slopes[place] = wheel.entry_angle;
            }
        }
    }

    /// Moves a balance along: `change` is how the motion differs from the one that it solves.
    pub(crate) fn predict(&self, balance: &mut Balance, change: &[f64; 5]) {
        let along = |slopes: &[f64; 5]| -> f64 {
            let pairs = slopes.iter().zip(change);
            pairs.map(|(slope, by)| slope * by).sum()
        };
        for (a, slopes) in balance.acceleration.iter_mut().zip(&self.acceleration) {
            *a += along(slopes).clamp(-LONGEST_PREDICTION, LONGEST_PREDICTION);
        }
        for (wheel, slopes) in balance.wheels.iter_mut().zip(&self.entry_angles) {
            let longest = 0.2 * wheel.entry_angle;
            wheel.entry_angle += along(slopes).clamp(-longest, longest);
        }
    }

    /// Visits every number, for a snapshot.
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let rows = self.acceleration.iter_mut().chain(&mut self.entry_angles);
        rows.flatten().for_each(visit);
    }
}
