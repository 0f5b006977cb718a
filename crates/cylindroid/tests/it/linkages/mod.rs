//! Classical linkages with the verdicts that are published about them, in every view.
//!
//! `tests/data/linkages`: one file each; `expected.json`: degrees of freedom to first order and of
//! finite motion, kinds of singularity (C configuration space, I, II, III, P passive) and source.

mod length;
mod modes;
mod published;
mod second_order;
mod servo;
mod view;
mod views;

use std::path::PathBuf;

use cylindroid::Mechanism;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/linkages")
}

/// The text of a linkage file.
fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(format!("{name}.toml"))).unwrap()
}

/// The names of all linkages, sorted.
fn names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap().map(|f| f.unwrap().path());
    let linkages = files.filter(|f| f.extension().is_some_and(|e| e == "toml"));
    let mut names: Vec<String> =
        linkages.map(|f| f.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

fn parsed(text: &str, name: &str) -> Mechanism {
    let path = PathBuf::from(format!("{name}.toml"));
    cylindroid::model::formats::toml::parse(text, &path).unwrap_or_else(|e| panic!("{name}: {e}"))
}
