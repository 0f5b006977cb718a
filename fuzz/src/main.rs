//! Coverage-guided fuzzing with libFuzzer. `CYLINDROID_FUZZ_TARGET` names the target; one program has
//! them all, since each would link the whole library again.

#![no_main]
#![allow(dead_code)] // of the shared files of tests

#[path = "../../crates/cylindroid/tests/formats/mutation.rs"]
mod mutation;
#[path = "../../crates/cylindroid/tests/limits/one_task.rs"]
mod one_task;
#[path = "../../crates/cylindroid/tests/limits/robots.rs"]
mod robots;
#[path = "../../crates/cylindroid/tests/limits/rounds.rs"]
mod rounds;
mod target;
#[path = "../../crates/cylindroid/tests/formats/use_of_files.rs"]
mod use_of_files;
#[path = "../../crates/cylindroid/tests/limits/watch.rs"]
mod watch;

use std::time::Duration;

use cpu_time::ThreadTime;
use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

use crate::mutation::{Random, mutate};
use crate::target::Target;

/// Processor time of one input; the instrumented program is slower than the library.
const PATIENCE: Duration = Duration::from_secs(4);

fuzz_target!(|data: &[u8]| {
    let start = ThreadTime::now();
    Target::of_environment().run(data);
    let spent = start.elapsed();
    assert!(spent < PATIENCE, "{spent:?} of processor time");
});

// For texts half of the changes are those of the tests, which know numbers and words.
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut random = Random(u64::from(seed));
    if !Target::of_environment().is_text() || random.below(2) == 0 {
        return fuzzer_mutate(data, size, max_size);
    }
    let mut bytes = data[..size].to_vec();
    let own = bytes.clone();
    mutate(&mut bytes, &own, &mut random);
    let size = bytes.len().min(max_size);
    data[..size].copy_from_slice(&bytes[..size]);
    size
});
