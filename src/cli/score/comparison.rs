//! Models predict the same windows.

use super::models::ComparedModel;
use crate::identification::{
    DataSplit, ErrorSummary, Latencies, PoseError, PredictionWindow, WindowOptions, WindowSet,
    common, summarise,
};
use crate::inspection::Doubt;
use rayon::prelude::*;

/// A recording's windows and the models that predict them.
pub struct ModelComparison {
    pub name: String,
    /// Doubts about its data.
    pub doubts: Vec<Doubt>,
    pub latencies: Latencies,
    /// How the windows are cut.
    pub cut: WindowOptions,
    pub heading_noise: Option<f64>,
    pub set: WindowSet,
    pub halves: DataSplit,
    pub models: Vec<ComparedModel>,
}

/// The results of a comparison.
pub struct ComparisonResult<'a> {
    pub comparison: &'a ModelComparison,
    /// Number of windows that all models predicted: the scores are of these.
    pub counted: usize,
    /// In the order of the models.
    pub results: Vec<ModelResult>,
}

/// The result of a model.
pub struct ModelResult {
    /// Number of windows in which the model failed.
    pub failed: usize,
    /// Why it failed first.
    pub reason: Option<String>,
    pub scores: Option<ModelScores>,
    errors: Vec<PoseError>,
    blocks: Vec<(usize, i64)>,
}

/// Errors at the end of windows.
pub struct ModelScores {
    pub position: ErrorSummary,
    pub heading: ErrorSummary,
}

/// The result of a model on the windows of all recordings.
pub struct PooledResult {
    pub name: &'static str,
    pub windows: usize,
    /// Number of windows in which it failed.
    pub failed: usize,
    pub scores: ModelScores,
}

impl ModelComparison {
    /// Number of predictions.
    pub fn work(&self) -> u64 {
        (self.halves.judged.len() * self.models.len()) as u64
    }

    /// Predicts every judged window with every model on all threads; the results do not depend on their number.
    pub fn run(&self, done: impl Fn() + Sync) -> ComparisonResult<'_> {
        let windows = self.halves.judged.iter();
        let windows: Vec<&PredictionWindow> = windows.map(|k| &self.set.windows[*k]).collect();
        let mut predictions = Vec::new();
        let mut reasons = Vec::new();
        for model in &self.models {
            let predict = |window: &&PredictionWindow| {
                let predictor = model.predictor.as_ref()?;
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
            let errors = all.into_iter().map(|result| result?.ok());
            predictions.push(errors.collect::<Vec<_>>());
        }
        let counted = common(&predictions);
        let blocks: Vec<(usize, i64)> = counted.iter().map(|k| windows[*k].block()).collect();
        let result = |(errors, reason): (Vec<Option<PoseError>>, Option<String>)| {
            let failed = errors.iter().filter(|error| error.is_none()).count();
            let errors: Vec<_> = counted.iter().filter_map(|k| errors[*k]).collect();
            ModelResult {
                failed,
                reason,
                scores: ModelScores::of(&errors, &blocks),
                errors,
                blocks: blocks.clone(),
            }
        };
        let results = predictions.into_par_iter().zip(reasons).map(result);
        ComparisonResult {
            comparison: self,
            counted: counted.len(),
            results: results.collect(),
        }
    }
}

impl ModelScores {
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

/// The results on the windows of all recordings, of the models with predictions of each; `None` for a single recording.
pub fn pool(results: &[ComparisonResult]) -> Option<Vec<PooledResult>> {
    let (first, _) = results.split_first().filter(|(_, rest)| !rest.is_empty())?;
    let pooled = |(index, model): (usize, &ComparedModel)| {
        let mut errors = Vec::new();
        let mut blocks = Vec::new();
        let mut failed = 0;
        for (recording, all) in results.iter().enumerate() {
            let result = all.results.get(index)?;
            result.scores.as_ref()?;
            failed += result.failed;
            errors.extend_from_slice(&result.errors);
            blocks.extend(result.blocks.iter().map(|block| (recording, *block)));
        }
        Some(PooledResult {
            name: model.name,
            windows: errors.len(),
            failed,
            scores: ModelScores::of(&errors, &blocks)?,
        })
    };
    let models = first.comparison.models.iter().enumerate();
    Some(models.filter_map(pooled).collect())
}
