//! Reading and setting variables: Float64, Int64 for the enumeration, Boolean; there are no others.

use super::exports;
use crate::fmu::guard::{read, write};
use crate::fmu::values::none_of;
use fmi_sys::fmi3::*;

exports! {
    /// Reads variables of type Float64.
    fmi3GetFloat64: fmi3GetFloat64TYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, values: *mut fmi3Float64, n_values: usize)
    |instance| instance.get_reals(read(references, count)?, write(values, n_values)?);

    /// Sets variables of type Float64.
    fmi3SetFloat64: fmi3SetFloat64TYPE = Set
    (references: *const fmi3ValueReference, count: usize, values: *const fmi3Float64, n_values: usize)
    |instance| instance.set_reals(read(references, count)?, read(values, n_values)?);

    /// Reads variables of an enumeration.
    fmi3GetInt64: fmi3GetInt64TYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, values: *mut fmi3Int64, n_values: usize)
    |instance| instance.get_enumerations(read(references, count)?, write(values, n_values)?);

    /// Sets variables of an enumeration.
    fmi3SetInt64: fmi3SetInt64TYPE = Set
    (references: *const fmi3ValueReference, count: usize, values: *const fmi3Int64, n_values: usize)
    |instance| instance.set_enumerations(read(references, count)?, read(values, n_values)?);

    /// Reads variables of type Boolean.
    fmi3GetBoolean: fmi3GetBooleanTYPE = GetOrStart
    (references: *const fmi3ValueReference, count: usize, values: *mut fmi3Boolean, n_values: usize)
    |instance| instance.get_booleans(read(references, count)?, write(values, n_values)?);

    /// Sets variables of type Boolean.
    fmi3SetBoolean: fmi3SetBooleanTYPE = Set
    (references: *const fmi3ValueReference, count: usize, values: *const fmi3Boolean, n_values: usize)
    |instance| {
        // As bytes: a C program may have left another number than 0 and 1 there.
        let values = read(values.cast::<u8>(), n_values)?;
        instance.set_booleans(read(references, count)?, values, |value| value != 0)
    };
}

/// Functions of types that no variable has; reading or setting none of them succeeds.
macro_rules! absent {
    ($($kind:literal: $get:ident $get_type:ident $set:ident $set_type:ident $value:ty;)*) => {
        exports! {$(
            #[doc = concat!("Reads variables of type ", $kind, ": there are none.")]
            $get: $get_type = GetOrStart
            (references: *const fmi3ValueReference, count: usize, _values: *mut $value, _n_values: usize)
            |_| none_of($kind, read(references, count)?);

            #[doc = concat!("Sets variables of type ", $kind, ": there are none.")]
            $set: $set_type = Set
            (references: *const fmi3ValueReference, count: usize, _values: *const $value, _n_values: usize)
            |_| none_of($kind, read(references, count)?);
        )*}
    };
}

absent! {
    "Float32": fmi3GetFloat32 fmi3GetFloat32TYPE fmi3SetFloat32 fmi3SetFloat32TYPE fmi3Float32;
    "Int8": fmi3GetInt8 fmi3GetInt8TYPE fmi3SetInt8 fmi3SetInt8TYPE fmi3Int8;
    "UInt8": fmi3GetUInt8 fmi3GetUInt8TYPE fmi3SetUInt8 fmi3SetUInt8TYPE fmi3UInt8;
    "Int16": fmi3GetInt16 fmi3GetInt16TYPE fmi3SetInt16 fmi3SetInt16TYPE fmi3Int16;
    "UInt16": fmi3GetUInt16 fmi3GetUInt16TYPE fmi3SetUInt16 fmi3SetUInt16TYPE fmi3UInt16;
    "Int32": fmi3GetInt32 fmi3GetInt32TYPE fmi3SetInt32 fmi3SetInt32TYPE fmi3Int32;
    "UInt32": fmi3GetUInt32 fmi3GetUInt32TYPE fmi3SetUInt32 fmi3SetUInt32TYPE fmi3UInt32;
    "UInt64": fmi3GetUInt64 fmi3GetUInt64TYPE fmi3SetUInt64 fmi3SetUInt64TYPE fmi3UInt64;
    "String": fmi3GetString fmi3GetStringTYPE fmi3SetString fmi3SetStringTYPE fmi3String;
}

exports! {
    /// Reads variables of type Binary: there are none.
    fmi3GetBinary: fmi3GetBinaryTYPE = GetOrStart
    (
        references: *const fmi3ValueReference,
        count: usize,
        _sizes: *mut usize,
        _values: *mut fmi3Binary,
        _n_values: usize,
    )
    |_| none_of("Binary", read(references, count)?);

    /// Sets variables of type Binary: there are none.
    fmi3SetBinary: fmi3SetBinaryTYPE = Set
    (
        references: *const fmi3ValueReference,
        count: usize,
        _sizes: *const usize,
        _values: *const fmi3Binary,
        _n_values: usize,
    )
    |_| none_of("Binary", read(references, count)?);
}
