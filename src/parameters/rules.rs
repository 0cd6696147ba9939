//! What values are allowed together.

use super::{Factors, FluidLaw, Formulation, PARAMETERS, Parameters, SolidLaw};
use crate::error::Error;

/// Least sum of the two curvatures \[1/m\].
const LEAST_CURVATURE: f64 = 1e-3;

impl Parameters {
    /// Checks every value against its range, and the few rules that tie values together.
    ///
    /// # Errors
    /// [`Error::Value`] naming the first parameter that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        let mut copy = *self;
        for row in PARAMETERS {
            row.set(&mut copy, &row.get(self))?;
        }
        if (1..8).contains(&self.mesh.columns) {
            let allowed = "8 or more, or 0 to leave the number to the program";
            return Err(Error::value("mesh.columns", self.mesh.columns, allowed));
        }
        let sector = self.sector_half_angle;
        if sector > 0.0 && sector < 1e-3 {
            return Err(Error::value(
                "sector_half_angle",
                sector,
                "1e-3 rad or more, or 0 for one that goes with the contact",
            ));
        }
        if self.surface_roughness > 0.0 && self.cavitation {
            return Err(Error::value(
                "cavitation",
                true,
                "false with surface_roughness above 0: cavitation between rough surfaces is not modelled; or surface_roughness = 0",
            ));
        }
        if self.surface_roughness == 0.0 && self.solid_fraction > 0.0 {
            return Err(Error::value(
                "solid_fraction",
                self.solid_fraction,
                "0 with smooth surfaces; or surface_roughness above 0",
            ));
        }
        if self.fluid_law == FluidLaw::Carreau && self.zero_shear_viscosity < self.viscosity {
            return Err(Error::value(
                "zero_shear_viscosity",
                self.zero_shear_viscosity,
                format!("viscosity, {}, or more with fluid_law carreau; or fluid_law = \"newtonian\"", self.viscosity),
            ));
        }
        let curvature = self.upper.curvature() + self.lower.curvature();
        if curvature < LEAST_CURVATURE {
            return Err(Error::value(
                "lower.outer_radius",
                self.lower.outer_radius,
                format!(
                    "with upper.outer_radius {} one that leaves a gap beside the point of contact: 1/upper + 1/lower of {LEAST_CURVATURE} 1/m or more",
                    self.upper.outer_radius
                ),
            ));
        }
        for (name, body) in [("upper", &self.upper), ("lower", &self.lower)] {
            if body.outer_radius != 0.0 && body.outer_radius.abs() < 1e-3 {
                let allowed =
                    "1e-3 m or more for a convex surface, -1e-3 m or less for a concave one, or 0 for a flat one";
                return Err(Error::value(&format!("{name}.outer_radius"), body.outer_radius, allowed));
            }
            if self.formulation == Formulation::Paper && body.biot_coefficient == 0.0 {
                return Err(Error::value(
                    &format!("{name}.biot_coefficient"),
                    body.biot_coefficient,
                    "above 0 in the paper's formulation, which weighs the shear modulus with it; or formulation = \"consistent\"",
                ));
            }
            if body.solid_law == SolidLaw::HolmesMow {
                if self.formulation == Formulation::Paper {
                    return Err(Error::value(
                        &format!("{name}.solid_law"),
                        "holmes_mow",
                        "\"neo_hookean\" in the paper's formulation, which weighs the two terms of that law; or formulation = \"consistent\"",
                    ));
                }
                if body.bulk_modulus < 2.0 / 3.0 * body.shear_modulus {
                    return Err(Error::value(
                        &format!("{name}.bulk_modulus"),
                        body.bulk_modulus,
                        format!(
                            "2/3 of {name}.shear_modulus or more, {}, with solid_law holmes_mow, which would not be stable with a \
                             negative Poisson's ratio; or solid_law = \"neo_hookean\"",
                            2.0 / 3.0 * body.shear_modulus
                        ),
                    ));
                }
            }
            if self.formulation == Formulation::Paper && body.fibre_modulus > 0.0 {
                return Err(Error::value(
                    &format!("{name}.fibre_modulus"),
                    body.fibre_modulus,
                    "0 in the paper's formulation, whose equations have no fibres; or formulation = \"consistent\"",
                ));
            }
            if body.middle_zone_end < body.middle_zone_start {
                return Err(Error::value(
                    &format!("{name}.middle_zone_end"),
                    body.middle_zone_end,
                    format!("{name}.middle_zone_start, {}, or more", body.middle_zone_start),
                ));
            }
            // A property that jumps would not be seen by elements that lie across the jump.
            for (zone, factors, limit, value, allowed) in [
                ("surface", &body.surface, "start", body.middle_zone_start, "above 0"),
                ("deep", &body.deep, "end", 1.0 - body.middle_zone_end, "below 1"),
            ] {
                if value == 0.0 && *factors != Factors::NONE {
                    return Err(Error::value(
                        &format!("{name}.middle_zone_{limit}"),
                        if limit == "end" { 1.0 } else { 0.0 },
                        format!(
                            "{allowed} where a {name}.{zone}_*_ratio is not 1: properties that jump are not modelled, they change over a zone"
                        ),
                    ));
                }
            }
            for (zone, factors) in [("surface", &body.surface), ("deep", &body.deep)] {
                let most = 0.9 / body.solid_volume_fraction;
                if factors.solid_volume_fraction > most {
                    return Err(Error::value(
                        &format!("{name}.{zone}_solid_fraction_ratio"),
                        factors.solid_volume_fraction,
                        format!("{most} or less, so that not more than 0.9 of the volume there is solid"),
                    ));
                }
                if body.solid_law == SolidLaw::HolmesMow
                    && body.bulk_modulus * factors.bulk_modulus < 2.0 / 3.0 * body.shear_modulus * factors.shear_modulus
                {
                    return Err(Error::value(
                        &format!("{name}.{zone}_bulk_modulus_ratio"),
                        factors.bulk_modulus,
                        "such that the bulk modulus there is 2/3 of the shear modulus or more, with solid_law holmes_mow",
                    ));
                }
            }
            if body.thickness * body.curvature() >= 0.5 {
                return Err(Error::value(
                    &format!("{name}.thickness"),
                    body.thickness,
                    format!("less than half of {name}.outer_radius, {}", 0.5 * body.outer_radius),
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Body;
    use super::*;

    #[test]
    fn properties_do_not_jump() {
        let stiffer = Factors { shear_modulus: 2.0, ..Factors::NONE };
        for (zones, name) in [([0.0, 0.5], "surface"), ([0.5, 1.0], "deep")] {
            let mut parameters = Parameters::default();
            [parameters.lower.middle_zone_start, parameters.lower.middle_zone_end] = zones;
            assert!(parameters.validate().is_ok());
            // At the end that has a zone, and at the one that has none.
            let (surface, deep) = if name == "surface" { (Factors::NONE, stiffer) } else { (stiffer, Factors::NONE) };
            (parameters.lower.surface, parameters.lower.deep) = (surface, deep);
            assert!(parameters.validate().is_ok());
            (parameters.lower.surface, parameters.lower.deep) = (deep, surface);
            let refusal = parameters.validate().unwrap_err().to_string();
            assert!(refusal.starts_with("lower.middle_zone_") && refusal.contains(name), "{refusal}");
        }
    }

    #[test]
    fn the_paper_s_formulation_has_the_paper_s_solid() {
        let paper = Parameters::default();
        for (name, change) in [
            ("lower.solid_law", (|body| body.solid_law = SolidLaw::HolmesMow) as fn(&mut Body)),
            ("lower.fibre_modulus", |body| body.fibre_modulus = 1e6),
        ] {
            let mut changed = paper;
            change(&mut changed.lower);
            let refusal = changed.validate().unwrap_err().to_string();
            assert!(refusal.starts_with(name) && refusal.contains("consistent"), "{refusal}");
            changed.formulation = Formulation::Consistent;
            assert!(changed.validate().is_ok());
        }
        let mut auxetic = Parameters { formulation: Formulation::Consistent, ..paper };
        auxetic.upper.bulk_modulus = 0.6 * auxetic.upper.shear_modulus;
        assert!(auxetic.validate().is_ok());
        auxetic.upper.solid_law = SolidLaw::HolmesMow;
        assert!(auxetic.validate().unwrap_err().to_string().starts_with("upper.bulk_modulus"));
    }
}
