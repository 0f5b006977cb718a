//! A release of the crates, up to the upload: they are packaged and listed with their sizes, with
//! the page of the viewer inside that of the command line.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, ensure};

use crate::shell::{captured, cargo, copy_folder, root, run};
use crate::viewer;

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The page inside the crate of the command line.
const PAGE: &str = "crates/cylindroid-cli/page";
/// Larger crates are refused by crates.io (bytes).
const LARGEST_CRATE: u64 = 10_000_000;

/// A folder that goes when it is dropped.
struct Passing(PathBuf);

impl Drop for Passing {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// `cargo xtask release`.
pub(crate) fn check() -> Result<()> {
    let changed = captured(Command::new("git").args(["status", "--porcelain"]))?;
    let files = crates()?;
    println!("what would be uploaded, version {VERSION}:");
    for file in &files {
        let size = fs::metadata(file)?.len();
        println!("{:>8.2} MB  {}", size as f64 / 1e6, file.display());
        ensure!(size < LARGEST_CRATE, "crates.io refuses crates of more than 10 MB");
    }
    if !changed.is_empty() {
        println!("\nnot in the last commit, and yet in the packages:\n{changed}");
    }
    Ok(())
}

/// The crates for crates.io, the library first.
fn crates() -> Result<Vec<PathBuf>> {
    viewer::build()?;
    let page = Passing(root().join(PAGE));
    copy_folder(&root().join("viewer/dist"), &page.0)?;
    let crates = ["cylindroid", "cylindroid-cli", "cylindroid-ros2"];
    let packages = crates.iter().flat_map(|name| ["--package", name]);
    // The page is in no commit.
    run(cargo(&["package", "--quiet", "--no-verify", "--allow-dirty"]).args(packages))?;
    let file = |name: &str| root().join("target/package").join(format!("{name}-{VERSION}.crate"));
    Ok(crates.map(file).to_vec())
}
