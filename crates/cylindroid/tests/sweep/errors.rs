//! Errors of parts: of several that of the first part, whatever the threads.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use cylindroid::sweep::{OwnColumn, Source, Sweep, SweepOptions, WriteOptions};

/// Ten rows a part; parts 2 and 4 to 19 have an error, part 2 after the others.
fn failing() -> Sweep {
    let function = |q: &[f64]| {
        let part = (q[0] * 100.0).round();
        match part {
            2.0 => thread::sleep(Duration::from_millis(40)),
            4.0.. => {}
            _ => return Ok(vec![0.0; q.len() / 3]),
        }
        Err(format!("no number in part {part}"))
    };
    let column = OwnColumn {
        name: "mine".to_owned(),
        unit: "1".to_owned(),
        version: String::new(),
        function: Arc::new(function),
    };
    let q = (0..200).flat_map(|row| [f64::from(row / 10) / 100.0, 0.0, 0.0]);
    let options = SweepOptions {
        source: Source::Configurations(q.collect()),
        quantities: Vec::new(),
        columns: vec![column],
        part_rows: 10,
        ..Default::default()
    };
    Sweep::new(&cylindroid::load("3r").unwrap(), options).unwrap()
}

#[test]
fn of_several_errors_that_of_the_first_part_is_returned() {
    let sweep = failing();
    for count in [1, 2, 8] {
        let threads = count.try_into().ok();
        let folder = tempfile::tempdir().unwrap();
        let options = WriteOptions { threads, resume: false };
        let errors = [
            sweep.collect(threads, |_| true).unwrap_err(),
            sweep.statistics(threads, |_| true).unwrap_err(),
            sweep.write(folder.path(), &options, |_| true).unwrap_err(),
        ];
        for error in errors.map(|error| error.to_string()) {
            assert!(error.contains("rows 20 to 29: no number in part 2"), "{count}: {error}");
        }
        // What is finished is kept.
        assert!(folder.path().join("part-000001.parquet").exists());
        assert!(!folder.path().join("part-000002.parquet").exists());
    }
}
