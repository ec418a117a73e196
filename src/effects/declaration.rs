//! What is said of an effect: its parameters, its equation and source, and the assumption that
//! it lifts.

use crate::parameter::{Bounds, ParameterError};

/// Physics of the vehicle and the ground, or a property of the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectKind {
    /// Changes how the vehicle moves.
    Physics,
    /// Changes what the sensors report; never to be blamed on the soil.
    Measurement,
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterDeclaration {
    /// Name in files.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Least value.
    pub low: f64,
    /// Greatest value.
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

/// One effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Declaration {
    /// Name in files and in the diagnosis.
    pub name: &'static str,
    /// Physics or measurement.
    pub kind: EffectKind,
    /// The paper's assumption that it lifts.
    pub lifts: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// Where the equation comes from.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [ParameterDeclaration],
}

/// Declares an effect: the struct of its parameters, generic over the scalar, and its
/// [`Declaration`].
macro_rules! effect {
    (
        $(#[$doc:meta])*
        $name:ident: $key:literal, $kind:ident,
        lifts $lifts:literal,
        equation $equation:literal,
        source $source:literal,
        {
            $($field:ident [$unit:literal] $low:literal..$high:literal, $role:ident $default:literal,
                $prior:ident($centre:literal, $deviation:literal), $what:literal;)*
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
                kind: $crate::effects::EffectKind::$kind,
                lifts: $lifts,
                equation: $equation,
                source: $source,
                parameters: &[$($crate::effects::ParameterDeclaration {
                    name: stringify!($field),
                    unit: $unit,
                    low: $low,
                    high: $high,
                    default: $default,
                    switches: effect!(@switches $role),
                    prior: effect!(@prior $prior, $centre, $deviation),
                    description: $what,
                },)*],
            };

            /// From the parameters in the order of the declaration.
            pub(crate) fn from_slice(values: &[S]) -> Self {
                let mut values = values.iter().copied();
                $(let $field = values.next().expect("as many values as the declaration has");)*
                Self { $($field),* }
            }
        }
    };
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
