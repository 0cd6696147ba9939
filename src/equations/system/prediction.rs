//! Where a state is expected, by a tangent that was formed nearby.

use super::{State, System};
use crate::equations::load::LARGEST_APPROACH;
use crate::solver::linear::Singular;

impl System {
    /// What to subtract from the unknowns of a state for changes of depth, speed and slide-to-roll ratio, by the tangent at a
    /// linearization point nearby; and the change of the depth, which where a load is given \[N/m\] follows from that.
    ///
    /// # Errors
    /// [`Singular`] where the tangent is of other equations, or elimination breaks down.
    pub fn predict(
        &mut self,
        state: &State,
        linearization: &State,
        mut changes: [f64; 3],
        load: Option<f64>,
    ) -> Result<(Vec<f64>, f64), Singular> {
        if linearization.mirrored != state.mirrored {
            return Err(Singular);
        }
        self.form(linearization)?;
        if self.mirrored() {
            // A mirrored pair does not change with the slide-to-roll ratio.
            changes[2] = 0.0;
        }
        if let Some(load) = load {
            self.fit(state.contact_half_width, &state.shifts, state.thickening);
            let mut wanted = load - self.load(state);
            for input in (1..3).filter(|input| changes[*input] != 0.0) {
                wanted -= self.slope(input)?.load * changes[input];
            }
            let most = LARGEST_APPROACH * self.thickness;
            let stiffness = self.slope(0)?.load;
            changes[0] = if stiffness > 0.0 { (wanted / stiffness).clamp(-most, most) } else { 0.0 };
        }
        let mut update = vec![0.0; state.unknowns.len()];
        for (input, change) in changes.into_iter().enumerate().filter(|(_, change)| *change != 0.0) {
            update.iter_mut().zip(&self.slope(input)?.unknowns).for_each(|(u, s)| *u -= s * change);
        }
        Ok((update, changes[0]))
    }
}
