//! The table of solved states: a CSV that grows with every state, and beside it the case that it belongs to. Every row names its
//! case by a hash, so that rows and case cannot be mistaken for each other's whenever a run was stopped.

use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

use cartilage_contact::error::Error;
use cartilage_contact::files::{self, OutputFolder, unwritten};
use cartilage_contact::io::case::Case;
use cartilage_contact::parameters::{Inputs, PARAMETERS, Value};
use cartilage_contact::simulation::{Input, Simulation};
use cartilage_contact::variables::{self, Source, Type, VARIABLES, Variable, View};

use crate::cli::format;

/// Rows of text under the names of the FMU's variables.
pub struct Table {
    _folder: OutputFolder,
    case: String,
    path: PathBuf,
    rows: Vec<Vec<String>>,
    held: HashSet<[u64; 2]>,
    writer: csv::Writer<File>,
}

/// The inputs of a steady state at a given depth, then results.
fn columns() -> impl Iterator<Item = &'static Variable> {
    let given = |row: &&Variable| match row.source {
        Source::Input(row) => !matches!(row.input, Input::ApproachSpeed | Input::AppliedLoad),
        _ => false,
    };
    VARIABLES.iter().filter(given).chain(variables::scalar_outputs())
}

fn column(name: &str) -> Option<usize> {
    columns().position(|variable| variable.name == name)
}

/// The last column: which case a row is of.
const CASE: &str = "case";

/// The words of the header.
fn header() -> impl Iterator<Item = &'static str> {
    columns().map(|variable| variable.name).chain([CASE])
}

/// The hash of what all states of a case have in common, and of the program that solved them.
fn hash(case: &Case) -> String {
    let text = format!("{}\n{}", version(), case.fixed_part());
    uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, text.as_bytes()).simple().to_string()
}

fn key(depth: f64, speed: f64) -> [u64; 2] {
    // -0 and 0 are one depth.
    [(depth + 0.0).to_bits(), (speed + 0.0).to_bits()]
}

impl Table {
    /// The table in a folder, with what a stopped run left there.
    pub fn open(folder: &Path, case: &Case, fresh: bool) -> Result<Self, Error> {
        let locked = OutputFolder::open(folder)?;
        let hash = hash(case);
        let (path, case_path) = (folder.join("stribeck.csv"), folder.join("case.toml"));
        let text = format!(
            "# What stribeck.csv holds the states of.\n# cartilage-contact {}\n{}",
            version(),
            case.fixed_part()
        );
        let mut rows = Vec::new();
        if !fresh && path.exists() {
            rows = read(&path)?;
            if rows.iter().any(|row| row.last() != Some(&hash)) {
                return Err(other_case(&case_path, case));
            }
        }
        let writer = rewrite(&path, &rows)?;
        files::replace(&case_path, text.as_bytes())?;
        let mut table = Self { _folder: locked, case: hash, path, rows: Vec::new(), held: HashSet::new(), writer };
        rows.into_iter().for_each(|row| table.hold(row));
        Ok(table)
    }

    /// Where the CSV is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a state is in the table.
    pub fn holds(&self, inputs: &Inputs) -> bool {
        self.held.contains(&key(inputs.penetration_depth, inputs.sliding_speed))
    }

    fn hold(&mut self, row: Vec<String>) {
        let number = |index: usize| row[index].parse().unwrap_or(f64::NAN);
        if self.held.insert(key(number(0), number(1))) {
            self.rows.push(row);
        }
    }

    /// Adds the present state of a simulation, in memory and on disk.
    pub fn add(&mut self, simulation: &mut Simulation) -> Result<(), Error> {
        if self.holds(simulation.inputs()) {
            return Ok(());
        }
        let view = View::new(simulation)?;
        let row: Vec<String> = columns()
            .map(|variable| match variable.get(&view) {
                Value::Real(value) if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) => format!("{value:e}"),
                Value::Text(word) => word,
                other => other.to_string(),
            })
            .chain([self.case.clone()])
            .collect();
        self.writer.write_record(&row).map_err(|error| unwritten(&self.path, error))?;
        self.writer.flush().map_err(|error| unwritten(&self.path, error))?;
        self.hold(row);
        Ok(())
    }

    /// Leaves the file in order: speed by speed, from apart to pressed.
    pub fn finish(&mut self) -> Result<(), Error> {
        let order = |row: &Vec<String>| [1, 0].map(|index| row[index].parse::<f64>().unwrap_or(f64::NAN));
        self.rows.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal));
        self.writer = rewrite(&self.path, &self.rows)?;
        format::write_units(&self.path, header())?;
        #[cfg(feature = "parquet")]
        self.write_parquet()?;
        Ok(())
    }

    #[cfg(feature = "parquet")]
    fn write_parquet(&self) -> Result<(), Error> {
        use super::parquet::{self, Column};
        let cases = self.rows.iter().filter_map(|row| row.last().cloned()).collect();
        let columns: Vec<_> = columns()
            .map(|variable| {
                let name = variable.name;
                let column = match variable.data_type() {
                    Type::Enumeration(_) | Type::Boolean => {
                        Column::Words(self.words(name).into_iter().map(String::from).collect())
                    }
                    _ => Column::Numbers(self.numbers(name)),
                };
                (name, column)
            })
            .chain([(CASE, Column::Words(cases))])
            .collect();
        let path = self.path.with_extension("parquet");
        files::replace(&path, &parquet::file(&columns).map_err(|error| unwritten(&path, error))?)
    }

    /// A column of numbers.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let index = column(name);
        self.rows.iter().map(|row| index.and_then(|i| row[i].parse().ok()).unwrap_or(f64::NAN)).collect()
    }

    /// A column of words.
    pub fn words(&self, name: &str) -> Vec<&str> {
        let index = column(name);
        self.rows.iter().map(|row| index.map_or("", |i| row[i].as_str())).collect()
    }

    /// Where contact begins and where friction is least, speed by speed.
    pub fn summary(&self) -> String {
        let [depth, speed, friction, film] =
            ["penetration_depth", "sliding_speed", "friction_coefficient", "minimum_film_thickness"]
                .map(|name| self.numbers(name));
        let micron = |metres: f64| format::number(1e6 * metres, 4);
        let mut text = String::new();
        let mut first = 0;
        while first < depth.len() {
            let last = (first..depth.len()).take_while(|i| speed[*i] == speed[first]).last().unwrap_or(first);
            text += &format!("\n{} states at {} m/s. ", last + 1 - first, format::number(speed[first], 4));
            if let Some(least) = (first..=last).min_by(|a, b| friction[*a].total_cmp(&friction[*b])) {
                text += &format!(
                    "Least friction coefficient {} at d = {} um. ",
                    format::number(friction[least], 3),
                    micron(depth[least])
                );
            }
            text += &match (first..=last).find(|i| film[*i] <= 0.0) {
                Some(touching) if touching > first => {
                    format!(
                        "The solids first touch between {} and {} um.",
                        micron(depth[touching - 1]),
                        micron(depth[touching])
                    )
                }
                Some(touching) => format!("The solids touch at {} um already.", micron(depth[touching])),
                None => "The solids do not touch.".into(),
            };
            first = last + 1;
        }
        text + "\n"
    }
}

fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// The rows of a file that are whole; a run may have been stopped while it wrote the last one.
fn read(path: &Path) -> Result<Vec<Vec<String>>, Error> {
    let unreadable = |error: csv::Error| Error::File {
        path: path.display().to_string(),
        message: format!("could not read the table: {error}; remove it, or use --fresh"),
    };
    let text = std::fs::read(path).map_err(|error| unreadable(error.into()))?;
    // The last number of a row that was cut off may still read as a number.
    let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(&text[..whole]);
    let found = reader.headers().map_err(unreadable)?.clone();
    if !found.is_empty() && !found.iter().eq(header()) {
        return Err(Error::File {
            path: path.display().to_string(),
            message: "is no table of this version's variables; choose another folder with --output, or use --fresh"
                .into(),
        });
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let row: Vec<String> = record.map_err(unreadable)?.iter().map(str::to_owned).collect();
        let whole = row.len() == found.len()
            && columns().zip(&row).all(|(variable, cell)| match variable.data_type() {
                Type::Enumeration(items) => items.iter().any(|(name, _)| name == cell),
                Type::Boolean => cell.parse::<bool>().is_ok(),
                _ => cell.parse::<f64>().is_ok(),
            });
        if whole {
            rows.push(row);
        }
    }
    Ok(rows)
}

/// A file with header and rows, put in place at once, and a writer at its end.
fn rewrite(path: &Path, rows: &[Vec<String>]) -> Result<csv::Writer<File>, Error> {
    let failed = |error: csv::Error| unwritten(path, error);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header()).map_err(failed)?;
    rows.iter().try_for_each(|row| writer.write_record(row)).map_err(failed)?;
    files::replace(path, &writer.into_inner().map_err(|error| unwritten(path, error))?)?;
    let file = OpenOptions::new().append(true).open(path).map_err(|error| unwritten(path, error))?;
    Ok(csv::Writer::from_writer(file))
}

/// Why a folder whose table has rows of another case is refused: what differs, as far as the case beside the table tells.
fn other_case(path: &Path, case: &Case) -> Error {
    let refuse = |why: &str| {
        Error::State(format!(
            "the table beside {} is of another case: {why}; choose another folder with --output, or solve anew with --fresh",
            path.display(),
        ))
    };
    let other = match Case::load(path) {
        Ok(other) => other,
        Err(error) => return refuse(&format!("which one is not known ({error})")),
    };
    let mut differing: Vec<String> = PARAMETERS
        .iter()
        .map(|row| (row.name, row.get(&other.parameters), row.get(&case.parameters)))
        .chain([(
            "slide_to_roll_ratio",
            Value::Real(other.inputs.slide_to_roll_ratio),
            Value::Real(case.inputs.slide_to_roll_ratio),
        )])
        .filter(|(_, there, here)| there != here)
        .map(|(name, there, here)| format!("{name} is {there} there and {here} here"))
        .collect();
    let by = std::fs::read_to_string(path).unwrap_or_default();
    if !by.contains(&format!("cartilage-contact {}\n", version())) {
        differing.push("another version of cartilage-contact solved it".into());
    }
    if differing.is_empty() {
        differing.push("its rows carry another hash than this case, which the file beside them names".into());
    }
    refuse(&differing.join("; "))
}
