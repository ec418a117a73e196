//! Whether a recording can be what it claims: doubts about its data, to be asked before any name of physics.

mod clocks;
mod commands;
mod constant;
mod doubt;
mod dropouts;
mod expected;
mod jumps;
mod odometry;
mod pairs;
mod provenance;
mod ratios;
mod sides;
mod standing;
mod unsigned;

pub use doubt::{Doubt, DoubtKind, PROBABLE, Span};

use doubt::joined;

use crate::recording::{Channel, NoteKind, Recording, Run, Series};
use crate::vehicle::Vehicle;

/// From this probability on the recording is unfit as it is.
const NEARLY_SURE: f64 = 0.9;
/// Less likely doubts are not reported.
const WORTH_SAYING: f64 = 0.2;
/// Minimum driving for a diagnosis \[s\]: two segments to fit and two to hold out.
pub const SHORTEST: f64 = 10.0;

/// Whether a recording can be diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fitness {
    /// Nothing speaks against it.
    Fit,
    /// Something may be wrong, or is left out.
    WithDoubts,
    /// What is recorded cannot be right, or is too little.
    Unfit,
}

impl Fitness {
    /// The name in files and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fit => "yes",
            Self::WithDoubts => "with doubts",
            Self::Unfit => "no",
        }
    }
}

/// The doubts about a recording of a vehicle, the likeliest first.
///
/// Without a vehicle, ratios of wheel speeds to motion cannot be judged. The work is bounded: usually a second, up to
/// fifteen where no soil fits at once.
///
/// # Algorithm
/// 1. *Pairs.* Two sensors of one motion are compared by their mean rates over a second, at the delay of the highest
///    correlation. Their *ratio* goes through the origin; what it leaves unexplained is measured against the variation.
/// 2. *Copies.* Distance and heading that follow from the wheel speeds more exactly than slip allows were computed from
///    them.
/// 3. *Ratios.* Slip makes wheels roll further than the vehicle goes, by a share that depends on the soil, on
///    acceleration and on turning. The wheel speeds therefore drive the given vehicle over the soils of the paper, of
///    several stiffnesses. A factor on the wheel speeds, or on the track, has to explain the motion much better than the
///    best soil without one, and to exceed the model's own errors. Where the factor of a unit explains the motion as well
///    as the best number, it is the unit.
///    Before that, distance and turns are taken apart into what each side's wheels add, by least squares: a side that adds
///    with the wrong sign counts backwards; where both find that one side rolls by another factor, it has another unit or
///    gear.
///    A position that gets much farther than the wheels roll, while the turns agree with them, is in another unit.
/// 4. *Values.* Stretches of one value, single zeros, cut-off or coarse values and jumps are judged against the same channel
///    elsewhere. Wheel speeds without noise may be constant: there the turns have to contradict what both sides add
///    elsewhere.
/// 5. *Standstill.* Wheels, a gyro or a position that stay exactly where they are, though the others move, are broken.
/// 6. *Clocks.* Where two sensors of one motion agree at a delay of seconds, and nowhere near, their clocks differ.
/// 7. *Notes.* What the reader left as it is, and what the importer warned of, is a doubt as well.
///
/// A doubt that another one explains is dropped: a pose from the wheels fits neither the gyro nor any soil.
#[must_use]
pub fn doubts(recording: &Recording, vehicle: Option<&Vehicle>) -> Vec<Doubt> {
    doubts_until(recording, vehicle, &|| false)
}

/// The same until a caller's time `is_over`: from then on wheel speeds are no longer compared with soils.
#[must_use]
pub fn doubts_until(
    recording: &Recording,
    vehicle: Option<&Vehicle>,
    is_over: &(dyn Fn() -> bool + Sync),
) -> Vec<Doubt> {
    let vehicle = vehicle.or(recording.about.vehicle.as_ref());
    let commanded = commands::doubt(recording);
    let mut unread = joined(dropouts::doubts(recording));
    unread.extend(constant::frozen(recording).into_iter().filter(|doubt| {
        // Commands stay as they are.
        commanded.is_none() || !doubt.channels.iter().any(|channel| channel.is_required())
    }));
    let alive = without(recording, &unread);
    let mut found = odometry::doubts(&alive);
    let is_probable = |found: &[Doubt], kinds: &[DoubtKind]| {
        let mut probable = found.iter().filter(|doubt| doubt.probability >= PROBABLE);
        probable.any(|doubt| kinds.contains(&doubt.kind))
    };
    let is_own = is_probable(&found, &[DoubtKind::OwnOdometry]);
    found.extend(sides::mirrored(&alive));
    found.extend(unsigned::doubt(&alive));
    let is_signed = !is_probable(&found, &[DoubtKind::MirroredSide, DoubtKind::Unsigned]);
    if !is_own {
        found.extend(ratios::heading(&alive));
    }
    if is_signed && !is_own {
        found.extend(sides::factor(&alive));
        found.extend(vehicle.and_then(|vehicle| ratios::position(&alive, vehicle)));
    }
    let is_scaled = is_probable(&found, &[DoubtKind::PositionUnit]);
    if is_signed && !is_scaled && !is_probable(&found, &[DoubtKind::RollingRatio]) {
        found.extend(vehicle.and_then(|vehicle| ratios::wheels(&alive, vehicle, is_own, is_over)));
    }
    found.extend(unread);
    found.extend(constant::coarse(recording));
    // How far a position moves is judged in metres.
    if !is_scaled {
        found.extend(joined(standing::doubts(recording)));
        found.extend(jumps::doubts(&alive));
    }
    found.extend(clocks::doubts(&alive));
    found.extend(commanded);
    found.extend(provenance::doubts(recording));
    found.retain(|doubt| doubt.probability >= WORTH_SAYING);
    found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    found
}

/// Whether a recording can be diagnosed, and why not, in a clause.
#[must_use]
pub fn fitness(recording: &Recording, doubts: &[Doubt]) -> (Fitness, String) {
    let moved = Channel::ALL.into_iter().filter(|c| !c.is_required());
    let mut moved = moved.filter(|channel| !matches!(channel, Channel::AX | Channel::AY));
    if !moved.any(|channel| recording.has(channel)) {
        let why =
            "no motion is recorded beside the wheel speeds: add x, y and heading, or yaw_rate";
        return (Fitness::Unfit, why.into());
    }
    if recording.runs.iter().all(standing::never_turn) {
        let why = "the wheel speeds are zero throughout: there is nothing to diagnose, or they were not recorded";
        return (Fitness::Unfit, why.into());
    }
    let seconds: f64 = recording.runs.iter().map(Run::duration).sum();
    if seconds < SHORTEST {
        let why = format!(
            "it lasts {seconds:.1} s: a diagnosis needs {SHORTEST} s of driving, a minute with turns both ways is good"
        );
        return (Fitness::Unfit, why);
    }
    let Some(first) = doubts.first() else {
        let why = "nothing in it contradicts itself";
        let corrected = recording.notes.iter().any(|note| is_correction(note.kind));
        let how = if corrected {
            " after the corrections below"
        } else {
            ""
        };
        return (Fitness::Fit, format!("{why}{how}"));
    };
    let others = match doubts.len() - 1 {
        0 => String::new(),
        1 => " (and 1 more doubt)".into(),
        more => format!(" (and {more} more doubts)"),
    };
    let is_open = |doubt: &&Doubt| !doubt.is_left_out() && doubt.probability >= NEARLY_SURE;
    let is_source = |doubt: &&Doubt| doubt.kind != DoubtKind::Source;
    let unfit = doubts.iter().filter(is_open).find(is_source);
    match unfit {
        Some(worst) => (Fitness::Unfit, format!("{}{others}", worst.evidence)),
        None if first.probability >= PROBABLE => {
            let left_out = if first.is_left_out() {
                "; left out"
            } else {
                ""
            };
            let why = format!("{}{left_out}{others}", first.evidence);
            (Fitness::WithDoubts, why)
        }
        None => {
            let why = format!(
                "no doubt is likely; the likeliest: {}{others}",
                first.evidence
            );
            (Fitness::Fit, why)
        }
    }
}

/// Whether the reader changed what the values mean.
fn is_correction(kind: NoteKind) -> bool {
    matches!(
        kind,
        NoteKind::Unit | NoteKind::SwappedWheels | NoteKind::SwappedPosition | NoteKind::Sign
    )
}

/// The recording without the samples that doubts leave out.
#[must_use]
pub fn without(recording: &Recording, doubts: &[Doubt]) -> Recording {
    let mut rest = recording.clone();
    for doubt in doubts {
        for Span { run, start, end } in &doubt.left_out {
            for channel in &doubt.channels {
                let Some(series) = rest.runs[*run].series(*channel) else {
                    continue;
                };
                let kept = series.samples();
                let kept: Series = kept.filter(|(t, _)| t < start || t > end).collect();
                let shortened = std::mem::take(&mut rest.runs[*run]).with(*channel, kept);
                rest.runs[*run] = shortened;
            }
        }
    }
    rest
}

#[cfg(test)]
mod tests;
