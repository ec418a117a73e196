//! Masses, places and laws of a vehicle after its effects.

use crate::contact::WheelLaw;
use crate::effects::{ActiveEffects, Soil};
use crate::scalar::Scalar;
use crate::vehicle::{ModelParameter, Specification, TerrainParameter, VehicleParameter};

/// A vehicle on a soil with its effects applied, generic over the scalar.
#[derive(Debug, Clone)]
pub(crate) struct Chassis<S> {
    /// Mass \[kg\].
    pub mass: S,
    /// Yaw moment of inertia about the centre of mass \[kg m^2\].
    pub yaw_inertia: S,
    /// Height of the centre of mass above the ground \[m\].
    pub com_height: S,
    /// The centre of mass, ahead and to the left of the reference point (the one that the
    /// vehicle's own parameters give, whose motion is the state) \[m\].
    pub com: [S; 2],
    /// The centroid ahead of the reference point \[m\].
    pub centroid: S,
    pub wheels: Vec<ChassisWheel<S>>,
    pub effects: ActiveEffects<S>,
}

/// One wheel of a [`Chassis`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChassisWheel<S> {
    /// Place ahead and to the left of the reference point \[m\].
    pub place: [S; 2],
    pub law: WheelLaw<S>,
}

impl<S: Scalar> Chassis<S> {
    /// Applies the effects; `seed` makes parameters variable.
    pub fn new(specification: &Specification, seed: impl Fn(ModelParameter) -> Option<S>) -> Self {
        let lifted = |parameter: ModelParameter| {
            seed(parameter).unwrap_or(S::constant(parameter.get(specification)))
        };
        let vehicle = &specification.vehicle;
        let effects = specification
            .effects
            .active(|parameter, _| seed(ModelParameter::Effect(parameter)));
        let [mass, yaw_inertia, radius, half_track, offset, height] =
            VehicleParameter::ALL.map(|number| lifted(ModelParameter::Vehicle(number)));
        let terrain = TerrainParameter::ALL.map(|number| lifted(ModelParameter::Terrain(number)));
        let soil = Soil::from_terrain(&terrain, S::constant(vehicle.wheel_width));
        let zero = S::constant(0.0);
        let one = S::constant(1.0);

        let shift = effects.com_shift.map_or([zero; 2], |s| [s.ahead, s.left]);
        let mut body = Body {
            mass,
            yaw_inertia,
            height,
            com: shift,
        };
        if let Some(load) = &effects.payload {
            let place = [load.ahead - offset, load.left];
            body = body.with_point(load.mass, place, load.height);
        }
        let count = vehicle.wheel_count();
        let place = |index: usize| {
            let row = S::constant(vehicle.row_positions[index / 2]);
            let left = index.is_multiple_of(2);
            [row - offset, if left { half_track } else { -half_track }]
        };
        let wheels = (0..count).map(|index| {
            let left = index.is_multiple_of(2);
            let factor = effects
                .wheel_radius
                .map_or(one, |w| if left { w.left } else { w.right });
            let soil = effects
                .left_right_soil
                .map_or(soil, |effect| effect.soil(&soil, left));
            let radius = radius * factor;
            let tyre = effects.tyre_compliance;
            let flat = tyre.map(|tyre| tyre.flat_sinkage(&soil));
            let soil = tyre.map_or(soil, |tyre| tyre.sheared(soil));
            let share = 1.0 / count as f64;
            ChassisWheel {
                place: place(index),
                law: WheelLaw {
                    soil,
                    radius,
                    flat,
                    width: vehicle.wheel_width,
                    rebound: effects.elastic_rebound.map_or(zero, |e| e.share),
                    modulus_ratio: effects.shear_anisotropy.map_or(one, |e| e.modulus_ratio),
                    strength_ratio: effects.shear_anisotropy.map_or(one, |e| e.strength_ratio),
                    viscosity: effects.rate_dependent_soil.map_or([zero; 2], |e| {
                        [e.forward.scale(share), e.lateral.scale(share)]
                    }),
                    peak: effects.stress_peak,
                    slip_sinkage: effects.slip_sinkage,
                    bulldozing: effects.bulldozing,
                    multipass: effects.multipass,
                    transient: effects
                        .transient_shear
                        .is_some_and(|e| e.relaxation.value() > 0.0),
                },
            }
        });
        Self {
            mass: body.mass,
            yaw_inertia: body.yaw_inertia,
            com_height: body.height,
            com: body.com,
            centroid: -offset,
            wheels: wheels.collect(),
            effects,
        }
    }

    /// Remembers what another chassis does, whether or not it is felt here.
    pub fn remembering_like(mut self, other: &Self) -> Self {
        self.effects.transient_shear = other.effects.transient_shear;
        self.effects.multipass = other.effects.multipass;
        self
    }

    /// The wheels' places ahead and to the left of the reference point \[m\].
    pub fn places(&self) -> Vec<[f64; 2]> {
        let wheels = self.wheels.iter();
        wheels.map(|wheel| wheel.place.map(|x| x.value())).collect()
    }

    /// A wheel's place ahead and to the left of the centre of mass.
    #[inline(always)]
    pub fn arm(&self, index: usize) -> [S; 2] {
        let [ahead, left] = self.wheels[index].place;
        [ahead - self.com[0], left - self.com[1]]
    }
}

impl Chassis<f64> {
    /// The same with another scalar: its derivatives are zero.
    pub fn lift<S: Scalar>(&self, specification: &Specification) -> Chassis<S> {
        let c = S::constant;
        let wheels = self.wheels.iter().map(|wheel| ChassisWheel {
            place: wheel.place.map(c),
            law: wheel.law.lift(),
        });
        Chassis {
            mass: c(self.mass),
            yaw_inertia: c(self.yaw_inertia),
            com_height: c(self.com_height),
            com: self.com.map(c),
            centroid: c(self.centroid),
            wheels: wheels.collect(),
            effects: specification.effects.active(|_, _| None),
        }
    }
}

/// A rigid body: mass, yaw inertia about its centre of mass, and where that lies.
struct Body<S> {
    mass: S,
    yaw_inertia: S,
    height: S,
    com: [S; 2],
}

impl<S: Scalar> Body<S> {
    /// With a point mass added, by the parallel-axis rule.
    fn with_point(self, mass: S, place: [S; 2], height: S) -> Self {
        let total = self.mass + mass;
        let middle = |a: S, b: S| (self.mass * a + mass * b) / total;
        let apart = [place[0] - self.com[0], place[1] - self.com[1]];
        let reduced = self.mass * mass / total;
        Self {
            mass: total,
            yaw_inertia: self.yaw_inertia + reduced * (apart[0] * apart[0] + apart[1] * apart[1]),
            height: middle(self.height, height),
            com: [middle(self.com[0], place[0]), middle(self.com[1], place[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_payload_moves_the_centre_of_mass_by_the_parallel_axis_rule() {
        // 100 kg on the vehicle's 400 kg, 1 m ahead: centre at 0.2 m; inertia 50 + 80 x 1.
        let body = Body {
            mass: 400.0,
            yaw_inertia: 50.0,
            height: 0.5,
            com: [0.0, 0.0],
        };
        let loaded = body.with_point(100.0, [1.0, 0.0], 1.0);
        assert!((loaded.com[0] - 0.2).abs() < 1e-15);
        assert!((loaded.yaw_inertia - 130.0).abs() < 1e-12);
        assert!((loaded.height - 0.6).abs() < 1e-15);
    }
}
