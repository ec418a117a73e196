//! Times of samples: header or log.

use super::collect::{StampedSample, Stream};
pub use super::sample::Clock;

/// Topics may have different clocks if their delays from measurement to logging differ by more than this \[ns\].
const LARGEST_DELAY_DIFFERENCE: i64 = 200_000_000;

/// A clock that goes back by more than this was set back \[ns\].
const SET_BACK: i64 = 1_000_000_000;

/// Apart from the first messages of a topic, one message, or one in this number, may lack its time of measurement. Such
/// messages are dropped.
const STRAY: usize = 100;

/// Times of measurement may span twice the span of the times of logging, plus this \[ns\].
const SPAN_TOLERANCE: i64 = 1_000_000_000;

/// Statistics of a topic's times.
pub(super) struct Times {
    topic: String,
    /// Number of messages without a stamp.
    unstamped: usize,
    /// Number of them before the first with a stamp.
    leading: usize,
    messages: usize,
    /// Median delay from measurement to logging \[ns\].
    delay: Option<i64>,
    /// Spans of the times of measurement and of logging \[ns\].
    spans: [i64; 2],
}

impl Times {
    pub fn of<T>(stream: &Stream<T>) -> Self {
        let stamped = stream.samples.iter().filter(|sample| sample.stamp != 0);
        let delays = stamped.clone();
        let mut delays: Vec<i64> = delays.map(|sample| sample.logged - sample.stamp).collect();
        let unstamped = stream.samples.len() - delays.len();
        let leading = stream.samples.iter();
        let leading = leading.take_while(|sample| sample.stamp == 0).count();
        delays.sort_unstable();
        Self {
            topic: stream.topic.name.clone(),
            unstamped,
            leading,
            messages: stream.samples.len(),
            delay: delays.get(delays.len() / 2).copied(),
            spans: [
                span(stamped.map(|sample| sample.stamp)),
                span(stream.samples.iter().map(|sample| sample.logged)),
            ],
        }
    }

    /// Whether the messages without a stamp are few enough to be dropped.
    fn can_drop_unstamped(&self) -> bool {
        let stray = self.unstamped - self.leading;
        2 * self.unstamped <= self.messages && (stray <= 1 || stray * STRAY <= self.messages)
    }
}

fn span(times: impl Iterator<Item = i64> + Clone) -> i64 {
    let last = times.clone().max().unwrap_or(0);
    last - times.min().unwrap_or(0)
}

/// The common clock of topics, with notes.
pub(super) fn settle(asked: Clock, topics: &[Times]) -> (Clock, Vec<String>) {
    if asked == Clock::Log {
        return (Clock::Log, Vec::new());
    }
    let unstamped: Vec<String> = topics
        .iter()
        .filter(|times| times.unstamped > 0)
        .map(|times| {
            format!(
                "{} of {} of {}",
                times.unstamped, times.messages, times.topic
            )
        })
        .collect();
    if !topics.iter().all(Times::can_drop_unstamped) {
        let note = format!(
            "warning: messages without a time of measurement ({}): the time of logging is taken for all \
             topics",
            unstamped.join(", ")
        );
        return (Clock::Log, vec![note]);
    }
    let mut delays: Vec<(i64, &str)> = topics
        .iter()
        .filter_map(|times| Some((times.delay?, times.topic.as_str())))
        .collect();
    delays.sort_unstable();
    let strayed = topics.iter().filter(|times| {
        let [measured, logged] = times.spans;
        measured / 2 > logged + SPAN_TOLERANCE
    });
    let stray = (!unstamped.is_empty()).then(|| {
        let which = unstamped.join(", ");
        format!("messages without a time of measurement ({which}) are left out")
    });
    let strayed = strayed.map(|times| {
        format!(
            "warning: the times of measurement of {} span {:.0} s, those of logging {:.0} s: the clock \
             was set during the drive, or some are wrong; --time log takes the time of logging",
            times.topic,
            times.spans[0] as f64 * 1e-9,
            times.spans[1] as f64 * 1e-9
        )
    });
    let mut notes: Vec<String> = stray.into_iter().chain(strayed).collect();
    if let (Some((min, first)), Some((max, last))) = (delays.first(), delays.last())
        && max.saturating_sub(*min) > LARGEST_DELAY_DIFFERENCE
    {
        notes.push(format!(
            "{last} is logged {:.3} s after its header's time, {first} {:.3} s: their clocks may \
             differ; --time log takes the time of logging",
            *max as f64 * 1e-9,
            *min as f64 * 1e-9
        ));
    }
    (Clock::Header, notes)
}

/// The samples of a topic sorted by time without repeats, and a note on the changes. Of samples with equal times the first
/// is kept; `fills` completes it from the others and returns whether it did.
pub(super) fn ordered<T>(
    stream: Stream<T>,
    clock: Clock,
    fills: impl Fn(&mut T, &T) -> bool,
) -> (Vec<(i64, T)>, Option<String>) {
    let topic = stream.topic.name;
    let samples = stream.samples.into_iter();
    let has_time = |sample: &StampedSample<T>| clock == Clock::Log || sample.stamp != 0;
    let mut samples: Vec<(i64, T)> = samples
        .filter(has_time)
        .map(|sample| (clock.of(&sample), sample.value))
        .collect();
    let steps_back = samples.windows(2).filter(|pair| pair[1].0 < pair[0].0);
    let set_back = samples.windows(2).map(|pair| pair[0].0 - pair[1].0).max();
    let set_back = set_back.filter(|back| *back > SET_BACK);
    let steps_back = steps_back.count();
    samples.sort_by_key(|(time, _)| *time);
    let before = samples.len();
    let mut filled = "";
    samples.dedup_by(|later, first| {
        let same = later.0 == first.0;
        if same && fills(&mut first.1, &later.1) {
            filled = ", with what it lacked from the others";
        }
        same
    });
    let repeated = before - samples.len();
    let note = match (steps_back, repeated) {
        (0, 0) => None,
        (0, _) => Some(format!(
            "{topic}: {repeated} of {before} messages repeat a time; the first of each is kept{filled}"
        )),
        (_, 0) => Some(format!(
            "{topic}: its time steps back {steps_back} times; its messages were sorted"
        )),
        _ => Some(format!(
            "{topic}: its time steps back {steps_back} times and {repeated} of {before} messages \
             repeat a time; they were sorted, the first of each is kept{filled}"
        )),
    };
    let note = match (set_back, note) {
        (Some(back), Some(note)) => Some(format!(
            "warning: {note}; its clock was set back by {:.0} s, so stretches of the drive may overlap: \
             --time log takes the time of logging",
            back as f64 * 1e-9
        )),
        (_, note) => note,
    };
    (samples, note)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::container::Connection;

    fn stream(name: &str, times: &[(i64, i64)]) -> Stream<usize> {
        let channel = Connection {
            topic: name.into(),
            message_type: String::new(),
            encoding: String::new(),
        };
        let sample = |(value, (stamp, logged)): (usize, &(i64, i64))| StampedSample {
            stamp: *stamp,
            logged: *logged,
            value,
        };
        Stream {
            topic: crate::import::survey::Topic::new(&channel, 0),
            joined: Vec::new(),
            child_frame: String::new(),
            samples: times.iter().enumerate().map(sample).collect(),
        }
    }

    #[test]
    fn samples_are_sorted_and_the_first_of_a_time_stays() {
        let stream = stream("/a", &[(10, 1), (30, 2), (20, 3), (30, 4)]);
        let (samples, note) = ordered(stream.clone(), Clock::Header, |_, _| false);
        assert_eq!(samples, [(10, 0), (20, 2), (30, 1)]);
        assert!(note.unwrap().contains("steps back 1 times and 1 of 4"));
        let (samples, note) = ordered(stream, Clock::Log, |_, _| false);
        assert_eq!(samples, [(1, 0), (2, 1), (3, 2), (4, 3)]);
        assert_eq!(note, None);
    }

    #[test]
    fn messages_of_one_time_complete_each_other() {
        let stream = stream("/a", &[(10, 1), (10, 2), (20, 3), (10, 4)]);
        let sum = |first: &mut usize, other: &usize| {
            *first += other;
            true
        };
        let (samples, note) = ordered(stream, Clock::Header, sum);
        assert_eq!(samples, [(10, 1 + 3), (20, 2)]);
        assert!(
            note.unwrap()
                .ends_with("with what it lacked from the others")
        );
        let joint = |position, velocity| crate::import::collect::JointSample {
            position,
            velocity,
            load: 0.5,
        };
        let mut arm = joint(f64::NAN, 2.0);
        assert!(arm.fill_from(&joint(1.0, 3.0)));
        assert_eq!(arm, joint(1.0, 2.0));
        assert!(!arm.fill_from(&joint(5.0, 6.0)));
    }

    #[test]
    fn one_topic_without_stamps_puts_all_on_the_time_of_logging() {
        let second = 1_000_000_000;
        let good = Times::of(&stream("/good", &[(second, second + 5), (2 * second, 0)]));
        let bare = Times::of(&stream("/bare", &[(0, 7), (0, 8)]));
        let (clock, notes) = settle(Clock::Header, &[good, bare]);
        assert_eq!(clock, Clock::Log);
        assert!(
            notes[0].starts_with("warning: ") && notes[0].contains("2 of 2 of /bare"),
            "{notes:?}"
        );
        // A few are dropped and change nothing else.
        let mut many: Vec<(i64, i64)> = (1..200).map(|k| (k * second, k * second)).collect();
        many.insert(0, (0, 5));
        let many = stream("/many", &many);
        let (clock, notes) = settle(Clock::Header, &[Times::of(&many)]);
        assert_eq!(clock, Clock::Header);
        assert!(
            notes[0].contains("1 of 200 of /many) are left out"),
            "{notes:?}"
        );
        let (samples, note) = ordered(many, clock, |_, _| false);
        assert_eq!((samples.len(), samples[0], note), (199, (second, 1), None));
    }

    #[test]
    fn a_start_without_stamps_and_one_more_message_are_dropped() {
        let topic = |stamps: &[i64]| {
            let logged = stamps.iter().zip(1..);
            let times: Vec<(i64, i64)> = logged.map(|(stamp, time)| (*stamp, time)).collect();
            Times::of(&stream("/few", &times))
        };
        for (stamps, clock) in [
            ([0, 0, 0, 4, 5, 6, 7, 0, 9], Clock::Header),
            ([1, 0, 3, 4, 5, 6, 7, 8, 9], Clock::Header),
            ([1, 0, 3, 0, 5, 6, 7, 8, 9], Clock::Log),
            ([0, 0, 0, 0, 0, 6, 7, 8, 9], Clock::Log),
        ] {
            let (found, notes) = settle(Clock::Header, &[topic(&stamps)]);
            assert_eq!((found, notes.len()), (clock, 1), "{stamps:?}: {notes:?}");
        }
    }

    #[test]
    fn a_clock_that_is_set_back_is_a_warning() {
        let second = 1_000_000_000;
        let times: Vec<(i64, i64)> = (0..60)
            .map(|k| {
                (
                    k * second - if k < 40 { 0 } else { 30 * second } + 1,
                    k * second,
                )
            })
            .collect();
        let (samples, note) = ordered(stream("/gps", &times), Clock::Header, |_, _| false);
        assert_eq!(samples.len(), 40);
        let note = note.unwrap();
        assert!(
            note.starts_with("warning: ") && note.contains("by 29 s"),
            "{note}"
        );
    }

    #[test]
    fn different_clocks_are_noted() {
        let near = Times::of(&stream("/near", &[(100, 200)]));
        let far = Times::of(&stream("/far", &[(100, 18_000_000_100)]));
        let (clock, notes) = settle(Clock::Header, &[far, near]);
        assert_eq!(clock, Clock::Header);
        assert!(notes[0].starts_with("/far is logged 18.000 s"), "{notes:?}");
        assert!(settle(Clock::Header, &[]).1.is_empty());
        let second = 1_000_000_000;
        let set = stream(
            "/gps",
            &[
                (second, 0),
                (900 * second, second),
                (901 * second, 2 * second),
            ],
        );
        let (_, notes) = settle(Clock::Header, &[Times::of(&set)]);
        assert!(notes[0].contains("of /gps span 900 s"), "{notes:?}");
    }
}
