//! Parameters of tissues that were measured, by name.

use crate::laws::Formulation;

use super::{Body, Factors, Mesh, MeshDistribution, Parameters};

/// Where all parameters start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Preset {
    /// Table 2 of de Boer et al. (2020).
    Paper,
    /// Human tibial plateau.
    HumanTibialPlateau,
    /// Human lateral femoral condyle.
    HumanFemoralCondyle,
    /// Normal human cartilage.
    HumanNormal,
    /// Calf's humeral head.
    BovineHumeralHead,
    /// Cartilage after collagenase, as in osteoarthritis.
    Osteoarthritic,
    /// Human lateral femoral condyle, with fibres.
    HumanFemoralCondyleFibres,
    /// Calf's humeral head, with fibres.
    BovineHumeralHeadFibres,
    /// Bovine cartilage in layers.
    BovineLayered,
}

/// Cartilage as tests of the biphasic theory report it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tissue {
    /// Aggregate modulus H_A: drained, in uniaxial strain \[Pa\].
    pub aggregate_modulus: f64,
    /// Drained Poisson's ratio \[1\].
    pub poisson_ratio: f64,
    /// Hydraulic permeability \[m^4/(N s)\].
    pub hydraulic_permeability: f64,
    /// Thickness of the layer \[m\].
    pub thickness: f64,
    /// Combined root mean square roughness of two such surfaces \[m\].
    pub roughness: f64,
    /// Tensile modulus E+ of the drained tissue, which fibres add \[Pa\]; 0 where there are none.
    pub tensile_modulus: f64,
    /// Permeability along the surface over that through the depth \[1\].
    pub tangential_permeability_ratio: f64,
    /// Values at the surface and at the bone over those in the middle, linear in between, where the tissue has layers.
    pub layers: Option<[Factors; 2]>,
}

/// Of Newton's method and of one internal step in time: in a walking cycle at body weight a tenth of the second changes support and least
/// film by 1e-4 and rolling friction by 1e-2.
const TOLERANCES: [f64; 2] = [1e-5, 1e-2];

impl Tissue {
    /// Without fibres, with one permeability, alike at all depths.
    const PLAIN: Self = Self {
        aggregate_modulus: 0.0,
        poisson_ratio: 0.0,
        hydraulic_permeability: 0.0,
        thickness: 0.0,
        roughness: 0.3e-6,
        tensile_modulus: 0.0,
        tangential_permeability_ratio: 1.0,
        layers: None,
    };
}

/// One row of [`PRESETS`].
pub struct PresetRow {
    /// The preset of this row.
    pub preset: Preset,
    /// Its name in cases, flags and the FMU.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Where the values are from.
    pub source: &'static str,
    /// What is uncertain about them.
    pub uncertainty: &'static str,
    /// The values; `None` for the paper's Table 2.
    pub tissue: Option<Tissue>,
}

/// Every preset, in the order of [`Preset`].
pub static PRESETS: [PresetRow; 9] = [
    PresetRow {
        preset: Preset::Paper,
        name: "paper",
        description: "Table 2 of de Boer et al. (2020), with its equations as printed",
        source: "de Boer et al., Tribology - Materials, Surfaces & Interfaces 14 (3), 151-165, 2020",
        uncertainty: "its permeability is about a thousand times that of cartilage",
        tissue: None,
    },
    PresetRow {
        preset: Preset::HumanTibialPlateau,
        name: "human_tibial_plateau",
        description: "Human tibial plateau",
        source: "Keenan et al., Computer Methods in Biomechanics and Biomedical Engineering 12 (4), 415-422, 2009 (PMC2858459)",
        uncertainty: "middles of ranges over five sites of one plateau: aggregate modulus 0.48 to 1.58 MPa, Poisson's ratio 0 to \
                      0.05, hydraulic permeability 1.7e-15 to 5.4e-15 m^4/(N s); thickness not given, 2.5 mm is typical of the site",
        tissue: Some(Tissue {
            aggregate_modulus: 1.03e6,
            poisson_ratio: 0.025,
            hydraulic_permeability: 3.55e-15,
            thickness: 2.5e-3,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::HumanFemoralCondyle,
        name: "human_femoral_condyle",
        description: "Human distal femur, lateral condyle",
        source: "Athanasiou et al., Journal of Orthopaedic Research 9 (3), 330-340, 1991",
        uncertainty: "means of a group; sites differ; values as later papers quote them, not yet compared with the article",
        tissue: Some(Tissue {
            aggregate_modulus: 0.70e6,
            poisson_ratio: 0.10,
            hydraulic_permeability: 1.18e-15,
            thickness: 2.3e-3,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::HumanNormal,
        name: "human_normal",
        description: "Normal human cartilage, as test cases of the biphasic theory have it",
        source: "a confined compression test case, tomamil.eu/index.php?id=biphasicfilmsAxisym",
        uncertainty: "no single specimen: Young's modulus 0.675 MPa and Poisson's ratio 0.125, which make the aggregate modulus; \
                      the permeability is at the upper end of what is measured",
        tissue: Some(Tissue {
            aggregate_modulus: 0.70e6,
            poisson_ratio: 0.125,
            hydraulic_permeability: 7.6e-15,
            thickness: 1.78e-3,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::BovineHumeralHead,
        name: "bovine_humeral_head",
        description: "Humeral head of calves six months old",
        source: "Soltz and Ateshian, Journal of Biomechanical Engineering 122 (6), 576-586, 2000 (PMC2854000)",
        uncertainty: "aggregate modulus 0.64 +- 0.22 MPa, axial hydraulic permeability (3.62 +- 0.97)e-16 m^4/(N s), the radial one \
                      is 6.06e-16; in tension the tissue is twenty times stiffer, which only bovine_humeral_head_fibres has; \
                      thickness not given, 1.5 mm is assumed",
        tissue: Some(Tissue {
            aggregate_modulus: 0.64e6,
            poisson_ratio: 0.03,
            hydraulic_permeability: 3.62e-16,
            thickness: 1.5e-3,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::Osteoarthritic,
        name: "osteoarthritic",
        description: "Cartilage after digestion with collagenase, as a stand-in for osteoarthritis",
        source: "Bioengineering 11 (6), 541, 2024",
        uncertainty: "middles of ranges that are not yet compared with the article: aggregate modulus 0.06 to 0.13 MPa, hydraulic \
                      permeability 4.7e-14 to 8.3e-14 m^4/(N s); Poisson's ratio 0.1 and thickness 2 mm are assumed; digestion is \
                      not the disease",
        tissue: Some(Tissue {
            aggregate_modulus: 0.095e6,
            poisson_ratio: 0.1,
            hydraulic_permeability: 6.5e-14,
            thickness: 2.0e-3,
            roughness: 0.75e-6,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::HumanFemoralCondyleFibres,
        name: "human_femoral_condyle_fibres",
        description: "Human distal femur, lateral condyle, with fibres that only pull",
        source: "human_femoral_condyle; tensile modulus after Akizuki et al., Journal of Orthopaedic Research 4 (4), 379-392, 1986",
        uncertainty: "as human_femoral_condyle; the tensile modulus is assumed: the article's summary says that all specimens of human \
                      knees were below 30 MPa and osteoarthritic ones below 2 MPa, and some MPa are quoted for normal condyles",
        tissue: Some(Tissue {
            aggregate_modulus: 0.70e6,
            poisson_ratio: 0.10,
            hydraulic_permeability: 1.18e-15,
            thickness: 2.3e-3,
            tensile_modulus: 5e6,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::BovineHumeralHeadFibres,
        name: "bovine_humeral_head_fibres",
        description: "Humeral head of calves six months old, with fibres that only pull",
        source: "Soltz and Ateshian, Journal of Biomechanical Engineering 122 (6), 576-586, 2000 (PMC2854000)",
        uncertainty: "as bovine_humeral_head; tensile modulus 12.75 +- 1.56 MPa from unconfined compression, radial hydraulic \
                      permeability (6.06 +- 2.10)e-16 m^4/(N s); the article has fibres along three axes, here they are in all directions",
        tissue: Some(Tissue {
            aggregate_modulus: 0.64e6,
            poisson_ratio: 0.03,
            hydraulic_permeability: 3.62e-16,
            thickness: 1.5e-3,
            tensile_modulus: 12.75e6,
            tangential_permeability_ratio: 6.06 / 3.62,
            ..Tissue::PLAIN
        }),
    },
    PresetRow {
        preset: Preset::BovineLayered,
        name: "bovine_layered",
        description: "Bovine cartilage whose modulus and permeability change with depth",
        source: "Chen, Bae, Schinagl and Sah, Journal of Biomechanics 34 (1), 1-12, 2001 (summary)",
        uncertainty: "zero-strain values of three layers: aggregate modulus 0.27 MPa at the surface to 0.71 MPa at the bone, hydraulic \
                      permeability 4.6e-15 to 0.50e-15 m^4/(N s); those in the middle are assumed, the mean and the geometric mean; \
                      Poisson's ratio 0.1 and thickness 1.5 mm are assumed; falling permeability (M 5.5 to 7.4 there) is left out",
        tissue: Some(Tissue {
            aggregate_modulus: 0.49e6,
            poisson_ratio: 0.1,
            hydraulic_permeability: 1.52e-15,
            thickness: 1.5e-3,
            layers: Some([layer(0.27 / 0.49, 4.6 / 1.52), layer(0.71 / 0.49, 0.50 / 1.52)]),
            ..Tissue::PLAIN
        }),
    },
];

/// Both moduli and the permeability, over those in the middle.
const fn layer(moduli: f64, permeability: f64) -> Factors {
    Factors { shear_modulus: moduli, bulk_modulus: moduli, permeability, ..Factors::NONE }
}

/// Names and descriptions, as a parameter lists its choices.
pub(super) const ITEMS: [(&str, &str); 9] = {
    let mut items = [("", ""); 9];
    let mut i = 0;
    while i < items.len() {
        items[i] = (PRESETS[i].name, PRESETS[i].description);
        i += 1;
    }
    items
};

impl Tissue {
    /// Drained shear modulus, H_A (1 - 2 nu) / (2 (1 - nu)) \[Pa\].
    pub fn shear_modulus(&self) -> f64 {
        self.aggregate_modulus * (1.0 - 2.0 * self.poisson_ratio) / (2.0 * (1.0 - self.poisson_ratio))
    }

    /// Drained bulk modulus, H_A (1 + nu) / (3 (1 - nu)) \[Pa\].
    pub fn bulk_modulus(&self) -> f64 {
        self.aggregate_modulus * (1.0 + self.poisson_ratio) / (3.0 * (1.0 - self.poisson_ratio))
    }

    /// Modulus xi of fibres in all directions (power law of `FIBRE_EXPONENT`) that resist the spreading of a plug in fast unconfined
    /// compression, strains e, e, -2e, as the tensile modulus does at e = `FIBRE_STRAIN`: with x = 2 e (1 - 3 c^2)
    /// E+ e = xi int_0^u (1 - c^2) x^2 dc, u^2 = 1/3 \[Pa\].
    pub fn fibre_modulus(&self) -> f64 {
        let u = (1.0_f64 / 3.0).sqrt();
        let mean = u - 7.0 / 3.0 * u.powi(3) + 3.0 * u.powi(5) - 9.0 / 7.0 * u.powi(7);
        self.tensile_modulus / (4.0 * FIBRE_STRAIN * mean)
    }
}

/// Exponent of the presets' fibres: they are recruited as they are stretched. With 2 the stiffness would jump where a strain changes its
/// sign, and Newton's method does not get far with fibres that are much stiffer than what is around them.
const FIBRE_EXPONENT: f64 = 3.0;

/// Strain across a plug, half of that along it, at which presets have the tensile modulus; assumed.
const FIBRE_STRAIN: f64 = 0.05;

impl Preset {
    /// All parameters: Table 2 of the paper; for a tissue with the tissue in both bodies, the consistent formulation, rough
    /// surfaces, and sector and mesh left to the program.
    pub fn parameters(self) -> Parameters {
        let paper = Parameters::default();
        let Some(tissue) = &PRESETS[self as usize].tissue else { return paper };
        let body = Body {
            thickness: tissue.thickness,
            shear_modulus: tissue.shear_modulus(),
            bulk_modulus: tissue.bulk_modulus(),
            permeability: tissue.hydraulic_permeability * paper.viscosity,
            biot_coefficient: 1.0,
            fibre_modulus: tissue.fibre_modulus(),
            fibre_exponent: if tissue.tensile_modulus > 0.0 { FIBRE_EXPONENT } else { paper.upper.fibre_exponent },
            tangential_permeability_ratio: tissue.tangential_permeability_ratio,
            ..paper.upper
        };
        let body = match tissue.layers {
            None => body,
            Some([surface, deep]) => Body { surface, deep, middle_zone_start: 0.5, middle_zone_end: 0.5, ..body },
        };
        Parameters {
            upper: body,
            lower: body,
            formulation: Formulation::Consistent,
            sector_half_angle: 0.0,
            mesh: Mesh { columns: 0, rows: 0, ..paper.mesh },
            mesh_distribution: MeshDistribution::Contact,
            surface_roughness: tissue.roughness,
            pressure_order: 1,
            tolerance: TOLERANCES[0],
            relative_tolerance: TOLERANCES[1],
            preset: self,
            ..paper
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Kind, PARAMETERS, Value, find};
    use approx::assert_relative_eq;

    #[test]
    fn rows_are_in_the_order_of_their_numbers_and_allowed() {
        for (place, row) in PRESETS.iter().enumerate() {
            assert_eq!(row.preset as usize, place, "{}", row.name);
            let parameters = row.preset.parameters();
            parameters.validate().unwrap();
            assert_eq!(find("preset").unwrap().get(&parameters), Value::Text(row.name.into()));
        }
        assert_eq!(Preset::Paper.parameters(), Parameters::default());
    }

    #[test]
    fn moduli_are_those_of_the_measured_tissue() {
        // E = 9 K G / (3 K + G), nu = (3 K - 2 G) / (6 K + 2 G), H_A = K + 4 G / 3
        for tissue in PRESETS.iter().filter_map(|row| row.tissue) {
            let (g, k) = (tissue.shear_modulus(), tissue.bulk_modulus());
            assert_relative_eq!(k + 4.0 / 3.0 * g, tissue.aggregate_modulus, max_relative = 1e-12);
            assert_relative_eq!((3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g), tissue.poisson_ratio, max_relative = 1e-12);
        }
        let body = Preset::HumanNormal.parameters().lower;
        let (g, k) = (body.shear_modulus, body.bulk_modulus);
        assert_relative_eq!(9.0 * k * g / (3.0 * k + g), 0.675e6, max_relative = 1e-12);
        assert_relative_eq!(body.permeability, 7.6e-18, max_relative = 1e-12);
    }

    /// The stress across a plug that is pressed fast, by the law itself, in plane strain and out of it: F = diag(1 + e, 1 - 2e) and F_zz =
    /// 1 + e cannot be had in plane strain, so that the mean over the sphere is summed up here.
    #[test]
    fn fibres_resist_the_spreading_of_a_plug_as_its_tensile_modulus_does() {
        let tissue = PRESETS[Preset::BovineHumeralHeadFibres as usize].tissue.unwrap();
        assert_eq!(PRESETS[Preset::BovineHumeralHead as usize].tissue.unwrap().fibre_modulus(), 0.0);
        let (count, e) = (2000, FIBRE_STRAIN);
        let stress = (0..count).map(|i| {
            let cosine_squared = ((f64::from(i) + 0.5) / f64::from(count)).powi(2);
            let extension = 2.0 * e * (1.0 - 3.0 * cosine_squared);
            // Along one of the two axes across: half of what is not along the plug.
            2.0 * 0.5 * (1.0 - cosine_squared) * tissue.fibre_modulus() * extension.max(0.0).powi(2)
        });
        assert_relative_eq!(stress.sum::<f64>() / f64::from(count), 12.75e6 * e, max_relative = 1e-5);
    }

    #[test]
    fn what_is_set_by_name_wins_whichever_comes_first() {
        let set = |parameters: &mut Parameters, name: &str, value: Value| {
            find(name).unwrap().set(parameters, &value).unwrap();
        };
        let mut expected = Preset::BovineHumeralHead.parameters();
        expected.viscosity = 2e-3;
        let steps = [("viscosity", Value::Real(2e-3)), ("preset", Value::Text("bovine_humeral_head".into()))];
        for order in [[0, 1], [1, 0]] {
            let mut parameters = Parameters::default();
            set(&mut parameters, "preset", Value::Text("osteoarthritic".into()));
            order.into_iter().for_each(|i: usize| set(&mut parameters, steps[i].0, steps[i].1.clone()));
            assert_eq!(parameters, expected);
        }
        // Back to the paper: nothing of the tissue is left.
        let mut parameters = expected;
        set(&mut parameters, "preset", Value::Text("paper".into()));
        assert_eq!(parameters, Parameters::default());
    }

    #[test]
    fn every_parameter_can_be_kept() {
        // A value of each that no preset has; the last row is the preset itself.
        for row in PARAMETERS.into_iter().filter(|row| row.name != "preset") {
            let mut parameters = Parameters::default();
            let value = match row.get(&parameters) {
                Value::Real(v) => Value::Real(1.1 * v + 1e-5 * f64::from(v == 0.0)),
                Value::Integer(v) => Value::Integer(if v == 2 { 1 } else { v + 3 }),
                Value::Boolean(v) => Value::Boolean(!v),
                Value::Text(_) => {
                    let Kind::Choice { items, .. } = &row.kind else { panic!("{} is no choice", row.name) };
                    Value::Text(items[1].0.into())
                }
            };
            row.set(&mut parameters, &value).unwrap();
            find("preset").unwrap().set(&mut parameters, &Value::Text("human_normal".into())).unwrap();
            assert_eq!(row.get(&parameters), value, "{}", row.name);
        }
    }
}
