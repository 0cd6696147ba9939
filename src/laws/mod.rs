//! The laws of the model as pure functions of numbers: no mesh, no unknowns, no linear algebra. Each returns its value and
//! its derivatives; the tests compare the derivatives with finite differences.

pub mod contact;
pub mod darcy;
pub mod depth;
pub mod film;
pub mod fluid;
pub mod kinematics;
pub mod roughness;
pub mod solid;

/// How permeability answers to strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum PermeabilityLaw {
    /// Not at all.
    Constant,
    /// [`darcy::HolmesMow`].
    HolmesMow,
}

/// How the drained solid answers to strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SolidLaw {
    /// [`solid::NeoHookean`].
    NeoHookean,
    /// [`solid::HolmesMow`].
    HolmesMow,
}

/// How the lubricant's shear stress depends on the shear rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum FluidLaw {
    /// [`fluid::Fluid::Newtonian`].
    Newtonian,
    /// [`fluid::Carreau`].
    Carreau,
}

/// Which reading of the balance laws is solved (see the crate documentation).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Formulation {
    /// The equations of de Boer et al. (2020) as printed.
    Paper,
    /// Total-stress poroelasticity at finite strain with regularised Coulomb friction.
    Consistent,
}

/// A function's value and slope, along a change of its argument.
pub fn chain((value, slope): (f64, f64), change: f64) -> num_dual::Dual64 {
    num_dual::Dual64::new(value, slope * change)
}
