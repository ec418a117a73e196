//! The whole command on a hundred drives whose truth is known, for hours:
//!
//! ```text
//! cargo test --release --test analysis suite -- --ignored --nocapture
//! ```
//!
//! Where a limit is missed, the table above the message shows the answer to each case; all files
//! stay in `target/tmp/diagnosis_suite`.

use super::cases::Family;
use super::told::{Answer, Told, diagnose, diagnosed, diagnosed_lasting, tool};
use std::collections::BTreeSet;
use std::fs;
use std::process::Command;
use ugv_terrain::effects::{CATALOGUE, EffectKind};

/// Answers that may be wrong, of 66 drives with one effect of the catalogue.
const EFFECTS_WRONG: usize = 10;
/// What shows as plainly as this \[standard deviations of the noise\] ...
const PLAIN: f64 = 8.0;
/// ... is named, and nothing else with it, this often.
const PLAIN_NAMED: f64 = 0.7;
/// Share of the 90 % intervals of what was named rightly that hold the true number.
const INTERVALS_HOLD: f64 = 0.75;
/// Found of what is not there, in 40 drives: 2.5 %.
const FALSE_ALARMS: usize = 1;
/// Wrong answers of 12 drives with two effects, of 5 with something for some seconds or on a patch, of
/// 5 with something outside of the catalogue, and of 8 look-alikes.
const PAIRS_WRONG: usize = 3;
const LOCAL_WRONG: usize = 2;
const OUTSIDE_WRONG: usize = 2;
const LOOKALIKES_WRONG: usize = 2;
/// Drives of 12 on which both effects are found.
const BOTH_FOUND: usize = 4;
/// Overlap of the seconds that were found with the true ones, in the middle of the cases.
const OVERLAP: f64 = 0.7;

/// Seconds that a drive lasts that has more stretches than fits begin on.
const LONG: [f64; 2] = [300.0, 310.0];

/// Seconds that a drive lasts that is longer than any interval that is scanned.
const OVER_FORTY: [f64; 2] = [50.0, 55.0];

/// The first cases of a family.
fn first(family: Family, count: usize) -> Vec<(Family, usize)> {
    (0..count).map(|number| (family, number)).collect()
}

fn count(told: &[Told], is: impl Fn(&Told) -> bool) -> usize {
    told.iter().filter(|one| is(one)).count()
}

/// At most so many answers are neither right nor honest.
fn assert_honest(told: &[Told], bound: usize) {
    let wrong = count(told, |one| !one.answer().is_honest());
    let all = told.len();
    assert!(
        wrong <= bound,
        "{wrong} of {all} answers are wrong, {bound} may be"
    );
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn every_effect_is_named_at_three_sizes() {
    let named = CATALOGUE
        .iter()
        .filter(|effect| !effect.name.starts_with("residual_"));
    let named: Vec<&str> = named.map(|effect| effect.name).collect();
    let physics = CATALOGUE.iter().filter(|effect| {
        let everywhere = effect.name != "terrain_change" && named.contains(&effect.name);
        effect.kind == EffectKind::Physics && everywhere
    });
    // Three rounds, each with every effect, which has another size in each.
    let mut all = first(Family::Single, 3 * physics.count());
    all.extend(first(Family::Sensor, 3 * 5));
    all.extend([0, 1, 4].map(|number| (Family::TerrainChange, number)));
    let told = diagnosed("every_effect", &all);
    let covered: BTreeSet<(&str, &str)> = told.iter().flat_map(Told::effects).collect();
    for name in named {
        for size in ["small", "medium", "large"] {
            assert!(covered.contains(&(name, size)), "there is no {size} {name}");
        }
    }
    assert_honest(&told, EFFECTS_WRONG);
    let plain = |one: &Told| one.signal() >= PLAIN;
    let share = count(&told, |one| plain(one) && one.answer() == Answer::Named) as f64
        / count(&told, plain) as f64;
    assert!(
        share >= PLAIN_NAMED,
        "{share:.2} of what shows plainly is named"
    );
    let right = told.iter().filter(|one| one.answer() == Answer::Named);
    let intervals: Vec<(usize, usize)> = right.map(Told::intervals).collect();
    let held: usize = intervals.iter().map(|one| one.0).sum();
    let all: usize = intervals.iter().map(|one| one.1).sum();
    println!("{held} of {all} intervals of 90 % hold the true number");
    assert!(
        all > 0 && held as f64 >= INTERVALS_HOLD * all as f64,
        "{held} of {all} intervals hold the true number"
    );
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn where_nothing_is_missing_nothing_is_found() {
    let told = diagnosed("nothing", &first(Family::Nothing, 40));
    let alarms = count(&told, |one| !one.found().is_empty());
    assert!(alarms <= FALSE_ALARMS, "{alarms} false alarms");
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn two_effects_are_found() {
    let told = diagnosed("pairs", &first(Family::Pair, 12));
    assert_honest(&told, PAIRS_WRONG);
    let both = count(&told, Told::is_complete);
    assert!(
        both >= BOTH_FOUND,
        "both are found on {both} of {} drives",
        told.len()
    );
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn what_acts_for_some_seconds_is_located() {
    let told = diagnosed("local", &first(Family::Local, 5));
    assert_honest(&told, LOCAL_WRONG);
    let mut overlaps: Vec<f64> = told.iter().filter_map(Told::overlap).collect();
    overlaps.sort_by(f64::total_cmp);
    assert_eq!(overlaps.len(), told.len());
    let middle = overlaps[overlaps.len() / 2];
    assert!(middle >= OVERLAP, "the seconds overlap by {middle:.2}");
    told.iter().for_each(drives);
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn what_the_catalogue_does_not_have_is_called_unknown() {
    let told = diagnosed("outside", &first(Family::Out, 5));
    assert_honest(&told, OUTSIDE_WRONG);
    let lawful = |one: &Told| {
        let model = fs::read_to_string(one.folder.join("out/model.json")).unwrap();
        model.contains("residual_")
    };
    assert!(count(&told, lawful) > 0, "no law was found");
    told.iter().for_each(drives);
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn the_way_back_parts_look_alikes() {
    // Every other one has a second drive, the other way round.
    let with_second = (0..16).step_by(2).map(|number| (Family::Lookalike, number));
    let all: Vec<_> = with_second.collect();
    let told = diagnosed("look_alikes", &all);
    assert!(
        told.iter()
            .all(|one| one.folder.join("drive2.csv").is_file())
    );
    assert_honest(&told, LOOKALIKES_WRONG);
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn what_one_of_two_drives_has_is_named_there() {
    let told = diagnosed_lasting(OVER_FORTY, "one_drive", &first(Family::OneDrive, 3));
    for one in &told {
        assert_eq!(one.answer(), Answer::Named, "{}", one.folder.display());
        let place = &one.said["findings"][0]["where"][0];
        assert_eq!(place["recording"], "drive2", "{place}");
        let [start, end] = ["start", "end"].map(|key| place[key].as_f64().unwrap());
        let all = one.truth["drives"]["drive2"]["seconds"].as_f64().unwrap();
        assert!(end - start > 0.9 * all, "{place} of {all} s");
    }
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn of_long_drives_a_part_tells_which_way_to_go() {
    let cases = [(Family::Pair, 5), (Family::Single, 0), (Family::Sensor, 1)];
    let told = diagnosed_lasting(LONG, "long", &cases);
    let named = count(&told, |one| one.answer() == Answer::Named);
    assert_eq!(named, told.len(), "long drives tell more than short ones");
    let complete = count(&told, Told::is_complete);
    assert_eq!(
        complete,
        told.len(),
        "what else is missing is found as well"
    );
}

#[test]
#[ignore = "nightly: diagnoses for minutes"]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let cases = [(Family::Single, 1), (Family::Pair, 0), (Family::Local, 1)];
    for one in diagnosed("threads", &cases) {
        let again = one.folder.join("again");
        diagnose(&one.folder, &again, 2);
        for file in ["diagnosis.json", "model.json"] {
            let read = |folder: &str| fs::read(one.folder.join(folder).join(file)).unwrap();
            assert!(
                read("out") == read("again"),
                "{} of {}",
                file,
                one.folder.display()
            );
        }
    }
}

/// The model that was found drives, is scored, and becomes an FMU.
fn drives(told: &Told) {
    let run = |arguments: &[&str]| {
        let mut command = Command::new(tool());
        command.current_dir(&told.folder).args(arguments);
        let output = command.output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success(),
            "{}: {arguments:?}: {errors}",
            told.folder.display()
        );
    };
    let model = ["--model", "out/model.json"];
    run(&[
        &[
            "simulate",
            "--input",
            "unseen.csv",
            "--output",
            "out/motion.csv",
        ],
        &model[..],
    ]
    .concat());
    run(&[
        &["score", "unseen.csv", "--json", "out/score.json"],
        &model[..],
    ]
    .concat());
    // The tool has in it what marks a library of the same version.
    let library = format!("linux64={}", tool().display());
    run(&[
        &["package", "--library", &library, "--output", "out/ugv.fmu"],
        &model[..],
    ]
    .concat());
}
