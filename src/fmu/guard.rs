//! The checks between C and an instance, through which every function of the interface goes.

use super::calls::{Call, Mode};
use super::instance::{Failure, Instance, Outcome, refuse};
use super::status::Status;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The target of a component handle. The C layout puts the mark first.
#[repr(C)]
pub(super) struct Handle {
    /// Distinguishes a handle from other memory.
    magic: u64,
    instance: Instance,
}

const MAGIC: u64 = u64::from_le_bytes(*b"ugv-inst");

/// Hands an instance to C.
pub(super) fn into_component(instance: Instance) -> *mut c_void {
    let magic = MAGIC;
    Box::into_raw(Box::new(Handle { magic, instance })).cast()
}

/// The handle behind a component; none where the mark is missing.
///
/// # Safety
/// `component` is null or points to eight bytes that can be read; where they are the mark, it came
/// from [`into_component`], has not been freed, and nobody else uses it while the result is.
unsafe fn handle<'a>(component: *mut c_void) -> Option<&'a mut Handle> {
    let handle = component.cast::<Handle>();
    if handle.is_null() || !handle.is_aligned() {
        return None;
    }
    // SAFETY: not null and aligned; by the caller's promise the mark's bytes can be read. A reference to
    // the whole would already claim that an instance follows them.
    let magic = unsafe { (&raw const (*handle).magic).read() };
    // SAFETY: the mark is there, so by the caller's promise this is a live handle.
    (magic == MAGIC).then(|| unsafe { &mut *handle })
}

/// Takes an instance back from C and drops it.
///
/// # Safety
/// `component` is null or came from [`into_component`] and has not been freed.
pub(super) unsafe fn free(component: *mut c_void) {
    // SAFETY: by the caller's promise the pointer is null or a live handle.
    let Some(handle) = (unsafe { handle(component) }) else {
        return;
    };
    handle.magic = 0;
    // Dropping should not panic. If it does, the instance leaks.
    let _ = catch_unwind(|| {
        // SAFETY: the handle was made by Box::into_raw and is not used after this.
        drop(unsafe { Box::from_raw(component.cast::<Handle>()) });
    });
}

/// Calls into an instance: checks the handle and the order of calls, reports failures to
/// the importer's logger, and contains panics, after which the instance is poisoned. The
/// result has the status type of the version of the standard.
///
/// # Safety
/// `component` is null or a handle from [`into_component`] that has not been freed, and no
/// other call with it is under way.
pub(super) unsafe fn call<S: From<u8>>(
    component: *mut c_void,
    call: Call,
    function: &'static str,
    body: impl FnOnce(&mut Instance) -> Outcome,
) -> S {
    // SAFETY: the caller's promise.
    unsafe { checked(component, call, function, body) }.code()
}

/// As [`call`].
///
/// # Safety
/// As [`call`].
unsafe fn checked(
    component: *mut c_void,
    call: Call,
    function: &'static str,
    body: impl FnOnce(&mut Instance) -> Outcome,
) -> Status {
    // SAFETY: by the caller's promise the pointer is null or a live handle.
    let Some(handle) = (unsafe { handle(component) }) else {
        return Status::Error;
    };
    let instance = &mut handle.instance;
    if let Err(message) = call.check(function, instance.core.mode, instance.purpose.interface) {
        instance.logger.report(Status::Error, &message);
        return Status::Error;
    }
    match catch_unwind(AssertUnwindSafe(|| body(instance))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(Failure::Refused(message))) => {
            instance
                .logger
                .report(Status::Error, &format!("{function}: {message}"));
            Status::Error
        }
        Ok(Err(Failure::Broken(message))) if instance.core.mode.has_solver() => {
            // The importer's solver tried the states and may try a shorter step.
            instance
                .logger
                .report(Status::Discard, &format!("{function}: {message}"));
            Status::Discard
        }
        Ok(Err(Failure::Broken(message))) => {
            instance.core.mode = Mode::Error;
            instance
                .logger
                .report(Status::Error, &format!("{function}: {message}"));
            Status::Error
        }
        Ok(Err(Failure::Unavailable(message))) => {
            instance
                .logger
                .report(Status::Discard, &format!("{function}: {message}"));
            Status::Discard
        }
        Err(panic) => {
            instance.core.mode = Mode::Poisoned;
            let message = panic_message(panic.as_ref());
            instance.logger.report(
                Status::Fatal,
                &format!(
                    "{function} failed internally ({message}); this instance can only be freed"
                ),
            );
            Status::Fatal
        }
    }
}

/// The message of a panic.
pub(super) fn panic_message(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
}

/// Refuses invalid arrays: a slice in Rust has at most `isize::MAX` bytes.
fn check_array<T>(pointer: *const T, count: usize) -> Outcome {
    if pointer.is_null() || !pointer.is_aligned() {
        return refuse("an array is a null pointer");
    }
    let bytes = count.checked_mul(size_of::<T>());
    if bytes.is_none_or(|bytes| bytes > isize::MAX as usize) {
        return refuse(format!("no array can hold {count} values"));
    }
    Ok(())
}

/// An array that C hands over to be read.
///
/// # Safety
/// `pointer` is null or points to `count` values that live as long as the result is used.
pub(super) unsafe fn read<'a, T>(pointer: *const T, count: usize) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_array(pointer, count)?;
    // SAFETY: not null, aligned and no larger than memory can be; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array that C hands over to be filled.
///
/// # Safety
/// `pointer` is null or points to `count` values that nobody else uses while the result is.
pub(super) unsafe fn write<'a, T>(pointer: *mut T, count: usize) -> Outcome<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check_array(pointer, count)?;
    // SAFETY: not null, aligned and no larger than memory can be; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// A single value that C hands over to be filled.
///
/// # Safety
/// As [`write()`] with a count of 1.
pub(super) unsafe fn out<'a, T>(pointer: *mut T) -> Outcome<&'a mut T> {
    // SAFETY: the caller's promise is the one that `write` needs.
    match unsafe { write(pointer, 1) }? {
        [value] => Ok(value),
        _ => refuse("a result has nowhere to go"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declaration::Configuration;
    use crate::fmu::calls::Interface;
    use crate::fmu::logger::Logger;
    use crate::fmu::test_instance::with_logger;
    use fmi_sys::fmi2::{
        fmi2CallbackFunctions, fmi2CallbackLogger, fmi2Component, fmi2ComponentEnvironment,
        fmi2Status, fmi2Status_fmi2Discard, fmi2Status_fmi2Error, fmi2Status_fmi2Fatal,
        fmi2Status_fmi2OK, fmi2String,
    };
    use std::cell::RefCell;
    use std::ffi::CStr;
    use std::ptr::null_mut;

    /// The messages to the importer's logger.
    #[derive(Default)]
    struct Log(RefCell<Vec<(fmi2Status, String)>>);

    /// The standard's logger without the arguments of a format, which no message has.
    unsafe extern "C" fn log(
        environment: fmi2ComponentEnvironment,
        _instance_name: fmi2String,
        status: fmi2Status,
        _category: fmi2String,
        message: fmi2String,
    ) {
        // SAFETY: the environment is the log of `component`, the message ends in zero.
        let (log, message) = unsafe { (&*environment.cast::<Log>(), CStr::from_ptr(message)) };
        let message = message.to_str().unwrap().to_owned();
        log.0.borrow_mut().push((status, message));
    }

    fn component(environment: &Log) -> fmi2Component {
        component_for(Interface::CoSimulation, environment, false)
    }

    fn component_for(interface: Interface, environment: &Log, verbose: bool) -> fmi2Component {
        // SAFETY: the fixed arguments of a variadic function are passed like any others.
        let logger: fmi2CallbackLogger = unsafe { std::mem::transmute(log as *const ()) };
        let functions = fmi2CallbackFunctions {
            logger,
            allocateMemory: None,
            freeMemory: None,
            stepFinished: None,
            componentEnvironment: std::ptr::from_ref(environment).cast_mut().cast(),
        };
        let logger = Logger::fmi2(Some(&functions), c"test", verbose);
        into_component(with_logger(logger, interface, Configuration::default()))
    }

    fn run(component: fmi2Component, body: impl FnOnce(&mut Instance) -> Outcome) -> fmi2Status {
        // SAFETY: the tests use live components or null.
        unsafe { call(component, Call::SetDebugLogging, "fmi2Test", body) }
    }

    #[test]
    fn a_panic_is_fatal_poisons_the_instance_and_leaves_the_others_alone() {
        let (log, other_log) = (Log::default(), Log::default());
        let (broken, other) = (component(&log), component(&other_log));
        let status = run(broken, |instance| {
            instance.core.time = 3.0;
            panic!("an index of {} is 100% out of bounds", 7)
        });
        assert_eq!(status, fmi2Status_fmi2Fatal);
        let expected = "fmi2Test failed internally (an index of 7 is 100 percent out of bounds); \
                        this instance can only be freed";
        assert_eq!(log.0.take(), [(fmi2Status_fmi2Fatal, expected.to_owned())]);

        let status = run(broken, |_| {
            unreachable!("a poisoned instance is not called")
        });
        assert_eq!(status, fmi2Status_fmi2Error);
        let expected = "fmi2Test: this instance failed internally and can only be freed";
        assert_eq!(log.0.take(), [(fmi2Status_fmi2Error, expected.to_owned())]);

        let status = run(other, |instance| instance.setup_experiment(1.0, None));
        assert_eq!(status, fmi2Status_fmi2OK);
        // SAFETY: both are live, and not used any more.
        unsafe {
            free(broken);
            free(other);
        }
        assert!(log.0.borrow().is_empty() && other_log.0.borrow().is_empty());
    }

    #[test]
    fn a_panic_without_words_is_fatal_as_well() {
        let log = Log::default();
        let component = component(&log);
        let status = run(component, |_| std::panic::panic_any(7_u8));
        assert_eq!(status, fmi2Status_fmi2Fatal);
        assert!(log.0.borrow()[0].1.contains("(no message)"));
        // SAFETY: it is live, and not used any more.
        unsafe { free(component) };
    }

    #[test]
    fn failures_have_the_standards_status_and_are_reported() {
        let log = Log::default();
        let component = component(&log);
        let text = || "reason".to_owned();
        for (failure, status, severity, mode) in [
            (
                Failure::Unavailable(text()),
                fmi2Status_fmi2Discard,
                // Reported only where the importer enables all categories.
                None,
                Mode::Instantiated,
            ),
            (
                Failure::Refused(text()),
                fmi2Status_fmi2Error,
                Some(fmi2Status_fmi2Error),
                Mode::Instantiated,
            ),
            (
                Failure::Broken(text()),
                fmi2Status_fmi2Error,
                Some(fmi2Status_fmi2Error),
                Mode::Error,
            ),
        ] {
            assert_eq!(run(component, |_| Err(failure)), status);
            let logged = severity.map(|severity| (severity, "fmi2Test: reason".to_owned()));
            assert_eq!(log.0.take(), Vec::from_iter(logged));
            let now = |instance: &mut Instance| {
                assert_eq!(instance.core.mode, mode);
                Ok(())
            };
            assert_eq!(run(component, now), fmi2Status_fmi2OK);
        }
        // SAFETY: it is live, and not used any more.
        unsafe { free(component) };
    }

    #[test]
    fn a_solver_may_try_again_after_a_computation_that_failed() {
        for (mode, verbose) in [
            (Mode::Event, false),
            (Mode::ContinuousTime, false),
            (Mode::ContinuousTime, true),
        ] {
            let log = Log::default();
            let component = component_for(Interface::ModelExchange, &log, verbose);
            let enter = |instance: &mut Instance| {
                instance.core.mode = mode;
                Ok(())
            };
            assert_eq!(run(component, enter), fmi2Status_fmi2OK);
            let broken = |_: &mut Instance| Err(Failure::Broken("reason".to_owned()));
            assert_eq!(run(component, broken), fmi2Status_fmi2Discard);
            // A solver tries many states: these are reported only where the importer enables all categories.
            let logged = (fmi2Status_fmi2Discard, "fmi2Test: reason".to_owned());
            assert_eq!(log.0.take(), if verbose { vec![logged] } else { vec![] });
            let still = |instance: &mut Instance| {
                assert_eq!(instance.core.mode, mode);
                Ok(())
            };
            assert_eq!(run(component, still), fmi2Status_fmi2OK);
            // SAFETY: it is live, and not used any more.
            unsafe { free(component) };
        }
    }

    #[test]
    fn pointers_to_other_memory_are_refused() {
        let unreachable = |_: &mut Instance| unreachable!();
        assert_eq!(run(null_mut(), unreachable), fmi2Status_fmi2Error);
        // As long as the mark: a memory checker detects further reads.
        let mut mark = 0_u64;
        let other = (&raw mut mark).cast();
        assert_eq!(run(other, unreachable), fmi2Status_fmi2Error);
        // The mark at an address where no handle can be.
        let mut bytes = vec![0_u64; size_of::<Handle>()];
        let odd = bytes.as_mut_ptr().wrapping_byte_add(1);
        // SAFETY: there is room for eight bytes.
        unsafe { odd.write_unaligned(MAGIC) };
        let odd = odd.cast();
        assert_eq!(run(odd, unreachable), fmi2Status_fmi2Error);
        // SAFETY: null is allowed, and what has not the handle's mark is not touched.
        unsafe {
            free(null_mut());
            free(other);
            free(odd);
        }
    }

    #[test]
    fn empty_arrays_may_be_null_and_others_not() {
        // SAFETY: what is read or written is null or a live local.
        unsafe {
            assert!(read::<f64>(std::ptr::null(), 0).unwrap().is_empty());
            assert!(read::<f64>(std::ptr::null(), 1).is_err());
            assert!(write::<f64>(null_mut(), 0).unwrap().is_empty());
            assert!(write::<f64>(null_mut(), 2).is_err());
            assert!(out::<f64>(null_mut()).is_err());
            let values = [1.0, 2.0];
            assert_eq!(read(values.as_ptr(), 2).unwrap(), values);
            assert!(read(values.as_ptr().wrapping_byte_add(1), 1).is_err());
            for count in [usize::MAX, isize::MAX as usize / 8 + 1] {
                assert!(read(values.as_ptr(), count).is_err());
                assert!(write(values.as_ptr().cast_mut(), count).is_err());
            }
        }
    }
}
