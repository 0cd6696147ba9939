//! What a case is made of: two bodies, the lubricant between them, their contact, and the numerics.
//!
//! [`PARAMETERS`] is the one table of names, units, ranges and descriptions. Case files, command-line flags and the FMU
//! all read it, so a parameter has the same name everywhere. Values are SI.

mod presets;
mod rules;
mod table;

use crate::laws::depth::DepthProfile;
pub use crate::laws::depth::Factors;
pub use crate::laws::roughness::AsperityLaw;
pub use crate::laws::{FluidLaw, Formulation, PermeabilityLaw, SolidLaw};
pub use presets::{PRESETS, Preset, PresetRow, Tissue};
pub use table::{Kind, PARAMETERS, Parameter, Value, find};

/// One cartilage layer on its bone.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Body {
    /// Radius of the articular surface \[m\]: negative where it is concave, 0 where it is flat.
    pub outer_radius: f64,
    /// Thickness of the layer \[m\].
    pub thickness: f64,
    /// Drained shear modulus \[Pa\].
    pub shear_modulus: f64,
    /// Drained bulk modulus \[Pa\].
    pub bulk_modulus: f64,
    /// Intrinsic permeability of the undeformed tissue \[m^2\].
    pub permeability: f64,
    /// Biot-Willis coefficient \[1\].
    pub biot_coefficient: f64,
    /// Volume fraction of the solid in the undeformed tissue \[1\]; like the next two of [`PermeabilityLaw::HolmesMow`] only.
    pub solid_volume_fraction: f64,
    /// Exponent of the pore volume in the permeability \[1\].
    pub permeability_exponent: f64,
    /// Coefficient of the exponential in the permeability \[1\].
    pub permeability_strain_coefficient: f64,
    /// How the drained solid answers to strain; both moduli are those at small strain.
    pub solid_law: SolidLaw,
    /// Coefficient of the exponential in the strain energy \[1\] ([`SolidLaw::HolmesMow`] only).
    pub stiffening_coefficient: f64,
    /// Modulus of the fibres that only pull \[Pa\]; 0: there are none.
    pub fibre_modulus: f64,
    /// Exponent of their strain energy \[1\].
    pub fibre_exponent: f64,
    /// Coefficient of the exponential in it \[1\]; 0: a power law.
    pub fibre_exponential_coefficient: f64,
    /// Permeability along the articular surface over that through the depth \[1\].
    pub tangential_permeability_ratio: f64,
    /// Depth where the middle zone begins, whose properties are those above, as a fraction of the thickness \[1\].
    pub middle_zone_start: f64,
    /// Depth where it ends, likewise \[1\].
    pub middle_zone_end: f64,
    /// Properties at the surface over those of the middle zone; linear in between.
    pub surface: Factors,
    /// Properties at the bone over those of the middle zone; linear in between.
    pub deep: Factors,
}

impl Body {
    /// How properties change with depth; `None` where they do not.
    pub fn depth_profile(&self) -> Option<DepthProfile> {
        let middle_zone = [self.middle_zone_start, self.middle_zone_end];
        let changes = [self.surface, self.deep].iter().any(|factors| *factors != Factors::NONE);
        changes.then_some(DepthProfile { surface: self.surface, deep: self.deep, middle_zone })
    }

    /// Drained modulus of confined compression at the surface, K + 4G/3 \[Pa\].
    pub fn surface_aggregate_modulus(&self) -> f64 {
        let factors = self.depth_profile().map_or(Factors::NONE, |profile| profile.at(0.0));
        self.bulk_modulus * factors.bulk_modulus + 4.0 / 3.0 * self.shear_modulus * factors.shear_modulus
    }

    /// Drained shear modulus, mean over the thickness \[Pa\].
    pub fn mean_shear_modulus(&self) -> f64 {
        self.shear_modulus * self.depth_profile().map_or(1.0, |profile| profile.mean(|factors| factors.shear_modulus))
    }
}

/// Structured mesh of a body: columns along the surface, rows through the thickness.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Mesh {
    /// Elements along the articular surface; 0 leaves the number to the program.
    pub columns: i32,
    /// Elements through the thickness; 0 leaves the number to the program.
    pub rows: i32,
    /// Strength of the sinh grading towards x = 0; 0 is uniform.
    pub column_grading: f64,
    /// Strength of the sinh grading towards the articular surface; 0 is uniform.
    pub row_grading: f64,
}

/// Where the nodes of the mesh are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum MeshDistribution {
    /// By the gradings of [`Mesh`], on a sector that stays.
    Graded,
    /// Dense at the edges of the contact and below the surface; steady states take it along as the contact grows.
    Contact,
}

/// What time does to the layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum TimeIntegration {
    /// Every state is the steady one of its inputs.
    QuasiSteady,
    /// Squeeze and drainage take their time.
    Transient,
}

/// Which of depth and load is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Control {
    /// The penetration depth is given, and the load follows.
    Depth,
    /// The load is given, and the penetration depth follows.
    Load,
}

/// Which model answers in the FMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Fidelity {
    /// The equations are solved.
    Full,
    /// A table of solved states is interpolated.
    Reduced,
}

/// All parameters of a case.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Parameters {
    /// The body above the film.
    pub upper: Body,
    /// The body below the film.
    pub lower: Body,
    /// Whether the lower body is rigid and impermeable, such as glass or metal, and its tissue of no account.
    pub rigid_lower: bool,
    /// Half the angle of the sector that is modelled \[rad\]; of the body with the smaller radius. 0: it goes with the contact.
    pub sector_half_angle: f64,
    /// Extent out of the plane \[m\]: turns forces per unit depth into forces.
    pub width: f64,
    /// Dynamic viscosity of the fluid \[Pa s\]; of a [`FluidLaw::Carreau`] that at high shear rates, and that in the pores.
    pub viscosity: f64,
    /// Viscosity of the fluid in the pores \[Pa s\]; 0: that of the film.
    pub pore_viscosity: f64,
    /// How the film's shear stress depends on the shear rate.
    pub fluid_law: FluidLaw,
    /// Viscosity at low shear rates \[Pa s\]; like the next two of [`FluidLaw::Carreau`] only.
    pub zero_shear_viscosity: f64,
    /// Relaxation time: one over the shear rate at which the fluid begins to thin \[s\].
    pub relaxation_time: f64,
    /// Exponent of the shear stress over the rate where it thins \[1\].
    pub flow_index: f64,
    /// Compressibility of the fluid \[1/Pa\].
    pub fluid_compressibility: f64,
    /// Friction coefficient of drained solid on solid \[1\].
    pub boundary_friction_coefficient: f64,
    /// Whether boundary friction acts on the tissue as a traction, or is only reported.
    pub boundary_friction_loads_tissue: bool,
    /// Sliding velocity at which regularised Coulomb friction reaches 71 % \[m/s\] (`consistent` only).
    pub friction_regularisation_speed: f64,
    /// Length added to the film thickness in the Couette shear stress \[m\].
    pub shear_film_offset: f64,
    /// Which balance laws are solved.
    pub formulation: Formulation,
    /// The mesh of each body.
    pub mesh: Mesh,
    /// Where its nodes are.
    pub mesh_distribution: MeshDistribution,
    /// Order of the pore pressure's shape functions: 1 or 2.
    pub pressure_order: i32,
    /// Newton stops when an update is below this, relative to the fields.
    pub tolerance: f64,
    /// What time does to the layers.
    pub time_integration: TimeIntegration,
    /// Which of depth and load is given.
    pub control: Control,
    /// Allowed error of one internal step in time, relative to the fields.
    pub relative_tolerance: f64,
    /// Longest internal step in time \[s\].
    pub maximum_internal_step: f64,
    /// Which model answers in the FMU; programs choose by which of them they make.
    pub fidelity: Fidelity,
    /// Whether the film cavitates where its pressure would fall below the cavitation pressure.
    pub cavitation: bool,
    /// Least pressure of the film, above ambient \[Pa\].
    pub cavitation_pressure: f64,
    /// After so long \[s\] a solution is given up; 0 is never.
    pub maximum_solve_time: f64,
    /// How permeability answers to strain.
    pub permeability_law: PermeabilityLaw,
    /// Combined root mean square roughness of the two surfaces \[m\]; 0 is smooth.
    pub surface_roughness: f64,
    /// How the pressure of asperities falls with the distance of rough surfaces.
    pub asperity_law: AsperityLaw,
    /// Pressure of the asperities where the mean planes meet \[Pa\].
    pub asperity_pressure: f64,
    /// Decay length of the asperities' pressure over the roughness \[1\] ([`AsperityLaw::Exponential`]).
    pub asperity_decay: f64,
    /// Pressure of the stiffer core where the mean planes meet \[Pa\].
    pub core_pressure: f64,
    /// Its decay length over the roughness \[1\].
    pub core_decay: f64,
    /// Fraction of the fluid's pressure in real contact that boundary friction feels, phi of Ateshian \[1\] (rough surfaces).
    pub solid_fraction: f64,
    /// Where the other values start from; to get these values, [`Preset::parameters`].
    pub preset: Preset,
    /// What [`Parameter::set`] was told so far.
    pub named: Named,
}

/// Which parameters were set by name. These win over a preset, whichever is set first: importers of FMUs set values in an order
/// of their own. How a value came about is no part of a case, so all of these compare as equal.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub struct Named(u128);

impl PartialEq for Named {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Default for Parameters {
    /// Table 2 of de Boer et al. (2020), on the default mesh.
    fn default() -> Self {
        let body = Body {
            outer_radius: 0.1,
            thickness: 1e-3,
            shear_modulus: 0.5e6,
            bulk_modulus: 5e6,
            permeability: 1e-15,
            biot_coefficient: 0.9,
            solid_volume_fraction: 0.2,
            permeability_exponent: 2.0,
            // With the other two the slope at small strain of the fit quoted from Holmes and Mow, M = 4.638 and L = 0.0848: 4.7.
            permeability_strain_coefficient: 2.2,
            solid_law: SolidLaw::NeoHookean,
            // Quoted for cartilage of calves: Ateshian et al., Journal of Biomechanics 30 (11/12), 1157-1164, 1997.
            stiffening_coefficient: 0.35,
            fibre_modulus: 0.0,
            fibre_exponent: 2.0,
            fibre_exponential_coefficient: 0.0,
            tangential_permeability_ratio: 1.0,
            middle_zone_start: 0.2,
            middle_zone_end: 0.7,
            surface: Factors::NONE,
            deep: Factors::NONE,
        };
        Self {
            upper: body,
            lower: body,
            rigid_lower: false,
            sector_half_angle: std::f64::consts::PI / 36.0,
            width: 1.0,
            viscosity: 1e-3,
            pore_viscosity: 0.0,
            fluid_law: FluidLaw::Newtonian,
            // Normal synovial fluid; see the table in docs/model.md.
            zero_shear_viscosity: 40.0,
            relaxation_time: 22.0,
            flow_index: 0.27,
            fluid_compressibility: 1e-10,
            boundary_friction_coefficient: 0.45,
            boundary_friction_loads_tissue: true,
            friction_regularisation_speed: 1e-3,
            shear_film_offset: 1e-7,
            formulation: Formulation::Paper,
            mesh: Mesh { columns: 120, rows: 8, column_grading: 2.5, row_grading: 2.0 },
            mesh_distribution: MeshDistribution::Graded,
            pressure_order: 2,
            tolerance: 1e-6,
            fidelity: Fidelity::Full,
            time_integration: TimeIntegration::QuasiSteady,
            control: Control::Depth,
            relative_tolerance: 1e-3,
            maximum_internal_step: 1e3,
            cavitation: false,
            cavitation_pressure: -1e5,
            maximum_solve_time: 600.0,
            permeability_law: PermeabilityLaw::Constant,
            surface_roughness: 0.0,
            asperity_law: AsperityLaw::Exponential,
            asperity_pressure: 20e3,
            asperity_decay: 0.5,
            core_pressure: 10e6,
            core_decay: 0.1,
            solid_fraction: 0.0,
            preset: Preset::Paper,
            named: Named::default(),
        }
    }
}

/// What the two layers are made to do. Also the rates of change of all this, per second.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Inputs {
    /// Approach of the bones past first touch of the undeformed surfaces \[m\]; positive presses the layers together.
    pub penetration_depth: f64,
    /// Sum of the two surface speeds, both positive along +x \[m/s\].
    pub sliding_speed: f64,
    /// (upper - lower surface speed) / sliding speed \[1\].
    pub slide_to_roll_ratio: f64,
    /// Rate of change of the penetration depth \[m/s\].
    pub approach_speed: f64,
    /// Load per unit depth under [`Control::Load`] \[N/m\].
    pub applied_load: f64,
}

impl Inputs {
    /// Nothing at all; as rates, constant inputs.
    pub const NONE: Self = Self {
        penetration_depth: 0.0,
        sliding_speed: 0.0,
        slide_to_roll_ratio: 0.0,
        approach_speed: 0.0,
        applied_load: 0.0,
    };

    /// Speeds of the upper and of the lower surface along +x \[m/s\].
    pub fn surface_speeds(&self) -> [f64; 2] {
        let (u, s) = (self.sliding_speed, self.slide_to_roll_ratio);
        [0.5 * u * (1.0 + s), 0.5 * u * (1.0 - s)]
    }

    /// Component by component.
    pub fn combined(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            penetration_depth: f(self.penetration_depth, other.penetration_depth),
            sliding_speed: f(self.sliding_speed, other.sliding_speed),
            slide_to_roll_ratio: f(self.slide_to_roll_ratio, other.slide_to_roll_ratio),
            approach_speed: f(self.approach_speed, other.approach_speed),
            applied_load: f(self.applied_load, other.applied_load),
        }
    }

    /// Names and values.
    pub fn named(&self) -> [(&'static str, f64); 5] {
        [
            ("penetration_depth", self.penetration_depth),
            ("sliding_speed", self.sliding_speed),
            ("slide_to_roll_ratio", self.slide_to_roll_ratio),
            ("approach_speed", self.approach_speed),
            ("applied_load", self.applied_load),
        ]
    }
}

impl Default for Inputs {
    /// Ten micron of clearance at the paper's speed; a load at which the paper's layers have a full film.
    fn default() -> Self {
        Self { penetration_depth: -10e-6, sliding_speed: 0.2, applied_load: 50.0, ..Self::NONE }
    }
}

impl Inputs {
    /// In words, with the depth or the load, whichever is given.
    pub fn described(&self, control: Control) -> String {
        let motion =
            format!("sliding_speed = {} m/s, slide_to_roll_ratio = {}", self.sliding_speed, self.slide_to_roll_ratio);
        match control {
            Control::Depth => format!("penetration_depth = {:e} m, {motion}", self.penetration_depth),
            Control::Load => format!("applied_load = {} N/m, {motion}", self.applied_load),
        }
    }
}

impl std::fmt::Display for Inputs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.described(Control::Depth))
    }
}

impl Body {
    /// Curvature of the articular surface, positive where it is convex \[1/m\].
    pub fn curvature(&self) -> f64 {
        if self.outer_radius == 0.0 { 0.0 } else { 1.0 / self.outer_radius }
    }
}

impl Parameters {
    /// Hydraulic permeability of a body's undeformed tissue \[m^4/(N s)\].
    pub fn hydraulic_permeability(&self, body: &Body) -> f64 {
        body.permeability / self.viscosity_in_pores()
    }

    /// Viscosity of the fluid in the pores \[Pa s\].
    pub fn viscosity_in_pores(&self) -> f64 {
        if self.pore_viscosity == 0.0 { self.viscosity } else { self.pore_viscosity }
    }

    /// Whether the two bodies are equal, so that one may be the mirror image of the other.
    pub fn equal_bodies(&self) -> bool {
        self.upper == self.lower && !self.rigid_lower
    }

    /// Elements along the surface and through the thickness, also where their numbers are left to the program.
    pub fn elements(&self) -> [i32; 2] {
        const COLUMNS: i32 = 96;
        const ROWS: i32 = 10;
        let Mesh { columns, rows, .. } = self.mesh;
        [if columns == 0 { COLUMNS } else { columns }, if rows == 0 { ROWS } else { rows }]
    }
}
