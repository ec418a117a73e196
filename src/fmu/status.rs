//! The status that a call returns. Both versions of the standard have the same numbers.

use fmi_sys::fmi2::*;
use fmi_sys::fmi3::*;

/// The result of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Status {
    Ok = fmi2Status_fmi2OK as u8,
    Warning = fmi2Status_fmi2Warning as u8,
    Discard = fmi2Status_fmi2Discard as u8,
    Error = fmi2Status_fmi2Error as u8,
    Fatal = fmi2Status_fmi2Fatal as u8,
}

impl Status {
    /// In the type of a version of the standard.
    pub(super) fn code<S: From<u8>>(self) -> S {
        S::from(self as u8)
    }
}

const _: () = {
    assert!(fmi2Status_fmi2OK == fmi3Status_fmi3OK);
    assert!(fmi2Status_fmi2Warning == fmi3Status_fmi3Warning);
    assert!(fmi2Status_fmi2Discard == fmi3Status_fmi3Discard);
    assert!(fmi2Status_fmi2Error == fmi3Status_fmi3Error);
    assert!(fmi2Status_fmi2Fatal == fmi3Status_fmi3Fatal);
};
