//! All effects, and which of them are on.

use super::{
    Boundary, Declaration, EffectKind, Extent, ParameterDeclaration, SlopeProfile, Window,
    WindowError,
};
use super::{
    Bulldozing, ComShift, Drag, Drawbar, ElasticRebound, Grade, HeadingOffset, Latency,
    LeftRightSoil, LeverArm, Multipass, Payload, RateDependentSoil, ResidualLateral,
    ResidualLongitudinal, ResidualYaw, ShearAnisotropy, SlipSinkage, StressPeak, TerrainChange,
    TransientShear, TyreCompliance, WheelRadius, YawRateBias,
};
use crate::parameter::ParameterError;
use crate::scalar::Scalar;

macro_rules! catalogue {
    ($($field:ident: $effect:ident,)*) => {
        /// Every effect, in the order of the parameters' vector.
        pub const CATALOGUE: &[&Declaration] = &[$(&$effect::<f64>::DECLARATION,)*];

        /// The effects that are on, generic over the scalar.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct ActiveEffects<S> {
            $(
                #[doc = concat!("[`", stringify!($effect), "`].")]
                pub $field: Option<$effect<S>>,
            )*
        }

        impl<S: Scalar> ActiveEffects<S> {
            /// From the values of all parameters; `on` answers, for each effect of the catalogue,
            /// whether it is.
            fn new(values: &[S; PARAMETER_COUNT], on: impl Fn(usize) -> bool) -> Self {
                let (mut effect, mut first) = (0, 0);
                $(
                    let count = $effect::<S>::DECLARATION.parameters.len();
                    let $field = on(effect).then(|| $effect::from_slice(&values[first..first + count]));
                    (effect, first) = (effect + 1, first + count);
                )*
                debug_assert!(effect == CATALOGUE.len() && first == PARAMETER_COUNT);
                Self { $($field),* }
            }
        }
    };
}

catalogue! {
    grade: Grade,
    terrain_change: TerrainChange,
    left_right_soil: LeftRightSoil,
    bulldozing: Bulldozing,
    slip_sinkage: SlipSinkage,
    multipass: Multipass,
    elastic_rebound: ElasticRebound,
    stress_peak: StressPeak,
    tyre_compliance: TyreCompliance,
    shear_anisotropy: ShearAnisotropy,
    transient_shear: TransientShear,
    rate_dependent_soil: RateDependentSoil,
    drag: Drag,
    drawbar: Drawbar,
    payload: Payload,
    com_shift: ComShift,
    wheel_radius: WheelRadius,
    latency: Latency,
    lever_arm: LeverArm,
    yaw_rate_bias: YawRateBias,
    heading_offset: HeadingOffset,
    residual_longitudinal: ResidualLongitudinal,
    residual_lateral: ResidualLateral,
    residual_yaw: ResidualYaw,
}

/// Number of the parameters of all effects together.
pub const PARAMETER_COUNT: usize = {
    let (mut count, mut index) = (0, 0);
    while index < CATALOGUE.len() {
        count += CATALOGUE[index].parameters.len();
        index += 1;
    }
    count
};

/// Place of an effect's first parameter in the vector of all.
fn first(effect: usize) -> usize {
    CATALOGUE[..effect].iter().map(|e| e.parameters.len()).sum()
}

/// A parameter of an effect, by its place in the vector of all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ParameterName(usize);

impl ParameterName {
    /// All parameters in order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..PARAMETER_COUNT).map(Self)
    }

    /// The parameter of this name, written `effect.parameter`.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.full_name() == name)
    }

    /// The parameter at these places: of its effect in the catalogue, and of itself in the effect.
    #[must_use]
    pub fn at(effect: usize, place: usize) -> Option<Self> {
        CATALOGUE.get(effect)?.parameters.get(place)?;
        Some(Self(first(effect) + place))
    }

    /// Its place in the vector.
    #[must_use]
    pub fn index(self) -> usize {
        self.0
    }

    /// The place of its effect in the catalogue.
    #[must_use]
    pub fn effect(self) -> usize {
        let mut next = 0;
        let ends = CATALOGUE.iter().map(|effect| {
            next += effect.parameters.len();
            next
        });
        ends.take_while(|end| *end <= self.0).count()
    }

    /// Its effect and what is declared of it.
    #[must_use]
    pub fn declaration(self) -> (&'static Declaration, &'static ParameterDeclaration) {
        let effect = self.effect();
        let declaration = CATALOGUE[effect];
        (declaration, &declaration.parameters[self.0 - first(effect)])
    }

    /// `effect.parameter`.
    #[must_use]
    pub fn full_name(self) -> String {
        let (effect, parameter) = self.declaration();
        format!("{}.{}", effect.name, parameter.name)
    }
}

/// Which effects are on, and how strong.
#[derive(Debug, Clone, PartialEq)]
pub struct Effects {
    values: [f64; PARAMETER_COUNT],
    /// What the boundary of `terrain_change` is measured over.
    pub boundary: Boundary,
    /// Slopes along the drive, added to those of `grade`.
    pub slope_profile: Option<SlopeProfile>,
    /// Outside of it some effects are off.
    pub window: Option<Window>,
}

impl Default for Effects {
    fn default() -> Self {
        Self::NONE
    }
}

impl Effects {
    /// All effects off.
    pub const NONE: Self = {
        let mut values = [0.0; PARAMETER_COUNT];
        let (mut effect, mut place) = (0, 0);
        while effect < CATALOGUE.len() {
            let parameters = CATALOGUE[effect].parameters;
            let mut index = 0;
            while index < parameters.len() {
                values[place] = parameters[index].default;
                (index, place) = (index + 1, place + 1);
            }
            effect += 1;
        }
        Self {
            values,
            boundary: Boundary::Place,
            slope_profile: None,
            window: None,
        }
    };

    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, parameter: ParameterName) -> f64 {
        self.values[parameter.0]
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// A value that is not finite or out of range; then nothing has changed.
    pub fn set(&mut self, parameter: ParameterName, value: f64) -> Result<(), ParameterError> {
        let (effect, declaration) = parameter.declaration();
        declaration.check(effect.name, value)?;
        self.values[parameter.0] = value;
        Ok(())
    }

    /// With one more parameter set, written `effect.parameter`.
    ///
    /// # Errors
    /// A value that is not finite or out of range, or a name that is no parameter's.
    pub fn with(mut self, name: &str, value: f64) -> Result<Self, ParameterError> {
        let parameter =
            ParameterName::find(name).ok_or_else(|| ParameterError::unknown(name, value))?;
        self.set(parameter, value)?;
        Ok(self)
    }

    /// The values of all parameters.
    #[must_use]
    pub fn values(&self) -> &[f64; PARAMETER_COUNT] {
        &self.values
    }

    /// Whether an effect of the catalogue is on.
    #[must_use]
    pub fn is_on(&self, effect: usize) -> bool {
        let declaration = CATALOGUE[effect];
        let profiled =
            self.slope_profile.is_some() && declaration.name == Grade::<f64>::DECLARATION.name;
        profiled
            || declaration
                .parameters
                .iter()
                .zip(&self.values[first(effect)..])
                .any(|(parameter, value)| parameter.switches && *value != parameter.default)
    }

    /// The effects of this kind that are on.
    pub fn on(&self, kind: EffectKind) -> impl Iterator<Item = &'static Declaration> {
        let numbered = CATALOGUE.iter().enumerate();
        numbered
            .filter(move |(effect, declaration)| declaration.kind == kind && self.is_on(*effect))
            .map(|(_, declaration)| *declaration)
    }

    /// Whether an effect of the catalogue is off outside of a window.
    #[must_use]
    pub fn is_windowed(&self, effect: usize) -> bool {
        let window = self.window.as_ref();
        window.is_some_and(|window| window.effects.contains(&effect))
    }

    /// What is left outside of the window, if there is one.
    #[must_use]
    pub fn outside(&self) -> Option<Self> {
        self.window.as_ref()?;
        let mut left = Self {
            window: None,
            ..self.clone()
        };
        for parameter in ParameterName::all().filter(|p| self.is_windowed(p.effect())) {
            let (effect, declared) = parameter.declaration();
            if declared.switches {
                left.values[parameter.0] = declared.default;
            }
            if effect.name == Grade::<f64>::DECLARATION.name {
                left.slope_profile = None;
            }
        }
        Some(left)
    }

    /// Whether all physics is off: the paper's model. (What sensors add is no matter of the
    /// model's.)
    #[must_use]
    pub fn is_paper(&self) -> bool {
        self.on(EffectKind::Physics).next().is_none()
    }

    /// Whether an effect of the catalogue, where it is on, makes the vehicle or its ground remember:
    /// states besides position and velocity.
    #[must_use]
    pub fn remembers(&self, effect: usize) -> bool {
        let is = |other: &Declaration| CATALOGUE[effect].name == other.name;
        let over_distance = matches!(self.slope_profile, Some(SlopeProfile::Distance(_)));
        CATALOGUE[effect].memory
            || is(&TerrainChange::<f64>::DECLARATION) && self.boundary == Boundary::Distance
            || is(&Grade::<f64>::DECLARATION) && over_distance
    }

    /// The effects that are on, and those besides that own a parameter which `seed` makes
    /// variable; `seed` lifts each value to the scalar.
    pub fn active<S: Scalar>(
        &self,
        seed: impl Fn(ParameterName, f64) -> Option<S>,
    ) -> ActiveEffects<S> {
        let mut values = [S::constant(0.0); PARAMETER_COUNT];
        let mut variable = [false; CATALOGUE.len()];
        let mut place = 0;
        for (effect, declaration) in CATALOGUE.iter().enumerate() {
            for _ in declaration.parameters {
                let value = self.values[place];
                let seeded = seed(ParameterName(place), value);
                variable[effect] |= seeded.is_some();
                values[place] = seeded.unwrap_or(S::constant(value));
                place += 1;
            }
        }
        ActiveEffects::new(&values, |effect| variable[effect] || self.is_on(effect))
    }
}

impl Effects {
    /// Whether what they do depends on when a drive began, or on how far it has come: slopes over time or distance, a
    /// boundary of soils over either, a window of seconds. Pieces of a drive cannot be looked at one by one then.
    #[must_use]
    pub fn depend_on_beginning(&self) -> bool {
        let slopes = !matches!(self.slope_profile, None | Some(SlopeProfile::Place(_)));
        let window = self.window.as_ref();
        let seconds = window.is_some_and(|w| matches!(w.extent, Extent::Time { .. }));
        let name = TerrainChange::<f64>::DECLARATION.name;
        let changes = self
            .on(EffectKind::Physics)
            .any(|effect| effect.name == name);
        slopes || seconds || (changes && self.boundary != Boundary::Place)
    }
}

impl Window {
    /// Refuses a window that makes no sense with these effects.
    ///
    /// # Errors
    /// Effects that are off anyway, or are no physics; an extent that holds nothing.
    pub fn check(&self, effects: &Effects) -> Result<(), WindowError> {
        if self.effects.is_empty() {
            return Err(WindowError::Empty);
        }
        for effect in &self.effects {
            let declaration = CATALOGUE.get(*effect);
            let declaration = declaration.ok_or(WindowError::Unknown(*effect))?;
            if declaration.kind == EffectKind::Measurement {
                return Err(WindowError::Sensor(declaration.name));
            }
            if !effects.is_on(*effect) {
                return Err(WindowError::Off(declaration.name));
            }
        }
        self.extent.check()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Extent, Points};
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn declarations_are_complete_and_names_unique() {
        let mut names = HashSet::new();
        for effect in CATALOGUE {
            assert!(names.insert(effect.name), "{}", effect.name);
            for text in [
                effect.phrase,
                effect.lifts,
                effect.equation,
                effect.source,
                effect.check,
            ] {
                assert!(text.len() > 5, "{}", effect.name);
            }
            assert!(effect.check.ends_with('.') && effect.check.split(' ').count() < 35);
            assert!(
                effect.parameters.iter().any(|p| p.switches),
                "{}",
                effect.name
            );
            for parameter in effect.parameters {
                parameter.check(effect.name, parameter.default).unwrap();
            }
        }
        assert_eq!(ParameterName::all().count(), PARAMETER_COUNT);
        for parameter in ParameterName::all() {
            assert_eq!(ParameterName::find(&parameter.full_name()), Some(parameter));
        }
        assert_eq!(
            ParameterName::at(1, 0),
            ParameterName::find("terrain_change.cohesion_factor")
        );
        assert_eq!(ParameterName::at(0, 2), None);
        assert_eq!(ParameterName::at(CATALOGUE.len(), 0), None);
    }

    #[test]
    fn a_switch_turns_an_effect_on_and_a_shape_does_not() {
        assert!(Effects::NONE.is_paper());
        let shaped = Effects::NONE.with("drawbar.hitch_height", 0.9).unwrap();
        assert!(shaped.is_paper());
        let towing = shaped.with("drawbar.force", 100.0).unwrap();
        assert!(!towing.is_paper());
        let active = towing.active::<f64>(|_, _| None);
        let drawbar = active.drawbar.unwrap();
        assert_eq!((drawbar.force, drawbar.hitch_height), (100.0, 0.9));
        assert_eq!(active.grade, None);
        let biased = Effects::NONE.with("yaw_rate_bias.bias", 0.01).unwrap();
        assert!(biased.is_paper() && !biased.is_on(0));
    }

    #[test]
    fn outside_of_a_window_its_effects_are_off() {
        let both = Effects::NONE
            .with("drawbar.force", 100.0)
            .and_then(|e| e.with("drawbar.hitch_height", 0.9))
            .and_then(|e| e.with("drag.coefficient", 3.0))
            .unwrap();
        assert_eq!(both.outside(), None);
        let profile = Points::new(vec![0.0], vec![[0.1, 0.0]]).unwrap();
        let place = |name: &str| CATALOGUE.iter().position(|effect| effect.name == name);
        let effects = ["drawbar", "grade"].map(|name| place(name).unwrap());
        let windowed = Effects {
            slope_profile: Some(SlopeProfile::Time(profile)),
            window: Some(Window {
                effects: effects.to_vec(),
                extent: Extent::Time {
                    start: 1.0,
                    end: 2.0,
                },
            }),
            ..both.clone()
        };
        let left = both.with("drawbar.force", 0.0).unwrap();
        assert_eq!(windowed.outside(), Some(left));
        assert!(effects.iter().all(|effect| windowed.is_windowed(*effect)));
        assert!(!windowed.is_windowed(place("drag").unwrap()));
    }

    #[test]
    fn values_out_of_range_and_unknown_names_are_refused() {
        let message = |name, value| Effects::NONE.with(name, value).unwrap_err().to_string();
        assert_eq!(
            message("grade.slope_east", 0.5),
            "grade.slope_east = 0.5 rad is outside its range [-0.3, 0.3] rad"
        );
        assert!(message("grade.slope", 0.1).contains("grade.slope"));
    }
}
