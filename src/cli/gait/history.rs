//! Tables of what a joint does in a cycle, as people have them: CSV, or OpenSim's storage files.

use cartilage_contact::error::Error;
use cartilage_contact::parameters::{Inputs, Parameters, Value};
use cartilage_contact::units::Unit;
use cartilage_contact::variables;

/// What turns a table's force and flexion into load and speed.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    /// Extent of the contact out of the plane \[m\].
    pub width: f64,
    /// Sliding speed over the rate of flexion \[m\].
    pub radius: f64,
}

/// A row of a history.
#[derive(Debug)]
pub struct Row {
    /// Since the first row \[s\].
    pub time: f64,
    /// Load per unit depth \[N/m\].
    pub load: f64,
    /// Sum of the two surface speeds \[m/s\].
    pub speed: f64,
}

/// A column that a history may have.
#[derive(Clone, Copy, PartialEq)]
struct Column {
    name: &'static str,
    unit: Unit,
}

const TIME: Column = Column { name: "time", unit: Unit::Second };
const LOAD: Column = Column { name: "applied_load", unit: Unit::NewtonPerMetre };
const FORCE: Column = Column { name: "force", unit: Unit::Newton };
const SPEED: Column = Column { name: "sliding_speed", unit: Unit::MetrePerSecond };
const FLEXION: Column = Column { name: "flexion", unit: Unit::Radian };
const TRANSLATION: Column = Column { name: "translation", unit: Unit::Metre };

/// A column that was found: where, and how many SI units one of its numbers is.
struct Found {
    column: Column,
    place: usize,
    scale: f64,
}

const NEEDED: &str = "time, applied_load or force, and sliding_speed or flexion are needed";

/// The columns of a history, in the order of `values` in [`parse`]: time, load, and one or two of motion.
fn find(head: &[String]) -> Result<Vec<Found>, String> {
    let find = |column: Column| -> Result<Option<Found>, String> {
        for (place, cell) in head.iter().enumerate() {
            let (name, unit) = cell.split_once('[').map_or((cell.as_str(), None), |(name, unit)| (name, Some(unit)));
            if name.trim() != column.name {
                continue;
            }
            let scale = match unit {
                None => 1.0,
                Some(unit) => {
                    let unit = unit.trim_end().strip_suffix(']').unwrap_or(unit);
                    column.unit.read(&format!("1 {unit}")).map_err(|why| {
                        format!("column `{cell}`: {why}; allowed are {} and units of that kind", column.unit.name())
                    })?
                }
            };
            return Ok(Some(Found { column, place, scale }));
        }
        Ok(None)
    };
    let missing = |column: Column| {
        let columns = head.join(", ");
        format!("no column `{}` among {columns}; {NEEDED}", column.name)
    };
    let either = |one: Column, other: Column| match (find(one)?, find(other)?) {
        (Some(found), None) | (None, Some(found)) => Ok(found),
        (None, None) => Err(missing(one)),
        (Some(_), Some(_)) => {
            let [a, b] = [one, other].map(|column| format!("`{}` [{}]", column.name, column.unit.name()));
            Err(format!("columns {a} and {b} are both there: one of them"))
        }
    };
    let mut found = vec![find(TIME)?.ok_or_else(|| missing(TIME))?, either(LOAD, FORCE)?, either(SPEED, FLEXION)?];
    if let Some(translation) = find(TRANSLATION)? {
        if found[2].column == SPEED {
            return Err("column `translation` goes with `flexion`; a `sliding_speed` has it already".into());
        }
        found.push(translation);
    }
    Ok(found)
}

/// The rate of a column at every row, of the parabola through it and its neighbours; the last row repeats the first.
fn rates(table: &[(usize, [f64; 4])], column: usize) -> Vec<f64> {
    let count = table.len() - 1;
    let step = |row: usize| {
        let [a, b] = [&table[row % count].1, &table[row % count + 1].1];
        (b[0] - a[0], (b[column] - a[column]) / (b[0] - a[0]))
    };
    let rate = |row: usize| {
        let [(before, left), (after, right)] = [step(row + count - 1), step(row)];
        (left * after + right * before) / (before + after)
    };
    (0..=count).map(rate).collect()
}

/// The rows of one cycle, the last as the first.
///
/// # Errors
/// [`Error::Case`] with line and column of the first mistake.
pub fn parse(file: &str, text: &str, scales: Scales) -> Result<Vec<Row>, Error> {
    let mistake = |line: usize, message: String| Error::Case { file: file.into(), line, message };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let storage = [".sto", ".mot"].iter().any(|ending| file.to_lowercase().ends_with(ending));
    let lines = if storage { storage_lines(text) } else { csv_lines(text) };
    let mut lines = lines.map_err(|(line, message)| mistake(line, message))?.into_iter();
    let Some((line, head)) = lines.next() else {
        return Err(mistake(1, format!("no columns: {NEEDED}")));
    };
    if let [only] = &head[..]
        && only.contains(';')
    {
        return Err(mistake(line, format!("columns are separated by `;`: {DIALECT}")));
    }
    let name = |cell: &str| cell.split('[').next().unwrap_or_default().trim().to_owned();
    let names: Vec<String> = head.iter().map(|cell| name(cell)).collect();
    if let Some(twice) =
        (1..names.len()).find(|index| !names[*index].is_empty() && names[..*index].contains(&names[*index]))
    {
        return Err(mistake(line, format!("column `{}` is there twice: which one is meant?", names[twice])));
    }
    let found = find(&head).map_err(|message| mistake(line, message))?;

    let mut table: Vec<(usize, [f64; 4])> = Vec::new();
    let mut last_line = line;
    for (line, cells) in lines {
        if cells.len() > head.len() {
            let (count, columns) = (cells.len(), head.len());
            return Err(mistake(line, format!("{count} values below {columns} columns: {DIALECT}")));
        }
        let mut values = [0.0; 4];
        for (value, Found { place, scale, .. }) in values.iter_mut().zip(&found) {
            let cell = cells.get(*place).map_or("", String::as_str);
            let name = &head[*place];
            let number = cell.parse().ok().map(|number: f64| number * scale).filter(|number| number.is_finite());
            *value = number.ok_or_else(|| {
                let decimal_comma = cell.replacen(',', ".", 1).parse::<f64>().is_ok();
                let allowed =
                    if decimal_comma { DIALECT } else { "a finite number, in SI units or as the column's head says" };
                mistake(line, format!("column `{name}`: `{cell}` is not allowed: {allowed}"))
            })?;
        }
        if values[1] <= 0.0 {
            let (name, value) = (&head[found[1].place], values[1]);
            return Err(mistake(
                line,
                format!("column `{name}`: {value} is not allowed: above 0, the surfaces stay together"),
            ));
        }
        if let Some((_, before)) = table.last().filter(|(_, before)| values[0] <= before[0]) {
            let (value, before) = (values[0], before[0]);
            return Err(mistake(
                line,
                format!("column `time`: {value} is not allowed: later than the row before, {before}"),
            ));
        }
        table.push((line, values));
        last_line = line;
    }
    let (Some(&(_, first)), Some(&(_, last)), true) = (table.first(), table.last(), table.len() >= 3) else {
        let count = table.len();
        return Err(mistake(last_line, format!("{count} rows are too few: 3 or more, of one whole cycle")));
    };
    let period = last[0] - first[0];
    if !PERIODS.contains(&period) {
        return Err(mistake(
            last_line,
            format!(
                "column `time`: a cycle of {period:e} s is not allowed: from {:e} to {:e} s; is the time in seconds?",
                PERIODS.start(),
                PERIODS.end()
            ),
        ));
    }
    for (column, found) in found.iter().enumerate().skip(1) {
        let size = table.iter().map(|(_, row)| row[column].abs()).fold(0.0, f64::max);
        if (last[column] - first[column]).abs() > CLOSED * size {
            let name = &head[found.place];
            let most = 100.0 * CLOSED;
            return Err(mistake(
                last_line,
                format!(
                    "column `{name}`: the last row ends a cycle and has to repeat the first, within {most} % of the largest value"
                ),
            ));
        }
        if found.column == FLEXION && size > std::f64::consts::TAU {
            let name = &head[found.place];
            return Err(mistake(
                line,
                format!(
                    "column `{name}`: {size} rad is more than a turn; write `flexion [deg]` where degrees are meant"
                ),
            ));
        }
    }
    if let Some((_, row)) = table.last_mut() {
        *row = [last[0], first[1], first[2], first[3]];
    }
    let speed = match found[2].column == SPEED {
        true => table.iter().map(|(_, row)| row[2]).collect(),
        false => {
            let [flexion, translation] = [2, 3].map(|column| rates(&table, column));
            flexion
                .iter()
                .zip(translation)
                .map(|(flexion, translation)| scales.radius * flexion + translation)
                .collect::<Vec<_>>()
        }
    };
    let width = if found[1].column == FORCE { scales.width } else { 1.0 };
    let rows = table.iter().zip(speed).map(|((line, row), speed)| {
        let load = row[1] / width;
        for (input, value, column) in [("applied_load", load, &found[1]), ("sliding_speed", speed, &found[2])] {
            // The ranges of the table of variables.
            variables::set(&mut Parameters::default(), &mut Inputs::default(), input, &Value::Real(value))
                .map_err(|error| mistake(*line, format!("column `{}`: {error}", head[column.place])))?;
        }
        Ok(Row { time: row[0] - first[0], load, speed })
    });
    rows.collect()
}

/// The cells of every line that has some, with its number.
type Lines = Result<Vec<(usize, Vec<String>)>, (usize, String)>;

/// What is after `endheader` in an OpenSim storage file.
fn storage_lines(text: &str) -> Lines {
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    if !lines.any(|(_, line)| line.eq_ignore_ascii_case("endheader")) {
        return Err((1, "no line `endheader`, after which an OpenSim storage file has its columns".into()));
    }
    let cells = |line: &str| line.split_whitespace().map(|cell| cell.trim_matches('"').to_owned()).collect();
    let kept = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    Ok(kept.map(|(line, text)| (line, cells(text))).collect())
}

fn csv_lines(text: &str) -> Lines {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(1, |position| position.line() as usize);
            (line, format!("no CSV: {error}"))
        })?;
        // The reader counts a row from the comments and empty lines above it.
        let (line, byte) =
            record.position().map_or((1, 0), |position| (position.line() as usize, position.byte() as usize));
        let skipped = text[byte..].lines().take_while(|line| line.is_empty() || line.starts_with('#')).count();
        if record.iter().any(|cell| !cell.is_empty()) && !record[0].starts_with('#') {
            lines.push((line + skipped, record.iter().map(str::to_owned).collect()));
        }
    }
    Ok(lines)
}

/// How a CSV has to be written.
const DIALECT: &str = "columns are separated by commas and numbers have a decimal point, as 0.5; a spreadsheet saves that as CSV \
                       (not as CSV of a country with decimal commas)";

/// Seconds that a cycle may take.
const PERIODS: std::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// How far the last row of a file may be from its first, relative to the largest value; it is then replaced by the first.
const CLOSED: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn read(file: &str, text: &str, width: f64) -> Result<Vec<Row>, Error> {
        parse(file, text, Scales { width, radius: 0.03 })
    }

    #[test]
    fn mistakes_are_named_with_line_and_column() {
        let good = "time,applied_load,sliding_speed\n0,1,0\n1,2,1\n2,1,0\n";
        assert!(read("a.csv", good, 1.0).is_ok());
        for (from, to, expected) in [
            ("2,1\n2", "fast,1\n2", "a.csv:3: column `applied_load`: `fast` is not allowed: a finite number"),
            ("1,2,1", "1,2", "a.csv:3: column `sliding_speed`: `` is not allowed"),
            ("1,2,1", "1,nan,1", "`nan` is not allowed"),
            ("1,2,1", "1,-2,1", "a.csv:3: column `applied_load`: -2 is not allowed: above 0"),
            ("1,2,1", "0,2,1", "a.csv:3: column `time`: 0 is not allowed: later than the row before, 0"),
            ("sliding_speed", "speed", "a.csv:1: no column `sliding_speed` among time, applied_load, speed"),
            ("sliding_speed", "sliding_speed,flexion", "`sliding_speed` [m/s] and `flexion` [rad] are both there"),
            ("sliding_speed", "sliding_speed,translation", "a.csv:1: column `translation` goes with `flexion`"),
            ("time", "time [%]", "a.csv:1: column `time [%]`: `%` is not a unit of the same kind as s; allowed are s"),
            (
                "applied_load",
                "applied_load [kN]",
                "column `applied_load [kN]`: `kN` is not a unit of the same kind as N/m",
            ),
            (
                "sliding_speed\n0,1,0\n1,2,1",
                "flexion\n0,1,0\n1,2,30",
                "a.csv:1: column `flexion`: 30 rad is more than a turn",
            ),
            ("applied_load", "load", "no column `applied_load`"),
            ("2,1,0\n", "", "a.csv:3: 2 rows are too few"),
            ("2,1,0", "2,1.5,0", "a.csv:4: column `applied_load`: the last row ends a cycle"),
            (good, "", "a.csv:1: no columns"),
            ("sliding_speed", "sliding_speed,time", "a.csv:1: column `time` is there twice"),
            ("1,2,1", "\n# more\n1,0,2,1,0", "a.csv:5: 5 values below 3 columns: columns are separated by commas"),
            ("1,2,1", "1,\"2,5\",1", "a.csv:3: column `applied_load`: `2,5` is not allowed: columns are separated by"),
            ("1,2,1", "1,2,11", "a.csv:3: column `sliding_speed`: sliding_speed = 11 is not allowed: a number from"),
            ("1,2,1", "1,2e9,1", "a.csv:3: column `applied_load`: applied_load = 2000000000 is not allowed"),
            ("\n2,1", "\n2e9,1", "a.csv:4: column `time`: a cycle of 2e9 s is not allowed"),
            ("0,1,0\n1,2,1\n2,", "0,1,0\n1e-300,2,1\n2e-300,", "a cycle of 2e-300 s is not allowed"),
        ] {
            let text = good.replace(from, to);
            assert_ne!(text, good, "{from}");
            let message = read("a.csv", &text, 1.0).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}, not {expected}");
        }
        let message = read("a.csv", &good.replace(',', ";").replace('.', ","), 1.0).unwrap_err().to_string();
        assert!(message.contains("a.csv:1: columns are separated by `;`"), "{message}");
        let message = read("a.sto", good, 1.0).unwrap_err().to_string();
        assert!(message.contains("endheader"), "{message}");
    }

    proptest! {
        // As many as PROPTEST_CASES says.
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(15), ..ProptestConfig::default() })]
        #[test]
        fn altered_histories_are_read_or_refused(
            storage in any::<bool>(),
            edits in collection::vec((0.0..1.0, any::<u8>(), 0..5_usize), 1..9),
        ) {
            const WORDS: [&str; 10] = ["\n", ",", "\"", "#", ";", "1e308", "-0", "endheader\n", "\r", "\u{e9}"];
            let table = "time, applied_load, sliding_speed\n0, 1.5, 0\n# rest\n0.5, 2, 0.1\n1, 3, -0.1\n1.5, 1.5, 0\n";
            let text = if storage { format!("walk\nendheader\n{}", table.replace(", ", "\t")) } else { table.into() };
            let mut bytes = text.into_bytes();
            for (fraction, byte, kind) in edits {
                let place = (fraction * bytes.len() as f64) as usize;
                match kind {
                    0 => bytes[place] = byte,
                    1 => bytes[place] ^= 1 << (byte % 8),
                    2 => { bytes.drain(place..bytes.len().min(place + usize::from(byte % 9))); }
                    _ => { bytes.splice(place..place, WORDS[usize::from(byte) % WORDS.len()].bytes()); }
                }
                if bytes.is_empty() { break; }
            }
            match read(if storage { "f.sto" } else { "f.csv" }, &String::from_utf8_lossy(&bytes), 0.7) {
                Ok(rows) => {
                    prop_assert!(rows.len() > 2 && rows.windows(2).all(|pair| pair[1].time > pair[0].time));
                    prop_assert!(rows.iter().all(|row| row.load > 0.0 && row.load <= 1e9), "{:?}", rows);
                    prop_assert!(rows.iter().all(|row| row.speed.abs() <= 10.0), "{:?}", rows);
                }
                Err(error) => prop_assert!(error.to_string().starts_with("f."), "{}", error),
            }
        }
    }
}
