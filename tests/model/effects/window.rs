//! Effects that act for a while, or somewhere, only.

use super::derivatives::{Differentiated, by_shares, compare, end, sensitive};
use super::{MOTIONS, specification};
use crate::common::speeds;
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects, Extent, Window};
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::vehicle::{Balance, ModelParameter, Motion, Surroundings, VehicleModel, Wrench};

/// The integrator's tolerance of a velocity \[m/s\], over some steps.
const CLOSE: f64 = 1e-3;

fn number(effect: &str) -> usize {
    let found = CATALOGUE.iter().position(|known| known.name == effect);
    found.unwrap()
}

fn with(settings: &[(&str, f64)]) -> Effects {
    settings.iter().fold(Effects::NONE, |all, (name, value)| {
        all.with(name, *value).unwrap()
    })
}

fn windowed(effects: &Effects, names: &[&str], extent: Extent) -> Effects {
    let mut effects = effects.clone();
    effects.window = Some(Window {
        effects: names.iter().map(|name| number(name)).collect(),
        extent,
    });
    effects
}

fn model(effects: Effects) -> VehicleModel {
    VehicleModel::from_specification(&specification("sandy_loam", effects)).unwrap()
}

fn wrench(model: &VehicleModel, motion: &Motion, surroundings: &Surroundings) -> Wrench {
    let mut balance = Balance::new(model);
    model.solve_at(motion, surroundings, &mut balance).unwrap();
    let mut wrench = Wrench::for_model(model);
    balance.wrench_at(model, motion, surroundings, &mut wrench);
    wrench
}

#[test]
fn forces_are_those_of_the_effects_switched_on_or_off_bit_for_bit() {
    let disc = Extent::Place {
        x: 2.0,
        y: 1.0,
        radius: 0.5,
    };
    let moment = Extent::Time {
        start: 3.0,
        end: 4.0,
    };
    for effect in CATALOGUE.iter().filter(|e| e.kind == EffectKind::Physics) {
        // Another effect stays on beside it: what is off is off in the same code.
        let kept = if effect.name == "drag" {
            ("drawbar.force", 100.0)
        } else {
            ("drag.coefficient", 7.0)
        };
        let off = with(&[kept]);
        let on = effect.parameters.iter().filter(|p| p.switches);
        let on = on.fold(off.clone(), |all, p| {
            let far = if p.default < p.high { p.high } else { p.low };
            // A tyre of nearly 2 MPa is as rigid as none.
            let share = if effect.name == "tyre_compliance" {
                0.995
            } else {
                0.02
            };
            let value = p.default + share * (far - p.default);
            let name = format!("{}.{}", effect.name, p.name);
            all.with(&name, value).unwrap()
        });
        for extent in [disc, moment] {
            let both = model(windowed(&on, &[effect.name], extent));
            let (on, off) = (model(on.clone()), model(off.clone()));
            let somewhere = Surroundings {
                position: [2.0, 1.5],
                time: 3.0,
                heading: 0.3,
                ..Surroundings::default()
            };
            let tells =
                |motion| wrench(&on, motion, &somewhere) != wrench(&off, motion, &somewhere);
            assert!(MOTIONS.iter().any(tells), "{} does nothing", effect.name);
            for motion in &MOTIONS {
                for (time, position, inside) in [
                    (3.0, [2.0, 1.5], true),
                    (2.999, [2.0, 1.501], false),
                    (4.0, [1.0, 1.0], false),
                ] {
                    let at = Surroundings {
                        time,
                        position,
                        heading: 0.3,
                        ..Surroundings::default()
                    };
                    let expected = if inside { &on } else { &off };
                    assert_eq!(
                        wrench(&both, motion, &at),
                        wrench(expected, motion, &at),
                        "{} {time}",
                        effect.name
                    );
                }
            }
        }
    }
}

/// Drives on another model from where a drive stands.
fn switched(drive: &Simulation, model: VehicleModel) -> Simulation {
    let mut next = Simulation::new(model);
    next.set_time(drive.time()).unwrap();
    next.set_state(drive.state()).unwrap();
    next.set_wheel_speeds(drive.wheel_speeds()).unwrap();
    next
}

fn assert_close(a: State, b: State, what: &str) {
    for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
        assert!((a - b).abs() < CLOSE, "{what}: {a} {b}");
    }
}

#[test]
fn a_drive_through_a_window_is_one_with_models_switched_by_hand() {
    // The second is over long before the integrator's step in a steady run is.
    for (start, end) in [(1.0, 2.5), (4.0, 4.03)] {
        let off = with(&[("drag.coefficient", 7.0)]);
        let on = with(&[("drag.coefficient", 7.0), ("drawbar.force", 1500.0)]);
        let mut by_hand = Simulation::new(model(off.clone()));
        by_hand.set_wheel_speeds(speeds(5.0, 6.0)).unwrap();
        by_hand.step(start).unwrap();
        let before = by_hand.state();
        by_hand = switched(&by_hand, model(on.clone()));
        by_hand.step(end - start).unwrap();
        let pulled = by_hand.state();
        by_hand = switched(&by_hand, model(off));
        by_hand.step(0.5).unwrap();

        let window = windowed(&on, &["drawbar"], Extent::Time { start, end });
        let mut whole = Simulation::new(model(window));
        whole.set_wheel_speeds(speeds(5.0, 6.0)).unwrap();
        let mut stepwise = whole.clone();
        whole.step(end + 0.5).unwrap();
        assert_close(whole.state(), by_hand.state(), "in one step");
        // Steps that end at an edge, or beside it by rounding, or within the window.
        let count = ((end + 0.5) / 0.01_f64).round() as usize;
        for k in 0..count {
            stepwise.step(0.01).unwrap();
            let time = stepwise.time();
            if (time - start).abs() < 1e-9 {
                assert_close(stepwise.state(), before, "at the start");
            } else if (time - end).abs() < 1e-9 {
                assert_close(stepwise.state(), pulled, "at the end");
            }
            assert!(k < count, "{time}");
        }
        assert_close(stepwise.state(), by_hand.state(), "step by step");
        // It pulls at all.
        assert!((pulled.v_x - before.v_x).abs() > 5.0 * CLOSE);
    }
}

#[test]
fn the_forces_jump_where_a_step_ends_at_an_edge() {
    let on = with(&[("drawbar.force", 1500.0)]);
    let extent = Extent::Time {
        start: 2.0,
        end: 3.0,
    };
    let mut drive = Simulation::new(model(windowed(&on, &["drawbar"], extent)));
    drive.set_wheel_speeds(speeds(6.0, 6.0)).unwrap();
    let mut a_x = |seconds: f64| {
        drive.step(seconds).unwrap();
        drive.wrench().unwrap().a_x
    };
    let [before, first, last, after] = [1.999, 0.001, 0.999, 0.001].map(&mut a_x);
    assert!(before.abs() < 0.01 && last > 0.3 * first && first < -1.0);
    // 1500 N on 490 kg, less what the other load on the wheels changes.
    assert!((first - before + 1500.0 / 490.0).abs() < 0.4, "{first}");
    assert!((after - last - 1500.0 / 490.0).abs() < 0.4, "{after}");
}

#[test]
fn a_straight_drive_is_held_back_within_a_disc() {
    let on = with(&[("drawbar.force", 600.0)]);
    let extent = Extent::Place {
        x: 4.0,
        y: 0.5,
        radius: 1.118_033_988_749_895,
    };
    let both = model(windowed(&on, &["drawbar"], extent));
    let (on, off) = (model(on), model(Effects::NONE));
    let mut drive = Simulation::new(both);
    drive.set_wheel_speeds(speeds(6.0, 6.0)).unwrap();
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..600 {
        drive.step(0.01).unwrap();
        let state = drive.state();
        let motion = Motion {
            v_x: state.v_x,
            v_y: state.v_y,
            yaw_rate: state.yaw_rate,
            omega_left: 6.0,
            omega_right: 6.0,
        };
        // The chord at y = 0: 1.118^2 = 1 + 0.5^2.
        let held = (state.x - 4.0).abs() <= 1.0;
        let expected = if held { &on } else { &off };
        let expected = wrench(expected, &motion, &Surroundings::default()).a_x;
        let found = drive.wrench().unwrap().a_x;
        assert!(
            (found - expected).abs() < 0.02,
            "{state:?} {found} {expected}"
        );
        *(if held { &mut inside } else { &mut outside }) += 1;
    }
    assert!(inside > 100 && outside > 300, "{inside} {outside}");
}

#[test]
fn a_drive_across_a_window_is_differentiated() {
    let on = with(&[("drag.coefficient", 30.0), ("drawbar.force", 400.0)]);
    let by = [
        "drawbar.force",
        "drawbar.hitch_behind",
        "drag.coefficient",
        "mass",
        "cohesion",
    ];
    let names = by.map(|name| ModelParameter::find(name).unwrap());
    for (extent, parameters) in [
        // Edges between the steps and at them.
        (
            Extent::Time {
                start: 0.5024,
                end: 1.2513,
            },
            &names[..],
        ),
        (
            Extent::Time {
                start: 0.5,
                end: 1.5,
            },
            &names[..],
        ),
        (
            Extent::Time {
                start: 1.0,
                end: 9.0,
            },
            &names[..],
        ),
        // Into a disc and not out of it: by what acts inside alone.
        (
            Extent::Place {
                x: 12.0,
                y: 0.0,
                radius: 10.8,
            },
            &names[..2],
        ),
    ] {
        let on = specification("sandy_loam", windowed(&on, &["drawbar"], extent));
        let steps = by_shares(1e-2, &on, parameters);
        let what = format!("{extent:?}");
        Differentiated::new(&on, &end).by_parameters(&what, &sensitive(&on, parameters), &steps);
    }
}

#[test]
fn nothing_depends_on_what_is_off_there() {
    let on = with(&[("drag.coefficient", 30.0), ("drawbar.force", 400.0)]);
    let late = Extent::Time {
        start: 5.0,
        end: 6.0,
    };
    let on = specification("sandy_loam", windowed(&on, &["drawbar"], late));
    let parameters =
        ["drawbar.force", "drag.coefficient"].map(|n| ModelParameter::find(n).unwrap());
    let drive = sensitive(&on, &parameters);
    assert_eq!(drive.derivatives().by_parameter(0), [0.0; 6]);
    assert!(drive.derivatives().by_parameter(1)[3] < 0.0);
}

#[test]
fn an_effect_that_is_off_is_differentiated_within_its_window_alone() {
    let force = [ModelParameter::find("drawbar.force").unwrap()];
    let by_force = |value: f64, extent: Extent| {
        let some = with(&[("drawbar.force", value)]);
        let some = specification("sandy_loam", windowed(&some, &["drawbar"], extent));
        sensitive(&some, &force).derivatives().by_parameter(0)
    };
    let [short, long] = [0.9, 1.4].map(|end| Extent::Time { start: 0.4, end });
    let (off, nearly) = (by_force(0.0, short), by_force(1e-6, short));
    compare("off", off, nearly);
    // Twice as long it holds the vehicle back by more.
    assert!(off[0] < 0.0 && by_force(0.0, long)[0] < 1.3 * off[0]);
}

#[test]
fn what_is_remembered_goes_on_outside() {
    let on = with(&[
        ("transient_shear.relaxation", 1.0),
        ("multipass.memory", 1.0),
    ]);
    let extent = Extent::Time {
        start: 3.0,
        end: 4.0,
    };
    let both = ["transient_shear", "multipass"];
    let mut drive = Simulation::new(model(windowed(&on, &both, extent)));
    let mut always = Simulation::new(model(on));
    assert_eq!(drive.snapshot().len(), always.snapshot().len());
    for drive in [&mut drive, &mut always] {
        drive.set_wheel_speeds(speeds(5.0, 6.0)).unwrap();
        drive.step(2.9).unwrap();
    }
    // The rear wheels' ruts are about as deep as with the effects on.
    let ruts = drive.model().memory_names().into_iter();
    let ruts = ruts
        .enumerate()
        .filter(|(_, name)| name.ends_with("rut_depth"));
    let ruts: Vec<_> = ruts.skip(2).collect();
    assert_eq!(ruts.len(), 6);
    for (index, name) in ruts {
        let ratio = drive.memory()[index] / always.memory()[index];
        assert!((0.6..1.3).contains(&ratio), "{name}: {ratio}");
    }
    // A state saved outside is taken up inside.
    let mut other = Simulation::new(drive.model().clone());
    other.restore(&drive.snapshot()).unwrap();
    for drive in [&mut drive, &mut other] {
        drive.step(0.6).unwrap();
    }
    assert_eq!(drive.state(), other.state());
    assert_eq!(drive.memory(), other.memory());
    assert_eq!(drive.wrench().unwrap(), other.wrench().unwrap());
}
