//! Derivatives: of outputs with respect to inputs, and of both with respect to time.

use crate::fmi::instance::{Answer, Instance, refuse};
use crate::fmi::phase::Call;
use crate::simulation::Input;
use crate::variables::{Source, Variable};

/// The inputs, in the order of [`Instance`]'s rates.
const INPUTS: [Input; 3] = [Input::PenetrationDepth, Input::SlidingSpeed, Input::SlideToRollRatio];

impl Instance {
    /// fmi2SetRealInputDerivatives: rates of the inputs during the next step.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Answer<()> {
        self.check(Call::SetRealInputDerivatives)?;
        let mut rates = self.settings.input_rates;
        for ((element, order), value) in self.standard.elements(references)?.into_iter().zip(orders).zip(values) {
            let variable = element.row()?;
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

    /// fmi2GetRealOutputDerivatives and fmi3GetOutputDerivatives, with the rates of the inputs during the last step.
    /// Without fmi2SetRealInputDerivatives the inputs are constant, and so are the outputs of a quasi-steady model.
    pub fn output_derivatives(&mut self, references: &[u32], orders: &[i32], values: &mut [f64]) -> Answer<()> {
        self.check(Call::GetRealOutputDerivatives)?;
        let mut found = Vec::with_capacity(values.len());
        for (reference, order) in references.iter().zip(orders) {
            for element in self.standard.elements(&[*reference])? {
                if *order < 1 {
                    return refuse(format!("order {order} of {} is not allowed: 1 or more", element.name()));
                }
                let rate = self.rate(element.row()?, &self.settings.last_rates)?;
                // Above the highest order there is, the standard asks for 0.
                found.push(if *order == 1 { rate } else { 0.0 });
            }
        }
        fill(values, &found)
    }

    /// Derivatives of unknowns (outputs) with respect to knowns (inputs) at the last solution, times a seed of the knowns.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        values: &mut [f64],
    ) -> Answer<()> {
        self.check(Call::GetDirectionalDerivative)?;
        let mut rates = [0.0; 3];
        for (variable, seed) in self.seeded(knowns, seed)? {
            rates[as_input(variable)? as usize] += seed;
        }
        self.solve_if_needed()?;
        let unknowns = self.standard.elements(unknowns)?;
        let found: Vec<f64> =
            unknowns.into_iter().map(|element| self.rate(element.row()?, &rates)).collect::<Answer<_>>()?;
        fill(values, &found)
    }

    /// fmi3GetAdjointDerivative: a seed of the unknowns times the same derivatives.
    pub fn adjoint_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        values: &mut [f64],
    ) -> Answer<()> {
        self.check(Call::GetDirectionalDerivative)?;
        let unknowns = self.seeded(unknowns, seed)?;
        self.solve_if_needed()?;
        let mut found = Vec::with_capacity(values.len());
        for element in self.standard.elements(knowns)? {
            let mut rates = [0.0; 3];
            rates[as_input(element.row()?)? as usize] = 1.0;
            let slopes = unknowns.iter().map(|(variable, seed)| Ok(seed * self.rate(variable, &rates)?));
            found.push(slopes.sum::<Answer<f64>>()?);
        }
        fill(values, &found)
    }

    /// Variables with their seeds.
    fn seeded(&self, references: &[u32], seed: &[f64]) -> Answer<Vec<(&'static Variable, f64)>> {
        let elements = self.standard.elements(references)?;
        if elements.len() != seed.len() {
            let (given, needed) = (seed.len(), elements.len());
            return refuse(format!("nSeed = {given} is not allowed: these variables have {needed} values"));
        }
        if let Some((element, seed)) = elements.iter().zip(seed).find(|(_, seed)| !seed.is_finite()) {
            return refuse(format!("seed {seed} of {} is not allowed: a finite number", element.name()));
        }
        elements.into_iter().zip(seed).map(|(element, seed)| Ok((element.row()?, *seed))).collect()
    }

    /// Sum of dy/du * du/dt over the inputs.
    fn rate(&self, variable: &Variable, rates: &[f64; 3]) -> Answer<f64> {
        let Some(model) = &self.model else { return refuse("nothing has been solved yet") };
        let mut sum = 0.0;
        for input in INPUTS {
            match variable.derivative(model.derivatives(input)) {
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

fn fill(values: &mut [f64], found: &[f64]) -> Answer<()> {
    if values.len() != found.len() {
        let (room, needed) = (values.len(), found.len());
        return refuse(format!("an array of {room} values is not allowed: these variables have {needed}"));
    }
    values.copy_from_slice(found);
    Ok(())
}

fn as_input(variable: &Variable) -> Answer<Input> {
    match variable.source {
        Source::Input(row) => Ok(row.input),
        _ => refuse(format!("{} is not an input", variable.name)),
    }
}
