//! Sequences of calls of FMI 2.0, in and out of order.
#![no_main]

use libfuzzer_sys::fuzz_target;
use ugv_terrain_fuzz::fmi2::{Call, Host};

fuzz_target!(|calls: Vec<(bool, Call)>| Host::new().run(&calls));
