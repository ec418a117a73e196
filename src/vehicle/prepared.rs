//! A model at one motion and in its surroundings: what holds throughout one solution of the balance.

use super::model::Standing;
use super::rut::{Ruts, TrackSlope};
use super::situation::{Environment, Situation};
use super::{Balance, Chassis, Motion, Surroundings, Tracks, VehicleModel, WheelOutputs, Wrench};
use crate::contact::{Wheel, WheelMemory};

/// What holds throughout one solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prepared<'a> {
    pub model: &'a VehicleModel,
    /// The one that holds at this time and place, and whether it is that outside of the effects' window.
    pub chassis: &'a Chassis<f64>,
    pub is_outside: bool,
    /// Each wheel's load \[N\] over theta_1^(2n+1) at small entry angles; for a guess.
    pub supports: &'a [f64],
    pub situation: Situation<f64>,
    pub environment: Environment<f64>,
    pub memory: &'a [f64],
    pub tracks: Tracks<'a>,
}

impl VehicleModel {
    /// What holds throughout one solution.
    pub(crate) fn prepare<'a>(
        &'a self,
        motion: &Motion,
        surroundings: &Surroundings<'a>,
    ) -> Prepared<'a> {
        let situation = Situation::new(
            motion,
            surroundings,
            self.layout().distance(surroundings.memory),
        );
        let fading = self.contact().regularisation().travel_speed;
        let outside = self.outside_at(surroundings);
        let Standing {
            chassis, supports, ..
        } = outside.unwrap_or(self.inside());
        Prepared {
            model: self,
            chassis,
            supports,
            is_outside: outside.is_some(),
            situation,
            environment: chassis.environment(&situation, self.effects(), fading),
            memory: surroundings.memory,
            tracks: surroundings.tracks,
        }
    }

    /// The chassis outside of the effects' window, if the vehicle is there.
    fn outside_at(&self, surroundings: &Surroundings) -> Option<&Standing> {
        let window = self.effects().window.as_ref()?;
        let inside = window
            .extent
            .holds(surroundings.time, surroundings.position);
        self.outside().filter(|_| !inside)
    }
}

impl Prepared<'_> {
    /// What one wheel remembers.
    pub fn memory(&self, index: usize) -> WheelMemory<f64> {
        WheelMemory::from_array(self.model.layout().wheel(self.memory, index))
    }

    /// A wheel in its contact, with the entry angle \[rad\] that it would have if it were rigid.
    #[inline(always)]
    pub fn wheel(&self, index: usize, reach: f64) -> Wheel<f64> {
        self.chassis
            .wheel(&self.situation, index, reach, self.memory(index))
    }

    /// Entry angle \[rad\] at which the normal stress alone would carry a load \[N\] under a wheel; for a guess.
    pub fn reach_guess(&self, index: usize, load: f64) -> f64 {
        let law = &self.chassis.wheels[index].law;
        let rigid = (load / self.supports[index]).powf(1.0 / (2.0 * law.soil.exponent + 1.0));
        law.reach(rigid.min(1.5))
    }

    /// Fills a wrench with what a balance means here.
    pub fn wrench(&self, balance: &Balance, wrench: &mut Wrench) {
        let chassis = self.chassis;
        let regularisation = self.model.contact().regularisation();
        let forces = &balance.forces;
        wrench.set_totals(chassis.totals(&self.environment, &self.situation, forces));
        for (index, standing) in balance.wheels.iter().enumerate() {
            let carries = standing.load > 0.0;
            let wheel = self.wheel(index, if carries { standing.entry_angle } else { 0.0 });
            let forces = &balance.forces[index];
            let outputs = chassis.outputs(&wheel, regularisation, standing.load, forces);
            wrench.wheels[index] = WheelOutputs::from_array(outputs);
        }
    }

    /// Writes the rates of what is remembered.
    pub fn memory_rates(&self, balance: &Balance, rates: &mut Vec<f64>) {
        if rates.is_empty() {
            return;
        }
        rates.clear();
        let wheel = |index: usize| self.wheel(index, balance.wheels[index].entry_angle);
        let layout = self.model.layout();
        layout.rates(self.chassis, &self.situation, wheel, self.tracks, rates);
    }

    /// How the rates of what the wheels meet depend on the samples of their tracks.
    pub fn track_slopes(&self, balance: &Balance) -> Vec<TrackSlope> {
        let Some(effect) = &self.chassis.effects.multipass else {
            return Vec::new();
        };
        let wheel = |index: usize| self.wheel(index, balance.wheels[index].entry_angle);
        Ruts::new(self.chassis, effect, &self.situation, wheel, self.tracks).slopes()
    }

    /// Writes each wheel's load and its derivatives by the ground's specific force; whether one is
    /// lifted.
    pub fn distribute(&self, specific: [f64; 2], loads: &mut [[f64; 3]]) -> bool {
        self.chassis.distribute(&self.environment, specific, loads)
    }

    /// Weight of the vehicle with what it carries \[N\].
    pub fn weight(&self) -> f64 {
        self.chassis.mass * super::GRAVITY
    }

    /// Load \[N\] below which a wheel's forces fade in proportion to it, a thousandth of the
    /// mean load. (A wheel on cohesive soil has forces that grow infinitely fast with the
    /// first newtons; with them no balance would be found where a wheel lifts.)
    pub fn lightest_load(&self) -> f64 {
        1e-3 * self.weight() / self.chassis.wheels.len() as f64
    }
}
