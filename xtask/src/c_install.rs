//! Builds the C library and installs it with its headers and the files of CMake and pkg-config; uses
//! what is installed.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::shell::{cargo, root, run};

/// `cargo xtask c-install DIR [--use]`.
pub(crate) fn task(arguments: &[String]) -> Result<()> {
    match arguments {
        [prefix] if !prefix.starts_with('-') => install(Path::new(prefix)),
        [prefix, flag] if flag == "--use" => {
            let prefix = Path::new(prefix);
            install(prefix)?;
            let folder = root().join("target/c-install");
            let _ = std::fs::remove_dir_all(&folder);
            std::fs::create_dir_all(&folder)?;
            use_installed(&std::fs::canonicalize(prefix)?, &folder)
        }
        _ => bail!("name a folder: cargo xtask c-install DIR [--use]"),
    }
}

/// Builds the library and copies it into a folder with all that belongs to it.
pub(crate) fn install(prefix: &Path) -> Result<()> {
    run(&mut cargo(&["build", "--release", "--package", "cylindroid-c"]))?;
    std::fs::create_dir_all(prefix).with_context(|| prefix.display().to_string())?;
    let prefix = std::fs::canonicalize(prefix)?;
    let own = root().join("crates/cylindroid-c");
    let built = root().join("target/release");
    for header in ["cylindroid.h", "cylindroid.hpp"] {
        copy(&own.join("include").join(header), &prefix.join("include").join(header))?;
    }
    for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
        copy(&root().join(licence), &prefix.join("share/doc/cylindroid").join(licence))?;
    }
    // The last one of Windows is what programs of the DLL link.
    let libraries: &[&str] = if cfg!(windows) {
        &["cylindroid_c.dll", "cylindroid_c.lib", "cylindroid_c.dll.lib"]
    } else if cfg!(target_os = "macos") {
        &["libcylindroid_c.dylib", "libcylindroid_c.a"]
    } else {
        &["libcylindroid_c.so", "libcylindroid_c.a"]
    };
    for library in libraries {
        copy(&built.join(library), &prefix.join("lib").join(library))?;
    }
    let shared = libraries[0];
    let linked = if cfg!(windows) {
        "IMPORTED_IMPLIB \"${_prefix}/lib/cylindroid_c.dll.lib\""
    } else {
        // The library has no name of its own, so that programs would keep its path.
        "IMPORTED_NO_SONAME TRUE"
    };
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
         IMPORTED_LOCATION \"${{_prefix}}/lib/{shared}\"\n    {linked}\n    \
         INTERFACE_INCLUDE_DIRECTORIES \"${{_prefix}}/include\")\nendif()\n"
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

/// Builds and runs the examples with what is installed in a folder alone: by pkg-config, and by CMake
/// where it is there.
pub(crate) fn use_installed(prefix: &Path, folder: &Path) -> Result<()> {
    let examples = root().join("crates/cylindroid-c/examples");
    let libraries = prefix.join("lib");
    let pkg_config = Command::new("pkg-config")
        .args(["--cflags", "--libs", "cylindroid"])
        .env("PKG_CONFIG_PATH", libraries.join("pkgconfig"))
        .output()
        .context("cannot start pkg-config")?;
    let fault = String::from_utf8_lossy(&pkg_config.stderr);
    ensure!(pkg_config.status.success(), "pkg-config: {fault}");
    let flags = String::from_utf8(pkg_config.stdout)?;
    let program = folder.join("by-pkg-config");
    let mut compile = Command::new("cc");
    compile.args(["-std=c11", "-O2"]).arg(examples.join("servo.c")).arg("-o").arg(&program);
    run(compile.args(flags.split_whitespace()))?;
    run(Command::new(&program).env("LD_LIBRARY_PATH", &libraries))?;

    if Command::new("cmake").arg("--version").output().is_err() {
        println!("CMake is not installed: its files were not used");
        return Ok(());
    }
    let project = folder.join("by-cmake");
    let text = format!(
        "cmake_minimum_required(VERSION 3.16)\nproject(loop CXX)\nfind_package(cylindroid {} \
         REQUIRED)\nadd_executable(loop {:?})\ntarget_compile_features(loop PRIVATE \
         cxx_std_17)\ntarget_link_libraries(loop PRIVATE cylindroid::cylindroid)\n",
        env!("CARGO_PKG_VERSION"),
        examples.join("loop.cpp"),
    );
    write(&project.join("CMakeLists.txt"), &text)?;
    let built = project.join("build");
    run(Command::new("cmake")
        .args(["-DCMAKE_BUILD_TYPE=Release", "-S"])
        .arg(&project)
        .arg("-B")
        .arg(&built)
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())))?;
    run(Command::new("cmake").arg("--build").arg(&built))?;
    run(&mut Command::new(built.join("loop")))
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
