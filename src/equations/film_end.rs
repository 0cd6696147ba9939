//! The film beyond the modelled sector (consistent formulation).
//!
//! Out there nothing deforms: the gap is h(x) = h_e + g(x) - g(x_e), with g that of the undeformed surfaces, and the film ends where
//! it is infinitely thick, at p = 0. Its flux Q does not change on the way, and Reynolds' equation p' = 12 eta (U h/2 - Q)/h^3
//! gives at the end x_e of the sector
//!
//! e Q = e U I_2/(2 I_3) + p_e/(12 eta I_3),   I_n = int dx/h^n from x_e to infinity,
//!
//! with e = 1 on the right and -1 on the left, where the integrals run the other way. What a changing gap stores out there is left
//! out: the sector has to be wide.

use num_dual::Dual64;

/// The undeformed surfaces at an end of the sector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmEnd {
    /// 1 on the right, -1 on the left.
    pub side: f64,
    /// Outward slope of the gap [1].
    pub slope: f64,
    /// Curvature of the gap [1/m].
    pub curvature: f64,
    /// Viscosity of the fluid [Pa s].
    pub viscosity: f64,
}

/// Flux that leaves the sector, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outflow {
    /// e Q [m^2/s].
    pub value: f64,
    /// By the gap at the end [m/s].
    pub by_gap: f64,
    /// By the pressure there.
    pub by_pressure: f64,
    /// By the sliding speed U [m].
    pub by_speed: f64,
}

/// A gap at the end that is smaller than this counts as this: contact has reached the end, which a warning tells.
const LEAST_GAP: f64 = 1e-7;

impl FilmEnd {
    /// I_1 to I_4, with the gap at the end.
    fn integrals(&self, gap: f64) -> [f64; 4] {
        // Double exponential quadrature, over the length on which the gap doubles.
        let length = gap / (self.slope + (0.5 * self.curvature * gap).sqrt());
        const STEP: f64 = 0.125;
        let mut sums = [0.0; 4];
        for i in -28..=28 {
            let (t, quarter) = (STEP * f64::from(i), std::f64::consts::FRAC_PI_2);
            let place = length * (quarter * t.sinh()).exp();
            let weight = STEP * place * quarter * t.cosh();
            let h = gap + place * (self.slope + 0.5 * self.curvature * place);
            let mut power = weight;
            for sum in &mut sums {
                power /= h;
                *sum += power;
            }
        }
        sums
    }

    /// The flux for a pressure and a gap at the end and a sliding speed.
    pub fn outflow(&self, gap: f64, pressure: f64, sliding_speed: f64) -> Outflow {
        let [_, two, three, four] = self.integrals(gap.max(LEAST_GAP));
        let conductance = 1.0 / (12.0 * self.viscosity * three);
        let carried = 0.5 * self.side * two / three;
        let open = f64::from(gap > LEAST_GAP);
        Outflow {
            value: carried * sliding_speed + conductance * pressure,
            // dI_n/dh = -n I_(n+1)
            by_gap: open
                * (0.5 * self.side * sliding_speed * (3.0 * two * four / (three * three) - 2.0)
                    + 3.0 * conductance * pressure * four / three),
            by_pressure: conductance,
            by_speed: carried,
        }
    }

    /// What the film beyond adds to the two parts of the friction forces, with its change: the integral of (h/2) p' and that of dx/h.
    pub fn shear(&self, gap: Dual64, pressure: Dual64, sliding_speed: Dual64) -> [Dual64; 2] {
        let open = f64::from(gap.re > LEAST_GAP);
        let [one, two, three, _] = self.integrals(gap.re.max(LEAST_GAP));
        // dI_n/dh = -n I_(n+1)
        let [one, two] =
            [(one, -two), (two, -2.0 * three)].map(|(value, slope)| Dual64::new(value, open * slope * gap.eps));
        let Outflow { value, by_gap, by_pressure, by_speed } = self.outflow(gap.re, pressure.re, sliding_speed.re);
        let change = by_gap * gap.eps + by_pressure * pressure.eps + by_speed * sliding_speed.eps;
        let flux = Dual64::new(value, change) * self.side;
        [(sliding_speed * one * 0.5 - flux * two) * (6.0 * self.viscosity), one]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const END: FilmEnd = FilmEnd { side: 1.0, slope: 0.1, curvature: 20.0, viscosity: 1e-3 };

    #[test]
    fn integrals_are_those_of_a_parabola() {
        // From the middle: int dx/(1 + x^2/2R)^n h0^n, with s = sqrt(2 R h0): s pi/2 h0^-1, s pi/4 h0^-2, 3 pi s/16, 5 pi s/32.
        let (h0, curvature) = (3e-6, 20.0);
        let s = f64::sqrt(2.0 * h0 / curvature);
        let end = FilmEnd { slope: 0.0, curvature, ..END };
        let pi = std::f64::consts::PI;
        for (n, (value, factor)) in end.integrals(h0).into_iter().zip([0.5, 0.25, 0.1875, 0.15625]).enumerate() {
            assert_relative_eq!(value, s * pi * factor / h0.powi(n as i32 + 1), max_relative = 1e-8);
        }
        // From a place further out, n = 2 and a gap below zero in the middle: what is left of the integral of 1/(x^2/2R - c)^2.
        let (c, x) = (5e-6, 2e-3);
        let a = f64::sqrt(2.0 * c / curvature);
        let end = FilmEnd { slope: curvature * x, curvature, ..END };
        let log = ((x + a) / (x - a)).ln();
        let exact = (2.0 / curvature).powi(2) * (x / (2.0 * a * a * (x * x - a * a)) - log / (4.0 * a.powi(3)));
        assert_relative_eq!(end.integrals(0.5 * curvature * x * x - c)[1], exact, max_relative = 1e-7);
    }

    #[test]
    fn derivatives_match_differences() {
        for side in [1.0, -1.0] {
            let end = FilmEnd { side, ..END };
            let (h, p, u) = (4e-5, 120.0, 0.2);
            let flux = end.outflow(h, p, u);
            let central = |f: &dyn Fn(f64) -> f64, step: f64| (f(step) - f(-step)) / (2.0 * step);
            assert_relative_eq!(flux.by_gap, central(&|s| end.outflow(h + s, p, u).value, 1e-9), max_relative = 1e-6);
            assert_relative_eq!(
                flux.by_pressure,
                central(&|s| end.outflow(h, p + s, u).value, 1.0),
                max_relative = 1e-6
            );
            assert_relative_eq!(flux.by_speed, central(&|s| end.outflow(h, p, u + s).value, 1e-3), max_relative = 1e-6);
        }
    }
}
