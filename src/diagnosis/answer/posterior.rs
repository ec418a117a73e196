//! Posterior probabilities from log odds.

use crate::diagnosis::Subject;
use crate::diagnosis::search::accepted::{NOTHING, Rival, likeliest_first};

/// Probability of "unknown" whatever the evidence: now and then something outside the catalogue imitates an effect
/// exactly.
pub const DOUBT: f64 = 0.03;
/// Log odds of a rival that was compared under its own noise are divided by sqrt(1 + pi s^2 / 8), with the standard error
/// s of its distance: the logistic approximation of the normal integral over it. Where no formula is the world's, which
/// one is nearest depends on what was driven (J. Huggins & J. Miller, "Reproducible model selection using bagged
/// posteriors", Bayesian Analysis 18 (2023)). Those of others and of "nothing" are divided by a temperature: `SILENT` if "nothing" leads, rising linearly to `TEMPERATURE` where the leader
/// exceeds "nothing" by `CLEAR`, plus `PER_ROOT` times the root of the largest log odds.
const SILENT: f64 = 0.75;
const TEMPERATURE: f64 = 2.0;
const CLEAR: f64 = 3.0;
const PER_ROOT: f64 = 0.02;
/// Those of names are divided by this share of the largest more. A formula is an approximation: also with its shape
/// freedom the right mechanism misses some of the evidence, 1.1 % in both of two drives with other formulas (a drag
/// along the vehicle alone on dry clay, a resistance that grows with slip on dry sand). With a scatter of 0.8 %, the
/// logistic approximation of the normal integral gives sqrt(pi / 8) times that.
const FORMULA: f64 = 0.005;

/// Temperature of log odds whose largest is `top`.
fn temperature(top: f64) -> f64 {
    let clear = ((top - NOTHING) / CLEAR).clamp(0.0, 1.0);
    SILENT + (TEMPERATURE - SILENT) * clear + PER_ROOT * top.max(0.0).sqrt()
}

/// What is added for names.
fn further(subject: Subject, top: f64) -> f64 {
    match subject {
        Subject::Effect(_) => FORMULA * top.max(0.0),
        Subject::Data | Subject::Unknown | Subject::Nothing => 0.0,
    }
}

/// Probabilities of subjects; they sum to 1.
#[derive(Debug, Clone)]
pub struct Posterior(pub Vec<(Subject, f64)>);

impl Posterior {
    /// From rivals and the log odds of "nothing".
    #[must_use]
    pub fn new(rivals: &[Rival], nothing: f64) -> Self {
        let mut all = vec![Rival::new(Subject::Nothing, nothing)];
        all.extend_from_slice(rivals);
        let logs = likeliest_first(&all);
        let top = logs[0].odds;
        let common = temperature(top);
        let temperature = |one: &Rival| match one.scatter {
            Some(scatter) => (1.0 + std::f64::consts::PI / 8.0 * scatter * scatter).sqrt(),
            None => common + further(one.subject, top),
        };
        let weight = |one: &Rival| ((one.odds - top) / temperature(one)).exp();
        let sum: f64 = logs.iter().map(weight).sum();
        let share = |one: &Rival| (one.subject, weight(one) / sum);
        Self(logs.iter().map(share).collect()).with(Subject::Unknown, DOUBT)
    }

    /// Probability of a subject.
    #[must_use]
    pub fn of(&self, subject: Subject) -> f64 {
        let found = self.0.iter().find(|(other, _)| *other == subject);
        found.map_or(0.0, |(_, share)| *share)
    }

    /// Probability that it is physics.
    #[must_use]
    pub fn physics(&self) -> f64 {
        let is = |subject: Subject| !subject.is_sensor() && subject != Subject::Nothing;
        self.0
            .iter()
            .filter(|(s, _)| is(*s))
            .map(|(_, share)| share)
            .sum()
    }

    /// With a share of one subject's probability spread evenly over others.
    #[must_use]
    pub fn shared(mut self, from: Subject, share: f64, among: &[Subject]) -> Self {
        let Some(own) = self.0.iter_mut().find(|(other, _)| *other == from) else {
            return self;
        };
        let moved = if among.is_empty() { 0.0 } else { share * own.1 };
        own.1 -= moved;
        for subject in among {
            let each = moved / among.len() as f64;
            match self.0.iter_mut().find(|(other, _)| other == subject) {
                Some((_, other)) => *other += each,
                None => self.0.push((*subject, each)),
            }
        }
        self
    }

    /// With this probability of a subject, unless it has more.
    #[must_use]
    pub fn with_at_least(self, subject: Subject, probability: f64) -> Self {
        let own = self.of(subject);
        if own >= probability {
            self
        } else {
            self.with(subject, (probability - own) / (1.0 - own))
        }
    }

    /// With a share of all probability given to a subject.
    #[must_use]
    pub fn with(mut self, subject: Subject, share: f64) -> Self {
        for (_, other) in &mut self.0 {
            *other *= 1.0 - share;
        }
        match self.0.iter_mut().find(|(other, _)| *other == subject) {
            Some((_, own)) => *own += share,
            None => self.0.push((subject, share)),
        }
        self
    }
}

/// Mean over several findings, weighted by evidence. "Nothing" requires that all of them are wrong.
#[must_use]
pub fn mean(each: &[(Posterior, f64)]) -> Option<Posterior> {
    let total: f64 = each.iter().map(|(_, gain)| gain).sum();
    let mut sum: Vec<(Subject, f64)> = Vec::new();
    for (odds, gain) in each {
        let weight = if total > 0.0 {
            gain / total
        } else {
            1.0 / each.len() as f64
        };
        for (subject, share) in &odds.0 {
            match sum.iter_mut().find(|(other, _)| other == subject) {
                Some((_, total)) => *total += weight * share,
                None => sum.push((*subject, weight * share)),
            }
        }
    }
    if each.len() > 1 {
        let all_wrong: f64 = each
            .iter()
            .map(|(odds, _)| odds.of(Subject::Nothing))
            .product();
        let nothing = Posterior(sum.clone()).of(Subject::Nothing);
        for (subject, share) in &mut sum {
            *share = match subject {
                Subject::Nothing => all_wrong,
                _ => *share * ((1.0 - all_wrong) / (1.0 - nothing)),
            };
        }
    }
    (!sum.is_empty()).then_some(Posterior(sum))
}

/// Each subject once, with its best odds, for a reader.
#[must_use]
pub fn pairs(rivals: &[Rival]) -> Vec<(Subject, f64)> {
    let each = likeliest_first(rivals).into_iter();
    each.map(|one| (one.subject, one.odds)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_sum_to_one_and_follow_the_evidence() {
        let (a, b) = (Subject::Effect(0), Subject::Effect(1));
        let of = |odds: &[(Subject, f64)]| {
            let rivals = odds
                .iter()
                .map(|(subject, odds)| Rival::new(*subject, *odds));
            Posterior::new(&rivals.collect::<Vec<_>>(), NOTHING)
        };
        let odds = of(&[(a, 20.0), (b, 4.0), (a, 3.0)]);
        let sum: f64 = odds.0.iter().map(|(_, share)| share).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        assert!(odds.of(a) > 0.95 && odds.of(b) < odds.of(a));
        assert!((odds.of(Subject::Unknown) - DOUBT).abs() < 1e-12);
        // The same lead counts less at larger odds.
        let ahead = |top: f64| of(&[(a, top), (b, top - 8.0)]).of(a);
        assert!(ahead(20.0) > ahead(200.0) && ahead(200.0) > ahead(2000.0));
        assert!(ahead(2000.0) > 0.5);
        let shared = odds.with(Subject::Unknown, 0.5);
        let sum: f64 = shared.0.iter().map(|(_, share)| share).sum();
        assert!((sum - 1.0).abs() < 1e-12 && shared.of(Subject::Unknown) > 0.5);
        let raised = of(&[(a, 20.0)]).with_at_least(Subject::Unknown, 0.3);
        assert!((raised.of(Subject::Unknown) - 0.3).abs() < 1e-12);
        let kept = raised.clone().with_at_least(Subject::Unknown, 0.2);
        assert!((kept.of(a) - raised.of(a)).abs() < 1e-12);
        // A residual model has no formula that could be another one.
        let law = of(&[(a, 2000.0), (Subject::Unknown, 1970.0)]);
        let name = of(&[(a, 2000.0), (b, 1970.0)]);
        assert!(law.of(a) > 0.96 && name.of(a) < 0.92);
        let nothing = of(&[]).of(Subject::Nothing);
        assert!((nothing - (1.0 - DOUBT)).abs() < 1e-12);
    }

    #[test]
    fn a_lead_within_its_standard_error_decides_nothing() {
        let (a, b) = (Subject::Effect(0), Subject::Effect(1));
        let leader = |behind: f64, scatter: f64| {
            let compared = |subject, odds, scatter| Rival {
                scatter: Some(scatter),
                ..Rival::new(subject, odds)
            };
            let rivals = [
                compared(a, 200.0, 0.0),
                compared(b, 200.0 - behind, scatter),
            ];
            Posterior::new(&rivals, NOTHING).of(a)
        };
        // Of a formula that is the world's, a lead of M has the standard error sqrt(2 M).
        assert!(leader(20.0, 40.0_f64.sqrt()) > 0.95);
        // Probability of a normal variable with this mean and deviation to be positive.
        assert!((leader(20.0, 20.0) / (1.0 - DOUBT) - 0.841).abs() < 0.02);
        assert!(leader(20.0, 80.0) < 0.6);
    }
}
