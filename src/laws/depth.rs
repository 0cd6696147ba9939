//! How properties of the tissue change with the depth below the articular surface.

/// Factors of a tissue's properties, or how these compare with those of the middle zone \[1\].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Factors {
    /// Of the drained shear modulus.
    pub shear_modulus: f64,
    /// Of the drained bulk modulus.
    pub bulk_modulus: f64,
    /// Of the modulus of the fibres.
    pub fibre_modulus: f64,
    /// Of the permeability.
    pub permeability: f64,
    /// Of the volume fraction of the solid.
    pub solid_volume_fraction: f64,
}

impl Factors {
    /// No change.
    pub const NONE: Self = Self {
        shear_modulus: 1.0,
        bulk_modulus: 1.0,
        fibre_modulus: 1.0,
        permeability: 1.0,
        solid_volume_fraction: 1.0,
    };

    /// (1 - x) * self + x * other.
    fn towards(&self, other: &Self, x: f64) -> Self {
        let mix = |a: f64, b: f64| a + x * (b - a);
        Self {
            shear_modulus: mix(self.shear_modulus, other.shear_modulus),
            bulk_modulus: mix(self.bulk_modulus, other.bulk_modulus),
            fibre_modulus: mix(self.fibre_modulus, other.fibre_modulus),
            permeability: mix(self.permeability, other.permeability),
            solid_volume_fraction: mix(self.solid_volume_fraction, other.solid_volume_fraction),
        }
    }
}

/// Piecewise linear in the depth: from the surface to the middle zone, constant in it, and from there to the bone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthProfile {
    /// At the surface.
    pub surface: Factors,
    /// At the bone.
    pub deep: Factors,
    /// Where the middle zone begins and ends, as fractions of the thickness.
    pub middle_zone: [f64; 2],
}

impl DepthProfile {
    /// Factors at a depth, given as a fraction of the thickness.
    pub fn at(&self, depth: f64) -> Factors {
        let [start, end] = self.middle_zone;
        if depth < start {
            self.surface.towards(&Factors::NONE, depth / start)
        } else if depth > end {
            Factors::NONE.towards(&self.deep, (depth - end) / (1.0 - end))
        } else {
            Factors::NONE
        }
    }

    /// Mean of a factor over the thickness.
    pub fn mean(&self, factor: impl Fn(&Factors) -> f64) -> f64 {
        let [start, end] = self.middle_zone;
        0.5 * (1.0 + factor(&self.surface)) * start + (end - start) + 0.5 * (1.0 + factor(&self.deep)) * (1.0 - end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_is_linear_between_its_depths() {
        let surface = Factors { permeability: 3.0, shear_modulus: 0.5, ..Factors::NONE };
        let profile = DepthProfile { surface, deep: Factors { permeability: 0.2, ..surface }, middle_zone: [0.2, 0.6] };
        for (depth, permeability, shear_modulus) in
            [(0.0, 3.0, 0.5), (0.1, 2.0, 0.75), (0.2, 1.0, 1.0), (0.5, 1.0, 1.0), (0.8, 0.6, 0.75), (1.0, 0.2, 0.5)]
        {
            let factors = profile.at(depth);
            assert!((factors.permeability - permeability).abs() < 1e-15, "{depth}: {factors:?}");
            assert!((factors.shear_modulus - shear_modulus).abs() < 1e-15, "{depth}: {factors:?}");
            assert_eq!(factors.solid_volume_fraction, 1.0);
        }
        let sum: f64 = (0..1000).map(|i| profile.at((f64::from(i) + 0.5) / 1000.0).permeability / 1000.0).sum();
        assert!((profile.mean(|factors| factors.permeability) - sum).abs() < 1e-6);
        // Zones of no extent.
        let narrow = DepthProfile { middle_zone: [0.0, 1.0], ..profile };
        assert_eq!([narrow.at(0.0), narrow.at(1.0)], [Factors::NONE; 2]);
    }
}
