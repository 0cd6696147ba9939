//! Which laws, with which constants, the parameters ask for.

use crate::equations::grid::Grid;
use crate::equations::tissue::Tissue;
use crate::fem::mesh::LayerMesh;
use crate::laws::contact::mobilised_friction;
use crate::laws::fluid::{Carreau, Fluid};
use crate::laws::roughness::Roughness;
use crate::laws::solid::{self, Fibres, GroundMatrix, NeoHookean, Solid};
use crate::laws::{FluidLaw, Formulation, PermeabilityLaw, SolidLaw, darcy};
use crate::parameters::{Body, Inputs, Parameters};

/// One body: its mesh and its material.
#[derive(Debug)]
pub struct Layer {
    /// The mesh.
    pub mesh: LayerMesh,
    /// The material.
    pub tissue: Tissue,
    /// 1 above the film, -1 below.
    pub side: f64,
}

/// Roughness of the surfaces; none where they are smooth.
pub fn roughness(parameters: &Parameters) -> Option<Roughness> {
    let p = parameters;
    (p.surface_roughness > 0.0).then_some(Roughness {
        rms: p.surface_roughness,
        law: p.asperity_law,
        asperity_pressure: p.asperity_pressure,
        asperity_decay: p.asperity_decay,
        core_pressure: p.core_pressure,
        core_decay: p.core_decay,
    })
}

/// The lubricant of the film. That in the pores has the viscosity at high shear rates: the long molecules that thin under shear stay in
/// the film.
pub fn fluid(parameters: &Parameters) -> Fluid {
    let p = parameters;
    match p.fluid_law {
        FluidLaw::Newtonian => Fluid::Newtonian(p.viscosity),
        FluidLaw::Carreau => Fluid::Carreau(Carreau {
            zero_shear_viscosity: p.zero_shear_viscosity,
            infinite_shear_viscosity: p.viscosity,
            relaxation_time: p.relaxation_time,
            flow_index: p.flow_index,
        }),
    }
}

/// Traction on the upper body's tissue per unit of contact pressure, positive along -x, between surfaces that are stretched alike.
pub(super) fn boundary_friction(parameters: &Parameters, inputs: &Inputs) -> f64 {
    let p = parameters;
    match p.boundary_friction_loads_tissue {
        true => {
            p.boundary_friction_coefficient
                * mobilised_friction(p.formulation, inputs.surface_speeds(), p.friction_regularisation_speed).0
        }
        false => 0.0,
    }
}

/// The body on this side of the film.
pub(super) fn body(parameters: &Parameters, side: f64) -> &Body {
    if side > 0.0 { &parameters.upper } else { &parameters.lower }
}

/// Permeability over the fluid's viscosity \[m^4/(N s)\].
pub(super) fn mobility(parameters: &Parameters, side: f64) -> f64 {
    parameters.hydraulic_permeability(body(parameters, side))
}

pub(super) fn sector(parameters: &Parameters, side: f64, grid: &Grid) -> LayerMesh {
    let body = body(parameters, side);
    let lower = usize::from(side < 0.0);
    let depths: Vec<f64> = grid.depths[lower].iter().map(|depth| depth * body.thickness).collect();
    LayerMesh::sector(&grid.surfaces[lower], &depths, 1.0 / body.curvature(), side, parameters.pressure_order)
}

impl Layer {
    /// Height of the uppermost elements \[m\].
    pub fn surface_row(&self) -> f64 {
        let [surface, below] = [self.mesh.nodes[0], self.mesh.nodes[2]];
        (below[0] - surface[0]).hypot(below[1] - surface[1])
    }

    pub(super) fn new(parameters: &Parameters, side: f64, grid: &Grid) -> Self {
        let body = body(parameters, side);
        let consistent = parameters.formulation == Formulation::Consistent;
        let alpha = body.biot_coefficient;
        let (isochoric, volumetric) = if consistent { (1.0, 1.0) } else { (alpha, 1.0 - alpha) };
        Self {
            mesh: sector(parameters, side, grid),
            tissue: Tissue {
                solid: Solid {
                    matrix: match body.solid_law {
                        SolidLaw::NeoHookean => GroundMatrix::NeoHookean(NeoHookean {
                            shear_modulus: isochoric * body.shear_modulus,
                            bulk_modulus: volumetric * body.bulk_modulus,
                        }),
                        SolidLaw::HolmesMow => GroundMatrix::HolmesMow(solid::HolmesMow {
                            shear_modulus: body.shear_modulus,
                            bulk_modulus: body.bulk_modulus,
                            stiffening_coefficient: body.stiffening_coefficient,
                        }),
                    },
                    fibres: (body.fibre_modulus > 0.0).then(|| {
                        Fibres::new(body.fibre_modulus, body.fibre_exponent, body.fibre_exponential_coefficient)
                    }),
                },
                biot_coefficient: alpha,
                mobility: mobility(parameters, side),
                tangential_ratio: body.tangential_permeability_ratio,
                strain_dependence: match parameters.permeability_law {
                    PermeabilityLaw::Constant => None,
                    PermeabilityLaw::HolmesMow => Some(darcy::HolmesMow {
                        solid_volume_fraction: body.solid_volume_fraction,
                        exponent: body.permeability_exponent,
                        strain_coefficient: body.permeability_strain_coefficient,
                    }),
                },
                fluid_compressibility: parameters.fluid_compressibility,
                consistent,
                profile: body.depth_profile(),
            },
            side,
        }
    }
}
