//! The binary `cylindroid`: parses, runs, returns the exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    cylindroid_cli::run(std::env::args_os()).into()
}
