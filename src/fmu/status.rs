//! What a call returns. The numbers are the same in both versions of the standard.

use fmi_sys::{fmi2, fmi3};

/// How a call went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Status {
    Ok = 0,
    Warning = 1,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

impl Status {
    /// As the standard's own type.
    pub(super) fn code<S: From<u8>>(self) -> S {
        S::from(self as u8)
    }
}

const _: () = {
    const fn is(status: Status, two: fmi2::fmi2Status, three: fmi3::fmi3Status) -> bool {
        status as u8 as fmi2::fmi2Status == two && status as u8 as fmi3::fmi3Status == three
    }
    assert!(is(
        Status::Ok,
        fmi2::fmi2Status_fmi2OK,
        fmi3::fmi3Status_fmi3OK
    ));
    assert!(is(
        Status::Warning,
        fmi2::fmi2Status_fmi2Warning,
        fmi3::fmi3Status_fmi3Warning
    ));
    assert!(is(
        Status::Discard,
        fmi2::fmi2Status_fmi2Discard,
        fmi3::fmi3Status_fmi3Discard
    ));
    assert!(is(
        Status::Error,
        fmi2::fmi2Status_fmi2Error,
        fmi3::fmi3Status_fmi3Error
    ));
    assert!(is(
        Status::Fatal,
        fmi2::fmi2Status_fmi2Fatal,
        fmi3::fmi3Status_fmi3Fatal
    ));
};
