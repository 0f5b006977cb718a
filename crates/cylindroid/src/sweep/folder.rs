//! A sweep in a folder: a Parquet file for each part and a manifest, computed by several threads,
//! stopped and resumed.
//!
//! Why so   a part is written under another name, made durable and renamed, and a manifest of the
//!          finished parts follows within tenths of a second (more where writing it takes more
//!          than a twentieth of the time): whatever ends the process, the folder is a valid
//!          beginning. A resumed run computes the parts that are missing from the manifest
//!          or do not have its checksum. Each thread holds one part, so memory does not grow with
//!          the sweep
//! Checked  tests/sweep/folder.rs

use std::cell::{Cell, RefCell};
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::{Duration, Instant};

use super::job::Sweep;
use super::manifest::Part;
use super::parts::run_parts;
use super::shared_folder::SharedFolder;
use super::table::Values;
use crate::error::Result;

/// Shortest pause between two manifests.
const BETWEEN_MANIFESTS: Duration = Duration::from_millis(100);

/// Shortest pause between two manifests, in multiples of the time that the last one took.
const MANIFEST_COST: u32 = 20;

/// How a sweep is written.
#[derive(Debug, Clone, Copy, Default)]
pub struct WriteOptions {
    /// Threads: as many as the machine has by default. Results do not depend on them.
    pub threads: Option<NonZeroUsize>,
    /// Continues a folder of the same recipe.
    pub resume: bool,
}

/// The state of a running sweep, map or search for designs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is counted: "rows" of a sweep; of a map "starts" (random restarts that look for working
    /// modes), then "cells" of the modes that are known so far, then "seeds" of curves or "vertices" of
    /// surfaces; of a search evaluated "designs".
    pub unit: &'static str,
    /// Rows of the sweep, or how many there are of what is counted.
    pub rows: u64,
    /// True if there may be fewer: modes do not reach all cells, refinements end before they have
    /// evaluated all designs that they may. The time left is then that at most.
    pub at_most: bool,
    /// Rows in finished parts, those of earlier runs included.
    pub done: u64,
    /// Rows that this run computed.
    pub computed: u64,
}

impl Progress {
    /// At the beginning of a sweep of this many rows.
    pub(super) const fn of_rows(rows: u64) -> Self {
        Self { unit: "rows", rows, at_most: false, done: 0, computed: 0 }
    }
}

/// The result of writing a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Summary {
    /// Rows of the sweep.
    pub rows: u64,
    /// Rows that this run computed.
    pub computed: u64,
    /// Finished parts.
    pub parts: usize,
    /// Size of the finished parts (bytes).
    pub bytes: u64,
    /// False if the observer stopped the run.
    pub complete: bool,
}

impl Sweep {
    /// Writes `part-*.parquet` and `manifest.json` into a folder, which is created. `observe` is
    /// called ten times a second on the thread of the caller, until it returns false, which stops
    /// the run after the parts that are being computed.
    ///
    /// # Errors
    /// A folder that has a sweep already, without [`WriteOptions::resume`]; with it, one of another
    /// recipe, with the difference; one that another process is writing; a folder or disk that
    /// cannot be written. Finished parts remain valid after an error.
    pub fn write(
        &self,
        folder: &Path,
        options: &WriteOptions,
        mut observe: impl FnMut(&Progress) -> bool,
    ) -> Result<Summary> {
        let shared = SharedFolder::open(self, folder, options.resume)?;
        // Listed until they are verified, so that a stop meanwhile loses nothing.
        let parts = RefCell::new(shared.listed.clone());
        let state = Cell::new(Progress::of_rows(self.rows()));
        let finished = Cell::new(0);
        let (mut last, mut pause, mut noted) = (Instant::now(), BETWEEN_MANIFESTS, 0);
        let work = |memory: &mut Vec<Values>, part: usize| {
            self.write_part_with(memory, folder, part, shared.listed[part].as_ref())
        };
        let take = |part: usize, (own, computed): (Part, bool)| {
            let rows = self.rows_of(part);
            let (rows, before) = (rows.end - rows.start, state.get());
            let computed = before.computed + if computed { rows } else { 0 };
            state.set(Progress { done: before.done + rows, computed, ..before });
            finished.set(finished.get() + 1);
            parts.borrow_mut()[part] = Some(own);
        };
        let tick = || {
            if last.elapsed() >= pause && finished.get() > noted {
                noted = finished.get();
                let start = Instant::now();
                shared.write_manifest(self, &parts.borrow())?;
                last = Instant::now();
                pause = BETWEEN_MANIFESTS.max((last - start) * MANIFEST_COST);
            }
            Ok(observe(&state.get()))
        };
        let ended = run_parts(self.parts(), options.threads, work, take, tick);
        let parts = parts.into_inner();
        let written = shared.write_manifest(self, &parts);
        ended.and(written)?;
        Ok(Summary {
            rows: self.rows(),
            computed: state.get().computed,
            parts: finished.get(),
            bytes: parts.iter().flatten().map(|part| part.bytes).sum(),
            complete: finished.get() == parts.len(),
        })
    }
}
