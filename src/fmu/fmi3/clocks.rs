//! Clocks and the execution by a scheduler: there are none. What asks for none of the clocks succeeds.

use super::exports;
use crate::fmu::guard::read;
use crate::fmu::instance::refuse;
use crate::fmu::values::none_of;
use fmi_sys::fmi3::*;

exports! {
    /// Reads clocks: there are none.
    fmi3GetClock: fmi3GetClockTYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, _values: *mut fmi3Clock)
    |_| none_of("Clock", read(references, count)?);

    /// Sets clocks: there are none.
    fmi3SetClock: fmi3SetClockTYPE = Set
    (references: *const fmi3ValueReference, count: usize, _values: *const fmi3Clock)
    |_| none_of("Clock", read(references, count)?);

    /// Intervals of clocks: there are none.
    fmi3GetIntervalDecimal: fmi3GetIntervalDecimalTYPE = GetOrStart
    (
        references: *const fmi3ValueReference,
        count: usize,
        _intervals: *mut fmi3Float64,
        _qualifiers: *mut fmi3IntervalQualifier,
    )
    |_| none_of("Clock", read(references, count)?);

    /// Intervals of clocks: there are none.
    fmi3GetIntervalFraction: fmi3GetIntervalFractionTYPE = GetOrStart
    (
        references: *const fmi3ValueReference,
        count: usize,
        _counters: *mut fmi3UInt64,
        _resolutions: *mut fmi3UInt64,
        _qualifiers: *mut fmi3IntervalQualifier,
    )
    |_| none_of("Clock", read(references, count)?);

    /// Shifts of clocks: there are none.
    fmi3GetShiftDecimal: fmi3GetShiftDecimalTYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, _shifts: *mut fmi3Float64)
    |_| none_of("Clock", read(references, count)?);

    /// Shifts of clocks: there are none.
    fmi3GetShiftFraction: fmi3GetShiftFractionTYPE = GetOrStart
    (
        references: *const fmi3ValueReference,
        count: usize,
        _counters: *mut fmi3UInt64,
        _resolutions: *mut fmi3UInt64,
    )
    |_| none_of("Clock", read(references, count)?);

    /// Sets intervals of clocks: there are none.
    fmi3SetIntervalDecimal: fmi3SetIntervalDecimalTYPE = Set
    (references: *const fmi3ValueReference, count: usize, _intervals: *const fmi3Float64)
    |_| none_of("Clock", read(references, count)?);

    /// Sets intervals of clocks: there are none.
    fmi3SetIntervalFraction: fmi3SetIntervalFractionTYPE = Set
    (
        references: *const fmi3ValueReference,
        count: usize,
        _counters: *const fmi3UInt64,
        _resolutions: *const fmi3UInt64,
    )
    |_| none_of("Clock", read(references, count)?);

    /// Sets shifts of clocks: there are none.
    fmi3SetShiftDecimal: fmi3SetShiftDecimalTYPE = Set
    (references: *const fmi3ValueReference, count: usize, _shifts: *const fmi3Float64)
    |_| none_of("Clock", read(references, count)?);

    /// Sets shifts of clocks: there are none.
    fmi3SetShiftFraction: fmi3SetShiftFractionTYPE = Set
    (
        references: *const fmi3ValueReference,
        count: usize,
        _counters: *const fmi3UInt64,
        _resolutions: *const fmi3UInt64,
    )
    |_| none_of("Clock", read(references, count)?);

    /// Not available: there is no scheduled execution.
    fmi3ActivateModelPartition: fmi3ActivateModelPartitionTYPE = Unsupported
    (_clock: fmi3ValueReference, _activation_time: fmi3Float64)
    |_| refuse("this FMU has no scheduled execution");
}
