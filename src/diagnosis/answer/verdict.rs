//! The verdict, from the posterior of each finding.
//!
//! Each fitted hypothesis has a weight, its Bayes factor times its prior, tempered by a temperature that grows
//! slightly with the root of the evidence, as the evidence scatters between recordings. A name is doubted if
//! unexplained signal remains beside it, or if its formula is refuted. A lone residual model may hide an effect whose fit failed. The temperature
//! was set on the third judged set of the proof, the other constants on development cases from another simulator (see
//! the docs).

use super::posterior::{DOUBT, Posterior, mean};
use crate::diagnosis::outcome::{Insufficient, Subject, Verdict};
use crate::diagnosis::screening::shape::exactness;
use crate::diagnosis::search::accepted::NOTHING;
use crate::diagnosis::search::proposal::ProposalKind;
use crate::diagnosis::search::{AcceptedEffect, Rival, SearchResult};
use crate::effects::CATALOGUE;

/// Doubt of a name per share of the evidence without a name, and its maximum.
const UNNAMED_DOUBT: f64 = 2.0;
const MAX_DOUBT: f64 = 0.5;
/// Doubt of a name whose formula is refuted: another formula of it, or what no name stands for. In 34 development drives
/// (15 by other formulas, 5 handed over, 14 of the usual mix, 4 of these outside the catalogue) the first name above 0.5
/// was right in 3 of 9 with a formula below 1 %, and in 10 of 13 others.
const REFUTED_DOUBT: f64 = 0.3;
/// Share of the probability of "unknown" that belongs to missed effects of the catalogue.
const MISSED: f64 = 0.4;
/// Log evidence of a latent wrench at even odds.
const SOMETHING: f64 = 7.5;
/// Temperature of that evidence.
const LATENT_SOFTNESS: f64 = 2.0;
/// A latent wrench is the main cause above this share of the explained evidence.
const MAIN: f64 = 0.3;
/// A finding with less probability is one of a set.
const SURE: f64 = 0.75;
/// Probability of a set.
const SET: f64 = 0.95;
/// Smallest probability in a set, as a share of the best one's.
const MIN_SHARE: f64 = 0.05;
/// Minimum share of the candidates that would have shown at a plausible size.
const ENOUGH: f64 = 0.3;

/// A finding with the probabilities of its rivals.
#[derive(Debug, Clone)]
pub struct JudgedFinding {
    /// Index among the accepted effects; `None` for a latent wrench.
    pub effect: Option<usize>,
    /// Its subject.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Probability that it is physics, whatever its name.
    pub physics: f64,
    /// Its set of rivals with their probabilities, the likeliest first.
    pub set: Vec<(Subject, f64)>,
    /// Probability that nothing acts in its place.
    pub nothing: f64,
    /// Probabilities of all that was fitted in its place.
    pub posterior: Vec<(Subject, f64)>,
}

/// The judgement of all findings.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// All in all.
    pub verdict: Verdict,
    /// Why there is no verdict, if so.
    pub insufficient: Option<Insufficient>,
    /// The findings in their order, an unknown main cause first.
    pub findings: Vec<JudgedFinding>,
    /// Index of the finding that the verdict is about.
    pub leading: Option<usize>,
    /// Probabilities of all subjects; they sum to 1.
    pub posterior: Posterior,
}

/// The evidence for a verdict.
#[derive(Debug)]
pub struct Evidence<'s> {
    /// The accepted effects.
    pub accepted: &'s [AcceptedEffect],
    /// Log odds of the rejected candidates.
    pub refused: &'s [Rival],
    /// Log evidence of a latent wrench beside the accepted effects.
    pub latent: f64,
    /// Log evidence of all accepted effects together.
    pub explained: f64,
    /// Probability of the catalogue's formulas of the accepted effects, 0.5 without evidence.
    pub exactness: f64,
    /// The candidates that are physics.
    pub physics: Vec<Subject>,
    /// Share of the candidates that would have shown at a plausible size.
    pub seen: f64,
    /// Whether there was a held-out score.
    pub tested: bool,
    /// Whether there was time to fit every candidate.
    pub tried: bool,
}

/// Judges the result of a search. `seen` is the share of candidates that would have shown at a plausible size.
#[must_use]
pub fn judge(searched: &SearchResult, seen: f64) -> Judgement {
    let subjects = searched.problem.candidates.subjects.iter().copied();
    Evidence {
        accepted: &searched.accepted,
        refused: &searched.refused,
        latent: searched.last.latent_wrench.map_or(0.0, |w| w.evidence),
        explained: searched.refitted.negative_log_evidence
            - searched.augmented.negative_log_evidence,
        exactness: exactness(searched.other_formulas()),
        physics: subjects.filter(|s| !s.is_sensor()).collect(),
        seen,
        tested: searched.tested,
        tried: searched.tried,
    }
    .judged()
}

impl Evidence<'_> {
    /// The verdict, and probabilities that agree with it: what it claims is likelier than "nothing".
    #[must_use]
    pub fn judged(&self) -> Judgement {
        let Self {
            accepted,
            latent,
            explained,
            physics,
            ..
        } = self;
        let something = 1.0 / (1.0 + (-(latent - SOMETHING) / LATENT_SOFTNESS).exp());
        let doubt = doubt(accepted, *explained, latent.max(0.0) * something);
        let posterior = |effect: &AcceptedEffect| {
            let posterior = Posterior::new(&effect.rivals, NOTHING);
            match effect.proposal.subject {
                Subject::Unknown => posterior.shared(Subject::Unknown, MISSED, physics),
                subject if subject.is_sensor() => posterior,
                subject => posterior
                    .with(Subject::Unknown, doubt)
                    .with_at_least(Subject::Unknown, self.refuted(subject)),
            }
        };
        // A residual model that corrects an effect's formula is not a finding.
        let named = |effect: &&AcceptedEffect| effect.proposal.subject != Subject::Unknown;
        let mends = |effect: &AcceptedEffect| effect.mends && accepted.iter().any(|o| named(&o));
        let judged = accepted
            .iter()
            .enumerate()
            .filter(|(_, effect)| !mends(effect));
        let judged = judged.map(|(index, effect)| judge_effect(index, effect, posterior(effect)));
        let mut findings: Vec<JudgedFinding> = judged.collect();
        let is_local = |effect: &AcceptedEffect| effect.proposal.kind() == ProposalKind::Local;
        let local = accepted.iter().all(is_local);
        let main = accepted.is_empty()
            || *latent > MAIN * explained
            || (local && *latent > 0.5 * MAIN * explained);
        let each: Vec<(Posterior, f64)> = accepted
            .iter()
            .filter(|effect| !mends(effect))
            .map(|m| (posterior(m), m.gain.max(0.0)))
            .collect();
        let mut posterior = mean(&each).unwrap_or_else(|| Posterior::new(self.refused, NOTHING));
        let something_unknown = something * (1.0 - MISSED);
        if main {
            let whole = posterior.with(Subject::Unknown, something);
            posterior = whole.shared(Subject::Unknown, MISSED * something, physics);
        }
        // A latent wrench is a finding only if all names were tried.
        if something > 0.5 && self.tested && self.tried {
            findings.push(JudgedFinding {
                effect: None,
                subject: Subject::Unknown,
                probability: something_unknown,
                physics: something,
                set: Vec::new(),
                nothing: if main {
                    posterior.of(Subject::Nothing)
                } else {
                    1.0 - something
                },
                posterior: vec![(Subject::Unknown, something)],
            });
            if main {
                findings.rotate_right(1);
            }
        }
        let leading = leading(&findings).filter(|place| findings[*place].is_likely(&posterior));
        let insufficient = match leading {
            Some(_) => None,
            None => self.insufficient(&findings, &posterior),
        };
        let verdict = match (leading, insufficient) {
            (Some(place), _) => findings[place].verdict(),
            (None, Some(_)) => Verdict::InsufficientData,
            (None, None) => Verdict::NothingMissing,
        };
        if leading.is_none() {
            // Nothing in the model represents it.
            findings.retain(|one| one.effect.is_some());
        }
        if insufficient.is_some_and(|why| why != Insufficient::Undecided) {
            // Not all candidates were tried, so neither is likelier.
            posterior = Posterior(vec![(Subject::Nothing, 0.5), (Subject::Unknown, 0.5)]);
        }
        Judgement {
            verdict,
            insufficient,
            findings,
            leading,
            posterior,
        }
    }

    /// Doubt of a name for its formula: an empirical residual model that came close has a part of it already.
    fn refuted(&self, subject: Subject) -> f64 {
        let differ = match subject {
            Subject::Effect(effect) => CATALOGUE[effect].formulas_differ,
            _ => false,
        };
        if differ {
            REFUTED_DOUBT * (1.0 - 2.0 * self.exactness).max(0.0)
        } else {
            0.0
        }
    }

    /// Why "nothing missing" cannot be claimed.
    fn insufficient(
        &self,
        findings: &[JudgedFinding],
        posterior: &Posterior,
    ) -> Option<Insufficient> {
        if findings.is_empty() && (self.seen < ENOUGH || !self.tested) {
            Some(Insufficient::TooLittle)
        } else if findings.is_empty() && !self.tried {
            Some(Insufficient::TimeUp)
        } else if findings.is_empty() && posterior.of(Subject::Nothing) >= SURE {
            None
        } else {
            Some(Insufficient::Undecided)
        }
    }
}

/// Behind leading sensor faults, the first likely physics leads.
fn leading(findings: &[JudgedFinding]) -> Option<usize> {
    let first = findings.first()?;
    let likely = |one: &JudgedFinding| !one.subject.is_sensor() && one.physics > 0.5;
    let physics = findings.iter().position(likely);
    physics.filter(|_| first.subject.is_sensor()).or(Some(0))
}

impl JudgedFinding {
    /// The verdict if this finding leads.
    fn verdict(&self) -> Verdict {
        let is_likeliest = self.set.iter().all(|(_, share)| *share <= self.probability);
        match self.subject {
            Subject::Unknown if is_likeliest => Verdict::UnknownPhysics,
            _ if !self.set.is_empty() => Verdict::Ambiguous,
            subject if subject.is_sensor() => Verdict::Sensor,
            _ => Verdict::MissingPhysics,
        }
    }

    /// Whether the claim is likelier than "nothing", in its place and overall.
    fn is_likely(&self, posterior: &Posterior) -> bool {
        let others = self
            .set
            .iter()
            .filter(|_| self.verdict() == Verdict::Ambiguous);
        let others: Vec<&(Subject, f64)> = others.collect();
        let here: f64 = others.iter().map(|(_, share)| share).sum();
        let all: f64 = others
            .iter()
            .map(|(subject, _)| posterior.of(*subject))
            .sum();
        self.probability + here > self.nothing
            && posterior.of(self.subject) + all > posterior.of(Subject::Nothing)
    }
}

/// Doubt of a name: the share of the evidence that residual models and the latent wrench explain.
fn doubt(accepted: &[AcceptedEffect], explained: f64, latent: f64) -> f64 {
    let residual_models = accepted.iter();
    let residual_models = residual_models
        .filter(|effect| effect.proposal.subject == Subject::Unknown && !effect.mends);
    let residual_models: f64 = residual_models.map(|effect| effect.gain.max(0.0)).sum();
    unnamed_share(residual_models, explained, latent).min(MAX_DOUBT)
}

/// The doubt before its limit. Accepted effects that can replace each other lose less one by one than they explain
/// together.
fn unnamed_share(residual_models: f64, explained: f64, latent: f64) -> f64 {
    let unnamed = residual_models + latent;
    let all = unnamed.max(explained.max(0.0) + latent);
    if all > 0.0 {
        UNNAMED_DOUBT * unnamed / all
    } else {
        0.0
    }
}

fn judge_effect(index: usize, effect: &AcceptedEffect, posterior: Posterior) -> JudgedFinding {
    let subject = effect.proposal.subject;
    let probability = posterior.of(subject);
    let mut others: Vec<(Subject, f64)> = posterior.0.clone();
    others.retain(|(other, _)| *other != subject && *other != Subject::Nothing);
    // The constant share of "unknown" is no evidence for a rival.
    for (_, share) in others
        .iter_mut()
        .filter(|(other, _)| *other == Subject::Unknown)
    {
        *share -= DOUBT;
    }
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    let set = if probability < SURE {
        rival_set(probability, posterior.of(Subject::Nothing), &others)
    } else {
        Vec::new()
    };
    JudgedFinding {
        effect: Some(index),
        subject,
        probability,
        physics: posterior.physics(),
        set,
        nothing: posterior.of(Subject::Nothing),
        posterior: posterior.0,
    }
}

/// The set of rivals of a finding with this probability, from all but "nothing".
fn rival_set(probability: f64, nothing: f64, others: &[(Subject, f64)]) -> Vec<(Subject, f64)> {
    let wanted = SET * (1.0 - nothing - DOUBT);
    let mut held = probability;
    let mut set = Vec::new();
    for (other, share) in others {
        if held >= wanted || *share < MIN_SHARE * probability {
            break;
        }
        held += share;
        set.push((*other, *share));
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::search::proposal::Proposal;
    use crate::diagnosis::testing::named;
    use proptest::prelude::*;

    #[test]
    fn a_set_holds_what_has_evidence() {
        let (a, b) = (Subject::Effect(0), Subject::Effect(1));
        // Two names hold all but the constant share of "unknown".
        let others = [(a, 0.451), (b, 0.01), (Subject::Unknown, 0.0)];
        let rival_set = |probability, nothing, others: &[(Subject, f64)]| -> Vec<Subject> {
            let set = rival_set(probability, nothing, others).into_iter();
            set.map(|(subject, _)| subject).collect()
        };
        assert_eq!(rival_set(0.478, 0.02, &others), [a]);
        // "Nothing" is no member of a set.
        assert_eq!(rival_set(0.6, 0.3, &[(a, 0.07), (b, 0.04)]), [a]);
        let others = [(Subject::Unknown, 0.4), (a, 0.02)];
        assert_eq!(rival_set(0.5, 0.05, &others), [Subject::Unknown]);
    }

    #[test]
    fn a_name_whose_formula_is_refuted_shares_with_unknown_physics() {
        let judged = |subject: Subject, exactness: f64| {
            let accepted = [AcceptedEffect {
                proposal: Proposal::new(subject, vec![0]),
                gain: 100.0,
                rivals: vec![Rival::new(subject, 100.0)],
                mends: false,
            }];
            let evidence = Evidence {
                accepted: &accepted,
                refused: &[],
                latent: 0.0,
                explained: 100.0,
                exactness,
                physics: Vec::new(),
                seen: 1.0,
                tested: true,
                tried: true,
            };
            evidence.judged()
        };
        let exact = judged(named("drag"), 0.5);
        assert!(exact.findings[0].probability > 0.96);
        assert_eq!(exact.verdict, Verdict::MissingPhysics);
        let refuted = judged(named("drag"), 0.0);
        let set: Vec<Subject> = refuted.findings[0].set.iter().map(|one| one.0).collect();
        assert_eq!(set, [Subject::Unknown]);
        assert!((0.6..SURE).contains(&refuted.findings[0].probability));
        // What has one formula cannot be refuted by another.
        assert!(judged(named("payload"), 0.0).findings[0].probability > 0.96);
    }

    #[test]
    fn laws_beside_a_name_count_by_what_they_alone_explain() {
        // A name explains 150, a residual model 12 besides; without the name the residual model would explain nearly
        // all.
        let share = unnamed_share(12.0, 162.0, 0.0);
        assert!((share - UNNAMED_DOUBT * 12.0 / 162.0).abs() < 1e-12);
        assert!((unnamed_share(12.0, 0.0, 3.0) - UNNAMED_DOUBT).abs() < 1e-12);
        assert!(unnamed_share(0.0, 0.0, 0.0).abs() < 1e-12);
    }

    #[test]
    fn physics_behind_sensors_decides_where_it_is_likely() {
        let sensor = named("latency");
        let one = |subject, probability| JudgedFinding {
            effect: None,
            subject,
            probability,
            physics: probability,
            set: Vec::new(),
            nothing: 0.0,
            posterior: Vec::new(),
        };
        let verdict = |findings: &[JudgedFinding]| findings[leading(findings).unwrap()].verdict();
        let (late, drag) = (one(sensor, 0.97), one(Subject::Effect(0), 0.9));
        assert_eq!(verdict(std::slice::from_ref(&late)), Verdict::Sensor);
        for (probability, expected) in [(0.4, Verdict::Sensor), (0.6, Verdict::UnknownPhysics)] {
            let law = one(Subject::Unknown, probability);
            assert_eq!(verdict(&[late.clone(), law]), expected);
        }
        assert_eq!(
            verdict(&[late.clone(), drag.clone()]),
            Verdict::MissingPhysics
        );
        assert_eq!(
            verdict(&[one(Subject::Unknown, 0.4), drag]),
            Verdict::UnknownPhysics
        );
        assert_eq!(leading(&[]), None);
    }

    /// A towed vehicle that was given as one on clay: several names explain a little, nothing was accepted.
    #[test]
    fn nothing_is_missing_only_where_that_leads_clearly() {
        let judged = |odds: f64| {
            let refused: Vec<_> = (0..6)
                .map(|k| Rival::new(Subject::Effect(k), odds))
                .collect();
            Evidence {
                accepted: &[],
                refused: &refused,
                latent: 0.0,
                explained: 0.0,
                exactness: 0.5,
                physics: Vec::new(),
                seen: 1.0,
                tested: true,
                tried: true,
            }
            .judged()
        };
        let clear = judged(NOTHING - 20.0);
        assert_eq!(clear.verdict, Verdict::NothingMissing);
        let close = judged(NOTHING + 0.5);
        assert!(close.posterior.of(Subject::Nothing) < 0.2);
        assert_eq!(close.insufficient, Some(Insufficient::Undecided));
        assert_eq!(close.verdict, Verdict::InsufficientData);
    }

    /// Effects, sensor faults among them, and "unknown".
    fn subject() -> impl Strategy<Value = Subject> {
        let effect = (0..CATALOGUE.len()).prop_map(Subject::Effect);
        prop_oneof![6 => effect, 1 => Just(Subject::Unknown)]
    }

    /// Log odds, many around those of "nothing", where verdicts change.
    fn odds() -> impl Strategy<Value = f64> {
        prop_oneof![-20.0..20.0, 3.0..7.0, 0.0..2000.0]
    }

    fn rival() -> impl Strategy<Value = Rival> {
        (subject(), odds(), prop::option::of(0.0..100.0)).prop_map(|(subject, odds, scatter)| {
            Rival {
                subject,
                odds,
                scatter,
            }
        })
    }

    fn rivals(most: usize) -> impl Strategy<Value = Vec<Rival>> {
        prop::collection::vec(rival(), 0..most)
    }

    prop_compose! {
        fn effect()(
            subject in subject(),
            own in odds(),
            gain in odds(),
            mut rivals in rivals(5),
            mends in any::<bool>(),
        ) -> AcceptedEffect {
            rivals.push(Rival::new(subject, own));
            AcceptedEffect {
                proposal: Proposal::new(subject, vec![0]),
                gain,
                rivals,
                mends: mends && subject == Subject::Unknown,
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn the_verdict_agrees_with_the_probabilities(
            accepted in prop::collection::vec(effect(), 0..4),
            refused in rivals(8),
            latent in prop_oneof![0.0..20.0, 6.0..9.0, 0.0..500.0],
            explained in 0.0..500.0,
            exactness in 0.0..1.0,
            seen in 0.0..1.0,
            tested in prop::bool::weighted(0.8),
            tried in prop::bool::weighted(0.8),
        ) {
            let physics = (0..CATALOGUE.len()).map(Subject::Effect);
            let judgement = Evidence {
                accepted: &accepted,
                refused: &refused,
                latent,
                explained,
                exactness,
                physics: physics.filter(|s| !s.is_sensor()).collect(),
                seen,
                tested,
                tried,
            }
            .judged();
            let Judgement { verdict, insufficient, findings, leading, posterior } = &judgement;
            let sum: f64 = posterior.0.iter().map(|(_, share)| share).sum();
            prop_assert!((sum - 1.0).abs() < 1e-9, "{sum}");
            prop_assert!(posterior.0.iter().all(|(_, share)| (0.0..=1.0 + 1e-12).contains(share)));
            let nothing = posterior.of(Subject::Nothing);
            let likeliest = posterior.0.iter().map(|(_, share)| *share).fold(0.0, f64::max);
            prop_assert_eq!(insufficient.is_some(), *verdict == Verdict::InsufficientData);
            let Some(place) = leading else {
                prop_assert!(matches!(verdict, Verdict::NothingMissing | Verdict::InsufficientData));
                if *verdict == Verdict::NothingMissing {
                    prop_assert!(findings.is_empty() && accepted.is_empty());
                    prop_assert!(nothing >= SURE && nothing == likeliest);
                    prop_assert!(tested && tried && seen >= ENOUGH);
                }
                return Ok(());
            };
            let one = &findings[*place];
            let set: f64 = one.set.iter().map(|(_, share)| share).sum();
            match verdict {
                Verdict::Ambiguous => {
                    prop_assert!(!one.set.is_empty());
                    prop_assert!(one.probability + set > one.nothing);
                    let all: f64 = one.set.iter().map(|(subject, _)| posterior.of(*subject)).sum();
                    prop_assert!(posterior.of(one.subject) + all > nothing);
                }
                Verdict::MissingPhysics | Verdict::Sensor | Verdict::UnknownPhysics => {
                    prop_assert!(one.probability > one.nothing);
                    prop_assert!(posterior.of(one.subject) > nothing);
                    prop_assert!(one.set.iter().all(|(_, share)| *share <= one.probability));
                    prop_assert_eq!(one.subject == Subject::Unknown, *verdict == Verdict::UnknownPhysics);
                    if *verdict != Verdict::UnknownPhysics {
                        prop_assert_eq!(one.subject.is_sensor(), *verdict == Verdict::Sensor);
                    }
                }
                Verdict::NothingMissing | Verdict::InsufficientData => prop_assert!(false, "{verdict:?}"),
            }
        }
    }
}
