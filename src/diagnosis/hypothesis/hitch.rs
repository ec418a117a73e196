//! Prior place of the hitch of a drawbar that is off.

use crate::effects::ParameterName;
use crate::vehicle::Specification;

/// The model with the hitch of an absent drawbar at the rear of the vehicle.
#[must_use]
pub fn hitched(nominal: &Specification) -> Specification {
    let mut hitched = nominal.clone();
    let vehicle = &nominal.vehicle;
    let last = vehicle.row_positions.iter().copied().reduce(f64::min);
    let rear = vehicle.wheel_radius - last.unwrap_or(0.0);
    let place = ParameterName::find("drawbar.hitch_behind");
    if let Some(place) = place.filter(|place| !nominal.effects.is_on(place.effect()))
        && hitched.effects.set(place, rear).is_err()
    {
        return nominal.clone();
    }
    hitched
}

#[cfg(test)]
mod tests {
    use super::super::Problem;
    use super::super::candidate::Target;
    use super::*;
    use crate::terrain::Terrain;
    use crate::vehicle::{ModelParameter, Vehicle};

    #[test]
    fn a_drawbar_is_expected_at_the_rear_and_fitted_around_it() {
        let hitch = ParameterName::find("drawbar.hitch_behind").unwrap();
        let mut vehicle = Vehicle::tran2007();
        vehicle.row_positions = vec![2.0, 0.5, -1.6];
        let rear = 1.6 + vehicle.wheel_radius;
        let mut nominal = Specification::plain(vehicle, Terrain::preset("dry_sand").unwrap());
        let expected = |nominal: &Specification| {
            let problem = Problem::new(nominal, &[]);
            let mut coefficients = problem.candidates.coefficients.iter();
            let coefficient =
                coefficients.find(|k| k.target == Target::Model(ModelParameter::Effect(hitch)));
            let coefficient = coefficient.map(|k| (k.parameter.prior.median, k.typical));
            (problem.nominal.effects.get(hitch), coefficient)
        };
        assert_eq!(expected(&nominal), (rear, Some((rear, rear))));
        // A given drawbar stays in its place.
        nominal.effects = nominal.effects.with("drawbar.force", 50.0).unwrap();
        assert_eq!(expected(&nominal), (1.0, None));
    }
}
