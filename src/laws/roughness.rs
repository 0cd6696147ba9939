//! Rough surfaces: what their asperities carry, and how they change the film between them.
//!
//! h is the mean distance of the two surfaces \[m\], negative where the mean planes overlap, and sigma the combined root mean square
//! roughness \[m\].

use crate::solver::root;

/// How the pressure of the asperities falls with the distance of the surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum AsperityLaw {
    /// exp(-h / (c sigma)), B. N. J. Persson, Physical Review Letters 99 (2007) 125502, for self-affine surfaces.
    Exponential,
    /// F_5/2(h / sigma) over F_5/2(0), J. A. Greenwood and J. H. Tripp, Proc. Inst. Mech. Engineers 185 (1970) 625-633, for Gaussian
    /// heights of equal summits.
    GreenwoodTripp,
}

/// The combined roughness of both surfaces.
///
/// The elastic contact of asperities saturates at some ten kilopascal in tissue as soft as cartilage. What carries more at closer
/// approach (the surface layer's osmotic pressure) is a second, stiffer exponential, the core. Below h = 0 both go on as straight
/// lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness {
    /// Combined root mean square roughness sigma \[m\].
    pub rms: f64,
    /// Law of the asperities.
    pub law: AsperityLaw,
    /// Their pressure at h = 0 \[Pa\].
    pub asperity_pressure: f64,
    /// Decay length of the exponential law over sigma, c \[1\].
    pub asperity_decay: f64,
    /// Pressure of the core at h = 0 \[Pa\].
    pub core_pressure: f64,
    /// Its decay length over sigma \[1\].
    pub core_decay: f64,
}

/// Film parameter h/sigma below which rough surfaces touch: mixed lubrication.
const MIXED_FILM: f64 = 3.0;

/// Value and derivative of amplitude * exp(-x / decay).
fn exponential(x: f64, amplitude: f64, decay: f64) -> (f64, f64) {
    let value = amplitude * (-x / decay).exp();
    (value, -value / decay)
}

/// F_5/2(x) / F_5/2(0) and its derivative for x >= 0, as fitted by J. C. Hu, Y. Cheng and others: (4 - x)^6.804 up to x = 4.
fn greenwood_tripp(x: f64) -> (f64, f64) {
    const POWER: f64 = 6.804;
    if x >= 4.0 {
        return (0.0, 0.0);
    }
    let value = (1.0 - 0.25 * x).powf(POWER);
    (value, -0.25 * POWER * value / (1.0 - 0.25 * x))
}

impl Roughness {
    /// Pressure p_a of solid on solid over the nominal area \[Pa\], and its derivative with respect to h \[Pa/m\].
    pub fn pressure(&self, gap: f64) -> (f64, f64) {
        let x = gap / self.rms;
        let open = x.max(0.0);
        let (asperities, slope) = match self.law {
            AsperityLaw::Exponential => exponential(open, self.asperity_pressure, self.asperity_decay),
            AsperityLaw::GreenwoodTripp => {
                let (value, slope) = greenwood_tripp(open);
                (self.asperity_pressure * value, self.asperity_pressure * slope)
            }
        };
        let (core, core_slope) = exponential(open, self.core_pressure, self.core_decay);
        let slope = slope + core_slope;
        (asperities + core + slope * x.min(0.0), slope / self.rms)
    }

    /// The distance below which rough surfaces count as touching \[m\].
    pub fn mixed_film(&self) -> f64 {
        MIXED_FILM * self.rms
    }

    /// The distance at which rough surfaces carry this pressure, which is positive \[m\].
    pub fn gap_at(&self, pressure: f64) -> f64 {
        let (at_zero, slope) = self.pressure(0.0);
        if pressure >= at_zero {
            return (pressure - at_zero) / slope;
        }
        let (mut low, mut high) = (0.0, self.rms);
        while self.pressure(high).0 > pressure && high < 1e3 * self.rms {
            (low, high) = (high, 2.0 * high);
        }
        // The logarithm of the pressure is next to a straight line.
        root::increasing([low, high], low, |gap| {
            let (value, slope) = self.pressure(gap);
            ((pressure / value).ln(), -slope / value)
        })
    }

    /// Fraction of the nominal area where the surfaces would overlap, for Gaussian heights: the bearing area erfc(h / (sqrt(2) sigma)) / 2,
    /// and its derivative with respect to h \[1/m\].
    pub fn real_contact_fraction(&self, gap: f64) -> (f64, f64) {
        let x = gap / self.rms;
        let density = (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        (0.5 * libm::erfc(x * std::f64::consts::FRAC_1_SQRT_2), -density / self.rms)
    }

    /// Thickness of the fluid, (h + sqrt(h^2 + 4 e^2)) / 2 with e = sigma / 100, and its derivative: h where the film is thick, and
    /// above zero where the mean planes overlap.
    pub fn thickness(&self, gap: f64) -> (f64, f64) {
        let e = 1e-2 * self.rms;
        let root = gap.hypot(2.0 * e);
        // Without cancellation below zero.
        let value = if gap >= 0.0 { 0.5 * (gap + root) } else { 2.0 * e * e / (root - gap) };
        (value, value / root)
    }

    /// Pressure flow factor on h^3 for isotropic roughness, 1 - 0.9 exp(-0.56 h / sigma) (N. Patir and H. S. Cheng, Journal of Lubrication
    /// Technology 100 (1978) 12-17), and its derivative with respect to the film's thickness \[1/m\].
    pub fn flow_factor(&self, thickness: f64) -> (f64, f64) {
        let reduction = 0.9 * (-0.56 * thickness / self.rms).exp();
        (1.0 - reduction, 0.56 * reduction / self.rms)
    }

    /// Mean of 1/h over the rough gap \[1/m\], by which viscosity times sliding velocity is the mean shear stress: phi_f / h of N. Patir
    /// and H. S. Cheng, Journal of Lubrication Technology 101 (1979) 220-229, for heights of polynomial density; gaps below
    /// sigma / 100 count as solid. And its derivative with respect to the film's thickness.
    pub fn inverse_thickness(&self, thickness: f64) -> (f64, f64) {
        let length = 3.0 * self.rms;
        let z = thickness / length;
        if z > 3.0 {
            // The closed form would cancel. Moments of the density: m_(k+1) = m_k (k + 1/2) / (k + 9/2).
            let (mut term, mut value, mut slope) = (1.0 / thickness, 0.0, 0.0);
            for k in (0..14).map(f64::from) {
                value += term;
                slope -= (2.0 * k + 1.0) * term / thickness;
                term *= (k + 0.5) / ((k + 4.5) * z * z);
            }
            return (value, slope);
        }
        let cube = (1.0 - z * z).powi(3);
        let cube_slope = -6.0 * z * (1.0 - z * z).powi(2);
        let (value, slope) = if z > 1.0 {
            let log = ((z + 1.0) / (z - 1.0)).ln();
            let polynomial = z / 15.0 * (66.0 + z * z * (30.0 * z * z - 80.0));
            let polynomial_slope = (66.0 + z * z * (150.0 * z * z - 240.0)) / 15.0;
            (cube * log + polynomial, cube_slope * log - cube * 2.0 / (z * z - 1.0) + polynomial_slope)
        } else {
            const LEAST: f64 = 1e-2 / 3.0;
            const COEFFICIENTS: [f64; 7] = [-55.0, 132.0, 345.0, -160.0, -405.0, 60.0, 147.0];
            let log = ((z + 1.0) / LEAST).ln();
            let (mut polynomial, mut polynomial_slope) = (0.0, 0.0);
            for coefficient in COEFFICIENTS.into_iter().rev() {
                polynomial_slope = polynomial_slope * z + polynomial;
                polynomial = polynomial * z + coefficient;
            }
            (cube * log + polynomial / 60.0, cube_slope * log + cube / (z + 1.0) + polynomial_slope / 60.0)
        };
        let factor = 35.0 / 32.0 / length;
        (factor * value, factor * slope / length)
    }
}

/// Surfaces for tests.
#[cfg(test)]
pub(crate) const ROUGH: Roughness = Roughness {
    rms: 0.3e-6,
    law: AsperityLaw::Exponential,
    asperity_pressure: 20e3,
    asperity_decay: 0.5,
    core_pressure: 10e6,
    core_decay: 0.1,
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_distance_at_a_pressure_inverts_the_law(x in -3.0..20.0f64, law in prop::sample::select(vec![AsperityLaw::Exponential, AsperityLaw::GreenwoodTripp])) {
            let rough = Roughness { law, ..ROUGH };
            let gap = x * rough.rms;
            prop_assert!((rough.gap_at(rough.pressure(gap).0) - gap).abs() < 1e-9 * rough.rms);
        }
    }

    type Law = fn(&Roughness, f64) -> (f64, f64);

    proptest! {
        #[test]
        fn derivatives_match_differences(x in -3.0..8.0f64, greenwood_tripp: bool) {
            let law = if greenwood_tripp { AsperityLaw::GreenwoodTripp } else { AsperityLaw::Exponential };
            let rough = Roughness { law, ..ROUGH };
            let laws: [Law; 5] = [
                Roughness::pressure, Roughness::real_contact_fraction, Roughness::thickness, Roughness::flow_factor,
                Roughness::inverse_thickness,
            ];
            for (index, f) in laws.into_iter().enumerate() {
                // The last two are of a thickness; kinks of slopes and where one formula follows another are left out.
                let x = if index > 2 { x.abs().max(0.02) } else { x };
                prop_assume!(x.abs() > 1e-3 && (x - 3.0).abs() > 1e-3 && (x - 4.0).abs() > 1e-3);
                let h = x * rough.rms;
                let step = 1e-5 * rough.rms;
                let difference = (f(&rough, h + step).0 - f(&rough, h - step).0) / (2.0 * step);
                let (value, slope) = f(&rough, h);
                let size = slope.abs() + 1e-4 * value.abs() / rough.rms;
                prop_assert!((slope - difference).abs() < 1e-5 * size, "{} at {}: {} {}", index, x, slope, difference);
            }
        }
    }

    #[test]
    fn pressure_falls_with_the_distance_and_goes_on_straight_below_zero() {
        for law in [AsperityLaw::Exponential, AsperityLaw::GreenwoodTripp] {
            let rough = Roughness { law, ..ROUGH };
            assert_relative_eq!(rough.pressure(0.0).0, 10.02e6, max_relative = 1e-12);
            let [a, b, c] = [-2e-7, -1e-7, 0.0].map(|h| rough.pressure(h).0);
            assert_relative_eq!(a - b, b - c, max_relative = 1e-9);
            assert!(a > b && b > c && rough.pressure(1e-6).0 < 1e-3 * c);
        }
    }

    #[test]
    fn greenwood_and_tripp_s_integral_is_that_of_gaussian_summits() {
        // F_5/2(x) = int_x^inf (s - x)^(5/2) exp(-s^2/2) ds / sqrt(2 pi); the fit is within a tenth of it up to 2 sigma.
        let integral = |x: f64| -> f64 {
            let step = 1e-3;
            (0..8000)
                .map(|i| (f64::from(i) + 0.5) * step)
                .map(|t| t.powf(2.5) * (-0.5 * (x + t).powi(2)).exp() * step)
                .sum()
        };
        for x in [0.5, 1.0, 1.5, 2.0] {
            assert_relative_eq!(greenwood_tripp(x).0, integral(x) / integral(0.0), max_relative = 0.1);
        }
    }

    #[test]
    fn mean_inverse_thickness_is_that_of_the_polynomial_density() {
        // Heights d within +-3 sigma of density 35/(96 sigma) (1 - (d/3 sigma)^2)^3, gaps below sigma/100 left out.
        for x in [0.0, 0.3, 1.0, 2.5, 2.9, 3.2, 5.0, 20.0] {
            let least = 1e-2;
            // Over the logarithm of the gap, where the integrand is smooth.
            let (low, high) = (f64::max(least, x - 3.0).ln(), f64::ln(x + 3.0));
            let steps = 20_000;
            let width = (high - low) / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|i| (low + (f64::from(i) + 0.5) * width).exp() - x)
                .map(|d| 35.0 / 96.0 * (1.0 - (d / 3.0).powi(2)).max(0.0).powi(3) * width)
                .sum();
            let (value, _) = ROUGH.inverse_thickness(x * ROUGH.rms);
            // The closed form leaves out terms of the order of the least gap.
            assert_relative_eq!(value * ROUGH.rms, sum, max_relative = 1e-2);
        }
        let (far, _) = ROUGH.inverse_thickness(1e-4);
        assert_relative_eq!(far, 1e4, max_relative = 1e-4);
        // No jump of value or slope where the series takes over.
        let [below, above] = [1.0 - 1e-9, 1.0 + 1e-9].map(|near| ROUGH.inverse_thickness(9.0 * near * ROUGH.rms));
        assert_relative_eq!(below.0, above.0, max_relative = 1e-8);
        assert_relative_eq!(below.1, above.1, max_relative = 1e-8);
    }

    #[test]
    fn a_thick_film_does_not_feel_the_roughness() {
        let h = 30.0 * ROUGH.rms;
        assert!(ROUGH.pressure(h).0 < 1e-15 * ROUGH.asperity_pressure);
        assert_relative_eq!(ROUGH.thickness(h).0, h, max_relative = 1e-6);
        assert_relative_eq!(ROUGH.flow_factor(h).0, 1.0, max_relative = 1e-6);
        assert_relative_eq!(ROUGH.inverse_thickness(h).0, 1.0 / h, max_relative = 2e-3);
        assert_relative_eq!(ROUGH.real_contact_fraction(0.0).0, 0.5, max_relative = 1e-12);
    }
}
