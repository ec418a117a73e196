//! How far a fitted law is from trials that it was not fitted to.

use super::data::{Condition, Trial};
use super::fit::Fit;
use super::law::Rig;

/// Draws of the bootstrap.
const DRAWS: usize = 2000;

/// A value and its 95 % interval.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    pub value: f64,
    pub interval: [f64; 2],
}

/// Errors of a fitted law.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Root mean square of traction and side force \[N\], sinkage \[m\].
    pub rmse: [Estimate; 3],
    /// 1 - sum of squared errors / sum of squared deviations from the mean.
    pub r2: [Estimate; 3],
    /// Squared errors and measured values of each condition's trials.
    conditions: Vec<Vec<([f64; 3], [f64; 3])>>,
}

impl Judged {
    pub fn new(rig: &Rig, fit: &Fit, trials: &[Trial]) -> Self {
        let mut names: Vec<Condition> = trials.iter().map(Trial::condition).collect();
        names.sort_unstable();
        names.dedup();
        let error = |trial: &Trial| {
            let (measured, found) = (trial.measured(), rig.predict(&fit.law, &fit.values, trial));
            let squared = |output: usize| (found.values[output] - measured[output]).powi(2);
            ([0, 1, 2].map(squared), measured)
        };
        let of = |name: &Condition| {
            trials
                .iter()
                .filter(|t| t.condition() == *name)
                .map(error)
                .collect()
        };
        let conditions: Vec<Vec<_>> = names.iter().map(of).collect();
        let all: Vec<usize> = (0..conditions.len()).collect();
        let draws: Vec<[[f64; 3]; 2]> = draws(all.len())
            .iter()
            .map(|draw| scores(&conditions, draw))
            .collect();
        let whole = scores(&conditions, &all);
        let estimate = |score: usize, output: usize| {
            let mut values: Vec<f64> = draws.iter().map(|draw| draw[score][output]).collect();
            Estimate {
                value: whole[score][output],
                interval: middle(&mut values),
            }
        };
        Self {
            rmse: [0, 1, 2].map(|output| estimate(0, output)),
            r2: [0, 1, 2].map(|output| estimate(1, output)),
            conditions,
        }
    }

    /// By what share of another's root mean square an output's is smaller, of the same trials.
    pub fn gain_over(&self, other: &Self, output: usize) -> Estimate {
        let gain = |draw: &[usize]| {
            let [mine, theirs] =
                [self, other].map(|judged| scores(&judged.conditions, draw)[0][output]);
            1.0 - mine / theirs
        };
        let all: Vec<usize> = (0..self.conditions.len()).collect();
        let mut values: Vec<f64> = draws(all.len()).iter().map(|draw| gain(draw)).collect();
        Estimate {
            value: gain(&all),
            interval: middle(&mut values),
        }
    }
}

/// Root mean square errors and R2 of the conditions drawn.
fn scores(conditions: &[Vec<([f64; 3], [f64; 3])>], draw: &[usize]) -> [[f64; 3]; 2] {
    let trials = || draw.iter().flat_map(|&place| &conditions[place]);
    let count = trials().count() as f64;
    let mut result = [[0.0; 3]; 2];
    for output in 0..3 {
        let mean = trials().map(|(_, measured)| measured[output]).sum::<f64>() / count;
        let errors: f64 = trials().map(|(errors, _)| errors[output]).sum();
        let spread: f64 = trials()
            .map(|(_, measured)| (measured[output] - mean).powi(2))
            .sum();
        result[0][output] = (errors / count).sqrt();
        result[1][output] = 1.0 - errors / spread;
    }
    result
}

/// The same draws of conditions with replacement for every law.
fn draws(count: usize) -> Vec<Vec<usize>> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        // Marsaglia's xorshift.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % count
    };
    (0..DRAWS)
        .map(|_| (0..count).map(|_| next()).collect())
        .collect()
}

/// The middle 95 %.
fn middle(values: &mut [f64]) -> [f64; 2] {
    values.sort_unstable_by(f64::total_cmp);
    [0.025, 0.975].map(|share| values[(share * (values.len() - 1) as f64).round() as usize])
}
