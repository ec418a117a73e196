//! Step 9: what to drive next.
//!
//! Each manoeuvre is rehearsed on the re-tuned soil (`rehearsal`), and judged by how far apart the
//! two hypotheses would then be: the recording made of it would be diagnosed with those at hand, so
//! that the normal equations add up, H = H_at_hand + H_manoeuvre. The soil and what acts everywhere
//! are shared, a slope or a sensor's fault is each recording's own. Were a true, the signal J_a d_a
//! would be in the data; b and the soil, X together, would be re-tuned to mimic it, and what they
//! cannot mimic is
//!
//! ```text
//! d^2 = min_x |S^1/2 (J_a d_a - J_X x)|^2 + x^T P x
//!     = d_a^T (H_aa - H_aX (H_XX + P)^-1 H_Xa) d_a
//! ```
//!
//! with the noise's inverse covariance S and the priors' precision P; the starts are eliminated
//! beforehand. d is the expected separation in standard deviations, the root of the likelihood
//! ratio's noncentrality. It is the criterion of T-optimal design, the least squares distance
//! between a model held for true at its estimates and its rival at the best of its parameters (A. C.
//! Atkinson & V. V. Fedorov, "The design of experiments for discriminating between two rival
//! models", Biometrika 62 (1975), 57–70), linearised around the re-tuned model, with priors. As in
//! the screen, d^2 is divided by the scatter phi of the blocks. d_a is what was estimated.
//!
//! What showed in one place or for some seconds is taken to act throughout the manoeuvre, and the
//! recordings at hand then tell of the soil alone.
//!
//! Where the recordings tell too little there is no pair to separate. Then every candidate's
//! leading parameter is held against nothing, at the size of its prior (b is empty), and the median of
//! their separations is what counts: half of what may be missing would show by so much.

use super::candidate::TERRAIN_CHANGE;
use super::naming::Kind;
use super::rehearsal::{AtHand, Rehearsal, Rehearsed, rehearse};
use super::search::Searched;
use super::system::System;
use super::verdict::{Judged, Judgement};
use super::{Manoeuvre, Options, Subject, Verdict};
use nalgebra::{DMatrix, DVector};

/// Where the model with its soil re-tuned suffices, it takes that many of the candidates to have
/// been seen at a plausible size to leave it at that.
const ENOUGH: f64 = 0.6;

/// What to drive next: where these recordings leave something open. `seen` is the share of the
/// candidates that they would have shown at a plausible size.
#[must_use]
pub fn next(
    searched: &Searched,
    judgement: &Judgement,
    seen: f64,
    options: &Options,
) -> Option<Manoeuvre> {
    let question = match judgement.verdict {
        Verdict::Ambiguous => Question::between(searched, judgement.findings.first()?)?,
        Verdict::InsufficientData => Question::whether(searched),
        Verdict::NothingMissing if seen < ENOUGH => Question::whether(searched),
        _ => return None,
    };
    let at_hand = AtHand {
        given: &searched.given,
        retuned: &searched.retuned.solution,
        by: &searched.by,
        system: &searched.first.system,
    };
    question.answer(&at_hand, options)
}

/// An unknown of the recordings at hand and of the one to come.
#[derive(Debug, Clone, Copy)]
struct Unknown {
    at_hand: Option<usize>,
    to_come: Option<usize>,
    /// Precision of its prior.
    precision: f64,
    /// Its size where it is there.
    size: f64,
}

/// Something that would be in the data, and what could mimic it besides the soil.
#[derive(Debug, Clone)]
struct Signal {
    /// Knobs with their sizes: for each recording at hand, then for the one to come.
    knobs: Vec<(usize, Vec<f64>)>,
    /// Knobs that could mimic it.
    rivals: Vec<usize>,
    /// Whether the recordings at hand tell of the knobs.
    told: bool,
    /// Scatter of the blocks.
    scatter: f64,
}

/// What a manoeuvre has to answer.
#[derive(Debug)]
struct Question {
    separates: [Subject; 2],
    signals: Vec<Signal>,
    /// Said of where it is to be driven.
    place: &'static str,
}

impl Question {
    /// Which of the first finding's set it is.
    fn between(searched: &Searched, first: &Judged) -> Option<Self> {
        let rival = *first.set.first()?;
        let member = searched.members.get(first.member?)?;
        let candidates = &searched.given.candidates;
        let rivals: Vec<usize> = match rival {
            Subject::Unknown => candidates.laws().collect(),
            _ => candidates.of(rival).collect(),
        };
        let each = &searched.augmented.solution.knobs;
        let knobs = member.proposal.knobs.iter().map(|knob| {
            let off = candidates.knobs[*knob].parameter.prior_coordinate();
            let mut sizes: Vec<f64> = each.iter().map(|knobs| knobs[*knob] - off).collect();
            // The recording to come is made on the same ground with the same sensors.
            sizes.push(sizes.iter().sum::<f64>() / sizes.len() as f64);
            (*knob, sizes)
        });
        let changes = |subject: Subject| subject.name() == TERRAIN_CHANGE;
        let local = member.proposal.kind() == Kind::Local;
        let bound = local || changes(first.subject);
        Some(Self {
            separates: [first.subject, rival],
            signals: vec![Signal {
                knobs: knobs.collect(),
                rivals,
                told: !bound && !changes(rival),
                scatter: scatter(searched, first.subject),
            }],
            place: if bound { ", where it showed" } else { "" },
        })
    }

    /// Whether anything is there.
    fn whether(searched: &Searched) -> Self {
        let candidates = &searched.given.candidates;
        let recordings = searched.given.recordings.len();
        let one = |subject: Subject| {
            let knob = candidates.of(subject).next()?;
            let deviation = candidates.knobs[knob].parameter.prior.deviation;
            Some(Signal {
                knobs: vec![(knob, vec![deviation; recordings + 1])],
                rivals: Vec::new(),
                told: true,
                scatter: scatter(searched, subject),
            })
        };
        Self {
            separates: [Subject::Unknown, Subject::Nothing],
            signals: candidates.subjects.iter().filter_map(|s| one(*s)).collect(),
            place: "",
        }
    }

    /// The manoeuvre that answers best.
    fn answer(&self, at_hand: &AtHand, options: &Options) -> Option<Manoeuvre> {
        let signals = self.signals.iter();
        let mut knobs: Vec<usize> = signals
            .flat_map(|s| s.knobs.iter().map(|k| k.0).chain(s.rivals.iter().copied()))
            .collect();
        knobs.sort_unstable();
        knobs.dedup();
        let rehearsed = rehearse(at_hand, &knobs, options.segment)?;
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

    /// The median separation of the signals with a manoeuvre's recording beside those at hand. `None`
    /// where the model cannot drive all of it.
    fn separation(&self, at_hand: &AtHand, rehearsed: &Rehearsed, one: usize) -> Option<f64> {
        let each = self.signals.iter();
        let mut all: Vec<f64> = each
            .map(|signal| signal.separation(at_hand, rehearsed, one))
            .collect::<Option<_>>()?;
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied()
    }
}

fn scatter(searched: &Searched, subject: Subject) -> f64 {
    let mut screened = searched.first.screened.iter();
    let found = screened.find(|one| one.subject == subject);
    found.map_or(1.0, |one| one.score.scatter)
}

impl Signal {
    fn separation(&self, at_hand: &AtHand, rehearsed: &Rehearsed, one: usize) -> Option<f64> {
        let to_come = &rehearsed.system;
        let mut unknowns: Vec<Unknown> = at_hand
            .system
            .soil()
            .map(|soil| Unknown {
                at_hand: Some(soil),
                to_come: Some(soil),
                precision: at_hand.system.precision[soil],
                size: 0.0,
            })
            .collect();
        let none = vec![0.0; at_hand.given.recordings.len() + 1];
        for knob in &self.rivals {
            unknowns.extend(self.unknowns(at_hand, to_come, one, *knob, &none));
        }
        let mimics = unknowns.len();
        for (knob, sizes) in &self.knobs {
            unknowns.extend(self.unknowns(at_hand, to_come, one, *knob, sizes));
        }
        let mut matrix = sum(at_hand.system, &unknowns, |u| u.at_hand, None);
        matrix += sum(to_come, &unknowns, |u| u.to_come, Some(one));
        let signals = unknowns.len() - mimics;
        let mut own = matrix.view((0, 0), (mimics, mimics)).into_owned();
        for (k, unknown) in unknowns[..mimics].iter().enumerate() {
            own[(k, k)] += unknown.precision;
        }
        let cross = matrix.view((0, mimics), (mimics, signals)).into_owned();
        let raw = matrix.view((mimics, mimics), (signals, signals));
        let left = raw - cross.tr_mul(&own.cholesky()?.solve(&cross));
        let sizes = unknowns[mimics..].iter().map(|unknown| unknown.size);
        let size = DVector::from_iterator(signals, sizes);
        let square = size.dot(&(left * &size)) / self.scatter;
        square.is_finite().then(|| square.max(0.0).sqrt())
    }

    /// The unknowns of a knob: one, or one for each recording that tells of it.
    fn unknowns(
        &self,
        at_hand: &AtHand,
        to_come: &System,
        one: usize,
        knob: usize,
        sizes: &[f64],
    ) -> Vec<Unknown> {
        let about = &at_hand.given.candidates.knobs[knob];
        let column = at_hand.system.layout.soil + knob;
        let unknown = |at_hand, to_come, size| Unknown {
            at_hand,
            to_come,
            precision: about.parameter.prior.deviation.powi(-2),
            size,
        };
        let next = to_come.places[one][column];
        let size = sizes[sizes.len() - 1];
        let places = at_hand.system.places.iter().map(|places| places[column]);
        if !about.own {
            let same = places.flatten().next().filter(|_| self.told);
            return vec![unknown(same, next, size)];
        }
        let known = places
            .zip(sizes)
            .filter(|(place, _)| self.told && place.is_some());
        let mut all: Vec<Unknown> = known
            .map(|(place, size)| unknown(place, None, *size))
            .collect();
        all.extend(next.map(|next| unknown(None, Some(next), size)));
        all
    }
}

/// A system's equations over these unknowns, of one recording or all; zero where it does not have them.
fn sum(
    system: &System,
    unknowns: &[Unknown],
    place: impl Fn(&Unknown) -> Option<usize>,
    recording: Option<usize>,
) -> DMatrix<f64> {
    let here: Vec<(usize, usize)> = unknowns
        .iter()
        .enumerate()
        .filter_map(|(k, unknown)| Some((k, place(unknown)?)))
        .collect();
    let own: Vec<usize> = here.iter().map(|(_, place)| *place).collect();
    let segments = system.segments.iter();
    let chosen = segments.filter(|s| recording.is_none_or(|recording| s.recording == recording));
    let (part, _) = system.sum(&own, chosen);
    let mut matrix = DMatrix::zeros(unknowns.len(), unknowns.len());
    for (i, (row, _)) in here.iter().enumerate() {
        for (j, (column, _)) in here.iter().enumerate() {
            matrix[(*row, *column)] = part[(i, j)];
        }
    }
    matrix
}

/// What to do, with numbers of the motion on the re-tuned soil.
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
