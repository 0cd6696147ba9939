//! Derivatives: of outputs with respect to inputs, and of both with respect to time.

use crate::fmi::instance::{Answer, Instance, lookup, refuse};
use crate::fmi::phase::Call;
use crate::simulation::Input;
use crate::variables::{Source, Variable};

impl Instance {
    /// fmi2SetRealInputDerivatives: rates of the inputs during the next step.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Answer<()> {
        self.check(Call::SetRealInputDerivatives)?;
        let mut rates = self.settings.input_rates;
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            let variable = lookup(*reference)?;
            let input = as_input(variable)?;
            if *order != 1 {
                return refuse(format!("order {order} of {} is not allowed: 1", variable.name));
            }
            if !value.is_finite() {
                return refuse(format!("derivative {value} of {} is not allowed: a finite number", variable.name));
            }
            rates[input as usize] = *value;
        }
        self.settings.input_rates = rates;
        Ok(())
    }

    /// fmi2GetRealOutputDerivatives, with the rates of the inputs during the last step. Without
    /// fmi2SetRealInputDerivatives the inputs are constant, and so are the outputs of a quasi-steady model.
    pub fn output_derivatives(&mut self, references: &[u32], orders: &[i32], values: &mut [f64]) -> Answer<()> {
        self.check(Call::GetRealOutputDerivatives)?;
        let mut found = Vec::with_capacity(values.len());
        for (reference, order) in references.iter().zip(orders) {
            let variable = lookup(*reference)?;
            if *order < 1 {
                return refuse(format!("order {order} of {} is not allowed: 1 or more", variable.name));
            }
            let rate = self.rate(variable, &self.settings.last_rates)?;
            // Above the highest order there is, the standard asks for 0.
            found.push(if *order == 1 { rate } else { 0.0 });
        }
        for (value, found) in values.iter_mut().zip(found) {
            *value = found;
        }
        Ok(())
    }

    /// fmi2GetDirectionalDerivative of outputs with respect to inputs, at the last solution.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        values: &mut [f64],
    ) -> Answer<()> {
        self.check(Call::GetDirectionalDerivative)?;
        let mut rates = [0.0; 3];
        for (reference, seed) in knowns.iter().zip(seed) {
            let variable = lookup(*reference)?;
            if !seed.is_finite() {
                return refuse(format!("seed {seed} of {} is not allowed: a finite number", variable.name));
            }
            rates[as_input(variable)? as usize] += seed;
        }
        self.solve_if_needed()?;
        let found: Vec<f64> =
            unknowns.iter().map(|reference| self.rate(lookup(*reference)?, &rates)).collect::<Answer<_>>()?;
        for (value, found) in values.iter_mut().zip(found) {
            *value = found;
        }
        Ok(())
    }

    /// Sum of dy/du * du/dt over the inputs.
    fn rate(&self, variable: &Variable, rates: &[f64; 3]) -> Answer<f64> {
        let Some(simulation) = &self.simulation else { return refuse("nothing has been solved yet") };
        let mut sum = 0.0;
        for input in [Input::PenetrationDepth, Input::SlidingSpeed, Input::SlideToRollRatio] {
            match variable.derivative(simulation.derivatives(input)) {
                Some(slope) => sum += slope * rates[input as usize],
                None => {
                    return refuse(format!(
                        "{} has no derivative: it is no smooth result of the inputs",
                        variable.name
                    ));
                }
            }
        }
        if !sum.is_finite() {
            return refuse(format!("the derivative of {} is too large for a number", variable.name));
        }
        Ok(sum)
    }
}

fn as_input(variable: &Variable) -> Answer<Input> {
    match variable.source {
        Source::Input(row) => Ok(row.input),
        _ => refuse(format!("{} is not an input", variable.name)),
    }
}
