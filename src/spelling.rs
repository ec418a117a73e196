//! The known name nearest to a misspelt one.

use std::cmp::Reverse;

/// No name is longer. The time to compare two words grows with the product of their lengths.
const MAX_LETTERS: usize = 64;

/// The candidate nearest to `word` by optimal string alignment: the number of letters that are inserted, deleted,
/// replaced or swapped with their neighbour. Upper and lower case count as equal, and only the first 64 letters count.
/// Of several candidates the longest wins, because a missing letter is likelier than an extra one.
#[must_use]
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let folded = |word: &str| -> String {
        word.chars()
            .flat_map(char::to_lowercase)
            .take(MAX_LETTERS)
            .collect()
    };
    let word = folded(word);
    candidates.into_iter().min_by_key(|candidate| {
        (
            strsim::osa_distance(&word, &folded(candidate)),
            Reverse(candidate.len()),
        )
    })
}

/// As [`nearest`], but only a candidate that is likely meant: at most a third of the letters of the word differ.
#[must_use]
pub fn nearest_within<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let found = nearest(word, candidates)?;
    let short = |word: &str| -> String { word.to_lowercase().chars().take(MAX_LETTERS).collect() };
    let (word, near) = (short(word), short(found));
    (3 * strsim::osa_distance(&word, &near) <= word.chars().count()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_the_likeliest() {
        let keys = ["wheel_radius", "wheel_width", "half_track"];
        assert_eq!(nearest("Wheel_Radus", keys), Some("wheel_radius"));
        assert_eq!(nearest("track", keys), Some("half_track"));
        assert_eq!(nearest("vx", ["x", "v_x"]), Some("v_x"));
        assert_eq!(nearest("amss", ["mss", "mass"]), Some("mass"));
        assert_eq!(nearest("x", []), None);
    }

    #[test]
    fn an_unlike_name_is_not_meant() {
        assert_eq!(
            nearest_within("omega_left", ["x", "omega_lef"]),
            Some("omega_lef")
        );
        assert_eq!(nearest_within("heading", ["x", "y", "yaw"]), None);
        assert_eq!(nearest_within("time", ["x", "y"]), None);
    }

    #[test]
    fn a_long_word_takes_no_more_work_than_its_first_letters() {
        let long = "mas".to_owned() + &"s".repeat(10_000_000);
        let used = allocation_counter::measure(|| {
            assert_eq!(nearest(&long, ["mass", "width"]), Some("mass"));
        });
        assert!(used.bytes_total < 1_000_000, "{used:?}");
    }
}
