//! Lower layers know nothing of higher ones: every `use crate::` points downwards.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};

/// The layers from the bottom; those in one row do not use each other unless they are one module.
const LAYERS: [&[&str]; 11] = [
    &["error", "units", "solver"],
    &["laws"],
    &["parameters", "fem", "files"],
    &["equations", "memory"],
    &["outputs", "fields"],
    &["simulation"],
    &["sweep"],
    &["variables", "reduced"],
    &["fmi", "io"],
    &["cli"],
    &["main", "lib"],
];

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|row| row.contains(&module))
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The modules of this crate that the code of a source file names, tests included; comments may point anywhere.
fn used(text: &str) -> Vec<String> {
    let mut modules = Vec::new();
    let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let text = code.join("\n");
    for (index, _) in text.match_indices("crate::") {
        // Not the end of a longer name such as `some_crate::`.
        if text[..index].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let rest = &text[index + "crate::".len()..];
        let group = match rest.strip_prefix('{') {
            // `use crate::{error::Error, laws};`
            Some(group) => group.split('}').next().unwrap_or_default(),
            None => rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default(),
        };
        for item in group.split(',') {
            let name: String = item.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if !name.is_empty() {
                modules.push(name);
            }
        }
    }
    modules
}

#[test]
fn every_use_points_downwards() {
    let mut paths = Vec::new();
    sources(Path::new("src"), &mut paths);
    assert!(paths.len() > 5);
    let mut wrong = Vec::new();
    for path in paths {
        let inside = path.strip_prefix("src").unwrap();
        let first = inside.components().next().unwrap().as_os_str().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        let Some(own) = layer(module) else {
            wrong.push(format!("{}: `{module}` has no layer; add it to tests/layers.rs", path.display()));
            continue;
        };
        for target in used(&std::fs::read_to_string(&path).unwrap()) {
            let allowed = target == module || layer(&target).is_some_and(|other| other < own);
            // A crate-level macro or item is not a module.
            if layer(&target).is_some() && !allowed {
                wrong.push(format!("{}: `{module}` uses `{target}`, which is not below it", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A command draws with figures; these have data of their own, or a table's.
#[test]
fn figures_know_no_command() {
    let mut paths = Vec::new();
    sources(Path::new("src/cli/figures"), &mut paths);
    assert!(paths.len() > 5);
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        for (index, _) in text.match_indices("crate::cli::").chain(text.match_indices("super::super::")) {
            let used: String = text[index..].lines().next().unwrap().into();
            assert!(used.starts_with("crate::cli::table::"), "{}: {used}", path.display());
        }
    }
    let table = std::fs::read_to_string("src/cli/table.rs").unwrap();
    assert!(!table.contains("figures") && !table.contains("stribeck::"), "src/cli/table.rs uses what uses it");
}

#[test]
fn names_are_found_in_every_form_of_use() {
    assert_eq!(
        used("/// [`crate::cli`]\nuse crate::error::Error;\nuse crate::{laws, fem::mesh::Mesh};"),
        ["error", "laws", "fem"]
    );
    assert_eq!(used("let x: crate::units::Unit = my_crate::other();"), ["units"]);
}
