//! What sensors report, differentiated.

use super::differences::DifferencePredictor;
use super::synthetic::{QUIET, nominal, record};
use ugv_terrain::fit::catalogue::find;
use ugv_terrain::fit::exact::ExactPredictor;
use ugv_terrain::fit::observation::{columns, observe};
use ugv_terrain::fit::segment::cut;
use ugv_terrain::fit::sensor::SensorValues;
use ugv_terrain::fit::signal::Signal;

/// Root mean square relative to the column's: differences of simulations whose steps adapt at a
/// tolerance of 1e-4, over steps of 0.01 (parameters: 5 %).
///
/// The variational equation is integrated in the steps that the motion asks for, and errs by some
/// per cent in what decays within a few of them: the velocities at the start, and above all the
/// cohesion, which acts in transients. (In steps of 5 ms it does not: tests/effects.)
const TOLERANCE: f64 = 0.05;
const COHESION_TOLERANCE: f64 = 0.08;
const COHESION: usize = 6;
/// The soil's columns. In those of the start and of the sensors, the slope below which moving the start
/// or the times of the samples (and with them the integrator's steps) shows more than the slope itself.
const SOIL: std::ops::Range<usize> = 6..8;
const LEAST_SLOPE: f64 = 0.1;

#[test]
fn rows_are_the_slopes_of_the_residuals() {
    let truth = nominal("sandy_loam");
    let free = vec![find("cohesion").unwrap(), find("shear_modulus").unwrap()];
    let values: Vec<f64> = free.iter().map(|p| p.get(&truth)).collect();
    let exact = ExactPredictor::new(truth.clone(), free.clone());
    let differences = DifferencePredictor::new(truth.clone(), free);
    let sensors: SensorValues = [0.013, 0.017, 0.01, 0.3, -0.2, 0.05];
    let segments = cut(&[record(&truth, 20.0, &QUIET)], &[sensors], 5.0).segments;
    let segment = &segments[1];
    let start = segment.start_prior;
    let look = |start: &[f64; 6], values: &[f64], sensors: &SensorValues| {
        observe(&exact, segment, start, values, sensors, true).unwrap()
    };
    let rows = look(&start, &values, &sensors);
    let width = columns(values.len());
    let check = observe(&differences, segment, &start, &values, &sensors, true).unwrap();
    for (channel, check) in rows.iter().zip(&check) {
        for column in 0..width {
            let pick = |rows: &[f64]| -> Vec<f64> {
                rows.iter().skip(column).step_by(width).copied().collect()
            };
            let (exact, check) = (pick(&channel.rows), pick(&check.rows));
            let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let off: Vec<f64> = exact.iter().zip(&check).map(|(a, b)| a - b).collect();
            let largest = norm(&exact).max(1e-9);
            let tolerance = if column == COHESION {
                COHESION_TOLERANCE
            } else {
                TOLERANCE
            };
            assert!(
                norm(&off) < tolerance * largest,
                "column {column}: {}",
                norm(&off) / largest
            );
        }
    }
    for column in 0..width {
        let shifted = |sign: f64| {
            let (mut start, mut values, mut sensors) = (start, values.clone(), sensors);
            let step = match column {
                0..6 => 0.01,
                // The cohesion moves so little that the integrator's tolerance shows in less.
                6 | 7 => 0.05 * values[column - 6],
                _ => 0.004,
            };
            match column {
                0..6 => start[column] += sign * step,
                6 | 7 => values[column - 6] += sign * step,
                _ => sensors[column - 8] += sign * step,
            }
            (look(&start, &values, &sensors), step)
        };
        let ((above, step), (below, _)) = (shifted(1.0), shifted(-1.0));
        for (channel, samples) in segment.samples.iter().enumerate() {
            // Relative to the largest slope in the column: some samples see none at all.
            let slope = |k: usize| rows[channel].rows[k * width + column];
            let largest = (0..samples.time.len()).map(|k| slope(k).abs()).fold(
                if SOIL.contains(&column) {
                    1e-9
                } else {
                    LEAST_SLOPE
                },
                f64::max,
            );
            let mut off = 0.0;
            for k in 0..samples.time.len() {
                let difference =
                    (below[channel].residual[k] - above[channel].residual[k]) / (2.0 * step);
                off += ((difference - slope(k)) / largest).powi(2);
            }
            let rms = (off / samples.time.len() as f64).sqrt();
            // Where wheel speeds bend, the slope by a latency jumps.
            let bends = column >= 8 && samples.signal == Signal::YawRate;
            let tolerance = match column {
                COHESION => COHESION_TOLERANCE,
                _ if bends => 4.0 * TOLERANCE,
                _ => TOLERANCE,
            };
            assert!(
                rms < tolerance,
                "column {column} {:?}: {rms}",
                samples.signal
            );
        }
    }
}
