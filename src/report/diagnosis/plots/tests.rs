use super::*;

#[test]
fn the_band_of_what_is_left_over_is_parted_as_its_line_is() {
    let trace = WrenchTrace {
        time: [0.0, 1.0, 2.0, 30.0, 31.0].into(),
        value: vec![[1.0; 3]; 5],
        deviation: vec![[0.5; 3]; 5],
    };
    for chart in wrenches(&trace, &[]) {
        let Some((_, Mark::Band(band))) = chart.marks.last() else {
            panic!("no band")
        };
        let line: Vec<usize> = chart.lines[0].parts.iter().map(Vec::len).collect();
        let band: Vec<usize> = band.iter().map(Vec::len).collect();
        assert_eq!((line, band), (vec![3, 2], vec![3, 2]));
    }
}

#[test]
fn an_outlier_does_not_hide_the_others() {
    let noise: Vec<f64> = (0..200).map(|k| f64::from(k % 7) - 3.0).collect();
    let mut spiked = noise.clone();
    spiked[50] = -400.0;
    spiked[60] = f64::NAN;
    assert_eq!(limit(&[&noise, &noise]), f64::INFINITY);
    assert_eq!(limit(&[&noise, &spiked]), 6.0);
    assert_eq!(limit(&[&vec![0.0; 9]]), f64::INFINITY);
    assert_eq!(limit(&[&Vec::new()]), f64::INFINITY);
    let trace = |before: &Vec<f64>| ResidualTrace {
        channel: "yaw_rate",
        unit: "m",
        time: (0..200).map(f64::from).collect(),
        before: before.clone(),
        after: noise.clone(),
    };
    let chart = residuals(&trace(&spiked), &[], true);
    assert!(
        chart
            .title
            .ends_with("predicted (one sample beyond the axis)")
    );
    let lowest = chart.lines[0].parts.iter().flatten().map(|point| point.1);
    assert_eq!(lowest.fold(f64::INFINITY, f64::min), -6.0);
    // Where something was found to act the signal is shown, an outlier is not.
    let acts = [("where it acts", 45.0, 55.0)];
    let title = |before: &Vec<f64>| residuals(&trace(before), &acts, true).title;
    assert!(title(&spiked).ends_with("predicted (one sample beyond the axis)"));
    spiked[47..54].fill(-400.0);
    assert!(title(&spiked).ends_with("predicted"));
    assert!(
        residuals(&trace(&noise), &[], true)
            .title
            .ends_with("predicted")
    );
}

#[test]
fn a_clock_of_many_digits_is_shown_from_the_runs_start_on() {
    let residual = |start: f64| ResidualTrace {
        channel: "yaw_rate",
        unit: "rad/s",
        time: (0..3).map(|k| start + f64::from(k)).collect(),
        before: vec![1.0; 3],
        after: vec![0.0; 3],
    };
    let run = |start: f64| RunTrace {
        recording: "drive".into(),
        run: 0,
        label: String::new(),
        time: vec![start, start + 2.0],
        path: Vec::new(),
        mismatch: Vec::new(),
        residuals: vec![residual(start)],
        wrench: None,
    };
    assert_eq!(origin(&run(12.5)), 0.0);
    let from = origin(&run(1_700_000_000.25));
    assert_eq!(from, 1_700_000_000.0);
    assert_eq!(
        since(from, &run(1_700_000_000.25).residuals[0].time),
        [0.25, 1.25, 2.25]
    );
}
