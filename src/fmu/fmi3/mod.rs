//! The functions of FMI 3.0. Each is checked against the standard's type at compile time.
#![allow(
    non_snake_case,
    non_upper_case_globals,
    reason = "the standard's names"
)]
#![allow(clippy::too_many_arguments, reason = "the standard's signatures")]

mod clocks;
mod co_simulation;
mod common;
mod derivatives;
mod model_exchange;
mod states;
mod values;

/// Defines exported functions that act on an instance, each as: name, type in the standard, row in the
/// table of calls, arguments after the instance, and what it does. There is no other way to define
/// one, so that none escapes the guard. All of them need what the standard promises: an instance
/// that is live or null, and pointers that are null or to as many values as is said.
macro_rules! exports {
    ($(
        $(#[$doc:meta])*
        $function:ident: $type:ident = $call:ident
        ($($argument:ident: $of:ty),* $(,)?) |$instance:pat_param| $body:expr;
    )*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// As the standard says: a live instance or null, and arrays of the given lengths.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(
            instance: fmi_sys::fmi3::fmi3Instance,
            $($argument: $of),*
        ) -> fmi_sys::fmi3::fmi3Status {
            let call = $crate::fmu::calls::Call::$call;
            // SAFETY: the caller keeps the standard's promises.
            unsafe {
                $crate::fmu::guard::call(instance, call, stringify!($function), |$instance| $body)
            }
        }
        const _: fmi_sys::fmi3::$type = Some($function);
    )*};
}
use exports;
