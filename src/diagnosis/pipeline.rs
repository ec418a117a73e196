//! The steps in their order.

use super::hypothesis::Given;
use super::likelihood::{tune, tune_with_noise};
use super::prepare::{prepare, seconds};
use super::screen::{Projection, chance, one_degree};
use super::sensitivity::{Layout, sensitivities};
use super::system::{linearise, weigh};
use super::{DiagnosisError, Options};
use crate::recording::Recording;
use crate::vehicle::Specification;
use std::time::Instant;

/// Debug.
pub fn probe(
    recordings: &[Recording],
    nominal: &Specification,
    options: &Options,
) -> Result<(), DiagnosisError> {
    let started = Instant::now();
    let mut given = Given::new(nominal, recordings);
    let (_, mut by) = prepare(&mut given, options)?;
    let lap = |what: &str| eprintln!("{:7.2} s {what}", started.elapsed().as_secs_f64());
    lap(&format!(
        "prepared {} segments {} s",
        given.segments.len(),
        seconds(&given)
    ));
    let mut on: Vec<usize> = Vec::new();
    let mut best = tune_with_noise(&given, &on, &given.begin(), &mut by)
        .map_err(DiagnosisError::Undrivable)?;
    lap(&format!(
        "baseline cost {} surprise {} soil {:?}",
        best.cost, best.surprise, best.solution.soil
    ));
    for group in 0..5 {
        let n = by.noise[0][group];
        eprintln!(
            "   noise {:.4} {:.4} {:.2}",
            n.white, n.coloured, n.correlation_time
        );
    }
    for round in 0..4 {
        let layout = Layout::new(&given, &on);
        let mut system = None;
        for pass in 0..1 {
            let tables = sensitivities(&given, &layout, &best.solution);
            lap("sensitivities");
            let s = linearise(&given, &layout, &tables, &best.solution, &mut by, true);
            lap("linearised");
            for group in 0..5 {
                let n = by.noise[0][group];
                eprintln!(
                    "   noise {:.4} {:.4} {:.2}",
                    n.white, n.coloured, n.correlation_time
                );
            }
            best = tune(&given, &on, &best.solution, &by).map_err(DiagnosisError::Undrivable)?;
            weigh(&given, &on, &best.tables, &mut by);
            best = tune(&given, &on, &best.solution, &by).map_err(DiagnosisError::Undrivable)?;
            lap(&format!(
                "retuned cost {} surprise {}",
                best.cost, best.surprise
            ));
            system = Some(s);
            let _ = pass;
        }
        let tables = sensitivities(&given, &layout, &best.solution);
        let system2 = linearise(&given, &layout, &tables, &best.solution, &mut by, false);
        lap("linearised");
        drop(system);
        let system = system2;
        let further: Vec<usize> = on.iter().flat_map(|k| system.unknowns(*k)).collect();
        let projection =
            Projection::over_all(&system, &further).ok_or(DiagnosisError::NotFinite)?;
        let all = super::naming::screened(&given, &system, &projection, &on);
        let list: Vec<_> = all.iter().map(|s| s.projected.clone()).collect();
        let threshold = chance(&projection, &list, 0.95, 400, options.seed);
        eprintln!("threshold chi2 {threshold}");
        let wander = super::wrench::wandering(&given, &system);
        lap(&format!("wandering {wander:?}"));
        let mut sorted: Vec<_> = all.iter().collect();
        sorted.sort_by(|a, b| b.score.evidence.total_cmp(&a.score.evidence));
        for s in sorted.iter().take(8) {
            let score = &s.score;
            eprintln!(
                "   {:20} ev {:9.2} chi {:9.2} ({:8.2}) phi {:6.2} absorbed {:.3} step {:?} +- {:?}",
                s.subject.name(),
                score.evidence,
                score.chi_square,
                one_degree(score.chi_square, s.projected.unknowns.len()),
                score.scatter,
                score.absorbed,
                score
                    .step
                    .as_slice()
                    .iter()
                    .map(|v| (v * 1e4).round() / 1e4)
                    .collect::<Vec<_>>(),
                score
                    .deviation
                    .as_slice()
                    .iter()
                    .map(|v| (v * 1e4).round() / 1e4)
                    .collect::<Vec<_>>(),
            );
        }
        let proposals = super::naming::proposals(
            &given,
            &system,
            &projection,
            &all,
            &on,
            &best.solution.soil,
            options.seed,
        );
        lap("proposals");
        for p in proposals.iter().take(10) {
            eprintln!(
                "   proposal {:20} {:8.2} looking {:.2} {:?} {:?}",
                p.subject.name(),
                p.evidence,
                p.looking,
                p.extent,
                p.knobs
                    .iter()
                    .map(|k| given.candidates.knobs[*k].parameter.name.clone())
                    .collect::<Vec<_>>()
            );
        }
        let base = super::held_out::scores(&given, &best, &by);
        let mut fitted = Vec::new();
        for p in super::naming::shortlist(&proposals) {
            if let Some(n) = super::naming::fit(&given, p, &best, &by) {
                let gain = n
                    .scores
                    .as_ref()
                    .zip(base.as_ref())
                    .map(|(a, b)| a.gain_over(b));
                lap(&format!(
                    "fit {} {:?} gain {:.2} held out {:?}",
                    p.subject.name(),
                    p.extent,
                    n.gain,
                    gain
                ));
                for k in &p.knobs {
                    eprintln!(
                        "      {} {:.4} (linear {:?})",
                        given.candidates.knobs[*k].parameter.name,
                        n.tuned.solution.knobs[0][*k],
                        p.steps.iter().find(|s| s.0 == *k).map(|s| s.1[0])
                    );
                }
                fitted.push(n);
            } else {
                lap(&format!("fit {} failed", p.subject.name()));
            }
        }
        fitted.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let Some(first) = fitted.into_iter().next().filter(|n| n.gain > 4.0) else {
            break;
        };
        eprintln!("round {round}: take {}", first.proposal.subject.name());
        on = first.tuned.knobs.clone();
        given = first.given;
        best = first.tuned;
    }
    Ok(())
}
