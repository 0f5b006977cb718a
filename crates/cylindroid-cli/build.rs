//! Tells cargo that the page of the viewer is a part of the binary, built or not.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let viewer = Path::new("../../viewer");
    if viewer.is_dir() {
        // Cargo builds anew each time where a folder that it watches is missing. Where it cannot be
        // made, that is all that is lost.
        let _ = std::fs::create_dir_all(viewer.join("dist"));
        println!("cargo::rerun-if-changed=../../viewer/dist");
    }
}
