//! What a fit costs: a minute of a four-wheeled vehicle's drive, made with the model itself.

#[path = "../analysis/fit/synthetic.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod synthetic;

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;
use synthetic::{QUIET, fitted, nominal, plain, record};
use ugv_terrain::fit::catalogue::DEFAULT_FREE;

fn fits(c: &mut Criterion) {
    let truth = nominal("sandy_loam");
    let begin = nominal("clayed_soil");
    let recording = [record(&truth, 60.0, &QUIET)];
    let mut group = c.benchmark_group("fit");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(30));
    group.bench_function("60 s, five soil parameters", |b| {
        b.iter(|| fitted(&begin, &DEFAULT_FREE, &recording, &plain()).unwrap());
    });
    group.finish();
}

criterion_group!(benches, fits);
criterion_main!(benches);
