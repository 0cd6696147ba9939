//! Derivatives: of outputs with respect to inputs, and of both with respect to time.

use crate::fmi::answer::{Answer, refuse};
use crate::fmi::instance::Instance;
use crate::fmi::model::Model;
use crate::fmi::phase::Call;
use crate::simulation::Input;
use crate::variables::{Source, Variable};

impl Instance {
    /// fmi2SetRealInputDerivatives: rates of the inputs during the next step.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Answer<()> {
        self.check(Call::SetRealInputDerivatives)?;
        let mut rates = self.settings.input_rates;
        for ((element, order), value) in self.standard.elements(references)?.into_iter().zip(orders).zip(values) {
            let variable = element.row()?;
            let Source::Input(row) = variable.source else { return refuse(no_input(variable)) };
            if *order != 1 {
                return refuse(format!("order {order} of {} is not allowed: 1", variable.name));
            }
            if !value.is_finite() {
                return refuse(format!("derivative {value} of {} is not allowed: a finite number", variable.name));
            }
            row.put(&mut rates, *value);
        }
        self.settings.input_rates = rates;
        Ok(())
    }

    /// fmi2GetRealOutputDerivatives and fmi3GetOutputDerivatives, at the end of the last step, with the inputs going on at their
    /// rates. Without fmi2SetRealInputDerivatives and approach speed the inputs are constant, and so are the outputs of a
    /// quasi-steady model.
    pub fn output_derivatives(&mut self, references: &[u32], orders: &[i32], values: &mut [f64]) -> Answer<()> {
        self.check(Call::GetRealOutputDerivatives)?;
        let mut found = Vec::with_capacity(values.len());
        for (reference, order) in references.iter().zip(orders) {
            for element in self.standard.elements(&[*reference])? {
                if *order < 1 {
                    return refuse(format!("order {order} of {} is not allowed: 1 or more", element.name()));
                }
                let variable = element.row()?;
                let rate = finite(variable, self.solved()?.rate(variable)?)?;
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
        let mut rates = [0.0; Input::ALL.len()];
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
            let mut rates = [0.0; Input::ALL.len()];
            rates[as_input(element.row()?)? as usize] = 1.0;
            let mut sum = 0.0;
            for (variable, seed) in &unknowns {
                // A seed may be so large that the sum is no number, where every derivative is one.
                sum = finite(variable, Some(sum + seed * self.rate(variable, &rates)?))?;
            }
            found.push(sum);
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

    fn solved(&mut self) -> Answer<&mut Model> {
        match &mut self.model {
            Some(model) => Ok(model),
            None => refuse("nothing has been solved yet"),
        }
    }

    /// Sum of dy/du * change of u over the inputs.
    fn rate(&mut self, variable: &Variable, changes: &[f64; Input::ALL.len()]) -> Answer<f64> {
        let model = self.solved()?;
        let mut sum = 0.0;
        for (input, change) in Input::ALL.into_iter().zip(changes) {
            sum += change * finite(variable, model.derivative(variable, input)?)?;
        }
        finite(variable, Some(sum))
    }
}

fn finite(variable: &Variable, derivative: Option<f64>) -> Answer<f64> {
    match derivative {
        Some(slope) if slope.is_finite() => Ok(slope),
        Some(_) => refuse(format!("the derivative of {} is too large for a number", variable.name)),
        None => refuse(format!("{} has no derivative: it is no smooth result of the inputs", variable.name)),
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
        _ => refuse(no_input(variable)),
    }
}

fn no_input(variable: &Variable) -> String {
    format!("{} is not an input", variable.name)
}
