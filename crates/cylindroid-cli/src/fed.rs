//! Files of numbers and of tasks: what fuzz targets feed, and tests of what they found.

use std::io;
use std::path::Path;

use clap::Parser;

use crate::args::Cli;
use crate::{commands, number_file};

/// Rows of the files that commands are given; they take time for each.
const FEW: usize = 16;

/// Reads a file of numbers as rows, configurations and a matrix, and gives a short one to the
/// commands that take such files.
pub(crate) fn numbers(path: &Path) {
    let _ = number_file::configurations(path, &["q1", "q2", "q3"]);
    if path.extension().is_some_and(|e| e == "parquet") {
        return;
    }
    let rows = number_file::rows(path);
    let _ = number_file::matrix(path, 3);
    if rows.is_ok_and(|rows| rows.len() <= FEW) {
        let file = path.to_string_lossy();
        command(&["screws", &file]);
        command(&["manipulability", "five-bar", "--task-map", &file]);
        command(&["manipulability", "five-bar", "--configurations", &file]);
        command(&["sweep", "ur5e", "--configurations", &file]);
    }
}

/// Gives a file of tasks to `ik`.
pub(crate) fn tasks(path: &Path) {
    command(&["ik", "panda", "--iterations", "40", "--tasks", &path.to_string_lossy()]);
}

fn command(words: &[&str]) {
    let words = ["cylindroid"].iter().chain(words);
    let Ok(cli) = Cli::try_parse_from(words) else { return };
    if let Err(error) = commands::run(&cli, &mut io::sink()) {
        assert!(!format!("{error:#}").is_empty());
    }
}

/// The files that were found for a target.
#[cfg(test)]
pub(crate) fn findings(target: &str) -> Vec<Vec<u8>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../cylindroid/tests/data/findings");
    let entries = std::fs::read_dir(Path::new(folder).join(target)).into_iter().flatten();
    entries.map(|entry| std::fs::read(entry.unwrap().path()).unwrap()).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{findings, numbers, tasks};

    fn fed(target: &str, extension: &str, seed: &str, feed: impl Fn(&std::path::Path)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fed").with_extension(extension);
        for bytes in findings(target).iter().map(Vec::as_slice).chain([seed.as_bytes()]) {
            fs::write(&path, bytes).unwrap();
            feed(&path);
        }
    }

    #[test]
    fn findings_stay_mended() {
        fed("csv", "csv", "q1,q2,q3\n0,1,2\n", numbers);
        fed("json", "json", "[[0, 1, 2]]", numbers);
        fed("parquet", "parquet", "PAR1", numbers);
        fed("tasks", "toml", "[[task]]\nframe = \"panda_hand\"\nxyz = [0.4, 0, 0.5]\n", tasks);
    }
}
