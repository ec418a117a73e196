//! The names of parameters, as arguments.

use crate::cli::failure::Failure;
use crate::cli::output::print;
use crate::fit::catalogue::{self, DEFAULT_FREE};
use crate::fit::sensor::SensorParameter;
use crate::vehicle::{ModelParameter, Specification};
use std::fmt::Write;

/// The parameters to fit, each once.
pub struct FreeNames {
    pub model: Vec<ModelParameter>,
    pub sensors: Vec<SensorParameter>,
}

impl FreeNames {
    pub fn parse(free: &[String], sensors: &[String]) -> Result<Self, Failure> {
        let mut names = Self {
            model: Vec::new(),
            sensors: Vec::new(),
        };
        let defaults = DEFAULT_FREE.map(String::from);
        for name in if free.is_empty() { &defaults } else { free } {
            let parameter = catalogue::find(name).map_err(|error| {
                let remedy = match SensorParameter::parse(name) {
                    Ok(_) => format!(
                        "it is a sensor parameter: --sensors {}",
                        with(sensors, name)
                    ),
                    Err(_) => format!("the nearest is {}; --free help lists all", error.nearest),
                };
                Failure::argument(format!("--free: {error}")).with_remedy(remedy)
            })?;
            if !names.model.contains(&parameter) {
                names.model.push(parameter);
            }
        }
        if sensors == ["none"] {
            return Ok(names);
        }
        for name in sensors {
            let sensor = SensorParameter::parse(name).map_err(|nearest| {
                let remedy = match catalogue::find(name) {
                    Ok(_) => format!(
                        "it is a parameter of soil, vehicle or effects: --free {}",
                        with(free, name)
                    ),
                    Err(_) => format!("the nearest is {nearest}; --sensors none fits none"),
                };
                let reason = format!("--sensors: there is no sensor parameter `{name}`");
                Failure::argument(reason).with_remedy(remedy)
            })?;
            if !names.sensors.contains(&sensor) {
                names.sensors.push(sensor);
            }
        }
        Ok(names)
    }
}

/// An argument with one more name.
fn with(names: &[String], name: &str) -> String {
    let others = names.iter().map(String::as_str);
    let others = others.filter(|other| *other != "none" && *other != name);
    others.chain([name]).collect::<Vec<_>>().join(",")
}

/// All names with their priors.
pub fn print_names(nominal: &Specification) -> Result<(), Failure> {
    let mark = |is_default: bool| if is_default { "*" } else { " " };
    let mut text = String::from(
        "--free: soil, vehicle and effects, shared by all recordings (*: default), with 90 % interval of the prior\n",
    );
    for entry in catalogue::all() {
        let parameter = catalogue::describe(entry, nominal);
        let mark = mark(DEFAULT_FREE.contains(&parameter.name.as_str()));
        let (low, high) = parameter.prior_interval();
        let range = format!("{low:.3e} .. {high:.3e} {}", parameter.unit);
        let _ = writeln!(text, "{mark} {:30} prior {range}", parameter.name);
    }
    text += "--sensors: for each recording (*: default, unless others are named)\n";
    for sensor in SensorParameter::ALL {
        let parameter = sensor.parameter("");
        let mark = mark(SensorParameter::DEFAULT_FREE.contains(&sensor));
        let (low, high) = parameter.prior_interval();
        let range = format!("{low:.3} .. {high:.3} {}", parameter.unit);
        let _ = writeln!(text, "{mark} {:30} prior {range}", sensor.name());
    }
    print(&text)
}
