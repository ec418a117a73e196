//! Every verdict as text, JSON and page.

mod sample;

use crate::formats;
use sample::{VERDICTS, sample};
use serde_json::Value;
use std::fs;
use std::path::Path;
use ugv_terrain::diagnosis::{Caution, Diagnosis, Insufficient, Subject, Verdict};
use ugv_terrain::report::diagnosis::{json, page, text};

fn parsed(diagnosis: &Diagnosis) -> Value {
    serde_json::from_str(&json(diagnosis)).expect("JSON")
}

#[test]
fn json_has_the_format_of_the_design() {
    let all = parsed(&sample(Verdict::MissingPhysics));
    assert_eq!(all["format"], "ugv-diagnosis/1");
    assert_eq!(all["verdict"], "missing_physics");
    let grade = &all["findings"][0];
    assert_eq!(grade["effect"], "grade");
    assert_eq!(grade["kind"], "physics");
    assert_eq!(grade["probability"], 0.962);
    assert_eq!(grade["ambiguous_with"], Value::Array(Vec::new()));
    let slope = &grade["parameters"]["slope_east"];
    assert_eq!(slope["value"], 0.031);
    assert_eq!(slope["low"], 0.027);
    assert_eq!(slope["high"], 0.035);
    assert_eq!(slope["unit"], "rad");
    let place = &grade["where"][0];
    assert_eq!(place["recording"], "drive3");
    assert_eq!(place["run"], 0);
    assert_eq!(place["start"], 12.4);
    assert_eq!(place["end"], 31.0);
    assert_eq!(place["channel"], "longitudinal");
    assert_eq!(place["regime"], "heading 60..120 deg");
    assert_eq!(place["patch"]["radius"], 4.0);
    assert!(grade["where"][1].get("patch").is_none());
    assert!(grade["statement"].as_str().unwrap().ends_with('.'));
    let held_out = &all["fit"]["held_out"];
    assert_eq!(held_out["nominal"]["position_rmse_m"], 0.41);
    assert_eq!(held_out["retuned"]["heading_rmse_rad"], 0.04);
    assert_eq!(held_out["augmented"]["log_score"], 1.9);
    assert_eq!(held_out["augmented"]["yaw_rate_rmse_rad_s"], Value::Null);
    assert_eq!(all["next_manoeuvre"], Value::Null);
    let cohesion = &all["fit"]["soil"][0];
    assert_eq!(cohesion["nominal"], 1040.0);
    let [refitted, augmented] =
        ["retuned", "augmented"].map(|key| cohesion[key]["value"].as_f64().unwrap());
    assert!(refitted > augmented, "{cohesion}");
}

#[test]
fn probabilities_sum_to_one() {
    for verdict in VERDICTS {
        let all = parsed(&sample(verdict));
        formats::assert_documented(&all);
        let candidates = all["candidates"].as_array().unwrap();
        let sum: f64 = candidates
            .iter()
            .map(|c| c["probability"].as_f64().unwrap())
            .sum();
        assert!((sum - 1.0).abs() < 1e-9, "{verdict:?}: {sum}");
        for name in ["nothing_missing", "unknown"] {
            let named = candidates.iter().filter(|c| c["effect"] == name);
            assert_eq!(named.count(), 1, "{name}");
        }
        assert_eq!(all["verdict"], verdict.name());
    }
}

#[test]
fn numbers_that_are_none_are_null() {
    let all = parsed(&sample(Verdict::NothingMissing));
    let candidates = all["candidates"].as_array().unwrap();
    assert_eq!(candidates[5]["smallest_detectable"], Value::Null);
    assert_eq!(candidates[7]["estimate"]["value"], Value::Null);
    let nothing = candidates
        .iter()
        .find(|c| c["effect"] == "nothing_missing")
        .unwrap();
    for key in [
        "absorbed_by_retuning",
        "parameter",
        "unit",
        "kind",
        "held_out_gain",
    ] {
        assert_eq!(nothing[key], Value::Null, "{key}");
    }
}

#[test]
fn each_recording_has_its_sensors() {
    let mut diagnosis = sample(Verdict::Sensor);
    let parameters = parsed(&diagnosis)["findings"][0]["parameters"].clone();
    assert_eq!(
        parameters["north_field_2024-05-17_afternoon.pose"]["value"],
        0.21
    );
    assert_eq!(parameters["spirals.pose"]["value"], 0.18);
    assert_eq!(parsed(&diagnosis)["findings"][0]["kind"], "sensor");
    diagnosis.recordings.truncate(1);
    diagnosis.findings[0].parameters.truncate(1);
    let parameters = parsed(&diagnosis)["findings"][0]["parameters"].clone();
    assert_eq!(parameters["pose"]["value"], 0.21);
}

#[test]
fn json_does_not_depend_on_the_machine() {
    let mut diagnosis = sample(Verdict::Ambiguous);
    let once = json(&diagnosis);
    for step in &mut diagnosis.account.steps {
        step.1 *= 3.7;
    }
    assert_eq!(json(&diagnosis), once);
    assert_ne!(page(&diagnosis), page(&sample(Verdict::Ambiguous)));
}

#[test]
fn the_text_is_short_and_has_the_main_facts() {
    for verdict in VERDICTS {
        let text = text(&sample(verdict));
        let lines: Vec<&str> = text.lines().collect();
        assert!((5..=16).contains(&lines.len()), "{text}");
        for line in &lines {
            assert!(
                line.chars().count() <= 100 && line.trim_end() == *line,
                "{line}"
            );
        }
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    let text = text(&sample(Verdict::MissingPhysics));
    for part in [
        "The model lacks sloping ground (grade)",
        "slope_east 1.78 deg (1.55 .. 2.01)",
        "drive3, 12.4 .. 31.0 s",
        "96 %",
        "0.41 m as given, 0.30 m refitted, 0.052 m mended",
        "took",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn the_text_of_other_verdicts_has_the_open_questions() {
    let of = |verdict| text(&sample(verdict));
    let ambiguous = of(Verdict::Ambiguous);
    assert!(
        ambiguous.contains("multipass, drawbar or elastic_rebound"),
        "{ambiguous}"
    );
    assert!(
        ambiguous.contains("96 % for one of these: multipass 48 %"),
        "{ambiguous}"
    );
    assert!(
        ambiguous.contains("opposite pass: Drive 20 m"),
        "{ambiguous}"
    );
    let nothing = of(Verdict::NothingMissing);
    assert!(nothing.contains("detectable"), "{nothing}");
    assert!(nothing.contains("undetectable"), "{nothing}");
    let unknown = of(Verdict::UnknownPhysics);
    let law = "dM_Z / (m g B) = -0.0270 |u| q + 0.0080";
    assert!(unknown.contains(law), "{unknown}");
    let sensor = of(Verdict::Sensor);
    assert!(sensor.starts_with("The sensors, not the soil"), "{sensor}");
    let words: Vec<&str> = sensor.split_whitespace().collect();
    let latency = "spirals.pose 0.180 s (0.160 .. 0.200)";
    assert!(words.join(" ").contains(latency), "{sensor}");
}

/// A page for every verdict stays in `target/tmp/report`, where tests/python/test_report.py looks.
#[test]
fn pages_are_whole() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    fs::create_dir_all(&folder).unwrap();
    for verdict in VERDICTS {
        let diagnosis = sample(verdict);
        let page = page(&diagnosis);
        let name = verdict.name();
        for forbidden in [
            "NaN", "inf ", "src=", "href=", "<script", "url(", "@import", "<drive3",
        ] {
            assert!(!page.contains(forbidden), "{name}: {forbidden}");
        }
        assert!(page.len() < 1_000_000, "{name}: {} bytes", page.len());
        for tag in [
            "figure", "svg", "table", "div", "section", "details", "p", "tr", "td",
        ] {
            let opened = page.matches(&format!("<{tag}>")).count()
                + page.matches(&format!("<{tag} ")).count();
            assert_eq!(
                opened,
                page.matches(&format!("</{tag}>")).count(),
                "{name}: {tag}"
            );
        }
        assert_eq!(page.contains("Drive next"), diagnosis.next.is_some());
        assert_eq!(
            page.contains("class=\"law\""),
            verdict == Verdict::UnknownPhysics
        );
        for candidate in &diagnosis.candidates {
            let cell = match candidate.subject {
                Subject::Nothing => "<td>nothing missing</td>".into(),
                subject => format!("<td>{}</td>", subject.name()),
            };
            assert!(page.contains(&cell), "{name}: {cell}");
        }
        fs::write(folder.join(format!("{name}.html")), page).unwrap();
    }
}

#[test]
fn unknown_numbers_are_not_shown() {
    let mut diagnosis = sample(Verdict::UnknownPhysics);
    let nan = f64::NAN;
    diagnosis.account.threshold = nan;
    diagnosis.account.overdispersion = nan;
    diagnosis.account.steps.clear();
    if let Some(held_out) = &mut diagnosis.held_out {
        held_out.augmented.position = nan;
        held_out.nominal.log_score = nan;
    }
    for term in &mut diagnosis.findings[0].law {
        term.coefficient.low = nan;
        term.coefficient.high = nan;
        term.stability = nan;
    }
    for (refitted, augmented) in &mut diagnosis.soil {
        (
            refitted.low,
            augmented.posterior_prior_ratio,
            augmented.value,
        ) = (nan, nan, nan);
    }
    for candidate in &mut diagnosis.candidates {
        (candidate.significance, candidate.absorbed) = (nan, nan);
        candidate.held_out_gain = Some((nan, nan));
    }
    diagnosis.runs[0].mismatch.fill(nan);
    diagnosis.runs[1].path.clear();
    diagnosis.runs[2].time.clear();
    diagnosis.runs[4].residuals[0].before.fill(nan);
    diagnosis.findings[0].probability = nan;
    for output in [text(&diagnosis), page(&diagnosis)] {
        assert!(!output.contains("NaN"), "{output}");
    }
    assert_eq!(parsed(&diagnosis)["account"]["threshold"], Value::Null);
    diagnosis.runs.clear();
    diagnosis.candidates.clear();
    diagnosis.findings.clear();
    for verdict in VERDICTS {
        diagnosis.verdict = verdict;
        assert!(!text(&diagnosis).is_empty() && !page(&diagnosis).contains("<h2>Found"));
    }
}

#[test]
fn the_map_marks_what_was_found() {
    let page = page(&sample(Verdict::MissingPhysics));
    for part in [
        "class=\"halo\"",
        "class=\"patch\"",
        "class=\"points\"",
        "class=\"step m0\"",
        "class=\"step m5\"",
        "class=\"span\"",
        "class=\"band\"",
        "only here",
        "x, east [m]",
        "dM_Z [N m]",
        "heading [deg]",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn of_many_runs_the_worst_are_plotted() {
    let diagnosis = sample(Verdict::UnknownPhysics);
    let page = page(&diagnosis);
    assert_eq!(
        page.matches("Mismatch of the refitted model").count(),
        2 * 4
    );
    assert!(page.contains("<h3>drive3 run 5</h3>"), "it has a place");
    assert!(page.contains("Plotted: 4 of 6 runs"));
}

#[test]
fn cautions_stand_beside_the_verdict() {
    let mut diagnosis = sample(Verdict::MissingPhysics);
    diagnosis.cautions = vec![
        Caution::TimeUp,
        Caution::Part {
            used: 72.0,
            of: 600.0,
        },
        Caution::assumed(&diagnosis.nominal.vehicle),
    ];
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (text, page) = (text(&diagnosis), page(&diagnosis));
    // Before anything else about the finding, and in the verdict's box.
    let top = words(text.split("\nprobability").next().unwrap());
    let verdict = page.split("</section>").next().unwrap();
    for words in [
        "Time was up before all candidates were fitted",
        "72 s of 600 s",
        "490 kg on 8 wheels",
    ] {
        assert!(top.contains(words), "{text}");
        assert!(verdict.contains(words), "{verdict}");
    }
    let all = parsed(&diagnosis);
    let kinds = ["time_up", "part_of_recordings", "assumed_vehicle"];
    let cautions = all["cautions"].as_array().unwrap();
    assert!(
        cautions
            .iter()
            .map(|one| one["kind"].as_str().unwrap())
            .eq(kinds)
    );
    assert_eq!(
        parsed(&sample(Verdict::MissingPhysics))["cautions"],
        Value::Array(Vec::new())
    );
}

#[test]
fn the_headline_has_the_reason_for_no_verdict() {
    let mut diagnosis = sample(Verdict::InsufficientData);
    for (why, headline) in [
        (
            Insufficient::TooLittle,
            "These recordings are not sufficient for a verdict.",
        ),
        (
            Insufficient::TimeUp,
            "The time limit was reached before a verdict.",
        ),
        (
            Insufficient::Undecided,
            "These recordings do not decide whether something is missing.",
        ),
    ] {
        diagnosis.insufficient = Some(why);
        let text = text(&diagnosis);
        assert!(text.starts_with(headline), "{text}");
        assert_eq!(parsed(&diagnosis)["insufficient"], why.name());
    }
}
