//! What it all amounts to: probabilities, and the verdict.
//!
//! Each hypothesis that was fitted has a weight, its Bayes factor times its prior, softened by a
//! temperature that grows a little with the root of the evidence, which is how the evidence itself scatters
//! from one recording to the next: noise and the way down to the best fit are never quite as the likelihood
//! has them.
//! Where something without a name is needed besides a name, the name is doubted; where a law stands alone,
//! an effect whose fit lost its way may be behind it. The temperature was set on the third judged
//! set of the proof, the other numbers on development cases from another simulator (see the docs).

use super::findings::likeliest_first;
use crate::diagnosis::search::{Member, NOTHING, Searched};
use crate::diagnosis::{Subject, Verdict};

/// Share of the probability that stays with "unknown" whatever the evidence: now and then something
/// outside the catalogue looks exactly like something inside.
const DOUBT: f64 = 0.03;
/// Softens log Bayes factors: so much where nothing is likeliest, so much where something is, by `CLEAR` or more, and
/// so many roots of the largest besides.
const SILENT: f64 = 0.75;
const TEMPERATURE: f64 = 2.0;
const CLEAR: f64 = 3.0;
const PER_ROOT: f64 = 0.02;
/// A name is doubted by so many times the share of the evidence that has no name, up to a limit.
const UNNAMED_DOUBT: f64 = 2.0;
const MOST_DOUBT: f64 = 0.5;
/// Share of the probability of "unknown" that belongs to effects of the catalogue which were missed.
const MISSED: f64 = 0.4;
/// A wrench that comes and goes with more evidence than this is something, with even odds.
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

/// Softens differences of log odds where the largest are these.
fn temperature(top: f64) -> f64 {
    let clear = ((top - NOTHING) / CLEAR).clamp(0.0, 1.0);
    SILENT + (TEMPERATURE - SILENT) * clear + PER_ROOT * top.max(0.0).sqrt()
}

/// Probabilities of subjects; they sum to 1.
#[derive(Debug, Clone)]
pub struct Odds(pub Vec<(Subject, f64)>);

impl Odds {
    fn new(weighed: &[(Subject, f64)], nothing: f64) -> Self {
        let mut all = vec![(Subject::Nothing, nothing)];
        all.extend_from_slice(weighed);
        let logs = likeliest_first(&all);
        let top = logs[0].1;
        let temperature = temperature(top);
        let weight = |log: f64| ((log - top) / temperature).exp();
        let sum: f64 = logs.iter().map(|(_, log)| weight(*log)).sum();
        let share = |(subject, log): &(Subject, f64)| (*subject, weight(*log) / sum);
        Self(logs.iter().map(share).collect()).with(Subject::Unknown, DOUBT)
    }

    /// Probability of a subject.
    #[must_use]
    pub fn of(&self, subject: Subject) -> f64 {
        let found = self.0.iter().find(|(other, _)| *other == subject);
        found.map_or(0.0, |(_, share)| *share)
    }

    /// Probability that it is physics.
    fn physics(&self) -> f64 {
        let is = |subject: Subject| !subject.is_sensor() && subject != Subject::Nothing;
        self.0
            .iter()
            .filter(|(s, _)| is(*s))
            .map(|(_, share)| share)
            .sum()
    }

    /// With a part of what one subject has given to others in equal parts.
    fn shared(mut self, from: Subject, part: f64, among: &[Subject]) -> Self {
        let Some(own) = self.0.iter_mut().find(|(other, _)| *other == from) else {
            return self;
        };
        let given = if among.is_empty() { 0.0 } else { part * own.1 };
        own.1 -= given;
        for subject in among {
            let each = given / among.len() as f64;
            match self.0.iter_mut().find(|(other, _)| other == subject) {
                Some((_, share)) => *share += each,
                None => self.0.push((*subject, each)),
            }
        }
        self
    }

    /// With a share of all given to a subject.
    fn with(mut self, subject: Subject, share: f64) -> Self {
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

/// A member with the probabilities of what may stand in its place.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Place among the members; `None` for what is left over without a name.
    pub member: Option<usize>,
    /// What.
    pub subject: Subject,
    /// Its probability.
    pub probability: f64,
    /// Probability that it is physics, whatever its name.
    pub physics: f64,
    /// Others that may stand in its place, likeliest first.
    pub set: Vec<Subject>,
}

/// Everything judged.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// All in all.
    pub verdict: Verdict,
    /// What was found, in that order; first what has no name where that is the most.
    pub findings: Vec<Judged>,
    /// Place of the one that the verdict is about.
    pub leading: Option<usize>,
    /// Probabilities of all subjects; they sum to 1.
    pub odds: Odds,
}

/// Judges what a search found. `seen` is the share of candidates that these recordings would have
/// shown at a plausible size.
#[must_use]
pub fn judge(searched: &Searched, seen: f64) -> Judgement {
    let members = &searched.members;
    let left = searched.last.wandering.map_or(0.0, |w| w.evidence);
    let something = 1.0 / (1.0 + (-(left - SOMETHING) / LEFT_SOFTNESS).exp());
    let explained = searched.retuned.surprise - searched.augmented.surprise;
    let doubt = doubt(members, explained, left.max(0.0) * something);
    let physics: Vec<Subject> = searched.given.candidates.subjects.clone();
    let physics: Vec<Subject> = physics.into_iter().filter(|s| !s.is_sensor()).collect();
    let odds = |member: &Member| {
        let odds = Odds::new(&member.rivals, NOTHING);
        match member.proposal.subject {
            Subject::Unknown => odds.shared(Subject::Unknown, MISSED, &physics),
            subject if subject.is_sensor() => odds,
            _ => odds.with(Subject::Unknown, doubt),
        }
    };
    let judged = members.iter().enumerate();
    let judged = judged.map(|(index, member)| judge_member(index, member, odds(member)));
    let mut findings: Vec<Judged> = judged.collect();
    let local = members.iter().all(|member| {
        matches!(
            member.proposal.kind(),
            crate::diagnosis::search::proposal::Kind::Local
        )
    });
    let main =
        members.is_empty() || left > MAIN * explained || (local && left > 0.5 * MAIN * explained);
    let mut odds = mean(members.iter().map(|m| (odds(m), m.gain.max(0.0))))
        .unwrap_or_else(|| Odds::new(&searched.refused, NOTHING));
    let something_unknown = something * (1.0 - MISSED);
    if main {
        let whole = odds.with(Subject::Unknown, something);
        odds = whole.shared(Subject::Unknown, MISSED * something, &physics);
    }
    if something > 0.5 && searched.tested {
        findings.push(Judged {
            member: None,
            subject: Subject::Unknown,
            probability: something_unknown,
            physics: something,
            set: Vec::new(),
        });
        if main {
            findings.rotate_right(1);
        }
    }
    let leading = leading(&findings);
    let verdict = match leading.map(|place| &findings[place]) {
        None if seen < ENOUGH || !searched.tested => Verdict::InsufficientData,
        None => Verdict::NothingMissing,
        Some(one) => one.verdict(),
    };
    if verdict == Verdict::InsufficientData {
        // Nothing was asked, so nothing is likelier than the other.
        odds = Odds(vec![(Subject::Nothing, 0.5), (Subject::Unknown, 0.5)]);
    }
    Judgement {
        verdict,
        findings,
        leading,
        odds,
    }
}

/// Where the sensors come first, physics that is likelier than not decides what is said of the model.
fn leading(findings: &[Judged]) -> Option<usize> {
    let first = findings.first()?;
    let likely = |one: &Judged| !one.subject.is_sensor() && one.physics > 0.5;
    let physics = findings.iter().position(likely);
    physics.filter(|_| first.subject.is_sensor()).or(Some(0))
}

impl Judged {
    /// What is said where nothing else was found.
    fn verdict(&self) -> Verdict {
        match self.subject {
            Subject::Unknown => Verdict::UnknownPhysics,
            _ if !self.set.is_empty() => Verdict::Ambiguous,
            subject if subject.is_sensor() => Verdict::Sensor,
            _ => Verdict::MissingPhysics,
        }
    }
}

/// How much a name is doubted because of what has none: of all that was explained together what leaving out the laws
/// would cost, and what is left over.
fn doubt(members: &[Member], explained: f64, left: f64) -> f64 {
    let laws = members.iter();
    let laws = laws.filter(|member| member.proposal.subject == Subject::Unknown);
    let laws: f64 = laws.map(|member| member.gain.max(0.0)).sum();
    unnamed_share(laws, explained, left).min(MOST_DOUBT)
}

/// A name is doubted so much, before the limit. What members lose one by one does not add up to what they explain
/// together, where they can stand in for each other.
fn unnamed_share(laws: f64, explained: f64, left: f64) -> f64 {
    let unnamed = laws + left;
    let all = unnamed.max(explained.max(0.0) + left);
    if all > 0.0 {
        UNNAMED_DOUBT * unnamed / all
    } else {
        0.0
    }
}

fn judge_member(index: usize, member: &Member, odds: Odds) -> Judged {
    let subject = member.proposal.subject;
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
    Judged {
        member: Some(index),
        subject,
        probability,
        physics: odds.physics(),
        set,
    }
}

/// Those that may stand in the place of a name of this probability, of all but "nothing".
fn joining(probability: f64, nothing: f64, others: &[(Subject, f64)]) -> Vec<Subject> {
    let wanted = SET * (1.0 - nothing - DOUBT);
    let mut held = probability;
    let mut set = Vec::new();
    for (other, share) in others {
        if held >= wanted || *share < WORTH_TELLING * probability {
            break;
        }
        held += share;
        set.push(*other);
    }
    set
}

/// Of several findings, each weighed by its evidence: what explains little is a small part of what was missing.
fn mean(each: impl Iterator<Item = (Odds, f64)>) -> Option<Odds> {
    let all: Vec<(Odds, f64)> = each.collect();
    let total: f64 = all.iter().map(|(_, gain)| gain).sum();
    let mut sum: Vec<(Subject, f64)> = Vec::new();
    for (odds, gain) in &all {
        let weight = if total > 0.0 {
            gain / total
        } else {
            1.0 / all.len() as f64
        };
        for (subject, share) in &odds.0 {
            match sum.iter_mut().find(|(other, _)| other == subject) {
                Some((_, total)) => *total += weight * share,
                None => sum.push((*subject, weight * share)),
            }
        }
    }
    (!sum.is_empty()).then_some(Odds(sum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;

    #[test]
    fn probabilities_sum_to_one_and_follow_the_evidence() {
        let (a, b) = (Subject::Effect(0), Subject::Effect(1));
        let odds = Odds::new(&[(a, 20.0), (b, 4.0), (a, 3.0)], NOTHING);
        let sum: f64 = odds.0.iter().map(|(_, share)| share).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        assert!(odds.of(a) > 0.95 && odds.of(b) < odds.of(a));
        assert!((odds.of(Subject::Unknown) - DOUBT).abs() < 1e-12);
        // The same lead says less where more is at stake.
        let ahead = |top: f64| Odds::new(&[(a, top), (b, top - 8.0)], NOTHING).of(a);
        assert!(ahead(20.0) > ahead(200.0) && ahead(200.0) > ahead(2000.0));
        assert!(ahead(2000.0) > 0.5);
        let shared = odds.with(Subject::Unknown, 0.5);
        let sum: f64 = shared.0.iter().map(|(_, share)| share).sum();
        assert!((sum - 1.0).abs() < 1e-12 && shared.of(Subject::Unknown) > 0.5);
        let nothing = Odds::new(&[], NOTHING).of(Subject::Nothing);
        assert!((nothing - (1.0 - DOUBT)).abs() < 1e-12);
    }

    #[test]
    fn a_set_holds_what_has_evidence() {
        let (a, b) = (Subject::Effect(0), Subject::Effect(1));
        // Two names hold all but the doubt that always is.
        let others = [(a, 0.451), (b, 0.01), (Subject::Unknown, 0.0)];
        assert_eq!(joining(0.478, 0.02, &others), [a]);
        // What is not there takes no place among names.
        assert_eq!(joining(0.6, 0.3, &[(a, 0.07), (b, 0.04)]), [a]);
        let others = [(Subject::Unknown, 0.4), (a, 0.02)];
        assert_eq!(joining(0.5, 0.05, &others), [Subject::Unknown]);
    }

    #[test]
    fn laws_beside_a_name_count_by_what_they_alone_explain() {
        // A name explains 150, a law 12 besides; without the name the law would regain most.
        let share = unnamed_share(12.0, 162.0, 0.0);
        assert!((share - UNNAMED_DOUBT * 12.0 / 162.0).abs() < 1e-12);
        assert!((unnamed_share(12.0, 0.0, 3.0) - UNNAMED_DOUBT).abs() < 1e-12);
        assert!(unnamed_share(0.0, 0.0, 0.0).abs() < 1e-12);
    }

    #[test]
    fn physics_behind_sensors_decides_where_it_is_likely() {
        let sensor = Subject::Effect(CATALOGUE.iter().position(|e| e.name == "latency").unwrap());
        let one = |subject, probability| Judged {
            member: None,
            subject,
            probability,
            physics: probability,
            set: Vec::new(),
        };
        let verdict = |findings: &[Judged]| findings[leading(findings).unwrap()].verdict();
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
}
