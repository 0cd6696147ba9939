//! Units of the variables: SI, with the unit that people read beside it.

/// A unit of measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Unit {
    One,
    Metre,
    SquareMetre,
    MetrePerSecond,
    Radian,
    Pascal,
    PerPascal,
    PascalSecond,
    Newton,
    NewtonPerMetre,
    SquareMetrePerSecond,
    Second,
}

/// A unit as people read it: `value_shown = factor * value_in_SI`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// Its name, such as `um`.
    pub name: &'static str,
    /// What the SI value is multiplied by.
    pub factor: f64,
}

impl Unit {
    /// Name in FMI's spelling, such as `Pa.s`; empty for 1.
    pub fn name(self) -> &'static str {
        match self {
            Self::One => "",
            Self::Metre => "m",
            Self::SquareMetre => "m2",
            Self::MetrePerSecond => "m/s",
            Self::Radian => "rad",
            Self::Pascal => "Pa",
            Self::PerPascal => "1/Pa",
            Self::PascalSecond => "Pa.s",
            Self::Newton => "N",
            Self::NewtonPerMetre => "N/m",
            Self::SquareMetrePerSecond => "m2/s",
            Self::Second => "s",
        }
    }

    /// Exponents of (kg, m, s, rad).
    pub fn base(self) -> (i32, i32, i32, i32) {
        match self {
            Self::One => (0, 0, 0, 0),
            Self::Metre => (0, 1, 0, 0),
            Self::SquareMetre => (0, 2, 0, 0),
            Self::MetrePerSecond => (0, 1, -1, 0),
            Self::Radian => (0, 0, 0, 1),
            Self::Pascal => (1, -1, -2, 0),
            Self::PerPascal => (-1, 1, 2, 0),
            Self::PascalSecond => (1, -1, -1, 0),
            Self::Newton => (1, 1, -2, 0),
            Self::NewtonPerMetre => (1, 0, -2, 0),
            Self::SquareMetrePerSecond => (0, 2, -1, 0),
            Self::Second => (0, 0, 1, 0),
        }
    }

    /// The units that people read this in.
    pub fn display_units(self) -> &'static [DisplayUnit] {
        match self {
            Self::Metre => &[DisplayUnit { name: "mm", factor: 1e3 }, DisplayUnit { name: "um", factor: 1e6 }],
            Self::MetrePerSecond => &[DisplayUnit { name: "mm/s", factor: 1e3 }],
            Self::Radian => &[DisplayUnit { name: "deg", factor: 180.0 / std::f64::consts::PI }],
            Self::Pascal => &[DisplayUnit { name: "kPa", factor: 1e-3 }, DisplayUnit { name: "MPa", factor: 1e-6 }],
            Self::SquareMetre => &[DisplayUnit { name: "um2", factor: 1e12 }, DisplayUnit { name: "mm2", factor: 1e6 }],
            Self::PerPascal => {
                &[DisplayUnit { name: "1/MPa", factor: 1e6 }, DisplayUnit { name: "1/GPa", factor: 1e9 }]
            }
            Self::PascalSecond => &[DisplayUnit { name: "mPa.s", factor: 1e3 }],
            Self::Newton => &[DisplayUnit { name: "mN", factor: 1e3 }, DisplayUnit { name: "kN", factor: 1e-3 }],
            Self::NewtonPerMetre => {
                &[DisplayUnit { name: "N/mm", factor: 1e-3 }, DisplayUnit { name: "N/um", factor: 1e-6 }]
            }
            Self::SquareMetrePerSecond => {
                &[DisplayUnit { name: "mm2/s", factor: 1e6 }, DisplayUnit { name: "um2/s", factor: 1e12 }]
            }
            Self::Second => &[DisplayUnit { name: "ms", factor: 1e3 }],
            Self::One => &[],
        }
    }
}
