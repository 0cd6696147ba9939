//! What a joint does in one cycle of walking: load and sliding speed at equal steps of time, stylised or from a file.

use std::path::Path;

use cartilage_contact::error::Error;
use cartilage_contact::parameters::{Inputs, Parameters, Value};
use cartilage_contact::variables;

/// Load and sliding speed over one cycle. The last point repeats the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// From 0 to the period \[s\].
    pub time: Vec<f64>,
    /// Load per unit depth \[N/m\].
    pub load: Vec<f64>,
    /// Sum of the two surface speeds \[m/s\].
    pub speed: Vec<f64>,
}

/// Seconds of a walking cycle, a round number: at 4 km/h a stride of 1.2 m.
const PERIOD: f64 = 1.1;
/// Largest hip contact force in body weights, walking at about 4 km/h: Bergmann et al., Journal of Biomechanics 34 (7), 859-871,
/// 2001.
pub const PEAK: f64 = 2.38;

/// Hip contact force: share of the cycle from heel strike, body weights. The first peak is the published one; the valley, the
/// second peak and the low load of the swinging leg are round numbers in its proportions.
const LOAD: [(f64, f64); 5] = [(0.15, PEAK), (0.31, 1.5), (0.48, 2.1), (0.70, 0.25), (0.95, 0.25)];
/// Hip flexion: share of the cycle, degrees. Extended by 10 degrees late in stance, flexed by 30 late in swing: usual textbook
/// values, such as in Perry and Burnfield, Gait Analysis, 2010.
const FLEXION: [(f64, f64); 2] = [(0.52, -10.0), (0.95, 30.0)];

/// A periodic curve that goes from extreme to extreme in half cosine waves: its value, and its rate per cycle.
fn through(extremes: &[(f64, f64)], share: f64) -> (f64, f64) {
    let next = extremes.iter().position(|extreme| extreme.0 > share);
    let end = next.unwrap_or(0);
    let start = (end + extremes.len() - 1) % extremes.len();
    let ((from, low), (to, high)) = (extremes[start], extremes[end]);
    // Between the last extreme of a cycle and the first of the next.
    let length = (to - from).rem_euclid(1.0);
    let angle = std::f64::consts::PI * (share - from).rem_euclid(1.0) / length;
    let half = 0.5 * (high - low);
    (low + half * (1.0 - angle.cos()), half * angle.sin() * std::f64::consts::PI / length)
}

impl Cycle {
    /// The stylised hip: this load \[N/m\] for every body weight, and the speed of a head of this radius \[m\].
    pub fn stylised(load_per_body_weight: f64, radius: f64, steps: usize) -> Self {
        let shares: Vec<f64> = (0..=steps).map(|step| (step % steps) as f64 / steps as f64).collect();
        Self {
            time: (0..=steps).map(|step| PERIOD * step as f64 / steps as f64).collect(),
            load: shares.iter().map(|share| load_per_body_weight * through(&LOAD, *share).0).collect(),
            speed: shares
                .iter()
                .map(|share| radius * through(&FLEXION, *share).1.to_radians() / PERIOD + 0.0)
                .collect(),
        }
    }

    /// Reads a table of `time`, `sliding_speed`, and `applied_load` or `force` (of a contact of this width): CSV, or an OpenSim
    /// storage file (`.sto`, `.mot`). Linear between its rows.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read, [`Error::Case`] with line and column of the first mistake.
    pub fn read(path: &Path, width: f64, steps: usize) -> Result<Self, Error> {
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&file, &text, width, steps),
            Err(error) => Err(Error::File { path: file, message: format!("could not read the history: {error}") }),
        }
    }

    fn parse(file: &str, text: &str, width: f64, steps: usize) -> Result<Self, Error> {
        let mistake = |line: usize, message: String| Error::Case { file: file.into(), line, message };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let storage = [".sto", ".mot"].iter().any(|ending| file.to_lowercase().ends_with(ending));
        let lines = if storage { storage_lines(text) } else { csv_lines(text) };
        let mut lines = lines.map_err(|(line, message)| mistake(line, message))?.into_iter();
        let Some((line, head)) = lines.next() else {
            return Err(mistake(1, "no columns: time, applied_load or force, sliding_speed".into()));
        };
        if let [only] = &head[..]
            && only.contains(';')
        {
            return Err(mistake(line, format!("columns are separated by `;`: {DIALECT}")));
        }
        if let Some(twice) =
            (1..head.len()).find(|index| !head[*index].is_empty() && head[..*index].contains(&head[*index]))
        {
            return Err(mistake(line, format!("column `{}` is there twice: which one is meant?", head[twice])));
        }
        let find = |name: &str| head.iter().position(|column| column == name);
        let missing = |name: &str| {
            let columns = head.join(", ");
            mistake(
                line,
                format!(
                    "no column `{name}` among {columns}; time, applied_load or force, and sliding_speed are needed"
                ),
            )
        };
        let (load, divisor) = match (find("applied_load"), find("force")) {
            (Some(column), None) => (column, 1.0),
            (None, Some(column)) => (column, width),
            (Some(_), Some(_)) => {
                return Err(mistake(
                    line,
                    "columns `applied_load` [N/m] and `force` [N] are both there: one of them".into(),
                ));
            }
            (None, None) => return Err(missing("applied_load")),
        };
        let columns = [find("time").ok_or_else(|| missing("time"))?, load]
            .into_iter()
            .chain([find("sliding_speed").ok_or_else(|| missing("sliding_speed"))?]);
        let columns: Vec<usize> = columns.collect();

        let mut table: Vec<[f64; 3]> = Vec::new();
        let mut last_line = line;
        for (line, cells) in lines {
            if cells.len() > head.len() {
                let (count, columns) = (cells.len(), head.len());
                return Err(mistake(line, format!("{count} values below {columns} columns: {DIALECT}")));
            }
            let mut row = [0.0; 3];
            for (value, &column) in row.iter_mut().zip(&columns) {
                let cell = cells.get(column).map_or("", String::as_str);
                let name = &head[column];
                *value = cell.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
                    let decimal_comma = cell.replacen(',', ".", 1).parse::<f64>().is_ok();
                    let allowed = if decimal_comma { DIALECT } else { "a finite number in SI units" };
                    mistake(line, format!("column `{name}`: `{cell}` is not allowed: {allowed}"))
                })?;
            }
            if row[1] <= 0.0 {
                let (name, value) = (&head[load], row[1]);
                return Err(mistake(
                    line,
                    format!("column `{name}`: {value} is not allowed: above 0, the surfaces stay together"),
                ));
            }
            if let Some(before) = table.last().filter(|before| row[0] <= before[0]) {
                let (value, before) = (row[0], before[0]);
                return Err(mistake(
                    line,
                    format!("column `time`: {value} is not allowed: later than the row before, {before}"),
                ));
            }
            row[1] /= divisor;
            for (input, column) in [("applied_load", 1), ("sliding_speed", 2)] {
                // The ranges of the table of variables.
                variables::set(&mut Parameters::default(), &mut Inputs::default(), input, &Value::Real(row[column]))
                    .map_err(|error| mistake(line, format!("column `{}`: {error}", head[columns[column]])))?;
            }
            table.push(row);
            last_line = line;
        }
        let (Some(&first), Some(&last), true) = (table.first(), table.last(), table.len() >= 3) else {
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
        for column in [1, 2] {
            let size = table.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
            if (last[column] - first[column]).abs() > CLOSED * size {
                let name = &head[columns[column]];
                let most = 100.0 * CLOSED;
                return Err(mistake(
                    last_line,
                    format!(
                        "column `{name}`: the last row ends a cycle and has to repeat the first, within {most} % of the largest value"
                    ),
                ));
            }
        }
        if let Some(row) = table.last_mut() {
            *row = [last[0], first[1], first[2]];
        }
        let time: Vec<f64> = (0..=steps).map(|step| period * step as f64 / steps as f64).collect();
        let at = |time: f64, column: usize| {
            let end = table.partition_point(|row| row[0] - first[0] < time).clamp(1, table.len() - 1);
            let [a, b] = [table[end - 1], table[end]];
            let share = ((time - (a[0] - first[0])) / (b[0] - a[0])).clamp(0.0, 1.0);
            a[column] + share * (b[column] - a[column])
        };
        Ok(Self {
            load: time.iter().map(|time| at(*time, 1)).collect(),
            speed: time.iter().map(|time| at(*time, 2)).collect(),
            time,
        })
    }
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

    #[test]
    fn the_stylised_hip_has_two_peaks_and_turns_twice() {
        let cycle = Cycle::stylised(100.0, 0.024, 200);
        assert_eq!((cycle.time.len(), cycle.time[200]), (201, 1.1));
        assert_eq!((cycle.load[0], cycle.speed[0]), (cycle.load[200], cycle.speed[200]));
        let peaks: Vec<usize> =
            (1..200).filter(|&i| cycle.load[i] > cycle.load[i - 1] && cycle.load[i] > cycle.load[i + 1]).collect();
        assert_eq!(peaks, [30, 96]);
        assert!((cycle.load[30] - 238.0).abs() < 1e-9 && (cycle.load[96] - 210.0).abs() < 1e-9);
        assert!(cycle.load.iter().all(|load| *load >= 25.0 - 1e-9));
        let turns = cycle.speed.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count();
        assert_eq!(turns, 2);
        // Out and back: flexion returns to where it was, and covers 40 degrees each way.
        let way = |sign: f64| cycle.speed[1..].iter().map(|v| (sign * v).max(0.0) * 1.1 / 200.0).sum::<f64>();
        let arc = 0.024 * 40_f64.to_radians();
        assert!((way(1.0) - arc).abs() < 1e-3 * arc && (way(-1.0) - arc).abs() < 1e-3 * arc, "{} {arc}", way(1.0));
    }

    #[test]
    fn files_are_read_linearly_between_rows() {
        let csv = "# a comment\nsliding_speed, time, force\n0.1,2,10\n-0.1,2.5,30\n0.1,3,10\n";
        let cycle = Cycle::parse("own.csv", csv, 0.5, 4).unwrap();
        assert_eq!(cycle.time, [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(cycle.load, [20.0, 40.0, 60.0, 40.0, 20.0]);
        assert!(cycle.speed.iter().zip([0.1, 0.0, -0.1, 0.0, 0.1]).all(|(a, b): (&f64, _)| (a - b).abs() < 1e-15));
        let spreadsheet = "\u{feff}\"time\",\"sliding_speed\",\"force\",\"a \"\"note\"\", or two\"\r\n\
                           2,0.1,10,\"with, commas\r\nand lines\"\r\n\r\n2.5,\"-0.1\",30,\r\n3,0.1,10,\r\n";
        assert_eq!(Cycle::parse("own.csv", spreadsheet, 0.5, 4).unwrap(), cycle);
        let storage = "walk\nversion=1\nnRows=3\nnColumns=4\ninDegrees=no\nendheader\ntime\tother\tapplied_load\tsliding_speed\n\
                       2 7 20 0.1\n2.5 7 60 -0.1\n3 7 20 0.1\n";
        assert_eq!(Cycle::parse("own.sto", storage, 0.5, 4).unwrap(), cycle);
    }

    #[test]
    fn mistakes_are_named_with_line_and_column() {
        let good = "time,applied_load,sliding_speed\n0,1,0\n1,2,1\n2,1,0\n";
        assert!(Cycle::parse("a.csv", good, 1.0, 8).is_ok());
        for (from, to, expected) in [
            ("2,1\n2", "fast,1\n2", "a.csv:3: column `applied_load`: `fast` is not allowed: a finite number"),
            ("1,2,1", "1,2", "a.csv:3: column `sliding_speed`: `` is not allowed"),
            ("1,2,1", "1,nan,1", "`nan` is not allowed"),
            ("1,2,1", "1,-2,1", "a.csv:3: column `applied_load`: -2 is not allowed: above 0"),
            ("1,2,1", "0,2,1", "a.csv:3: column `time`: 0 is not allowed: later than the row before, 0"),
            ("sliding_speed", "speed", "a.csv:1: no column `sliding_speed` among time, applied_load, speed"),
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
            let message = Cycle::parse("a.csv", &text, 1.0, 8).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}, not {expected}");
        }
        let message = Cycle::parse("a.csv", &good.replace(',', ";").replace('.', ","), 1.0, 8).unwrap_err().to_string();
        assert!(message.contains("a.csv:1: columns are separated by `;`"), "{message}");
        let message = Cycle::parse("a.sto", good, 1.0, 8).unwrap_err().to_string();
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
            for (share, byte, kind) in edits {
                let place = (share * bytes.len() as f64) as usize;
                match kind {
                    0 => bytes[place] = byte,
                    1 => bytes[place] ^= 1 << (byte % 8),
                    2 => { bytes.drain(place..bytes.len().min(place + usize::from(byte % 9))); }
                    _ => { bytes.splice(place..place, WORDS[usize::from(byte) % WORDS.len()].bytes()); }
                }
                if bytes.is_empty() { break; }
            }
            match Cycle::parse(if storage { "f.sto" } else { "f.csv" }, &String::from_utf8_lossy(&bytes), 0.7, 16) {
                Ok(Cycle { time, load, speed }) => {
                    prop_assert!(time.windows(2).all(|pair| pair[1] > pair[0]) && time.len() == 17);
                    prop_assert!(load.iter().all(|load| *load > 0.0 && *load <= 1e9), "{:?}", load);
                    prop_assert!(speed.iter().all(|speed| speed.abs() <= 10.0), "{:?}", speed);
                }
                Err(error) => prop_assert!(error.to_string().starts_with("f."), "{}", error),
            }
        }
    }
}
