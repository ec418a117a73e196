//! The categories of log messages.

use std::ffi::CStr;

/// A category of log messages.
#[derive(Debug)]
pub struct LogCategory {
    /// Name.
    pub name: &'static CStr,
    /// Meaning.
    pub description: &'static str,
    /// Whether FMI 2.0 reports it even where the importer has logging off.
    pub always_in_fmi2: bool,
    /// The same in FMI 3.0, whose version 3.0.3 excludes warnings.
    pub always_in_fmi3: bool,
}

/// All of them, by falling severity.
pub static LOG_CATEGORIES: [LogCategory; 5] = [
    LogCategory {
        name: c"logStatusFatal",
        description: "Failures that end the instance",
        always_in_fmi2: true,
        always_in_fmi3: true,
    },
    LogCategory {
        name: c"logStatusError",
        description: "Calls that fail, with the reason",
        always_in_fmi2: true,
        always_in_fmi3: true,
    },
    LogCategory {
        name: c"logStatusWarning",
        description: "Conditions to know about, such as a lifted wheel",
        always_in_fmi2: true,
        always_in_fmi3: false,
    },
    LogCategory {
        name: c"logStatusDiscard",
        description: "Unavailable values; in model exchange, states of the solver that cannot be computed",
        always_in_fmi2: false,
        always_in_fmi3: false,
    },
    LogCategory {
        name: c"logEvents",
        description: "Cost of the integration, at the end",
        always_in_fmi2: false,
        always_in_fmi3: false,
    },
];
