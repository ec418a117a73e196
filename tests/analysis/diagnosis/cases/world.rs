//! Drives through a world in which something is left out by the model.

use super::law::Law;
use super::manoeuvres::{Commands, STEP};
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::{Simulation, SimulationError, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle, VehicleModel};

/// When or where something acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    Always,
    /// From one time to another \[s\].
    Time(f64, f64),
    /// Within so many metres of a place on the map.
    Disc([f64; 2], f64),
}

impl Region {
    pub fn holds(self, time: f64, state: &State) -> bool {
        match self {
            Self::Always => true,
            // Times are whole commands but for rounding.
            Self::Time(start, end) => time > start - 1e-6 && time < end - 1e-6,
            Self::Disc([x, y], radius) => (state.x - x).hypot(state.y - y) < radius,
        }
    }
}

/// Something that the nominal model does not know.
#[derive(Debug, Clone, PartialEq)]
pub struct Ingredient {
    /// Name of the effect in the catalogue, or of the law.
    pub name: &'static str,
    /// small, medium or large.
    pub size: &'static str,
    /// Parameters of the effect by their full names; none of a law.
    pub parameters: Vec<(String, f64)>,
    /// A force outside of the catalogue.
    pub law: Option<Law>,
    pub region: Region,
}

/// What there is in truth.
#[derive(Debug, Clone)]
pub struct World {
    pub vehicle: Vehicle,
    pub terrain: Terrain,
    pub ingredients: Vec<Ingredient>,
}

/// A drive as it was, every [`TRACK_STEP`].
#[derive(Debug, Clone)]
pub struct Track {
    pub states: Vec<State>,
    /// Wheel speeds (left, right) \[rad/s\], every [`STEP`].
    pub wheels: Vec<[f64; 2]>,
}

/// Seconds between two states of a track.
pub const TRACK_STEP: f64 = STEP / 2.0;
/// Forces outside of the model push this many times between two states.
const KICKS: usize = 3;

/// Why a drive is none.
#[derive(Debug)]
pub enum Failure {
    Simulation(SimulationError),
    /// The vehicle comes only this share of the way that its wheels roll.
    Bogged(f64),
    /// It slides faster than anybody would drive \[m/s\].
    Sliding(f64),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulation(error) => error.fmt(f),
            Self::Bogged(share) => write!(f, "bogs down, {:.0} % of the way", 100.0 * share),
            Self::Sliding(speed) => write!(f, "slides at {speed:.1} m/s"),
        }
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(error)
    }
}

impl World {
    /// Drives from a pose by the commands.
    ///
    /// # Errors
    /// Drives on which the vehicle bogs down.
    pub fn drive(&self, start: State, commands: &Commands) -> Result<Track, Failure> {
        let mut models = HashMap::new();
        let mut mask = self.mask(0.0, &start);
        let mut simulation = Simulation::new(self.model(mask, &mut models));
        simulation.set_state(start)?;
        let mut states = Vec::with_capacity(2 * commands.wheels.len());
        for (k, pair) in commands.wheels.windows(2).enumerate() {
            let time = k as f64 * STEP;
            let state = simulation.state();
            let now = self.mask(time, &state);
            if now != mask {
                mask = now;
                simulation = Simulation::new(self.model(mask, &mut models));
                simulation.set_state(state)?;
            }
            simulation.set_time(time).unwrap();
            simulation.set_wheel_speeds(WheelSpeeds::from(pair[0]))?;
            let rates = [0, 1].map(|side| (pair[1][side] - pair[0][side]) / STEP);
            simulation.set_wheel_accelerations(WheelSpeeds::from(rates))?;
            for _ in 0..2 {
                states.push(simulation.state());
                self.step(&mut simulation)?;
            }
        }
        states.push(simulation.state());
        let track = Track {
            states,
            wheels: commands.wheels.clone(),
        };
        track.check(self.vehicle.wheel_radius)?;
        Ok(track)
    }

    /// From one state of a track to the next.
    fn step(&self, simulation: &mut Simulation) -> Result<(), Failure> {
        let laws = || self.ingredients.iter().filter(|one| one.law.is_some());
        if laws().next().is_none() {
            return Ok(simulation.step(TRACK_STEP)?);
        }
        let step = TRACK_STEP / KICKS as f64;
        for _ in 0..KICKS {
            // Half of the momentum before, half after: second order in the step.
            self.kick(simulation, step / 2.0)?;
            simulation.step(step)?;
            self.kick(simulation, step / 2.0)?;
        }
        Ok(())
    }

    /// Gives the vehicle the momentum of the laws' forces over some seconds.
    fn kick(&self, simulation: &mut Simulation, seconds: f64) -> Result<(), Failure> {
        let (time, mut state) = (simulation.time(), simulation.state());
        for one in &self.ingredients {
            let Some(law) = &one.law else { continue };
            if one.region.holds(time, &state) {
                let [ahead, left, moment] = law.wrench(time, &state);
                state.v_x += seconds * ahead / self.vehicle.mass;
                state.v_y += seconds * left / self.vehicle.mass;
                state.yaw_rate += seconds * moment / self.vehicle.yaw_inertia;
            }
        }
        Ok(simulation.set_state(state)?)
    }

    /// Which ingredients of the catalogue act now, as bits.
    fn mask(&self, time: f64, state: &State) -> u32 {
        let of = |(bit, one): (usize, &Ingredient)| {
            let acts = one.law.is_none() && one.region.holds(time, state);
            u32::from(acts) << bit
        };
        self.ingredients.iter().enumerate().map(of).sum()
    }

    fn model(&self, mask: u32, models: &mut HashMap<u32, Arc<VehicleModel>>) -> Arc<VehicleModel> {
        let make = || {
            let acting = self.ingredients.iter().enumerate();
            let acting = acting.filter(|(bit, _)| mask >> bit & 1 == 1);
            let specification = Specification {
                vehicle: self.vehicle.clone(),
                terrain: self.terrain,
                effects: effects(acting.map(|(_, one)| one)),
            };
            VehicleModel::from_specification(&specification).expect("draws within the ranges")
        };
        models
            .entry(mask)
            .or_insert_with(|| Arc::new(make()))
            .clone()
    }
}

/// What these ingredients are together.
pub fn effects<'a>(ingredients: impl Iterator<Item = &'a Ingredient>) -> Effects {
    let mut effects = Effects::NONE;
    for (name, value) in ingredients.flat_map(|one| &one.parameters) {
        effects = effects.with(name, *value).expect("draws within the ranges");
    }
    effects
}

impl Track {
    pub fn duration(&self) -> f64 {
        (self.wheels.len() - 1) as f64 * STEP
    }

    fn check(&self, wheel_radius: f64) -> Result<(), Failure> {
        const LEAST: f64 = 0.5;
        const FASTEST: f64 = 4.0;
        let (mut rolled, mut came, mut fastest) = (0.0, 0.0, 0.0_f64);
        for (k, wheels) in self.wheels.iter().enumerate() {
            let state = self.states[2 * k];
            let speed = wheel_radius * (wheels[0] + wheels[1]) / 2.0;
            fastest = fastest.max(state.v_x.hypot(state.v_y));
            if speed.abs() > 0.15 {
                rolled += speed.abs();
                came += state.v_x * speed.signum();
            }
        }
        if fastest > FASTEST {
            return Err(Failure::Sliding(fastest));
        }
        if came < LEAST * rolled {
            return Err(Failure::Bogged(came / rolled));
        }
        Ok(())
    }

    /// When a region acts along the drive \[s\], stretches of at least a command's length.
    pub fn visits(&self, region: Region) -> Vec<[f64; 2]> {
        let mut visits: Vec<[f64; 2]> = Vec::new();
        for (k, state) in self.states.iter().step_by(2).enumerate() {
            let time = k as f64 * STEP;
            if region.holds(time, state) {
                match visits.last_mut() {
                    Some(last) if time - last[1] < 1.5 * STEP => last[1] = time,
                    _ => visits.push([time, time]),
                }
            }
        }
        visits
    }

    /// The state at a time, cubic between two states; the first one before the drive.
    pub fn at(&self, time: f64) -> State {
        let place = (time / TRACK_STEP).clamp(0.0, (self.states.len() - 1) as f64);
        let k = (place as usize).min(self.states.len() - 2);
        let (a, b, u) = (self.states[k], self.states[k + 1], place - k as f64);
        let cubic = |from: f64, rate: f64, to: f64, rate_to: f64| {
            let (h, d) = (TRACK_STEP, to - from);
            let (c2, c3) = (
                3.0 * d - h * (2.0 * rate + rate_to),
                h * (rate + rate_to) - 2.0 * d,
            );
            from + u * (h * rate + u * (c2 + u * c3))
        };
        let rates = |s: &State| {
            let (sin, cos) = s.heading.sin_cos();
            [s.v_x * cos - s.v_y * sin, s.v_x * sin + s.v_y * cos]
        };
        let ([ax, ay], [bx, by]) = (rates(&a), rates(&b));
        let mix = |from: f64, to: f64| from + u * (to - from);
        State {
            x: cubic(a.x, ax, b.x, bx),
            y: cubic(a.y, ay, b.y, by),
            heading: cubic(a.heading, a.yaw_rate, b.heading, b.yaw_rate),
            v_x: mix(a.v_x, b.v_x),
            v_y: mix(a.v_y, b.v_y),
            yaw_rate: mix(a.yaw_rate, b.yaw_rate),
        }
    }
}
