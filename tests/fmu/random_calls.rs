//! 100 000 random calls of all functions of either version of the standard, in and out of order, on
//! several instances and states, from C (`host.c`, `host_3.c`): no crash, no memory error, no
//! leak, and the same results however the calls of independent instances interleave.

use crate::support;
use crate::support::host::{Host, printed};
use std::collections::HashMap;
use std::process::Command;

const CALLS: &str = "100000";
const SEED: &str = "20071121";

/// How often each function returned each status.
type Counts = HashMap<String, [u64; 4]>;

/// A version of the standard.
struct Version {
    host: &'static str,
    /// Which of the ways to name the resources it takes.
    resources: usize,
    functions: usize,
    /// Functions that never succeed with this FMU.
    never: &'static [&'static str],
    /// Calls that always succeed.
    always: &'static [&'static str],
    /// Functions that have nothing to tell at times, or are given a state that is none; and those that may be asked
    /// where there are no forces.
    discards: &'static [&'static str],
    may_discard: &'static [&'static str],
    /// Calls that have to get somewhere so and so often.
    often: &'static [(&'static str, u64)],
    /// Refuses damaged states.
    deserialize: &'static str,
}

const FMI_2: Version = Version {
    host: "host.c",
    resources: 1,
    functions: 44,
    // Its steps are never pending.
    never: &[
        "fmi2CancelStep",
        "fmi2GetStatus",
        "fmi2GetIntegerStatus",
        "fmi2GetStringStatus",
    ],
    always: &["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2FreeInstance"],
    discards: &[
        "fmi2GetStatus",
        "fmi2GetRealStatus",
        "fmi2GetIntegerStatus",
        "fmi2GetBooleanStatus",
        "fmi2GetStringStatus",
        "fmi2SetContinuousStates",
    ],
    may_discard: &[
        "fmi2GetReal",
        "fmi2GetDerivatives",
        "fmi2GetDirectionalDerivative",
    ],
    often: &[
        ("fmi2DoStep", 1000),
        ("fmi2GetDerivatives", 500),
        ("fmi2SetFMUstate", 500),
    ],
    deserialize: "fmi2DeSerializeFMUstate",
};

const FMI_3: Version = Version {
    host: "host_3.c",
    resources: 0,
    functions: 75,
    never: &[
        "fmi3InstantiateScheduledExecution",
        "fmi3EnterConfigurationMode",
        "fmi3ExitConfigurationMode",
        "fmi3EvaluateDiscreteStates",
        "fmi3ActivateModelPartition",
    ],
    always: &["fmi3GetVersion", "fmi3FreeInstance"],
    discards: &["fmi3SetContinuousStates"],
    may_discard: &[
        "fmi3GetFloat64",
        "fmi3GetContinuousStateDerivatives",
        "fmi3GetDirectionalDerivative",
        "fmi3GetAdjointDerivative",
    ],
    often: &[
        ("fmi3DoStep", 1000),
        ("fmi3GetContinuousStateDerivatives", 500),
        ("fmi3SetFMUState", 500),
    ],
    deserialize: "fmi3DeserializeFMUState",
};

impl Version {
    /// Runs the host through `command`.
    fn run(&self, host: &Host, mut command: Command, ways: &[&str]) -> Counts {
        let output = command
            .arg(host.library())
            .arg(&host.resources()[self.resources])
            .args([host.guid(), SEED, CALLS])
            .args(ways)
            .output()
            .unwrap();
        printed(&output).lines().map(counts).collect()
    }

    /// The calls mean something only if enough of them get somewhere.
    fn assert_variety(&self, counts: &Counts) {
        assert_eq!(counts.len(), self.functions);
        for (name, [ok, _warning, discard, error]) in counts {
            assert_eq!(*ok == 0, self.never.contains(&name.as_str()), "{name}");
            assert_eq!(*error == 0, self.always.contains(&name.as_str()), "{name}");
            if !self.may_discard.contains(&name.as_str()) {
                let discards = self.discards.contains(&name.as_str());
                assert_eq!(*discard > 0, discards, "{name}");
            }
        }
        for (name, least) in self.often {
            assert!(counts[*name][0] > *least, "{name}: {counts:?}");
        }
        assert!(counts[self.deserialize][3] > 500, "{counts:?}");
    }

    fn assert_ways_agree(&self) {
        if let Some(host) = Host::compile(self.host) {
            let ways = ["mixed", "serial", "threads"];
            self.assert_variety(&self.run(&host, Command::new(host.program()), &ways));
        }
    }

    fn assert_clean_memory(&self) {
        let Some(host) = Host::compile(self.host) else {
            return;
        };
        if !support::has("valgrind", "valgrind") {
            return;
        }
        let mut valgrind = Command::new("valgrind");
        let kinds = "definite,indirect,possible";
        valgrind
            .args(["--quiet", "--error-exitcode=99", "--leak-check=full"])
            .args([
                format!("--show-leak-kinds={kinds}"),
                format!("--errors-for-leak-kinds={kinds}"),
            ])
            .arg(format!(
                "--suppressions={}",
                support::root().join("tests/fmu/host.supp").display()
            ))
            .arg(host.program());
        self.assert_variety(&self.run(&host, valgrind, &["mixed"]));
    }
}

fn counts(line: &str) -> (String, [u64; 4]) {
    let mut words = line.split(' ');
    let name = words.next().unwrap().to_owned();
    let counts: Vec<u64> = words.map(|word| word.parse().unwrap()).collect();
    (name, counts.try_into().unwrap())
}

#[test]
fn random_calls_of_fmi_2_give_the_same_mixed_one_after_the_other_and_in_threads() {
    FMI_2.assert_ways_agree();
}

#[test]
fn random_calls_of_fmi_2_make_no_memory_error_and_leak_nothing() {
    FMI_2.assert_clean_memory();
}

#[test]
fn random_calls_of_fmi_3_give_the_same_mixed_one_after_the_other_and_in_threads() {
    FMI_3.assert_ways_agree();
}

#[test]
fn random_calls_of_fmi_3_make_no_memory_error_and_leak_nothing() {
    FMI_3.assert_clean_memory();
}
