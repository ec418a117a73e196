//! Many steps and instances with flat memory (`soak.c`; `scripts/tools/soak.sh` is the long run), and many
//! instances in many threads (`threads.c`), from C, through both versions of the standard.

use crate::support::host::Host;

#[test]
fn memory_is_flat_over_many_steps_and_instances() {
    if let Some(host) = Host::compile("soak.c") {
        let table = host.run_both(&["50000", "1000"]);
        assert_eq!(table.matches(" kB, of 1024 allowed").count(), 2, "{table}");
    }
}

#[test]
fn vehicles_in_threads_drive_as_they_do_alone() {
    if let Some(host) = Host::compile("threads.c") {
        let said = host.run_both(&["12"]);
        assert!(
            said.starts_with("64 vehicles in 16 threads, 120 steps each"),
            "{said}"
        );
    }
}
