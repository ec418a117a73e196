//! The FMU: the model behind the C interfaces of FMI 2.0 and FMI 3.0.
//!
//! This is the only module with unsafe code. `fmi2` and `fmi3` contain the functions of the two
//! standards. Each goes through `guard`, which checks the handle and the order of calls (one table,
//! in `calls`) and contains panics. `instance` is safe code without C. It depends on the version of
//! the standard only in whether value references stand for scalars or arrays.
#![allow(unsafe_code, reason = "the C interface")]

mod calls;
mod creation;

mod exports;
mod fmi2;
mod fmi3;
mod guard;
mod instance;
mod logger;
mod parameters;
mod resources;
mod saved;
mod sensitivity;
mod status;
#[cfg(test)]
mod test_instance;
mod values;
