//! A fit ends at its deadline, and one that is not met changes nothing.

use super::synthetic::{QUIET, nominal, plain, record};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use ugv_terrain::fit::catalogue::{describe, find};
use ugv_terrain::fit::deadline::{Deadline, Watch};
use ugv_terrain::fit::exact::ExactPredictor;
use ugv_terrain::fit::predictor::PredictionError;
use ugv_terrain::fit::{Fit, FitError, fit};
use ugv_terrain::recording::Recording;
use ugv_terrain::vehicle::{ModelParameter, Specification};

/// Counts how often it is asked, and is over after so many times.
struct Counted {
    asked: AtomicUsize,
    until: usize,
}

impl Counted {
    fn new(until: usize) -> Self {
        Self {
            asked: AtomicUsize::new(0),
            until,
        }
    }

    fn asked(&self) -> usize {
        self.asked.load(Ordering::Relaxed)
    }
}

impl Watch for Counted {
    fn is_over(&self, _end: Duration) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.until
    }
}

fn fitted(
    begin: &Specification,
    recordings: &[Recording],
    deadline: Deadline,
) -> Result<Fit, FitError> {
    let free: [ModelParameter; 2] = ["cohesion", "friction_angle"].map(|name| find(name).unwrap());
    let predictor = ExactPredictor::new(begin.clone(), free.to_vec()).with_deadline(deadline);
    let parameters = free.iter().map(|p| describe(*p, begin)).collect();
    let values = free.map(|p| p.get(begin));
    fit(
        &predictor,
        parameters,
        &values,
        recordings,
        &plain(),
        &|_| {},
    )
}

#[test]
fn a_fit_ends_at_its_deadline() {
    let recordings = [record(&nominal("sandy_loam"), 15.0, &QUIET)];
    let begin = nominal("clayed_soil");
    let free = fitted(&begin, &recordings, Deadline::NEVER).unwrap();
    let never = Counted::new(usize::MAX);
    let watched = fitted(&begin, &recordings, Deadline::new(&never, Duration::ZERO)).unwrap();
    assert_eq!(format!("{free:?}"), format!("{watched:?}"));
    // Each prediction asks at every row of wheel speeds.
    let rows = recordings[0].runs[0].drive().unwrap().len();
    assert!(never.asked() > 10 * rows, "{}", never.asked());
    for share in 0..7 {
        let watch = Counted::new(never.asked() * share / 8);
        let error = fitted(&begin, &recordings, Deadline::new(&watch, Duration::ZERO));
        let error = error.unwrap_err();
        assert_eq!(error, FitError::Start(PredictionError::OutOfTime));
        // Each of a few segments asks once more, and so do the loops around them.
        let after = watch.asked() - watch.until;
        assert!(after < 60, "{after}");
    }
}
