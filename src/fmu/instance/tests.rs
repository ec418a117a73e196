//! Windows, trials, and steps that are refused.

use super::*;
use crate::declaration::{Quantity, Side};
use crate::fmu::test_instance::{instance, running, with_effects};

const DRIVING: [f64; State::COUNT] = [0.0, 0.0, 0.3, 1.1, 0.02, 0.1];
const WINDOW: &str =
    r#"{"grade": {"slope_east": 0.1}, "window": {"effects": ["grade"], "time": [0.25, 0.5]}}"#;

fn rates(instance: &mut Instance) -> [f64; State::COUNT] {
    let mut rates = [0.0; State::COUNT];
    instance.get_rates(&mut rates).unwrap();
    rates
}

#[test]
fn a_window_opens_and_closes_at_the_events_alone() {
    let mut instance = running(Interface::ModelExchange, WINDOW);
    for (edge, beyond) in [(0.25_f64, 0.3), (0.5, 0.6)] {
        instance.enter_continuous_time_mode().unwrap();
        instance.set_time(edge.next_down()).unwrap();
        let before = rates(&mut instance);
        // At the event itself, and where a solver's trial oversteps it.
        for time in [edge, beyond, edge] {
            instance.set_time(time).unwrap();
            assert_eq!(rates(&mut instance), before, "{time}");
            assert_eq!(instance.core.time, time);
        }
        instance.enter_event_mode().unwrap();
        let behind = rates(&mut instance);
        assert!((behind[3] - before[3]).abs() > 0.5, "{behind:?}");
        instance.enter_continuous_time_mode().unwrap();
        assert_eq!(rates(&mut instance), behind);
    }
    assert_eq!(instance.next_event(), Ok(None));
}

#[test]
fn a_trial_that_cannot_be_computed_can_be_taken_back() {
    let mut instance = running(Interface::ModelExchange, "{}");
    instance.enter_continuous_time_mode().unwrap();
    instance.set_states(&DRIVING).unwrap();
    let before = rates(&mut instance);
    let mut trial = DRIVING;
    trial[2] = f64::NAN;
    let failed = instance.set_states(&trial);
    assert!(matches!(failed, Err(Failure::Broken(_))), "{failed:?}");
    assert_eq!(rates(&mut instance), before);
    // There are no forces at such a wheel speed.
    let left =
        |instance: &mut Instance, speed| instance.core.set_real(Quantity::Input(Side::Left), speed);
    left(&mut instance, 1e300).unwrap();
    let failed = instance.get_rates(&mut trial);
    assert!(matches!(failed, Err(Failure::Broken(_))), "{failed:?}");
    left(&mut instance, 0.0).unwrap();
    for (again, before) in rates(&mut instance).into_iter().zip(before) {
        assert!((again - before).abs() < 1e-8, "{again}, {before}");
    }
}

#[test]
fn long_steps_skip_no_time() {
    let mut instance = running(Interface::CoSimulation, "{}");
    instance.core.stop_time = 2000.0;
    instance.step(0.0, 1000.0).unwrap();
    let refused = instance.step(1_000.000_9, 100.0).unwrap_err();
    assert!(matches!(refused, Failure::Refused(_)), "{refused:?}");
    let refused = instance.step(1000.0, 1_000.000_9).unwrap_err();
    assert!(matches!(refused, Failure::Refused(_)), "{refused:?}");
    instance.step(1000.0 + 5e-7, 1000.0).unwrap();
}

#[test]
fn a_late_start_gives_the_same_drive() {
    let drive = |start: f64| {
        let mut instance = instance(Interface::CoSimulation, with_effects("{}"));
        instance.setup_experiment(start, None).unwrap();
        instance.enter_initialization().unwrap();
        instance.exit_initialization().unwrap();
        for step in 0..50 {
            // Jumps, which the integrator follows by short steps.
            let speed = if step % 10 < 5 { 8.0 } else { -3.0 };
            let left = Quantity::Input(Side::Left);
            instance.core.set_real(left, speed).unwrap();
            let size = 0.02;
            let point = start + f64::from(step) * size;
            instance.step(point, size).unwrap();
        }
        let mut states = [0.0; State::COUNT];
        instance.get_states(&mut states).unwrap();
        states
    };
    // Seconds since 1970, and the latest.
    for start in [1.7e9, -1.7e9, MAX_TIME - 10.0] {
        assert_eq!(drive(start), drive(0.0), "{start}");
    }
}

#[test]
fn times_that_resolve_no_steps_are_refused_before_anything_is_taken() {
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let mut early = instance(interface, with_effects("{}"));
        for start in [1e12, -1e12, f64::MAX, f64::NAN] {
            let refused = early.setup_experiment(start, None).unwrap_err();
            let Failure::Refused(why) = refused else {
                panic!("{refused:?}")
            };
            assert!(why.starts_with("start time"), "{why}");
        }
        // A stop time is no point of the clock.
        early.setup_experiment(MAX_TIME, Some(1e300)).unwrap();
        assert_eq!(early.core.time, MAX_TIME);
    }
    let mut exchange = running(Interface::ModelExchange, "{}");
    exchange.enter_continuous_time_mode().unwrap();
    assert!(matches!(exchange.set_time(1e12), Err(Failure::Refused(_))));
    assert_eq!(exchange.core.time, 0.0);
    exchange.set_time(1.7e9).unwrap();
}

#[test]
fn a_step_that_the_clock_cannot_resolve_is_refused() {
    let start = 1.7e9;
    let mut instance = instance(Interface::CoSimulation, with_effects("{}"));
    instance.setup_experiment(start, None).unwrap();
    instance.enter_initialization().unwrap();
    instance.exit_initialization().unwrap();
    // The clock moves in steps of 2.4e-7 s here.
    for size in [1e-9, 1e-6] {
        let refused = instance.step(start, size).unwrap_err();
        assert!(matches!(refused, Failure::Refused(_)), "{refused:?}");
    }
    instance.step(start, 0.001).unwrap();
    // A point that is half a step off is another one.
    let refused = instance.step(start + 0.0015, 0.001).unwrap_err();
    assert!(matches!(refused, Failure::Refused(_)), "{refused:?}");
    instance.step(start + 0.001, 0.001).unwrap();
    assert_eq!(instance.core.time, start + 0.001 + 0.001);
}

#[test]
fn a_step_that_is_too_long_is_refused_before_anything_is_taken() {
    let mut instance = running(Interface::CoSimulation, "{}");
    instance.core.rates.left = 1.0;
    let refused = instance.step(0.0, 1.1e6).unwrap_err();
    assert!(matches!(refused, Failure::Refused(_)), "{refused:?}");
    assert_eq!(instance.core.rates.left, 1.0);
    instance.step(0.0, 0.1).unwrap();
}
