//! The macro behind every exported function that acts on an instance.

/// Defines exported functions, each as: name, its type in the standard, row in the table of calls,
/// arguments after the instance, and body. Every function goes through [`super::guard::call`], so
/// that none bypasses the checks for null, call order and panics. The type of each function is
/// checked against the standard's at compile time. The file that uses the macro says what the
/// standard calls an instance (`Handle`) and the result (`Status`).
macro_rules! exports {
    ($(
        $(#[$doc:meta])*
        $function:ident: $type:ident = $call:ident
        ($($argument:tt: $of:ty),* $(,)?) |$instance:pat_param| $body:expr;
    )*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// As the standard requires: a live instance or null, and arrays of the given lengths.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(instance: Handle, $($argument: $of),*) -> Status {
            let call = $crate::fmu::calls::Call::$call;
            // SAFETY: the caller keeps the standard's promises.
            unsafe {
                $crate::fmu::guard::call(instance, call, stringify!($function), |$instance| $body)
            }
        }
        const _: $type = Some($function);
    )*};
}
pub(super) use exports;
