//! What a solved state is asked for: loads, friction, film, stresses, and profiles along the interface.

/// Number of fixed stations of the profiles.
pub const STATIONS: usize = 101;

/// Lubrication regime, as named by de Boer et al. (2020), section 3.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Regime {
    /// Full film between hardly deformed surfaces: the undeformed surfaces would not touch.
    #[default]
    ThinFilmFlow,
    /// Full film that exists only because the layers deform.
    LowFriction,
    /// Solid contact, with ten times more load on the fluid than on the solid.
    BoundaryContact,
    /// Solid contact that carries more than a tenth of the fluid's load.
    HighFriction,
}

impl Regime {
    /// All regimes with name and description; in FMI the first is 1.
    pub const ITEMS: [(&'static str, &'static str); 4] = [
        ("thin_film_flow", "Full film; the undeformed surfaces would not touch"),
        ("low_friction", "Full film that exists only because the layers deform"),
        ("boundary_contact", "Solid contact, fluid load at least ten times the solid load"),
        ("high_friction", "Solid contact, fluid load less than ten times the solid load"),
    ];

    /// Name in case files, tables and the FMU.
    pub fn name(self) -> &'static str {
        Self::ITEMS[self as usize].0
    }
}

/// Results of one state; and, with the same fields, their derivatives with respect to one input.
///
/// Lengths in m, pressures in Pa (gauge), loads per unit depth in N/m, forces (loads times the width) in N. Every number is
/// finite in every state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outputs {
    /// Load per unit depth, L = L_f + L_s [N/m].
    pub load: f64,
    /// Part carried by fluid pressure, L_f (equation 11) [N/m].
    pub fluid_load: f64,
    /// Part carried by solid contact, L_s (equation 12) [N/m].
    pub solid_load: f64,
    /// Load times width [N].
    pub normal_force: f64,
    /// Drag on the upper body, positive along -x, times width (T_1 of equation 13) [N].
    pub upper_friction_force: f64,
    /// Traction on the lower body, positive along +x, times width (T_2 of equation 13) [N].
    pub lower_friction_force: f64,
    /// mu = |T_1| / L (equation 13) [1].
    pub friction_coefficient: f64,
    /// mu_f = |T_f1| / L_f [1].
    pub fluid_friction_coefficient: f64,
    /// L_f / L [1].
    pub fluid_load_support: f64,
    /// Least distance of the deformed surfaces [m].
    pub minimum_film_thickness: f64,
    /// Where it is [m].
    pub minimum_film_position: f64,
    /// Distance of the deformed surfaces at x = 0 [m].
    pub central_film_thickness: f64,
    /// Length over which the solids touch, b (equation 8) [m].
    pub contact_length: f64,
    /// Largest fluid pressure on the interface [Pa].
    pub maximum_fluid_pressure: f64,
    /// Smallest fluid pressure on the interface [Pa].
    pub minimum_fluid_pressure: f64,
    /// Largest contact pressure [Pa].
    pub maximum_contact_pressure: f64,
    /// Largest von Mises stress of the tissue (effective Cauchy stress, plane strain) [Pa].
    pub maximum_von_mises_stress: f64,
    /// eta U / L [1].
    pub sommerfeld_number: f64,
    /// dL/dd times width [N/m].
    pub contact_stiffness: f64,
    /// Fluid that leaves the bodies into the film, integral of max(V, 0), per unit depth [m^2/s].
    pub fluid_exudation: f64,
    /// Lubrication regime.
    pub lubrication_regime: Regime,
    /// Newton iterations of the last solution, summed over its sub-steps.
    pub newton_iterations: i32,
    /// Film thickness at the fixed stations [m]; [`STATIONS`] values.
    pub film_thickness: Vec<f64>,
    /// Fluid pressure at the fixed stations [Pa].
    pub fluid_pressure: Vec<f64>,
    /// Contact pressure at the fixed stations [Pa].
    pub contact_pressure: Vec<f64>,
}
