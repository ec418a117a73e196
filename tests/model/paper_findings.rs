//! What the paper reports of its Figs. 3 and 4, on an acceleration followed by a right turn.

use crate::common::{accelerate_then_turn_right, drive, paper_model};
use ugv_terrain::simulation::Simulation;

/// What one drive shows.
struct Drive {
    distance: f64,
    no_slip_distance: f64,
    /// Means over the settled turn, 4.5 s to 6 s.
    rolling_resistance: f64,
    turning_resistance: f64,
    largest_resistance: f64,
    largest_moment: f64,
    /// Mean longitudinal slip of the left (outer) and right (inner) wheels, straight and turning.
    straight_slip: [f64; 2],
    turning_slip: [f64; 2],
    /// Least slip of the inner wheels in the turn.
    least_inner_slip: f64,
}

const STEP: f64 = 0.02;

fn driven(terrain: &str) -> Drive {
    let mut simulation = Simulation::new(paper_model(terrain));
    let table = accelerate_then_turn_right(STEP);
    let mut drive_ = Drive {
        distance: 0.0,
        no_slip_distance: 0.0,
        rolling_resistance: 0.0,
        turning_resistance: 0.0,
        largest_resistance: 0.0,
        largest_moment: 0.0,
        straight_slip: [0.0; 2],
        turning_slip: [0.0; 2],
        least_inner_slip: f64::INFINITY,
    };
    let settled = table.iter().filter(|row| row.0 > 4.5).count() as f64;
    let mut previous = simulation.state();
    drive(&mut simulation, &table, |index, simulation| {
        let (time, left, right) = table[index];
        let state = simulation.state();
        let d = &mut drive_;
        d.distance += (state.x - previous.x).hypot(state.y - previous.y);
        d.no_slip_distance += 0.25 * (left + right) / 2.0 * STEP;
        previous = state;
        let wrench = simulation.wrench().unwrap();
        let moment = wrench.turning_resistance_moment.abs();
        d.largest_resistance = d.largest_resistance.max(wrench.rolling_resistance);
        d.largest_moment = d.largest_moment.max(moment);
        let mean = |side: usize| -> f64 {
            let wheels = wrench.wheels.iter().skip(side).step_by(2);
            wheels.map(|wheel| wheel.longitudinal_slip).sum::<f64>() / 4.0
        };
        if (time - 2.4).abs() < 1e-9 {
            d.straight_slip = [mean(0), mean(1)];
        }
        if time > 2.5 {
            d.least_inner_slip = d.least_inner_slip.min(mean(1));
        }
        if time > 4.5 {
            d.rolling_resistance += wrench.rolling_resistance / settled;
            d.turning_resistance += moment / settled;
            d.turning_slip = [mean(0), mean(1)];
        }
    });
    drive_
}

fn all() -> [Drive; 4] {
    ["dry_clay", "clayed_soil", "sandy_loam", "dry_sand"].map(driven)
}

#[test]
fn rolling_resistance_ranks_the_terrains() {
    let drives = all();
    let resistance: Vec<f64> = drives.iter().map(|d| d.rolling_resistance).collect();
    assert!(resistance.is_sorted(), "{resistance:?}");
    // "Order 10^2 to 10^3 N"; the figure's axis ends at 1000 N, dry clay lies near its foot.
    assert!(
        resistance[0] > 30.0 && resistance[3] < 2000.0,
        "{resistance:?}"
    );
}

#[test]
fn turning_resistance_ranks_the_terrains() {
    let [clay, clayed, loam, sand] = all().map(|d| d.turning_resistance);
    let ranked = [clay, loam, clayed, sand];
    assert!(ranked.is_sorted(), "{ranked:?}");
    // "Up to about 700 N m."
    assert!(sand < 1000.0 && clay > 50.0, "{ranked:?}");
}

#[test]
fn rolling_resistance_grows_slightly_in_the_turn() {
    for drive in all() {
        let growth = drive.largest_resistance / drive.rolling_resistance;
        assert!((1.0..1.2).contains(&growth), "{growth}");
        assert!(drive.largest_moment >= drive.turning_resistance);
    }
}

#[test]
fn every_distance_falls_short_of_the_one_without_slip() {
    for drive in all() {
        assert!(drive.distance < drive.no_slip_distance);
        assert!(drive.distance > 0.5 * drive.no_slip_distance);
    }
}

#[test]
fn inner_slip_shrinks_and_changes_sign_and_outer_slip_grows_most_on_dry_sand() {
    let drives = all();
    let growth: Vec<f64> = drives
        .iter()
        .map(|d| {
            assert!(d.straight_slip[0] > 0.0 && d.straight_slip[1] > 0.0);
            assert!(
                d.turning_slip[1] < d.straight_slip[1],
                "inner wheels: {:?}",
                d.turning_slip
            );
            assert!(
                d.least_inner_slip < 0.0,
                "inner wheels: {}",
                d.least_inner_slip
            );
            assert!(
                d.turning_slip[0] > d.straight_slip[0],
                "outer wheels: {:?}",
                d.turning_slip
            );
            d.turning_slip[0] - d.straight_slip[0]
        })
        .collect();
    assert!(
        growth[..3].iter().all(|other| *other < growth[3]),
        "{growth:?}"
    );
}
