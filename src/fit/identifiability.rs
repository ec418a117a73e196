//! What the data leave undetermined, in words.

use super::parameter::FreeParameter;
use super::uncertainty::Uncertainty;
use nalgebra::DMatrix;
use std::fmt;

/// A parameter whose interval is not narrower than this share of the prior's is not determined by
/// the data.
const UNTOLD: f64 = 0.7;
/// Parameters that are correlated beyond this are determined only together.
const TOGETHER: f64 = 0.95;
/// The data determine a combination if they narrow it to this share of the prior.
const FIXED: f64 = 0.5;
/// Shares of a combination below this are left out.
const SMALL_SHARE: f64 = 0.3;

/// Something that the data leave open.
#[derive(Debug, Clone, PartialEq)]
pub enum Limit {
    /// The data hardly narrow a parameter: its standard deviation over the prior's.
    Untold {
        /// Name of the parameter.
        parameter: String,
        /// The ratio.
        ratio: f64,
    },
    /// Two parameters of which the data determine a combination alone.
    Together {
        /// Names.
        parameters: [String; 2],
        /// Their correlation.
        correlation: f64,
    },
    /// A parameter that ended on a bound.
    AtBound {
        /// Name.
        parameter: String,
        /// The bound, in the parameter's unit.
        bound: f64,
        /// The unit.
        unit: &'static str,
    },
    /// How many combinations of the model's parameters the data determine, of how many; with the
    /// one determined worst.
    Combinations {
        /// Told by the data.
        told: usize,
        /// All.
        all: usize,
        /// Name and share of what makes up the worst one.
        worst: Vec<(String, f64)>,
    },
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Untold { parameter, ratio } if *ratio > 1.0 => write!(
                f,
                "the data contradict themselves about {parameter}: from segment to segment it scatters by more than the \
                 prior allows (its interval is {:.0} % of the prior's)",
                100.0 * ratio
            ),
            Self::Untold { parameter, ratio } => write!(
                f,
                "the data say nothing about {parameter}: its interval is {:.0} % of the prior's; \
                 what is shown is the prior",
                100.0 * ratio
            ),
            Self::Together {
                parameters: [a, b],
                correlation,
            } => write!(
                f,
                "only a combination of {a} and {b} is known (correlation {correlation:.2}): {}",
                if *correlation > 0.0 {
                    "raising both fits as well"
                } else {
                    "raising one and lowering the other fits as well"
                }
            ),
            Self::AtBound {
                parameter,
                bound,
                unit,
            } => write!(
                f,
                "{parameter} ended on its bound of {bound} {unit}: the model cannot explain these \
                 data with a plausible value"
            ),
            Self::Combinations { told, all, worst } => {
                let words: Vec<String> = worst
                    .iter()
                    .map(|(name, share)| format!("{share:+.1} {name}"))
                    .collect();
                write!(
                    f,
                    "the data fix {told} combinations of the {all} model parameters; the least known is {}",
                    words.join(" ")
                )
            }
        }
    }
}

/// What the data leave open at a fitted point; the first `model` parameters are the model's.
#[must_use]
pub fn limits(
    parameters: &[FreeParameter],
    model: usize,
    coordinates: &[f64],
    uncertainty: &Uncertainty,
) -> Vec<Limit> {
    let mut limits = Vec::new();
    let ratio = |k: usize| uncertainty.deviation(k) / parameters[k].prior.deviation;
    for (k, parameter) in parameters.iter().enumerate() {
        let (low, high) = parameter.bounds();
        let near = 1e-9 * (high - low);
        for (at, bound) in [(low, parameter.low), (high, parameter.high)] {
            if (coordinates[k] - at).abs() <= near {
                limits.push(Limit::AtBound {
                    parameter: parameter.name.clone(),
                    bound,
                    unit: parameter.unit,
                });
            }
        }
        if ratio(k) > UNTOLD {
            limits.push(Limit::Untold {
                parameter: parameter.name.clone(),
                ratio: ratio(k),
            });
        }
    }
    for a in 0..parameters.len() {
        for b in a + 1..parameters.len() {
            let correlation = uncertainty.correlation(a, b);
            if correlation.abs() > TOGETHER {
                limits.push(Limit::Together {
                    parameters: [&parameters[a], &parameters[b]].map(|p| p.name.clone()),
                    correlation,
                });
            }
        }
    }
    limits.extend(combinations(parameters, model, uncertainty));
    limits
}

/// Directions in the model's parameters, each in units of its prior, by how far the data
/// narrow them: eigenvectors of the posterior covariance. Reported only where some are not determined.
fn combinations(
    parameters: &[FreeParameter],
    model: usize,
    uncertainty: &Uncertainty,
) -> Option<Limit> {
    if model < 2 {
        return None;
    }
    let scaled = DMatrix::from_fn(model, model, |a, b| {
        let units = parameters[a].prior.deviation * parameters[b].prior.deviation;
        uncertainty.covariance[(a, b)] / units
    });
    let eigen = scaled.symmetric_eigen();
    let told = eigen
        .eigenvalues
        .iter()
        .filter(|v| v.sqrt() < FIXED)
        .count();
    let worst = eigen.eigenvalues.iamax();
    let (name, mut shares) = (
        |k: usize| parameters[k].name.clone(),
        eigen.eigenvectors.column(worst).clone_owned(),
    );
    // The sign of an eigenvector is arbitrary: its largest share is made positive.
    if shares[shares.iamax()] < 0.0 {
        shares = -shares;
    }
    let mut words: Vec<(String, f64)> = (0..model).map(|k| (name(k), shares[k])).collect();
    words.retain(|(_, share)| share.abs() >= SMALL_SHARE);
    words.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    (told < model).then_some(Limit::Combinations {
        told,
        all: model,
        worst: words,
    })
}
