//! Doubts about recordings, before a model is fitted to them or judged by them.

use crate::inspection::Doubt;
use crate::inspection::doubts::{PROBABLE, doubts, without};
use crate::recording::Recording;
use crate::report::number::percent;
use crate::vehicle::Vehicle;

/// The doubts about a recording, and the recording without the samples that they leave out.
pub fn settled(recording: Recording, vehicle: Option<&Vehicle>) -> (Recording, Vec<Doubt>) {
    let found = doubts(&recording, vehicle);
    let rest = without(&recording, &found);
    (rest, found)
}

/// The doubts that a user must know, each a line.
pub fn lines<'a>(name: &'a str, doubts: &'a [Doubt]) -> impl Iterator<Item = String> + 'a {
    let known = doubts.iter();
    let known = known.filter(|doubt| doubt.is_left_out() || doubt.probability >= PROBABLE);
    known.map(move |doubt| format!("doubt ({}): {name}: {doubt}", percent(doubt.probability)))
}
