//! Lubrication of cartilage on cartilage: two poroelastic layers on bone, the film of fluid between them, and their contact.
//!
//! The model is that of de Boer, Raske, Soltanahmadi, Bryant and Hewson, *Compliant-poroelastic lubrication in
//! cartilage-on-cartilage line contacts*, Tribology - Materials, Surfaces & Interfaces 14(3), 2020, in plane strain.
//!
//! # Equations
//!
//! ```text
//! solid     Div P = alpha grad p,  P = dW/dF            paper: as printed
//!           Div (P - alpha p J F^-T) = 0                consistent: total stress
//! W         G/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2       weighted by alpha and 1 - alpha in the paper; or Holmes and Mow's
//! pore flow div(rho q) + alpha rho (dJ/dt + v . grad J) = 0,  q = -(kappa/eta) grad p
//! film      d(rho h)/dt + d/dx [rho (-h^3/(12 eta) dp/dx + U h/2)] = rho (q1.n1 + q2.n2)
//! contact   h >= 0,  p_c >= 0,  p_c h = 0,  and boundary friction mu_s p_c
//! ```
//!
//! v is the rotation of each body about its centre, with U_i at the articular surface. Both bodies and the film share the pressure
//! on the interface, so that one set of equations holds them all; Newton's method solves them together.
//!
//! # Notation
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | d | `penetration_depth`: approach of the bones past first touch, positive = approach | m |
//! | U = U1 + U2 | `sliding_speed`; U_i is positive along +x | m/s |
//! | (U1 - U2)/U | `slide_to_roll_ratio` | 1 |
//! | h | `film_thickness` | m |
//! | p, p_c | `fluid_pressure` (gauge), `contact_pressure` | Pa |
//! | L = L_f + L_s | `load`, `fluid_load`, `solid_load`, per unit depth | N/m |
//! | T1, T2 | `upper_friction_force` (along -x), `lower_friction_force` (along +x) | N |
//! | mu, mu_f, mu_s | `friction_coefficient`, `fluid_friction_coefficient`, `boundary_friction_coefficient` | 1 |
//! | b | `contact_length` | m |
//! | G, K, alpha | `shear_modulus`, `bulk_modulus`, `biot_coefficient` | Pa, Pa, 1 |
//! | kappa | `permeability`; kappa/eta is the hydraulic permeability | m^2 |
//! | eta, chi | `viscosity`, `fluid_compressibility` | Pa s, 1/Pa |
//! | rho = exp(chi p) | density of the fluid over that at ambient pressure | 1 |
//!
//! # The way of a number
//!
//! `penetration_depth` through an FMU, from `fmi2SetReal` to `load`:
//!
//! ```text
//! fmi2SetReal -> fmi::instance::Instance::set_real   its row of variables::VARIABLES says where in parameters::Inputs
//! fmi2DoStep -> Instance::do_step -> fmi::model::Model::advance
//!   -> simulation::Simulation::advance            in time (simulation::transient, solver::time_stepping),
//!                ::solve_steady                   or to the steady state (simulation::steady, solver::continuation,
//!                                                 and where its steps fail solver::pseudo_transient)
//!     -> equations::system::System::settle        Newton's method (solver::newton) on the system, with the active set of contact
//!       -> equations::{tissue, film, contact}     weak forms: residual and tangent of an element
//!         -> laws::{solid, darcy, film, contact}  formulas and their derivatives at a point
//!       -> equations::load                        the balance of a given load, whose unknown is the depth
//!       -> solver::linear::Multifrontal           eliminates
//!   -> outputs::Outputs                           from the solution, and its derivatives with respect to the inputs
//! fmi2GetReal -> Instance::get_real               the row of load in variables::VARIABLES
//! ```
//!
//! Case files and the command line name the same rows, and drive the same `simulation::Simulation`.
//!
//! # One state
//!
//! ```
//! use cartilage_contact::parameters::{Inputs, Mesh, Parameters};
//! use cartilage_contact::simulation::{Input, Simulation};
//!
//! # fn main() -> Result<(), cartilage_contact::error::Error> {
//! let mesh = Mesh { columns: 40, rows: 4, ..Parameters::default().mesh };
//! let mut contact = Simulation::new(&Parameters { mesh, ..Parameters::default() })?;
//! contact.solve_steady(Inputs { penetration_depth: 0.0, sliding_speed: 0.2, ..Inputs::NONE })?;
//! let outputs = contact.outputs();
//! assert!((outputs.load - 9.2).abs() < 0.1, "{} N/m", outputs.load);
//! assert!((outputs.minimum_film_thickness - 3.17e-6).abs() < 0.1e-6);
//! assert!(contact.derivatives(Input::PenetrationDepth)?.load > 0.0);
//! # Ok(())
//! # }
//! ```

pub mod equations;
pub mod error;
pub mod fem;
pub mod fields;
pub mod files;
pub mod fmi;
pub mod io;
pub mod laws;
pub mod memory;
pub mod outputs;
pub mod parameters;
pub mod reduced;
pub mod simulation;
pub mod solver;
pub mod sweep;
pub mod units;
pub mod variables;
