//! The table of results, each declared once: value reference, field, type with unit and order of magnitude, how the real-time model
//! has it, and what it is.
//!
//! From it follow the fields of [`Outputs`] and their documentation, the rows of the FMU, of CSV files and of the command line, and
//! the list of what the real-time model interpolates. A row may stand anywhere; its value reference never changes.

use num_dual::Dual64;

use super::{Regime, STATIONS};
use crate::units::Unit;

/// Where the value of a result is.
#[derive(Clone, Copy)]
pub enum Get {
    /// A real number.
    Real(fn(&Outputs) -> f64),
    /// A whole number.
    Integer(fn(&Outputs) -> i32),
    /// true or false.
    Boolean(fn(&Outputs) -> bool),
    /// A word: the words with what they mean, and the index of the present one.
    Choice(&'static [(&'static str, &'static str)], fn(&Outputs) -> usize),
    /// Values at the fixed stations.
    Profile(fn(&Outputs) -> &[f64]),
    /// The fixed stations themselves, which are no field of [`Outputs`].
    Position,
    /// The contact stiffness, which is found only where it is asked for.
    Stiffness,
}

/// How the real-time model has a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RealTime {
    /// Interpolated between solved states.
    Interpolated(Interpolation),
    /// By the formulas of both models, from what is interpolated.
    Derived,
    /// It has it not: 0 or false.
    Absent,
}

/// How a result is interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interpolation {
    /// What becomes of it when x and the speeds are reversed.
    pub mirror: Mirror,
    /// Whether it changes with |U| near rest, as extrema of fields do that vanish there.
    pub kinked: bool,
    /// Whether it hops from one element of the mesh to the next as the state changes. Its tangents are those between two hops, and
    /// differences between states serve better as slopes.
    pub hops: bool,
    /// Whether it is kept from going below zero, where a cubic may carry it.
    pub floor: Floor,
}

/// The symmetry of a result under reversal of x and of the speeds. Stations of profiles are reversed, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mirror {
    /// It stays.
    Kept,
    /// It changes sign.
    Negated,
    /// A place, which in contact is the first one that touches: in the mirror that is the last one.
    Place,
}

/// What is never negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Floor {
    /// It may be.
    None,
    /// It is not.
    Zero,
    /// A distance of the surfaces: that of smooth ones is not; the mean planes of rough ones may overlap.
    Distance,
}

impl Interpolation {
    const fn new(mirror: Mirror) -> Self {
        Self { mirror, kinked: false, hops: false, floor: Floor::None }
    }

    const fn kinked(self) -> Self {
        Self { kinked: true, ..self }
    }

    const fn hopping(self) -> Self {
        Self { hops: true, ..self }
    }

    const fn never_negative(self) -> Self {
        Self { floor: Floor::Zero, ..self }
    }

    const fn distance(self) -> Self {
        Self { floor: Floor::Distance, ..self }
    }
}

const KEPT: Interpolation = Interpolation::new(Mirror::Kept);
const NEGATED: Interpolation = Interpolation::new(Mirror::Negated);
const PLACE: Interpolation = Interpolation::new(Mirror::Place);

/// One row of [`RESULTS`].
pub struct ResultRow {
    /// Name in case files, tables and the FMU.
    pub name: &'static str,
    /// Value reference in FMI; of a profile, that of its first station.
    pub reference: u32,
    /// Its unit.
    pub unit: Unit,
    /// Order of magnitude.
    pub nominal: f64,
    /// What it is, in one sentence.
    pub description: &'static str,
    /// Type and place.
    pub get: Get,
    /// How the real-time model has it.
    pub real_time: RealTime,
}

impl ResultRow {
    /// How many value references it takes.
    pub const fn length(&self) -> u32 {
        match self.get {
            Get::Profile(_) | Get::Position => STATIONS as u32,
            _ => 1,
        }
    }
}

/// What depends on the type of a result.
macro_rules! by_type {
    (mapped (real($($size:tt)*)) $value:expr, $f:expr) => {
        $f($value)
    };
    (mapped (profile($($size:tt)*)) $value:expr, $f:expr) => {
        $value.iter().map(|value| $f(*value)).collect()
    };
    (mapped $other:tt $value:expr, $f:expr) => {
        $value
    };

    (size (real($unit:expr, $nominal:expr))) => {
        ($unit, $nominal)
    };
    (size (profile($unit:expr, $nominal:expr))) => {
        ($unit, $nominal)
    };
    (size (stiffness($unit:expr, $nominal:expr))) => {
        ($unit, $nominal)
    };
    (size (position($unit:expr, $nominal:expr))) => {
        ($unit, $nominal)
    };
    (size $other:tt) => {
        (Unit::One, 1.0)
    };

    (get (real($($size:tt)*)) $field:ident) => {
        Get::Real(|o| o.$field)
    };
    (get (integer) $field:ident) => {
        Get::Integer(|o| o.$field)
    };
    (get (boolean) $field:ident) => {
        Get::Boolean(|o| o.$field)
    };
    (get (choice($words:ident)) $field:ident) => {
        Get::Choice(&$words::ITEMS, |o| o.$field as usize)
    };
    (get (profile($($size:tt)*)) $field:ident) => {
        Get::Profile(|o| &o.$field)
    };
    (get (stiffness($($size:tt)*)) $field:ident) => {
        Get::Stiffness
    };
    (get (position($($size:tt)*)) $field:ident) => {
        Get::Position
    };
}

/// What depends on how the real-time model has a result.
macro_rules! by_provision {
    (row interpolated($how:expr)) => {
        RealTime::Interpolated($how)
    };
    (row derived) => {
        RealTime::Derived
    };
    (row absent) => {
        RealTime::Absent
    };
    (row beside) => {
        RealTime::Derived
    };

    (value (interpolated($how:expr)) (real($($size:tt)*)) $number:ident, $profile:ident) => {
        $number()
    };
    (value (interpolated($how:expr)) (profile($($size:tt)*)) $number:ident, $profile:ident) => {
        $profile()
    };
    (value (absent) (real($($size:tt)*)) $number:ident, $profile:ident) => {
        Dual64::from(0.0)
    };
    (value (absent) $other:tt $number:ident, $profile:ident) => {
        Default::default()
    };
}

/// The rows below: `reference field: type, real-time model, "description"`, where a field may have another name `as "name"`.
macro_rules! results {
    ($(
        $(#[$doc:meta])*
        $reference:literal $field:ident $(as $name:literal)?: $type:ident $(($($size:tt)*))?,
        $real_time:ident $(($how:expr))?, $description:literal;
    )*) => {
        /// Every result, in the order in which they are listed.
        pub static RESULTS: &[ResultRow] = &[$({
            let (unit, nominal) = by_type!(size ($type $(($($size)*))?));
            ResultRow {
                name: results!(@name $field $($name)?),
                reference: $reference,
                unit,
                nominal,
                description: $description,
                get: by_type!(get ($type $(($($size)*))?) $field),
                real_time: by_provision!(row $real_time $(($how))?),
            }
        }),*];

        results! { @types [] $(
            {
                ($real_time $(($how))?)
                [#[doc = concat!($description, ".")] $(#[doc = ""] #[$doc])*] $field ($type $(($($size)*))?)
            }
        )* }
    };

    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $name:literal) => { $name };

    // Puts the types of the fields behind the rows: `derive` takes no macros for them.
    (@types [$($done:tt)*] { $how:tt $doc:tt $field:ident (integer) } $($rest:tt)*) => {
        results! { @types [$($done)* { $how $doc $field (integer) [i32] }] $($rest)* }
    };
    (@types [$($done:tt)*] { $how:tt $doc:tt $field:ident (boolean) } $($rest:tt)*) => {
        results! { @types [$($done)* { $how $doc $field (boolean) [bool] }] $($rest)* }
    };
    (@types [$($done:tt)*] { $how:tt $doc:tt $field:ident (choice($words:ident)) } $($rest:tt)*) => {
        results! { @types [$($done)* { $how $doc $field (choice($words)) [$words] }] $($rest)* }
    };
    (@types [$($done:tt)*] { $how:tt $doc:tt $field:ident (profile $size:tt) } $($rest:tt)*) => {
        results! { @types [$($done)* { $how $doc $field (profile $size) [Vec<T>] }] $($rest)* }
    };
    (@types [$($done:tt)*] { $how:tt $doc:tt $field:ident ($other:ident $size:tt) } $($rest:tt)*) => {
        results! { @types [$($done)* { $how $doc $field ($other $size) [T] }] $($rest)* }
    };
    (@types [$($done:tt)*]) => { results! { @fields [] [] $($done)* } };

    // Sorts the rows into what the solved fields give, and what is derived of that; rows beside have no field.
    (@fields [$($direct:tt)*] [$($derived:tt)*] { (beside) $($row:tt)* } $($rest:tt)*) => {
        results! { @fields [$($direct)*] [$($derived)*] $($rest)* }
    };
    (@fields [$($direct:tt)*] [$($derived:tt)*] { (derived) $($row:tt)* } $($rest:tt)*) => {
        results! { @fields [$($direct)*] [$($derived)* { (derived) $($row)* }] $($rest)* }
    };
    (@fields [$($direct:tt)*] [$($derived:tt)*] { $($row:tt)* } $($rest:tt)*) => {
        results! { @fields [$($direct)* { $($row)* }] [$($derived)*] $($rest)* }
    };
    (@fields
        [$({ $how:tt [$($direct_doc:tt)*] $direct:ident $direct_type:tt [$($direct_of:tt)*] })*]
        [$({ $derived_how:tt [$($derived_doc:tt)*] $derived:ident $derived_type:tt [$($derived_of:tt)*] })*]
    ) => {
        /// Results of one state; and, with the same fields, their derivatives with respect to one input or to time.
        ///
        /// Units are those of the variable of the same name: SI, loads per unit depth, forces times the width, pressures above
        /// ambient. Every number is finite in every state.
        #[derive(Debug, Clone, PartialEq, Default)]
        pub struct Outputs<T = f64> {
            $($($derived_doc)* pub $derived: $($derived_of)*,)*
            $($($direct_doc)* pub $direct: $($direct_of)*,)*
        }

        /// Results that are found in solved fields, or interpolated by the real-time model.
        #[derive(Debug, Clone)]
        pub(crate) struct Direct<T> {
            $($($direct_doc)* pub $direct: $($direct_of)*,)*
        }

        /// Results that follow from [`Direct`] ones, friction and inputs by formulas that both models share.
        #[derive(Debug, Clone)]
        pub(crate) struct Derived<T> {
            $($($derived_doc)* pub $derived: $($derived_of)*,)*
        }

        impl<T> Outputs<T> {
            /// All of them.
            pub(crate) fn new(direct: Direct<T>, derived: Derived<T>) -> Self {
                Self { $($derived: derived.$derived,)* $($direct: direct.$direct,)* }
            }
        }

        impl<T: Copy> Outputs<T> {
            /// The same fields, each number replaced by `f` of it.
            pub(crate) fn map<S>(&self, f: impl Fn(T) -> S) -> Outputs<S> {
                Outputs {
                    $($derived: by_type!(mapped $derived_type self.$derived, f),)*
                    $($direct: by_type!(mapped $direct_type self.$direct, f),)*
                }
            }
        }

        impl Direct<Dual64> {
            /// Those of the real-time model, from what it interpolates: numbers and profiles, each in the order of the table.
            pub(crate) fn interpolated(
                mut number: impl FnMut() -> Dual64,
                mut profile: impl FnMut() -> Vec<Dual64>,
            ) -> Self {
                Self { $($direct: by_provision!(value $how $direct_type number, profile),)* }
            }
        }
    };
}

// Value references: 604 and on are free for all variables, those from 1000 for profiles, which take 101 each. Those of variables that
// are no more are in src/variables/table.rs.
results! {
    /// L = L_f + L_s.
    5 load: real(Unit::NewtonPerMetre, 1e3), derived, "Load per unit depth, fluid and solid together";
    /// L_f, equation 11.
    6 fluid_load: real(Unit::NewtonPerMetre, 1e3), interpolated(KEPT), "Load per unit depth that fluid pressure carries";
    /// L_s, equation 12.
    7 solid_load: real(Unit::NewtonPerMetre, 1e3), interpolated(KEPT.never_negative()),
        "Load per unit depth that solid contact carries";
    8 normal_force: real(Unit::Newton, 1e3), derived, "Load times width; pushes the bodies apart";
    /// T_1 of equation 13.
    9 upper_friction_force: real(Unit::Newton, 10.0), derived, "Drag on the upper body, positive along -x, times width";
    /// T_2 of equation 13.
    10 lower_friction_force: real(Unit::Newton, 10.0), derived,
        "Traction on the lower body, positive along +x, times width";
    /// mu = max(|T_1|, |T_2|) / L, equation 13.
    11 friction_coefficient: real(Unit::One, 1e-2), derived,
        "Larger of the two friction forces over the normal force: rolling and sliding friction together; 0 where nothing is pressed together";
    /// mu_f = max(|T_f1|, |T_f2|) / L_f.
    12 fluid_friction_coefficient: real(Unit::One, 1e-2), derived,
        "Larger of the fluid's friction on the two bodies over the fluid load; 0 where the fluid pulls";
    13 fluid_load_support: real(Unit::One, 1.0), derived, "Fluid load over load; 0 where nothing is pressed together";
    /// Of pressure on slopes, contact and shear together; with the load that of each bone's reaction.
    477 tangential_load: real(Unit::NewtonPerMetre, 10.0), interpolated(NEGATED),
        "Force along +x on the upper bone per unit depth, of pressure on sloping surfaces and of friction; the lower one has the opposite";
    /// About the point halfway between the bones' undeformed surfaces at x = 0.
    478 load_moment: real(Unit::NewtonMetrePerMetre, 1.0), interpolated(NEGATED),
        "Counter-clockwise moment on the upper bone per unit depth about the middle of the contact; the lower one has the opposite";
    479 upper_force_x: real(Unit::Newton, 10.0), derived, "Force on the upper bone along +x, times width";
    480 upper_force_y: real(Unit::Newton, 1e3), derived, "Force on the upper bone along +y, away from the lower one, times width";
    481 upper_moment: real(Unit::NewtonMetre, 1.0), derived,
        "Counter-clockwise moment on the upper bone about the middle of the contact, times width";
    482 lower_force_x: real(Unit::Newton, 10.0), derived, "Force on the lower bone along +x, times width";
    483 lower_force_y: real(Unit::Newton, 1e3), derived, "Force on the lower bone along +y, towards the upper one, times width";
    484 lower_moment: real(Unit::NewtonMetre, 1.0), derived,
        "Counter-clockwise moment on the lower bone about the middle of the contact, times width";
    14 minimum_film_thickness: real(Unit::Metre, 1e-6), interpolated(KEPT.hopping().distance()),
        "Least distance of the deformed surfaces; 0 in contact";
    15 minimum_film_position: real(Unit::Metre, 1e-3), interpolated(PLACE.hopping()),
        "Where the film is thinnest, along x from the middle of the contact";
    16 central_film_thickness: real(Unit::Metre, 1e-6), interpolated(KEPT.distance()),
        "Distance of the deformed surfaces in the middle of the contact";
    /// b, equation 8.
    17 contact_length: real(Unit::Metre, 1e-3), interpolated(KEPT.hopping().never_negative()),
        "Length along x over which the solids touch";
    18 maximum_fluid_pressure: real(Unit::Pascal, 1e4), interpolated(KEPT.kinked()),
        "Largest fluid pressure on the interface, above ambient";
    19 minimum_fluid_pressure: real(Unit::Pascal, 1e4), interpolated(KEPT.kinked().hopping()),
        "Smallest fluid pressure on the interface, above ambient";
    20 maximum_contact_pressure: real(Unit::Pascal, 1e4), interpolated(KEPT.hopping().never_negative()),
        "Largest pressure of solid on solid";
    /// Of the effective Cauchy stress in plane strain.
    21 maximum_von_mises_stress: real(Unit::Pascal, 1e4), interpolated(KEPT.kinked()),
        "Largest von Mises stress of the tissue's solid part";
    /// eta U / L.
    22 sommerfeld_number: real(Unit::One, 1e-7), derived,
        "Viscosity times sliding speed over load per unit depth: abscissa of the Stribeck curve; 0 where nothing is pressed together";
    23 contact_stiffness: stiffness(Unit::NewtonPerMetre, 1e8), beside,
        "Rate of change of the normal force with penetration depth";
    /// Integral of max(V, 0).
    24 fluid_exudation: real(Unit::SquareMetrePerSecond, 1e-6), interpolated(KEPT.kinked()),
        "Fluid that leaves the tissue into the film, per unit depth";
    /// Integral of V.
    25 net_fluid_exudation: real(Unit::SquareMetrePerSecond, 1e-6), interpolated(KEPT),
        "Fluid that leaves the tissue into the film less what it takes in, per unit depth";
    26 penetration_depth as "penetration_depth_result": real(Unit::Metre, 1e-5), derived,
        "Penetration depth of these results; where control is load, the depth at which the load is carried";
    27 lubrication_regime: choice(Regime), derived, "Lubrication regime";
    28 newton_iterations: integer, absent, "Newton iterations of the last solution, all its sub-steps together";
    29 cavitated_length: real(Unit::Metre, 1e-3), absent,
        "Length along x over which the film is cavitated, to half an element; 0 unless cavitation is true";
    /// h/sigma at the thinnest place; below 3 the surfaces touch.
    520 film_parameter: real(Unit::One, 1.0), derived, "Least film thickness over surface_roughness; 0 with smooth surfaces";
    521 real_contact_share: real(Unit::One, 0.1), interpolated(KEPT.never_negative()),
        "Fraction of the nominal area that is in real contact, a mean weighted with pressure; 0 with smooth surfaces";
    522 estimated_load_error: real(Unit::One, 1e-2), absent,
        "Estimated error of the load by the mesh over the load, from the curvature of the pressures between nodes";
    533 estimated_film_error: real(Unit::One, 1e-2), absent,
        "Estimated error of the least film thickness by the mesh over that thickness, from kinks of the film between elements where it is thin";
    534 estimated_friction_error: real(Unit::One, 1e-2), absent,
        "Estimated error of the film's rolling friction, and of the boundary friction of smooth surfaces, by the mesh over the larger friction force";
    523 well_resolved: boolean, absent,
        "Whether mesh and sector are fine and wide enough for these results; a warning says what is not";
    524 mesh_columns: integer, absent, "Elements along the surface of these results";
    525 mesh_rows: integer, absent, "Elements through the thickness of these results";
    526 mesh_half_width: real(Unit::Metre, 1e-2), absent, "Half the width of the modelled interface of these results";
    /// With the power of the load, [`Self::normal_force`] times the rate of the depth, it is what the bones put in.
    527 rotation_power: real(Unit::Watt, 1e-2), absent,
        "Power that the turning bones put in, with their surfaces at the surface speeds, times width";
    528 film_dissipation: real(Unit::Watt, 1e-2), absent, "Power lost in the film by its pressure flow and by sliding, times width";
    529 pore_flow_dissipation: real(Unit::Watt, 1e-2), absent, "Power lost by flow through the pores of the tissue, times width";
    530 boundary_friction_dissipation: real(Unit::Watt, 1e-2), absent, "Power lost by friction of solid on solid, times width";
    531 carried_power: real(Unit::Watt, 1e-3), absent, "Power that moving tissue and film carry out of the modelled sector, times width";
    532 stored_elastic_energy: real(Unit::Joule, 1e-2), absent, "Elastic energy of the tissue's solid part, times width";

    30 position: position(Unit::Metre, 1e-3), beside, "Place along x from the middle of the contact";
    131 film_thickness: profile(Unit::Metre, 1e-6), interpolated(KEPT.distance()), "Film thickness";
    232 fluid_pressure: profile(Unit::Pascal, 1e4), interpolated(KEPT), "Fluid pressure";
    333 contact_pressure: profile(Unit::Pascal, 1e4), interpolated(KEPT.never_negative()), "Pressure of solid on solid";
}
