//! What a real wheel in sand says of the contact law and its effects (docs/explanation/single_wheel.md):
//! fitted to one half of the trials, judged by the other. Needs the data (`UGV_DATA`).

#[path = "../studies/wheel/data.rs"]
mod data;
#[path = "../studies/wheel/fit.rs"]
#[allow(dead_code, reason = "the study shows more of it")]
mod fit;
#[path = "../studies/wheel/judge.rs"]
#[allow(dead_code, reason = "the study shows more of it")]
mod judge;
#[path = "../studies/wheel/law.rs"]
#[allow(dead_code, reason = "the study shows more of it")]
mod law;

use self::data::{Data, scatter};
use self::fit::{Fit, fit};
use self::judge::Judged;
use self::law::{Effect, Law, Rig};
use crate::measured;
use ugv_terrain::contact::Detail;

const TRACTION: usize = 0;
const SIDE: usize = 1;
const SINKAGE: usize = 2;

/// Each effect must gain about two thirds of what it gains in the study: the margin leaves room
/// for coarser integrals and for a fit that ends elsewhere in a flat valley.
#[test]
fn effects_bring_the_law_nearer_to_a_real_wheel() {
    if measured::data("single_wheel").is_none() {
        return;
    }
    let data = Data::read().unwrap();
    let rig = Rig::new(Detail::Coarse);
    let (fitted, judged) = (data.half(false), data.half(true));
    let scatter = scatter(&data.trials);
    let mut last: Vec<Fit> = Vec::new();
    let mut of = |effects: &[Effect]| {
        let law = Law::new(effects, &data.plates);
        let found = fit(
            &rig,
            &law,
            &fitted,
            scatter,
            &last.iter().collect::<Vec<_>>(),
        );
        let judged = Judged::new(&rig, &found, &judged);
        last = vec![found];
        judged
    };
    let paper = of(&[]);
    let sinking = of(&[Effect::SinkageGrowth]);
    let rebounding = of(&[Effect::SinkageGrowth, Effect::Rebound]);
    let best = of(&[Effect::SinkageGrowth, Effect::Rebound, Effect::Bulldozing]);

    let gains = [
        ("slip_sinkage, sinkage", &sinking, &paper, SINKAGE, 0.40),
        (
            "elastic_rebound, traction",
            &rebounding,
            &sinking,
            TRACTION,
            0.12,
        ),
        ("bulldozing, side force", &best, &rebounding, SIDE, 0.25),
        ("all three, traction", &best, &paper, TRACTION, 0.30),
        ("all three, side force", &best, &paper, SIDE, 0.40),
    ];
    for (what, law, than, output, least) in gains {
        let gain = law.gain_over(than, output);
        println!("{what}: {:.0} % nearer", 100.0 * gain.value);
        assert!(gain.value > least, "{what}: {gain:?}");
    }
}
