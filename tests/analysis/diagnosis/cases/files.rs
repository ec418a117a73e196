//! A case on disk: what may be seen in a folder, the truth beside it.

use super::world::{Ingredient, Region};
use super::{Case, Recorded, Row};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;
use ugv_terrain::effects::CATALOGUE;
use ugv_terrain::effects::EffectKind;
use ugv_terrain::terrain::Terrain;

/// What marks a file with the truth.
const FORMAT: &str = "ugv-case-truth/1";

/// Writes `NAME/drive.csv`, `NAME/unseen.csv`, perhaps `NAME/drive2.csv`, a JSON beside each, and
/// `NAME.truth.json`.
///
/// # Errors
/// What the file system says.
pub fn write(case: &Case, folder: &Path, name: &str) -> io::Result<()> {
    let own = folder.join(name);
    fs::create_dir_all(&own)?;
    let about = about(case);
    for (file, drive) in case.recordings() {
        fs::write(own.join(format!("{file}.csv")), table(&drive.rows))?;
        fs::write(own.join(format!("{file}.json")), &about)?;
    }
    let truth = format!("{:#}\n", truth(case, name));
    fs::write(folder.join(format!("{name}.truth.json")), truth)
}

impl Case {
    /// All recordings by the names of their files.
    fn recordings(&self) -> impl Iterator<Item = (&'static str, &Recorded)> {
        let names = ["drive", "drive2"].into_iter();
        names.zip(&self.drives).chain([("unseen", &self.unseen)])
    }
}

/// A recording as CSV.
fn table(rows: &[Row]) -> String {
    let has_velocity = rows.iter().any(|row| row.velocity.is_some());
    let mut text = String::from("time,omega_left,omega_right,x,y,heading,");
    text.push_str(if has_velocity {
        "v_x,v_y,yaw_rate\n"
    } else {
        "yaw_rate\n"
    });
    let cell = |value: Option<f64>, digits: usize| {
        value.map_or(String::new(), |value| format!("{value:.digits$}"))
    };
    for row in rows {
        let [left, right] = row.wheels;
        let [x, y] = [0, 1].map(|axis| cell(row.position.map(|p| p[axis]), 5));
        let heading = cell(row.heading, 6);
        let time = row.time;
        write!(text, "{time:.2},{left:.6},{right:.6},{x},{y},{heading},").expect("memory");
        if has_velocity {
            let [ahead, left] = [0, 1].map(|axis| cell(row.velocity.map(|v| v[axis]), 5));
            write!(text, "{ahead},{left},").expect("memory");
        }
        writeln!(text, "{:.6}", row.yaw_rate).expect("memory");
    }
    text
}

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or(Value::Null)
}

fn soil(terrain: &Terrain) -> Value {
    parsed(&terrain.to_json())
}

/// What a user knows.
fn about(case: &Case) -> String {
    let words = case.sensors.words().into_iter();
    let sensors: Map<String, Value> = words
        .map(|(key, text)| (key.to_owned(), text.into()))
        .collect();
    let value = json!({
        "vehicle": parsed(&case.vehicle.to_json()),
        "terrain": soil(&case.ground.nominal),
        "sensors": sensors,
        "source": "simulated",
        "licence": "MIT OR Apache-2.0",
    });
    format!("{value:#}\n")
}

fn truth(case: &Case, name: &str) -> Value {
    let plan = &case.plan;
    // The first of two may have less.
    let fullest = &case.drives[case.drives.len() - 1];
    let effects = fullest.ingredients.iter().chain(&plan.faults);
    let drives = case.recordings().map(|(file, drive)| {
        let where_it_acts = drive
            .ingredients
            .iter()
            .filter(|one| one.region != Region::Always);
        let visits = where_it_acts
            .map(|one| json!({ "effect": one.name, "intervals": drive.track.visits(one.region) }));
        let value = json!({
            "style": drive.style.name(),
            "seconds": drive.track.duration(),
            "top_speed": drive.top_speed,
            "signal": { "raw": drive.signal.raw, "left": drive.signal.left },
            "acts": visits.collect::<Vec<_>>(),
        });
        (file.to_owned(), value)
    });
    let sensors = &case.sensors;
    json!({
        "format": FORMAT,
        "case": name,
        "family": case.family.name(),
        "variant": plan.variant,
        "seed": case.seed,
        "expected": case.expected(),
        "signal_left": case.signal_left(),
        "effects": effects.map(effect).collect::<Vec<_>>(),
        "rivals": plan.rivals,
        "vehicle": case.vehicle_name,
        "ground": case.ground.name,
        "nominal_terrain": soil(&case.ground.nominal),
        "true_terrain": soil(&case.ground.truth),
        "noise": {
            "position_m": sensors.position,
            "heading_rad": sensors.heading,
            "yaw_rate": sensors.yaw_rate,
            "velocity": sensors.velocity,
            "encoder_step": sensors.quantum,
            "drop_outs": sensors.drops,
            "outliers": sensors.outliers,
        },
        "drives": drives.collect::<Map<_, _>>(),
    })
}

fn effect(one: &Ingredient) -> Value {
    let known = CATALOGUE.iter().find(|effect| effect.name == one.name);
    let kind = match known.map(|effect| effect.kind) {
        Some(EffectKind::Physics) => "physics",
        Some(EffectKind::Measurement) => "measurement",
        None => "outside",
    };
    let mut parameters: Map<String, Value> = one
        .parameters
        .iter()
        .map(|(name, value)| {
            let short = name.split_once('.').map_or(name.as_str(), |parts| parts.1);
            (short.to_owned(), (*value).into())
        })
        .collect();
    if let Some(law) = &one.law {
        let own = law.parameters.iter();
        parameters.extend(own.map(|(name, value)| ((*name).to_owned(), (*value).into())));
    }
    let switches = known.map_or(Map::new(), |effect| {
        let on = effect.parameters.iter().filter(|p| p.switches);
        on.filter(|p| parameters.contains_key(p.name))
            .map(|p| (p.name.to_owned(), p.default.into()))
            .collect()
    });
    let region = match one.region {
        Region::Always => json!({ "over": "everywhere" }),
        Region::Time(start, end) => json!({ "over": "time", "start": start, "end": end }),
        Region::Disc([x, y], radius) => {
            json!({ "over": "place", "x": x, "y": y, "radius": radius })
        }
    };
    json!({
        "effect": one.name,
        "kind": kind,
        "size": one.size,
        "parameters": parameters,
        "off": switches,
        "where": region,
    })
}
