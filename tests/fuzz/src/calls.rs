//! Arguments of calls, and what may be believed of the modes that an instance is in.
//!
//! What a caller must keep, the fuzzer keeps: a pointer is null or to as many values as is said, strings
//! end in zero, instances and states are live or null. Everything else is arbitrary.

use arbitrary::Arbitrary;
use std::ffi::{CStr, c_char};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Modes of both standards, as bits.
pub mod mode {
    pub const INSTANTIATED: u16 = 1;
    pub const INITIALIZATION: u16 = 2;
    pub const STEP: u16 = 4;
    pub const EVENT: u16 = 8;
    pub const CONTINUOUS: u16 = 16;
    pub const TERMINATED: u16 = 32;
    pub const ERROR: u16 = 64;
    pub const STEP_EVENT: u16 = 128;
    pub const EXCHANGE: u16 = EVENT | CONTINUOUS;
    pub const RUNNING: u16 = STEP | STEP_EVENT | EXCHANGE;
    pub const OVER: u16 = TERMINATED | ERROR;
    pub const READABLE: u16 = INITIALIZATION | RUNNING | OVER;
    pub const EARLY: u16 = INSTANTIATED | INITIALIZATION;
    pub const ANY: u16 = EARLY | RUNNING | OVER;
}

/// The longest array, and the most calls of a sequence.
pub const LONGEST: usize = 12;
pub const MOST_CALLS: usize = 48;

/// No step is longer \[s\]: a vehicle drives on for as long as it is told, and that takes its time.
const LONGEST_STEP: f64 = 0.05;

/// Statuses of both standards.
pub const OK: u32 = 0;
pub const DISCARD: u32 = 2;
pub const ERROR: u32 = 3;

/// The modes that an instance may be in. A call that fails may end in the mode of errors, or may not:
/// the standard does not say, and a caller cannot see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modes(pub u16);

impl Modes {
    /// Learns from a call: `allowed` in some modes, leading to `next` or changing nothing.
    ///
    /// # Panics
    /// Where the call's status does not fit, or it failed without a word to a logger that listens.
    pub fn learn(&mut self, name: &str, status: u32, allowed: u16, next: Option<u16>) {
        let now = self.0 & allowed;
        match status {
            OK => {
                assert!(now != 0, "{name} succeeded in the modes {:#b}", self.0);
                self.0 = next.unwrap_or(now);
            }
            DISCARD => assert!(now != 0, "{name} was discarded in the modes {:#b}", self.0),
            ERROR if now != 0 => self.0 |= mode::ERROR,
            ERROR => {}
            other => panic!("{name} returned {other}"),
        }
    }
}

/// How often the loggers were called.
static MESSAGES: AtomicUsize = AtomicUsize::new(0);

pub fn messages() -> usize {
    MESSAGES.load(Ordering::Relaxed)
}

/// Takes note of a message, which must be a text that cannot be taken for a format.
///
/// # Safety
/// The strings end in zero.
pub unsafe fn take_note(category: *const c_char, message: *const c_char) {
    assert!(!category.is_null() && !message.is_null());
    // SAFETY: not null; the caller promises the rest.
    let [category, message] = unsafe { [CStr::from_ptr(category), CStr::from_ptr(message)] };
    assert!(category.to_str().unwrap().starts_with("logS") || category == c"logEvents");
    assert!(!message.to_str().unwrap().contains('#'));
    MESSAGES.fetch_add(1, Ordering::Relaxed);
}

/// Any number, most of them sensible.
#[derive(Arbitrary, Debug, Clone, Copy)]
pub enum Number {
    Some(i16),
    Small(i16),
    Strange(u8),
    Any(f64),
}

impl Number {
    pub fn value(self) -> f64 {
        const STRANGE: [f64; 12] = [
            0.0,
            -0.0,
            1.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            5e-324,
            1e300,
            1e9,
        ];
        match self {
            Self::Some(number) => f64::from(number) / 1024.0,
            Self::Small(number) => f64::from(number) * 1e-6,
            Self::Strange(index) => STRANGE[usize::from(index) % STRANGE.len()],
            Self::Any(number) => number,
        }
    }

    /// As the size of a step.
    pub fn step(self) -> f64 {
        let value = self.value();
        let too_long = value.is_finite() && value > LONGEST_STEP;
        if too_long {
            value % LONGEST_STEP
        } else {
            value
        }
    }
}

/// A value reference, most of them of a variable.
#[derive(Arbitrary, Debug, Clone, Copy)]
pub enum Reference {
    Input(bool),
    Scalar(u8),
    Effect(u8, u8),
    Time,
    Row(u8),
    Wheel(u8, u8),
    Any(u32),
}

impl Reference {
    pub fn value(self) -> u32 {
        match self {
            Self::Input(right) => right.into(),
            Self::Scalar(index) => u32::from(index) % 41,
            Self::Effect(effect, parameter) => {
                500 + 16 * (u32::from(effect) % 25) + u32::from(parameter) % 13
            }
            Self::Time => 400,
            Self::Row(index) => 1000 + u32::from(index) % 6,
            Self::Wheel(wheel, field) => 2000 + 16 * (u32::from(wheel) % 9) + u32::from(field) % 8,
            Self::Any(reference) => reference,
        }
    }
}

/// An array that is handed over, or null in its place.
#[derive(Arbitrary, Debug, Clone)]
pub struct Array<T> {
    is_null: Null,
    items: Vec<T>,
}

impl<T> Array<T> {
    /// Its values, at most so many as are allowed.
    pub fn values<U>(&self, value: impl Fn(&T) -> U) -> Buffer<U> {
        Buffer {
            values: self.items.iter().take(LONGEST).map(value).collect(),
            is_null: self.is_null.holds(),
        }
    }
}

/// Once in a while null.
#[derive(Arbitrary, Debug, Clone, Copy)]
pub struct Null(u8);

impl Null {
    pub fn holds(self) -> bool {
        self.0 % 32 == 31
    }

    /// A place for a result, or null.
    pub fn or<T>(self, place: &mut T) -> *mut T {
        if self.holds() {
            std::ptr::null_mut()
        } else {
            place
        }
    }
}

/// Memory of exactly the length that is told.
#[derive(Debug)]
pub struct Buffer<T> {
    values: Box<[T]>,
    is_null: bool,
}

impl<T: Clone> Buffer<T> {
    /// Room for results, as long as another array.
    pub fn room(count: usize, null: Null, value: T) -> Self {
        let (values, is_null) = (vec![value; count].into(), null.holds());
        Self { values, is_null }
    }
}

impl<T> Buffer<T> {
    pub fn len(&self) -> usize {
        self.values.len()
    }

    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    pub fn pointer(&self) -> *const T {
        if self.is_null {
            std::ptr::null()
        } else {
            self.values.as_ptr()
        }
    }

    pub fn place(&mut self) -> *mut T {
        if self.is_null {
            std::ptr::null_mut()
        } else {
            self.values.as_mut_ptr()
        }
    }
}

impl Buffer<f64> {
    /// # Panics
    /// Where a call succeeded and gave what is no number.
    pub fn check(&self, name: &str, status: u32) {
        let finite = self.values.iter().all(|value| value.is_finite());
        assert!(status != OK || finite, "{name} gave {:?}", self.values);
    }
}

/// Names of log categories, and what is none.
#[derive(Arbitrary, Debug, Clone, Copy)]
pub struct Category(u8);

impl Category {
    pub fn pointer(&self) -> *const c_char {
        let known = [
            c"logStatusError",
            c"logStatusWarning",
            c"logStatusDiscard",
            c"logEvents",
            c"logAll",
            c"\xff",
        ];
        known
            .get(usize::from(self.0) % 7)
            .map_or(std::ptr::null(), |name| name.as_ptr())
    }
}

/// Where the resources are said to be; the built-in ones serve where there are none.
#[derive(Arbitrary, Debug, Clone, Copy)]
pub struct Place(u8);

impl Place {
    pub fn pointer(self) -> *const c_char {
        let known = [
            c"",
            c"file:///nowhere/%20",
            c"/nowhere/",
            c"rubbish",
            c"file:///%ff",
            c"/dev/null",
        ];
        known
            .get(usize::from(self.0) % 8)
            .map_or(std::ptr::null(), |name| name.as_ptr())
    }
}
