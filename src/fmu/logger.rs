//! Messages to the importer.

use super::status::Status;
use crate::declaration::LOG_CATEGORIES;
use fmi_sys::fmi2::{fmi2CallbackFunctions, fmi2CallbackLogger};
use fmi_sys::fmi3::{fmi3InstanceEnvironment, fmi3LogMessageCallback};
use std::ffi::{CStr, CString, c_void};

/// A choice of log categories.
pub(super) type Categories = [bool; LOG_CATEGORIES.len()];

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

/// The importer's log, and the categories that it gets.
pub(super) struct Logger {
    callback: Callback,
    environment: *mut c_void,
    enabled: Categories,
}

impl Callback {
    /// The categories that the version of the standard always reports.
    fn always(&self) -> Categories {
        LOG_CATEGORIES.each_ref().map(|category| match self {
            Self::Fmi2 { .. } => category.always_in_fmi2,
            Self::Fmi3 { .. } => category.always_in_fmi3,
        })
    }
}

impl Logger {
    /// The logger of FMI 2.0; `verbose` adds the categories that are not always reported.
    pub(super) fn fmi2(
        functions: Option<&fmi2CallbackFunctions>,
        name: &CStr,
        verbose: bool,
    ) -> Self {
        let callback = Callback::Fmi2 {
            log: functions.and_then(|f| f.logger),
            instance_name: name.to_owned(),
        };
        let environment = functions.map_or(std::ptr::null_mut(), |f| f.componentEnvironment);
        Self::new(callback, environment, verbose)
    }

    /// The logger of FMI 3.0; `on` adds the categories that are not always reported.
    pub(super) fn fmi3(
        log: fmi3LogMessageCallback,
        environment: fmi3InstanceEnvironment,
        on: bool,
    ) -> Self {
        Self::new(Callback::Fmi3 { log }, environment, on)
    }

    fn new(callback: Callback, environment: *mut c_void, all: bool) -> Self {
        Self {
            enabled: callback.always().map(|always| always || all),
            callback,
            environment,
        }
    }

    /// Chooses the categories to report besides those that always are: all where none is named.
    pub(super) fn choose(&mut self, on: bool, named: Categories) {
        let always = self.callback.always();
        let all = !named.contains(&true);
        self.enabled = std::array::from_fn(|k| always[k] || on && (all || named[k]));
    }

    /// Reports a message, the category of which follows from the status: statistics have `Ok`.
    pub(super) fn report(&self, status: Status, message: &str) {
        let category = match status {
            Status::Fatal => 0,
            Status::Error => 1,
            Status::Warning => 2,
            Status::Discard => 3,
            Status::Ok => 4,
        };
        if self.enabled[category] {
            self.send(status, LOG_CATEGORIES[category].name, message);
        }
    }

    fn send(&self, status: Status, category: &CStr, message: &str) {
        // In both versions #...# stands for a variable. In FMI 2.0 a message is a printf format as well.
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
                // SAFETY: the importer's function, called as the standard requires: the environment it
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
