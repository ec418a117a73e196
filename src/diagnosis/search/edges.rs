//! Exact edges of regions.
//!
//! The box scan resolves regions by time bins on the linearised problem. A strong effect determines its edges to some
//! hundredths of a second, and an error of a tenth costs all candidates more than what they differ by. So the edges
//! of the candidates close to the likeliest are refined in the full fit: they are unknowns of a Gauss–Newton step
//! beside all others, with derivatives by differences; then the others follow.

use super::accepted::close_to;
use super::naming::{FittedCandidate, placed};
use super::proposal::{Proposal, ProposalKind};
use super::rerank::AT_STAKE;
use crate::diagnosis::hypothesis::Solution;
use crate::diagnosis::hypothesis::held_out::scores;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, PARTIAL_FIT, continue_fit, cost, fit_until, own_noise,
};
use crate::diagnosis::screening::region::Region;
use crate::fit::normal::{Eliminated, Normal, Reduced};
use crate::fit::problem::{NoiseModel, Tables};
use nalgebra::{DMatrix, DVector};

/// Unit of edges: the disc's radius, or two seconds. Derivatives are differences over this share ...
const DIFFERENCE: f64 = 0.02;
const SECONDS: f64 = 2.0;
/// ... their prior's standard deviation, and the limit of a step.
const PRIOR: f64 = 1.0;
const REACH: f64 = 0.25;
/// Damping of steps that lose, as a share of the diagonal (Marquardt 1963): beside a wrong edge, soil and effect move
/// far along poorly determined directions, where the problem is not linear.
const DAMPINGS: [f64; 4] = [0.0, 1e-3, 1e-2, 0.1];
/// Maximum number of steps, gain of log evidence to continue, and to accept: fits end half a unit from their optimum.
const STEPS: usize = 10;
const CONTINUE_GAIN: f64 = 1.0;
const MIN_GAIN: f64 = 0.5;
/// A disc has a centre (two numbers) and a radius; an interval two ends.
const EDGES: usize = 3;
/// Shortest interval \[s\].
const SHORTEST: f64 = 0.1;

/// Refines the edges of the local candidates close to the likeliest, whose log odds are `best`.
pub fn refine_edges(fitted: &mut [FittedCandidate], best: f64, noise: &NoiseModel) {
    if best < AT_STAKE {
        return;
    }
    let close = |candidate: &&mut FittedCandidate| {
        candidate.proposal.kind() == ProposalKind::Local && candidate.odds() > close_to(best)
    };
    for candidate in fitted.iter_mut().filter(close) {
        let before = candidate.fit.negative_log_evidence;
        refine(candidate, noise);
        if candidate.fit.negative_log_evidence < before {
            candidate.scores = scores(&candidate.problem, &candidate.fit, noise);
        }
    }
}

/// Refines the edges of the accepted candidate under the noise of the residuals that it leaves. The larger noise of the
/// model without it hides information about the edges. It keeps its odds and scores.
pub fn refine_under_own_noise(candidate: &mut FittedCandidate, noise: &NoiseModel) {
    if candidate.proposal.kind() != ProposalKind::Local || candidate.odds() < AT_STAKE {
        return;
    }
    let gain = candidate.gain;
    let own = own_noise(&candidate.problem, &candidate.fit, noise);
    candidate.fit = continue_fit(&candidate.problem, &candidate.fit, &own, PARTIAL_FIT);
    refine(candidate, &own);
    candidate.gain = gain;
}

fn refine(candidate: &mut FittedCandidate, noise: &NoiseModel) {
    for _ in 0..STEPS {
        if stepped(candidate, noise).is_none_or(|gain| gain < CONTINUE_GAIN) {
            break;
        }
    }
}

/// One step of the edges and everything else; returns its gain. `None` without a gain.
fn stepped(candidate: &mut FittedCandidate, noise: &NoiseModel) -> Option<f64> {
    let coefficients = &candidate.fit.coefficients;
    let way = EdgeSystem::of(candidate, noise)?;
    let (proposal, problem, initial) = DAMPINGS.into_iter().find_map(|damping| {
        let step = way.step(damping)?;
        let proposal = moved(&candidate.proposal, &way.edges(&step))?;
        let problem = placed(&candidate.problem, &proposal)?;
        let initial = way.solution(candidate, &step);
        let lower = cost(&problem, coefficients, &initial, noise) < way.cost;
        lower.then_some((proposal, problem, initial))
    })?;
    let fit = fit_until(&problem, coefficients, &initial, noise, PARTIAL_FIT).ok()?;
    let gain = candidate.fit.negative_log_evidence - fit.negative_log_evidence;
    if gain.is_nan() || gain < MIN_GAIN {
        return None;
    }
    candidate.gain += gain;
    (candidate.proposal, candidate.problem, candidate.fit) = (proposal, problem, fit);
    Some(gain)
}

/// The normal equations with the edges among the unknowns.
struct EdgeSystem {
    /// Number of unknowns before the edges.
    others: usize,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    segments: Vec<(Normal, Eliminated)>,
    /// Half the cost here.
    cost: f64,
}

impl EdgeSystem {
    fn of(candidate: &FittedCandidate, noise: &NoiseModel) -> Option<Self> {
        let FittedHypothesis {
            coefficients,
            solution,
            tables,
            ..
        } = &candidate.fit;
        let predictor = candidate.problem.predictor(coefficients);
        let shooting = candidate.problem.shooting(&predictor, coefficients);
        let point = candidate.problem.point(&shooting, coefficients, solution);
        let here = shooting.evaluate_unless_one_fails(&point, false)?;
        let after = (0..EDGES).map_while(|edge| {
            let mut step = DVector::zeros(EDGES);
            step[edge] = DIFFERENCE;
            let problem = placed(&candidate.problem, &moved(&candidate.proposal, &step)?)?;
            let predictor = problem.predictor(coefficients);
            let shooting = problem.shooting(&predictor, coefficients);
            shooting.evaluate_unless_one_fails(&point, false)
        });
        let after: Vec<Vec<Tables>> = after.collect();
        let others = shooting.parameters.len();
        let linearised = shooting.linearised(&point);
        let linearised = linearised.with_further(&vec![PRIOR.powi(-2); after.len()]);
        let tables = tables.iter().enumerate().map(|(index, segment)| {
            let after: Vec<&Tables> = after.iter().map(|all| &all[index]).collect();
            with_differences(segment, &here[index], &after)
        });
        let normals = linearised.normals(&tables.collect::<Vec<_>>(), noise);
        let Reduced {
            matrix,
            gradient,
            each,
        } = Reduced::new(&normals, &linearised.precision, &linearised.pull, 0.0)?;
        let gain = |matrix: DMatrix<f64>, gradient: DVector<f64>| {
            let step = matrix.cholesky()?.solve(&gradient);
            Some(0.5 * step.dot(&gradient))
        };
        let still = matrix.view((0, 0), (others, others)).into_owned();
        let without = gain(still, gradient.rows(0, others).into_owned())?;
        let with = gain(matrix.clone(), gradient.clone())?;
        if (with - without).is_nan() || with - without < MIN_GAIN {
            return None;
        }
        Some(Self {
            others,
            matrix,
            gradient,
            segments: normals.into_iter().zip(each).collect(),
            cost: 0.5 * shooting.cost(&here, &point, noise),
        })
    }

    /// The damped step of all unknowns, cut to the limit of the edges.
    fn step(&self, damping: f64) -> Option<DVector<f64>> {
        let mut damped = self.matrix.clone();
        for k in 0..damped.nrows() {
            damped[(k, k)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&self.gradient);
        let far = self.edges(&step).amax();
        Some(step * (REACH / far).min(1.0))
    }

    fn edges(&self, step: &DVector<f64>) -> DVector<f64> {
        let count = step.len() - self.others;
        step.rows(self.others, count).into_owned()
    }

    /// The solution after a step.
    fn solution(&self, candidate: &FittedCandidate, step: &DVector<f64>) -> Solution {
        let FittedCandidate { problem, fit, .. } = candidate;
        let predictor = problem.predictor(&fit.coefficients);
        let shooting = problem.shooting(&predictor, &fit.coefficients);
        let mut point = problem.point(&shooting, &fit.coefficients, &fit.solution);
        for (k, parameter) in shooting.parameters.iter().enumerate() {
            let (low, high) = parameter.bounds();
            point.coordinates[k] = (point.coordinates[k] + step[k]).clamp(low, high);
        }
        for (start, (normal, eliminated)) in point.starts.iter_mut().zip(&self.segments) {
            let moved = eliminated.start_step(normal, step);
            for (value, moved) in start.iter_mut().zip(moved) {
                *value += moved;
            }
        }
        problem.solution(&shooting, &fit.coefficients, &point, &fit.solution)
    }
}

/// A segment's table with derivatives by the edges as last columns: `after` are its residuals with each edge moved.
fn with_differences(segment: &Tables, here: &Tables, after: &[&Tables]) -> Tables {
    let columns = segment.columns + after.len();
    let channels = segment.channels.iter().enumerate();
    let channels = channels.map(|(channel, table)| {
        let mut wider = Vec::with_capacity(table.len() / segment.columns * columns);
        for (row, numbers) in table.chunks_exact(segment.columns).enumerate() {
            let before = here.channels[channel][row];
            let slope = |moved: &&Tables| (before - moved.channels[channel][row]) / DIFFERENCE;
            wider.extend(numbers);
            wider.extend(after.iter().map(slope));
        }
        wider
    });
    Tables {
        channels: channels.collect(),
        columns,
    }
}

/// A proposal with its edges moved; `None` without edges, or for an empty region.
fn moved(proposal: &Proposal, shares: &DVector<f64>) -> Option<Proposal> {
    Some(Proposal {
        extent: Some(nudged(proposal.extent.as_ref()?, shares)?),
        ..proposal.clone()
    })
}

fn nudged(extent: &Region, shares: &DVector<f64>) -> Option<Region> {
    let shares = |edge: usize| shares.get(edge).copied().unwrap_or(0.0);
    match extent {
        Region::Place { disc } => {
            let radius = disc[2];
            let at = |edge: usize| disc[edge] + shares(edge) * radius;
            Some(Region::Place {
                disc: [at(0), at(1), at(2)],
            })
        }
        Region::Time(at) if shares(2) == 0.0 => {
            let mut at = *at;
            at.start += SECONDS * shares(0);
            at.end += SECONDS * shares(1);
            (at.end - at.start > SHORTEST).then_some(Region::Time(at))
        }
        Region::Time(_) | Region::Run(_) | Region::Beyond { .. } => None,
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::diagnosis::Subject;
    use crate::diagnosis::screening::region::RunInterval;
    use crate::diagnosis::search::naming::ANY;
    use crate::diagnosis::search::naming::{finish, partial_fit};
    use crate::diagnosis::search::stage::Stage;
    use crate::diagnosis::testing::{driven, on, refitted, with_effects};
    use crate::effects::CATALOGUE;
    use crate::recording::Recording;

    use crate::vehicle::Specification;

    /// A vehicle and its recording, on which it was slowed from 6.7 s to 12.15 s.
    pub fn slowed() -> (Specification, [Recording; 1]) {
        let nominal = on("sandy_loam");
        let text = r#"{"drag": {"coefficient": 150}, "window": {"effects": ["drag"], "time": [6.7, 12.15]}}"#;
        let slowed = with_effects(&nominal, text);
        let recording = driven(&slowed, "slalom");
        (nominal, [recording])
    }

    /// Drag from 6.9 s to 12.4 s, fitted.
    pub fn drag<'a>(stage: &Stage<'a>, noise: &NoiseModel) -> FittedCandidate<'a> {
        let drag = CATALOGUE.iter().position(|e| e.name == "drag").unwrap();
        let subject = Subject::Effect(drag);
        let coefficients: Vec<usize> = stage.problem.candidates.of(subject).collect();
        let proposal = Proposal {
            extent: Some(Region::Time(RunInterval {
                recording: 0,
                run: 0,
                start: 6.9,
                end: 12.4,
            })),
            steps: vec![(coefficients[0], DVector::repeat(1, 100.0))],
            price: 7.0,
            soil: DVector::zeros(stage.problem.soil.len()),
            ..Proposal::new(subject, coefficients)
        };
        let started = partial_fit(&stage.problem, &proposal, &stage.fit, noise, 1.0, ANY).unwrap();
        finish(started, &stage.fit, noise).unwrap()
    }

    #[test]
    fn edges_move_to_where_something_acts() {
        let (nominal, recordings) = slowed();
        let (stage, noise) = refitted(&nominal, &recordings);
        let mut fitted = [drag(&stage, &noise)];
        let before = fitted[0].gain;
        refine_edges(&mut fitted, before, &noise);
        let Some(Region::Time(at)) = fitted[0].proposal.extent else {
            unreachable!()
        };
        assert!(
            (at.start - 6.7).abs() < 0.05 && (at.end - 12.15).abs() < 0.05,
            "{at:?}"
        );
        assert!(fitted[0].gain > before + 20.0);
    }

    #[test]
    fn each_edge_moves_alone() {
        let disc = Region::Place {
            disc: [1.0, 2.0, 4.0],
        };
        let shares = |edge: usize| {
            let mut shares = DVector::zeros(EDGES);
            shares[edge] = 0.1;
            shares
        };
        let moved = |edge| match nudged(&disc, &shares(edge)) {
            Some(Region::Place { disc }) => disc,
            _ => unreachable!(),
        };
        assert_eq!(moved(0), [1.4, 2.0, 4.0]);
        assert_eq!(moved(1), [1.0, 2.4, 4.0]);
        assert_eq!(moved(2), [1.0, 2.0, 4.4]);
        let interval = |end| {
            Region::Time(RunInterval {
                recording: 0,
                run: 0,
                start: 1.0,
                end,
            })
        };
        assert_eq!(nudged(&interval(3.0), &shares(1)), Some(interval(3.2)));
        // An interval has two ends, and does not vanish.
        assert_eq!(nudged(&interval(3.0), &shares(2)), None);
        assert_eq!(nudged(&interval(1.2), &shares(0)), None);
    }
}
