//! The FMU: the model behind the C interface of FMI 2.0.
//!
//! This is the only module with unsafe code. `exports` holds the standard's functions; each
//! goes through `guard`, which checks the handle and the order of calls (one table, in
//! `calls`) and contains panics; `instance` is safe code that knows no C.
#![allow(unsafe_code, reason = "the C interface")]

mod calls;
mod exports;
mod guard;
mod instance;
mod logger;
mod parameters;
mod resources;
mod saved;
mod sensitivity;
