//! The lubricant: its shear stress at a shear rate, and how a film of it answers to sliding walls and to a pressure gradient.
//!
//! Across a film of thickness h the shear stress is a straight line, tau(y) = tau_m + p' y with y from the middle, and the shear rate
//! is f(tau), the inverse of the flow curve tau = eta(gamma) gamma. Integrated over the film (A. Dyson and A. R. Wilson, Proc. Inst. Mech.
//! Engineers 180 (1965) 97-112; B. Najji, B. Bou-Said and D. Berthe, Journal of Tribology 111 (1989) 29-34, both quoted from memory):
//!
//! - the walls' velocity difference: (U1 - U2)/h = A = (1/2) int f(tau_m + G s) ds,  s from -1 to 1,  G = (h/2) p'
//! - the flux: Q = (U1 + U2) h/2 - (h^2/2) B,  B = (1/2) int s f(tau_m + G s) ds
//!
//! Sliding and pressure thus thin the same fluid. Q has the form of Reynolds' equation with the viscosity eta_p = G/(3 B); a small
//! pressure gradient in a film that slides fast feels the slope of the flow curve there, d tau/d gamma, not stress over rate.

use num_dual::{Dual64, DualNum};

/// Density over that at ambient pressure, rho/rho0 = exp(chi p), of a fluid of compressibility chi \[1/Pa\].
#[inline(always)]
pub fn relative_density(compressibility: f64, pressure: f64) -> f64 {
    // At every quadrature point of every residual: most fluids here do not give way.
    if compressibility == 0.0 { 1.0 } else { (compressibility * pressure).exp() }
}

/// How the shear stress of the lubricant depends on the shear rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fluid {
    /// In proportion: the viscosity \[Pa s\].
    Newtonian(f64),
    /// Thinner at high rates.
    Carreau(Carreau),
}

/// eta = eta_inf + (eta_0 - eta_inf) (1 + (lambda gamma)^2)^((n - 1)/2): P. J. Carreau, Transactions of the Society of Rheology 16
/// (1972) 99-127. Newtonian below the rate 1/lambda, then a power law of the stress with exponent n, and Newtonian again where eta_inf
/// is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carreau {
    /// Viscosity at low shear rates eta_0 \[Pa s\].
    pub zero_shear_viscosity: f64,
    /// Viscosity at high shear rates eta_inf \[Pa s\].
    pub infinite_shear_viscosity: f64,
    /// Relaxation time lambda \[s\].
    pub relaxation_time: f64,
    /// Flow index n \[1\], above 0 and up to 1.
    pub flow_index: f64,
}

/// What a film does where it is sheared at a mean rate, with the derivatives with respect to that and to the half difference of the wall stresses
/// G = (h/2) p'.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sheared {
    /// Viscosity eta_p that the flow driven by pressure feels \[Pa s\].
    pub viscosity: f64,
    /// Its derivative with respect to the mean shear rate \[Pa s^2\].
    pub viscosity_by_rate: f64,
    /// Its derivative with respect to G \[s\].
    pub viscosity_by_difference: f64,
    /// Mean shear stress tau_m \[Pa\].
    pub stress: f64,
    /// Its derivative with respect to the mean shear rate \[Pa s\].
    pub stress_by_rate: f64,
    /// Its derivative with respect to G \[1\].
    pub stress_by_difference: f64,
}

/// Points on one half of -1..1, and weights, of Gauss's rule with 16 points.
const GAUSS: [[f64; 2]; 8] = [
    [0.095_012_509_837_637_4, 0.189_450_610_455_068_5],
    [0.281_603_550_779_258_9, 0.182_603_415_044_923_6],
    [0.458_016_777_657_227_4, 0.169_156_519_395_002_5],
    [0.617_876_244_402_643_8, 0.149_595_988_816_576_7],
    [0.755_404_408_355_003, 0.124_628_971_255_533_9],
    [0.865_631_202_387_831_8, 0.095_158_511_682_492_8],
    [0.944_575_023_073_232_6, 0.062_253_523_938_647_9],
    [0.989_400_934_991_649_9, 0.027_152_459_411_754_1],
];

impl Fluid {
    /// Stress over rate \[Pa s\] for the square of a shear rate \[1/s^2\].
    pub fn viscosity(&self, square: Dual64) -> Dual64 {
        match self {
            Self::Newtonian(viscosity) => Dual64::from(*viscosity),
            Self::Carreau(carreau) => carreau.viscosity(square),
        }
    }

    /// So many times as viscous at every rate.
    pub fn thickened(self, factor: f64) -> Self {
        match self {
            Self::Newtonian(viscosity) => Self::Newtonian(factor * viscosity),
            Self::Carreau(carreau) => Self::Carreau(Carreau {
                zero_shear_viscosity: factor * carreau.zero_shear_viscosity,
                infinite_shear_viscosity: factor * carreau.infinite_shear_viscosity,
                ..carreau
            }),
        }
    }

    /// A film with this mean shear rate (U1 - U2)/h \[1/s\] and half difference of its wall stresses (h/2) p' \[Pa\].
    pub fn sheared(&self, rate: f64, difference: f64) -> Sheared {
        match self {
            Self::Newtonian(viscosity) => Sheared {
                viscosity: *viscosity,
                stress: viscosity * rate,
                stress_by_rate: *viscosity,
                ..Sheared::default()
            },
            Self::Carreau(carreau) => carreau.sheared(rate, difference),
        }
    }
}

/// A, B and their derivatives: of A by tau_m, of A by G (which is that of B by tau_m), of B by G.
struct Means {
    rate: f64,
    moment: f64,
    slopes: [f64; 3],
}

impl Carreau {
    fn viscosity(&self, square: Dual64) -> Dual64 {
        let excess = self.zero_shear_viscosity - self.infinite_shear_viscosity;
        let thinned = (square * self.relaxation_time.powi(2) + 1.0).powf(0.5 * (self.flow_index - 1.0));
        thinned * excess + self.infinite_shear_viscosity
    }

    /// The flow curve: shear stress at a rate \[Pa\], and its slope \[Pa s\].
    pub fn stress(&self, rate: f64) -> (f64, f64) {
        let stress = self.viscosity(Dual64::new(rate * rate, 2.0 * rate)) * Dual64::new(rate, 1.0);
        (stress.re, stress.eps)
    }

    /// The shear rate at a stress \[1/s\], and its slope \[1/(Pa s)\], by Newton's method from a rate nearby.
    ///
    /// For positive rates the flow curve is concave: from the left Newton's method goes up to the root and never past it.
    fn rate(&self, stress: f64, guess: f64) -> (f64, f64) {
        let size = stress.abs();
        let least = size / self.zero_shear_viscosity;
        let mut rate = guess.abs().max(least);
        let mut slope = 0.0;
        for _ in 0..100 {
            let (value, by_rate) = self.stress(rate);
            slope = by_rate;
            let next = (rate - (value - size) / by_rate).max(least);
            let change = (next - rate).abs();
            rate = next;
            if change <= 1e-9 * rate {
                // The next change would be of the order of the square of this one.
                break;
            }
        }
        (rate.copysign(stress), 1.0 / slope)
    }

    /// A, B and derivatives, with guesses of the rates that are improved.
    fn means(&self, stress: f64, difference: f64, guesses: &mut [[f64; 2]; 8]) -> Means {
        let mut means = Means { rate: 0.0, moment: 0.0, slopes: [0.0; 3] };
        for ([s, weight], guess) in GAUSS.into_iter().zip(guesses) {
            let above = self.rate(stress + difference * s, guess[0]);
            // Without sliding one half of the film is like the other.
            let below = match stress {
                0.0 => (-above.0, above.1),
                _ => self.rate(stress - difference * s, guess[1]),
            };
            *guess = [above.0, below.0];
            let half = 0.5 * weight;
            means.rate += half * (above.0 + below.0);
            means.moment += half * s * (above.0 - below.0);
            means.slopes[0] += half * (above.1 + below.1);
            means.slopes[1] += half * s * (above.1 - below.1);
            means.slopes[2] += half * s * s * (above.1 + below.1);
        }
        means
    }

    fn sheared(&self, rate: f64, difference: f64) -> Sheared {
        // G/(3 B) is an even function of G. Where G is next to nothing it is taken at a ten-thousandth of what matters beside it, the
        // stresses of sliding and of where thinning starts, so that nothing is divided by zero.
        const LEAST: f64 = 1e-4;
        let (curve, curve_slope) = self.stress(rate.abs());
        let least = LEAST * (self.zero_shear_viscosity / self.relaxation_time + curve);
        let size = difference.hypot(least);
        let mut guesses = [[0.0; 2]; 8];
        let mut means = self.means(0.0, size, &mut guesses);
        let mut stress = 0.0;
        if rate != 0.0 {
            // A grows with the mean stress: Newton's method, and halving where that leaves the bracket. Pressure can only thin.
            let wall = 0.5 * guesses[7][0];
            let (mut low, mut high) = (0.0, curve * (1.0 + 1e-9));
            stress = (rate.abs() * self.viscosity((rate * rate + wall * wall).into()).re).clamp(low, high);
            for _ in 0..100 {
                means = self.means(stress, size, &mut guesses);
                let missing = rate.abs() - means.rate;
                if missing > 0.0 {
                    low = stress
                } else {
                    high = stress
                }
                let next = stress + missing / means.slopes[0];
                if (next - stress).abs() <= 1e-13 * stress {
                    break;
                }
                stress = if next > low && next < high { next } else { 0.5 * (low + high) };
            }
            stress = stress.copysign(rate);
        }
        let [a, b, c] = means.slopes;
        let viscosity = size / (3.0 * means.moment);
        // dB/dG and dB/dA, the mean stress being what the mean rate asks for.
        let (by_size, by_rate) = (c - b * b / a, b / a);
        let viscosity_by_size = viscosity / size - viscosity / means.moment * by_size;
        let (direction, way) = (1.0_f64.copysign(rate), difference / size);
        let size_by_rate = LEAST * curve_slope * least / size;
        Sheared {
            viscosity,
            viscosity_by_rate: (viscosity_by_size * size_by_rate - viscosity / means.moment * by_rate) * direction,
            viscosity_by_difference: viscosity_by_size * way,
            stress,
            stress_by_rate: 1.0 / a - by_rate * size_by_rate,
            stress_by_difference: -by_rate * direction * way,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    const SYNOVIAL: Carreau =
        Carreau { zero_shear_viscosity: 40.0, infinite_shear_viscosity: 1e-3, relaxation_time: 22.0, flow_index: 0.27 };

    proptest! {
        #[test]
        fn the_rate_at_a_stress_has_that_stress(power in -6.0..8.0f64, index in 0.1..1.0f64, negative: bool) {
            let carreau = Carreau { flow_index: index, ..SYNOVIAL };
            let rate = if negative { -1.0 } else { 1.0 } * 10_f64.powf(power);
            let (stress, slope) = carreau.stress(rate);
            let (found, inverse) = carreau.rate(stress, 0.0);
            prop_assert!((found / rate - 1.0).abs() < 1e-10 && (inverse * slope - 1.0).abs() < 1e-6);
            let step = 1e-5 * rate;
            let difference = (carreau.stress(rate + step).0 - carreau.stress(rate - step).0) / (2.0 * step);
            prop_assert!((slope / difference - 1.0).abs() < 1e-6);
        }

        #[test]
        fn derivatives_match_differences(
            rate_power in -3.0..6.0f64, difference_power in -2.0..4.0f64, index in 0.2..1.0f64, signs: [bool; 2],
        ) {
            let fluid = Fluid::Carreau(Carreau { flow_index: index, ..SYNOVIAL });
            let sign = |negative: bool| if negative { -1.0 } else { 1.0 };
            let (rate, difference) =
                (sign(signs[0]) * 10_f64.powf(rate_power), sign(signs[1]) * 10_f64.powf(difference_power));
            let (at, step) = (fluid.sheared(rate, difference), 1e-4);
            let [faster, slower] = [step, -step].map(|e| fluid.sheared(rate * (1.0 + e), difference));
            let [steeper, flatter] = [step, -step].map(|e| fluid.sheared(rate, difference * (1.0 + e)));
            for (slope, more, less, value, by) in [
                (at.viscosity_by_rate, faster.viscosity, slower.viscosity, at.viscosity, rate),
                (at.viscosity_by_difference, steeper.viscosity, flatter.viscosity, at.viscosity, difference),
                (at.stress_by_rate, faster.stress, slower.stress, at.stress, rate),
                (at.stress_by_difference, steeper.stress, flatter.stress, at.stress, difference),
            ] {
                let change = (more - less) / (2.0 * step);
                // The last term is round-off of differences that sliding makes in far larger rates.
                prop_assert!((slope * by - change).abs() < 1e-5 * value.abs() + 1e-12 * difference.abs(), "{} {}", slope * by, change);
            }
        }

    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(30))]

        /// Against midpoints of 4,000 strips, with the mean stress by bisection. The rule of 16 points is off by up to 0.05 % of the viscosity,
        /// and up to 0.4 % of the stress of sliding alone.
        #[test]
        fn sliding_and_pressure_share_the_film(rate_power in -2.0..5.0f64, difference_power in -1.0..3.0f64, index in 0.25..1.0f64) {
            let carreau = Carreau { flow_index: index, ..SYNOVIAL };
            let (rate, difference) = (10_f64.powf(rate_power), 10_f64.powf(difference_power));
            let strips = 4_000;
            let means = |stress: f64| {
                let mut guess = 0.0;
                let (mut sum, mut moment) = (0.0, 0.0);
                for i in 0..strips {
                    let s = (2.0 * f64::from(i) + 1.0) / f64::from(strips) - 1.0;
                    guess = carreau.rate(stress + difference * s, guess).0;
                    sum += guess / f64::from(strips);
                    moment += s * guess / f64::from(strips);
                }
                (sum, moment)
            };
            let (mut low, mut high) = (0.0, carreau.stress(rate).0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if means(middle).0 < rate { low = middle } else { high = middle }
            }
            let (stress, viscosity) = (low, difference / (3.0 * means(low).1));
            let film = Fluid::Carreau(carreau).sheared(rate, difference);
            let curve = carreau.stress(rate).0;
            prop_assert!((film.viscosity / viscosity - 1.0).abs() < 2e-3, "{} {}", film.viscosity, viscosity);
            prop_assert!((film.stress - stress).abs() < 1e-2 * curve, "{} {}", film.stress, stress);
        }
    }

    #[test]
    fn a_flow_index_of_one_is_newtonian() {
        let newtonian = Fluid::Newtonian(2e-3);
        let carreau = Carreau { zero_shear_viscosity: 2e-3, flow_index: 1.0, ..SYNOVIAL };
        for (rate, difference) in [(0.0, 0.0), (0.0, 10.0), (1e4, 0.0), (-1e4, 10.0), (1e5, -3.0)] {
            let [a, b] = [newtonian, Fluid::Carreau(carreau)].map(|fluid| fluid.sheared(rate, difference));
            assert_relative_eq!(a.viscosity, b.viscosity, max_relative = 1e-12);
            assert_relative_eq!(a.stress, b.stress, max_relative = 1e-12);
            assert_relative_eq!(a.stress_by_rate, b.stress_by_rate, max_relative = 1e-12);
            assert!(b.viscosity_by_rate.abs() * 1e4 < 1e-12 && b.viscosity_by_difference.abs() * 10.0 < 1e-12);
        }
    }

    /// A sheared parallel film: stress eta(U/h) U/h, and a little pressure meets the slope of the flow curve.
    #[test]
    fn sliding_alone_has_the_stress_of_the_flow_curve() {
        for rate in [1e-4, 0.03, 1.0, 1e3, 1e6, 1e9] {
            let film = Fluid::Carreau(SYNOVIAL).sheared(rate, 0.0);
            let (stress, slope) = SYNOVIAL.stress(rate);
            assert_relative_eq!(film.stress, stress, max_relative = 1e-7);
            assert_relative_eq!(film.stress_by_rate, slope, max_relative = 1e-6);
            assert_relative_eq!(film.viscosity, slope, max_relative = 1e-6);
        }
    }

    /// tau = K gamma^n: pressure drives (h^2/2) n/(2n + 1) (G/K)^(1/n) through the film, of order 1/n in the gradient.
    #[test]
    fn pressure_alone_drives_the_flow_of_a_power_law() {
        for index in [0.3, 0.5, 0.8] {
            let carreau =
                Carreau { infinite_shear_viscosity: 1e-12, relaxation_time: 1e6, flow_index: index, ..SYNOVIAL };
            let consistency = carreau.zero_shear_viscosity * carreau.relaxation_time.powf(index - 1.0);
            let moment =
                |difference: f64| difference / (3.0 * Fluid::Carreau(carreau).sheared(0.0, difference).viscosity);
            for rate in [1e2, 1e3, 1e4] {
                let difference = consistency * f64::powf(rate, index);
                assert_relative_eq!(moment(difference), index / (2.0 * index + 1.0) * rate, max_relative = 2e-4);
                let order = (moment(2.0 * difference) / moment(difference)).log2();
                assert_relative_eq!(order, 1.0 / index, max_relative = 1e-4);
            }
        }
    }
}
