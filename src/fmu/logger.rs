//! Messages to the importer.

use super::status::Status;
use fmi_sys::fmi2::{fmi2CallbackFunctions, fmi2CallbackLogger};
use fmi_sys::fmi3::{fmi3InstanceEnvironment, fmi3LogMessageCallback};
use std::ffi::{CStr, CString, c_void};

/// The log categories that the model description declares, worst first.
pub(super) const CATEGORIES: [&CStr; 3] = [c"logStatusError", c"logStatusWarning", c"logEvents"];

const ERROR: usize = 0;
const WARNING: usize = 1;
const EVENT: usize = 2;

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
    enabled: [bool; 3],
}

impl Logger {
    /// The logger of FMI 2.0: `verbose` switches the events; errors and warnings are always reported.
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
            enabled: [true, true, verbose],
        }
    }

    /// The logger of FMI 3.0, which wants nothing reported unless it is `on`.
    pub(super) fn fmi3(
        log: fmi3LogMessageCallback,
        environment: fmi3InstanceEnvironment,
        on: bool,
    ) -> Self {
        Self {
            callback: Callback::Fmi3 { log },
            environment,
            enabled: [on; 3],
        }
    }

    /// Chooses what to report: all categories where none is named. To FMI 2.0 only the events can
    /// be switched: on where they are named, or no other is.
    pub(super) fn choose(&mut self, on: bool, named: [bool; 3]) {
        self.enabled = match self.callback {
            Callback::Fmi2 { .. } => {
                let meant = named == [false; 3] || named[EVENT];
                [true, true, on && meant]
            }
            Callback::Fmi3 { .. } if named == [false; 3] => [on; 3],
            Callback::Fmi3 { .. } => named.map(|named| named && on),
        };
    }

    /// Something that makes the importer's call fail.
    pub(super) fn error(&self, message: &str) {
        self.report(Status::Error, ERROR, message);
    }

    /// Why there is no instance; always reported.
    pub(super) fn refusal(&self, message: &str) {
        self.send(Status::Error, CATEGORIES[ERROR], message);
    }

    /// The end of the instance.
    pub(super) fn fatal(&self, message: &str) {
        self.report(Status::Fatal, ERROR, message);
    }

    /// Something that the user should know.
    pub(super) fn warning(&self, message: &str) {
        self.report(Status::Warning, WARNING, message);
    }

    /// What is not to be had, such as a trial of the importer's solver that cannot be computed: there may be
    /// many, so that only who asked for events is told.
    pub(super) fn discard(&self, message: &str) {
        self.report(Status::Discard, EVENT, message);
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
