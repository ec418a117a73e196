//! CSV files as programs and people write them: every command reads them in the same way.

use super::*;

/// The usual drive with a pose, under other names and in other units.
fn spoiled() -> String {
    let mut text = String::from("sep=;\r\nt [ms];wl_rpm;right;posX;posY;yaw_deg\r\n");
    for row in 0..400 {
        let time = 0.05 * f64::from(row);
        let turn = (0.7 * time).sin();
        let rpm = |speed: f64| speed * 30.0 / std::f64::consts::PI;
        text += &format!(
            "{:.0};{:.4};{:.4};{:.4};0;{:.4}\r\n",
            1e3 * time,
            rpm(4.0 - turn),
            rpm(4.0 + turn),
            1.1 * time,
            (0.2 - 0.2 * (0.7 * time).cos()).to_degrees()
        )
        .replace('.', ",");
    }
    text
}

#[test]
fn names_units_and_separators_of_others_are_read_by_every_command() {
    let bench = Bench::new();
    bench.write("log.csv", spoiled());
    let named = "--column omega_right=right:rpm";
    let shown = bench.stdout(&format!("inspect log.csv {named}"));
    for note in [
        "omega_left: taken from column `wl_rpm` [rpm]",
        "omega_right: taken from column `right` [rpm]",
        "heading: taken from column `yaw_deg` [deg]",
        "x: taken from column `posX`, without a unit, as [m]",
        "time: taken from column `t [ms]` [ms]",
    ] {
        assert_contains(&shown, note);
    }
    let out = "--terrain sandy_loam --output motion.csv --force";
    let done = bench.ugv(&format!("simulate --input log.csv {named} {out}"));
    let done = { done }.assert().success();
    let notes = String::from_utf8(done.get_output().stderr.clone()).unwrap();
    assert_contains(&notes, "note: omega_left: taken from column `wl_rpm` [rpm]");
    let motion = bench.read("motion.csv");
    let first = &numbers(&motion)[0];
    assert!((first[1] - 4.0).abs() < 1e-4 && (first[2] - 4.0).abs() < 1e-4);
    let quiet = bench.ugv(&format!("simulate --input log.csv {named} {out} --quiet"));
    { quiet }.assert().success().stderr("");
    // What is not known is asked for, with the column that may be meant.
    for command in [
        "inspect log.csv",
        "simulate --input log.csv",
        "score log.csv",
        "fit log.csv",
    ] {
        let message = bench.fails(command, 2);
        assert_contains(
            &message,
            "`right` may be it: --column omega_right=right:UNIT",
        );
    }
    let message = bench.fails("inspect log.csv --column omega_right=rigt:rpm", 2);
    assert_contains(&message, "the nearest is `right`");
    let message = bench.fails("inspect log.csv --column omega_right", 2);
    assert_contains(&message, "NAME=COLUMN");
}

#[test]
fn a_missing_header_is_explained_and_columns_have_numbers() {
    let bench = Bench::new();
    bench.write("bare.csv", "0,1,2\n0.5,3,4\n1,5,6\n");
    let message = bench.fails("simulate --input bare.csv", 2);
    assert_contains(&message, "found a row without a header");
    assert_contains(
        &message,
        "--column time=#1 --column omega_left=#2 --column omega_right=#3",
    );
    let motion = bench.stdout(
        "simulate --input bare.csv --column time=#1 --column omega_left=#3 --column omega_right=#2 --quiet",
    );
    assert_eq!(numbers(&motion)[0][..3], [0.0, 2.0, 1.0]);
}

#[test]
fn a_hint_is_an_argument_that_a_shell_takes() {
    let bench = Bench::new();
    bench.write("log.csv", "time,omega lft,omega_right\n0,1,1\n1,1,1\n");
    let message = bench.fails("inspect log.csv", 2);
    assert_contains(
        &message,
        "`omega lft` may be it: --column 'omega_left=omega lft:UNIT'",
    );
}
