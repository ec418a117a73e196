//! The declaration of an effect: its parameters with range and prior, its equation and source, the assumption that it
//! lifts, what it acts on, and its name in reports. Everything that other modules need to know of an effect stands here.

use super::Soil;
use crate::parameter::{Bounds, ParameterError};

/// Physics of the vehicle and the ground, or a property of the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectKind {
    /// Changes how the vehicle moves.
    Physics,
    /// Changes what the sensors report; never to be blamed on the soil.
    Measurement,
}

/// What an effect acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// On forces, loads or geometry of the wheels.
    Wheels,
    /// On the vehicle's body alone.
    Body,
    /// On the body, by a slope of the ground: it depends on the place, and belongs to the place of each drive.
    Slope,
    /// On the soil under a wheel, by the wheel's place.
    SoilByPlace,
    /// On the body, as an empirical residual model along this axis: it describes physics that the catalogue lacks.
    Residual(Axis),
    /// On what the sensors report.
    Sensors,
}

/// Axis of a residual model: its force or moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Force along X.
    Longitudinal,
    /// Force along Y.
    Lateral,
    /// Moment about Z.
    Yaw,
}

/// A wheel at rest on level soil: what the size of a first step may depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandingWheel {
    /// The soil.
    pub soil: Soil<f64>,
    /// Load \[N\].
    pub load: f64,
    /// Radius \[m\].
    pub radius: f64,
    /// Width \[m\].
    pub width: f64,
}

/// How an effect that is off is differenced by a parameter.
#[derive(Debug, Clone, Copy)]
pub enum FirstStep {
    /// By its derivative.
    Derivative,
    /// By the difference to this value: the derivative does not exist while the effect is off.
    To(f64),
    /// By the difference to a value that depends on the wheel and its soil.
    Of(fn(&StandingWheel) -> f64),
}

/// What is believed of a parameter before any data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prior {
    /// Normally distributed.
    Normal {
        /// Mean, in the parameter's unit.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// Its logarithm is normally distributed.
    LogNormal {
        /// Median, in the parameter's unit.
        median: f64,
        /// Standard deviation of the natural logarithm.
        deviation: f64,
    },
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct ParameterDeclaration {
    /// Name in files.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Value where none is given.
    pub default: f64,
    /// Whether the effect is off while all such parameters have their defaults; the others only
    /// shape an effect that is on.
    pub switches: bool,
    /// What is believed of it before any data, where the effect is on.
    pub prior: Prior,
    /// Meaning.
    pub description: &'static str,
    /// How the effect is differenced by it while it is off.
    pub first_step: FirstStep,
    /// A shape that is estimated with the effect: with another lever the same moment is another force.
    pub estimated_shape: bool,
    /// Whether it has a direction on the map.
    pub on_map: bool,
}

impl ParameterDeclaration {
    /// The range, for messages.
    #[must_use]
    pub const fn bounds(&self) -> Bounds {
        Bounds::closed(self.name, self.unit, self.low, self.high)
    }

    /// Refuses a value outside the range, naming it as `effect.parameter`.
    ///
    /// # Errors
    /// A value that is not finite or out of range.
    pub fn check(&self, effect: &str, value: f64) -> Result<(), ParameterError> {
        self.bounds().check(value).map_err(|mut error| {
            error.name = format!("{effect}.{}", self.name);
            error
        })
    }
}

/// What kind of thing an effect changes, whatever its name: the coarsest claim that a diagnosis can make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// What resists the motion.
    Resistance,
    /// The weight and its place.
    Weight,
    /// Gravity on a slope.
    Gravity,
    /// How far a wheel rolls in a turn.
    RollingRadius,
    /// Ground that differs from place to place.
    Ground,
    /// What the sensors report.
    Sensor,
}

/// One effect.
#[derive(Debug, Clone, Copy)]
pub struct Declaration {
    /// Name in files and in the diagnosis.
    pub name: &'static str,
    /// Physics or measurement.
    pub kind: EffectKind,
    /// What it acts on.
    pub acts: Acts,
    /// Its name in plain words, for reports.
    pub phrase: &'static str,
    /// Whether it adds states to the model: the vehicle or its ground remembers.
    pub memory: bool,
    /// The paper's assumption that it lifts.
    pub lifts: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// Where the equation comes from.
    pub source: &'static str,
    /// What to check on the vehicle, its sensors or the ground once a diagnosis names the effect: one sentence.
    pub check: &'static str,
    /// What kind of thing it changes.
    pub class: Class,
    /// Whether the mechanism has other formulas as well: statics and geometry have one.
    pub formulas_differ: bool,
    /// Its parameters.
    pub parameters: &'static [ParameterDeclaration],
}

impl Acts {
    /// Physics of the vehicle and its ground, or a property of the sensors.
    #[must_use]
    pub const fn kind(self) -> EffectKind {
        match self {
            Self::Sensors => EffectKind::Measurement,
            _ => EffectKind::Physics,
        }
    }
}

/// Declares an effect: the struct of its parameters, generic over the scalar, and its
/// [`Declaration`].
macro_rules! effect {
    (
        $(#[$doc:meta])*
        $name:ident: $key:literal, $acts:ident $(($axis:ident))? $(+ $memory:ident)?,
        phrase $phrase:literal,
        lifts $lifts:literal,
        equation $equation:literal,
        source $source:literal,
        check $check:literal,
        $(class $class:ident,)?
        $(formulas $differ:ident,)?
        {
            $($field:ident [$unit:literal] $low:literal..$high:literal, $role:ident $default:literal,
                $prior:ident($centre:literal, $deviation:literal), $what:literal
                $(, $flag:ident $(($step:expr))?)?;)*
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name<S> {
            $(#[doc = concat!($what, " \\[", $unit, "\\].")] pub $field: S,)*
        }

        impl<S: Copy> $name<S> {
            /// What is declared of it.
            pub const DECLARATION: $crate::effects::Declaration = $crate::effects::Declaration {
                name: $key,
                kind: $crate::effects::Acts::$acts $(($crate::effects::Axis::$axis))?.kind(),
                acts: $crate::effects::Acts::$acts $(($crate::effects::Axis::$axis))?,
                phrase: $phrase,
                memory: effect!(@memory $($memory)?),
                lifts: $lifts,
                equation: $equation,
                source: $source,
                check: $check,
                class: effect!(@class $acts $($class)?),
                formulas_differ: effect!(@differ $($differ)?),
                parameters: &[$($crate::effects::ParameterDeclaration {
                    name: stringify!($field),
                    unit: $unit,
                    low: $low,
                    high: $high,
                    default: $default,
                    switches: effect!(@switches $role),
                    prior: effect!(@prior $prior, $centre, $deviation),
                    description: $what,
                    first_step: effect!(@step $($flag $(($step))?)?),
                    estimated_shape: effect!(@shape $($flag)?),
                    on_map: effect!(@map $($flag)?),
                },)*],
            };

            /// From the parameters in the order of the declaration.
            pub(crate) fn from_slice(values: &[S]) -> Self {
                let mut values = values.iter().copied();
                $(let $field = values.next().expect("as many values as the declaration has");)*
                Self { $($field),* }
            }

            /// The parameters in the order of the declaration.
            #[allow(dead_code)]
            pub(crate) fn to_array(self) -> [S; $name::<f64>::DECLARATION.parameters.len()] {
                [$(self.$field),*]
            }
        }
    };
    (@class Sensors) => { $crate::effects::Class::Sensor };
    (@class Slope) => { $crate::effects::Class::Gravity };
    (@class SoilByPlace) => { $crate::effects::Class::Ground };
    (@class $acts:ident) => { $crate::effects::Class::Resistance };
    (@class $acts:ident $class:ident) => { $crate::effects::Class::$class };
    (@differ differ) => { true };
    (@differ) => { false };
    (@memory memory) => { true };
    (@memory) => { false };
    (@step first_step_to($value:expr)) => { $crate::effects::FirstStep::To($value) };
    (@step first_step_of($function:expr)) => { $crate::effects::FirstStep::Of($function) };
    (@step $($flag:ident)?) => { $crate::effects::FirstStep::Derivative };
    (@shape estimated) => { true };
    (@shape $($flag:ident)?) => { false };
    (@map on_map) => { true };
    (@map $($flag:ident)?) => { false };
    (@switches off) => { true };
    (@switches shape) => { false };
    (@prior normal, $mean:literal, $deviation:literal) => {
        $crate::effects::Prior::Normal { mean: $mean, deviation: $deviation }
    };
    (@prior lognormal, $median:literal, $deviation:literal) => {
        $crate::effects::Prior::LogNormal { median: $median, deviation: $deviation }
    };
}
pub(crate) use effect;
