//! `ugv package` with libraries for several platforms, and what it merges.

use super::*;
use crate::libraries::{elf, pe};
use predicates::prelude::*;
use predicates::str::contains;
use std::io::{Cursor, Write};
use ugv_terrain::declaration::MARK;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

impl Bench {
    /// Writes what passes for a library of a platform.
    fn library(&self, name: &str, header: Vec<u8>) {
        self.write(name, [&header, MARK.as_bytes()].concat());
    }

    fn packaged(arguments: &str) -> Self {
        let bench = Self::new();
        bench.library("ugv.so", elf(62));
        bench.library("arm.so", elf(183));
        bench.library("ugv.dll", pe(0x8664));
        for (platform, file) in [
            ("linux64", "ugv.so"),
            ("aarch64-linux", "arm.so"),
            ("win64", "ugv.dll"),
        ] {
            let package = format!("package --library {platform}={file} --output {platform}.fmu");
            bench.ugv(&package).assert().success();
        }
        bench.ugv(arguments).assert().success();
        bench
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }
}

#[test]
fn merged_fmus_are_what_packaging_at_once_gives() {
    let bench = Bench::packaged(
        "package --library win64=ugv.dll --library aarch64-linux=arm.so --library linux64=ugv.so",
    );
    bench
        .ugv("package --merge win64.fmu linux64.fmu aarch64-linux.fmu --output merged.fmu")
        .assert()
        .success()
        .stdout("")
        .stderr(
            "ugv: merged.fmu written, with binaries/linux64/ugv.so, binaries/win64/ugv.dll, \
             binaries/aarch64-linux/ugv.so\n",
        );
    assert_eq!(bench.bytes("merged.fmu"), bench.bytes("ugv.fmu"));
    // Into one of them.
    let into = "package --merge win64.fmu merged.fmu --output win64.fmu";
    assert_contains(&bench.fails(into, 2), "win64.fmu exists");
    bench.ugv(&format!("{into} --force")).assert().success();
    assert_eq!(bench.bytes("win64.fmu"), bench.bytes("ugv.fmu"));
}

#[cfg(unix)]
#[test]
fn a_link_to_an_fmu_stays_a_link() {
    let bench = Bench::new();
    bench.library("ugv.so", elf(62));
    bench.write("real.fmu", "old");
    std::os::unix::fs::symlink("real.fmu", bench.path("link.fmu")).unwrap();
    let package = "package --library linux64=ugv.so --output link.fmu --force";
    bench.ugv(package).assert().success();
    assert!(bench.path("link.fmu").is_symlink());
    assert!(bench.bytes("real.fmu").starts_with(b"PK"));
}

/// Model exchange does not see states that depend on the path.
#[test]
fn an_fmu_for_co_simulation_alone_has_reasons() {
    let bench = Bench::new();
    bench.library("ugv.so", elf(62));
    let drag = r#""drag": {"coefficient": 9}"#;
    for (effects, why) in [
        (
            format!(
                r#"{{{drag}, "window": {{"effects": ["drag"], "place": {{"x": 1, "y": 0, "radius": 2}}}}}}"#
            ),
            ", for co-simulation alone (a window on the map)",
        ),
        (
            r#"{"multipass": {"memory": 1}, "transient_shear": {"relaxation": 1}}"#.to_owned(),
            ", for co-simulation alone (multipass, transient_shear)",
        ),
        (
            format!(r#"{{{drag}, "window": {{"effects": ["drag"], "time": [1, 2]}}}}"#),
            "",
        ),
    ] {
        bench.write("effects.json", &effects);
        for version in ["2", "3"] {
            let package = "package --library linux64=ugv.so --effects effects.json --fmi";
            bench
                .ugv(&format!("{package} {version} --output some.fmu --force"))
                .assert()
                .success()
                .stderr(format!("ugv: some.fmu written, for linux64{why}\n"));
            let fmu = std::io::Cursor::new(bench.bytes("some.fmu"));
            let mut fmu = zip::ZipArchive::new(fmu).unwrap();
            let mut text =
                |name: &str| std::io::read_to_string(fmu.by_name(name).unwrap()).unwrap();
            let exchange = text("modelDescription.xml").contains("<ModelExchange");
            assert_eq!(exchange, why.is_empty(), "{effects}");
            let documented =
                text("documentation/index.html").contains("co-simulation and model exchange");
            assert_eq!(documented, why.is_empty(), "{effects}");
        }
    }
}

#[test]
fn what_cannot_be_merged_is_named_and_nothing_is_written() {
    let bench =
        Bench::packaged("package --terrain dry_sand --library win64=ugv.dll --output sand.fmu");
    bench
        .ugv("package --library win64=ugv.dll --fmi 3 --output three.fmu")
        .assert()
        .success();
    bench.write("rubbish.fmu", "rubbish");
    // The same variables, built from another version.
    let older = MARK.rsplit_once(' ').unwrap().0;
    let older = format!("{older} 0.0.0\n");
    bench.write("old.dll", [pe(0x8664), older.into()].concat());
    let whole = bench.bytes("win64.fmu");
    bench.write("cut.fmu", &whole[..whole.len() / 2]);
    bench.write("merged.fmu", "precious");
    let files = bench.files();
    for (arguments, expected) in [
        (
            "--merge linux64.fmu sand.fmu",
            "modelDescription.xml differs between linux64.fmu and sand.fmu",
        ),
        (
            "--merge linux64.fmu three.fmu",
            "hint: package each with the same --fmi, ",
        ),
        (
            "--merge linux64.fmu cut.fmu",
            "cut.fmu is no FMU that can be read: ",
        ),
        ("--fmi 4", "invalid value '4' for '--fmi <VERSION>'"),
        (
            "--merge linux64.fmu rubbish.fmu",
            "rubbish.fmu is no FMU that can be read: ",
        ),
        (
            "--merge linux64.fmu nowhere.fmu",
            "cannot read nowhere.fmu: ",
        ),
        ("--merge linux64.fmu", "2 values"),
        (
            "--merge linux64.fmu win64.fmu --terrain dry_sand",
            "cannot be used with",
        ),
        (
            "--library linux64=ugv.dll",
            "the library for linux64 is not built for that platform",
        ),
        (
            "--library win64=old.dll",
            "the library for win64 was built from another version of ugv-terrain",
        ),
        (
            "--library amiga=ugv.dll",
            "expected PLATFORM=FILE with a PLATFORM of linux64",
        ),
    ] {
        let message = bench.fails(
            &format!("package {arguments} --force --output merged.fmu"),
            2,
        );
        assert_contains(&message, expected);
    }
    assert_eq!(bench.read("merged.fmu"), "precious");
    assert_eq!(bench.files(), files);
    bench
        .ugv("package --merge linux64.fmu win64.fmu --output nowhere/ugv.fmu")
        .assert()
        .code(1)
        .stderr(contains("cannot write nowhere/ugv.fmu: ").and(contains(
            "\nugv: hint: name a place in a folder that exists and is writable\n",
        )));
}

/// An archive with one more entry than an FMU has.
fn with_entry(fmu: &[u8], add: impl FnOnce(&mut ZipWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut zip = ZipWriter::new_append(Cursor::new(fmu.to_vec())).unwrap();
    add(&mut zip);
    zip.finish().unwrap().into_inner()
}

fn with_file(fmu: &[u8], name: &str, content: &[u8]) -> Vec<u8> {
    with_entry(fmu, |zip| {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(content).unwrap();
    })
}

/// Lets the last entry declare another size unpacked, in both of its headers.
fn declaring(mut fmu: Vec<u8>, size: u32) -> Vec<u8> {
    for (signature, at) in [(b"PK\x01\x02", 24), (b"PK\x03\x04", 22)] {
        let last = fmu
            .windows(4)
            .rposition(|bytes| bytes == signature)
            .unwrap();
        fmu[last + at..last + at + 4].copy_from_slice(&size.to_le_bytes());
    }
    fmu
}

#[test]
fn entries_that_lead_out_of_an_fmu_or_are_no_libraries_are_refused() {
    let bench = Bench::packaged("package --library win64=ugv.dll");
    let whole = bench.bytes("linux64.fmu");
    let file = |name: &str| with_file(&whole, name, b"text");
    let library =
        |folder: &str, content: &[u8]| with_file(&whole, &format!("binaries/{folder}"), content);
    let link = with_entry(&whole, |zip| {
        zip.add_symlink(
            "resources/link",
            "/etc/passwd",
            SimpleFileOptions::default(),
        )
        .unwrap();
    });
    for (fmu, entry, reason) in [
        (file("../evil.sh"), "../evil.sh", "leads out of the archive"),
        (
            file("resources/../../evil"),
            "resources/../../evil",
            "leads out",
        ),
        (file("/etc/cron.d/evil"), "/etc/cron.d/evil", "leads out"),
        (file("resources//evil"), "resources//evil", "leads out"),
        (file("C:/evil.dll"), "C:/evil.dll", "a backslash or a colon"),
        (
            file("resources\\evil"),
            "resources\\evil",
            "a backslash or a colon",
        ),
        (
            file("a\u{1b}[2Jb\nugv: c"),
            "a\\u{1b}[2Jb\\nugv: c",
            "control characters",
        ),
        (link, "resources/link", "a link or a device"),
        (
            library("win64/ugv.dll", b"#!/bin/sh"),
            "binaries/win64/ugv.dll",
            "no 64-bit shared library for win64",
        ),
        (
            library("win64/ugv.dll", &elf(62)),
            "binaries/win64/ugv.dll",
            "no 64-bit shared library for win64",
        ),
        (
            library("aarch64-linux/ugv.so", &elf(62)),
            "binaries/aarch64-linux/ugv.so",
            "for another processor",
        ),
        (
            library("win32/ugv.dll", &pe(0x014c)),
            "binaries/win32/ugv.dll",
            "no library that `ugv package` adds",
        ),
        (
            library("win64/other.dll", &pe(0x8664)),
            "binaries/win64/other.dll",
            "no library that `ugv package` adds",
        ),
        (
            declaring(file("resources/big"), u32::MAX - 1),
            "resources/big",
            "the archive unpacks to over 256 MB",
        ),
        (
            declaring(file("resources/big"), 3),
            "resources/big",
            "it does not unpack: ",
        ),
    ] {
        bench.write("evil.fmu", fmu);
        let message = bench.fails("package --merge win64.fmu evil.fmu --output merged.fmu", 2);
        let start = format!("ugv: error: evil.fmu: the entry `{entry}` is refused: ");
        assert!(message.starts_with(&start), "{message}");
        assert_contains(&message, reason);
        assert!(!bench.path("merged.fmu").exists(), "{entry}");
    }
}

#[test]
fn what_is_in_an_fmu_is_json_on_demand() {
    let bench = Bench::new();
    bench.library("ugv.so", elf(62));
    let json = |arguments: &str| -> serde_json::Value {
        serde_json::from_str(&bench.stdout(&format!("package {arguments} --json"))).unwrap()
    };
    let packaged = json("--library linux64=ugv.so -o one.fmu");
    formats::assert_documented(&packaged);
    assert_eq!(packaged["fmu"], "one.fmu");
    assert_eq!(packaged["platforms"][0], "linux64");
    bench.library("ugv.dll", pe(0x8664));
    json("--library win64=ugv.dll -o two.fmu");
    let merged = json("--merge one.fmu two.fmu -o both.fmu");
    formats::assert_documented(&merged);
    assert_eq!(merged["binaries"].as_array().unwrap().len(), 2);
    // No FMU is replaced unasked.
    let message = bench.fails("package --library linux64=ugv.so -o one.fmu", 2);
    assert_contains(&message, "one.fmu exists");
}
