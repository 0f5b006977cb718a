//! The book: `docs/` as a static site, built by MkDocs and checked for links that lead nowhere.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::python::{environment, pip};
use crate::shell::{cargo, copy_folder, documentation, root, run};
use crate::{models, python};

const HERE: &str = "xtask/book";
const SITE: &str = "target/book";

/// `cargo xtask book [--outputs | --serve]`.
pub(crate) fn task(option: Option<&str>) -> Result<()> {
    match option {
        None => {
            build()?;
            println!("the book is in {}", root().join(SITE).join("index.html").display());
            Ok(())
        }
        Some("--outputs") => outputs(),
        Some("--serve") => run(mkdocs()?.arg("serve").args(CONFIGURATION)),
        Some(other) => bail!("no option '{other}': cargo xtask book [--outputs | --serve]"),
    }
}

const CONFIGURATION: [&str; 2] = ["--config-file", "xtask/book/mkdocs.yml"];

/// Builds the site, with the documentation of the Rust library in it, and checks all links.
pub(crate) fn build() -> Result<()> {
    run(mkdocs()?.args(["build", "--strict", "--quiet"]).args(CONFIGURATION))?;
    documentation()?;
    copy_folder(&root().join("target/doc"), &root().join(SITE).join("rust"))?;
    run(Command::new(interpreter()?).args([&format!("{HERE}/check.py"), SITE]))
}

/// Writes what commands and Python print into the pages.
fn outputs() -> Result<()> {
    let robots = models::fetch()?;
    let arguments = ["test", "--quiet", "--workspace", "--test", "cli", "book::"];
    let mut test = cargo(&arguments);
    run(test.env("CYLINDROID_TEST_ROBOTS", robots).env("CYLINDROID_WRITE_BOOK", "1"))?;
    python::write_outputs()
}

fn mkdocs() -> Result<Command> {
    let mut command = Command::new(interpreter()?);
    command.args(["-m", "mkdocs"]);
    command.env("CYLINDROID_BOOK_PACKAGES", packages()?.join("node_modules"));
    command.env("NO_MKDOCS_2_WARNING", "1");
    Ok(command)
}

/// A Python that has MkDocs.
fn interpreter() -> Result<PathBuf> {
    let venv = root().join("target/book-venv");
    let python = environment(&venv)?;
    let requirements = format!("{HERE}/requirements.txt");
    once(&venv, &[&requirements], || {
        println!("fetching what builds the book (100 MB, once)");
        pip(&python, &["-r", &requirements]).context("pip needs a way to PyPI")
    })?;
    Ok(python)
}

/// The folder of the npm packages that render formulas.
fn packages() -> Result<PathBuf> {
    let folder = root().join("target/book-packages");
    fs::create_dir_all(&folder)?;
    let [manifest, lock] = ["package.json", "package-lock.json"].map(|n| format!("{HERE}/{n}"));
    once(&folder, &[&manifest, &lock], || {
        for (from, to) in [(&manifest, "package.json"), (&lock, "package-lock.json")] {
            fs::copy(root().join(from), folder.join(to))?;
        }
        run(Command::new("npm").arg("--prefix").arg(&folder).args(["ci", "--silent"]))
            .context("formulas need Node.js 20.19 or later with npm 11 and a way to its registry")
    })?;
    Ok(folder)
}

/// Runs `install` where one of the `files` changed since it succeeded last.
fn once(folder: &Path, files: &[&str], install: impl FnOnce() -> Result<()>) -> Result<()> {
    let mut wanted = String::new();
    for file in files {
        wanted += &fs::read_to_string(root().join(file)).with_context(|| (*file).to_owned())?;
    }
    let stamp = folder.join(".installed");
    if fs::read_to_string(&stamp).is_ok_and(|got| got == wanted) {
        return Ok(());
    }
    install()?;
    fs::write(stamp, wanted)?;
    Ok(())
}
