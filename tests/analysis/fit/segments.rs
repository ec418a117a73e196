//! How recordings are cut.

use ugv_terrain::fit::segment::{Cut, SAME_TIME, cut};
use ugv_terrain::recording::{Channel, Recording, Run, Series};

/// A straight drive at 20 Hz over these times.
fn drive(times: &[f64]) -> Run {
    let of = |value: fn(f64) -> f64| -> Series { times.iter().map(|t| (*t, value(*t))).collect() };
    Run::new("")
        .with(Channel::OmegaLeft, of(|_| 4.0))
        .with(Channel::OmegaRight, of(|_| 4.0))
        .with(Channel::X, of(|t| t))
        .with(Channel::Y, of(|_| 0.0))
        .with(Channel::Heading, of(|_| 0.0))
}

fn seconds(from: f64, count: u32) -> Vec<f64> {
    (0..=20 * count)
        .map(|k| from + f64::from(k) / 20.0)
        .collect()
}

fn cut_into(run: Run, length: f64) -> Cut {
    let recording = Recording {
        name: "drive".into(),
        runs: vec![run],
        ..Recording::default()
    };
    cut(&[recording], &[Default::default()], length)
}

#[test]
fn no_run_is_lost_to_the_rounding_of_its_pieces() {
    let cut = cut_into(drive(&seconds(0.0, 101)), 2.0);
    assert_eq!((cut.segments.len(), cut.unusable), (50, 0.0));
    let shortest = cut.segments.iter().map(|one| one.end - one.start);
    assert!(shortest.fold(f64::INFINITY, f64::min) >= 2.0);
}

#[test]
fn a_clock_that_is_set_parts_a_run() {
    let times = [seconds(0.0, 20), seconds(1.7e9, 20)].concat();
    let cut = cut_into(drive(&times), 5.0);
    assert_eq!(cut.segments.len(), 8);
    assert_eq!(cut.unusable, 0.0);
    let follows = |k: usize| cut.segments[k].follows(&cut.segments[k - 1]);
    let following: Vec<bool> = (1..8).map(follows).collect();
    assert_eq!(following, [true, true, true, false, true, true, true]);
}

#[test]
fn no_segment_reaches_over_wheel_speeds_of_a_side_that_were_lost() {
    let whole = drive(&seconds(0.0, 40));
    let left = whole.series(Channel::OmegaLeft).unwrap();
    let lost = 12.0..19.0;
    let kept = left.samples().filter(|(time, _)| !lost.contains(time));
    let cut = cut_into(whole.clone().with(Channel::OmegaLeft, kept.collect()), 5.0);
    for segment in &cut.segments {
        assert!(
            segment.end < lost.start + SAME_TIME || segment.start > lost.end - SAME_TIME,
            "{} to {}",
            segment.start,
            segment.end
        );
    }
    assert!((cut.unusable - 7.05).abs() < 1e-6, "{}", cut.unusable);
    let driven: f64 = cut.segments.iter().map(|one| one.end - one.start).sum();
    assert!((driven + cut.unusable - 40.0).abs() < 1e-6, "{driven}");
}

#[test]
fn nothing_is_driven_where_one_side_is_lost_for_good() {
    let whole = drive(&seconds(0.0, 40));
    let right = whole.series(Channel::OmegaRight).unwrap().samples();
    let kept = right.filter(|(time, _)| (6.0..=20.0).contains(time));
    let cut = cut_into(whole.clone().with(Channel::OmegaRight, kept.collect()), 5.0);
    let ends: Vec<[f64; 2]> = cut
        .segments
        .iter()
        .map(|one| [one.start, one.end])
        .collect();
    assert_eq!((ends[0][0], ends[ends.len() - 1][1]), (6.0, 20.0));
}

#[test]
fn a_start_in_an_outage_of_the_pose_is_hardly_known() {
    let whole = drive(&seconds(0.0, 20));
    let series = |channel| whole.series(channel).unwrap();
    let late = |channel| -> Series {
        let samples = series(channel).samples();
        samples.filter(|(time, _)| *time >= 4.0).collect()
    };
    let run = [Channel::X, Channel::Y, Channel::Heading]
        .into_iter()
        .fold(whole.clone(), |run, channel| {
            run.with(channel, late(channel))
        });
    let cut = cut_into(run, 5.0);
    let deviations: Vec<f64> = cut
        .segments
        .iter()
        .map(|one| one.start_deviation[0])
        .collect();
    assert_eq!(deviations, [20.0, 5.0, 5.0, 5.0]);
}
