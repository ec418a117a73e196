//! Intervals that hold what they promise.

use super::synthetic::{QUIET, Sensors, fitted, nominal, plain, record, truths};

const FREE: [&str; 3] = ["cohesion", "friction_angle", "shear_modulus"];
const SEEDS: u64 = 20;

#[test]
#[ignore = "nightly: twenty fits"]
fn ninety_percent_intervals_hold_the_truth_nine_times_in_ten() {
    let truth = nominal("sandy_loam");
    let (mut held, mut all) = (0, 0);
    let mut by_parameter = [0; 6];
    for seed in 1..=SEEDS {
        let by = Sensors {
            seed,
            pose_latency: 0.2,
            wheel_latency: 0.1,
            yaw_rate_bias: 0.01,
            coloured: [0.02, 0.005, 0.01],
            ..QUIET
        };
        let fit = fitted(&truth, &FREE, &[record(&truth, 40.0, &by)], &plain()).unwrap();
        for (k, (estimate, truth)) in fit
            .estimates
            .iter()
            .zip(truths(&fit, &truth, &by))
            .enumerate()
        {
            let inside = (estimate.low..=estimate.high).contains(&truth);
            held += usize::from(inside);
            by_parameter[k] += usize::from(inside);
            all += 1;
        }
    }
    let share = held as f64 / all as f64;
    println!("{held} of {all}; by parameter {by_parameter:?} of {SEEDS}");
    // 120 intervals, six to a drive and correlated there: a standard deviation of about 4 %.
    assert!((0.80..=0.985).contains(&share), "{share} {by_parameter:?}");
}
