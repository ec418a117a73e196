//! Whatever was found and however likely it is: the verdict agrees with the probabilities.

use super::*;
use crate::diagnosis::search::proposal::Proposal;
use crate::effects::CATALOGUE;
use nalgebra::DVector;
use proptest::prelude::*;

/// Effects, sensors among them, and something without a name.
fn subject() -> impl Strategy<Value = Subject> {
    let effect = (0..CATALOGUE.len()).prop_map(Subject::Effect);
    prop_oneof![6 => effect, 1 => Just(Subject::Unknown)]
}

/// Log odds: many around those of nothing, where verdicts turn.
fn odds() -> impl Strategy<Value = f64> {
    prop_oneof![-20.0..20.0, 3.0..7.0, 0.0..2000.0]
}

fn rivals(most: usize) -> impl Strategy<Value = Vec<(Subject, f64)>> {
    prop::collection::vec((subject(), odds()), 0..most)
}

prop_compose! {
    fn effect()(
        subject in subject(),
        own in odds(),
        gain in odds(),
        mut rivals in rivals(5),
    ) -> AcceptedEffect {
        rivals.push((subject, own));
        AcceptedEffect {
            proposal: Proposal {
                subject,
                coefficients: vec![0],
                extent: None,
                steps: Vec::new(),
                evidence: 0.0,
                price: 0.0,
                stability: Vec::new(),
                soil: DVector::zeros(0),
                hidden: false,
                anew: false,
            },
            gain,
            rivals,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn the_verdict_agrees_with_the_probabilities(
        accepted in prop::collection::vec(effect(), 0..4),
        refused in rivals(8),
        left in prop_oneof![0.0..20.0, 6.0..9.0, 0.0..500.0],
        explained in 0.0..500.0,
        seen in 0.0..1.0,
        tested in prop::bool::weighted(0.8),
        tried in prop::bool::weighted(0.8),
    ) {
        let physics = (0..CATALOGUE.len()).map(Subject::Effect);
        let judgement = Evidence {
            accepted: &accepted,
            refused: &refused,
            left,
            explained,
            physics: physics.filter(|s| !s.is_sensor()).collect(),
            seen,
            tested,
            tried,
        }
        .judged();
        let Judgement { verdict, insufficient, findings, leading, odds } = &judgement;
        let sum: f64 = odds.0.iter().map(|(_, share)| share).sum();
        prop_assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        prop_assert!(odds.0.iter().all(|(_, share)| (0.0..=1.0 + 1e-12).contains(share)));
        let nothing = odds.of(Subject::Nothing);
        let likeliest = odds.0.iter().map(|(_, share)| *share).fold(0.0, f64::max);
        prop_assert_eq!(insufficient.is_some(), *verdict == Verdict::InsufficientData);
        let Some(place) = leading else {
            prop_assert!(matches!(verdict, Verdict::NothingMissing | Verdict::InsufficientData));
            if *verdict == Verdict::NothingMissing {
                prop_assert!(findings.is_empty() && accepted.is_empty());
                prop_assert!(nothing >= SURE && nothing == likeliest);
                prop_assert!(tested && tried && seen >= ENOUGH);
            }
            return Ok(());
        };
        let one = &findings[*place];
        let set: f64 = one.set.iter().map(|(_, share)| share).sum();
        match verdict {
            Verdict::Ambiguous => {
                prop_assert!(!one.set.is_empty());
                prop_assert!(one.probability + set > one.nothing);
                let all: f64 = one.set.iter().map(|(subject, _)| odds.of(*subject)).sum();
                prop_assert!(odds.of(one.subject) + all > nothing);
            }
            Verdict::MissingPhysics | Verdict::Sensor | Verdict::UnknownPhysics => {
                prop_assert!(one.probability > one.nothing);
                prop_assert!(odds.of(one.subject) > nothing);
                prop_assert!(one.set.iter().all(|(_, share)| *share <= one.probability));
                prop_assert_eq!(one.subject == Subject::Unknown, *verdict == Verdict::UnknownPhysics);
                if *verdict != Verdict::UnknownPhysics {
                    prop_assert_eq!(one.subject.is_sensor(), *verdict == Verdict::Sensor);
                }
            }
            Verdict::NothingMissing | Verdict::InsufficientData => prop_assert!(false, "{verdict:?}"),
        }
    }
}
