//! Vehicles, terrains, effects, whole models, what stands beside a recording, and the FMU's resources
//! as JSON: what is read can be written, and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::fmt::Debug;
use ugv_terrain::declaration::Configuration;
use ugv_terrain::effects::Effects;
use ugv_terrain::json::JsonError;
use ugv_terrain::recording::About;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle, VehicleModel};

/// The files of an FMU's resources.
const RESOURCES: [&str; 4] = [
    "vehicle.json",
    "terrains.json",
    "terrain.json",
    "effects.json",
];

fn again<T: Debug>(
    text: &str,
    read: impl Fn(&str) -> Result<T, JsonError>,
    write: impl Fn(&T) -> String,
) -> Option<T> {
    let value = read(text).ok()?;
    let written = write(&value);
    if let Err(error) = read(&written) {
        panic!("{error}: {value:?} was written as {written}");
    }
    Some(value)
}

fuzz_target!(|text: &str| {
    again(text, Vehicle::from_json, Vehicle::to_json);
    again(text, Terrain::from_json, Terrain::to_json);
    again(text, Effects::from_json, Effects::to_json);
    let model = again(text, Specification::from_json, Specification::to_json);
    if let Some(model) = model {
        let _ = VehicleModel::from_specification(&model);
    }
    let _ = Terrain::presets_from_json(text);
    let _ = About::from_json(text);
    for named in RESOURCES {
        let read = |file: &str| Ok((file == named).then(|| text.to_owned()));
        if let Ok(configuration) = Configuration::from_resources(read) {
            let files = configuration.to_resources();
            let read = |file: &str| {
                let found = files.iter().find(|(name, _)| *name == file);
                Ok(found.map(|(_, text)| text.clone()))
            };
            let same = Configuration::from_resources(read);
            assert!(same.is_ok(), "{same:?} from {files:?}");
        }
    }
});
