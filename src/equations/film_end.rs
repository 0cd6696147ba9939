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
//!
//! A lubricant that thins has beyond the sector the viscosity that it has at its end, where it is sheared most, at the walls' rate for
//! sliding, for entrainment far from the contact and for what the pressure drives out, q = p_e/(12 eta I_3):
//! ((U_1 - U_2)/h_e)^2 + (3 U/h_e)^2 + (6 q/h_e^2)^2. Further out it is thicker, but how far such a film goes on is not known.

use num_dual::{Dual64, DualNum};

use crate::laws::fluid::Fluid;

/// The undeformed surfaces at an end of the sector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmEnd {
    /// 1 on the right, -1 on the left.
    pub side: f64,
    /// Outward slope of the gap \[1\].
    pub slope: f64,
    /// Curvature of the gap \[1/m\].
    pub curvature: f64,
    /// The lubricant.
    pub fluid: Fluid,
}

/// Flux that leaves the sector, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outflow {
    /// e Q \[m^2/s\].
    pub value: f64,
    /// Its derivative with respect to the gap at the end \[m/s\].
    pub by_gap: f64,
    /// With respect to the pressure there.
    pub by_pressure: f64,
    /// With respect to the speeds of the upper and the lower surface \[m\].
    pub by_speeds: [f64; 2],
}

/// Flow beyond the end, along a change of what it depends on.
struct Beyond {
    /// e Q \[m^2/s\].
    outflow: Dual64,
    /// Viscosity \[Pa s\].
    viscosity: Dual64,
    /// I_1 and I_2.
    integrals: [Dual64; 2],
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

    /// The flow for a gap and a pressure at the end and speeds of the surfaces, with the integrals for this gap.
    fn beyond(&self, integrals: [f64; 4], gap: Dual64, pressure: Dual64, speeds: [Dual64; 2]) -> Beyond {
        let gap = if gap.re > LEAST_GAP { gap } else { Dual64::from(LEAST_GAP) };
        // dI_n/dh = -n I_(n+1)
        let [one, two, three] =
            [0, 1, 2].map(|n| Dual64::new(integrals[n], -(n as f64 + 1.0) * integrals[n + 1] * gap.eps));
        let sliding_speed = speeds[0] + speeds[1];
        let slid = (speeds[0] - speeds[1]) / gap;
        let carried = sliding_speed / gap * 3.0;
        let viscosity = |driven: Dual64| {
            self.fluid.viscosity(slid * slid + carried * carried + (driven / (gap * gap) * 6.0).powi(2))
        };
        // q eta(q) is concave in q > 0: from the left Newton's method goes up to the root, in one step where the viscosity is constant. The
        // step from the root has the change along that of gap, pressure and speeds.
        let mut driven = 0.0;
        for _ in 0..100 {
            let at = Dual64::new(driven, 1.0);
            let constant = |value: Dual64| Dual64::from(value.re);
            let rate = constant(slid).powi(2) + constant(carried).powi(2) + (at / (gap.re * gap.re) * 6.0).powi(2);
            let balance = self.fluid.viscosity(rate) * at * (12.0 * three.re);
            let step = (pressure.re - balance.re) / balance.eps;
            let next = Dual64::from(driven);
            driven += step;
            if step.abs() <= 1e-13 * driven.abs() {
                let missing = pressure - viscosity(next) * three * next * 12.0;
                let driven = Dual64::new(driven, missing.eps / balance.eps);
                let outflow = sliding_speed * two / three * (0.5 * self.side) + driven;
                return Beyond { outflow, viscosity: viscosity(driven), integrals: [one, two] };
            }
        }
        Beyond { outflow: Dual64::from(f64::NAN), viscosity: viscosity(Dual64::from(driven)), integrals: [one, two] }
    }

    /// The flux for a gap and a pressure at the end and speeds of the surfaces.
    pub fn outflow(&self, gap: f64, pressure: f64, speeds: [f64; 2]) -> Outflow {
        let integrals = self.integrals(gap.max(LEAST_GAP));
        let along = |change: [f64; 4]| {
            let dual = |value: f64, k: usize| Dual64::new(value, change[k]);
            self.beyond(integrals, dual(gap, 0), dual(pressure, 1), [dual(speeds[0], 2), dual(speeds[1], 3)]).outflow
        };
        let by_gap = along([1.0, 0.0, 0.0, 0.0]);
        Outflow {
            value: by_gap.re,
            by_gap: by_gap.eps,
            by_pressure: along([0.0, 1.0, 0.0, 0.0]).eps,
            by_speeds: [along([0.0, 0.0, 1.0, 0.0]).eps, along([0.0, 0.0, 0.0, 1.0]).eps],
        }
    }

    /// What the film beyond adds to the two parts of the friction forces, with its change: the integrals of (h/2) p' and of
    /// eta (U1 - U2)/h.
    pub fn shear(&self, gap: Dual64, pressure: Dual64, speeds: [Dual64; 2]) -> [Dual64; 2] {
        let integrals = self.integrals(gap.re.max(LEAST_GAP));
        let Beyond { outflow, viscosity, integrals: [one, two] } = self.beyond(integrals, gap, pressure, speeds);
        let carried = (speeds[0] + speeds[1]) * one * 0.5;
        [(carried - outflow * two * self.side) * viscosity * 6.0, (speeds[0] - speeds[1]) * viscosity * one]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::fluid::Carreau;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    const END: FilmEnd = FilmEnd { side: 1.0, slope: 0.1, curvature: 20.0, fluid: Fluid::Newtonian(ETA) };
    const ETA: f64 = 1e-3;

    const SYNOVIAL: Carreau =
        Carreau { zero_shear_viscosity: 40.0, infinite_shear_viscosity: 1e-3, relaxation_time: 22.0, flow_index: 0.27 };

    /// I_1 to I_3 of a constant viscosity, by what they make of unit speeds and pressures.
    fn integrals(end: &FilmEnd, gap: f64) -> [f64; 3] {
        let outflow = end.outflow(gap, 1.0, [0.0; 2]);
        let three = 1.0 / (12.0 * ETA * outflow.by_pressure);
        assert_relative_eq!(outflow.value, outflow.by_pressure, max_relative = 1e-12);
        let two = 2.0 * three * end.outflow(gap, 0.0, [0.5, 0.5]).value;
        let shear = end.shear(gap.into(), 0.0.into(), [1.0, 0.0].map(Dual64::from));
        [shear[1].re / ETA, two, three]
    }

    #[test]
    fn integrals_are_those_of_a_parabola() {
        // From the middle: int dx/(1 + x^2/2R)^n h0^n, with s = sqrt(2 R h0): s pi/2 h0^-1, s pi/4 h0^-2, 3 pi s/16.
        let (h0, curvature) = (3e-6, 20.0);
        let s = f64::sqrt(2.0 * h0 / curvature);
        let end = FilmEnd { slope: 0.0, curvature, ..END };
        for (n, (value, factor)) in integrals(&end, h0).into_iter().zip([0.5, 0.25, 0.1875]).enumerate() {
            assert_relative_eq!(value, s * PI * factor / h0.powi(n as i32 + 1), max_relative = 1e-8);
        }
        // Rolling: int (h/2) p' dx = 6 eta (U I_1/2 - Q I_2), Q = 2 U h0/3.
        let rolling = end.shear(h0.into(), 0.0.into(), [0.1, 0.1].map(Dual64::from))[0].re;
        assert_relative_eq!(rolling, 6.0 * ETA * 0.2 * s * PI / h0 * (0.25 - 1.0 / 6.0), max_relative = 1e-7);
        // From a place further out, n = 2 and a gap below zero in the middle: what is left of the integral of 1/(x^2/2R - c)^2.
        let (c, x) = (5e-6, 2e-3);
        let a = f64::sqrt(2.0 * c / curvature);
        let end = FilmEnd { slope: curvature * x, curvature, ..END };
        let log = ((x + a) / (x - a)).ln();
        let exact = (2.0 / curvature).powi(2) * (x / (2.0 * a * a * (x * x - a * a)) - log / (4.0 * a.powi(3)));
        assert_relative_eq!(integrals(&end, 0.5 * curvature * x * x - c)[1], exact, max_relative = 1e-7);
    }

    /// Without speed the flux has the viscosity at the rate 6 q/h_e^2, and grows as the power 1/n of the pressure where that thins.
    #[test]
    fn pressure_drives_a_thinning_fluid_out() {
        let end = FilmEnd { fluid: Fluid::Carreau(SYNOVIAL), ..END };
        let gap = 4e-5;
        let three = integrals(&END, gap)[2];
        let outflow = |pressure: f64| end.outflow(gap, pressure, [0.0; 2]).value;
        for pressure in [1e-3, 1.0, 1e3, 1e6] {
            let rate = 6.0 * outflow(pressure) / (gap * gap);
            let carried = 12.0 * SYNOVIAL.stress(rate).0 / rate * three * outflow(pressure);
            assert_relative_eq!(carried, pressure, max_relative = 1e-9);
        }
        let power_law = Carreau { relaxation_time: 1e4, infinite_shear_viscosity: 1e-9, ..SYNOVIAL };
        let end = FilmEnd { fluid: Fluid::Carreau(power_law), ..END };
        let outflow = |pressure: f64| end.outflow(gap, pressure, [0.0; 2]).value;
        assert_relative_eq!((outflow(20.0) / outflow(10.0)).log2(), 1.0 / SYNOVIAL.flow_index, max_relative = 1e-2);
    }

    #[test]
    fn derivatives_match_differences() {
        for fluid in [Fluid::Newtonian(ETA), Fluid::Carreau(SYNOVIAL)] {
            for (side, speeds) in [(1.0, [0.1, 0.1]), (-1.0, [0.15, 0.05]), (1.0, [-0.3, 0.1])] {
                let end = FilmEnd { side, fluid, ..END };
                let (h, p) = (4e-5, 120.0);
                let flux = end.outflow(h, p, speeds);
                let central = |f: &dyn Fn(f64) -> f64, step: f64| (f(step) - f(-step)) / (2.0 * step);
                let moved = |s: f64, k: usize| -> [f64; 2] {
                    std::array::from_fn(|i| speeds[i] + if i == k { s } else { 0.0 })
                };
                let by_gap = central(&|s| end.outflow(h + s, p, speeds).value, 1e-9);
                let by_pressure = central(&|s| end.outflow(h, p + s, speeds).value, 1e-3);
                assert_relative_eq!(flux.by_gap, by_gap, max_relative = 1e-5);
                assert_relative_eq!(flux.by_pressure, by_pressure, max_relative = 1e-5);
                for k in 0..2 {
                    let by_speed = central(&|s| end.outflow(h, p, moved(s, k)).value, 1e-5);
                    assert_relative_eq!(flux.by_speeds[k], by_speed, max_relative = 1e-5);
                }
                let shear = |s: f64, change: f64| {
                    let dual = |value: f64, by: f64| Dual64::new(value + s * by, change * by);
                    end.shear(dual(h, 1e-5), dual(p, 30.0), [dual(speeds[0], 0.02), dual(speeds[1], -0.03)])
                };
                for k in 0..2 {
                    let by = central(&|s| shear(s, 0.0)[k].re, 1e-4);
                    assert_relative_eq!(shear(0.0, 1.0)[k].eps, by, max_relative = 1e-5);
                }
            }
        }
    }
}
