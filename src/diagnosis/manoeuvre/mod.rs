//! The next manoeuvre to drive.
//!
//! Each manoeuvre is rehearsed on the refitted soil (`rehearsal`), and ranked by the separation of two hypotheses by
//! its recording and those at hand (`separation`): the leading finding as estimated, and the first of its rivals. An
//! effect of one region is taken to act throughout the manoeuvre, and the recordings at hand then determine the soil
//! alone.
//!
//! Recordings with too little information have no such pair. Then every candidate that they would not have shown at a
//! plausible size is compared with "nothing", its leading parameter at its prior's standard deviation, and the median
//! separation counts: half of the hidden candidates would show by this much.

pub mod course;
pub mod rehearsal;
pub mod separation;

use crate::diagnosis::answer::verdict::{JudgedFinding, Judgement};
use crate::diagnosis::hypothesis::candidate::TERRAIN_CHANGE;
use crate::diagnosis::search::SearchResult;
use crate::diagnosis::search::proposal::ProposalKind;
use crate::diagnosis::{Manoeuvre, Options, Subject, Verdict};
use rehearsal::{AtHand, Rehearsal, Rehearsed, rehearse};
use separation::Contrast;

/// A "nothing missing" needs no further manoeuvre if this share of the candidates would have shown.
const ENOUGH: f64 = 0.6;

/// The next manoeuvre, if these recordings do not decide. `hidden` are the candidates that would not have shown at a
/// plausible size.
#[must_use]
pub fn next(
    searched: &SearchResult,
    judgement: &Judgement,
    hidden: &[Subject],
    options: &Options,
) -> Option<Manoeuvre> {
    let seen = 1.0 - hidden.len() as f64 / searched.first.screened.len().max(1) as f64;
    let question = match judgement.verdict {
        Verdict::Ambiguous => {
            Question::between(searched, judgement.findings.get(judgement.leading?)?)?
        }
        Verdict::InsufficientData => Question::whether(searched, hidden),
        Verdict::NothingMissing if seen < ENOUGH => Question::whether(searched, hidden),
        _ => return None,
    };
    let at_hand = AtHand {
        problem: &searched.problem,
        refitted: &searched.refitted.solution,
        noise: &searched.noise,
        system: &searched.first.system,
    };
    question.answer(&at_hand, options.segment)
}

/// The question to a manoeuvre.
#[derive(Debug)]
struct Question {
    separates: [Subject; 2],
    signals: Vec<Contrast>,
    /// Suffix of the instruction about the place.
    place: &'static str,
}

impl Question {
    /// Which of the finding's rivals is true.
    fn between(searched: &SearchResult, first: &JudgedFinding) -> Option<Self> {
        let (rival, _) = *first.set.first()?;
        let effect = searched.accepted.get(first.effect?)?;
        let candidates = &searched.problem.candidates;
        let rivals: Vec<usize> = match rival {
            Subject::Unknown => candidates.residual_models().collect(),
            _ => candidates.of(rival).collect(),
        };
        let each = &searched.augmented.solution.coefficients;
        let coefficients = effect.proposal.coefficients.iter().map(|coefficient| {
            let off = candidates[*coefficient].off();
            let mut sizes: Vec<f64> = each
                .iter()
                .map(|coefficients| coefficients[*coefficient] - off)
                .collect();
            // The future recording has the same ground and sensors.
            sizes.push(sizes.iter().sum::<f64>() / sizes.len() as f64);
            (*coefficient, sizes)
        });
        let changes = |subject: Subject| subject.name() == TERRAIN_CHANGE;
        let local = effect.proposal.kind() == ProposalKind::Local;
        let bound = local || changes(first.subject);
        Some(Self {
            separates: [first.subject, rival],
            signals: vec![Contrast {
                coefficients: coefficients.collect(),
                rivals,
                seen_at_hand: !bound && !changes(rival),
                scatter: scatter(searched, first.subject),
            }],
            place: if bound {
                ", where the effect showed"
            } else {
                ""
            },
        })
    }

    /// Whether any of these candidates acts.
    fn whether(searched: &SearchResult, subjects: &[Subject]) -> Self {
        let candidates = &searched.problem.candidates;
        let recordings = searched.problem.recordings.len();
        let one = |subject: Subject| {
            let coefficient = candidates.of(subject).next()?;
            let deviation = candidates[coefficient].parameter.prior.deviation;
            Some(Contrast {
                coefficients: vec![(coefficient, vec![deviation; recordings + 1])],
                rivals: Vec::new(),
                seen_at_hand: true,
                scatter: scatter(searched, subject),
            })
        };
        Self {
            separates: [Subject::Unknown, Subject::Nothing],
            signals: subjects.iter().filter_map(|s| one(*s)).collect(),
            place: "",
        }
    }

    /// The manoeuvre with the largest separation.
    fn answer(&self, at_hand: &AtHand, length: f64) -> Option<Manoeuvre> {
        let signals = self.signals.iter();
        let mut coefficients: Vec<usize> = signals
            .flat_map(|s| {
                s.coefficients
                    .iter()
                    .map(|k| k.0)
                    .chain(s.rivals.iter().copied())
            })
            .collect();
        coefficients.sort_unstable();
        coefficients.dedup();
        let rehearsed = rehearse(at_hand, &coefficients, length)?;
        let mut order: Vec<(usize, f64)> = (0..rehearsed.rehearsals.len())
            .filter_map(|one| Some((one, self.separation(at_hand, &rehearsed, one)?)))
            .collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (best, separation) = *order.first()?;
        let best = &rehearsed.rehearsals[best];
        let name = |(one, separation): &(usize, f64)| {
            (rehearsed.rehearsals[*one].course.name, *separation)
        };
        Some(Manoeuvre {
            name: best.course.name,
            description: format!("{}{}.", describe(best), self.place),
            separates: self.separates,
            separation,
            compared: order.iter().map(name).collect(),
        })
    }

    /// The median separation of the signals. `None` if the model cannot follow the manoeuvre.
    fn separation(&self, at_hand: &AtHand, rehearsed: &Rehearsed, one: usize) -> Option<f64> {
        let each = self.signals.iter();
        let mut all: Vec<f64> = each
            .map(|signal| signal.separation(at_hand, rehearsed, one))
            .collect::<Option<_>>()?;
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied()
    }
}

fn scatter(searched: &SearchResult, subject: Subject) -> f64 {
    let mut screened = searched.first.screened.iter();
    let found = screened.find(|one| one.subject == subject);
    found.map_or(1.0, |one| one.score.scatter)
}

/// The instruction, with numbers of the motion on the refitted soil.
fn describe(rehearsal: &Rehearsal) -> String {
    let course = &rehearsal.course;
    let states = rehearsal.states.iter();
    let fastest = states.clone().map(|s| s[3]).fold(0.0, f64::max);
    let turning = states.clone().map(|s| s[5].abs()).fold(0.0, f64::max);
    let radius = states
        .filter(|s| s[3] > 0.5 * fastest && s[5].abs() > 1e-6)
        .map(|s| (s[3] / s[5]).abs())
        .fold(f64::INFINITY, f64::min);
    let (speed, radius) = (format!("{fastest:.2} m/s"), format!("{radius:.1} m"));
    let (seconds, part, times) = (course.seconds(), course.part, course.times);
    match course.name {
        "straight" => format!("Drive straight at {speed} for {part:.0} s"),
        "varied_speed" => format!(
            "Drive straight for {seconds:.0} s, {part:.0} s each at {:.2}, {:.2}, {:.2} and {:.2} m/s",
            0.3 * fastest,
            0.6 * fastest,
            fastest,
            0.45 * fastest
        ),
        "accelerate_and_brake" => format!(
            "Drive straight for {seconds:.0} s, {times} times speeding up to {speed} and braking to {:.2} m/s",
            0.25 * fastest
        ),
        "stop_and_go" => format!(
            "Drive straight, {times} times for {part:.0} s at {speed} with a stop in between, {seconds:.0} s in all"
        ),
        "slalom" => format!(
            "Drive a slalom at {speed}, {part:.0} s to each side and down to a radius of {radius}, for {seconds:.0} s"
        ),
        "spiral" => format!(
            "Drive an ever tighter bend to the left at {speed}, within {part:.0} s from straight to a radius of {radius}"
        ),
        "circles" => format!(
            "Drive a circle of {radius} radius at {speed}, {part:.0} s to the left, then as long to the right"
        ),
        "pivots" => format!(
            "Turn on the spot at {turning:.2} rad/s for {part:.0} s to the left, then as long to the right"
        ),
        "figure_eight" => format!(
            "Drive a figure of eight at {speed} with circles of {radius} radius, {part:.0} s each"
        ),
        _ => format!(
            "Drive straight at {speed} for {part:.0} s, turn round on the spot, and drive back beside the track as long"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::hypothesis::Problem;
    use crate::diagnosis::manoeuvre::rehearsal::tests::steady_straight;
    use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
    use crate::diagnosis::screening::system::linearise;
    use crate::diagnosis::testing::{named, on};
    use crate::fit::noise_model::first_noise_model;
    use crate::fit::segment::cut;
    use crate::fit::sensor::SensorParameter;

    const LENGTH: f64 = 5.0;

    /// After a straight drive in one direction: is it this, as many prior deviations large, or that?
    fn after_a_straight(a: (&str, &str, f64), b: Option<&str>) -> Manoeuvre {
        let model = on("sandy_loam");
        let recordings = [steady_straight(&model)];
        let mut problem = Problem::new(&model, &recordings);
        problem.segments = cut(&recordings, &[[0.0; SensorParameter::ALL.len()]], LENGTH).segments;
        let candidates = &problem.candidates;
        let mut coefficients = candidates.of(named(a.0));
        let coefficient = coefficients
            .find(|coefficient| candidates[*coefficient].name == a.1)
            .unwrap();
        let size = a.2 * candidates[coefficient].parameter.prior.deviation;
        let rivals: Vec<usize> = b.map_or(Vec::new(), |b| candidates.of(named(b)).collect());
        let asked: Vec<usize> = std::iter::once(coefficient)
            .chain(rivals.iter().copied())
            .collect();
        let refitted = problem.initial();
        let noise = first_noise_model(&problem.shooting(&problem.predictor(&[]), &[]));
        let layout = Layout::single_bin(&problem, &asked);
        let tables = sensitivities(&problem, &layout, &refitted);
        assert!(tables.len() > 4 && tables.iter().all(Option::is_some));
        let system = linearise(&problem, &layout, &tables, &refitted, &noise);
        let question = Question {
            separates: [named(a.0), b.map_or(Subject::Nothing, named)],
            signals: vec![Contrast {
                coefficients: vec![(coefficient, vec![size; 2])],
                rivals,
                seen_at_hand: true,
                scatter: 1.0,
            }],
            place: "",
        };
        let at_hand = AtHand {
            problem: &problem,
            refitted: &refitted,
            noise: &noise,
            system: &system,
        };
        question.answer(&at_hand, LENGTH).unwrap()
    }

    fn of(found: &Manoeuvre, name: &str) -> f64 {
        let mut compared = found.compared.iter();
        compared.find(|one| one.0 == name).unwrap().1
    }

    #[test]
    fn a_slope_shows_on_the_way_back_and_in_turns() {
        let found = after_a_straight(("grade", "slope_east", 0.6), Some("drag"));
        assert_eq!(found.compared.len(), 10, "{found:?}");
        let straight = of(&found, "straight");
        for name in ["there_and_back", "circles"] {
            assert!(of(&found, name) > 2.0 * straight, "{name} {found:?}");
        }
        assert_eq!(found.compared[0], (found.name, found.separation));
        let pairs = found.compared.windows(2);
        assert!(pairs.clone().all(|pair| pair[0].1 >= pair[1].1));
        assert_eq!(
            found,
            after_a_straight(("grade", "slope_east", 0.6), Some("drag"))
        );
    }

    #[test]
    fn what_acts_across_shows_in_a_pivot() {
        let found = after_a_straight(("shear_anisotropy", "strength_ratio", 1.0), None);
        assert!(of(&found, "pivots") > 3.0 * of(&found, "straight"));
        assert!(of(&found, "pivots") > 0.5, "{found:?}");
    }

    #[test]
    fn descriptions_name_numbers_of_the_motion() {
        let model = on("sandy_loam");
        for rehearsal in crate::diagnosis::manoeuvre::rehearsal::tests::all(&model) {
            let text = describe(&rehearsal);
            let name = rehearsal.course.name;
            assert!(text.contains(" s"), "{name}: {text}");
            assert!(text.matches(|c: char| c.is_ascii_digit()).count() > 2);
            assert!(!text.contains("inf") && !text.contains("NaN"), "{text}");
            let bends = ["slalom", "spiral", "circles", "figure_eight"].contains(&name);
            assert_eq!(bends, text.contains("radius"), "{name}: {text}");
        }
    }
}
