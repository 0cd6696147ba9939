//! Lower layers know nothing of higher ones: every `use crate::` points downwards.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
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

/// The code of a source file: comments may point anywhere.
fn code(text: &str) -> String {
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// The paths that begin with `crate`, `super` or `self` in the code of a source file, `use` with braces taken apart.
fn used(text: &str) -> Vec<Vec<String>> {
    /// The paths of what follows `before`, and the rest of the text.
    fn paths<'a>(before: &[String], mut text: &'a str, found: &mut Vec<Vec<String>>) -> &'a str {
        let mut path = before.to_vec();
        loop {
            if let Some(group) = text.strip_prefix('{') {
                text = group;
                loop {
                    text = paths(&path, text.trim_start(), found).trim_start();
                    match text.strip_prefix(',') {
                        Some(rest) => text = rest,
                        None => return text.strip_prefix('}').unwrap_or(text),
                    }
                }
            }
            let length = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
            if length > 0 {
                path.push(text[..length].into());
            }
            text = &text[length..];
            match text.strip_prefix("::") {
                Some(rest) => text = rest,
                None => break,
            }
        }
        if path.len() > before.len() {
            found.push(path);
        }
        text.trim_start_matches(|c: char| !",}".contains(c))
    }
    let text = code(text);
    let mut found = Vec::new();
    for head in ["crate", "super", "self"] {
        for (index, _) in text.match_indices(&format!("{head}::")) {
            // Not the end of a longer name such as `some_crate::`, nor of a longer path.
            if !text[..index].ends_with(|c: char| c.is_alphanumeric() || "_:".contains(c)) {
                paths(&[], &text[index..], &mut found);
            }
        }
    }
    found
}

/// The module in which a source file puts its code, from the crate.
fn module(path: &Path) -> Vec<String> {
    let inside = path.strip_prefix("src").unwrap().with_extension("");
    let mut names: Vec<String> = inside.iter().map(|name| name.to_str().unwrap().into()).collect();
    names.pop_if(|name| name == "mod");
    names
}

/// What a path within a module stands for, from the crate.
fn resolved(module: &[String], path: &[String]) -> Vec<String> {
    let up = path.iter().take_while(|name| *name == "super").count();
    match path[0].as_str() {
        "crate" => path[1..].to_vec(),
        "self" => [module, &path[1..]].concat(),
        _ => [&module[..module.len().saturating_sub(up)], &path[up..]].concat(),
    }
}

#[test]
fn every_use_points_downwards() {
    let mut paths = Vec::new();
    sources(Path::new("src"), &mut paths);
    assert!(paths.len() > 5);
    let mut wrong = Vec::new();
    for path in paths {
        let module = &*module(&path)[0];
        let Some(own) = layer(module) else {
            wrong.push(format!("{}: `{module}` has no layer; add it to tests/layers.rs", path.display()));
            continue;
        };
        for path_used in used(&std::fs::read_to_string(&path).unwrap()).iter().filter(|used| used[0] == "crate") {
            let target = &path_used[1];
            let allowed = target == module || layer(target).is_some_and(|other| other < own);
            // A crate-level macro or item is not a module.
            if layer(target).is_some() && !allowed {
                wrong.push(format!("{}: `{module}` uses `{target}`, which is not below it", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// No module uses another one that uses it, on whatever detour. A module and those within it are one thing, seen from outside; tests may
/// use what they test.
#[test]
fn imports_go_in_no_circle() {
    let mut paths = Vec::new();
    sources(Path::new("src"), &mut paths);
    let modules: BTreeSet<Vec<String>> = paths.iter().map(|path| module(path)).collect();
    let mut uses: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> = BTreeMap::new();
    for path in &paths {
        let (module, text) = (module(path), std::fs::read_to_string(path).unwrap());
        for used in used(text.split("#[cfg(test)]\nmod tests {").next().unwrap()) {
            let mut target = resolved(&module, &used);
            while !target.is_empty() && !modules.contains(&target) {
                target.pop();
            }
            let common = module.iter().zip(&target).take_while(|(a, b)| a == b).count();
            if common < module.len().min(target.len()) {
                uses.entry(module[..=common].to_vec()).or_default().insert(target[..=common].to_vec());
            }
        }
    }
    assert!(uses.values().map(BTreeSet::len).sum::<usize>() > 150);
    for (start, first) in &uses {
        let (mut reached, mut next) = (BTreeSet::new(), Vec::from_iter(first));
        while let Some(other) = next.pop() {
            assert!(other != start, "{} uses what uses it; it uses {first:?}", start.join("::"));
            if reached.insert(other) {
                next.extend(uses.get(other).into_iter().flatten());
            }
        }
    }
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
    let found = |text: &str| used(text).iter().map(|path| path.join("::")).collect::<Vec<_>>();
    assert_eq!(
        found("/// [`crate::cli`]\nuse crate::error::Error;\nuse crate::{laws, fem::{self, mesh::Mesh as M}, io};"),
        ["crate::error::Error", "crate::laws", "crate::fem::self", "crate::fem::mesh::Mesh", "crate::io"]
    );
    assert_eq!(found("let x: crate::units::Unit = my_crate::other();"), ["crate::units::Unit"]);
    let module = ["a", "b"].map(String::from);
    let stands = |path: &str| resolved(&module, &used(path)[0]).join("::");
    assert_eq!(
        ["crate::c::D", "super::c::D", "super::super::c", "self::c"].map(stands),
        ["c::D", "a::c::D", "c", "a::b::c"]
    );
}
