//! Sequences of calls of FMI 3.0, in and out of order.
#![no_main]

use libfuzzer_sys::fuzz_target;
use ugv_terrain_fuzz::fmi3::{Call, Host};

fuzz_target!(|calls: Vec<(bool, Call)>| Host::new().run(&calls));
