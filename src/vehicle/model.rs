//! A vehicle on a terrain, prepared for evaluation.

use super::memory::{MemoryLayout, Remembered};
use super::{Chassis, ModelParameter, Specification, Vehicle, WheelOutputs, Wrench};
use crate::contact::{Regularisation, Resolution, WheelContact};
use crate::effects::{Effects, Extent, ParameterName, SlopeProfile, Soil};
use crate::parameter::{Bounds, ParameterError};
use crate::terrain::Terrain;
use fearless_simd::Level;

/// What is shorter \[m\] may be stepped over: a ramp of a tenth of a millimetre that stands for an edge would cost
/// thousands of steps a second all the way.
const FINEST: f64 = 0.02;

/// A vehicle on a terrain with the effects that are on: everything about them that does not move.
#[derive(Debug, Clone)]
pub struct VehicleModel {
    specification: Specification,
    contact: WheelContact,
    inside: Standing,
    /// The same outside of the effects' window, where they have one.
    outside: Option<Standing>,
    layout: MemoryLayout,
    /// The length \[m\] of the shortest thing that lies in the way.
    grain: Option<f64>,
    /// The processor's vector instructions.
    level: Level,
}

/// A vehicle after its effects.
#[derive(Debug, Clone)]
pub(super) struct Standing {
    pub effects: Effects,
    pub chassis: Chassis<f64>,
    /// Each wheel's load \[N\] over theta_1^(2n+1) at small entry angles; for a guess.
    pub supports: Vec<f64>,
}

impl VehicleModel {
    /// A vehicle on a terrain, with the default settings.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn new(vehicle: Vehicle, terrain: Terrain) -> Result<Self, ParameterError> {
        Self::from_specification(&Specification::plain(vehicle, terrain))
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
        let specification = Specification::plain(vehicle, terrain);
        Self::build(specification, regularisation, resolution)
    }

    /// A vehicle on a terrain with effects. Where all physics is off it is the paper's model, bit
    /// for bit.
    ///
    /// # Errors
    /// The first parameter that lies outside its range.
    pub fn from_specification(specification: &Specification) -> Result<Self, ParameterError> {
        Self::build(
            specification.clone(),
            Regularisation::default(),
            Resolution::default(),
        )
    }

    fn build(
        specification: Specification,
        regularisation: Regularisation,
        resolution: Resolution,
    ) -> Result<Self, ParameterError> {
        let Specification {
            vehicle,
            terrain,
            effects,
        } = &specification;
        vehicle.validate()?;
        terrain.validate()?;
        let contact = WheelContact::new(regularisation, resolution)?;
        let stiffness = Bounds::open_low(
            "cohesive_modulus / b + frictional_modulus",
            "N/m^(n+2)",
            0.0,
            1e14,
        );
        stiffness.check(terrain.sinkage_modulus(vehicle.wheel_width))?;
        let standing = |effects: &Effects, chassis: Chassis<f64>| {
            let wheels = chassis.wheels.iter().map(|wheel| &wheel.law);
            let supports = wheels.map(|law| contact.support(&law.soil, law.radius, law.width));
            Standing {
                effects: effects.clone(),
                supports: supports.collect(),
                chassis,
            }
        };
        let chassis = Chassis::new(&specification, |_| None);
        let outside = effects.outside().map(|effects| {
            let own = Chassis::new(&specification.with_effects(effects.clone()), |_| None);
            standing(&effects, own.remembering_like(&chassis))
        });
        if chassis.effects.tyre_compliance.is_some() {
            // A tyre's stiffness has 3 - n in its denominator.
            let below = Bounds::half_open("sinkage_exponent", "1", 0.0, 3.0);
            below
                .because("with tyre_compliance")
                .check(terrain.sinkage_exponent)?;
        }
        let other = outside.iter().flat_map(|outside| &outside.chassis.wheels);
        for wheel in chassis.wheels.iter().chain(other) {
            Bounds::open_low("sinkage modulus", "N/m^(n+2)", 0.0, 1e16)
                .check(wheel.law.soil.modulus)?;
        }
        let grains = [
            effects
                .slope_profile
                .as_ref()
                .and_then(SlopeProfile::min_feature_length),
            effects
                .window
                .as_ref()
                .and_then(|window| window.extent.min_feature_length()),
        ];
        let shortest = grains.into_iter().flatten().reduce(f64::min);
        Ok(Self {
            layout: MemoryLayout::new(&specification),
            grain: shortest.map(|grain| grain.max(FINEST)),
            inside: standing(effects, chassis),
            contact,
            outside,
            level: Level::new(),
            specification,
        })
    }

    /// How many numbers the vehicle and its ground remember besides position and velocity; none
    /// in the paper's model.
    #[must_use]
    pub fn memory_count(&self) -> usize {
        self.layout.count()
    }

    /// Names of the remembered numbers.
    #[must_use]
    pub fn memory_names(&self) -> Vec<String> {
        self.layout.names()
    }

    /// Where the depth stands that a wheel's soil was pressed to before, among the remembered numbers; `None` where
    /// wheels do not meet the ruts that they left.
    pub(crate) fn rut_of(&self, wheel: usize) -> Option<usize> {
        self.layout.rut_of(wheel)
    }

    /// Whether wheels meet the ruts that they left.
    pub(crate) fn has_ruts(&self) -> bool {
        self.rut_of(0).is_some()
    }

    /// What a remembered number is. `None` beyond the last.
    pub(crate) fn remembers(&self, index: usize) -> Option<Remembered> {
        self.layout.what(index)
    }

    /// The first moment after `time` \[s\] at which effects are switched on or off, whatever the
    /// vehicle does.
    #[must_use]
    pub fn next_event(&self, time: f64) -> Option<f64> {
        let effects = self.effects();
        effects.window.as_ref()?.extent.next_edge(time)
    }

    /// The first moment after `time` \[s\] at which a slope over time changes its rate: a step
    /// that is longer might miss a bump.
    pub(crate) fn next_knot(&self, time: f64) -> Option<f64> {
        let effects = self.effects();
        effects.slope_profile.as_ref()?.next_knot(time)
    }

    /// The length \[m\] of the shortest thing that lies in the way: a step that is longer might miss it.
    pub(crate) fn min_feature_length(&self) -> Option<f64> {
        self.grain
    }

    /// Whether nothing depends on position and heading.
    pub(crate) fn is_placeless(&self) -> bool {
        let effects = self.effects();
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
    }

    /// Vehicle, terrain and effects.
    #[must_use]
    pub fn specification(&self) -> &Specification {
        &self.specification
    }

    /// The effects.
    #[must_use]
    pub fn effects(&self) -> &Effects {
        &self.specification.effects
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.specification.vehicle
    }

    /// The terrain.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.specification.terrain
    }

    pub(super) fn inside(&self) -> &Standing {
        &self.inside
    }

    pub(super) fn outside(&self) -> Option<&Standing> {
        self.outside.as_ref()
    }

    pub(super) fn layout(&self) -> &MemoryLayout {
        &self.layout
    }

    pub(super) fn level(&self) -> Level {
        self.level
    }

    pub(crate) fn contact(&self) -> &WheelContact {
        &self.contact
    }

    /// The soil without effects.
    pub(super) fn bare_soil(&self) -> Soil<f64> {
        Soil::from_terrain(&self.terrain().to_array(), self.vehicle().wheel_width)
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
}
