//! What a joint does in one cycle of walking: load and sliding speed at equal steps of time, published or from a file.

use std::path::Path;

use cartilage_contact::error::Error;

use super::history::{Row, Scales, parse};

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

/// A cycle that comes with the program, in the manner of a standard for the wear of prostheses; its file says what is from where.
pub struct Published {
    /// Name of the joint.
    pub joint: &'static str,
    /// Name and text of the file in `examples`.
    file: (&'static str, &'static str),
    /// What turns flexion into sliding \[m\].
    pub radius: f64,
    /// Largest force in walking, in body weights, over that of the contact that is modelled.
    pub peak: f64,
}

/// The first is walked where no joint is named.
pub const PUBLISHED: [Published; 2] = [
    Published {
        joint: "hip",
        file: ("gait_hip.csv", include_str!("../../../examples/gait_hip.csv")),
        // Head of the femur.
        radius: 0.024,
        // Walking at about 4 km/h: Bergmann et al., Journal of Biomechanics 34 (7), 859-871, 2001.
        peak: 2.38,
    },
    Published {
        joint: "knee",
        file: ("gait_knee.csv", include_str!("../../../examples/gait_knee.csv")),
        // Lateral condyle in extension: see examples/knee.toml.
        radius: 0.032,
        // The whole knee: Kutzner et al., Journal of Biomechanics 43 (11), 2164-2173, 2010, as quoted. The lateral side takes 20 to 40 %
        // of it (as quoted in PMC2965044).
        peak: 0.4 * 2.61,
    },
];

impl Cycle {
    /// A published cycle whose largest load is this \[N/m\].
    ///
    /// # Errors
    /// As of [`Cycle::read`]; a test reads every file.
    pub fn published(published: &Published, peak_load: f64, radius: f64, steps: usize) -> Result<Self, Error> {
        let (file, text) = published.file;
        // The width drops out.
        let mut table = parse(file, text, Scales { width: 1.0, radius })?;
        let largest = table.iter().map(|row| row.load).fold(f64::MIN_POSITIVE, f64::max);
        table.iter_mut().for_each(|row| row.load *= peak_load / largest);
        Ok(Self::through(&table, steps))
    }

    /// Reads a table of `time`, of `applied_load` or `force`, and of `sliding_speed`, or `flexion` with or without `translation`: CSV,
    /// or an OpenSim storage file (`.sto`, `.mot`). Linear between its rows.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read, [`Error::Case`] with line and column of the first mistake.
    pub fn read(path: &Path, scales: Scales, steps: usize) -> Result<Self, Error> {
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Ok(Self::through(&parse(&file, &text, scales)?, steps)),
            Err(error) => Err(Error::File { path: file, message: format!("could not read the history: {error}") }),
        }
    }

    /// At equal steps of time, linear between the rows of a table.
    fn through(table: &[Row], steps: usize) -> Self {
        let period = table[table.len() - 1].time;
        let time: Vec<f64> = (0..=steps).map(|step| period * step as f64 / steps as f64).collect();
        let at = |time: f64, get: fn(&Row) -> f64| {
            let end = table.partition_point(|row| row.time < time).clamp(1, table.len() - 1);
            let [a, b] = [&table[end - 1], &table[end]];
            let fraction = ((time - a.time) / (b.time - a.time)).clamp(0.0, 1.0);
            get(a) + fraction * (get(b) - get(a))
        };
        Self {
            load: time.iter().map(|time| at(*time, |row| row.load)).collect(),
            speed: time.iter().map(|time| at(*time, |row| row.speed)).collect(),
            time,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str, text: &str, width: f64, steps: usize) -> Result<Cycle, Error> {
        parse(file, text, Scales { width, radius: 0.03 }).map(|table| Cycle::through(&table, steps))
    }

    /// A periodic curve that goes from node to node in half cosine waves.
    fn half_cosines(nodes: &[(f64, f64)], fraction: f64) -> f64 {
        let end = nodes.iter().position(|node| node.0 > fraction).unwrap_or(0);
        let ((from, low), (to, high)) = (nodes[(end + nodes.len() - 1) % nodes.len()], nodes[end]);
        let angle = std::f64::consts::PI * (fraction - from).rem_euclid(1.0) / (to - from).rem_euclid(1.0);
        low + 0.5 * (high - low) * (1.0 - angle.cos())
    }

    #[test]
    fn published_cycles_go_through_the_nodes_that_their_files_name() {
        type Nodes<'a> = &'a [(f64, f64)];
        let hip: [Nodes; 2] = [
            &[(0.12, 3000.0), (0.32, 1500.0), (0.5, 3000.0), (0.62, 300.0), (1.0, 300.0)],
            &[(0.0, 25.0), (0.5, -18.0)],
        ];
        let knee: [Nodes; 2] = [
            &[(0.0, 168.0), (0.13, 2600.0), (0.28, 850.0), (0.45, 2433.0), (0.6, 168.0)],
            &[(0.0, 0.0), (0.15, 15.0), (0.4, 5.0), (0.72, 58.0)],
        ];
        for (published, [force, flexion], glide) in [(&PUBLISHED[0], hip, 0.0), (&PUBLISHED[1], knee, 5.2e-3 / 58.0)] {
            let peak = force.iter().map(|node| node.1).fold(0.0, f64::max);
            let cycle = Cycle::published(published, peak, published.radius, 100).unwrap();
            assert_eq!((cycle.time.len(), cycle.time[100]), (101, 1.0));
            for (step, fraction) in cycle.time.iter().enumerate() {
                let (load, expected) = (cycle.load[step], half_cosines(force, *fraction));
                assert!(
                    (load - expected).abs() < 0.06 * peak / 1000.0,
                    "{} {step}: {load} {expected}",
                    published.joint
                );
                let way = |fraction: f64| {
                    let degrees = half_cosines(flexion, fraction.rem_euclid(1.0));
                    published.radius * degrees.to_radians() + glide * degrees
                };
                // Over twice the interval: where two waves meet the rate is smooth, its own rate is not.
                let expected = (way(fraction + 0.01) - way(fraction - 0.01)) / 0.02;
                assert!((cycle.speed[step] - expected).abs() < 3e-4, "{step}: {} {expected}", cycle.speed[step]);
            }
            assert!(cycle.load[0] == cycle.load[100] && (cycle.speed[0] - cycle.speed[100]).abs() < 1e-15);
        }
    }

    #[test]
    fn flexion_and_translation_become_speed() {
        // Sines, whose rates are known, at uneven instants.
        let mut text = String::from("time [ms],force [kN],flexion [deg],translation [mm]\n");
        for row in 0..=200 {
            let fraction = f64::from(row) / 200.0 + if row % 2 == 1 { 0.001 } else { 0.0 };
            let angle = std::f64::consts::TAU * fraction;
            text += &format!(
                "{},{},{},{}\n",
                500.0 + 2000.0 * fraction,
                2.0 + fraction.min(0.0),
                20.0 * angle.sin(),
                3.0 * angle.cos()
            );
        }
        let cycle = read("own.csv", &text, 0.02, 50).unwrap();
        assert!((cycle.time[50] - 2.0).abs() < 1e-12 && cycle.load.iter().all(|load| (load - 1e5).abs() < 1e-6));
        let frequency = std::f64::consts::PI;
        for (time, speed) in cycle.time.iter().zip(&cycle.speed) {
            let angle = frequency * time;
            let expected = frequency * (0.03 * 20_f64.to_radians() * angle.cos() - 3e-3 * angle.sin());
            assert!((speed - expected).abs() < 3e-4 * 0.035, "{time}: {speed} {expected}");
        }
    }

    #[test]
    fn files_are_read_linearly_between_rows() {
        let csv = "# a comment\nsliding_speed, time, force\n0.1,2,10\n-0.1,2.5,30\n0.1,3,10\n";
        let cycle = read("own.csv", csv, 0.5, 4).unwrap();
        assert_eq!(cycle.time, [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(cycle.load, [20.0, 40.0, 60.0, 40.0, 20.0]);
        assert!(cycle.speed.iter().zip([0.1, 0.0, -0.1, 0.0, 0.1]).all(|(a, b): (&f64, _)| (a - b).abs() < 1e-15));
        let spreadsheet = "\u{feff}\"time\",\"sliding_speed\",\"force\",\"a \"\"note\"\", or two\"\r\n\
                           2,0.1,10,\"with, commas\r\nand lines\"\r\n\r\n2.5,\"-0.1\",30,\r\n3,0.1,10,\r\n";
        assert_eq!(read("own.csv", spreadsheet, 0.5, 4).unwrap(), cycle);
        let storage = "walk\nversion=1\nnRows=3\nnColumns=4\ninDegrees=no\nendheader\ntime\tother\tapplied_load\tsliding_speed\n\
                       2 7 20 0.1\n2.5 7 60 -0.1\n3 7 20 0.1\n";
        assert_eq!(read("own.sto", storage, 0.5, 4).unwrap(), cycle);
    }
}
