//! A vehicle on a terrain, prepared for evaluation.

use super::altered::{Altered, Prepared, Remembered};
use super::{
    LoadPlane, ModelParameter, Motion, Specification, Surroundings, Vehicle, WheelOutputs, Wrench,
};
use crate::contact::{Regularisation, Resolution, WheelContact, WheelMotion};
use crate::effects::{Extent, ParameterName};
use crate::parameter::ParameterError;
use crate::scalar::Scalar;
use crate::terrain::Terrain;
use fearless_simd::Level;

/// A vehicle on a terrain: everything about the two that does not move.
#[derive(Debug, Clone)]
pub struct VehicleModel {
    vehicle: Vehicle,
    terrain: Terrain,
    regularisation: Regularisation,
    contact: WheelContact,
    plane: LoadPlane,
    /// The effects that are on, unless there are none.
    altered: Option<Box<Altered>>,
    /// The processor's vector instructions.
    level: Level,
}

impl VehicleModel {
    /// A vehicle on a terrain, with the default settings.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn new(vehicle: Vehicle, terrain: Terrain) -> Result<Self, ParameterError> {
        Self::with_settings(
            vehicle,
            terrain,
            Regularisation::default(),
            Resolution::default(),
        )
    }

    /// A vehicle on a terrain, with other regularisation speeds or quadrature nodes.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn with_settings(
        vehicle: Vehicle,
        terrain: Terrain,
        regularisation: Regularisation,
        resolution: Resolution,
    ) -> Result<Self, ParameterError> {
        vehicle.validate()?;
        let (radius, width) = (vehicle.wheel_radius, vehicle.wheel_width);
        let contact = WheelContact::new(&terrain, radius, width, regularisation, resolution)?;
        let plane = LoadPlane::new(&vehicle);
        Ok(Self {
            vehicle,
            terrain,
            regularisation,
            contact,
            plane,
            altered: None,
            level: Level::new(),
        })
    }

    /// A vehicle on a terrain with effects. Where all physics is off it is the paper's model, bit
    /// for bit.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn from_specification(specification: &Specification) -> Result<Self, ParameterError> {
        let mut model = Self::new(specification.vehicle.clone(), specification.terrain)?;
        if !specification.effects.is_paper() {
            model.altered = Some(Box::new(Altered::new(specification)?));
        }
        Ok(model)
    }

    /// The same model evaluated through the code that effects can alter, though none is on: what
    /// derivatives by parameters are taken of.
    pub(crate) fn alterable(specification: &Specification) -> Result<Self, ParameterError> {
        let mut model = Self::new(specification.vehicle.clone(), specification.terrain)?;
        model.altered = Some(Box::new(Altered::new(specification)?));
        Ok(model)
    }

    /// How many numbers the vehicle and its ground remember besides position and velocity; none
    /// in the paper's model.
    #[must_use]
    pub fn memory_count(&self) -> usize {
        self.altered().map_or(0, |altered| altered.layout.count())
    }

    /// Names of the remembered numbers.
    #[must_use]
    pub fn memory_names(&self) -> Vec<String> {
        self.altered()
            .map_or_else(Vec::new, |altered| altered.layout.names())
    }

    /// Where the depth stands that a wheel's soil was pressed to before, among the remembered numbers; `None` where
    /// wheels do not meet the ruts that they left.
    pub(crate) fn rut_of(&self, wheel: usize) -> Option<usize> {
        self.altered()?.layout.rut_of(wheel)
    }

    /// Whether wheels meet the ruts that they left.
    pub(crate) fn has_ruts(&self) -> bool {
        self.rut_of(0).is_some()
    }

    /// What a remembered number is. `None` beyond the last.
    pub(crate) fn remembers(&self, index: usize) -> Option<Remembered> {
        self.altered()?.layout.what(index)
    }

    /// The first moment after `time` \[s\] at which effects are switched on or off, whatever the
    /// vehicle does.
    #[must_use]
    pub fn next_event(&self, time: f64) -> Option<f64> {
        let effects = &self.altered()?.specification.effects;
        effects.window.as_ref()?.extent.next_edge(time)
    }

    /// The first moment after `time` \[s\] at which a slope over time changes its rate: a step
    /// that is longer might miss a bump.
    pub(crate) fn next_knot(&self, time: f64) -> Option<f64> {
        let effects = &self.altered()?.specification.effects;
        effects.slope_profile.as_ref()?.next_knot(time)
    }

    /// The length \[m\] of the shortest thing that lies in the way: a step that is longer might miss it.
    pub(crate) fn min_feature_length(&self) -> Option<f64> {
        self.altered()?.grain
    }

    /// Whether nothing depends on position and heading.
    pub(crate) fn is_placeless(&self) -> bool {
        self.altered().is_none_or(|altered| {
            let effects = &altered.specification.effects;
            let mut placed =
                ParameterName::all().filter(|p| ModelParameter::Effect(*p).depends_on_place());
            let anywhere = effects
                .window
                .as_ref()
                .is_none_or(|window| matches!(window.extent, Extent::Time { .. }));
            anywhere
                && effects.slope_profile.is_none()
                && !self.has_ruts()
                && placed.all(|p| effects.get(p) == p.declaration().1.default)
        })
    }

    pub(crate) fn altered(&self) -> Option<&Altered> {
        self.altered.as_deref()
    }

    pub(super) fn regularisation(&self) -> &Regularisation {
        &self.regularisation
    }

    /// What holds throughout one solution, where effects are on.
    pub(crate) fn prepare<'a>(
        &'a self,
        motion: &Motion,
        surroundings: &Surroundings<'a>,
    ) -> Option<Prepared<'a>> {
        self.altered()
            .map(|altered| altered.prepare(motion, surroundings, &self.regularisation))
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The terrain.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// How one wheel moves (10).
    pub(super) fn wheel_motion(&self, motion: &Motion, index: usize) -> WheelMotion<f64> {
        let (ahead, left) = self.vehicle.wheel_centre(index);
        WheelMotion {
            forward: motion.v_x - motion.yaw_rate * left,
            lateral: motion.v_y + motion.yaw_rate * ahead,
            yaw_rate: motion.yaw_rate,
            angular_speed: if left > 0.0 {
                motion.omega_left
            } else {
                motion.omega_right
            },
        }
    }

    /// r omega \[m/s\] of (13), kept away from zero.
    pub(super) fn slip_denominator<S: Scalar>(&self, omega: S) -> S {
        let bounded = self.regularisation.bounded_angular_speed(omega);
        let sign = if omega.value() < 0.0 { -1.0 } else { 1.0 };
        bounded.scale(self.vehicle.wheel_radius * sign)
    }

    /// Weight m g \[N\].
    pub(super) fn weight(&self, prepared: Option<&Prepared>) -> f64 {
        match prepared {
            Some(prepared) => prepared.chassis.mass * super::GRAVITY,
            None => self.plane.weight(),
        }
    }

    /// Each wheel's load and its derivatives by a_X and a_Y; whether a wheel is lifted.
    pub(super) fn distribute_loads(&self, acceleration: [f64; 2], loads: &mut [[f64; 3]]) -> bool {
        self.plane.distribute(acceleration, loads)
    }

    pub(super) fn level(&self) -> Level {
        self.level
    }

    pub(super) fn contact(&self) -> &WheelContact {
        &self.contact
    }
}

impl Wrench {
    /// An empty wrench with room for every wheel of a model.
    #[must_use]
    pub fn for_model(model: &VehicleModel) -> Self {
        Self {
            wheels: vec![WheelOutputs::default(); model.vehicle().wheel_count()],
            ..Self::default()
        }
    }

    /// Sets the slips (13) of every wheel: S_X = -V_jX / (r omega), S_Y = -V_jY / (r omega),
    /// with omega kept away from zero as in the contact time; at omega = 0 as for a wheel
    /// that just starts to roll forward.
    pub(super) fn set_slips(&mut self, model: &VehicleModel, motion: &Motion) {
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            let local = model.wheel_motion(motion, index);
            let rim = model.slip_denominator(local.angular_speed);
            let rolling = model.vehicle().wheel_radius * local.angular_speed;
            wheel.longitudinal_slip = -(local.forward - rolling) / rim;
            wheel.lateral_slip = -local.lateral / rim;
        }
    }
}
