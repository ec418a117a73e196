//! Findings in numbers and sentences.

use super::posterior::pairs;
use super::verdict::JudgedFinding;
use super::words::{statement, whose};
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, scattered};
use crate::diagnosis::hypothesis::{Problem, UnknownKind};
use crate::diagnosis::outcome::{Channel, Finding, Interval, Quantity, Subject, Term};
use crate::diagnosis::screening::regime::{channel, gains, regime};
use crate::diagnosis::screening::region::Region;
use crate::diagnosis::screening::residual_model::{channel as pushed, group};
use crate::diagnosis::screening::screen::Projection;
use crate::diagnosis::screening::wrench::smooth;
use crate::diagnosis::search::accepted::is_mended;
use crate::diagnosis::search::proposal::{Proposal, ProposalKind};
use crate::diagnosis::search::{AcceptedEffect, SearchResult};
use crate::fit::parameter::{FreeParameter, NORMAL_95};
use crate::recording;
use nalgebra::DMatrix;

/// Number of reported places of an effect that acts throughout.
const MAX_PLACES: usize = 3;

/// The findings of a judgement.
#[must_use]
pub fn findings(searched: &SearchResult, judged: &[JudgedFinding]) -> Vec<Finding> {
    if judged.is_empty() {
        return Vec::new();
    }
    let covariance = scattered(&searched.placed, &searched.augmented, &searched.noise);
    let one = |judged: &JudgedFinding| match judged.effect {
        Some(effect) => named(searched, effect, judged, &covariance),
        None => latent_wrench(searched, judged),
    };
    judged.iter().map(one).collect()
}

/// Values and intervals of a proposal's coefficients.
fn quantities(
    problem: &Problem,
    fit: &FittedHypothesis,
    proposal: &Proposal,
    covariance: &DMatrix<f64>,
) -> Vec<Quantity> {
    let coefficients = &proposal.coefficients;
    let acts = |recording: usize| match &proposal.extent {
        Some(Region::Time(at) | Region::Run(at)) => at.recording == recording,
        _ => true,
    };
    let predictor = problem.predictor(&fit.coefficients);
    let shooting = problem.shooting(&predictor, &fit.coefficients);
    let mut found: Vec<(usize, Quantity)> = Vec::new();
    let mut reported = Vec::new();
    problem.visit(&shooting, &fit.coefficients, |place, recording, what| {
        let UnknownKind::CandidateParameter(coefficient) = what else {
            return;
        };
        if !coefficients.contains(&coefficient) || reported.contains(&place) {
            return;
        }
        reported.push(place);
        let about = &problem.candidates[coefficient];
        if about.own && !acts(recording) {
            return;
        }
        let at = fit.solution.coefficients[recording][coefficient];
        let half = NORMAL_95 * covariance[(place, place)].max(0.0).sqrt();
        let parameter: &FreeParameter = &about.parameter;
        let (low, high) = parameter.interval(at, half);
        let each = about.own && problem.recordings.len() > 1;
        found.push((
            coefficient,
            Quantity {
                name: about.name.into(),
                recording: each.then(|| problem.names[recording].clone()),
                value: parameter.value(at),
                low,
                high,
                off: parameter.value(about.off()),
                unit: parameter.unit,
            },
        ));
    });
    found
        .sort_by_key(|(coefficient, _)| coefficients.iter().position(|other| other == coefficient));
    found.into_iter().map(|(_, quantity)| quantity).collect()
}

fn named(
    searched: &SearchResult,
    index: usize,
    judged: &JudgedFinding,
    covariance: &DMatrix<f64>,
) -> Finding {
    let effect = &searched.accepted[index];
    let proposal = &effect.proposal;
    let (problem, fit) = (&searched.placed, &searched.augmented);
    let parameters = quantities(problem, fit, proposal, covariance);
    let steps = steps(problem, fit, &proposal.coefficients);
    let local = proposal.kind() == ProposalKind::Local;
    let places = places(searched, effect, judged.subject, &steps);
    let law: Vec<Term> = if proposal.subject == Subject::Unknown {
        law(problem, proposal, &parameters)
    } else {
        Vec::new()
    };
    let mut finding = Finding {
        subject: judged.subject,
        probability: judged.probability,
        ambiguous_with: judged.set.iter().map(|(subject, _)| *subject).collect(),
        evidence: effect.gain,
        rivals: pairs(&effect.rivals),
        parameters,
        places,
        local,
        law,
        mended_by: if is_mended(&searched.accepted, index) {
            mending(searched, covariance)
        } else {
            Vec::new()
        },
        statement: String::new(),
    };
    finding.statement = statement(&finding);
    finding
}

/// The terms of the residual models that mend a formula.
fn mending(searched: &SearchResult, covariance: &DMatrix<f64>) -> Vec<Term> {
    let (problem, fit) = (&searched.placed, &searched.augmented);
    let mending = searched.accepted.iter().filter(|effect| effect.mends);
    let terms = mending.flat_map(|effect| {
        let parameters = quantities(problem, fit, &effect.proposal, covariance);
        law(problem, &effect.proposal, &parameters)
    });
    terms.collect()
}

/// Distances of coefficients from "off", for each recording.
fn steps(
    problem: &Problem,
    fit: &FittedHypothesis,
    coefficients: &[usize],
) -> Vec<(usize, Vec<f64>)> {
    let each = |coefficient: &usize| {
        let off = problem.candidates[*coefficient].off();
        let values = fit
            .solution
            .coefficients
            .iter()
            .map(|values| values[*coefficient] - off);
        (*coefficient, values.collect())
    };
    coefficients.iter().map(each).collect()
}

fn law(problem: &Problem, proposal: &Proposal, parameters: &[Quantity]) -> Vec<Term> {
    let term = |(index, coefficient): (usize, &usize)| {
        let about = &problem.candidates[*coefficient];
        Term {
            channel: pushed(about.effect),
            parameter: about.parameter.name.clone(),
            group: group(about.effect, about.name),
            coefficient: parameters[index].clone(),
            stability: proposal.stability.get(index).copied().unwrap_or(1.0),
        }
    };
    let coefficients = proposal
        .coefficients
        .iter()
        .enumerate()
        .take(parameters.len());
    coefficients.map(term).collect()
}

fn places(
    searched: &SearchResult,
    effect: &AcceptedEffect,
    subject: Subject,
    steps: &[(usize, Vec<f64>)],
) -> Vec<Interval> {
    let problem = &searched.problem;
    let system = &searched.first.system;
    let what = match problem.candidates[effect.proposal.coefficients[0]].target {
        Target::Sensor(_) => Channel::Measurement,
        Target::Model(_) if subject == Subject::Unknown => {
            pushed(problem.candidates[effect.proposal.coefficients[0]].effect)
        }
        Target::Model(_) => channel(problem, system, steps),
    };
    // An effect of one region shows in the regime of that region, which says nothing new.
    let everywhere = effect.proposal.extent.is_none();
    let gains = Projection::over_all(system, &[])
        .filter(|_| everywhere)
        .map(|projection| gains(problem, system, &projection, steps))
        .unwrap_or_default();
    let regime = regime(&gains);
    let interval = |recording: usize, run: usize, start: f64, end: f64, patch| Interval {
        recording: problem.names[recording].clone(),
        run,
        label: problem.label_of(recording, run),
        start,
        end,
        channel: what,
        regime: regime.clone(),
        patch,
    };
    match &effect.proposal.extent {
        Some(Region::Time(at) | Region::Run(at)) => {
            let patch = patch(searched, at.recording, at.run, at.start, at.end);
            vec![interval(at.recording, at.run, at.start, at.end, patch)]
        }
        Some(Region::Place { disc }) => visits(searched, |[x, y]| {
            (x - disc[0]).hypot(y - disc[1]) < disc[2]
        })
        .into_iter()
        .map(|(recording, run, start, end)| interval(recording, run, start, end, Some(*disc)))
        .collect(),
        Some(Region::Beyond {
            direction,
            position,
        }) => visits(searched, |[x, y]| {
            x * direction.cos() + y * direction.sin() > *position
        })
        .into_iter()
        .map(|(recording, run, start, end)| interval(recording, run, start, end, None))
        .collect(),
        None => {
            let mut runs: Vec<(usize, usize, f64, f64, f64)> = Vec::new();
            for segment in &problem.segments {
                let key = (segment.recording, segment.run);
                match runs.last_mut().filter(|run| (run.0, run.1) == key) {
                    Some(run) => run.3 = segment.end,
                    None => runs.push((key.0, key.1, segment.start, segment.end, 0.0)),
                }
            }
            for run in &mut runs {
                let own = gains.iter().filter(|gain| gain.run == (run.0, run.1));
                run.4 = own.map(|gain| gain.gain).sum();
            }
            runs.sort_by(|a, b| b.4.total_cmp(&a.4));
            let reported = runs.into_iter().take(MAX_PLACES);
            reported
                .map(|(recording, run, start, end, _)| interval(recording, run, start, end, None))
                .collect()
        }
    }
}

/// Time intervals in which the vehicle is in a region.
fn visits(
    searched: &SearchResult,
    inside: impl Fn([f64; 2]) -> bool,
) -> Vec<(usize, usize, f64, f64)> {
    let problem = &searched.problem;
    let mut found: Vec<(usize, usize, f64, f64)> = Vec::new();
    for segment in &searched.first.system.segments {
        let data = &problem.segments[segment.index];
        let run = &problem.recordings[data.recording].runs[data.run];
        for edges in segment.edges.windows(2) {
            let middle = 0.5 * (edges[0] + edges[1]);
            let at = |channel| run.series(channel).and_then(|series| series.at(middle));
            let place = at(recording::Channel::X).zip(at(recording::Channel::Y));
            if !place.is_some_and(|(x, y)| inside([x, y])) {
                continue;
            }
            let key = (data.recording, data.run);
            let last = found.last_mut();
            match last.filter(|last| (last.0, last.1) == key && edges[0] - last.3 < 1e-6) {
                Some(last) => last.3 = edges[1],
                None => found.push((key.0, key.1, edges[0], edges[1])),
            }
        }
    }
    found
}

/// The smallest centred disc around the path in a time interval.
fn patch(
    searched: &SearchResult,
    recording: usize,
    run: usize,
    start: f64,
    end: f64,
) -> Option<[f64; 3]> {
    let run = &searched.problem.recordings[recording].runs[run];
    let (x, y) = (
        run.series(recording::Channel::X)?,
        run.series(recording::Channel::Y)?,
    );
    let times = x.time.iter().filter(|time| (start..=end).contains(*time));
    let places: Vec<[f64; 2]> = times
        .filter_map(|time| Some([x.at(*time)?, y.at(*time)?]))
        .collect();
    let range = |axis: usize| {
        let values = places.iter().map(|place| place[axis]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
            (a.min(v), b.max(v))
        })
    };
    let ((west, east), (south, north)) = (range(0), range(1));
    let centre = [0.5 * (west + east), 0.5 * (south + north)];
    let radius = places
        .iter()
        .map(|[x, y]| (x - centre[0]).hypot(y - centre[1]))
        .fold(0.0, f64::max);
    (!places.is_empty()).then_some([centre[0], centre[1], radius])
}

/// The finding of a latent wrench.
fn latent_wrench(searched: &SearchResult, judged: &JudgedFinding) -> Finding {
    let size = searched.last.latent_wrench.map_or([0.0; 3], |w| w.size);
    let largest = (0..3)
        .max_by(|a, b| size[*a].total_cmp(&size[*b]))
        .unwrap_or(0);
    let channel = [Channel::Longitudinal, Channel::Lateral, Channel::Yaw][largest];
    let problem = &searched.problem;
    let mut places: Vec<(f64, Interval)> = Vec::new();
    for (recording, run) in problem.runs() {
        let found = smooth(problem, &searched.last.system, recording, run, size);
        let Some(trace) = found else { continue };
        let ratio = |k: usize| (trace.value[k][largest] / trace.deviation[k][largest]).abs();
        let strongest = (0..trace.time.len()).max_by(|a, b| ratio(*a).total_cmp(&ratio(*b)));
        let Some(peak) = strongest else { continue };
        let strong = |k: &usize| ratio(*k) > 0.5 * ratio(peak);
        let first = (0..=peak).rev().take_while(strong).last().unwrap_or(peak);
        let last = (peak..trace.time.len())
            .take_while(strong)
            .last()
            .unwrap_or(peak);
        let half = 0.5
            * trace
                .time
                .windows(2)
                .next()
                .map_or(0.5, |pair| pair[1] - pair[0]);
        places.push((
            ratio(peak),
            Interval {
                recording: problem.names[recording].clone(),
                run,
                label: problem.label_of(recording, run),
                start: trace.time[first] - half,
                end: trace.time[last] + half,
                channel,
                regime: String::new(),
                patch: None,
            },
        ));
    }
    places.sort_by(|a, b| b.0.total_cmp(&a.0));
    let places: Vec<Interval> = places
        .into_iter()
        .take(MAX_PLACES)
        .map(|(_, place)| place)
        .collect();
    let weight = problem.nominal.vehicle.mass * crate::vehicle::GRAVITY;
    let (what, amount) = match channel {
        Channel::Yaw => (
            "moment about the vertical",
            format!(
                "{:.0} N m",
                size[2] * weight * problem.nominal.vehicle.half_track
            ),
        ),
        Channel::Lateral => (
            "force across the vehicle",
            format!("{:.0} N", size[1] * weight),
        ),
        _ => (
            "force along the vehicle",
            format!("{:.0} N", size[0] * weight),
        ),
    };
    let strongest = places.first().map_or(String::new(), |place| {
        format!(
            ", strongest from {:.1} to {:.1} s of {}",
            place.start,
            place.end,
            whose(place)
        )
    });
    Finding {
        subject: Subject::Unknown,
        probability: judged.probability,
        ambiguous_with: Vec::new(),
        evidence: searched.last.latent_wrench.map_or(0.0, |w| w.evidence),
        rivals: Vec::new(),
        parameters: Vec::new(),
        places,
        local: false,
        law: Vec::new(),
        mended_by: Vec::new(),
        statement: format!(
            "a time-varying {what} of about {amount} that no effect of the catalogue explains{strongest}"
        ),
    }
}
