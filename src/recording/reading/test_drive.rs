//! A drive as text, for tests of the reader.

use super::*;
use crate::recording::note::{Note, NoteKind};

/// Columns after the time, in the order of [`NAMES`].
pub type Rows = Vec<(f64, [f64; 6])>;
pub const NAMES: &str = "time,omega_left,omega_right,x,y,heading,yaw_rate";

/// A drive with turns both ways, a pivot and a stretch in reverse, at 20 Hz, the pose late.
pub fn drive(seconds: f64, seed: u64) -> Rows {
    turning(seconds, seed, 0.16)
}

/// The same with another yaw rate by difference of wheel speeds \[-\].
pub fn turning(seconds: f64, seed: u64, by_difference: f64) -> Rows {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut noise = |size: f64| size * (random.f64() - 0.5);
    let (mut x, mut y, mut heading) = (3.0, -2.0, 0.4);
    let phase = (seed % 7) as f64;
    let mut late = std::collections::VecDeque::from(vec![[x, y, heading]; 6]);
    let mut rows = Rows::new();
    for index in 0..(20.0 * seconds) as usize {
        let time = 0.05 * index as f64;
        let turn = 3.0 * (0.7 * time + phase).sin() + 2.0 * (0.31 * time).cos();
        let ahead =
            5.0 + 4.0 * (0.2 * time + phase).sin() - if index % 600 > 450 { 8.0 } else { 0.0 };
        let (left, right) = (ahead - turn, ahead + turn);
        let yaw_rate = by_difference * (right - left);
        heading += 0.05 * yaw_rate;
        let step = 0.05 * 0.145 * (left + right);
        x += step * heading.cos();
        y += step * heading.sin();
        late.push_back([x, y, heading]);
        let pose = late.pop_front().unwrap();
        rows.push((
            time,
            [
                left,
                right,
                pose[0] + noise(0.02),
                pose[1] + noise(0.02),
                pose[2] + noise(0.01),
                yaw_rate + noise(0.02),
            ],
        ));
    }
    rows
}

pub fn text(rows: &Rows) -> String {
    let mut text = format!("{NAMES}\n");
    for (time, values) in rows {
        let cells: Vec<String> = values.iter().map(f64::to_string).collect();
        text += &format!("{time},{}\n", cells.join(","));
    }
    text
}

pub fn read(text: &str) -> Result<Recording, CsvError> {
    let about = About {
        vehicle: Some(crate::vehicle::Vehicle {
            wheel_radius: 0.3,
            ..crate::vehicle::Vehicle::tran2007()
        }),
        ..About::default()
    };
    parse_recording("drive.csv", "drive", text.as_bytes(), about, None, &[])
}

pub fn kinds(notes: &[Note]) -> Vec<NoteKind> {
    notes.iter().map(|note| note.kind).collect()
}

/// Reads, and checks that nothing but this was done and that the drive comes out.
pub fn assert_restored(good: &Rows, bad: &str, kinds: &[(NoteKind, Option<Channel>)]) {
    let recording = read(bad).unwrap();
    let mut found: Vec<_> = recording
        .notes
        .iter()
        .map(|note| (note.kind, note.channel))
        .collect();
    found.sort();
    let mut expected = kinds.to_vec();
    expected.sort();
    assert_eq!(found, expected, "{:#?}", recording.notes);
    for (index, channel) in [
        Channel::OmegaLeft,
        Channel::OmegaRight,
        Channel::X,
        Channel::Y,
        Channel::Heading,
        Channel::YawRate,
    ]
    .into_iter()
    .enumerate()
    {
        let series = recording.runs[0].series(channel).unwrap();
        for (time, values) in good {
            if let Some(value) = series.at(*time) {
                let error = (value - values[index]).abs();
                assert!(
                    error < 0.06,
                    "{channel} at {time}: {value}, not {}",
                    values[index]
                );
            }
        }
        assert!(series.len() as f64 > 0.95 * good.len() as f64);
    }
}

pub fn with(rows: &Rows, change: impl Fn(&mut f64, &mut [f64; 6])) -> String {
    let mut rows = rows.clone();
    for (time, values) in &mut rows {
        change(time, values);
    }
    text(&rows)
}
