//! Windows, trials, and steps that are refused.

use super::*;
use crate::declaration::Quantity;
use crate::fmu::test_instance::running;

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
    let left = |instance: &mut Instance, speed| instance.core.set_real(Quantity::Input(0), speed);
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
fn a_step_that_is_too_long_is_refused_before_anything_is_taken() {
    let mut instance = running(Interface::CoSimulation, "{}");
    instance.core.rates.left = 1.0;
    let refused = instance.step(0.0, 1.1e6).unwrap_err();
    assert!(matches!(refused, Failure::Refused(_)), "{refused:?}");
    assert_eq!(instance.core.rates.left, 1.0);
    instance.step(0.0, 0.1).unwrap();
}
