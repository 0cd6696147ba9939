//! The balance of a given load per unit depth, L = W, with the penetration depth d as its unknown.
//!
//! It borders the tangent K of the equations at a given depth: with their residual r and that of the load, s,
//!
//! ```text
//! | K      r_d  | | dz |   | r |
//! | L_z    L_d  | | dd | = | s |
//! ```
//!
//! Block elimination takes the factors of K alone: u = K^-1 r, and z_d = -K^-1 r_d, by which a solution changes with the depth. Then
//!
//! dd = (s - L_z u) / (dL/dd),   dz = u + z_d dd,   with the stiffness dL/dd = L_d + L_z z_d of the contact.

/// Largest change of the depth in one iteration, as a fraction of the layers' thickness.
pub const LARGEST_APPROACH: f64 = 0.02;

/// The equation of a given load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadBalance {
    /// The load W that is given \[N/m\].
    pub given: f64,
    /// Thickness of the layers \[m\].
    pub thickness: f64,
}

impl LoadBalance {
    /// The residual s at a load L, so that its derivative with respect to L is 1 \[N/m\]. In a film the load grows with powers of the
    /// depth: below the given one its logarithm is nearer to a straight line.
    pub fn residual(&self, load: f64) -> f64 {
        const LOGARITHMIC: f64 = 1e-3;
        let given = self.given;
        if load > LOGARITHMIC * given && load < given {
            let slope = given / load;
            given * (load / given).ln() / slope
        } else {
            load - given
        }
    }

    /// Change of the depth that makes up for a residual, within what is wise: `along` is the change L_z u of the load along the update
    /// at a given depth.
    pub fn depth_update(&self, residual: f64, along: f64, stiffness: f64) -> f64 {
        let most = LARGEST_APPROACH * self.thickness;
        ((residual - along) / stiffness).clamp(-most, most)
    }

    /// What a change of the depth is measured against: the depth counts like a displacement of a thousandth of the thickness.
    pub fn depth_scale(&self, depth: f64) -> f64 {
        depth.abs() + 1e-3 * self.thickness
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const BALANCE: LoadBalance = LoadBalance { given: 50.0, thickness: 1e-3 };

    #[test]
    fn the_residual_is_scaled_to_the_load() {
        assert_eq!(BALANCE.residual(50.0), 0.0);
        for load in [49.999, 50.001] {
            assert_relative_eq!(BALANCE.residual(load), load - 50.0, max_relative = 1e-4);
        }
        // Of L = c exp(d/l) the logarithm is a straight line: one step reaches it.
        let (length, load) = (1e-6, 10.0);
        let update = BALANCE.depth_update(BALANCE.residual(load), 0.0, load / length);
        assert_relative_eq!(load * (-update / length).exp(), 50.0, max_relative = 1e-12);
    }

    /// The bordered system of two unknowns, solved whole.
    #[test]
    fn block_elimination_solves_the_bordered_system() {
        let (k, by_depth, along, at_depth) = ([[4.0, 1.0], [-2.0, 3.0]], [0.5, -1.5], [2.0, -1.0], 0.7);
        let (r, s) = ([1.0, 2.0], 1e-6);
        let solve = |f: [f64; 2]| {
            let determinant = k[0][0] * k[1][1] - k[0][1] * k[1][0];
            [(f[0] * k[1][1] - k[0][1] * f[1]) / determinant, (k[0][0] * f[1] - f[0] * k[1][0]) / determinant]
        };
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let (u, z_d) = (solve(r), solve(by_depth).map(|v| -v));
        let balance = LoadBalance { thickness: 1e3, ..BALANCE };
        let dd = balance.depth_update(s, dot(along, u), at_depth + dot(along, z_d));
        let dz = [u[0] + z_d[0] * dd, u[1] + z_d[1] * dd];
        for i in 0..2 {
            assert_relative_eq!(dot(k[i], dz) + by_depth[i] * dd, r[i], max_relative = 1e-12);
        }
        assert_relative_eq!(dot(along, dz) + at_depth * dd, s, max_relative = 1e-9);
        let far = BALANCE.depth_update(1.0, 0.0, 1e-3);
        assert_eq!(far, LARGEST_APPROACH * BALANCE.thickness);
    }
}
