//! The names of parameters, as arguments.

use crate::cli::Failure;
use crate::cli::output::print;
use std::fmt::Write;
use ugv_terrain::fit::catalogue::{self, DEFAULT_FREE};
use ugv_terrain::fit::sensor::SensorParameter;
use ugv_terrain::vehicle::{ModelParameter, Specification};

/// What is to be fitted.
pub struct Wanted {
    /// Each once.
    pub model: Vec<ModelParameter>,
    pub sensors: Vec<SensorParameter>,
}

impl Wanted {
    pub fn parse(free: &[String], sensors: &[String]) -> Result<Self, Failure> {
        let mut wanted = Self {
            model: Vec::new(),
            sensors: Vec::new(),
        };
        let defaults = DEFAULT_FREE.map(String::from);
        for name in if free.is_empty() { &defaults } else { free } {
            let place = catalogue::find(name).map_err(|error| Failure::Argument {
                reason: format!("--free: {error}"),
                hint: Some(match SensorParameter::parse(name) {
                    Ok(_) => format!("it is a sensor's: --sensors {}", with(sensors, name)),
                    Err(_) => format!("the nearest is {}; --free help lists all", error.nearest),
                }),
            })?;
            if !wanted.model.contains(&place) {
                wanted.model.push(place);
            }
        }
        if sensors == ["none"] {
            return Ok(wanted);
        }
        for name in sensors {
            let sensor = SensorParameter::parse(name).map_err(|nearest| Failure::Argument {
                reason: format!("--sensors: there is no sensor parameter `{name}`"),
                hint: Some(match catalogue::find(name) {
                    Ok(_) => format!(
                        "it is of soil, vehicle or effects: --free {}",
                        with(free, name)
                    ),
                    Err(_) => format!("the nearest is {nearest}; --sensors none fits none"),
                }),
            })?;
            if !wanted.sensors.contains(&sensor) {
                wanted.sensors.push(sensor);
            }
        }
        Ok(wanted)
    }
}

/// Names with one more, as an argument.
fn with(names: &[String], name: &str) -> String {
    let others = names.iter().map(String::as_str);
    let others = others.filter(|other| *other != "none" && *other != name);
    others.chain([name]).collect::<Vec<_>>().join(",")
}

/// All names with their priors.
pub fn print_names(nominal: &Specification) -> Result<(), Failure> {
    let mut text = String::from(
        "--free: soil, vehicle and effects, shared by all recordings (* by default), with 90 % of their prior\n",
    );
    for entry in catalogue::all() {
        let parameter = catalogue::describe(entry, nominal);
        let mark = if DEFAULT_FREE.contains(&parameter.name.as_str()) {
            "*"
        } else {
            " "
        };
        let (low, high) = parameter.prior_interval();
        let range = format!("{low:.3e} .. {high:.3e} {}", parameter.unit);
        let _ = writeln!(text, "{mark} {:30} prior {range}", parameter.name);
    }
    text +=
        "--sensors: each recording's own (* by default; naming some takes the place of these)\n";
    for sensor in SensorParameter::ALL {
        let mark = if SensorParameter::DEFAULT_FREE.contains(&sensor) {
            "*"
        } else {
            " "
        };
        let parameter = sensor.parameter("");
        let (low, high) = parameter.prior_interval();
        let _ = writeln!(
            text,
            "{mark} {:30} prior {low:.3} .. {high:.3} {}",
            sensor.name(),
            parameter.unit
        );
    }
    print(&text)
}
