//! `cartilage-contact gait`: cycles of walking under load control, in time until they repeat, and quasi-steady beside that.

mod cycle;
mod history;

use std::path::PathBuf;

use cartilage_contact::error::Error;
use cartilage_contact::files::{self, OutputFolder, unwritten};
use cartilage_contact::outputs::Outputs;
use cartilage_contact::parameters::{Control, Inputs, Parameters, TimeIntegration};
use cartilage_contact::simulation::{Drive, Simulation};
use cartilage_contact::sweep;
use cartilage_contact::variables::{self, Source};
use indicatif::ProgressBar;

use self::cycle::{Cycle, PUBLISHED};
use self::history::Scales;
use super::case::CaseArguments;
use super::figures::gait::{RESOLVED, State, resolved_film};
use super::stribeck::progress;
use super::{Failure, figures, format, print};

const EXAMPLES: &str = "\
Without --history the cycle is that of a hip in the manner of ISO 14242-1, or with --joint knee of ISO 14243-3 \
(examples/gait_hip.csv, gait_knee.csv): 1 s, scaled to the largest force that was measured in walking, 2.38 body weights, or 0.4 of 2.61 on the \
lateral side of a knee. Its load is that over the width of the case, and the case is --joint hip unless one is named; or it is scaled to \
--peak-load, for tissue as soft as the paper's. A history is a CSV or an OpenSim .sto file of one cycle with columns time, \
applied_load or force, and sliding_speed, or flexion with or without translation, which --joint-radius turns into speed. They are in SI \
units, or as their heads say: force [kN], flexion [deg]. The case's own time_integration, control and inputs of load, depth and speed \
are not used. The folder gets gait.csv (one row a communication point) and a picture.

Examples:
  cartilage-contact gait
  cartilage-contact gait --body-weight 900 --set slide_to_roll_ratio=1
  cartilage-contact gait --joint knee --body-weight 600
  cartilage-contact gait --peak-load 25 --steps 200
  cartilage-contact gait --joint hip --history examples/gait_hip.csv --transient-only
  cartilage-contact gait --history walk.sto --set width=0.02 --cycles 5";

/// A walking cycle under load control: in time until it repeats, beside quasi-steady.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    case: CaseArguments,

    /// Largest load per unit depth of the published cycle \[N/m\], in place of a body weight
    #[arg(long, value_name = "LOAD", conflicts_with_all = ["body_weight", "history"])]
    peak_load: Option<f64>,

    /// Body weight \[N\]: the load is the joint's over the width of the case; 750 by default
    #[arg(long, value_name = "FORCE", conflicts_with = "history")]
    body_weight: Option<f64>,

    /// Radius that turns flexion into sliding speed \[m\]; 0.032 for a knee, 0.024 otherwise
    #[arg(long, value_name = "LENGTH")]
    joint_radius: Option<f64>,

    /// Load and speed of one cycle of your own (CSV, OpenSim .sto)
    #[arg(long, value_name = "FILE")]
    history: Option<PathBuf>,

    /// Communication steps a cycle; load and speed are linear within them
    #[arg(long, value_name = "COUNT", default_value_t = 100, value_parser = clap::value_parser!(u32).range(4..=100_000))]
    steps: u32,

    /// Most cycles in time
    #[arg(long, value_name = "COUNT", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    cycles: u32,

    /// Only in time: leave out the steady state of every instant, which a surface at rest does not have before its tissue is drained
    #[arg(long)]
    transient_only: bool,

    /// A cycle repeats where depth, fluid load and solid load have less than this fraction of their largest values still to change, as the changes
    /// from cycle to cycle shrink
    #[arg(long, value_name = "FRACTION", default_value_t = 0.01)]
    periodicity: f64,

    /// Folder for everything that is written
    #[arg(long, value_name = "FOLDER", default_value = "target/gait")]
    output: PathBuf,
}

/// Cycles in time.
struct Transient {
    cycles: Vec<Vec<State>>,
    /// From each cycle to the next: the largest change of depth, fluid load and solid load, and those of their means, relative to the largest
    /// depth and load.
    changes: Vec<(f64, [f64; 3])>,
}

impl Transient {
    /// How much the means still have to change, if their changes go on to shrink from cycle to cycle as the last two did.
    fn remaining(&self, tolerance: f64) -> Option<f64> {
        let [.., (_, before), (_, last)] = self.changes[..] else { return None };
        let each = before.into_iter().zip(last).map(|(before, last)| match (before.abs(), last.abs()) {
            (_, last) if last < SLIGHT * tolerance => last,
            (before, last) if last < before => last * last / (before - last),
            _ => f64::INFINITY,
        });
        Some(each.fold(0.0, f64::max))
    }

    fn repeats(&self, tolerance: f64) -> bool {
        let (change, remaining) = (self.changes.last(), self.remaining(tolerance));
        change.is_some_and(|(change, _)| *change < tolerance)
            && remaining.is_some_and(|remaining| remaining < tolerance)
    }
}

/// Changes from cycle to cycle below this part of the tolerance need not shrink.
const SLIGHT: f64 = 0.05;

/// Solves, writes table and picture, prints what came out.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let case = match arguments.peak_load.is_none() && arguments.history.is_none() {
        true => arguments.case.or_joint("hip").load()?,
        false => arguments.case.load()?,
    };
    let parameters = Parameters { control: Control::Load, ..case.parameters };
    let positive = |flag: &str, value: f64, unit: &str| match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err(Error::value(flag, value, format!("a number above 0 {unit}"))),
    };
    positive("--periodicity", arguments.periodicity, "(a fraction, such as 0.01)")?;
    let steps = arguments.steps as usize;
    let joint = arguments.case.joint().unwrap_or(PUBLISHED[0].joint);
    let published = PUBLISHED.iter().find(|published| published.joint == joint);
    let radius = arguments.joint_radius.or(published.map(|published| published.radius));
    let radius = positive("--joint-radius", radius.unwrap_or(PUBLISHED[0].radius), "m")?;
    let cycle = match (&arguments.history, published) {
        (Some(path), _) => Cycle::read(path, Scales { width: parameters.width, radius }, steps),
        (None, Some(published)) => {
            let load = match arguments.peak_load {
                Some(load) => positive("--peak-load", load, "N/m")?,
                None => {
                    let weight = positive("--body-weight", arguments.body_weight.unwrap_or(750.0), "N")?;
                    published.peak * weight / parameters.width
                }
            };
            Cycle::published(published, load, radius, steps)
        }
        (None, None) => {
            return Err(Failure::Usage(format!(
                "--joint {joint}: no cycle of this joint comes with the program; give one with --history"
            )));
        }
    };
    let cycle = cycle.map_err(|error| Failure::Usage(error.to_string()))?;

    let folder = OutputFolder::open(&arguments.output)?;
    let bar = progress(steps * (1 + arguments.cycles as usize));
    let (transient, steady) = std::thread::scope(|scope| {
        let steady = match arguments.transient_only {
            true => None,
            false => Some(sweep::spawn(scope, || quasi_steady(&parameters, &case.inputs, &cycle, &bar))?),
        };
        let transient = transient(&parameters, &case.inputs, &cycle, arguments, &bar);
        let steady = steady.map_or(Ok(Ok(Steady::default())), |steady| steady.join());
        let steady = steady.map_err(|_| Failure::Failed("the quasi-steady cycle stopped".into()))?;
        Ok::<_, Failure>((transient?, steady?))
    })?;
    bar.finish_and_clear();

    let csv = folder.path().join("gait.csv");
    let text = to_csv(&transient.cycles, &steady.states).map_err(|error| unwritten(&csv, error))?;
    files::replace(&csv, &text)?;
    let header = String::from_utf8_lossy(&text).lines().next().unwrap_or_default().to_owned();
    format::write_units(&csv, header.split(','))?;
    let last = transient.cycles.last().map_or(&[][..], Vec::as_slice);
    let [svg, png, pdf] = figures::gait::save(&folder.path().join("gait"), last, &steady.states)?;
    let mut text = table(last, &steady.states) + "\n" + &verdict(&transient, arguments.periodicity) + &resolution(last);
    if steady.drained > 0 {
        text += &format!(
            "At {} of {} instants a surface hardly moves: there is no quasi-steady state, since tissue would drain for many cycles.\n",
            steady.drained,
            cycle.time.len()
        );
    }
    if let Some(first) = steady.failures.first() {
        text += &format!("{} quasi-steady states were not found; the first: {first}\n", steady.failures.len());
    }
    print(&format!("{text}\nWrote {}, {}, {} and {}\n", csv.display(), svg.display(), png.display(), pdf.display()))
}

/// Speed of a surface over the largest of the cycle, below which its tissue drains instead of being renewed by motion.
const HARDLY_MOVING: f64 = 0.05;
/// Cycles, as a time in which nothing of a cycle becomes steady.
const MANY_CYCLES: f64 = 100.0;

/// The inputs at a communication point.
fn inputs(given: &Inputs, cycle: &Cycle, step: usize) -> Inputs {
    Inputs { applied_load: cycle.load[step], sliding_speed: cycle.speed[step], approach_speed: 0.0, ..*given }
}

/// The state of a communication point, after the one before it in its cycle.
fn state(simulation: &Simulation, cycle: &Cycle, step: usize, cycles_before: usize, before: Option<&State>) -> State {
    let phase = cycle.time[step];
    let period = cycle.time.last().copied().unwrap_or_default();
    let outputs = simulation.outputs().clone();
    let exchange = before.map_or(0.0, |before| {
        let mean = 0.5 * (before.outputs.net_fluid_exudation + outputs.net_fluid_exudation);
        before.exchange + mean * (phase - before.phase)
    });
    State { time: cycles_before as f64 * period + phase, phase, inputs: *simulation.inputs(), outputs, exchange }
}

fn transient(
    parameters: &Parameters,
    given: &Inputs,
    cycle: &Cycle,
    arguments: &Arguments,
    bar: &ProgressBar,
) -> Result<Transient, Error> {
    let parameters = Parameters { time_integration: TimeIntegration::Transient, ..*parameters };
    let mut simulation = Simulation::new(&parameters)?;
    // Not at the speed of the first instant: where that is none, the steady state is one of hours, drained.
    let mean = (cycle.speed.iter().map(|speed| speed * speed).sum::<f64>() / cycle.speed.len() as f64).sqrt();
    simulation.solve_steady(Inputs { sliding_speed: mean, ..inputs(given, cycle, 0) })?;
    let mut found = Transient { cycles: Vec::new(), changes: Vec::new() };
    for count in 0..arguments.cycles as usize {
        bar.set_message(format!("cycle {}", count + 1));
        let start = state(&simulation, cycle, 0, count, None);
        // The first start is at another speed: not of the cycle.
        let mut states = if count == 0 { Vec::new() } else { vec![start.clone()] };
        for step in 1..cycle.time.len() {
            let [from, to] = [step - 1, step].map(|step| inputs(given, cycle, step));
            let duration = cycle.time[step] - cycle.time[step - 1];
            let rates = Inputs { penetration_depth: 0.0, ..to.combined(&from, |to, from| (to - from) / duration) };
            simulation.advance(Drive { inputs: from, rates }, duration)?;
            states.push(state(&simulation, cycle, step, count, states.last().or(Some(&start))));
            bar.inc(1);
        }
        found.changes.extend(found.cycles.last().map(|before| change(before, &states)));
        found.cycles.push(states);
        if found.repeats(arguments.periodicity) {
            break;
        }
    }
    Ok(found)
}

/// The largest change of depth, fluid load and solid load from one cycle to the next, and those of their means, relative to the largest depth
/// and load.
fn change(before: &[State], after: &[State]) -> (f64, [f64; 3]) {
    type Get = fn(&Outputs) -> f64;
    let judged: [(Get, Get); 3] = [
        (|o| o.penetration_depth, |o| o.penetration_depth),
        (|o| o.fluid_load, |o| o.load),
        (|o| o.solid_load, |o| o.load),
    ];
    let relative = judged.map(|(get, size)| {
        let size = after.iter().map(|state| size(&state.outputs).abs()).fold(f64::MIN_POSITIVE, f64::max);
        // From the ends, since the first cycle has no start.
        let pairs = before.iter().rev().zip(after.iter().rev());
        let changes: Vec<f64> = pairs.map(|(a, b)| (get(&b.outputs) - get(&a.outputs)) / size).collect();
        let largest = changes.iter().fold(0.0, |largest: f64, change| largest.max(change.abs()));
        (largest, changes.iter().sum::<f64>() / changes.len() as f64)
    });
    (relative.iter().fold(0.0, |largest: f64, (change, _)| largest.max(*change)), relative.map(|(_, mean)| mean))
}

/// A steady cycle.
#[derive(Default)]
struct Steady {
    states: Vec<State>,
    /// Instants at which a steady state would take the tissue many cycles.
    drained: usize,
    /// Why others were not found.
    failures: Vec<String>,
}

/// The steady states of one cycle.
fn quasi_steady(parameters: &Parameters, given: &Inputs, cycle: &Cycle, bar: &ProgressBar) -> Result<Steady, Error> {
    let parameters = Parameters { time_integration: TimeIntegration::QuasiSteady, ..*parameters };
    let mut simulation = Simulation::new(&parameters)?;
    let mut found = Steady::default();
    for step in 0..cycle.time.len() {
        let inputs = inputs(given, cycle, step);
        if drains_for_long(&parameters, &inputs, cycle) {
            found.drained += 1;
        } else {
            match simulation.solve_steady(inputs) {
                Ok(()) => found.states.push(state(&simulation, cycle, step, 0, found.states.last())),
                Err(error) => found.failures.push(error.to_string()),
            }
        }
        bar.inc(1);
    }
    Ok(found)
}

/// Whether tissue that hardly moves would drain for many cycles until it is steady.
fn drains_for_long(parameters: &Parameters, inputs: &Inputs, cycle: &Cycle) -> bool {
    let largest = cycle.speed.iter().fold(0.0, |largest: f64, speed| largest.max(speed.abs()));
    let period = cycle.time.last().copied().unwrap_or_default();
    [&parameters.upper, &parameters.lower].into_iter().zip(inputs.surface_speeds()).any(|(body, speed)| {
        let consolidation = parameters.hydraulic_permeability(body) * body.surface_aggregate_modulus();
        let drains_in = body.thickness.powi(2) / consolidation;
        speed.abs() < HARDLY_MOVING * largest && drains_in > MANY_CYCLES * period
    })
}

fn to_csv(cycles: &[Vec<State>], steady: &[State]) -> Result<Vec<u8>, csv::Error> {
    // Contact stiffness would cost as much as the step.
    let results = || {
        variables::scalar_outputs().filter_map(|row| match row.source {
            Source::Result(get) => Some((row.name, get)),
            _ => None,
        })
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    let head = ["time_integration", "cycle", "time", "applied_load", "sliding_speed"];
    let tail = ["cumulative_net_fluid_exudation", "lubrication_regime", "newton_iterations"];
    writer.write_record(head.into_iter().chain(results().map(|(name, _)| name)).chain(tail))?;
    let transient = cycles.iter().enumerate().map(|(index, states)| ("transient", index + 1, states.as_slice()));
    for (integration, cycle, states) in transient.chain([("quasi_steady", 1, steady)]) {
        for State { time, inputs, outputs, exchange, .. } in states {
            let given = [*time, inputs.applied_load, inputs.sliding_speed];
            let numbers = given.into_iter().chain(results().map(|(_, get)| get(outputs))).chain([*exchange]);
            let words = [outputs.lubrication_regime.name().into(), outputs.newton_iterations.to_string()];
            let cells = [integration.to_owned(), cycle.to_string()].into_iter();
            writer.write_record(cells.chain(numbers.map(|value| format!("{value:e}"))).chain(words))?;
        }
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}

/// Extremes of the cycle, in time and quasi-steady.
fn table(transient: &[State], steady: &[State]) -> String {
    let most = |states: &[State], get: fn(&Outputs) -> f64| {
        states.iter().map(|state| get(&state.outputs)).fold(f64::NEG_INFINITY, f64::max)
    };
    let least = |states: &[State], get: fn(&Outputs) -> f64| {
        states.iter().map(|state| get(&state.outputs)).fold(f64::INFINITY, f64::min)
    };
    let mean = |states: &[State], get: fn(&Outputs) -> f64| {
        states.iter().map(|state| get(&state.outputs)).sum::<f64>() / states.len() as f64
    };
    // In millijoule.
    let work = |states: &[State], get: fn(&Outputs) -> f64| {
        states
            .windows(2)
            .map(|s| 500.0 * (get(&s[0].outputs) + get(&s[1].outputs)) * (s[1].phase - s[0].phase))
            .sum::<f64>()
    };
    let load_work = |s: &[State]| {
        let [a, b] = [&s[0].outputs, &s[1].outputs];
        500.0 * (a.normal_force + b.normal_force) * (b.penetration_depth - a.penetration_depth)
    };
    type Row<'a> = (&'a str, &'a dyn Fn(&[State]) -> f64);
    let rows: [Row; 13] = [
        ("largest load [N/m]", &|s| most(s, |o| o.load)),
        ("deepest penetration [um]", &|s| 1e6 * most(s, |o| o.penetration_depth)),
        ("thinnest film, where resolved [um]", &|s| 1e6 * least(s, |o| resolved_film(o).unwrap_or(f64::INFINITY))),
        ("longest contact [mm]", &|s| 1e3 * most(s, |o| o.contact_length)),
        ("least fluid load support", &|s| least(s, |o| o.fluid_load_support)),
        ("largest friction coefficient", &|s| most(s, |o| o.friction_coefficient)),
        ("mean friction coefficient", &|s| mean(s, |o| o.friction_coefficient)),
        ("fluid given off in the cycle [mm^2]", &|s| 1e6 * s.last().map_or(0.0, |state| state.exchange)),
        ("work of the turning bones [mJ]", &|s| work(s, |o| o.rotation_power)),
        ("work of the load [mJ]", &|s| s.windows(2).map(load_work).sum()),
        ("lost in the film [mJ]", &|s| work(s, |o| o.film_dissipation)),
        ("lost in the pores [mJ]", &|s| work(s, |o| o.pore_flow_dissipation)),
        ("lost by friction of solid on solid [mJ]", &|s| work(s, |o| o.boundary_friction_dissipation)),
    ];
    let mut text = String::from("| over the cycle | in time | quasi-steady |\n|---|---|---|\n");
    for (name, value) in rows {
        let cells = [transient, steady].map(|states| match states {
            [] => "-".into(),
            states => format::number(value(states), 4),
        });
        text += &format!("| {name} | {} | {} |\n", cells[0], cells[1]);
    }
    text
}

fn verdict(transient: &Transient, tolerance: f64) -> String {
    let count = transient.cycles.len();
    let percent = |fraction: f64| format!("{} %", format::number(100.0 * fraction, 3));
    let Some((last, _)) = transient.changes.last() else {
        return "One cycle: whether it repeats is not known.\n".into();
    };
    let differs = format!("cycle {count} differs from the one before by {} at most", percent(*last));
    let remaining = transient.remaining(tolerance);
    let coming = match remaining {
        Some(remaining) if remaining.is_finite() => {
            format!("; as changes of its means shrink, some {} are still to come", percent(remaining))
        }
        Some(_) => "; changes of its means do not shrink".into(),
        None => String::new(),
    };
    match transient.repeats(tolerance) {
        true => format!("Periodic: {differs}{coming}.\n"),
        false => format!(
            "Not periodic: {differs}{coming}. Less than {} was asked for: take more with --cycles; tissue that stays under load drains for \
             many.\n",
            percent(tolerance)
        ),
    }
}

/// What mesh and sector leave open in the cycle in time.
fn resolution(states: &[State]) -> String {
    let sorted = |get: fn(&Outputs) -> f64| {
        let mut values: Vec<f64> = states.iter().map(|state| get(&state.outputs)).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let load = sorted(|o| o.estimated_load_error);
    let [film, friction] = [sorted(|o| o.estimated_film_error), sorted(|o| o.estimated_friction_error)];
    let percent = |value: Option<&f64>| format!("{} %", format::number(100.0 * value.copied().unwrap_or_default(), 2));
    let unresolved = states.iter().filter(|state| resolved_film(&state.outputs).is_none()).count();
    let warned = states.iter().filter(|state| !state.outputs.well_resolved).count();
    format!(
        "Errors by the mesh, estimated: load {} at most, thinnest film {} in the median and {} at most (instants above {}, left out of \
         table and picture: {unresolved}), friction {} in the median and {} at most. {warned} of {} instants carry a warning; \
         estimated_load_error, estimated_film_error and estimated_friction_error in gait.csv say where.\n",
        percent(load.last()),
        percent(film.get(film.len() / 2)),
        percent(film.last()),
        percent(Some(&RESOLVED)),
        percent(friction.get(friction.len() / 2)),
        percent(friction.last()),
        states.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn states(depths: [f64; 2], solid_load: f64) -> Vec<State> {
        let of = |penetration_depth| Outputs { penetration_depth, load: 20.0, solid_load, ..Outputs::default() };
        let state = |depth| State { time: 0.0, phase: 0.0, inputs: Inputs::NONE, outputs: of(depth), exchange: 0.0 };
        depths.map(state).into()
    }

    #[test]
    fn cycles_are_compared_by_depth_and_by_who_carries_the_load() {
        let before = states([4e-6, -10e-6], 2.0);
        assert_eq!(change(&before, &before), (0.0, [0.0; 3]));
        let (largest, means) = change(&before, &states([5e-6, -10e-6], 2.0));
        assert!((largest - 0.1).abs() < 1e-12 && (means[0] - 0.05).abs() < 1e-12, "{largest} {means:?}");
        assert!((change(&before, &states([4e-6, -10e-6], 7.0)).0 - 0.25).abs() < 1e-12);
    }

    #[test]
    fn what_is_still_to_come_follows_from_the_last_two_changes() {
        let transient = |means: &[f64]| Transient {
            cycles: Vec::new(),
            changes: means.iter().map(|mean| (mean.abs(), [*mean, 0.0, -0.5 * mean])).collect(),
        };
        let remaining = |means: &[f64]| transient(means).remaining(0.01);
        assert_eq!(remaining(&[0.01]), None);
        // 0.01 (1/2 + 1/4 + ...)
        assert!((remaining(&[1.0, 0.02, 0.01]).unwrap() - 0.01).abs() < 1e-12);
        assert!((remaining(&[0.01, -0.009]).unwrap() - 0.081).abs() < 1e-12);
        assert_eq!(remaining(&[0.01, 0.02]), Some(f64::INFINITY));
        assert_eq!(remaining(&[1e-4, 2e-4]), Some(2e-4));
        assert!(transient(&[0.02, 0.005]).repeats(0.01) && !transient(&[0.006, 0.005]).repeats(0.01));
        assert!(!transient(&[0.005]).repeats(0.01));
    }
}
