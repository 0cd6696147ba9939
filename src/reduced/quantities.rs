//! What is interpolated of a state: the results of which the table of results says so, and the fluid's friction.

use crate::outputs::{Floor, Get, Interpolation, Mirror, Outputs, RESULTS, RealTime, ResultRow, STATIONS};

/// How a result is interpolated, if it is and if it is a number, or a profile.
const fn interpolated(row: &ResultRow, is_profile: bool) -> Option<Interpolation> {
    match (row.real_time, row.get) {
        (RealTime::Interpolated(how), Get::Real(_)) if !is_profile => Some(how),
        (RealTime::Interpolated(how), Get::Profile(_)) if is_profile => Some(how),
        _ => None,
    }
}

/// How many of the first results are interpolated.
const fn count(results: usize, is_profile: bool) -> usize {
    let (mut found, mut i) = (0, 0);
    while i < results {
        found += interpolated(&RESULTS[i], is_profile).is_some() as usize;
        i += 1;
    }
    found
}

/// The fluid's friction on the upper body, per unit depth; it follows the numbers of the table of results.
pub const UPPER_FRICTION: usize = count(RESULTS.len(), false);
/// The fluid's friction on the lower body, per unit depth.
pub const LOWER_FRICTION: usize = UPPER_FRICTION + 1;
/// The depth, which follows where the load is given.
pub const PENETRATION_DEPTH: usize = LOWER_FRICTION + 1;
/// Number of interpolated scalars.
pub const SCALARS: usize = PENETRATION_DEPTH + 1;
/// Number of interpolated quantities: scalars, and the stations of profiles.
pub const QUANTITIES: usize = SCALARS + STATIONS * count(RESULTS.len(), true);

/// Where in a state an interpolated number is. No other name compiles.
const fn place(name: &str) -> usize {
    let mut i = 0;
    while !equal(RESULTS[i].name.as_bytes(), name.as_bytes()) {
        i += 1;
    }
    assert!(interpolated(&RESULTS[i], false).is_some());
    count(i, false)
}

const fn equal(a: &[u8], b: &[u8]) -> bool {
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Where the least film thickness is.
pub const MINIMUM_FILM: usize = place("minimum_film_thickness");
/// Where the film thickness in the middle is.
pub const CENTRAL_FILM: usize = place("central_film_thickness");
const CONTACT_LENGTH: usize = place("contact_length");

/// How each quantity is interpolated.
pub static INTERPOLATION: [Interpolation; QUANTITIES] = {
    let mut all =
        [Interpolation { mirror: Mirror::Negated, kinked: false, hops: false, floor: Floor::None }; QUANTITIES];
    all[PENETRATION_DEPTH].mirror = Mirror::Kept;
    let mut i = 0;
    while i < RESULTS.len() {
        if let Some(how) = interpolated(&RESULTS[i], false) {
            all[count(i, false)] = how;
        }
        if let Some(how) = interpolated(&RESULTS[i], true) {
            let mut station = 0;
            while station < STATIONS {
                all[SCALARS + STATIONS * count(i, true) + station] = how;
                station += 1;
            }
        }
        i += 1;
    }
    all
};

/// All quantities of a state, and their derivatives with respect to penetration depth, sliding speed and slide-to-roll ratio.
pub type State = [[f64; QUANTITIES]; 4];

/// What is interpolated of outputs: the rest follows from it. `boundary_friction` is the part of the friction forces, per unit
/// depth, that is not interpolated because it is known from the solid load.
pub fn quantities(outputs: &Outputs, boundary_friction: f64, width: f64) -> [f64; QUANTITIES] {
    let mut all = [0.0; QUANTITIES];
    let (scalars, profiles) = all.split_at_mut(SCALARS);
    scalars[UPPER_FRICTION] = outputs.upper_friction_force / width - boundary_friction;
    scalars[LOWER_FRICTION] = outputs.lower_friction_force / width - boundary_friction;
    scalars[PENETRATION_DEPTH] = outputs.penetration_depth;
    let (mut scalars, mut profiles) = (scalars.iter_mut(), profiles.iter_mut());
    for row in RESULTS.iter().filter(|row| matches!(row.real_time, RealTime::Interpolated(_))) {
        match row.get {
            Get::Real(get) => scalars.next().into_iter().for_each(|scalar| *scalar = get(outputs)),
            Get::Profile(get) => profiles.by_ref().zip(get(outputs)).for_each(|(place, value)| *place = *value),
            _ => {}
        }
    }
    all
}

/// The quantities, or a derivative of them, with x and U reversed.
pub fn mirrored(values: &[f64; QUANTITIES]) -> [f64; QUANTITIES] {
    let mut result: [f64; QUANTITIES] = std::array::from_fn(|q| match INTERPOLATION[q].mirror {
        Mirror::Kept => values[q],
        Mirror::Negated => -values[q],
        Mirror::Place => -(values[q] + values[CONTACT_LENGTH]),
    });
    result[SCALARS..].chunks_exact_mut(STATIONS).for_each(<[f64]>::reverse);
    result
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::*;
    use crate::outputs::{Derived, Direct};
    use crate::parameters::Parameters;

    /// Outputs of which the interpolated numbers are 0, 1, 2 and so on, and the values of the profiles go on from there.
    fn counted() -> Outputs {
        let (mut number, mut station) = (-1.0, SCALARS as f64 - 1.0);
        let mut next = || {
            station += 1.0;
            Dual64::from(station)
        };
        let direct = Direct::interpolated(
            || {
                number += 1.0;
                Dual64::from(number)
            },
            || (0..STATIONS).map(|_| next()).collect(),
        );
        let none = Dual64::from(0.0);
        let derived = Derived::new(&Parameters::default(), [none; 2], &direct, false, [none; 2], none);
        Outputs::new(direct, derived).map(|dual| dual.re)
    }

    #[test]
    fn what_is_interpolated_comes_back_to_its_place() {
        let found = quantities(&counted(), 0.0, 1.0);
        for (q, value) in found.into_iter().enumerate() {
            let beside = [UPPER_FRICTION, LOWER_FRICTION, PENETRATION_DEPTH].contains(&q);
            assert_eq!(value, if beside { 0.0 } else { q as f64 });
        }
        assert_eq!(found[MINIMUM_FILM], counted().minimum_film_thickness);
        assert_eq!(found[CONTACT_LENGTH], counted().contact_length);
    }

    #[test]
    fn the_mirror_image_of_the_mirror_image_is_the_state() {
        let mut state = quantities(&counted(), 0.0, 1.0);
        state[UPPER_FRICTION] = 2.5;
        let mirror = mirrored(&state);
        assert_eq!(mirrored(&mirror), state);
        assert_eq!(mirror[UPPER_FRICTION], -2.5);
        assert_eq!(mirror[MINIMUM_FILM], state[MINIMUM_FILM]);
        // What touches from a to a + b touches in the mirror from -(a + b) to -a.
        let place = place("minimum_film_position");
        assert_eq!(mirror[place], -(state[place] + state[CONTACT_LENGTH]));
        assert_eq!(mirror[SCALARS], state[SCALARS + STATIONS - 1]);
    }
}
