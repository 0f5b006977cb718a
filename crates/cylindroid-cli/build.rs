//! The page of the viewer as a part of the binary: the built one of the repository, whether it is
//! built or not, and in a package the one that it carries.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

const MISSING: &str = "this package lacks the page of the viewer (page/index.html): packages are \
                       made by `cargo xtask release`";

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    let viewer = Path::new("../../viewer");
    let page = if viewer.join("package.json").is_file() {
        // Cargo builds anew each time where a folder that it watches is missing. Where it cannot be
        // made, that is all that is lost.
        let _ = fs::create_dir_all(viewer.join("dist"));
        viewer.join("dist")
    } else {
        if !Path::new("page/index.html").is_file() {
            println!("cargo::error={MISSING}");
        }
        PathBuf::from("page")
    };
    println!("cargo::rerun-if-changed={}", page.display());
    let out = env::var_os("OUT_DIR").map(PathBuf::from).unwrap_or_default();
    let code = format!(
        "/// The page built by `cargo xtask viewer`.\n#[derive(rust_embed::RustEmbed)]\n#[folder = \
         {:?}]\n#[allow_missing = true]\npub(super) struct Page;\n",
        page.display().to_string()
    );
    fs::write(out.join("page.rs"), code)
}
