//! The page of all effects says what their declarations say.
//!
//! `UGV_BLESS=1 cargo test --test effects page` writes it anew.

use std::fmt::Write as _;
use std::path::Path;
use ugv_terrain::effects::{CATALOGUE, Declaration, Kind, Prior};

const HEAD: &str = "\
# Effects: the physics that the paper leaves out

<!-- Written by `UGV_BLESS=1 cargo test --test effects page` from the declarations in `src/effects/`. -->

Each effect is one file in `src/effects/`, of one shape, generic over the scalar: the same code is switched
on by a file (`ugv simulate --effects FILE`), estimated by `ugv fit`, and set as an FMU's parameters. With all
off the model is the paper's, bit for bit. An effect is on when one of its **bold** parameters differs from its
default; the others shape it. Symbols and numbers of equations as in the paper; z is the sinkage (h in `bulldozing`), and i is the slip
(r omega - V_X) / max(abs(r omega), abs(V_X)): -1 for a locked wheel, 1 for one that spins on the spot, up to 2 in size where
rim and travel oppose each other; smooth between. (The output
`longitudinal_slip` is the paper's, (13), which divides by r omega.) The stress' peak stays within 0.95 of the arc. Where
shear is a state (`transient_shear`), the slip speed u at which the shear of a held wheel fades is 0.02 mm/s, for a rolling one 1 mm/s: u^2 grows with (r omega)^2/((r omega)^2 + (1 mm/s)^2).

The reference point is the centre of mass of the vehicle as given, without `payload` and `com_shift`: pose, velocities and accelerations stay
those of it; moments are about where the centre of mass then is. Forces that are not a wheel's (`grade`, `drag`, `drawbar`, laws) are in a_x, a_y and in
the yaw acceleration, not in R_r, M_r or the turning moment; frontal bulldozing is in R_r, the viscous force of `rate_dependent_soil` in the thrust. On a slope
x and y lie along the surface, not in the horizontal: at 10 deg a map is 1.5 % shorter.

Priors: m ± s is normal, m ×/÷ f log-normal with ln f the standard deviation of the logarithm; `ugv fit` uses those of the physics, `ugv diagnose`
[others around \"off\"](method.md#1-the-likelihood). Besides the paper's symbols: N wheels of width b, half a track B,
a sinkage h_0 under the axle, v_0 = 0.01 m/s, and after Hegedus D1 = 2 q, D2 = q + q^2 tan phi with
q = sqrt(1 + tan^2 phi) + tan phi.

What is of the sensors moves no vehicle: a simulation and an FMU leave it out. `ugv fit` and `ugv diagnose` estimate it for each recording
under names of its own (`pose_latency`, `lever_arm_x`, ...), in ranges and with priors of its own, whose 90 % intervals `ugv fit --free help` prints; there a latency may be negative.

In a file `grade` may also hold slopes along the drive, linear in between:
`\"profile\": {\"over\": \"time\" or \"distance\", \"points\": [[at, slope_east, slope_north], ...]}` or
`{\"over\": \"place\", \"x\": [...], \"y\": [...], \"slopes\": [[[slope_east, slope_north], ...], ...]}`.
`terrain_change` lies at a line on the map, or with `\"over\": \"time\"` or `\"over\": \"distance\"` at a time or a distance driven.
Beside the effects a `window` with hard edges may tell when [s from the first row] or where [m] some of them act:
`\"window\": {\"effects\": [\"drawbar\"], \"time\": [12.4, 21]}` (from 12.4 on, before 21) or
`{\"effects\": [\"drawbar\"], \"place\": {\"x\": 5, \"y\": 0, \"radius\": 2}}` (while the reference point is in the disc).
Outside they are off; what they make the vehicle and its ground remember goes on being remembered.
What acts over the time or the distance is for simulation and FMU: `ugv fit`, `score` and `diagnose` refuse it.
The laws `residual_*` have no name: they say how physics that is not in this list acts, not what it is.
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
        (Kind::Physics, "Physics"),
        (
            Kind::Measurement,
            "Measurement (never to be blamed on the soil)",
        ),
    ] {
        writeln!(page, "\n## {title}").unwrap();
        for effect in CATALOGUE.iter().filter(|effect| effect.kind == kind) {
            section(&mut page, effect);
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/docs/effects.md");
    if std::env::var_os("UGV_BLESS").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap();
    assert!(
        written == page,
        "src/docs/effects.md is out of date: UGV_BLESS=1 cargo test --test effects page"
    );
}
