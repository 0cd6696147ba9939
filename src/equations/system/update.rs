//! How the unknowns are changed, and how large a change is.

use super::System;
use crate::equations::grid::Grid;
use crate::equations::layout::Quantity;
use crate::solver::linear::FIXED;

/// A film thinner than this fraction of the layers' thickness (0.1 micron for 1 mm) may close within one update.
const THIN_FILM: f64 = 1e-4;

/// Ratio to the largest fluid pressure up to which rough surfaces may come to press within one update.
const NEW_CONTACT: f64 = 0.02;

impl System {
    /// Compresses the tissue evenly through its thickness by an approach of the bones \[m\], with the gap as it is.
    pub fn compress(&self, unknowns: &mut [f64], approach: f64) {
        for ((layer, vertical), heights) in self.layers.iter().zip(&self.layout.vertical).zip(&self.height) {
            for numbers in vertical.chunks_exact(heights.len()) {
                for (number, height) in numbers.iter().zip(heights).filter(|(n, _)| **n != FIXED) {
                    unknowns[*number as usize] -= self.part(layer) * approach * (1.0 - height);
                }
            }
        }
    }

    /// A guess on the mesh of another contact or with other shifts, from unknowns on the present one: each node keeps what it has, scaled
    /// as the indentation goes with the square of the half-width. Inside, the film stays about as thick as it was.
    /// Returns by how much indentations grow.
    pub fn carry(&self, unknowns: &mut [f64], contact_half_width: f64, shifts: &[f64]) -> f64 {
        /// Distances above this are gaps of bodies apart, below it films \[m\].
        const FILM: f64 = 1e-5;
        let after = Grid::new(&self.parameters, contact_half_width, shifts).touching_gap;
        let ratio = match self.contact_half_width == contact_half_width {
            true => 1.0,
            false => (contact_half_width / self.contact_half_width).powi(2),
        };
        for (number, quantity) in self.layout.quantities.iter().enumerate() {
            if *quantity == Quantity::Displacement {
                unknowns[number] *= ratio;
            }
        }
        for (station, number) in self.layout.gap.iter().enumerate() {
            let gap = &mut unknowns[*number as usize];
            // What deformed stays in proportion, and the rest follows the undeformed surfaces.
            let proportional = after[station] + ratio * (*gap - self.touching_gap[station]);
            *gap = if *gap > FILM { proportional.max(FILM) } else { *gap };
            let correction = *gap - proportional;
            self.follow(station, correction, unknowns);
        }
        ratio
    }

    /// Subtracts an update from the unknowns. Where the film is thicker than `THIN_FILM` the gap closes and opens within the limits of
    /// [`crate::equations::contact::ContactLaw`]. The tissue below follows, less and less towards the bone, so that no element is
    /// turned inside out.
    pub fn apply(&self, unknowns: &mut [f64], update: &[f64], active: &[bool]) {
        let thin = THIN_FILM * self.thickness;
        let contact = self.contact_law();
        let [closing, opening] = contact.film_limits();
        let levels = self.layers[0].mesh.levels();
        let film = self.layout.pressure[0].iter().step_by(levels).filter(|number| **number != FIXED);
        let largest = film.map(|number| unknowns[*number as usize].abs()).fold(1e-3 * self.stress_scale, f64::max);
        let free = contact.gap_at(NEW_CONTACT * largest);
        let gaps: Vec<f64> = self.layout.gap.iter().map(|number| unknowns[*number as usize]).collect();
        unknowns.iter_mut().zip(update).for_each(|(z, d)| *z -= d);
        for (station, before) in gaps.into_iter().enumerate() {
            let gap = &mut unknowns[self.layout.gap[station] as usize];
            let smallest = if active[station] || before <= thin { f64::NEG_INFINITY } else { closing * before };
            let smallest = smallest.max(contact.least_gap(before, *gap, free));
            let limited = gap.min((opening * before).max(5.0 * thin)).max(smallest);
            let correction = limited - *gap;
            *gap = limited;
            self.follow(station, correction, unknowns);
        }
    }

    /// Moves the surfaces apart, so that there is a film of this thickness \[m\] where they would overlap.
    pub fn lift(&self, unknowns: &mut [f64], film: f64) {
        for (station, number) in self.layout.gap.iter().enumerate() {
            let gap = &mut unknowns[*number as usize];
            let parted = 0.5 * (*gap + gap.hypot(2.0 * film));
            let correction = parted - *gap;
            *gap = parted;
            self.follow(station, correction, unknowns);
        }
    }

    /// Moves the tissue below a station by what its gap was changed, less and less towards the bone.
    pub(super) fn follow(&self, station: usize, opening: f64, unknowns: &mut [f64]) {
        for (body, (vertical, heights)) in self.layout.vertical.iter().zip(&self.height).enumerate() {
            let column = &vertical[station * heights.len()..(station + 1) * heights.len()];
            for (number, height) in column.iter().zip(heights).filter(|(n, _)| **n != FIXED) {
                unknowns[*number as usize] += self.surface_part(body, station) * opening * height;
            }
        }
    }

    /// One over what a change of each unknown is measured against: displacements and pressures against their largest values, gaps
    /// each against itself (and `THIN_FILM` where the surfaces all but touch).
    pub fn weights_of(&self, unknowns: &[f64]) -> Vec<f64> {
        // What is below a millionth of the layer's thickness or modulus is no displacement or pressure to speak of.
        let (mut displacement, mut pressure) = (1e-6 * self.thickness, 1e-6 * self.stress_scale);
        for (value, quantity) in unknowns.iter().zip(&self.layout.quantities) {
            match quantity {
                Quantity::Displacement => displacement = displacement.max(value.abs()),
                Quantity::Pressure => pressure = pressure.max(value.abs()),
                Quantity::Gap | Quantity::Void => {}
            }
        }
        let weight = |(value, quantity): (&f64, &Quantity)| match quantity {
            Quantity::Displacement => 1.0 / displacement,
            Quantity::Pressure => 1.0 / pressure,
            Quantity::Gap | Quantity::Void => 1.0 / (value.abs() + THIN_FILM * self.thickness),
        };
        unknowns.iter().zip(&self.layout.quantities).map(weight).collect()
    }

    /// Size of an update relative to the fields: displacements and pressures to their largest values, gaps each to itself (and to
    /// `THIN_FILM` where the surfaces all but touch).
    pub fn relative_size(&self, unknowns: &[f64], update: &[f64]) -> f64 {
        // What is below a millionth of the layer's thickness or modulus is no displacement or pressure to speak of.
        let mut displacement = (1e-6 * self.thickness, 0.0_f64);
        let mut pressure = (1e-6 * self.stress_scale, 0.0_f64);
        let mut gap = 0.0_f64;
        for ((value, change), quantity) in unknowns.iter().zip(update).zip(&self.layout.quantities) {
            let (value, change) = (value.abs(), change.abs());
            // `max` would pass over a NaN.
            if !change.is_finite() {
                return f64::INFINITY;
            }
            match quantity {
                Quantity::Displacement => displacement = (displacement.0.max(value), displacement.1.max(change)),
                Quantity::Pressure => pressure = (pressure.0.max(value), pressure.1.max(change)),
                Quantity::Gap | Quantity::Void => gap = gap.max(change / (value + THIN_FILM * self.thickness)),
            }
        }
        (displacement.1 / displacement.0).max(pressure.1 / pressure.0).max(gap)
    }

    /// Root mean square of a small change relative to the fields, the largest of displacements, pressures and gaps: displacements
    /// and pressures to their largest values, gaps each to itself. One station that enters or leaves the contact counts as one.
    pub fn mean_relative_size(&self, unknowns: &[f64], change: &[f64]) -> f64 {
        // What is below a millionth of the layer's thickness or modulus is no displacement or pressure to speak of.
        let mut fields = [(1e-6 * self.thickness, 0.0, 0.0), (1e-6 * self.stress_scale, 0.0, 0.0), (1.0, 0.0, 0.0)];
        for ((value, change), quantity) in unknowns.iter().zip(change).zip(&self.layout.quantities) {
            let (field, largest, change) = match quantity {
                Quantity::Displacement => (0, value.abs(), *change),
                Quantity::Pressure => (1, value.abs(), *change),
                Quantity::Gap | Quantity::Void => (2, 1.0, change / (value.abs() + THIN_FILM * self.thickness)),
            };
            let (scale, sum, count) = &mut fields[field];
            *scale = largest.max(*scale);
            *sum += change * change;
            *count += 1.0;
        }
        let means = fields.map(|(scale, sum, count): (f64, f64, f64)| (sum / count.max(1.0)).sqrt() / scale);
        // `max` would pass over a NaN.
        if means.iter().all(|mean| mean.is_finite()) { means.into_iter().fold(0.0, f64::max) } else { f64::INFINITY }
    }
}
