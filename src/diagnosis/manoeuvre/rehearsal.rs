//! Manoeuvres simulated on the refitted soil, and the information of their recordings with the sensors at hand.

use super::course::{Course, DriveLimits, STEP, courses, steady};
use crate::diagnosis::hypothesis::candidate::TERRAIN_CHANGE;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
use crate::diagnosis::screening::system::{System, linearise};
use crate::effects::{CATALOGUE, ParameterName};
use crate::fit::deadline::Deadline;
use crate::fit::exact::ExactPredictor;
use crate::fit::predictor::{PredictionError, Predictor, Request, Trajectory};
use crate::fit::problem::NoiseModel;
use crate::fit::segment::{Segment, cut};
use crate::fit::sensor::SensorParameter;
use crate::fit::signal::Signal;
use crate::recording::{Channel, Drive, Recording, Run, Series};
use crate::simulation::State;
use crate::vehicle::{Specification, Vehicle};
use rayon::prelude::*;

/// The recordings at hand, linearised around the refitted model.
#[derive(Debug, Clone, Copy)]
pub struct AtHand<'a> {
    /// The given model and the recordings.
    pub problem: &'a Problem<'a>,
    /// The refitted soil and starts.
    pub refitted: &'a Solution,
    /// Noise.
    pub noise: &'a NoiseModel,
    /// Normal equations.
    pub system: &'a System,
}

/// A simulated manoeuvre.
#[derive(Debug, Clone)]
pub struct Rehearsal {
    /// The course.
    pub course: Course,
    /// Motion every [`STEP`] seconds.
    pub states: Vec<[f64; 6]>,
    drive: Drive,
}

/// All manoeuvres that the model can follow, and the normal equations of their recordings, in this order.
#[derive(Debug)]
pub struct Rehearsed {
    /// The manoeuvres.
    pub rehearsals: Vec<Rehearsal>,
    /// Their linearised problem.
    pub system: System,
}

/// A vehicle that moves by less than this share of its wheels' travel is bogged down.
const BOGGED: f64 = 0.1;
/// Time at the end over which a steady turn is averaged \[s\].
const STEADY: f64 = 1.0;
/// Minimum yaw rate of a turn \[rad/s\].
const SLOWEST: f64 = 0.05;

/// Rehearses for some coefficients. `None` without a template recording or drive limits.
#[must_use]
pub fn rehearse(at_hand: &AtHand, coefficients: &[usize], length: f64) -> Option<Rehearsed> {
    let AtHand {
        problem, refitted, ..
    } = at_hand;
    let template = template(problem)?;
    let model = problem.specification(refitted, template).ok()?;
    let reach = DriveLimits::of(problem.recordings, &model.vehicle)?;
    let first = problem
        .segments
        .iter()
        .position(|s| s.recording == template);
    let [x, y, heading, ..] = refitted.starts[first?];
    let start = State {
        x,
        y,
        heading,
        ..State::default()
    };
    let rehearsals = drive_all(&model, start, &reach, problem.deadline);
    let sampling = sampling(&problem.recordings[template]);
    let recordings: Vec<Recording> = rehearsals
        .iter()
        .map(|one| one.recording(&sampling))
        .collect();
    let cut = cut(
        &recordings,
        &vec![[0.0; SensorParameter::ALL.len()]; recordings.len()],
        length,
    );
    let rehearsed = Problem {
        nominal: beyond(problem)?,
        recordings: &recordings,
        names: recordings.iter().map(|r| r.name.clone()).collect(),
        soil: problem.soil.clone(),
        candidates: problem.candidates.clone(),
        segments: cut.segments,
        late: vec![[0.0; SensorParameter::ALL.len()]; recordings.len()],
        maps: problem.maps,
        stiffening: 1.0,
        tolerance: problem.tolerance,
        wheels: None,
        deadline: problem.deadline,
    };
    let off = problem.initial().coefficients.swap_remove(template);
    let at = Solution {
        soil: refitted.soil.clone(),
        coefficients: vec![off; recordings.len()],
        starts: rehearsed
            .segments
            .iter()
            .map(|segment| rehearsals[segment.recording].at(segment.start))
            .collect(),
    };
    let noise = NoiseModel {
        noise: vec![at_hand.noise.noise[template]; recordings.len()],
        weights: rehearsed
            .segments
            .iter()
            .map(|s| weights(s, &sampling))
            .collect(),
    };
    let layout = Layout::single_bin(&rehearsed, coefficients);
    let tables = sensitivities(&rehearsed, &layout, &at);
    let system = linearise(&rehearsed, &layout, &tables, &at, &noise);
    Some(Rehearsed { rehearsals, system })
}

/// Simulates all manoeuvres, without those that the model cannot follow.
fn drive_all(
    model: &Specification,
    start: State,
    reach: &DriveLimits,
    deadline: Deadline,
) -> Vec<Rehearsal> {
    let turn = |forward, turn| {
        let one = drive(model, start, steady(forward, turn), deadline).ok()?;
        let last = &one.states[one.states.len() - (STEADY / STEP) as usize..];
        let mean = last.iter().map(|state| state[5]).sum::<f64>() / last.len() as f64;
        (mean.abs() > SLOWEST).then_some(mean.abs())
    };
    let all: Vec<Option<Rehearsal>> = courses(reach, turn)
        .into_par_iter()
        .map(|course| drive(model, start, course, deadline).ok())
        .collect();
    all.into_iter()
        .flatten()
        .filter(|one| one.moves(&model.vehicle))
        .collect()
}

/// The longest recording: the next one is made with its sensors.
fn template(problem: &Problem) -> Option<usize> {
    let seconds = |recording: usize| -> f64 {
        let own = problem.segments.iter().filter(|s| s.recording == recording);
        own.map(|s| s.end - s.start).sum()
    };
    let each = (0..problem.recordings.len()).map(|recording| (recording, seconds(recording)));
    let best = each.rev().max_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|(_, seconds)| *seconds > 0.0)
        .map(|(recording, _)| recording)
}

/// The given model; the other soil of a change of terrain lies under the wheels from the start.
fn beyond(problem: &Problem) -> Option<Specification> {
    let mut nominal = problem.nominal.clone();
    let mut coefficients = problem.candidates.coefficients.iter();
    if coefficients.any(|coefficient| CATALOGUE[coefficient.effect].name == TERRAIN_CHANGE) {
        let position = ParameterName::find(&format!("{TERRAIN_CHANGE}.position"))?;
        nominal.effects.set(position, -1e6).ok()?;
    }
    Some(nominal)
}

/// How a channel is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sampling {
    signal: Signal,
    /// Seconds between two samples.
    interval: f64,
    /// Weight of a sample, as there are fewer than in a recording.
    weight: f64,
}

/// The channels and rates of a recording.
fn sampling(recording: &Recording) -> Vec<Sampling> {
    let one = |signal: Signal| {
        let runs = recording.runs.iter();
        let longest = runs
            .filter_map(|run| run.series(signal.channel()))
            .max_by_key(|series| series.len())?;
        let recorded = longest.median_interval()?;
        let interval = recorded.max(STEP);
        Some(Sampling {
            signal,
            interval,
            weight: interval / recorded,
        })
    };
    Signal::ALL.into_iter().filter_map(one).collect()
}

fn weights(segment: &Segment, sampling: &[Sampling]) -> Vec<Vec<f64>> {
    let one = |samples: &crate::fit::segment::Samples| {
        let same = sampling.iter().find(|s| s.signal == samples.signal);
        vec![same.map_or(1.0, |s| s.weight); samples.time.len()]
    };
    segment.samples.iter().map(one).collect()
}

fn drive(
    model: &Specification,
    start: State,
    course: Course,
    deadline: Deadline,
) -> Result<Rehearsal, PredictionError> {
    let drive = course.drive(model.vehicle.wheel_radius);
    let mut driven = Trajectory::default();
    let request = Request {
        parameters: &[],
        start: &start,
        course: &[],
        clock: 0.0,
        drive: &drive,
        wheel_latency: 0.0,
        times: &drive.time,
        time_bins: &[],
        derivatives: false,
    };
    ExactPredictor::new(model.clone(), Vec::new())
        .with_deadline(deadline)
        .predict(&request, &mut driven)?;
    Ok(Rehearsal {
        course,
        states: driven.states,
        drive,
    })
}

impl Rehearsal {
    /// Whether the vehicle follows its wheels.
    fn moves(&self, vehicle: &Vehicle) -> bool {
        let (mut rolled, mut moved) = (0.0, 0.0);
        for (row, state) in self.states.iter().enumerate() {
            let [left, right] = self.drive.wheel_speeds(row);
            let turn = state[5] * vehicle.half_track;
            rolled += (left.abs() + right.abs()) * vehicle.wheel_radius;
            moved += (state[3] - turn).abs() + (state[3] + turn).abs();
        }
        moved > BOGGED * rolled
    }

    /// The state at a time \[s\].
    fn at(&self, time: f64) -> [f64; 6] {
        let last = self.states.len() - 1;
        let place = (time / STEP).clamp(0.0, last as f64);
        let row = (place as usize).min(last.saturating_sub(1));
        let (from, to) = (&self.states[row], &self.states[(row + 1).min(last)]);
        let share = place - row as f64;
        std::array::from_fn(|k| from[k] + share * (to[k] - from[k]))
    }

    /// What sensors without noise record.
    fn recording(&self, sampling: &[Sampling]) -> Recording {
        let series = |values: &[f64]| Series {
            time: self.drive.time.clone(),
            value: values.to_vec(),
        };
        let mut run = Run::new("")
            .with(Channel::OmegaLeft, series(&self.drive.omega_left))
            .with(Channel::OmegaRight, series(&self.drive.omega_right));
        for channel in sampling {
            let place = Signal::ALL.iter().position(|s| *s == channel.signal);
            let count = (self.drive.duration() / channel.interval) as usize;
            let times = (0..count).map(|k| k as f64 * channel.interval);
            let value = |time| (time, place.map_or(0.0, |place| self.at(time)[place]));
            run = run.with(channel.signal.channel(), times.map(value).collect());
        }
        Recording {
            name: self.course.name.to_owned(),
            runs: vec![run],
            ..Recording::default()
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::terrain::Terrain;

    fn reach(model: &Specification) -> DriveLimits {
        DriveLimits {
            speed: 1.0,
            wheel_radius: model.vehicle.wheel_radius,
            half_track: model.vehicle.half_track,
        }
    }

    /// All manoeuvres on a soil.
    pub fn all(model: &Specification) -> Vec<Rehearsal> {
        drive_all(model, State::default(), &reach(model), Deadline::NEVER)
    }

    /// A recording of a straight drive east, from a GPS receiver with a heading at 10 Hz.
    pub fn steady_straight(model: &Specification) -> Recording {
        driven(model, "straight")
    }

    /// A recording of a manoeuvre, from such a receiver.
    pub fn driven(model: &Specification, name: &str) -> Recording {
        let mut all = all(model).into_iter();
        let one = all.find(|one| one.course.name == name).unwrap();
        let channel = |signal| Sampling {
            signal,
            interval: 0.1,
            weight: 1.0,
        };
        one.recording(&[Signal::X, Signal::Y, Signal::Heading].map(channel))
    }

    #[test]
    fn manoeuvres_are_what_their_names_say() {
        let model =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let all = all(&model);
        let last = |name: &str| {
            let one = all.iter().find(|one| one.course.name == name).unwrap();
            one.states[one.states.len() - 1]
        };
        let [x, y, heading, ..] = last("straight");
        assert!(x > 10.0 && y.abs() < 1e-6 && heading.abs() < 1e-9);
        // Half a turn, and back to the start.
        let [x, y, heading, ..] = last("there_and_back");
        assert!((heading - std::f64::consts::PI).abs() < 0.3, "{heading}");
        assert!(x.abs() < 1.0 && y.abs() < 4.0, "{x} {y}");
        let [x, y, heading, ..] = last("pivots");
        assert!(x.hypot(y) < 0.5 && heading.abs() < 0.2, "{x} {y} {heading}");
        let [.., v_x, v_y, yaw_rate] = last("spiral");
        assert!(v_x.abs() + v_y.abs() + yaw_rate.abs() < 0.05);
    }

    #[test]
    fn fewer_samples_count_for_as_much() {
        let time: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let value = vec![0.0; time.len()];
        let run = Run::new("").with(Channel::YawRate, Series { time, value });
        let recording = Recording {
            runs: vec![run],
            ..Recording::default()
        };
        let found = sampling(&recording);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].interval, STEP);
        assert!((found[0].weight - STEP / 0.01).abs() < 1e-9);
    }
}
