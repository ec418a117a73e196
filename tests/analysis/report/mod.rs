//! Every verdict as text, JSON and page.

mod sample;

use crate::formats;
use sample::{VERDICTS, sample};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::Duration;
use ugv_terrain::diagnosis::{
    Caution, Claim, ClaimLevel, Diagnosis, Insufficient, Subject, Verdict, phrase,
};
use ugv_terrain::inspection::{Doubt, DoubtKind, Span};
use ugv_terrain::recording::Channel as Measured;
use ugv_terrain::report::diagnosis::{self as report, Input, Source, headline, json, text};

/// Largest script of a page in bytes.
const MAX_SCRIPT: usize = 20_000;

/// A page of a diagnosis that was asked with names that need escapes.
fn page(diagnosis: &Diagnosis) -> String {
    let recordings = diagnosis.recordings.iter();
    let recordings = recordings.map(|name| (format!("{name}.csv"), 128.2));
    let input = Input {
        command: "ugv diagnose '<drive3>.csv' --terrain dry_sand".into(),
        recordings: recordings.collect(),
        vehicle: Source::Assumed,
        terrain: Source::Named("dry_sand".into()),
        limit: Some(Duration::from_secs(900)),
        folder: "out & more".into(),
        ..Input::default()
    };
    report::page(diagnosis, &input)
}

/// A text without line breaks.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What stands between two marks, each time.
fn between<'t>(text: &'t str, start: &str, end: &str) -> Vec<&'t str> {
    let pieces = text.split(start).skip(1);
    pieces
        .filter_map(|piece| Some(piece.split_once(end)?.0))
        .collect()
}

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
        assert!((5..=24).contains(&lines.len()), "{text}");
        for line in &lines {
            assert!(
                line.chars().count() <= 100 && line.trim_end() == *line,
                "{line}"
            );
        }
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    let text = words(&text(&sample(Verdict::MissingPhysics)));
    for part in [
        "The model lacks sloping ground (grade)",
        "the ground rises towards the east (slope_east) 1.78 deg (1.55 .. 2.01)",
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
    let of = |verdict| words(&text(&sample(verdict)));
    let ambiguous = of(Verdict::Ambiguous);
    assert!(
        ambiguous.contains("rut (multipass), a towed load (drawbar) or soil that springs back"),
        "{ambiguous}"
    );
    assert!(
        ambiguous.contains(
            "96 % for one of these: rear wheels in the front wheels' rut (multipass) 48 %"
        ),
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
    let latency = "delay of position and heading (spirals.pose) 0.180 s (0.160 .. 0.200)";
    assert!(sensor.contains(latency), "{sensor}");
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
            "NaN",
            "inf ",
            "src=",
            "href=",
            "url(",
            "@import",
            "<drive3",
            "fetch(",
            "innerHTML",
        ] {
            assert!(!page.contains(forbidden), "{name}: {forbidden}");
        }
        assert!(page.len() < 1_000_000, "{name}: {} bytes", page.len());
        for tag in [
            "figure", "svg", "table", "thead", "tbody", "div", "section", "details", "p", "tr",
            "td", "dl", "dt", "dd", "ul", "li", "pre", "code", "h1", "h2", "h3", "script",
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
        let law = "dM_Z / (m g B)";
        assert_eq!(page.contains(law), verdict == Verdict::UnknownPhysics);
        for candidate in &diagnosis.candidates {
            let cell = match candidate.subject {
                Subject::Unknown => "physics outside the catalogue (unknown)".into(),
                subject => phrase(subject),
            };
            assert!(page.contains(&format!(">{cell}</td>")), "{name}: {cell}");
        }
        assert_well_formed(&page, name);
        fs::write(folder.join(format!("{name}.html")), page).unwrap();
    }
}

/// One heading, unique names of sections, one small script, no address, and one colour for each model.
fn assert_well_formed(page: &str, name: &str) {
    assert_eq!(page.matches("<h1>").count(), 1, "{name}");
    let mut ids = between(page, " id=\"", "\"");
    for expected in ["input", "verdict", "candidates", "account"] {
        assert!(ids.contains(&expected), "{name}: {expected}");
    }
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "{name}: {ids:?}");
    let scripts = between(page, "<script>", "</script>");
    assert_eq!(scripts.len(), 1, "{name}");
    assert!(
        scripts[0].len() <= MAX_SCRIPT,
        "{name}: {} bytes",
        scripts[0].len()
    );
    // The name of the language of pictures is no address that is loaded.
    let addresses = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!addresses.contains("://"), "{name}");
    for (class, model) in [
        ("given", "as given"),
        ("refitted", "refitted"),
        ("mended", "mended"),
    ] {
        let entries = page.matches(&format!("</i>{model}</span>")).count();
        let coloured = page
            .matches(&format!("<i class=\"{class}\"></i>{model}</span>"))
            .count();
        assert_eq!(entries, coloured, "{name}: {model}");
        // On a light and on a dark page.
        assert_eq!(
            page.matches(&format!("--{class}:#")).count(),
            2,
            "{name}: {class}"
        );
        for bar in between(page, "<rect class=\"bar ", "\"") {
            assert!(
                ["b0", "b1", "b2", "given", "refitted", "mended"].contains(&bar),
                "{bar}"
            );
        }
    }
}

#[test]
fn the_input_stands_before_the_verdict() {
    let page = page(&sample(Verdict::MissingPhysics));
    let input = page.split("id=\"verdict\"").next().unwrap();
    for part in [
        "<code>ugv diagnose '&lt;drive3&gt;.csv' --terrain dry_sand</code>",
        "drive3.csv: 128.2 s, 90.0 s used",
        "490 kg on 8 wheels of 0.250 m radius, assumed",
        "from dry_sand",
        "1, 900 s",
    ] {
        assert!(input.contains(part), "{part}: {input}");
    }
}

#[test]
fn a_finding_is_stated_once() {
    let mut diagnosis = sample(Verdict::MissingPhysics);
    diagnosis.findings.truncate(1);
    let claim = |level, name, statement: &str, probability| Claim {
        level,
        name,
        statement: statement.into(),
        probability,
    };
    let named = "sloping ground (grade)";
    diagnosis.claims = vec![
        claim(ClaimLevel::Where, "gravity", "gravity on a slope", 0.97),
        claim(ClaimLevel::Mechanism, "grade", named, 0.962),
        claim(ClaimLevel::Formula, "grade", named, 0.8),
    ];
    let page = page(&diagnosis);
    let verdict = between(&page, "id=\"verdict\"", "</section>")[0];
    assert_eq!(verdict.matches(named).count(), 1, "{verdict}");
    assert_eq!(page.matches("(1.55 .. 2.01)").count(), 1);
    assert!(!page.contains(&diagnosis.statement));
    let text = text(&diagnosis);
    assert_eq!(text.matches(named).count(), 1, "{text}");
}

#[test]
fn what_now_has_checks_and_commands() {
    let next = |diagnosis: &Diagnosis| {
        let page = page(diagnosis);
        between(&page, "<section id=\"next\">", "</section>").concat()
    };
    let missing = next(&sample(Verdict::MissingPhysics));
    for part in [
        "sloping ground (grade): Measure the slope with an inclinometer",
        "an added load (payload): Weigh the vehicle",
        "Use the mended model",
        "ugv simulate --model 'out &amp; more/model.json' --input drive3.csv",
        "ugv package --model 'out &amp; more/model.json' --output ugv.fmu",
    ] {
        assert!(missing.contains(part), "{part}: {missing}");
    }
    // Every name of a set.
    let ambiguous = next(&sample(Verdict::Ambiguous));
    for name in ["(multipass): ", "(drawbar): ", "(elastic_rebound): "] {
        assert!(ambiguous.contains(name), "{name}: {ambiguous}");
    }
    let unknown = next(&sample(Verdict::UnknownPhysics));
    assert!(unknown.contains("pushes the vehicle sideways"), "{unknown}");
    assert!(next(&sample(Verdict::NothingMissing)).contains("Use the refitted model"));
    // Nothing was fitted.
    assert!(!next(&sample(Verdict::InsufficientData)).contains("Use the"));
}

#[test]
fn the_first_picture_has_all_models() {
    let page = page(&sample(Verdict::MissingPhysics));
    let paths = between(&page, "<section id=\"paths\">", "</section>")[0];
    let picture = between(paths, "<svg", "</svg>")[0];
    for class in ["measured", "given", "refitted", "mended"] {
        let drawn = format!("<path class=\"line {class}\" data-t=\"");
        assert_eq!(picture.matches(&drawn).count(), 1, "{class}");
    }
    // A time for each point that is drawn.
    for path in between(picture, "<path class=\"line ", "/>") {
        let times = between(path, "data-t=\"", "\"")[0].split(' ').count();
        let drawn = between(path, " d=\"", "\"")[0];
        assert_eq!(times, drawn.matches(['M', 'L']).count());
    }
    assert!(paths.contains("All 12 predictions."), "{paths}");
    let unknown = self::page(&sample(Verdict::UnknownPhysics));
    let paths = between(&unknown, "<section id=\"paths\">", "</section>")[0];
    assert!(
        !paths.contains("mended"),
        "a residual model without parameters: {paths}"
    );
}

#[test]
fn text_json_and_page_have_one_headline_and_its_colour() {
    let reasons = [
        Insufficient::TooLittle,
        Insufficient::TimeUp,
        Insufficient::Undecided,
    ];
    for verdict in VERDICTS {
        for reason in reasons {
            let mut diagnosis = sample(verdict);
            diagnosis.insufficient = diagnosis.insufficient.map(|_| reason);
            let headline = headline(&diagnosis);
            assert_eq!(parsed(&diagnosis)["headline"], *headline);
            assert!(words(&text(&diagnosis)).starts_with(&format!("{headline}.")));
            let page = page(&diagnosis);
            let expected = format!(
                "<h2 class=\"headline\">{}</h2>",
                headline.replace(" %", "&nbsp;%")
            );
            assert_eq!(page.matches(&expected).count(), 1, "{expected}");
            let colour = match verdict {
                Verdict::NothingMissing => "fine",
                Verdict::Sensor => "sensor",
                Verdict::InsufficientData => "open",
                _ => "found",
            };
            assert!(page.contains(&format!("<section id=\"verdict\" class=\"{colour}\">")));
            let is_fine = headline.starts_with("Nothing is missing");
            assert_eq!(is_fine, verdict == Verdict::NothingMissing);
        }
    }
}

#[test]
fn no_headline_hides_frozen_samples_or_a_doubt() {
    let doubt = |kind, channel, probability, left_out: &[Span]| Doubt {
        kind,
        channels: vec![channel],
        span: None,
        probability,
        left_out: left_out.to_vec(),
        evidence: "it stands still".into(),
        remedy: "Check it".into(),
    };
    let span = Span {
        run: 0,
        start: 20.0,
        end: 32.0,
    };
    let frozen = |channel| Caution::DoubtfulData {
        recording: "drive3".into(),
        doubt: doubt(DoubtKind::Frozen, channel, 0.97, &[span]),
    };
    for verdict in VERDICTS {
        let mut diagnosis = sample(verdict);
        let plain = headline(&diagnosis);
        let channels = [Measured::OmegaLeft, Measured::YawRate, Measured::OmegaLeft];
        diagnosis.cautions.extend(channels.map(frozen));
        let left_out = format!("{plain}; faulty samples of omega_left and yaw_rate are left out");
        assert_eq!(headline(&diagnosis), left_out);
        let minor = doubt(DoubtKind::Quantised, Measured::X, 0.4, &[]);
        diagnosis.minor_doubts.push(minor);
        let doubted = format!("{left_out}; 40 % that the data are wrong (quantised)");
        assert_eq!(headline(&diagnosis), doubted);
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
    diagnosis.runs[4].residuals[0].errors[1].fill(nan);
    diagnosis.runs[4].predicted[0].predicted[1].fill([nan; 2]);
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
        assert!(!text(&diagnosis).is_empty() && !page(&diagnosis).contains("id=\"findings\""));
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
        Caution::NotHeldOut,
    ];
    let (text, page) = (text(&diagnosis), page(&diagnosis));
    // Before anything else about the finding.
    let top = words(text.split("\nprobability").next().unwrap());
    let input = page.split("</section>").next().unwrap();
    assert_eq!(input.matches("class=\"banner\"").count(), 3);
    for words in [
        "Time was up before all candidates were fitted",
        "72 s of 600 s",
        "no time to compare the models on held-out data",
    ] {
        assert!(top.contains(words), "{text}");
        assert!(input.contains(words), "{input}");
    }
    let all = parsed(&diagnosis);
    let kinds = ["time_up", "part_of_recordings", "not_held_out"];
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
