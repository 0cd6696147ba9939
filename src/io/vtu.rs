//! Fields as VTK unstructured grids (VTU, XML, ASCII), which ParaView, VisIt and PyVista open.
//!
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>

use std::fmt::Write;

use crate::fields::{BodyFields, Fields, InterfaceFields};

/// VTK's number for a quadrilateral of nine nodes: corners, middles of the edges, centre.
const BIQUADRATIC_QUADRILATERAL: u8 = 28;
/// VTK's number for a line of three nodes: ends, middle.
const QUADRATIC_EDGE: u8 = 21;
/// Where VTK's nodes of a biquadratic quadrilateral are among ours, which go row by row.
const QUADRILATERAL_NODES: [usize; 9] = [0, 2, 8, 6, 1, 5, 7, 3, 4];

/// A list of values with its name; 1 or 3 components.
struct Array<'a> {
    name: &'a str,
    components: usize,
    values: Vec<f64>,
}

impl<'a> Array<'a> {
    fn scalars(name: &'a str, values: impl IntoIterator<Item = f64>) -> Self {
        Self { name, components: 1, values: values.into_iter().collect() }
    }

    fn vectors(name: &'a str, values: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self { name, components: 3, values: values.into_iter().flat_map(|[x, y]| [x, y, 0.0]).collect() }
    }
}

/// Both bodies before deformation, with the displacement as a vector (ParaView: Warp By Vector), pore pressure, von Mises stress
/// and Darcy flux at the nodes, and volume ratio and body (1 upper, 2 lower) of the elements.
pub fn bodies(fields: &Fields) -> String {
    let bodies = &fields.bodies;
    let all = |get: fn(&BodyFields) -> &Vec<f64>| bodies.iter().flat_map(move |body| get(body).iter().copied());
    let vectors =
        |get: fn(&BodyFields) -> &Vec<[f64; 2]>| bodies.iter().flat_map(move |body| get(body).iter().copied());
    let mut cells = Vec::new();
    let mut first = 0;
    for body in bodies {
        for element in 0..body.columns * body.rows {
            let nodes = body.element_nodes(element);
            cells.push(QUADRILATERAL_NODES.map(|a| first + nodes[a]).to_vec());
        }
        first += body.reference_position.len();
    }
    let body_number =
        (1..=2).zip(bodies).flat_map(|(i, body)| std::iter::repeat_n(f64::from(i), body.volume_ratio.len()));
    document(
        &Array::vectors("position", vectors(|b| &b.reference_position)),
        BIQUADRATIC_QUADRILATERAL,
        &cells,
        &[
            Array::vectors("displacement [m]", vectors(|b| &b.displacement)),
            Array::scalars("fluid pressure [Pa]", all(|b| &b.fluid_pressure)),
            Array::scalars("von Mises stress [Pa]", all(|b| &b.von_mises_stress)),
            Array::vectors("Darcy flux [m/s]", vectors(|b| &b.darcy_flux)),
        ],
        &[Array::scalars("volume ratio", all(|b| &b.volume_ratio)), Array::scalars("body", body_number)],
    )
}

/// The interface as a line along x.
pub fn interface(fields: &InterfaceFields) -> String {
    let cells: Vec<_> = (0..fields.position.len() - 1).step_by(2).map(|i| vec![i, i + 2, i + 1]).collect();
    let touching =
        cells.iter().map(|cell| if cell.iter().all(|i| fields.contact_pressure[*i] > 0.0) { 1.0 } else { 0.0 });
    let nodal = |name, values: &[f64]| Array::scalars(name, values.iter().copied());
    document(
        &Array::vectors("position", fields.position.iter().map(|x| [*x, 0.0])),
        QUADRATIC_EDGE,
        &cells,
        &[
            nodal("film thickness [m]", &fields.film_thickness),
            nodal("fluid pressure [Pa]", &fields.fluid_pressure),
            nodal("void thickness [m]", &fields.void_thickness),
            nodal("contact pressure [Pa]", &fields.contact_pressure),
            nodal("film flux [m2/s]", &fields.film_flux),
            nodal("outflow of upper body [m/s]", &fields.upper_outflow),
            nodal("outflow of lower body [m/s]", &fields.lower_outflow),
            nodal("outflow into film [m/s]", &fields.outflow),
        ],
        &[Array::scalars("solids touch", touching)],
    )
}

fn document(points: &Array, cell_type: u8, cells: &[Vec<usize>], point_data: &[Array], cell_data: &[Array]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">\n<UnstructuredGrid>\n",
    );
    let count = points.values.len() / 3;
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{}\">", cells.len());
    text += "<Points>\n";
    array(&mut text, points);
    text += "</Points>\n<Cells>\n";
    integers(&mut text, "connectivity", cells.iter().flatten().copied(), 9);
    let ends = cells.iter().scan(0, |end, cell| {
        *end += cell.len();
        Some(*end)
    });
    integers(&mut text, "offsets", ends, 12);
    integers(&mut text, "types", cells.iter().map(|_| usize::from(cell_type)), 24);
    text += "</Cells>\n<PointData>\n";
    point_data.iter().for_each(|values| array(&mut text, values));
    text += "</PointData>\n<CellData>\n";
    cell_data.iter().for_each(|values| array(&mut text, values));
    text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    text
}

fn array(text: &mut String, Array { name, components, values }: &Array) {
    let _ = writeln!(
        text,
        "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for row in values.chunks(6) {
        let words: Vec<_> =
            row.iter().map(|value| if *value == 0.0 { "0".into() } else { format!("{value:e}") }).collect();
        let _ = writeln!(text, "{}", words.join(" "));
    }
    text.push_str("</DataArray>\n");
}

fn integers(text: &mut String, name: &str, values: impl Iterator<Item = usize>, a_line: usize) {
    let _ = writeln!(text, "<DataArray type=\"Int64\" Name=\"{name}\" format=\"ascii\">");
    let words: Vec<_> = values.map(|value| value.to_string()).collect();
    for row in words.chunks(a_line) {
        let _ = writeln!(text, "{}", row.join(" "));
    }
    text.push_str("</DataArray>\n");
}
