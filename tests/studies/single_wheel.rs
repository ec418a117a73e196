//! Compares the contact law, with and without effects, with a real wheel in sand, and writes the
//! tables and the picture of `docs/explanation/single_wheel.md`:
//!
//! ```text
//! UGV_DATA=../shared/data cargo run --release --example single_wheel
//! ```

#[path = "wheel/data.rs"]
mod data;
#[path = "wheel/fit.rs"]
mod fit;
#[path = "wheel/judge.rs"]
mod judge;
#[path = "wheel/law.rs"]
mod law;
#[path = "wheel/picture.rs"]
mod picture;
#[path = "wheel/tables.rs"]
mod tables;

use data::{Data, Plate, Trial, scatter};
use fit::{Fit, fit};
use judge::Judged;
use law::{Believed, Effect, Flank, Growth, Law, Rig};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Mutex;
use tables::Line;
use ugv_terrain::contact::Detail;

/// An effect joins the best combination while it lowers the training cost by this share.
const WORTH: f64 = 0.05;
/// Between them the page's text is written by this program.
const MARKS: [&str; 2] = [
    "<!-- written by the example single_wheel -->",
    "<!-- end -->",
];

fn main() -> ExitCode {
    let data = match Data::read() {
        Ok(data) => data,
        Err(error) => {
            println!("skipped: the measured wheel is not there ({error}); UGV_DATA says where");
            return ExitCode::SUCCESS;
        }
    };
    let rig = Rig::new(Detail::Full);
    let (text, picture) = match study(&rig, &data) {
        Ok(found) => found,
        Err(error) => {
            eprintln!("single_wheel: {error}");
            return ExitCode::FAILURE;
        }
    };
    println!("{text}");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/explanation");
    let written = write(&folder.join("single_wheel.svg"), &picture)
        .and_then(|()| update(&folder.join("single_wheel.md"), &text));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("single_wheel: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Trials to fit and trials to judge by.
struct Halves<'s> {
    rig: &'s Rig,
    plates: &'s [Plate],
    scatter: [f64; 3],
    fitted: Vec<Trial>,
    judged: Vec<Trial>,
}

impl Halves<'_> {
    fn of(&self, keep: impl Fn(&Trial) -> bool) -> Self {
        let part = |trials: &[Trial]| trials.iter().filter(|t| keep(t)).cloned().collect();
        Halves {
            fitted: part(&self.fitted),
            judged: part(&self.judged),
            ..*self
        }
    }

    fn law(&self, effects: &[Effect]) -> Law {
        Law::new(effects, self.plates)
    }

    fn line(&self, law: &Law, name: String, from: &[&Fit]) -> Line {
        let fit = fit(self.rig, law, &self.fitted, self.scatter, from);
        eprintln!("fitted {name}: cost {:.1}", fit.cost);
        Line {
            judged: Judged::new(self.rig, &fit, &self.judged),
            name,
            fit,
        }
    }

    /// Several laws, on all processors.
    fn lines(&self, laws: Vec<(String, Law)>, from: &[&Fit]) -> Vec<Line> {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let (next, found) = (Mutex::new(laws.iter().enumerate()), Mutex::new(Vec::new()));
        std::thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(|| {
                    loop {
                        let Some((place, (name, law))) = next.lock().expect("no panic").next()
                        else {
                            return;
                        };
                        let line = self.line(law, name.clone(), from);
                        found.lock().expect("no panic").push((place, line));
                    }
                });
            }
        });
        let mut found = found.into_inner().expect("no panic");
        found.sort_by_key(|(place, _)| *place);
        found.into_iter().map(|(_, line)| line).collect()
    }
}

fn study(rig: &Rig, data: &Data) -> Result<(String, String), String> {
    let scatter = scatter(&data.trials);
    let plates = &data.plates;
    let halves = |second| Halves {
        rig,
        plates,
        scatter,
        fitted: data.half(second),
        judged: data.half(!second),
    };
    let first = halves(false);
    let named = |halves: &Halves, effects: &[Effect]| {
        let law = halves.law(effects);
        (law.name(), law)
    };

    // The paper's law, every effect alone, and the best combination by the training half alone.
    let alone: Vec<Vec<Effect>> = std::iter::once(vec![])
        .chain(Effect::ALL.map(|effect| vec![effect]))
        .chain([vec![Effect::SinkageGrowth, Effect::ExponentGrowth]])
        .collect();
    let mut table = first.lines(
        alone.iter().map(|effects| named(&first, effects)).collect(),
        &[],
    );
    let mut trail = Vec::new();
    let mut best = table[1..=Effect::ALL.len()]
        .iter()
        .min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))
        .map(|line| line.fit.clone())
        .ok_or("no effects")?;
    loop {
        let more = Effect::ALL
            .into_iter()
            .filter(|effect| !best.law.effects.contains(effect));
        let tried = more.map(|effect| named(&first, &[&best.law.effects[..], &[effect]].concat()));
        let tried = first.lines(tried.collect(), &[&best]);
        let Some(next) = tried
            .into_iter()
            .min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))
        else {
            break;
        };
        let worth = next.fit.cost < (1.0 - WORTH) * best.cost;
        if worth {
            best = next.fit.clone();
        }
        trail.push(next);
        if !worth {
            break;
        }
    }
    let all = first.line(&first.law(&Effect::ALL), "all six".into(), &[&best]);
    table.extend(trail);
    table.push(all);
    let best_at = table
        .iter()
        .position(|line| line.fit.law.effects == best.law.effects)
        .ok_or("the best law is not among them")?;

    // Other forms of two effects, in the best combination.
    let mut forms = Vec::new();
    let mut form = |name: &str, growth, flank| {
        let mut law = best.law.clone();
        (law.growth, law.flank) = (growth, flank);
        forms.push((name.to_owned(), law));
    };
    form("as in the library", Growth::Library, Flank::Library);
    form(
        "sinkage 1 + S s, s along and across",
        Growth::Linear,
        Flank::Library,
    );
    form(
        "sinkage (1 + S i)/(1 - S i/2), i along only",
        Growth::LyaskoAlong,
        Flank::Library,
    );
    form(
        "sinkage 1 + S i, i along only",
        Growth::LinearAlong,
        Flank::Library,
    );
    form("flank r - h cos(theta)", Growth::Library, Flank::Ishigami);
    let forms = first.lines(forms, &[&best]);

    // Each wheel by itself, and the halves exchanged.
    let mut others = Vec::new();
    let second = halves(true);
    let parts = [
        ("smooth wheel", first.of(|trial| !trial.grouser)),
        ("wheel with grousers", first.of(|trial| trial.grouser)),
        ("halves exchanged", second),
    ];
    for (name, part) in &parts {
        // One effect after the other, so that every step starts from where the last one ended.
        let effects = &best.law.effects;
        let mut line = part.line(&part.law(&[]), format!("{name}: the paper's law"), &[]);
        for count in 1..=effects.len() {
            let law = part.law(&effects[..count]);
            let next = part.line(&law, format!("{name}: best"), &[&line.fit, &best]);
            let before = std::mem::replace(&mut line, next);
            if count == 1 {
                others.push(before);
            }
        }
        others.push(line);
    }

    let believed = Believed::from_plates(plates);
    let growths = [Effect::SinkageGrowth, Effect::ExponentGrowth].map(|effect| {
        let alone = |line: &&Line| line.fit.law.effects == [effect];
        table
            .iter()
            .find(alone)
            .expect("every effect is fitted alone")
    });
    let constants = [
        &table[0],
        growths[0],
        growths[1],
        &table[best_at],
        &others[1],
        &others[3],
    ];
    let text = format!(
        "{} trials fitted, {} judged. Scatter between trials of one condition: {:.2} N traction, {:.2} N side \
         force, {:.2} mm sinkage. From the plates: n = {:.2} ± {:.2}, p(20 mm) = {:.1} kPa within {:.0} %.\n\n\
         ### Errors on the judged half\n\n{}\n\
         ### By how much the error is smaller than that of the paper's law\n\n{}\n\
         ### Other forms of the effects, in the best combination\n\n{}\n\
         ### Each wheel by itself, and the halves exchanged\n\n{}\n\
         ### Fitted constants\n\n{}",
        first.fitted.len(),
        first.judged.len(),
        scatter[0],
        scatter[1],
        1e3 * scatter[2],
        believed.exponent.0,
        believed.exponent.1,
        believed.log_pressure.0.exp(),
        100.0 * believed.log_pressure.1,
        tables::errors(&table),
        tables::gains(&table),
        tables::errors(&forms),
        tables::errors(&others),
        tables::constants(&constants),
    );
    let picture = picture::draw(rig, [&table[0], &table[best_at]], &first.judged)?;
    Ok((text, picture))
}

/// Puts the text between the page's marks.
fn update(page: &Path, text: &str) -> Result<(), String> {
    let fail = |what: &str| format!("{}: {what}", page.display());
    let old = std::fs::read_to_string(page).map_err(|error| fail(&error.to_string()))?;
    let start = old
        .find(MARKS[0])
        .ok_or_else(|| fail("no mark to begin at"))?
        + MARKS[0].len();
    let end = old[start..]
        .find(MARKS[1])
        .ok_or_else(|| fail("no mark to end at"))?
        + start;
    write(page, &format!("{}\n{text}\n{}", &old[..start], &old[end..]))
}

/// Writes a file beside its place, then puts it there.
fn write(path: &Path, text: &str) -> Result<(), String> {
    let beside = path.with_extension("part");
    let written = std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, path));
    written.map_err(|error| format!("{}: {error}", path.display()))
}
