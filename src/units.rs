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
    NewtonMetre,
    NewtonMetrePerMetre,
    Watt,
    Joule,
    SquareMetrePerSecond,
    Second,
    /// Of hydraulic permeability.
    MetreToTheFourthPerNewtonSecond,
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
            Self::NewtonMetre => "N.m",
            Self::NewtonMetrePerMetre => "N.m/m",
            Self::Watt => "W",
            Self::Joule => "J",
            Self::SquareMetrePerSecond => "m2/s",
            Self::Second => "s",
            Self::MetreToTheFourthPerNewtonSecond => "m4/(N.s)",
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
            Self::Newton | Self::NewtonMetrePerMetre => (1, 1, -2, 0),
            Self::NewtonPerMetre => (1, 0, -2, 0),
            Self::NewtonMetre | Self::Joule => (1, 2, -2, 0),
            Self::Watt => (1, 2, -3, 0),
            Self::SquareMetrePerSecond => (0, 2, -1, 0),
            Self::Second => (0, 0, 1, 0),
            Self::MetreToTheFourthPerNewtonSecond => (-1, 3, 1, 0),
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
                &[DisplayUnit { name: "kN/m", factor: 1e-3 }, DisplayUnit { name: "N/um", factor: 1e-6 }]
            }
            Self::SquareMetrePerSecond => {
                &[DisplayUnit { name: "mm2/s", factor: 1e6 }, DisplayUnit { name: "um2/s", factor: 1e12 }]
            }
            Self::Second => &[DisplayUnit { name: "ms", factor: 1e3 }],
            Self::NewtonMetre => &[DisplayUnit { name: "N.mm", factor: 1e3 }],
            Self::NewtonMetrePerMetre => &[DisplayUnit { name: "N.mm/mm", factor: 1.0 }],
            Self::Watt => &[DisplayUnit { name: "mW", factor: 1e3 }],
            Self::Joule => &[DisplayUnit { name: "mJ", factor: 1e3 }],
            Self::MetreToTheFourthPerNewtonSecond => &[DisplayUnit { name: "mm4/(N.s)", factor: 1e12 }],
            Self::One => &[],
        }
    }

    /// The SI value of a number with a unit of this kind, such as `0.7 MPa`, `5 deg` or `1.2e-15 m^4/(N s)`; otherwise what is wrong.
    ///
    /// # Errors
    /// Why the text is no such value, as a clause.
    pub fn read(self, text: &str) -> Result<f64, String> {
        const LONGEST: usize = 100;
        let text = text.trim();
        if text.chars().nth(LONGEST).is_some() {
            return Err("it is too long for a number with a unit".into());
        }
        let (number, unit) = split_number(text).ok_or("a number has to come first, then its unit")?;
        let unit = unit.trim();
        let mut rest = Reader { symbols: &plain(unit) };
        let scale = rest.product().filter(|_| rest.symbols.is_empty());
        let scale = scale.ok_or_else(|| format!("`{unit}` is no unit that is known"))?;
        let (kg, m, s, rad) = self.base();
        if scale.base != [kg, m, s, rad] {
            let wanted = if self == Self::One { "a pure number" } else { self.name() };
            return Err(format!("`{unit}` is not a unit of the same kind as {wanted}"));
        }
        // The decimal prefix goes to the number's exponent, so that `12 um` is 12e-6 to the last bit.
        let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
        let value: Option<f64> = (exponent.parse::<i32>().ok())
            .and_then(|exponent| format!("{digits}e{}", exponent.checked_add(scale.power)?).parse().ok());
        value.map(|value| value * scale.factor).ok_or_else(|| format!("`{number}` is no number"))
    }
}

/// A unit as factor * 10^power of the SI units kg, m, s, rad with these exponents.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scale {
    factor: f64,
    power: i32,
    base: [i32; 4],
}

/// Units by their symbols. Those that take prefixes come first.
const SYMBOLS: [(&str, Scale); 13] = {
    const fn unit(factor: f64, power: i32, base: [i32; 4]) -> Scale {
        Scale { factor, power, base }
    }
    [
        ("Pa", unit(1.0, 0, [1, -1, -2, 0])),
        ("N", unit(1.0, 0, [1, 1, -2, 0])),
        ("m", unit(1.0, 0, [0, 1, 0, 0])),
        ("s", unit(1.0, 0, [0, 0, 1, 0])),
        ("g", unit(1.0, -3, [1, 0, 0, 0])),
        ("J", unit(1.0, 0, [1, 2, -2, 0])),
        ("rad", unit(1.0, 0, [0, 0, 0, 1])),
        ("min", unit(60.0, 0, [0, 0, 1, 0])),
        ("h", unit(3600.0, 0, [0, 0, 1, 0])),
        ("deg", unit(std::f64::consts::PI / 180.0, 0, [0, 0, 0, 1])),
        ("\u{b0}", unit(std::f64::consts::PI / 180.0, 0, [0, 0, 0, 1])),
        ("%", unit(1.0, -2, [0; 4])),
        ("1", unit(1.0, 0, [0; 4])),
    ]
};

/// How many of [`SYMBOLS`] take a prefix.
const PREFIXED: usize = 7;

const PREFIXES: [(&str, i32); 10] =
    [("G", 9), ("M", 6), ("k", 3), ("h", 2), ("d", -1), ("c", -2), ("m", -3), ("u", -6), ("n", -9), ("p", -12)];

/// The number that a text begins with, and the rest.
fn split_number(text: &str) -> Option<(&str, &str)> {
    // The longest beginning that is a number; `2 m` must not become 2e-3 of nothing, nor `2 e` a number.
    let end = (1..=text.len()).rev().find(|end| {
        text.get(..*end).is_some_and(|number| {
            number.ends_with(|c: char| c.is_ascii_digit() || c == '.') && number.parse::<f64>().is_ok()
        })
    })?;
    Some(text.split_at(end))
}

/// The unit in ASCII: superscripts as exponents, both signs for micro as `u`, dots and asterisks as blanks.
fn plain(unit: &str) -> String {
    const SUPERSCRIPTS: &str = "\u{2070}\u{b9}\u{b2}\u{b3}\u{2074}\u{2075}\u{2076}\u{2077}\u{2078}\u{2079}";
    let mut text = String::new();
    for symbol in unit.replace("**", "^").chars() {
        match (SUPERSCRIPTS.chars().position(|c| c == symbol), symbol) {
            (Some(digit), _) => text += &digit.to_string(),
            (_, '\u{207b}') => text.push('-'),
            (_, '\u{b5}' | '\u{3bc}') => text.push('u'),
            (_, '.' | '*' | '\u{b7}') => text.push(' '),
            (_, other) => text.push(other),
        }
    }
    text
}

/// What is left to read of a unit.
struct Reader<'a> {
    symbols: &'a str,
}

impl Reader<'_> {
    fn skip(&mut self, symbol: char) -> bool {
        let rest = self.symbols.trim_start().strip_prefix(symbol);
        self.symbols = rest.unwrap_or(self.symbols.trim_start());
        rest.is_some()
    }

    /// Factors side by side; a solidus divides by the one factor that follows.
    fn product(&mut self) -> Option<Scale> {
        let mut product = self.factor()?;
        loop {
            let divided = self.skip('/');
            if !divided && (self.symbols.is_empty() || self.symbols.starts_with(')')) {
                return Some(product);
            }
            let next = self.factor()?.to_the(if divided { -1 } else { 1 })?;
            product.factor *= next.factor;
            product.power = product.power.checked_add(next.power)?;
            for (sum, exponent) in product.base.iter_mut().zip(next.base) {
                *sum = sum.checked_add(exponent)?;
            }
        }
    }

    /// A symbol or a product in parentheses, to a power.
    fn factor(&mut self) -> Option<Scale> {
        let base = if self.skip('(') {
            let inner = self.product()?;
            self.skip(')').then_some(inner)?
        } else {
            let end = self.symbols.find(|c: char| c.is_whitespace() || "/()^-+0123456789".contains(c));
            // A lone 1 is the unit of what follows a solidus, `1/MPa`.
            let end = if self.symbols.starts_with('1') { 1 } else { end.unwrap_or(self.symbols.len()) };
            let (symbol, rest) = self.symbols.split_at(end);
            self.symbols = rest;
            scale_of(symbol)?
        };
        let marked = self.symbols.starts_with('^');
        let rest = self.symbols.trim_start_matches('^');
        let end = rest.char_indices().find(|(i, c)| !(c.is_ascii_digit() || *i == 0 && *c == '-'));
        let (exponent, rest) = rest.split_at(end.map_or(rest.len(), |(end, _)| end));
        self.symbols = rest;
        if exponent.is_empty() && !marked { Some(base) } else { base.to_the(exponent.parse().ok()?) }
    }
}

impl Scale {
    fn to_the(self, exponent: i32) -> Option<Self> {
        let mut base = self.base;
        for e in &mut base {
            *e = e.checked_mul(exponent)?;
        }
        Some(Self { factor: self.factor.powi(exponent), power: self.power.checked_mul(exponent)?, base })
    }
}

fn scale_of(symbol: &str) -> Option<Scale> {
    let named = |list: &[(&str, Scale)], name: &str| list.iter().find(|row| row.0 == name).map(|row| row.1);
    named(&SYMBOLS, symbol).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, power)| {
            let scale = named(&SYMBOLS[..PREFIXED], symbol.strip_prefix(prefix)?)?;
            Some(Scale { power: scale.power + power, ..scale })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_units_are_read_to_the_last_bit() {
        for (unit, text, value) in [
            (Unit::Metre, "2 mm", 2e-3),
            (Unit::Metre, "12 um", 12e-6),
            (Unit::Metre, "-1.5e1\u{b5}m", -15e-6),
            (Unit::Metre, "0.3 \u{3bc}m", 0.3e-6),
            (Unit::Pascal, "0.7 MPa", 0.7e6),
            (Unit::Pascal, "0.7MPa", 0.7e6),
            (Unit::Pascal, "3 N/mm^2", 3e6),
            (Unit::Pascal, "3 N mm-2", 3e6),
            (Unit::PascalSecond, "1 mPa s", 1e-3),
            (Unit::PascalSecond, "1 mPa.s", 1e-3),
            (Unit::PerPascal, "4.5e-4 1/MPa", 4.5e-10),
            (Unit::PerPascal, "4.5e-4 MPa\u{207b}\u{b9}", 4.5e-10),
            (Unit::SquareMetre, "1.18e-6 um\u{b2}", 1.18e-18),
            (Unit::MetrePerSecond, "30 mm/s", 30e-3),
            (Unit::Second, "2 h", 7200.0),
            (Unit::NewtonPerMetre, "10 kN/m", 10e3),
            (Unit::Radian, "180 deg", std::f64::consts::PI),
            (Unit::One, "20 %", 0.2),
            (Unit::MetreToTheFourthPerNewtonSecond, "1.18e-15 m^4/(N s)", 1.18e-15),
            (Unit::MetreToTheFourthPerNewtonSecond, "1.18e-15 m4/N/s", 1.18e-15),
            (Unit::MetreToTheFourthPerNewtonSecond, "1.18e-3 mm4/(N*s)", 1.18e-15),
            (Unit::MetreToTheFourthPerNewtonSecond, "1.18e-15 m2/Pa/s", 1.18e-15),
        ] {
            assert_eq!(unit.read(text), Ok(value), "{text}");
        }
        // A unit to a power: prefix and all.
        let read = Unit::Pascal.read("1 kg/(m (ms)^2)").unwrap();
        assert!((read - 1e6).abs() < 1e-9, "{read}");
    }

    #[test]
    fn what_is_no_value_of_the_kind_is_refused() {
        for (unit, text, why) in [
            (Unit::Metre, "2 MPa", "`MPa` is not a unit of the same kind as m"),
            (Unit::Metre, "2 m^2", "not a unit of the same kind"),
            // The solidus divides by N alone.
            (Unit::MetreToTheFourthPerNewtonSecond, "1 m^4/N s", "not a unit of the same kind"),
            (Unit::One, "2 m", "a pure number"),
            (Unit::Metre, "2 inch", "`inch` is no unit that is known"),
            (Unit::Metre, "2 m/", "no unit"),
            (Unit::Metre, "2 (m", "no unit"),
            (Unit::Metre, "2 m)", "no unit"),
            (Unit::Metre, "2 m^", "no unit"),
            (Unit::Metre, "2 m^99999999999", "no unit"),
            (Unit::Metre, "2 Gh", "no unit"),
            (Unit::Metre, "2", "no unit"),
            (Unit::Metre, "mm", "a number has to come first"),
            (Unit::Metre, "1e99999999999 mm", "is no number"),
        ] {
            let error = unit.read(text).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
        assert!(Unit::Metre.read(&format!("1 {}", "(".repeat(1_000_000))).is_err());
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_answered(text in "[0-9eE+. -]{0,4}[ (]{0,3}[mMPasNkgu1()^/%\u{b5}\u{b2}\u{207b} -]{0,12}[0-9)]{0,3}") {
            let _ = Unit::Metre.read(&text);
            let _ = Unit::One.read(&text);
        }
    }
}
