//! What a reader of the verdict has to know before acting on it.

use crate::vehicle::Vehicle;

/// Something that limits what the verdict is worth.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Caution {
    /// The time limit ended the work early.
    TimeUp,
    /// The time limit allowed a part of the recordings only \[s\].
    Part {
        /// Seconds of driving that were used.
        used: f64,
        /// Seconds of driving that there are.
        of: f64,
    },
    /// There was no time to compare the models on data that they were not fitted to.
    NotHeldOut,
    /// Nobody named a vehicle: this one was assumed.
    AssumedVehicle {
        /// Its mass \[kg\].
        mass: f64,
        /// How many wheels it has.
        wheels: usize,
    },
}

impl Caution {
    /// That a vehicle was assumed.
    #[must_use]
    pub fn assumed(vehicle: &Vehicle) -> Self {
        Self::AssumedVehicle {
            mass: vehicle.mass,
            wheels: vehicle.wheel_count(),
        }
    }

    /// The name in `diagnosis.json`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::TimeUp => "time_up",
            Self::Part { .. } => "part_of_recordings",
            Self::NotHeldOut => "not_held_out",
            Self::AssumedVehicle { .. } => "assumed_vehicle",
        }
    }

    /// In words: what happened, and what to do.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::TimeUp => "Time was up before everything had been tried. More may be missing than was found, and \
                             probabilities compare only what had been fitted by then. Give it more time (--within)."
                .into(),
            Self::Part { used, of } => format!(
                "Time allowed only {:.0} % of the driving: {used:.0} s of {of:.0} s, in stretches spread evenly. What acts \
                 for some seconds may lie between them.",
                100.0 * used / of
            ),
            Self::NotHeldOut => {
                "There was no time to compare the models on data that they were not fitted to.".into()
            }
            Self::AssumedVehicle { mass, wheels } => format!(
                "No vehicle was named: the paper's was assumed, {mass:.0} kg on {wheels} wheels. The verdict is about that \
                 vehicle. Name yours (--vehicle)."
            ),
        }
    }
}
