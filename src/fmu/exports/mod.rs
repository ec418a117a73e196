//! The 44 functions of FMI 2.0. Each is checked against the standard's type at compile time.
#![allow(
    non_snake_case,
    non_upper_case_globals,
    reason = "the standard's names"
)]
#![allow(clippy::too_many_arguments, reason = "the standard's signatures")]

mod co_simulation;
mod common;
mod model_exchange;
mod states;
mod values;

/// Checks at compile time that an exported function has the standard's type.
macro_rules! conforms {
    ($($type:ident = $function:ident;)*) => {
        $(const _: fmi_sys::fmi2::$type = Some($function);)*
    };
}
use conforms;
