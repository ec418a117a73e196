//! What `ugv diagnose` says of a case, and whether it is right.

use super::cases::{Family, generate_lasting, write};
use rayon::prelude::*;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// The tool; `UGV_TOOL` names another build of it.
pub fn tool() -> PathBuf {
    std::env::var_os("UGV_TOOL").map_or(env!("CARGO_BIN_EXE_ugv").into(), PathBuf::from)
}

/// Another seed than those that the diagnosis was developed on.
const SEED: u64 = 2007;
/// Seconds that the drives last: long enough for a few manoeuvres, short enough for a hundred cases.
const SHORT: [f64; 2] = [35.0, 40.0];
/// A set with more names than these tells nothing.
const LARGEST_SET: usize = 4;

/// How an answer compares with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// The truth and nothing else in its place.
    Named,
    /// The truth in a set of few.
    InSet,
    /// That nothing is missing, or that there is too little, of what hardly shows.
    Silent,
    /// The same of what shows.
    Missed,
    /// Something else.
    Wrong,
}

impl Answer {
    /// Whether nothing wrong was said.
    pub fn is_honest(self) -> bool {
        !matches!(self, Self::Missed | Self::Wrong)
    }
}

/// A case and what was said of it.
pub struct Told {
    name: String,
    pub folder: PathBuf,
    pub truth: Value,
    pub said: Value,
    pub seconds: f64,
}

/// Diagnoses cases, one process for each processor. What was said is printed as it comes, past the
/// test harness, then as a table, which is left with all files in `target/tmp/diagnosis_suite/GROUP`.
pub fn diagnosed(group: &str, cases: &[(Family, usize)]) -> Vec<Told> {
    diagnosed_lasting(SHORT, group, cases)
}

/// The same with drives that last from and to so many seconds.
pub fn diagnosed_lasting(lengths: [f64; 2], group: &str, cases: &[(Family, usize)]) -> Vec<Told> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("diagnosis_suite")
        .join(group);
    let one = |(family, number): &(Family, usize)| {
        let told = Told::of(lengths, &folder, *family, *number);
        std::io::Write::write_all(&mut std::io::stderr(), told.line().as_bytes()).unwrap();
        told
    };
    let told: Vec<Told> = cases.par_iter().map(one).collect();
    let mut table = format!("{group}\n{}\n", Told::HEADER);
    for one in &told {
        table += &one.line();
    }
    println!("{table}");
    fs::write(folder.join("table.txt"), table).unwrap();
    for one in &told {
        one.check();
    }
    told
}

/// Runs the tool; the drives are those that are to be diagnosed.
pub fn diagnose(case: &Path, out: &Path, jobs: usize) {
    let drives = ["drive.csv", "drive2.csv"].map(|name| case.join(name));
    let output = Command::new(tool())
        .arg("diagnose")
        .args(drives.iter().filter(|path| path.is_file()))
        .args(["--quiet", "--jobs", &jobs.to_string(), "--out"])
        .arg(out)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {errors}", case.display());
}

pub fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn strings(value: &Value) -> Vec<&str> {
    let all = value.as_array().into_iter().flatten();
    all.filter_map(Value::as_str).collect()
}

impl Told {
    const HEADER: &str = "case              answer  signal  verdict            sure  overlap  held out (se)    \
                          s     truth; what was said";

    fn of(lengths: [f64; 2], folder: &Path, family: Family, number: usize) -> Self {
        let name = format!("{}_{number:02}", family.name());
        let case = generate_lasting(lengths, family, number, SEED).unwrap();
        write(&case, folder, &name).unwrap();
        let out = folder.join(&name).join("out");
        let begin = Instant::now();
        diagnose(&folder.join(&name), &out, 1);
        Self {
            seconds: begin.elapsed().as_secs_f64(),
            truth: read(&folder.join(format!("{name}.truth.json"))),
            said: read(&out.join("diagnosis.json")),
            folder: folder.join(&name),
            name,
        }
    }

    pub fn verdict(&self) -> &str {
        self.said["verdict"].as_str().unwrap()
    }

    fn findings(&self) -> &[Value] {
        self.said["findings"].as_array().unwrap()
    }

    fn candidates(&self) -> &[Value] {
        self.said["candidates"].as_array().unwrap()
    }

    /// Names of what was found, the surest first.
    pub fn found(&self) -> Vec<&str> {
        let names = self.findings().iter().map(|one| one["effect"].as_str());
        names.map(Option::unwrap).collect()
    }

    /// What may be the first thing that was found.
    pub fn set(&self) -> Vec<&str> {
        let mut set = self.found();
        set.truncate(1);
        set.extend(
            self.findings()
                .iter()
                .take(1)
                .flat_map(|one| strings(&one["ambiguous_with"])),
        );
        set
    }

    /// Names of what is there in truth, and its size.
    pub fn effects(&self) -> Vec<(&str, &str)> {
        let all = self.truth["effects"].as_array().unwrap().iter();
        all.map(|one| {
            let text = |key: &str| one[key].as_str().unwrap();
            (text("effect"), text("size"))
        })
        .collect()
    }

    /// The names that would be right.
    fn right(&self) -> Vec<&str> {
        let all = self.truth["effects"].as_array().unwrap().iter();
        all.map(|one| match one["kind"].as_str() {
            Some("outside") => "unknown",
            _ => one["effect"].as_str().unwrap(),
        })
        .collect()
    }

    /// Signal that re-tuning the soil leaves, in standard deviations of the noise.
    pub fn signal(&self) -> f64 {
        self.truth["signal_left"].as_f64().unwrap()
    }

    fn is_silent(&self) -> bool {
        matches!(self.verdict(), "nothing_missing" | "insufficient_data")
    }

    pub fn answer(&self) -> Answer {
        let (right, set) = (self.right(), self.set());
        if self.is_silent() {
            let allowed = strings(&self.truth["expected"]).contains(&self.verdict());
            return match (allowed, right.is_empty()) {
                (true, true) => Answer::Named,
                _ if allowed || right.is_empty() => Answer::Silent,
                _ => Answer::Missed,
            };
        }
        match set.iter().position(|name| right.contains(name)) {
            Some(0) if set.len() == 1 => Answer::Named,
            Some(_) if set.len() <= LARGEST_SET => Answer::InSet,
            _ => Answer::Wrong,
        }
    }

    /// Whether all that is missing is among what was found.
    pub fn is_complete(&self) -> bool {
        let found = self.found();
        self.right().iter().all(|name| found.contains(name))
    }

    /// Overlap of the seconds that were found with the true ones.
    pub fn overlap(&self) -> Option<f64> {
        let acts = self.truth["drives"]["drive"]["acts"].as_array()?.first()?;
        let pair = |start: &Value, end: &Value| Some([start.as_f64()?, end.as_f64()?]);
        let truth = acts["intervals"].as_array()?.iter();
        let truth: Vec<[f64; 2]> = truth.filter_map(|one| pair(&one[0], &one[1])).collect();
        let right = self.right();
        let named = |one: &&Value| {
            one["effect"]
                .as_str()
                .is_some_and(|name| right.contains(&name))
        };
        let best = self.findings().iter().find(named);
        let best = best.or(self.findings().first());
        let places = best
            .and_then(|one| one["where"].as_array())
            .into_iter()
            .flatten();
        let found: Vec<[f64; 2]> = places
            .filter(|place| place["recording"] == "drive")
            .filter_map(|place| pair(&place["start"], &place["end"]))
            .collect();
        Some(overlap(&found, &truth))
    }

    /// Of the numbers that the truth and a finding of the same name tell, how many 90 % intervals hold the
    /// true one, and how many there are.
    pub fn intervals(&self) -> (usize, usize) {
        let (mut held, mut all) = (0, 0);
        for effect in self.truth["effects"].as_array().unwrap() {
            let same = |one: &&Value| one["effect"] == effect["effect"];
            for finding in self.findings().iter().filter(same) {
                for (name, truth) in effect["parameters"].as_object().unwrap() {
                    let end = |end: &str| finding["parameters"][name][end].as_f64();
                    if let (Some(low), Some(high)) = (end("low"), end("high")) {
                        let truth = truth.as_f64().unwrap();
                        held += usize::from(low <= truth && truth <= high);
                        all += 1;
                    }
                }
            }
        }
        (held, all)
    }

    /// Held-out log score per sample over the re-tuned model's, with the standard error.
    fn held_out(&self) -> Option<(f64, f64)> {
        let gain = &self.said["fit"]["held_out"]["gain"];
        Some((gain["value"].as_f64()?, gain["standard_error"].as_f64()?))
    }

    fn probability(&self) -> f64 {
        let first = self.findings().first();
        let nothing = self
            .candidates()
            .iter()
            .find(|one| one["effect"] == "nothing_missing");
        let told = first
            .or(nothing)
            .and_then(|one| one["probability"].as_f64());
        told.unwrap_or(f64::NAN)
    }

    /// What holds of every diagnosis.
    fn check(&self) {
        let name = &self.name;
        let each = self
            .candidates()
            .iter()
            .map(|one| one["probability"].as_f64().unwrap());
        let each: Vec<f64> = each.collect();
        assert!(
            each.iter().all(|p| (0.0..=1.0).contains(p)),
            "{name}: {each:?}"
        );
        let sum: f64 = each.iter().sum();
        assert!(
            (sum - 1.0).abs() < 1e-9,
            "{name}: the probabilities sum to {sum}"
        );
        assert_eq!(self.is_silent(), self.findings().is_empty(), "{name}");
        let claimed = self.findings().iter().any(|one| one["kind"] == "physics");
        if let Some((gain, error)) = self.held_out().filter(|_| claimed) {
            assert!(gain >= -error, "{name}: held out {gain} (se {error})");
        }
    }

    fn line(&self) -> String {
        let truth = self.effects().into_iter();
        let truth: Vec<String> = truth
            .map(|(name, size)| format!("{name} ({size})"))
            .collect();
        let variant = self.truth["variant"].as_str().unwrap_or_default();
        let alike = self.set().into_iter().skip(1).collect::<Vec<_>>().join("|");
        let mut line = String::new();
        let cell = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.2}"));
        let held_out = self.held_out().map_or("-".into(), |(gain, error)| {
            format!("{gain:+.4} ({error:.4})")
        });
        write!(
            line,
            "{:<17} {:<7} {:>6.1}  {:<17} {:>5.2}  {:>7}  {held_out:<16} {:>5.1}  {}; {}",
            self.name,
            format!("{:?}", self.answer()).to_lowercase(),
            self.signal(),
            self.verdict(),
            self.probability(),
            cell(self.overlap()),
            self.seconds,
            if truth.is_empty() {
                "nothing".into()
            } else {
                truth.join(" + ")
            },
            self.found().join(" + "),
        )
        .unwrap();
        if !alike.is_empty() {
            write!(line, " or {alike}").unwrap();
        }
        if !variant.is_empty() {
            write!(line, " [{variant}]").unwrap();
        }
        line + "\n"
    }
}

/// Intersection over union.
fn overlap(found: &[[f64; 2]], truth: &[[f64; 2]]) -> f64 {
    let mut edges: Vec<f64> = found.iter().chain(truth).flatten().copied().collect();
    edges.sort_by(f64::total_cmp);
    let (mut both, mut either) = (0.0, 0.0);
    for pair in edges.windows(2) {
        let holds = |all: &[[f64; 2]]| all.iter().any(|[a, b]| *a <= pair[0] && pair[1] <= *b);
        let inside = [holds(found), holds(truth)];
        let length = pair[1] - pair[0];
        both += if inside == [true; 2] { length } else { 0.0 };
        either += if inside == [false; 2] { 0.0 } else { length };
    }
    if either > 0.0 { both / either } else { 0.0 }
}
