//! Builds the C library and installs it with its headers and the files of CMake and pkg-config.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::shell::{cargo, root, run};

/// `cargo xtask c-install DIR`.
pub(crate) fn install(prefix: Option<&str>) -> Result<()> {
    let prefix = prefix.context("name a folder: cargo xtask c-install DIR")?;
    run(&mut cargo(&["build", "--release", "--package", "cylindroid-c"]))?;
    std::fs::create_dir_all(prefix).with_context(|| prefix.to_owned())?;
    let prefix = std::fs::canonicalize(prefix)?;
    let own = root().join("crates/cylindroid-c");
    let built = root().join("target/release");
    for header in ["cylindroid.h", "cylindroid.hpp"] {
        copy(&own.join("include").join(header), &prefix.join("include").join(header))?;
    }
    let [shared, fixed] = if cfg!(windows) {
        ["cylindroid_c.dll", "cylindroid_c.lib"]
    } else if cfg!(target_os = "macos") {
        ["libcylindroid_c.dylib", "libcylindroid_c.a"]
    } else {
        ["libcylindroid_c.so", "libcylindroid_c.a"]
    };
    for library in [shared, fixed] {
        copy(&built.join(library), &prefix.join("lib").join(library))?;
    }
    let version = env!("CARGO_PKG_VERSION");
    let pc = format!(
        "prefix=${{pcfiledir}}/../..\nName: cylindroid\nDescription: robots and mechanisms in a \
         loop of 1 kHz\nVersion: {version}\nCflags: -I${{prefix}}/include\nLibs: -L${{prefix}}/lib \
         -lcylindroid_c\nLibs.private: -lpthread -ldl -lm\n"
    );
    write(&prefix.join("lib/pkgconfig/cylindroid.pc"), &pc)?;
    let config = format!(
        "get_filename_component(_prefix \"${{CMAKE_CURRENT_LIST_DIR}}/../../..\" ABSOLUTE)\n\
         if(NOT TARGET cylindroid::cylindroid)\n  add_library(cylindroid::cylindroid SHARED \
         IMPORTED)\n  set_target_properties(cylindroid::cylindroid PROPERTIES\n    \
         IMPORTED_LOCATION \"${{_prefix}}/lib/{shared}\"\n    IMPORTED_IMPLIB \
         \"${{_prefix}}/lib/{fixed}\"\n    INTERFACE_INCLUDE_DIRECTORIES \
         \"${{_prefix}}/include\")\nendif()\n"
    );
    write(&prefix.join("lib/cmake/cylindroid/cylindroid-config.cmake"), &config)?;
    let exact = format!(
        "set(PACKAGE_VERSION {version})\nif(PACKAGE_FIND_VERSION VERSION_GREATER \
         PACKAGE_VERSION)\n  set(PACKAGE_VERSION_COMPATIBLE FALSE)\nelse()\n  \
         set(PACKAGE_VERSION_COMPATIBLE TRUE)\nendif()\n"
    );
    write(&prefix.join("lib/cmake/cylindroid/cylindroid-config-version.cmake"), &exact)?;
    println!("installed in {}", prefix.display());
    Ok(())
}

fn folder_of(file: &Path) -> Result<PathBuf> {
    let folder = file.parent().context("a file has a folder")?.to_path_buf();
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    folder_of(to)?;
    std::fs::copy(from, to).with_context(|| from.display().to_string())?;
    Ok(())
}

fn write(to: &Path, text: &str) -> Result<()> {
    folder_of(to)?;
    std::fs::write(to, text).with_context(|| to.display().to_string())
}
