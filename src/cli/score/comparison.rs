//! Models predict the same windows.

use super::entries::Entry;
use rayon::prelude::*;
use ugv_terrain::identification::{
    DataSplit, ErrorSummary, Latencies, PoseError, PredictionWindow, WindowOptions, WindowSet,
    common, summarise,
};

/// A recording's windows and the models that are to predict them.
pub struct Comparison {
    pub name: String,
    pub latencies: Latencies,
    /// How the windows are cut.
    pub how: WindowOptions,
    pub heading_noise: Option<f64>,
    pub set: WindowSet,
    pub halves: DataSplit,
    pub entries: Vec<Entry>,
}

/// A contest with its results.
pub struct ModelScore<'a> {
    pub comparison: &'a Comparison,
    /// Windows that all models predicted: those that count.
    pub counted: usize,
    /// In the order of the entries.
    pub results: Vec<Outcomes>,
}

/// What a model achieved.
pub struct Outcomes {
    /// Windows in which the model failed, and why it did first.
    pub failed: usize,
    pub reason: Option<String>,
    /// On the windows that count.
    pub scores: Option<Scores>,
    errors: Vec<PoseError>,
    blocks: Vec<(usize, i64)>,
}

/// Errors at the end of windows.
pub struct Scores {
    pub position: ErrorSummary,
    pub heading: ErrorSummary,
}

/// What a model achieved on the windows of all recordings.
pub struct Pooled {
    pub name: &'static str,
    pub windows: usize,
    /// Windows of all recordings in which it failed.
    pub failed: usize,
    pub scores: Scores,
}

impl Comparison {
    /// Number of predictions.
    pub fn work(&self) -> u64 {
        (self.halves.judged.len() * self.entries.len()) as u64
    }

    /// Lets every model predict every window that is to be judged; on all cores, with results
    /// that do not depend on how many there are.
    pub fn run(&self, done: impl Fn() + Sync) -> ModelScore<'_> {
        let windows: Vec<&PredictionWindow> = self
            .halves
            .judged
            .iter()
            .map(|k| &self.set.windows[*k])
            .collect();
        let mut predictions = Vec::new();
        let mut reasons = Vec::new();
        for entry in &self.entries {
            let predict = |window: &&PredictionWindow| {
                let predictor = entry.predictor.as_ref()?;
                let predicted = predictor.predict(window);
                done();
                Some(predicted.map(|pose| PoseError::new(window, pose)))
            };
            let all: Vec<_> = windows.par_iter().map(predict).collect();
            let reason = all
                .iter()
                .flatten()
                .find_map(|result| result.as_ref().err());
            reasons.push(reason.map(ToString::to_string));
            predictions.push(
                all.into_iter()
                    .map(|result| result?.ok())
                    .collect::<Vec<_>>(),
            );
        }
        let counting = common(&predictions);
        let blocks: Vec<(usize, i64)> = counting.iter().map(|k| windows[*k].block()).collect();
        let result = |(errors, reason): (Vec<Option<PoseError>>, Option<String>)| {
            let failed = errors.iter().filter(|error| error.is_none()).count();
            let errors: Vec<_> = counting.iter().filter_map(|k| errors[*k]).collect();
            Outcomes {
                failed,
                reason,
                scores: Scores::of(&errors, &blocks),
                errors,
                blocks: blocks.clone(),
            }
        };
        ModelScore {
            comparison: self,
            counted: counting.len(),
            results: predictions
                .into_par_iter()
                .zip(reasons)
                .map(result)
                .collect(),
        }
    }
}

impl Scores {
    fn of<B: Ord + Clone>(errors: &[PoseError], blocks: &[B]) -> Option<Self> {
        let pick = |value: fn(&PoseError) -> f64| {
            let values: Vec<f64> = errors.iter().map(value).collect();
            summarise(&values, blocks.iter().cloned())
        };
        Some(Self {
            position: pick(|error| error.position)?,
            heading: pick(|error| error.heading)?,
        })
    }
}

/// The windows of all recordings taken together, for the models that predicted some of each;
/// `None` for a single recording.
pub fn pool(outcomes: &[ModelScore]) -> Option<Vec<Pooled>> {
    let (first, _) = outcomes
        .split_first()
        .filter(|(_, rest)| !rest.is_empty())?;
    let together = |(index, entry): (usize, &Entry)| {
        let mut errors = Vec::new();
        let mut blocks = Vec::new();
        let mut failed = 0;
        for (recording, outcome) in outcomes.iter().enumerate() {
            let result = outcome.results.get(index)?;
            result.scores.as_ref()?;
            failed += result.failed;
            errors.extend_from_slice(&result.errors);
            blocks.extend(result.blocks.iter().map(|block| (recording, *block)));
        }
        Some(Pooled {
            name: entry.name,
            windows: errors.len(),
            failed,
            scores: Scores::of(&errors, &blocks)?,
        })
    };
    Some(
        first
            .comparison
            .entries
            .iter()
            .enumerate()
            .filter_map(together)
            .collect(),
    )
}
