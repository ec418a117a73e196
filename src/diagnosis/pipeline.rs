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
        for pass in 0..2 {
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
        let mut all = Vec::new();
        for subject in &given.candidates.subjects {
            let unknowns: Vec<usize> = given
                .candidates
                .of(*subject)
                .flat_map(|k| system.unknowns(k))
                .collect();
            if unknowns.is_empty() || given.candidates.of(*subject).any(|k| on.contains(&k)) {
                continue;
            }
            all.push((*subject, projection.of(&unknowns)));
        }
        let list: Vec<_> = all.iter().map(|(_, p)| p.clone()).collect();
        let threshold = chance(&projection, &list, 0.95, 400, options.seed);
        eprintln!("threshold chi2 {threshold}");
        let mut scored: Vec<_> = all
            .iter()
            .map(|(s, p)| (*s, projection.score(p), p))
            .collect();
        scored.sort_by(|a, b| b.1.evidence.total_cmp(&a.1.evidence));
        for (subject, score, p) in scored.iter() {
            eprintln!(
                "   {:20} ev {:9.2} chi {:9.2} ({:8.2}) phi {:6.2} absorbed {:.3} step {:?} +- {:?}",
                subject.name(),
                score.evidence,
                score.chi_square,
                one_degree(score.chi_square, p.unknowns.len()),
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
        let mut refits = Vec::new();
        for (subject, score, p) in scored.iter().take(4) {
            if score.evidence < 1.0 {
                continue;
            }
            let mut knobs = on.clone();
            knobs.extend(given.candidates.of(*subject));
            let mut begin = best.solution.clone();
            given.step(&system, &mut begin, &p.unknowns, &score.step);
            match tune(&given, &knobs, &begin, &by) {
                Ok(t) => {
                    lap(&format!(
                        "refit {} gain {} cost {}",
                        subject.name(),
                        best.surprise - t.surprise,
                        t.cost
                    ));
                    for k in given.candidates.of(*subject) {
                        eprintln!(
                            "      {} {}",
                            given.candidates.knobs[k].parameter.name, t.solution.knobs[0][k]
                        );
                    }
                    refits.push((*subject, t));
                }
                Err(e) => eprintln!("   {} failed {e}", subject.name()),
            }
        }
        refits.sort_by(|a, b| a.1.surprise.total_cmp(&b.1.surprise));
        match refits.into_iter().next() {
            Some((subject, t)) if best.surprise - t.surprise > 4.0 => {
                eprintln!("round {round}: take {}", subject.name());
                on = t.knobs.clone();
                best = t;
            }
            _ => break,
        }
    }
    Ok(())
}
