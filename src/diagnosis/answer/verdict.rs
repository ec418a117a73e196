//! What it all amounts to: probabilities, and the verdict.
//!
//! Each hypothesis that was fitted has a weight, its Bayes factor times its prior, softened by a
//! temperature that grows a little with the root of the evidence, which is how the evidence itself scatters
//! from one recording to the next: noise and the way down to the best fit are never quite as the likelihood
//! has them.
//! Where something without a name is needed besides a name, the name is doubted; where a residual model stands alone,
//! an effect whose fit lost its way may be behind it. The temperature was set on the third judged
//! set of the proof, the other numbers on development cases from another simulator (see the docs).

use super::posterior::{DOUBT, Posterior, mean};
use crate::diagnosis::outcome::{Insufficient, Subject, Verdict};
use crate::diagnosis::search::accepted::NOTHING;
use crate::diagnosis::search::proposal::ProposalKind;
use crate::diagnosis::search::{AcceptedEffect, SearchResult};

/// A name is doubted by so many times the share of the evidence that has no name, up to a limit.
const UNNAMED_DOUBT: f64 = 2.0;
const MOST_DOUBT: f64 = 0.5;
/// Share of the probability of "unknown" that belongs to effects of the catalogue which were missed.
const MISSED: f64 = 0.4;
/// A latent wrench with more evidence than this is something, with even odds.
const SOMETHING: f64 = 7.5;
/// Softens the evidence of what is left over.
const LEFT_SOFTNESS: f64 = 2.0;
/// What is left over is the main thing where it has more than this share of what was named.
const MAIN: f64 = 0.3;
/// A name with less probability is one of a set.
const SURE: f64 = 0.75;
/// A set holds so much of the probability.
const SET: f64 = 0.95;
/// Members of a set have at least this share of the best one's probability.
const WORTH_TELLING: f64 = 0.05;
/// Where fewer candidates than this share would have been seen at a plausible size, the recordings
/// tell too little.
const ENOUGH: f64 = 0.3;

/// A member with the probabilities of what may stand in its place.
#[derive(Debug, Clone)]
pub struct JudgedFinding {
    /// Place among the members; `None` for what is left over without a name.
    pub effect: Option<usize>,
    /// What.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Probability that it is physics, whatever its name.
    pub physics: f64,
    /// Others that may stand in its place with their probabilities, likeliest first.
    pub set: Vec<(Subject, f64)>,
    /// Probability that nothing is there in its place.
    pub nothing: f64,
}

/// Everything judged.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// All in all.
    pub verdict: Verdict,
    /// Why there is no verdict, if so.
    pub insufficient: Option<Insufficient>,
    /// What was found, in that order; first what has no name where that is the most.
    pub findings: Vec<JudgedFinding>,
    /// Place of the one that the verdict is about.
    pub leading: Option<usize>,
    /// Probabilities of all subjects; they sum to 1.
    pub odds: Posterior,
}

/// What a verdict rests on.
#[derive(Debug)]
pub struct Evidence<'s> {
    /// What was found.
    pub accepted: &'s [AcceptedEffect],
    /// Log odds of what was fitted and not taken.
    pub refused: &'s [(Subject, f64)],
    /// Log evidence of a latent wrench, left over beside what was found.
    pub left: f64,
    /// Log evidence of all that was found together.
    pub explained: f64,
    /// The candidates that are physics.
    pub physics: Vec<Subject>,
    /// Share of the candidates that these recordings would have shown at a plausible size.
    pub seen: f64,
    /// Whether some data could be held out.
    pub tested: bool,
    /// Whether there was time to fit every candidate.
    pub tried: bool,
}

/// Judges what a search found. `seen` is the share of candidates that these recordings would have
/// shown at a plausible size.
#[must_use]
pub fn judge(searched: &SearchResult, seen: f64) -> Judgement {
    let subjects = searched.problem.candidates.subjects.iter().copied();
    Evidence {
        accepted: &searched.accepted,
        refused: &searched.refused,
        left: searched.last.latent_wrench.map_or(0.0, |w| w.evidence),
        explained: searched.refitted.negative_log_evidence
            - searched.augmented.negative_log_evidence,
        physics: subjects.filter(|s| !s.is_sensor()).collect(),
        seen,
        tested: searched.tested,
        tried: searched.tried,
    }
    .judged()
}

impl Evidence<'_> {
    /// The verdict, with the probabilities that it agrees with: what it claims is likelier than that nothing is missing.
    #[must_use]
    pub fn judged(&self) -> Judgement {
        let Self {
            accepted,
            left,
            explained,
            physics,
            ..
        } = self;
        let something = 1.0 / (1.0 + (-(left - SOMETHING) / LEFT_SOFTNESS).exp());
        let doubt = doubt(accepted, *explained, left.max(0.0) * something);
        let odds = |effect: &AcceptedEffect| {
            let odds = Posterior::new(&effect.rivals, NOTHING);
            match effect.proposal.subject {
                Subject::Unknown => odds.shared(Subject::Unknown, MISSED, physics),
                subject if subject.is_sensor() => odds,
                _ => odds.with(Subject::Unknown, doubt),
            }
        };
        let judged = accepted.iter().enumerate();
        let judged = judged.map(|(index, effect)| judge_member(index, effect, odds(effect)));
        let mut findings: Vec<JudgedFinding> = judged.collect();
        let is_local = |effect: &AcceptedEffect| effect.proposal.kind() == ProposalKind::Local;
        let local = accepted.iter().all(is_local);
        let main = accepted.is_empty()
            || *left > MAIN * explained
            || (local && *left > 0.5 * MAIN * explained);
        let each: Vec<(Posterior, f64)> = accepted
            .iter()
            .map(|m| (odds(m), m.gain.max(0.0)))
            .collect();
        let mut odds = mean(&each).unwrap_or_else(|| Posterior::new(self.refused, NOTHING));
        let something_unknown = something * (1.0 - MISSED);
        if main {
            let whole = odds.with(Subject::Unknown, something);
            odds = whole.shared(Subject::Unknown, MISSED * something, physics);
        }
        // Without a name is what the names were tried for.
        if something > 0.5 && self.tested && self.tried {
            findings.push(JudgedFinding {
                effect: None,
                subject: Subject::Unknown,
                probability: something_unknown,
                physics: something,
                set: Vec::new(),
                nothing: if main {
                    odds.of(Subject::Nothing)
                } else {
                    1.0 - something
                },
            });
            if main {
                findings.rotate_right(1);
            }
        }
        let leading = leading(&findings).filter(|place| findings[*place].is_likely(&odds));
        let insufficient = match leading {
            Some(_) => None,
            None => self.insufficient(&findings, &odds),
        };
        let verdict = match (leading, insufficient) {
            (Some(place), _) => findings[place].verdict(),
            (None, Some(_)) => Verdict::InsufficientData,
            (None, None) => Verdict::NothingMissing,
        };
        if leading.is_none() {
            // Nothing in the model stands for it.
            findings.retain(|one| one.effect.is_some());
        }
        if insufficient.is_some_and(|why| why != Insufficient::Undecided) {
            // Not everything was asked, so nothing is likelier than the other.
            odds = Posterior(vec![(Subject::Nothing, 0.5), (Subject::Unknown, 0.5)]);
        }
        Judgement {
            verdict,
            insufficient,
            findings,
            leading,
            odds,
        }
    }

    /// Where nothing is claimed: why it cannot be said that nothing is missing.
    fn insufficient(&self, findings: &[JudgedFinding], odds: &Posterior) -> Option<Insufficient> {
        if findings.is_empty() && (self.seen < ENOUGH || !self.tested) {
            Some(Insufficient::TooLittle)
        } else if findings.is_empty() && !self.tried {
            Some(Insufficient::TimeUp)
        } else if findings.is_empty() && odds.of(Subject::Nothing) >= SURE {
            None
        } else {
            Some(Insufficient::Undecided)
        }
    }
}

/// Where the sensors come first, physics that is likelier than not decides what is said of the model.
fn leading(findings: &[JudgedFinding]) -> Option<usize> {
    let first = findings.first()?;
    let likely = |one: &JudgedFinding| !one.subject.is_sensor() && one.physics > 0.5;
    let physics = findings.iter().position(likely);
    physics.filter(|_| first.subject.is_sensor()).or(Some(0))
}

impl JudgedFinding {
    /// What is said where nothing else was found.
    fn verdict(&self) -> Verdict {
        let is_likeliest = self.set.iter().all(|(_, share)| *share <= self.probability);
        match self.subject {
            Subject::Unknown if is_likeliest => Verdict::UnknownPhysics,
            _ if !self.set.is_empty() => Verdict::Ambiguous,
            subject if subject.is_sensor() => Verdict::Sensor,
            _ => Verdict::MissingPhysics,
        }
    }

    /// Whether what would be claimed is likelier than that nothing is there, in its place and all in all.
    fn is_likely(&self, odds: &Posterior) -> bool {
        let others = self
            .set
            .iter()
            .filter(|_| self.verdict() == Verdict::Ambiguous);
        let others: Vec<&(Subject, f64)> = others.collect();
        let here: f64 = others.iter().map(|(_, share)| share).sum();
        let all: f64 = others.iter().map(|(subject, _)| odds.of(*subject)).sum();
        self.probability + here > self.nothing
            && odds.of(self.subject) + all > odds.of(Subject::Nothing)
    }
}

/// How much a name is doubted because of what has none: of all that was explained together what leaving out the residual models
/// would cost, and what is left over.
fn doubt(accepted: &[AcceptedEffect], explained: f64, left: f64) -> f64 {
    let residual_models = accepted.iter();
    let residual_models =
        residual_models.filter(|effect| effect.proposal.subject == Subject::Unknown);
    let residual_models: f64 = residual_models.map(|effect| effect.gain.max(0.0)).sum();
    unnamed_share(residual_models, explained, left).min(MOST_DOUBT)
}

/// A name is doubted so much, before the limit. What members lose one by one does not add up to what they explain
/// together, where they can stand in for each other.
fn unnamed_share(residual_models: f64, explained: f64, left: f64) -> f64 {
    let unnamed = residual_models + left;
    let all = unnamed.max(explained.max(0.0) + left);
    if all > 0.0 {
        UNNAMED_DOUBT * unnamed / all
    } else {
        0.0
    }
}

fn judge_member(index: usize, effect: &AcceptedEffect, odds: Posterior) -> JudgedFinding {
    let subject = effect.proposal.subject;
    let probability = odds.of(subject);
    let mut others: Vec<(Subject, f64)> = odds.0.clone();
    others.retain(|(other, _)| *other != subject && *other != Subject::Nothing);
    // What "unknown" has whatever the evidence makes it no rival.
    for (_, share) in others
        .iter_mut()
        .filter(|(other, _)| *other == Subject::Unknown)
    {
        *share -= DOUBT;
    }
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    let set = if probability < SURE {
        joining(probability, odds.of(Subject::Nothing), &others)
    } else {
        Vec::new()
    };
    JudgedFinding {
        effect: Some(index),
        subject,
        probability,
        physics: odds.physics(),
        set,
        nothing: odds.of(Subject::Nothing),
    }
}

/// Those that may stand in the place of a name of this probability, of all but "nothing".
fn joining(probability: f64, nothing: f64, others: &[(Subject, f64)]) -> Vec<(Subject, f64)> {
    let wanted = SET * (1.0 - nothing - DOUBT);
    let mut held = probability;
    let mut set = Vec::new();
    for (other, share) in others {
        if held >= wanted || *share < WORTH_TELLING * probability {
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
    use crate::effects::CATALOGUE;
    use proptest::prelude::*;

    #[test]
    fn a_set_holds_what_has_evidence() {
        let (a, b) = (Subject::Effect(0), Subject::Effect(1));
        // Two names hold all but the doubt that always is.
        let others = [(a, 0.451), (b, 0.01), (Subject::Unknown, 0.0)];
        let joining = |probability, nothing, others: &[(Subject, f64)]| -> Vec<Subject> {
            let set = joining(probability, nothing, others).into_iter();
            set.map(|(subject, _)| subject).collect()
        };
        assert_eq!(joining(0.478, 0.02, &others), [a]);
        // What is not there takes no place among names.
        assert_eq!(joining(0.6, 0.3, &[(a, 0.07), (b, 0.04)]), [a]);
        let others = [(Subject::Unknown, 0.4), (a, 0.02)];
        assert_eq!(joining(0.5, 0.05, &others), [Subject::Unknown]);
    }

    #[test]
    fn laws_beside_a_name_count_by_what_they_alone_explain() {
        // A name explains 150, a residual model 12 besides; without the name the residual model would regain most.
        let share = unnamed_share(12.0, 162.0, 0.0);
        assert!((share - UNNAMED_DOUBT * 12.0 / 162.0).abs() < 1e-12);
        assert!((unnamed_share(12.0, 0.0, 3.0) - UNNAMED_DOUBT).abs() < 1e-12);
        assert!(unnamed_share(0.0, 0.0, 0.0).abs() < 1e-12);
    }

    #[test]
    fn physics_behind_sensors_decides_where_it_is_likely() {
        let sensor = Subject::Effect(CATALOGUE.iter().position(|e| e.name == "latency").unwrap());
        let one = |subject, probability| JudgedFinding {
            effect: None,
            subject,
            probability,
            physics: probability,
            set: Vec::new(),
            nothing: 0.0,
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

    /// Effects, sensors among them, and something without a name.
    fn subject() -> impl Strategy<Value = Subject> {
        let effect = (0..CATALOGUE.len()).prop_map(Subject::Effect);
        prop_oneof![6 => effect, 1 => Just(Subject::Unknown)]
    }

    /// Log odds: many around those of nothing, where verdicts turn.
    fn odds() -> impl Strategy<Value = f64> {
        prop_oneof![-20.0..20.0, 3.0..7.0, 0.0..2000.0]
    }

    fn rivals(most: usize) -> impl Strategy<Value = Vec<(Subject, f64)>> {
        prop::collection::vec((subject(), odds()), 0..most)
    }

    prop_compose! {
        fn effect()(
            subject in subject(),
            own in odds(),
            gain in odds(),
            mut rivals in rivals(5),
        ) -> AcceptedEffect {
            rivals.push((subject, own));
            AcceptedEffect {
                proposal: Proposal::new(subject, vec![0]),
                gain,
                rivals,
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn the_verdict_agrees_with_the_probabilities(
            accepted in prop::collection::vec(effect(), 0..4),
            refused in rivals(8),
            left in prop_oneof![0.0..20.0, 6.0..9.0, 0.0..500.0],
            explained in 0.0..500.0,
            seen in 0.0..1.0,
            tested in prop::bool::weighted(0.8),
            tried in prop::bool::weighted(0.8),
        ) {
            let physics = (0..CATALOGUE.len()).map(Subject::Effect);
            let judgement = Evidence {
                accepted: &accepted,
                refused: &refused,
                left,
                explained,
                physics: physics.filter(|s| !s.is_sensor()).collect(),
                seen,
                tested,
                tried,
            }
            .judged();
            let Judgement { verdict, insufficient, findings, leading, odds } = &judgement;
            let sum: f64 = odds.0.iter().map(|(_, share)| share).sum();
            prop_assert!((sum - 1.0).abs() < 1e-9, "{sum}");
            prop_assert!(odds.0.iter().all(|(_, share)| (0.0..=1.0 + 1e-12).contains(share)));
            let nothing = odds.of(Subject::Nothing);
            let likeliest = odds.0.iter().map(|(_, share)| *share).fold(0.0, f64::max);
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
                    let all: f64 = one.set.iter().map(|(subject, _)| odds.of(*subject)).sum();
                    prop_assert!(odds.of(one.subject) + all > nothing);
                }
                Verdict::MissingPhysics | Verdict::Sensor | Verdict::UnknownPhysics => {
                    prop_assert!(one.probability > one.nothing);
                    prop_assert!(odds.of(one.subject) > nothing);
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
