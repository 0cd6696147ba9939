//! The lubricating film: Reynolds' flux and the mean shear stress over it.

use num_dual::Dual64;

use super::fluid::Fluid;

/// Volume flux per unit depth Q = -h^3/(12 eta) dp/dx + U h / 2 (equation 7) with its derivatives. A negative gap is a closed
/// film: no flux.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReynoldsFlux {
    /// Q \[m^2/s\].
    pub value: f64,
    /// What pressure drives of it.
    pub driven: f64,
    /// dQ/dh \[m/s\].
    pub by_film_thickness: f64,
    /// dQ/d(dp/dx) \[m^4/(N s) m\].
    pub by_pressure_gradient: f64,
    /// With respect to the sum of the speeds of the surfaces \[m\].
    pub by_speed_sum: f64,
    /// With respect to their difference.
    pub by_speed_difference: f64,
}

/// Mean shear rate (U1 - U2) / (h + offset) of a film between smooth surfaces \[1/s\], and its derivative with respect to the gap. The offset keeps it
/// finite in contact.
pub fn mean_shear_rate(gap: f64, speed_difference: f64, offset: f64) -> (f64, f64) {
    if gap < 0.0 {
        return (speed_difference / offset, 0.0);
    }
    let rate = speed_difference / (gap + offset);
    (rate, -rate / (gap + offset))
}

/// Reynolds' flux for a gap \[m\], a pressure gradient \[Pa/m\], the sum and the difference of the surfaces' speeds \[m/s\] and the offset of
/// the shear rate \[m\]. The viscosity is that of [`Fluid::sheared`].
pub fn reynolds_flux(
    fluid: &Fluid,
    gap: f64,
    pressure_gradient: f64,
    [speed, speed_difference]: [f64; 2],
    offset: f64,
) -> ReynoldsFlux {
    if gap <= 0.0 {
        return ReynoldsFlux::default();
    }
    let (rate, rate_slope) = mean_shear_rate(gap, speed_difference, offset);
    let film = fluid.sheared(rate, 0.5 * gap * pressure_gradient);
    let conductance = gap.powi(3) / (12.0 * film.viscosity);
    let by_viscosity = conductance * pressure_gradient / film.viscosity;
    let by_rate = by_viscosity * film.viscosity_by_rate;
    let by_difference = by_viscosity * film.viscosity_by_difference;
    ReynoldsFlux {
        value: -conductance * pressure_gradient + 0.5 * speed * gap,
        driven: -conductance * pressure_gradient,
        by_film_thickness: -3.0 * conductance / gap * pressure_gradient
            + 0.5 * speed
            + by_rate * rate_slope
            + by_difference * 0.5 * pressure_gradient,
        by_pressure_gradient: -conductance + by_difference * 0.5 * gap,
        by_speed_sum: 0.5 * gap,
        by_speed_difference: by_rate / (gap + offset),
    }
}

/// Mean shear stress over the film \[Pa\], with its change, of which both walls feel the opposite: the part of equation 15 that acts with the
/// same sign in the two friction forces; viscosity times mean shear rate where the fluid is Newtonian. (The other part is (h/2) dp/dx.)
pub fn mean_shear_stress(fluid: &Fluid, thickness: Dual64, shear_rate: Dual64, pressure_gradient: Dual64) -> Dual64 {
    let difference = thickness * pressure_gradient * 0.5;
    let film = fluid.sheared(shear_rate.re, difference.re);
    Dual64::new(film.stress, film.stress_by_rate * shear_rate.eps + film.stress_by_difference * difference.eps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::fluid::Carreau;
    use approx::assert_relative_eq;

    const SYNOVIAL: Fluid = Fluid::Carreau(Carreau {
        zero_shear_viscosity: 40.0,
        infinite_shear_viscosity: 1e-3,
        relaxation_time: 22.0,
        flow_index: 0.27,
    });
    const OFFSET: f64 = 1e-7;

    #[test]
    fn derivatives_match_finite_differences() {
        for fluid in [Fluid::Newtonian(1e-3), SYNOVIAL] {
            for speeds in [[0.2, 0.0], [0.15, 0.25], [-0.1, -0.3]] {
                let (h, g) = (3e-6, -2e6);
                let flux = |h, g, speeds| reynolds_flux(&fluid, h, g, speeds, OFFSET).value;
                let at = reynolds_flux(&fluid, h, g, speeds, OFFSET);
                let central = |f: &dyn Fn(f64) -> f64, step: f64| (f(step) - f(-step)) / (2.0 * step);
                let by_h = central(&|s| flux(h + s, g, speeds), 1e-10);
                let by_g = central(&|s| flux(h, g + s, speeds), 1e2);
                assert_relative_eq!(at.by_film_thickness, by_h, max_relative = 1e-6);
                assert_relative_eq!(at.by_pressure_gradient, by_g, max_relative = 1e-6);
                for k in 0..2 {
                    let moved = |s: f64| std::array::from_fn(|i| speeds[i] + if i == k { s } else { 0.0 });
                    assert_relative_eq!(
                        [at.by_speed_sum, at.by_speed_difference][k],
                        central(&|s| flux(h, g, moved(s)), 1e-5),
                        max_relative = 1e-6,
                        epsilon = 1e-10
                    );
                }
                // The shear, along a change of all it depends on.
                let shear = |s: f64, change: f64| {
                    let dual = |value: f64, by: f64| Dual64::new(value + s * by, change * by);
                    let rate = speeds[1] / h;
                    mean_shear_stress(&fluid, dual(h, 2e-6), dual(rate, 1e4), dual(g, 1e6))
                };
                assert_relative_eq!(shear(0.0, 1.0).eps, central(&|s| shear(s, 0.0).re, 2e-8), max_relative = 1e-5);
            }
        }
    }

    #[test]
    fn a_closed_film_carries_nothing() {
        assert_eq!(reynolds_flux(&SYNOVIAL, -1e-9, 1e6, [0.5, 0.5], OFFSET).value, 0.0);
        let [thickness, rate, gradient] = [0.0, 0.0, 1e6].map(Dual64::from);
        assert_eq!(mean_shear_stress(&SYNOVIAL, thickness, rate, gradient).re, 0.0);
    }
}
