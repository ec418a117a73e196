//! What a diagnosis was asked with, for its reader.

use crate::display::shell_quoted;
use crate::recording::Recording;
use std::path::Path;
use std::time::Duration;

/// The input of a diagnosis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Input {
    /// The command, ready to be repeated.
    pub command: String,
    /// The file of each recording, with its length \[s\].
    pub recordings: Vec<(String, f64)>,
    /// Whether the first is a robot's log.
    pub is_log: bool,
    /// The number of its runs.
    pub runs: usize,
    /// The arguments that say how the first is read.
    pub reading: Vec<String>,
    /// Where the vehicle is from.
    pub vehicle: Source,
    /// Where the terrain is from.
    pub terrain: Source,
    /// The time limit, if any.
    pub limit: Option<Duration>,
    /// Folder of the files that the diagnosis writes; empty if the caller keeps them.
    pub folder: String,
}

/// Where a part of the given model is from.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Source {
    /// From an argument.
    Named(String),
    /// From the file beside a recording.
    Recorded,
    /// Nobody named it: this one was assumed.
    #[default]
    Assumed,
}

impl Input {
    /// For a caller who knows no files: recordings have names, and arguments are not files.
    pub fn hide_files(&mut self, recordings: &[Recording]) {
        let names = recordings.iter().map(|one| one.name.clone());
        for ((file, _), name) in self.recordings.iter_mut().zip(names) {
            *file = name;
        }
        for source in [&mut self.vehicle, &mut self.terrain] {
            if matches!(source, Source::Named(path) if Path::new(path).exists()) {
                *source = Source::Named("an argument".into());
            }
        }
        self.folder.clear();
    }

    /// The commands that use the mended model, each with its purpose.
    pub(super) fn commands(&self) -> Vec<(&'static str, String)> {
        if self.folder.is_empty() {
            return Vec::new();
        }
        let model = Path::new(&self.folder).join("model.json");
        let model = shell_quoted(&model.display().to_string());
        let file = self.recordings.first().map_or("drive.csv", |one| &one.0);
        let reading = self.reading.iter().map(|argument| shell_quoted(argument));
        let reading: String = reading.map(|argument| format!(" {argument}")).collect();
        let mut commands = Vec::new();
        let mut input = format!("{}{reading}", shell_quoted(file));
        if self.is_log {
            commands.push((
                "Make a table of the log",
                format!("ugv import {input} --output drive.csv"),
            ));
            input = "drive.csv".into();
        }
        // A table of several drives is not one input.
        if self.runs < 2 {
            commands.push((
                "Simulate the drive",
                format!(
                    "ugv simulate --model {model} --input {input} --initial no-slip --output motion.csv"
                ),
            ));
        }
        commands.push((
            "Test it on another recording",
            format!("ugv score OTHER.csv --model {model}"),
        ));
        commands.push((
            "Package it as an FMU",
            format!("ugv package --model {model} --output ugv.fmu"),
        ));
        commands
    }
}

/// A command of its arguments, for a shell.
#[must_use]
pub fn command(arguments: impl Iterator<Item = String>) -> String {
    let arguments = arguments.map(|argument| shell_quoted(&argument));
    arguments.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_can_be_repeated() {
        let arguments = ["ugv", "diagnose", "my drive.csv", "it's", "a=b", ""];
        let text = command(arguments.into_iter().map(String::from));
        assert_eq!(text, r"ugv diagnose 'my drive.csv' 'it'\''s' a=b ''");
    }

    #[test]
    fn a_log_is_imported_before_it_is_simulated() {
        let input = |file: &str| Input {
            recordings: vec![(file.into(), 20.0)],
            folder: "out".into(),
            is_log: file.ends_with(".mcap"),
            ..Input::default()
        };
        let texts = |file| {
            let commands = input(file).commands().into_iter();
            commands.map(|(_, text)| text).collect::<Vec<_>>()
        };
        let expected = [
            "ugv simulate --model out/model.json --input a.csv --initial no-slip --output motion.csv",
            "ugv score OTHER.csv --model out/model.json",
            "ugv package --model out/model.json --output ugv.fmu",
        ];
        assert_eq!(texts("a.csv"), expected);
        assert_eq!(texts("a.mcap")[0], "ugv import a.mcap --output drive.csv");
        assert!(texts("a.mcap")[1].contains("--input drive.csv"));
        assert_eq!(texts("a.tsv")[0], expected[0].replace("a.csv", "a.tsv"));
        let read = Input {
            reading: ["--column", "omega_left=left wheel:rpm"]
                .map(String::from)
                .to_vec(),
            ..input("a.csv")
        };
        let options = "--input a.csv --column 'omega_left=left wheel:rpm' --initial";
        assert!(read.commands()[0].1.contains(options));
        // Several drives are no input, and a caller that writes no files has no commands.
        let several = Input {
            runs: 3,
            ..input("a.csv")
        };
        assert_eq!(several.commands().len(), 2);
        let folder = String::new();
        let kept = Input {
            folder,
            ..input("a.csv")
        };
        assert!(kept.commands().is_empty());
    }
}
