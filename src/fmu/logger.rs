//! Messages to the importer.

use super::status::Status;
use fmi_sys::fmi2::{fmi2CallbackFunctions, fmi2CallbackLogger};
use fmi_sys::fmi3::{fmi3InstanceEnvironment, fmi3LogMessageCallback};
use std::ffi::{CStr, CString, c_void};

/// The log categories that the model description declares.
pub(super) const CATEGORIES: [&CStr; 5] = [
    c"logStatusFatal",
    c"logStatusError",
    c"logStatusWarning",
    c"logStatusDiscard",
    c"logEvents",
];

const FATAL: usize = 0;
const ERROR: usize = 1;
const WARNING: usize = 2;
const DISCARD: usize = 3;
const EVENT: usize = 4;

/// What is reported whatever the importer asks for: to FMI 2.0 warnings as well, to FMI 3.0 what its version 3.0.3 wants.
const ALWAYS_2: [bool; 5] = [true, true, true, false, false];
const ALWAYS_3: [bool; 5] = [true, true, false, false, false];

/// The importer's function, in the form of its version of the standard.
enum Callback {
    Fmi2 {
        log: fmi2CallbackLogger,
        instance_name: CString,
    },
    Fmi3 {
        log: fmi3LogMessageCallback,
    },
}

/// Whom to tell, and about what.
pub(super) struct Logger {
    callback: Callback,
    environment: *mut c_void,
    /// Which of [`CATEGORIES`] to report.
    enabled: [bool; 5],
}

impl Logger {
    /// The logger of FMI 2.0; `verbose` switches what is not always reported.
    pub(super) fn fmi2(
        functions: Option<&fmi2CallbackFunctions>,
        name: &CStr,
        verbose: bool,
    ) -> Self {
        Self {
            callback: Callback::Fmi2 {
                log: functions.and_then(|f| f.logger),
                instance_name: name.to_owned(),
            },
            environment: functions.map_or(std::ptr::null_mut(), |f| f.componentEnvironment),
            enabled: ALWAYS_2.map(|always| always || verbose),
        }
    }

    /// The logger of FMI 3.0; `on` switches what is not always reported.
    pub(super) fn fmi3(
        log: fmi3LogMessageCallback,
        environment: fmi3InstanceEnvironment,
        on: bool,
    ) -> Self {
        Self {
            callback: Callback::Fmi3 { log },
            environment,
            enabled: ALWAYS_3.map(|always| always || on),
        }
    }

    /// Chooses what to report beside what always is: all categories where none is named.
    pub(super) fn choose(&mut self, on: bool, named: [bool; 5]) {
        let always = match self.callback {
            Callback::Fmi2 { .. } => ALWAYS_2,
            Callback::Fmi3 { .. } => ALWAYS_3,
        };
        let all = !named.contains(&true);
        self.enabled = std::array::from_fn(|k| always[k] || on && (all || named[k]));
    }

    /// Something that makes the importer's call fail.
    pub(super) fn error(&self, message: &str) {
        self.report(Status::Error, ERROR, message);
    }

    /// The end of the instance.
    pub(super) fn fatal(&self, message: &str) {
        self.report(Status::Fatal, FATAL, message);
    }

    /// Something that the user should know.
    pub(super) fn warning(&self, message: &str) {
        self.report(Status::Warning, WARNING, message);
    }

    /// What is not to be had, such as a trial of the importer's solver that cannot be computed: there may be
    /// many, so that only who asked is told.
    pub(super) fn discard(&self, message: &str) {
        self.report(Status::Discard, DISCARD, message);
    }

    /// Something for the curious.
    pub(super) fn event(&self, message: &str) {
        self.report(Status::Ok, EVENT, message);
    }

    fn report(&self, status: Status, category: usize, message: &str) {
        if self.enabled[category] {
            self.send(status, CATEGORIES[category], message);
        }
    }

    fn send(&self, status: Status, category: &CStr, message: &str) {
        // To both versions #...# stands for a variable, to FMI 2.0 a message is a printf format as well.
        let mut clean = message.replace(['#', '\0'], " ");
        if matches!(self.callback, Callback::Fmi2 { .. }) {
            clean = clean.replace('%', " percent");
        }
        let Ok(text) = CString::new(clean) else {
            return;
        };
        match &self.callback {
            Callback::Fmi2 {
                log: Some(log),
                instance_name,
            } => {
                // SAFETY: the importer's function, called as the standard says: the environment it
                // gave, three strings that end in zero and live through the call, and a format
                // without any specifier, so that no further argument is read.
                unsafe {
                    log(
                        self.environment,
                        instance_name.as_ptr(),
                        status.code(),
                        category.as_ptr(),
                        text.as_ptr(),
                    );
                }
            }
            Callback::Fmi3 { log: Some(log) } => {
                // SAFETY: as above, with two strings and no format.
                unsafe {
                    log(
                        self.environment,
                        status.code(),
                        category.as_ptr(),
                        text.as_ptr(),
                    );
                }
            }
            _ => {}
        }
    }
}
