//! Messages to the importer.

use fmi_sys::fmi2::{
    fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status,
    fmi2Status_fmi2Error, fmi2Status_fmi2Fatal, fmi2Status_fmi2OK, fmi2Status_fmi2Warning,
};
use std::ffi::{CStr, CString};

/// The log categories that the model description declares, worst first.
pub(super) const CATEGORIES: [&CStr; 3] = [c"logStatusError", c"logStatusWarning", c"logEvents"];

/// Whom to tell, and about what.
pub(super) struct Logger {
    callback: fmi2CallbackLogger,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
    /// Whether to report what is neither an error nor a warning.
    pub(super) verbose: bool,
}

impl Logger {
    pub(super) fn new(
        functions: Option<&fmi2CallbackFunctions>,
        name: &CStr,
        verbose: bool,
    ) -> Self {
        Self {
            callback: functions.and_then(|f| f.logger),
            environment: functions.map_or(std::ptr::null_mut(), |f| f.componentEnvironment),
            instance_name: name.to_owned(),
            verbose,
        }
    }

    /// Something that makes the importer's call fail; always reported.
    pub(super) fn error(&self, message: &str) {
        self.send(fmi2Status_fmi2Error, CATEGORIES[0], message);
    }

    /// The end of the instance; always reported.
    pub(super) fn fatal(&self, message: &str) {
        self.send(fmi2Status_fmi2Fatal, CATEGORIES[0], message);
    }

    /// Something that the user should know; always reported.
    pub(super) fn warning(&self, message: &str) {
        self.send(fmi2Status_fmi2Warning, CATEGORIES[1], message);
    }

    /// Something for the curious, reported when logging is on.
    pub(super) fn event(&self, message: &str) {
        if self.verbose {
            self.send(fmi2Status_fmi2OK, CATEGORIES[2], message);
        }
    }

    fn send(&self, status: fmi2Status, category: &CStr, message: &str) {
        let Some(callback) = self.callback else {
            return;
        };
        // The message is a printf format to the importer, and some replace #...# as well.
        let clean = message.replace('%', " percent").replace(['#', '\0'], " ");
        let Ok(text) = CString::new(clean) else {
            return;
        };
        // SAFETY: the importer's function, called as the standard says: the environment it
        // gave, three strings that end in zero and live through the call, and a format
        // without any specifier, so that no further argument is read.
        unsafe {
            callback(
                self.environment,
                self.instance_name.as_ptr(),
                status,
                category.as_ptr(),
                text.as_ptr(),
            );
        }
    }
}
