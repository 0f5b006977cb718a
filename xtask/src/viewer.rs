//! The viewer's page: built by Node.js into `viewer/dist`, which the command line embeds; tested in
//! a browser against the real server.

use std::collections::hash_map::DefaultHasher;
use std::fs;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::models;
use crate::shell::{cargo, root, run};

const PAGE: &str = "viewer";
const CHROMIUM: &str = "/usr/bin/chromium";
const NO_NODE: &str =
    "the viewer's page is built by Node.js 20.19 or later with npm; install them and try again";

/// `cargo xtask viewer [--test | --picture]`.
pub(crate) fn task(option: Option<&str>) -> Result<()> {
    match option {
        None => build(),
        Some("--test") => {
            build()?;
            test()
        }
        Some("--picture") => {
            build()?;
            in_browser(&["tests/picture.mjs".into()], None)
        }
        Some(other) => bail!("no option '{other}': cargo xtask viewer [--test | --picture]"),
    }
}

/// Installs what `viewer/package-lock.json` names and builds the page, where something changed since.
pub(crate) fn build() -> Result<()> {
    let page = root().join(PAGE);
    install(&page)?;
    let stamp = root().join("target/viewer-page.stamp");
    let now = fingerprint(&page)?.to_string();
    if page.join("dist/index.html").exists() && fs::read_to_string(&stamp).is_ok_and(|s| s == now) {
        return Ok(());
    }
    run(npm(&page).args(["run", "--silent", "build"])).context("building the viewer's page")?;
    fs::create_dir_all(root().join("target"))?;
    fs::write(stamp, now)?;
    Ok(())
}

fn npm(page: &Path) -> Command {
    let mut command = Command::new("npm");
    command.arg("--prefix").arg(page);
    command
}

/// `npm ci`, once for each lock file.
fn install(page: &Path) -> Result<()> {
    let node = Command::new("node").arg("--version").stderr(Stdio::null()).output();
    if !node.is_ok_and(|found| found.status.success()) {
        bail!(NO_NODE);
    }
    let wanted = fs::read_to_string(page.join("package-lock.json"))?;
    let stamp = page.join("node_modules/.installed-lock");
    if fs::read_to_string(&stamp).is_ok_and(|got| got == wanted) {
        return Ok(());
    }
    println!("fetching what the viewer's page is built with (120 MB, once)");
    run(npm(page).args(["ci", "--silent"]))
        .context("npm ci needs npm 11 and a way to its registry")?;
    fs::write(stamp, wanted)?;
    Ok(())
}

/// Of all that the page is built from and checked with.
fn fingerprint(page: &Path) -> Result<u64> {
    let mut hasher = DefaultHasher::new();
    for name in ["index.html", "package-lock.json", "tsconfig.json", "vite.config.ts"] {
        fs::read(page.join(name)).with_context(|| format!("{PAGE}/{name}"))?.hash(&mut hasher);
    }
    let mut folders = ["src", "public", "tests"].map(|name| page.join(name)).to_vec();
    while let Some(folder) = folders.pop() {
        let mut entries: Vec<_> =
            fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
        entries.sort();
        for path in entries {
            if path.is_dir() {
                folders.push(path);
            } else {
                path.strip_prefix(page)?.hash(&mut hasher);
                fs::read(&path)?.hash(&mut hasher);
            }
        }
    }
    Ok(hasher.finish())
}

/// The page in headless Chromium against the server; pictures land in `target/viewer-screenshots`.
pub(crate) fn test() -> Result<()> {
    let mut arguments = vec!["--test".into(), "--test-concurrency=1".into()];
    let mut files: Vec<PathBuf> = fs::read_dir(root().join(PAGE).join("tests"))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_>>()?;
    files.retain(|file| file.to_string_lossy().ends_with(".test.mjs"));
    files.sort();
    arguments.extend(files);
    in_browser(&arguments, None)
}

/// Pages that follow a program in this Python, which has the package.
pub(crate) fn follow(python: &Path) -> Result<()> {
    in_browser(&["--test".into(), "tests/python.mjs".into()], Some(python))
}

/// Runs Node.js on the page's tests, with a browser, the command line and perhaps a Python.
fn in_browser(arguments: &[PathBuf], python: Option<&Path>) -> Result<()> {
    let chromium = chromium()?;
    let robots = models::fetch()?;
    // The command line that its tests run: another profile would compile everything again.
    run(&mut cargo(&["test", "--quiet", "--workspace", "--test", "cli", "--no-run"]))?;
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let binary = target.join("debug").join(format!("cylindroid{}", std::env::consts::EXE_SUFFIX));
    let screenshots = root().join("target/viewer-screenshots");
    fs::create_dir_all(&screenshots)?;
    let mut node = Command::new("node");
    node.args(arguments)
        .env("CYLINDROID_BINARY", binary)
        .env("CYLINDROID_TEST_ROBOTS", robots)
        .env("CYLINDROID_SCREENSHOTS", screenshots)
        .env("CYLINDROID_CHROMIUM", chromium);
    if let Some(python) = python {
        node.env("CYLINDROID_PYTHON", python);
    }
    let status = node.current_dir(root().join(PAGE)).status().context(NO_NODE)?;
    if !status.success() {
        bail!("the viewer's page failed in the browser ({status})");
    }
    Ok(())
}

/// The browser: `CHROMIUM`, or Debian's, which is installed where it is missing and can be.
fn chromium() -> Result<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM") {
        return Ok(PathBuf::from(path));
    }
    let chromium = PathBuf::from(CHROMIUM);
    if chromium.exists() {
        return Ok(chromium);
    }
    println!("installing Chromium for the viewer's tests (apt-get install chromium, once)");
    let apt = |arguments: &[&str]| {
        Command::new("apt-get")
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    };
    let installed = apt(&["update", "-qq"])
        && apt(&["install", "-qq", "-y", "--no-install-recommends", "chromium"]);
    if !installed || !chromium.exists() {
        bail!(
            "the viewer's tests need Chromium: install it (Debian: apt-get install chromium), or \
             set CHROMIUM to where it is"
        );
    }
    Ok(chromium)
}
