//! The whole command on a hundred drives whose truth is known: minutes, and in release only.
//!
//! ```text
//! UGV_SUITE=whole cargo test --release --test diagnosis_suite -- --nocapture
//! ```
//!
//! `UGV_SUITE=third` runs a third of the cases of the large families, no `UGV_SUITE` some of every
//! family but the long drives; all by the same bounds.
//!
//! Where a limit is missed, the table above the message tells what was said of each case; all files
//! stay in `target/tmp/diagnosis_suite`.

use super::cases::Family;
use super::told::{Answer, Told, diagnose, diagnosed, diagnosed_lasting, tool};
use std::collections::BTreeSet;
use std::fs;
use std::process::Command;
use ugv_terrain::effects::{CATALOGUE, Kind};

/// Answers that may be wrong of so many drives with one effect of the catalogue.
const EFFECTS_WRONG: usize = 10;
const EFFECTS: usize = 66;
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

/// How many of the cases run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Some,
    Third,
    Whole,
}

impl Part {
    /// What `UGV_SUITE` names.
    fn asked() -> Self {
        match std::env::var("UGV_SUITE").as_deref() {
            Ok("whole") => Self::Whole,
            Ok("third") => Self::Third,
            Ok(other) => panic!("UGV_SUITE is {other}, where whole, third, or nothing is known"),
            Err(_) => Self::Some,
        }
    }

    /// Every so many-th case of a large family runs.
    fn step(self) -> usize {
        match self {
            Self::Some => 16,
            Self::Third => 3,
            Self::Whole => 1,
        }
    }
}

/// The first cases of a family.
fn first(family: Family, count: usize) -> Vec<(Family, usize)> {
    (0..count).map(|number| (family, number)).collect()
}

/// Those of these cases that run.
fn these(all: Vec<(Family, usize)>) -> Vec<(Family, usize)> {
    all.into_iter().step_by(Part::asked().step()).collect()
}

/// Those that run of what has one case or a few for each effect: all but where only some of everything runs.
fn these_few(all: Vec<(Family, usize)>) -> Vec<(Family, usize)> {
    let step = if Part::asked() == Part::Some { 5 } else { 1 };
    all.into_iter().step_by(step).collect()
}

/// The first five cases of a family, or three where only some of everything runs.
fn five_or_three(family: Family) -> Vec<(Family, usize)> {
    first(family, if Part::asked() == Part::Some { 3 } else { 5 })
}

/// What is so many of a whole family, of those that ran.
fn scaled(bound: usize, family: usize, told: &[Told]) -> f64 {
    bound as f64 * told.len() as f64 / family as f64
}

fn count(told: &[Told], is: impl Fn(&Told) -> bool) -> usize {
    told.iter().filter(|one| is(one)).count()
}

/// At most so many answers of a whole family are neither right nor honest.
fn assert_honest(told: &[Told], bound: usize, family: usize) {
    let wrong = count(told, |one| !one.answer().is_honest());
    let (all, most) = (told.len(), scaled(bound, family, told));
    assert!(
        wrong as f64 <= most,
        "{wrong} of {all} answers are wrong, {most:.1} may be"
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn every_effect_is_named_at_three_sizes() {
    let named = CATALOGUE
        .iter()
        .filter(|effect| !effect.name.starts_with("residual_"));
    let named: Vec<&str> = named.map(|effect| effect.name).collect();
    let physics = CATALOGUE.iter().filter(|effect| {
        let everywhere = effect.name != "terrain_change" && named.contains(&effect.name);
        effect.kind == Kind::Physics && everywhere
    });
    // Of three rounds, each with every effect and all sizes, the first; or some of that.
    let part = Part::asked();
    let rounds = if part == Part::Whole { 3 } else { 1 };
    let mut all = these_few(first(Family::Single, rounds * physics.count()));
    all.extend(these_few(first(Family::Sensor, rounds * 5)));
    let changes = [0, 1, 4].map(|number| (Family::TerrainChange, number));
    all.extend(changes.into_iter().take(rounds));
    let told = diagnosed("every_effect", &all);
    let covered: BTreeSet<(&str, &str)> = told.iter().flat_map(Told::effects).collect();
    // Some cases alone do not hold every effect in every size.
    for name in named.into_iter().filter(|_| part != Part::Some) {
        let sizes = ["small", "medium", "large"].map(|size| covered.contains(&(name, size)));
        let missing = sizes.iter().filter(|there| !**there).count();
        let may_miss = match part {
            Part::Whole => 0,
            Part::Third => 2,
            Part::Some => 3,
        };
        assert!(missing <= may_miss, "there is no {name} of {missing} sizes");
    }
    assert_honest(&told, EFFECTS_WRONG, EFFECTS);
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
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn where_nothing_is_missing_nothing_is_found() {
    let all = first(Family::Nothing, 40);
    let family = all.len();
    let told = diagnosed("nothing", &these(all));
    let alarms = count(&told, |one| !one.found().is_empty());
    assert!(
        alarms as f64 <= scaled(FALSE_ALARMS, family, &told),
        "{alarms} false alarms"
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn two_effects_are_found() {
    let all = first(Family::Pair, 12);
    let family = all.len();
    let told = diagnosed("pairs", &these(all));
    assert_honest(&told, PAIRS_WRONG, family);
    let both = count(&told, Told::is_complete);
    assert!(
        both as f64 >= scaled(BOTH_FOUND, family, &told),
        "both are found on {both} of {} drives",
        told.len()
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn what_acts_for_some_seconds_is_located() {
    let told = diagnosed("local", &five_or_three(Family::Local));
    assert_honest(&told, LOCAL_WRONG, 5);
    let mut overlaps: Vec<f64> = told.iter().filter_map(Told::overlap).collect();
    overlaps.sort_by(f64::total_cmp);
    assert_eq!(overlaps.len(), told.len());
    let middle = overlaps[overlaps.len() / 2];
    assert!(middle >= OVERLAP, "the seconds overlap by {middle:.2}");
    told.iter().for_each(drives);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn what_the_catalogue_does_not_have_is_called_unknown() {
    let told = diagnosed("outside", &five_or_three(Family::Out));
    assert_honest(&told, OUTSIDE_WRONG, 5);
    let lawful = |one: &Told| {
        let model = fs::read_to_string(one.folder.join("out/model.json")).unwrap();
        model.contains("residual_")
    };
    assert!(count(&told, lawful) > 0, "no law was found");
    told.iter().for_each(drives);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn the_way_back_parts_look_alikes() {
    // Every other one has a second drive, the other way round.
    let with_second = (0..16).step_by(2).map(|number| (Family::Lookalike, number));
    let all: Vec<_> = with_second.collect();
    let family = all.len();
    let told = diagnosed("look_alikes", &these(all));
    assert!(
        told.iter()
            .all(|one| one.folder.join("drive2.csv").is_file())
    );
    assert_honest(&told, LOOKALIKES_WRONG, family);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn what_one_of_two_drives_has_is_named_there() {
    let told = diagnosed_lasting(OVER_FORTY, "one_drive", &these(first(Family::OneDrive, 3)));
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
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn of_long_drives_a_part_tells_which_way_to_go() {
    if Part::asked() == Part::Some {
        println!("skipped: long drives run where UGV_SUITE is third or whole");
        return;
    }
    let cases = [(Family::Pair, 5), (Family::Single, 0), (Family::Sensor, 1)];
    let told = diagnosed_lasting(LONG, "long", &these(cases.into()));
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
#[cfg_attr(debug_assertions, ignore = "takes minutes; cargo test --release")]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let cases = [(Family::Single, 1), (Family::Pair, 0), (Family::Local, 1)];
    for one in diagnosed("threads", &these(cases.into())) {
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
