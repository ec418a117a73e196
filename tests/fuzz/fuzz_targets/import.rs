//! MCAP files, ROS 1 bags and logs of PX4: what is imported has a table of finite numbers, which is a recording again
//! or is refused in words. The first byte chooses what the user asks for.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::fs;
use ugv_terrain::import::{Clock, HeadingChoice, ImportOptions, PoseChoice, import, survey};
use ugv_terrain::recording::read_recording;
use ugv_terrain_fuzz::scratch;

fuzz_target!(|data: &[u8]| {
    let Some((wishes, data)) = data.split_first() else {
        return;
    };
    let path = scratch("log");
    fs::write(&path, data).unwrap();
    let Ok(surveyed) = survey(&path, &mut |_, _| {}) else {
        return;
    };
    let bit = |place: u8| wishes & (1 << place) != 0;
    let options = ImportOptions {
        partial: bit(0),
        clock: if bit(1) { Clock::Log } else { Clock::default() },
        imu_z_down: bit(2),
        invert: [bit(3), bit(4)],
        pose: bit(5).then_some(if bit(6) {
            PoseChoice::Fix
        } else {
            PoseChoice::Odometry
        }),
        heading: bit(7).then_some(if bit(6) {
            HeadingChoice::Imu
        } else {
            HeadingChoice::Without
        }),
        ..ImportOptions::default()
    };
    let Ok(imported) = import(&path, &surveyed, &options, &mut |_, _| {}) else {
        return;
    };
    for column in &imported.columns {
        assert!(
            column.samples.iter().all(|(_, value)| value.is_finite()),
            "{}",
            column.name
        );
    }
    let mut csv = Vec::new();
    imported.write_csv(&mut csv).unwrap();
    let _ = imported.provenance(&path, &surveyed);
    assert!(imported.seconds().is_finite());
    let table = scratch("csv");
    fs::write(&table, csv).unwrap();
    let _ = read_recording(&table);
});
