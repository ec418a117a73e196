//! The page of all effects says what their declarations say.
//!
//! `UGV_BLESS=1 cargo test --test model page` writes it anew.

use super::generated::assert_current;
use std::fmt::Write as _;
use ugv_terrain::effects::{CATALOGUE, Declaration, EffectKind, Prior};

const PAGE: &str = "docs/reference/effects.md";
const COMMAND: &str = "cargo test --test model page";
const HEAD: &str = "\
# Effects

<!-- Written by `UGV_BLESS=1 cargo test --test model page` from the declarations in `src/effects/`. -->

The physics that the paper leaves out. Each effect is one file in `src/effects/`, generic over the scalar. `ugv simulate --effects FILE`
switches it on, `ugv fit` estimates it, and an FMU has its parameters. With all effects off the model is the paper's, bit for bit.

## How to read this page

**On and off.** An effect is on if one of its **bold** parameters differs from its default. The others shape it.

**Symbols** and equation numbers are the paper's. z is the sinkage (h in `bulldozing`). i is the slip
(r omega - V_X) / max(abs(r omega), abs(V_X)): -1 for a locked wheel, 1 for one that spins on the spot, up to 2 in size if
rim and travel oppose each other; smooth between. (The output `longitudinal_slip` is the paper's, (13), which divides by r omega.)
N is the number of wheels, b their width, B half the track, h_0 the sinkage under the axle, v_0 = 0.01 m/s. After Hegedus,
D1 = 2 q and D2 = q + q^2 tan phi, with q = sqrt(1 + tan^2 phi) + tan phi. The peak of the stress stays within 0.95 of the arc.
With `transient_shear`, the slip speed u at which the shear of a held wheel fades is 0.02 mm/s, and 1 mm/s for a rolling one:
u^2 grows with (r omega)^2/((r omega)^2 + (1 mm/s)^2).

**Outputs.** The reference point is the centre of mass of the given vehicle, without `payload` and `com_shift`: pose, velocities and
accelerations refer to it. Moments are about the actual centre of mass. Forces of `grade`, `drag`, `drawbar` and the
empirical residual models are in a_x, a_y and the yaw acceleration, not in R_r, M_r or the turning moment. Frontal bulldozing is in R_r, the
viscous force of `rate_dependent_soil` in the thrust. On a slope x and y lie along the surface: at 10 deg a map is 1.5 % shorter.

**Priors.** m ± s is normal. m ×/÷ f is log-normal, with ln f the standard deviation of the logarithm. `ugv fit` uses those of the physics;
`ugv diagnose` uses [others around \"off\"](../explanation/method.md#priors).

**Sensor faults** move no vehicle: a simulation and an FMU ignore them. `ugv fit` and `ugv diagnose` estimate them for each recording
under names such as `pose_latency` and `lever_arm_x`. `ugv fit --free help` prints their ranges and the 90 % intervals of their priors.
A latency may be negative there.

**In a file**, `grade` may have slopes along the drive, linear in between:
`\"profile\": {\"over\": \"time\" or \"distance\", \"points\": [[at, slope_east, slope_north], ...]}` or
`{\"over\": \"place\", \"x\": [...], \"y\": [...], \"slopes\": [[[slope_east, slope_north], ...], ...]}`.
`terrain_change` lies at a line on the map, or with `\"over\": \"time\"` or `\"over\": \"distance\"` at a time or a distance driven.
A `window` with hard edges confines effects to a time [s from the first row] or a place [m]:
`\"window\": {\"effects\": [\"drawbar\"], \"time\": [12.4, 21]}` (from 12.4 on, before 21) or
`{\"effects\": [\"drawbar\"], \"place\": {\"x\": 5, \"y\": 0, \"radius\": 2}}` (while the reference point is in the disc).
Outside it they are off, and the memory of vehicle and ground persists.
What acts over time or distance is for simulation and FMU: `ugv fit`, `score` and `diagnose` refuse it.

The `residual_*` are empirical residual models: they describe how physics outside this list acts, not what it is.
";

fn prior(prior: &Prior) -> String {
    match prior {
        Prior::Normal { mean, deviation } => format!("{mean} ± {deviation}"),
        Prior::LogNormal { median, deviation } => format!("{median} ×/÷ {:.2}", deviation.exp()),
    }
}

fn section(page: &mut String, effect: &Declaration) {
    let Declaration {
        name,
        lifts,
        equation,
        source,
        parameters,
        ..
    } = effect;
    writeln!(page, "\n### `{name}`\n").unwrap();
    writeln!(
        page,
        "- lifts: {lifts}\n- equation: `{equation}`\n- source: {source}\n"
    )
    .unwrap();
    writeln!(
        page,
        "| parameter | unit | range | default | prior | meaning |\n|---|---|---|---|---|---|"
    )
    .unwrap();
    for p in *parameters {
        let name = if p.switches {
            format!("**{}**", p.name)
        } else {
            p.name.to_owned()
        };
        writeln!(
            page,
            "| {name} | {} | {} .. {} | {} | {} | {} |",
            p.unit,
            p.low,
            p.high,
            p.default,
            prior(&p.prior),
            p.description
        )
        .unwrap();
    }
}

#[test]
fn the_page_says_what_the_declarations_say() {
    let mut page = HEAD.to_owned();
    for (kind, title) in [
        (EffectKind::Physics, "Physics"),
        (EffectKind::Measurement, "Sensor faults"),
    ] {
        writeln!(page, "\n## {title}").unwrap();
        for effect in CATALOGUE.iter().filter(|effect| effect.kind == kind) {
            section(&mut page, effect);
        }
    }
    assert_current(PAGE, COMMAND, &page);
}
