//! Step 2: how every prediction changes with the soil, the starts and every candidate, in one pass.
//!
//! Forward dual numbers carry the derivatives of the motion by the soil and by every effect while it
//! acts within short gates of time; their sum is the effect that acts throughout. Sensors' effects
//! follow from the motion. The few effects without a derivative while they are off are compared
//! with a drive in which they are on.

use crate::diagnosis::hypothesis::candidate::{Knob, Target, is_law};
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::fit::deadline::Deadline;
use crate::fit::exact::ExactPredictor;
use crate::fit::observation::{Residuals, observe, observe_gated};
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Tables;
use crate::fit::segment::Segment;
use crate::fit::sensor::{SensorParameter, SensorValues};
use crate::simulation::State;
use crate::vehicle::{Parameter, Specification};
use rayon::prelude::*;

/// Length of a gate \[s\], about.
const GATE: f64 = 0.5;

/// Which columns there are, the same for all segments: soil and knobs; and, gate by gate, the gated
/// ones: the soil, and of the knobs those with a derivative.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Number of the soil's columns.
    pub soil: usize,
    /// Number of knobs.
    pub knobs: usize,
    /// The knobs that are gated.
    pub gated: Vec<usize>,
    /// Knobs of the model that act throughout only: laws, and effects that are on and remember.
    throughout: Vec<usize>,
    /// Knobs that are compared with a drive in which they are on.
    secants: Vec<usize>,
    /// Length of a gate \[s\], about.
    gate: f64,
}

/// Residuals of a segment with derivatives by everything.
#[derive(Debug, Clone)]
pub struct SegmentTable {
    /// Rows of the residual, and derivatives by the start, the soil and the knobs, by channel.
    pub whole: Tables,
    /// Derivatives by the gated columns, gate by gate, for the same rows.
    pub gated: Vec<Vec<f64>>,
    /// Where gates begin and end \[s\], one more than there are gates.
    pub edges: Vec<f64>,
}

const START: usize = State::COUNT;
const SENSORS: usize = SensorParameter::ALL.len();

impl Layout {
    /// The columns where these knobs are on.
    #[must_use]
    pub fn new(given: &Given, on: &[usize]) -> Self {
        let knobs = &given.candidates.knobs;
        let mut layout = Self {
            soil: given.soil.len(),
            knobs: knobs.len(),
            gated: Vec::new(),
            throughout: Vec::new(),
            secants: Vec::new(),
            gate: GATE,
        };
        for (place, knob) in knobs.iter().enumerate() {
            if !matches!(knob.target, Target::Model(_)) {
                continue;
            }
            if is_law(knob.effect) && knob.name != "constant" {
                layout.throughout.push(place);
            } else if knob.secant.is_none() {
                layout.gated.push(place);
            } else if on.contains(&place) {
                layout.throughout.push(place);
            } else {
                layout.secants.push(place);
            }
        }
        layout
    }

    /// The columns of some knobs that are off, a single gate in each segment: what acts throughout,
    /// at a fraction of the cost. Other knobs' columns, but for the sensors', are zero.
    #[must_use]
    pub fn ungated(given: &Given, knobs: &[usize]) -> Self {
        let mut layout = Self::new(given, &[]);
        let lists = [
            &mut layout.gated,
            &mut layout.throughout,
            &mut layout.secants,
        ];
        for list in lists {
            list.retain(|knob| knobs.contains(knob));
        }
        layout.gate = f64::INFINITY;
        layout
    }

    /// Number of whole columns, the residual and the start not counted.
    #[must_use]
    pub fn whole(&self) -> usize {
        self.soil + self.knobs
    }

    /// Number of gated columns of one gate.
    #[must_use]
    pub fn per_gate(&self) -> usize {
        self.soil + self.gated.len()
    }
}

/// All segments, computed side by side; `None` where the model cannot drive.
#[must_use]
pub fn sensitivities(given: &Given, layout: &Layout, at: &Solution) -> Vec<Option<SegmentTable>> {
    let models: Vec<Option<RecordingModel>> = (0..given.recordings.len())
        .map(|recording| RecordingModel::new(given, layout, at, recording).ok())
        .collect();
    let one = |(segment, start): (&Segment, &[f64; 6])| {
        let model = models[segment.recording].as_ref()?;
        model.table(given, layout, segment, start).ok()
    };
    given.segments.par_iter().zip(&at.starts).map(one).collect()
}

/// The models of a recording.
struct RecordingModel<'a> {
    predictor: ExactPredictor<'a>,
    secants: Vec<Option<Secant<'a>>>,
    sensors: SensorValues,
    /// Derivatives of values by coordinates: soil, then knobs.
    slopes: Vec<f64>,
    throughout: Vec<f64>,
}

/// A model in which an effect is on, and how far that is in its coordinate.
struct Secant<'a> {
    knob: usize,
    predictor: ExactPredictor<'a>,
    step: f64,
}

impl<'a> RecordingModel<'a> {
    fn new(
        given: &Given<'a>,
        layout: &Layout,
        at: &Solution,
        recording: usize,
    ) -> Result<Self, crate::parameter::ParameterError> {
        let here = given.specification(at, recording)?;
        let parameter = |place: &usize| match given.candidates.knobs[*place].target {
            Target::Model(parameter) => Some(parameter),
            Target::Sensor(_) => None,
        };
        let throughout: Vec<Parameter> = layout.throughout.iter().filter_map(parameter).collect();
        let gated = layout.gated.iter().filter_map(parameter);
        let gated = given.soil.iter().copied().chain(gated).collect();
        let coordinates = &at.knobs[recording];
        let secant = |place: &usize| {
            let knob = &given.candidates.knobs[*place];
            secant(knob, *place, &here, coordinates[*place], given.deadline)
        };
        let mut sensors = [0.0; SENSORS];
        for (knob, coordinate) in given.candidates.knobs.iter().zip(coordinates) {
            if let Target::Sensor(sensor) = knob.target {
                sensors[sensor.index()] = *coordinate;
            }
        }
        let soil = given.soil_parameters();
        let soil = soil.iter().zip(&at.soil);
        let knobs = given.candidates.knobs.iter().map(|knob| &knob.parameter);
        let all = soil.chain(knobs.zip(coordinates));
        Ok(Self {
            secants: layout.secants.iter().map(secant).collect(),
            sensors,
            slopes: all.map(|(p, at)| p.slope(p.value(*at))).collect(),
            throughout: throughout.iter().map(|p| p.get(&here)).collect(),
            predictor: ExactPredictor::new(here, throughout)
                .with_gated(gated)
                .with_coarse_derivatives()
                .with_tolerance(given.tolerance)
                .with_deadline(given.deadline),
        })
    }

    fn table(
        &self,
        given: &Given,
        layout: &Layout,
        segment: &Segment,
        start: &[f64; 6],
    ) -> Result<SegmentTable, PredictionError> {
        let length = segment.end - segment.start;
        let gates = (length / layout.gate).round().max(1.0) as usize;
        let edge = |k: usize| segment.start + length * k as f64 / gates as f64;
        let edges: Vec<f64> = (0..=gates).map(edge).collect();
        let observed = observe_gated(
            &self.predictor,
            segment,
            start,
            &self.throughout,
            &self.sensors,
            true,
            &edges[1..gates],
        )?;
        let none = Vec::new();
        let secants = self.secants.iter().map(|secant| {
            let secant = secant.as_ref()?;
            let sensors = &self.sensors;
            let on = observe(&secant.predictor, segment, start, &none, sensors, false);
            Some((secant, on.ok()?))
        });
        let secants: Vec<_> = secants.collect();
        let mut table = SegmentTable {
            whole: Tables {
                channels: Vec::new(),
                columns: 1 + START + layout.whole(),
            },
            gated: Vec::new(),
            edges,
        };
        for (channel, residuals) in observed.iter().enumerate() {
            let (whole, gated) = self.channel(given, layout, residuals, gates, |knob, row| {
                let found = secants.iter().flatten().find(|(s, _)| s.knob == knob);
                // A prediction that grows takes from the residual.
                found.map_or(0.0, |(secant, on)| {
                    (residuals.residual[row] - on[channel].residual[row]) / secant.step
                })
            });
            table.whole.channels.push(whole);
            table.gated.push(gated);
        }
        Ok(table)
    }

    /// Turns values into coordinates and puts columns in their places.
    fn channel(
        &self,
        given: &Given,
        layout: &Layout,
        residuals: &Residuals,
        gates: usize,
        secant: impl Fn(usize, usize) -> f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let (throughout, per_gate) = (layout.throughout.len(), layout.per_gate());
        let width = START + throughout + per_gate * gates + SENSORS;
        let (mut whole, mut gated) = (Vec::new(), Vec::new());
        for (index, row) in residuals.rows.chunks_exact(width).enumerate() {
            let (start, rest) = row.split_at(START);
            let (model, sensors) = rest.split_at(width - START - SENSORS);
            let (model, by_gate) = model.split_at(throughout);
            let first = gated.len();
            for gate in by_gate.chunks_exact(per_gate) {
                let (soil, knobs) = gate.split_at(layout.soil);
                gated.extend(soil.iter().zip(&self.slopes).map(|(s, slope)| s * slope));
                let knobs = knobs.iter().zip(&layout.gated);
                gated.extend(knobs.map(|(k, place)| k * self.slopes[layout.soil + place]));
            }
            let own = &gated[first..];
            let sum = |column: usize| own.iter().skip(column).step_by(per_gate).sum::<f64>();
            whole.push(residuals.residual[index]);
            whole.extend(start);
            whole.extend((0..layout.soil).map(sum));
            for (place, knob) in given.candidates.knobs.iter().enumerate() {
                let slope = self.slopes[layout.soil + place];
                let at = |list: &[usize]| list.iter().position(|other| *other == place);
                whole.push(
                    match (knob.target, at(&layout.gated), at(&layout.throughout)) {
                        (Target::Sensor(sensor), ..) => sensors[sensor.index()],
                        (_, Some(column), _) => sum(layout.soil + column),
                        (_, None, Some(column)) => model[column] * slope,
                        (_, None, None) => secant(place, index),
                    },
                );
            }
        }
        (whole, gated)
    }
}

fn secant<'a>(
    knob: &Knob,
    place: usize,
    here: &Specification,
    at: f64,
    deadline: Deadline<'a>,
) -> Option<Secant<'a>> {
    let Target::Model(parameter) = knob.target else {
        return None;
    };
    let value = knob.secant?;
    let mut on = here.clone();
    parameter.set(&mut on, value).ok()?;
    Some(Secant {
        knob: place,
        predictor: ExactPredictor::new(on, Vec::new()).with_deadline(deadline),
        step: knob.parameter.coordinate(value) - at,
    })
}
