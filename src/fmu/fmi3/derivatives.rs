//! Partial derivatives and dependencies.

use super::exports;
use crate::declaration::DependencyKind;
use crate::fmu::guard::{out, read, write};
use crate::fmu::instance::refuse;
use fmi_sys::fmi3::*;

/// To the functions of dependencies: all elements of a variable.
const ALL_ELEMENTS: usize = 0;

exports! {
    /// Derivatives of outputs and state derivatives in a direction of inputs, states and the time.
    fmi3GetDirectionalDerivative: fmi3GetDirectionalDerivativeTYPE = Differentiate
    (
        unknowns: *const fmi3ValueReference,
        n_unknowns: usize,
        knowns: *const fmi3ValueReference,
        n_knowns: usize,
        seed: *const fmi3Float64,
        n_seed: usize,
        sensitivity: *mut fmi3Float64,
        n_sensitivity: usize,
    )
    |instance| {
        // A copy, as the result may lie in the same place.
        let seeds = read(seed, n_seed)?.to_vec();
        instance.directional_derivative(
            read(unknowns, n_unknowns)?,
            read(knowns, n_knowns)?,
            &seeds,
            write(sensitivity, n_sensitivity)?,
        )
    };

    /// Derivatives of a weighted sum of outputs and state derivatives by inputs, states and the time.
    fmi3GetAdjointDerivative: fmi3GetAdjointDerivativeTYPE = Differentiate
    (
        unknowns: *const fmi3ValueReference,
        n_unknowns: usize,
        knowns: *const fmi3ValueReference,
        n_knowns: usize,
        seed: *const fmi3Float64,
        n_seed: usize,
        sensitivity: *mut fmi3Float64,
        n_sensitivity: usize,
    )
    |instance| {
        // A copy, as the result may lie in the same place.
        let seeds = read(seed, n_seed)?.to_vec();
        instance.adjoint_derivative(
            read(unknowns, n_unknowns)?,
            read(knowns, n_knowns)?,
            &seeds,
            write(sensitivity, n_sensitivity)?,
        )
    };

    /// On how many variables an output or a state derivative depends.
    fmi3GetNumberOfVariableDependencies: fmi3GetNumberOfVariableDependenciesTYPE = GetDependencies
    (reference: fmi3ValueReference, count: *mut usize)
    |instance| {
        *out(count)? = instance.dependencies(reference)?.0.len();
        Ok(())
    };

    /// On which variables: all elements of an array depend on the same.
    fmi3GetVariableDependencies: fmi3GetVariableDependenciesTYPE = GetDependencies
    (
        dependent: fmi3ValueReference,
        dependent_elements: *mut usize,
        independents: *mut fmi3ValueReference,
        independent_elements: *mut usize,
        kinds: *mut fmi3DependencyKind,
        count: usize,
    )
    |instance| {
        let (references, kind) = instance.dependencies(dependent)?;
        if references.len() != count {
            return refuse(format!("there are {} dependencies, not {count}", references.len()));
        }
        write(dependent_elements, count)?.fill(ALL_ELEMENTS);
        write(independents, count)?.copy_from_slice(&references);
        write(independent_elements, count)?.fill(ALL_ELEMENTS);
        write(kinds, count)?.fill(match kind {
            DependencyKind::Constant => fmi3DependencyKind_fmi3Constant,
            DependencyKind::Dependent => fmi3DependencyKind_fmi3Dependent,
        });
        Ok(())
    };
}
