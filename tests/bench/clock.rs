//! Seconds of the processor, which do not count what other programs do meanwhile.

use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;

/// Rounds in which all works take turns; the best of each counts.
const ROUNDS: usize = 5;
/// Shortest measurement \[s\]: a short work is repeated.
const SHORTEST: f64 = 0.02;

/// Seconds that this process has used so far, on all threads.
pub fn processor() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Seconds of a call: of the processor, and on the clock.
#[derive(Debug, Clone, Copy)]
pub struct Cost {
    pub processor: f64,
    pub clock: f64,
}

fn cost(work: &mut dyn FnMut(), count: usize) -> Cost {
    let (start, used) = (Instant::now(), processor());
    (0..count).for_each(|_| work());
    Cost {
        processor: (processor() - used) / count as f64,
        clock: start.elapsed().as_secs_f64() / count as f64,
    }
}

/// What one call of each work costs. They take turns, so that a machine that slows down slows all of them.
pub fn compare(works: &mut [Box<dyn FnMut() + '_>]) -> Vec<Cost> {
    let count = |work: &mut Box<dyn FnMut() + '_>| {
        work();
        let once = cost(work, 1).processor;
        (SHORTEST / once.max(1e-9)).ceil().max(1.0) as usize
    };
    let counts: Vec<usize> = works.iter_mut().map(count).collect();
    let mut best = vec![
        Cost {
            processor: f64::INFINITY,
            clock: f64::INFINITY,
        };
        works.len()
    ];
    for _ in 0..ROUNDS {
        for ((work, count), best) in works.iter_mut().zip(&counts).zip(&mut best) {
            let now = cost(work, *count);
            best.processor = best.processor.min(now.processor);
            best.clock = best.clock.min(now.clock);
        }
    }
    best
}
