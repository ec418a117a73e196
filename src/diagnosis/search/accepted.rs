//! An accepted effect with its rivals.

use super::proposal::Proposal;
use crate::diagnosis::Subject;
use crate::effects::CATALOGUE;

/// Margin of log odds over "nothing more" for acceptance, prior included.
pub const TAKE: f64 = 0.5;
/// Log prior of "nothing more" relative to one effect of the catalogue.
pub const NOTHING: f64 = 4.5;
/// Log prior odds that what the neighbourhood of a name explains is that mechanism and none outside the catalogue.
pub const CATALOGUED: f64 = 5.0;

/// A candidate with its log odds in the place of an accepted effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rival {
    /// What.
    pub subject: Subject,
    /// Log odds, its prior included.
    pub odds: f64,
    /// Standard error of its distance to the accepted one, from the scatter of their log likelihoods in time; `None` if
    /// they were not compared under their own noise.
    pub scatter: Option<f64>,
}

impl Rival {
    /// One that was not compared.
    #[must_use]
    pub fn new(subject: Subject, odds: f64) -> Self {
        Self {
            subject,
            odds,
            scatter: None,
        }
    }
}

/// Each subject once, with its best odds, the likeliest first.
#[must_use]
pub fn likeliest_first(rivals: &[Rival]) -> Vec<Rival> {
    let mut sorted = rivals.to_vec();
    sorted.sort_by(|a, b| b.odds.total_cmp(&a.odds));
    let mut once: Vec<Rival> = Vec::new();
    for one in sorted {
        if !once.iter().any(|other| other.subject == one.subject) {
            once.push(one);
        }
    }
    once
}

/// An accepted effect.
#[derive(Debug, Clone)]
pub struct AcceptedEffect {
    /// What was proposed.
    pub proposal: Proposal,
    /// Log Bayes factor against the hypothesis without it, by the catalogue's formulas or neighbours of them.
    pub gain: f64,
    /// All that was fitted in its place, itself among them.
    pub rivals: Vec<Rival>,
    /// Whether it only mends the formulas of the others, as a residual model does within their shape freedom.
    pub mends: bool,
}

/// Whether a name has a residual model beside it that mends its formula.
#[must_use]
pub fn is_mended(accepted: &[AcceptedEffect], index: usize) -> bool {
    let named = |effect: &AcceptedEffect| matches!(effect.proposal.subject, Subject::Effect(k) if CATALOGUE[k].formulas_differ);
    named(&accepted[index]) && accepted.iter().any(|effect| effect.mends)
}

impl AcceptedEffect {
    /// Log odds of a subject in its place.
    #[must_use]
    pub fn odds(&self, subject: Subject) -> f64 {
        let own = self.rivals.iter().filter(|one| one.subject == subject);
        own.map(|one| one.odds).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Takes over the odds of later fits, also of what was not fitted before. The other rivals keep their distance.
    pub fn stand_anew(&mut self, fitted: &[Rival]) {
        let fitted = likeliest_first(fitted);
        let anew = |subject: Subject| fitted.iter().find(|one| one.subject == subject);
        let subject = self.proposal.subject;
        let (before, Some(now)) = (self.odds(subject), anew(subject)) else {
            return;
        };
        for rival in &mut self.rivals {
            match anew(rival.subject) {
                Some(anew) => *rival = *anew,
                None => rival.odds += now.odds - before,
            }
        }
        let known: Vec<Subject> = self.rivals.iter().map(|one| one.subject).collect();
        let new = fitted.into_iter();
        self.rivals
            .extend(new.filter(|one| !known.contains(&one.subject)));
    }

    /// Limits the log odds of rivals relative to its own.
    pub fn limit(&mut self, far: &[(Subject, f64)]) {
        let own = self.odds(self.proposal.subject);
        for rival in &mut self.rivals {
            if let Some((_, behind)) = far.iter().find(|(subject, _)| *subject == rival.subject) {
                rival.odds = rival.odds.min(own + behind);
            }
        }
    }

    /// Lowers its own odds; those of its rivals stay.
    pub fn lose(&mut self, odds: f64) {
        let own = self.rivals.iter_mut();
        for one in own.filter(|one| one.subject == self.proposal.subject) {
            one.odds -= odds;
        }
    }

    /// A residual model that was ahead of a name is now behind by this much.
    pub fn outdo_residual_model(&mut self, advantage: f64) {
        let subject = self.proposal.subject;
        if subject == Subject::Unknown {
            return;
        }
        let own = self.odds(subject);
        for rival in &mut self.rivals {
            if rival.subject == Subject::Unknown {
                rival.odds = rival.odds.min(own - advantage);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(rivals: &[(usize, f64)]) -> AcceptedEffect {
        let rival = |(effect, odds): &(usize, f64)| Rival::new(Subject::Effect(*effect), *odds);
        AcceptedEffect {
            proposal: Proposal::new(Subject::Effect(0), Vec::new()),
            gain: rivals[0].1,
            rivals: rivals.iter().map(rival).collect(),
            mends: false,
        }
    }

    #[test]
    fn odds_of_a_later_fit_count_and_the_rest_stays_as_far_behind() {
        let mut one = effect(&[(0, 100.0), (1, 98.0), (2, 60.0)]);
        let fitted = |effect: usize, odds: f64| Rival::new(Subject::Effect(effect), odds);
        one.stand_anew(&[fitted(1, 900.0), fitted(0, 1000.0)]);
        let odds: Vec<f64> = one.rivals.iter().map(|one| one.odds).collect();
        assert_eq!(odds, [1000.0, 900.0, 960.0]);
        one.stand_anew(&[fitted(0, 1000.0), fitted(3, 1010.0)]);
        assert_eq!(one.rivals[3].odds, 1010.0);
        one.limit(&[(Subject::Effect(2), -50.0), (Subject::Effect(1), -200.0)]);
        let odds: Vec<f64> = one.rivals.iter().map(|one| one.odds).collect();
        assert_eq!(odds, [1000.0, 800.0, 950.0, 1010.0]);
        // A rival that was not fitted again has no new odds.
        one.stand_anew(&[fitted(1, 5.0)]);
        assert_eq!(one.rivals[1].odds, 800.0);
    }
}
