//! The lubricating film: Reynolds' flux and the shear stress on its walls.

/// Volume flux per unit depth Q = -h^3/(12 eta) dp/dx + U h / 2 (equation 7) with its derivatives. A negative gap is a closed
/// film: no flux.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReynoldsFlux {
    /// Q [m^2/s].
    pub value: f64,
    /// dQ/dh [m/s].
    pub by_film_thickness: f64,
    /// dQ/d(dp/dx) [m^4/(N s) m].
    pub by_pressure_gradient: f64,
    /// dQ/dU [m].
    pub by_sliding_speed: f64,
}

/// Reynolds' flux for a gap [m], a pressure gradient [Pa/m], a sliding speed U1 + U2 [m/s] and a viscosity [Pa s].
pub fn reynolds_flux(gap: f64, pressure_gradient: f64, sliding_speed: f64, viscosity: f64) -> ReynoldsFlux {
    if gap <= 0.0 {
        return ReynoldsFlux { value: 0.0, by_film_thickness: 0.0, by_pressure_gradient: 0.0, by_sliding_speed: 0.0 };
    }
    let conductance = gap.powi(3) / (12.0 * viscosity);
    ReynoldsFlux {
        value: -conductance * pressure_gradient + 0.5 * sliding_speed * gap,
        by_film_thickness: -3.0 * conductance / gap * pressure_gradient + 0.5 * sliding_speed,
        by_pressure_gradient: -conductance,
        by_sliding_speed: 0.5 * gap,
    }
}

/// The two parts of the wall shear stress (equation 15) [Pa]: (h/2) dp/dx, which acts with opposite signs in the two friction
/// forces, and eta (U1 - U2) / (h + offset), which acts with the same sign. The offset keeps the second one finite in contact.
pub fn wall_shear(gap: f64, pressure_gradient: f64, speed_difference: f64, viscosity: f64, offset: f64) -> (f64, f64) {
    let gap = gap.max(0.0);
    (0.5 * gap * pressure_gradient, viscosity * speed_difference / (gap + offset))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn derivatives_match_finite_differences() {
        let (h, g, u, eta) = (3e-6, -2e6, 0.2, 1e-3);
        let flux = reynolds_flux(h, g, u, eta);
        let central = |f: &dyn Fn(f64) -> f64, step: f64| (f(step) - f(-step)) / (2.0 * step);
        let by_h = central(&|s| reynolds_flux(h + s, g, u, eta).value, 1e-10);
        let by_g = central(&|s| reynolds_flux(h, g + s, u, eta).value, 1e2);
        let by_u = central(&|s| reynolds_flux(h, g, u + s, eta).value, 1e-4);
        assert_relative_eq!(flux.by_film_thickness, by_h, max_relative = 1e-7);
        assert_relative_eq!(flux.by_pressure_gradient, by_g, max_relative = 1e-7);
        assert_relative_eq!(flux.by_sliding_speed, by_u, max_relative = 1e-7);
    }

    #[test]
    fn a_closed_film_carries_nothing() {
        assert_eq!(reynolds_flux(-1e-9, 1e6, 1.0, 1e-3).value, 0.0);
        assert_eq!(wall_shear(-1e-9, 1e6, 0.0, 1e-3, 1e-7), (0.0, 0.0));
    }
}
