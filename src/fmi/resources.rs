//! Files beside the library in an unpacked FMU.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::parameters::{Fidelity, PARAMETERS, Parameters};
use crate::reduced::ReducedModel;

/// Name of the table of the real-time model in the folder of resources.
pub const REDUCED_MODEL: &str = "reduced_model.bin";

/// The folder that an importer names: a URI in FMI 2, a path in FMI 3. Both are taken from either.
///
/// # Errors
/// [`Error::Value`] for a URI that is no file on this machine.
pub fn folder(location: &str) -> Result<PathBuf, Error> {
    let refuse = |allowed: &str| Err(Error::value("resource location", location, allowed));
    let Some(rest) = location.get(..5).filter(|scheme| scheme.eq_ignore_ascii_case("file:")).map(|_| &location[5..])
    else {
        return match location.contains("://") {
            true => refuse("a path, or a URI that begins with file:"),
            false => Ok(PathBuf::from(location)),
        };
    };
    // file:/x, file:///x, file://localhost/x
    let path = match rest.strip_prefix("//").map(|rest| rest.split_at(rest.find('/').unwrap_or(rest.len()))) {
        None => rest,
        Some((host, path)) if host.is_empty() || host.eq_ignore_ascii_case("localhost") => path,
        Some(_) => return refuse("a file on this machine: file:///..."),
    };
    let Some(path) = percent_decoded(path) else {
        return refuse("a URI whose percent signs begin two digits of a byte");
    };
    // file:///C:/x
    let drive = path.strip_prefix('/').filter(|path| path.as_bytes().get(1) == Some(&b':'));
    Ok(PathBuf::from(drive.unwrap_or(&path)))
}

/// A URI's text with the bytes that `%xx` stand for; `None` where they are no text.
fn percent_decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut pieces = text.split('%');
    bytes.extend(pieces.next()?.bytes());
    for piece in pieces {
        bytes.push(u8::from_str_radix(piece.get(..2).filter(|digits| !digits.starts_with('+'))?, 16).ok()?);
        bytes.extend(piece[2..].bytes());
    }
    String::from_utf8(bytes).ok()
}

/// The real-time model in the FMU's resources, if it was made for these parameters.
///
/// # Errors
/// [`Error::File`] where there is none, or none of this version; [`Error::State`] with the parameters that differ.
pub fn reduced_model(location: Option<&str>, parameters: &Parameters) -> Result<ReducedModel, Error> {
    let path = folder(location.unwrap_or_default())?.join(REDUCED_MODEL);
    let failed = |message: String| Error::File { path: path.display().to_string(), message };
    let bytes = std::fs::read(&path).map_err(|error| {
        failed(format!(
            "fidelity = reduced needs a reduced model in the FMU's resources ({error}); make an FMU that has one with \
             `cartilage-contact reduce`"
        ))
    })?;
    let model = ReducedModel::from_bytes(&bytes).map_err(|error| failed(error.to_string()))?;
    // How long a solution may take changes none.
    let maximum_solve_time = model.parameters().maximum_solve_time;
    let wanted = Parameters { fidelity: Fidelity::Full, maximum_solve_time, ..*parameters };
    let differing: Vec<String> = (PARAMETERS.into_iter())
        .map(|row| (row.name, row.get(model.parameters()), row.get(&wanted)))
        .filter(|(_, there, here)| there != here)
        .map(|(name, there, here)| format!("{name} is {there} there and {here} here"))
        .collect();
    match differing.is_empty() {
        true => Ok(model),
        false => Err(Error::State(format!(
            "the reduced model in {} is of another case: {}; make one of this case with `cartilage-contact reduce`",
            Path::display(&path),
            differing.join("; ")
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_and_paths_name_the_same_folder() {
        for location in [
            "/tmp/an fmu/resources",
            "file:/tmp/an%20fmu/resources",
            "file:///tmp/an%20fmu/resources",
            "FILE://localhost/tmp/an%20fmu/resources",
        ] {
            assert_eq!(folder(location).unwrap(), Path::new("/tmp/an fmu/resources"), "{location}");
        }
        assert_eq!(folder("file:///tmp/k%C3%A4se").unwrap(), Path::new("/tmp/käse"));
        // A path is taken as it is.
        assert_eq!(folder("/tmp/100%20").unwrap(), Path::new("/tmp/100%20"));
        assert_eq!(folder("file:///C:/fmu/resources").unwrap(), Path::new("C:/fmu/resources"));
        for wrong in ["https://host/x", "file://host/x", "file:///a%2", "file:///a%zz", "file:///a%FF"] {
            assert!(folder(wrong).unwrap_err().to_string().contains(wrong));
        }
    }
}
