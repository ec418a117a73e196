//! The word that somebody meant who wrote another one.

use std::cmp::Reverse;

/// No name has more letters; the time to compare two words grows with the product of their lengths.
const LONGEST: usize = 64;

/// The candidate nearest to `word`: fewest letters inserted, deleted, replaced or swapped
/// with their neighbour, upper and lower case being the same; of several, the longest (a
/// letter left out is likelier than one too many). Of long words the first letters count.
#[must_use]
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters = |word: &str| -> Vec<char> {
        word.chars()
            .flat_map(char::to_lowercase)
            .take(LONGEST)
            .collect()
    };
    let word = letters(word);
    candidates.into_iter().min_by_key(|candidate| {
        (
            distance(&word, &letters(candidate)),
            Reverse(candidate.len()),
        )
    })
}

/// Optimal string alignment distance (Damerau–Levenshtein without edits between swapped letters).
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(before[j - 2] + 1);
            }
            row.push(best);
        }
        (before, above) = (above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_known_by_hand() {
        for (a, b, expected) in [
            ("", "", 0),
            ("", "mass", 4),
            ("mass", "mass", 0),
            ("mas", "mass", 1),
            ("amss", "mass", 1),
            ("kitten", "sitting", 3),
        ] {
            let [a, b]: [Vec<char>; 2] = [a, b].map(|word| word.chars().collect());
            let (a, b) = (&a[..], &b[..]);
            assert_eq!(distance(a, b), expected, "{a:?} {b:?}");
            assert_eq!(distance(b, a), expected, "{b:?} {a:?}");
        }
    }

    #[test]
    fn nearest_is_the_likeliest() {
        let keys = ["wheel_radius", "wheel_width", "half_track"];
        assert_eq!(nearest("Wheel_Radus", keys), Some("wheel_radius"));
        assert_eq!(nearest("track", keys), Some("half_track"));
        assert_eq!(nearest("vx", ["x", "v_x"]), Some("v_x"));
        assert_eq!(nearest("x", []), None);
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
