//! `cartilage-contact presets`: what the presets are, as Markdown; docs/presets.md has the same tables.

use std::fmt::Write;

use cartilage_contact::parameters::{Factors, PRESETS, Tissue};

use super::{Failure, format, print};

/// Prints the values, then the sources.
pub fn run() -> Result<(), Failure> {
    let mut text = "| preset | number | aggregate modulus [MPa] | Poisson's ratio | shear modulus [MPa] | bulk modulus [MPa] | \
                    hydraulic permeability [m^4/(N s)] | permeability [m^2] | along over through | tensile modulus [MPa] | fibre modulus [MPa] | thickness [mm] | roughness [um] | mesh |\n\
                    |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for (row, number) in PRESETS.iter().zip(1..) {
        let body = row.preset.parameters().upper;
        let measured = |value: fn(&Tissue) -> f64| {
            row.tissue.as_ref().map_or_else(|| "-".into(), |tissue| format::number(value(tissue), 4))
        };
        let mesh = row.preset.parameters().mesh;
        let values = [
            measured(|tissue| tissue.aggregate_modulus * 1e-6),
            measured(|tissue| tissue.poisson_ratio),
            format::number(body.shear_modulus * 1e-6, 4),
            format::number(body.bulk_modulus * 1e-6, 4),
            measured(|tissue| tissue.hydraulic_permeability),
            format::number(body.permeability, 4),
            format::number(body.tangential_permeability_ratio, 4),
            measured(|tissue| tissue.tensile_modulus * 1e-6),
            format::number(body.fibre_modulus * 1e-6, 4),
            format::number(body.thickness * 1e3, 4),
            measured(|tissue| tissue.roughness * 1e6),
            if mesh.columns == 0 { "automatic".into() } else { format!("{} x {}", mesh.columns, mesh.rows) },
        ];
        let _ = writeln!(text, "| `{}` | {number} | {} |", row.name, values.join(" | "));
    }
    text += "\n| preset | at | aggregate modulus [MPa] | hydraulic permeability [m^4/(N s)] |\n|---|---|---|---|\n";
    for row in &PRESETS {
        let Some(Tissue { aggregate_modulus, hydraulic_permeability, layers: Some([surface, deep]), .. }) = row.tissue
        else {
            continue;
        };
        for (place, factors) in [("surface", surface), ("middle", Factors::NONE), ("bone", deep)] {
            let modulus = format::number(aggregate_modulus * factors.bulk_modulus * 1e-6, 4);
            let permeability = format::number(hydraulic_permeability * factors.permeability, 4);
            let _ = writeln!(text, "| `{}`, in layers | {place} | {modulus} | {permeability} |", row.name);
        }
    }
    text += "\n| preset | tissue | source | uncertain |\n|---|---|---|---|\n";
    for row in &PRESETS {
        let _ = writeln!(text, "| `{}` | {} | {} | {} |", row.name, row.description, row.source, row.uncertainty);
    }
    print(&text)
}
