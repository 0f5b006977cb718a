//! Statistics of the columns of a sweep, without its rows.
//!
//! Formula  smallest, mean and largest of the finite numbers; how many others; how often each name.
//!          Sums are those of the parts in their order, so that threads change no digit
//! Checked  tests/sweep/quantities.rs::statistics_are_those_of_the_table,
//!          tests/sweep/pinocchio.rs

use std::num::NonZeroUsize;
use std::ops::Range;

use super::designs::VALID;
use super::job::Sweep;
use super::parts::run_parts;
use super::source::REACHED;
use super::table::{Table, Values};
use super::{Column, Progress};
use crate::error::Result;

/// Statistics of a column.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Statistics {
    /// Of numbers; NaN where none is finite.
    Numbers {
        /// Smallest finite number.
        smallest: f64,
        /// Mean of the finite numbers.
        mean: f64,
        /// Largest finite number.
        largest: f64,
        /// How many are infinite or NaN.
        not_finite: u64,
    },
    /// How often each name occurs, in the order of the alphabet.
    Texts(Vec<(&'static str, u64)>),
}

#[derive(Debug, Clone)]
enum Sum {
    Numbers { smallest: f64, sum: f64, largest: f64, finite: u64, not_finite: u64 },
    Texts(Vec<(&'static str, u64)>),
}

impl Sum {
    /// Of those of these rows that there are.
    fn of_rows(values: &Values, rows: Range<usize>) -> Self {
        let of = |length: usize| rows.start.min(length)..rows.end.min(length);
        match values {
            Values::Numbers(numbers) => Self::numbers(&numbers[of(numbers.len())], |x| x),
            Values::Counts(counts) => Self::numbers(&counts[of(counts.len())], |c| c as f64),
            Values::Texts(texts) => {
                let mut own = Self::Texts(Vec::new());
                texts[of(texts.len())].iter().for_each(|text| own.count(text, 1));
                own
            }
        }
    }

    /// Of those of these rows that are present: others have no counts and no names.
    fn of_present(values: &Values, present: &[bool], rows: Range<usize>) -> Self {
        let is_present = present.iter().copied();
        match values {
            Values::Numbers(_) => Self::of_rows(values, rows),
            Values::Counts(counts) => {
                let all = counts.iter().skip(rows.start).zip(is_present);
                let number = |(count, is): (&u64, bool)| if is { *count as f64 } else { f64::NAN };
                Self::numbers(&all.map(number).collect::<Vec<_>>(), |x| x)
            }
            Values::Texts(texts) => {
                let mut sum = Self::Texts(Vec::new());
                let all = texts.iter().skip(rows.start).zip(is_present).filter(|(_, is)| *is);
                all.for_each(|(text, _)| sum.count(text, 1));
                sum
            }
        }
    }

    /// In lanes, each of which sums every eighth number: a sum does not wait for the one before.
    fn numbers<T: Copy>(all: &[T], number: impl Fn(T) -> f64) -> Self {
        const LANES: usize = 8;
        let mut lanes = [(f64::INFINITY, 0.0, f64::NEG_INFINITY, 0_u64); LANES];
        let mut add = |lane: usize, x: T| {
            let (smallest, sum, largest, finite) = &mut lanes[lane];
            let x = number(x);
            let counts = x.abs() < f64::INFINITY;
            *sum += if counts { x } else { 0.0 };
            *smallest = if counts && x < *smallest { x } else { *smallest };
            *largest = if counts && x > *largest { x } else { *largest };
            *finite += u64::from(counts);
        };
        let (eights, rest) = all.as_chunks::<LANES>();
        for eight in eights {
            for (lane, x) in eight.iter().enumerate() {
                add(lane, *x);
            }
        }
        for (lane, x) in rest.iter().enumerate() {
            add(lane, *x);
        }
        let finite: u64 = lanes.iter().map(|lane| lane.3).sum();
        let mut own = Self::Numbers {
            smallest: f64::INFINITY,
            sum: 0.0,
            largest: f64::NEG_INFINITY,
            finite: 0,
            not_finite: all.len() as u64 - finite,
        };
        for (smallest, sum, largest, finite) in lanes {
            own.add(&Self::Numbers { smallest, sum, largest, finite, not_finite: 0 });
        }
        own
    }

    fn count(&mut self, text: &'static str, times: u64) {
        let Self::Texts(own) = self else { return };
        match own.binary_search_by(|(name, _)| name.cmp(&text)) {
            Ok(place) => own[place].1 += times,
            Err(place) => own.insert(place, (text, times)),
        }
    }

    fn add(&mut self, other: &Self) {
        match (&mut *self, other) {
            (
                Self::Numbers { smallest, sum, largest, finite, not_finite },
                Self::Numbers {
                    smallest: least,
                    sum: more,
                    largest: most,
                    finite: f,
                    not_finite: n,
                },
            ) => {
                (*smallest, *largest) = (smallest.min(*least), largest.max(*most));
                (*sum, *finite, *not_finite) = (*sum + more, *finite + f, *not_finite + n);
            }
            (_, Self::Texts(texts)) => texts.iter().for_each(|(text, n)| self.count(text, *n)),
            _ => {}
        }
    }

    fn statistics(self) -> Statistics {
        match self {
            Self::Texts(texts) => Statistics::Texts(texts),
            Self::Numbers { finite: 0, not_finite, .. } => {
                let none = f64::NAN;
                Statistics::Numbers { smallest: none, mean: none, largest: none, not_finite }
            }
            Self::Numbers { smallest, sum, largest, finite, not_finite } => {
                Statistics::Numbers { smallest, mean: sum / finite as f64, largest, not_finite }
            }
        }
    }
}

impl Sweep {
    /// The statistics of every column but `index`, with its name and unit. `threads` and `observe`
    /// as in [`Sweep::write`]; `None` if `observe` stopped the run.
    ///
    /// # Errors
    /// As [`Sweep::table`].
    pub fn statistics(
        &self,
        threads: Option<NonZeroUsize>,
        mut observe: impl FnMut(&Progress) -> bool,
    ) -> Result<Option<Vec<(Column, Statistics)>>> {
        let mut parts: Vec<Option<Vec<Sum>>> = vec![None; self.parts()];
        let progress = std::cell::Cell::new(Progress::of_rows(self.rows()));
        let work = |values: &mut Vec<Values>, part: usize| {
            self.fill(self.rows_of(part), values)?;
            Ok(self.sums(values, 0..usize::MAX))
        };
        let finished = |part: usize, sums| {
            let rows = self.rows_of(part);
            let (before, more) = (progress.get(), rows.end - rows.start);
            let (done, computed) = (before.done + more, before.computed + more);
            progress.set(Progress { done, computed, ..before });
            parts[part] = Some(sums);
        };
        run_parts(self.parts(), threads, work, finished, || Ok(observe(&progress.get())))?;
        let parts: Option<Vec<Vec<Sum>>> = parts.into_iter().collect();
        Ok(parts.map(|parts| self.of_parts(parts)))
    }

    /// The same of all rows, which were collected.
    #[must_use]
    pub fn statistics_of(&self, table: &Table) -> Vec<(Column, Statistics)> {
        let part = |part: usize| {
            let rows = self.rows_of(part);
            let at = |row: u64| usize::try_from(row).unwrap_or(usize::MAX);
            let rows = at(rows.start)..at(rows.end);
            self.sums(&table.values, rows)
        };
        self.of_parts((0..self.parts()).map(part).collect())
    }

    /// True for a column that says whether a row has results, those in the columns after it.
    fn says_presence(&self, column: &Column) -> bool {
        match column.name.as_str() {
            VALID => self.designs.is_some(),
            REACHED => self.configurations.of_poses(),
            "closed" => self.configurations.of_closed_samples(),
            _ => false,
        }
    }

    /// Of these rows of all columns but `index`. Rows of designs without a mechanism, of poses that are
    /// not reached and of samples of a closed chain without a configuration have no counts and names.
    fn sums(&self, values: &[Values], rows: Range<usize>) -> Vec<Sum> {
        let mut present: Option<Vec<bool>> = None;
        let mut sums = Vec::with_capacity(values.len());
        for (column, all) in self.columns.iter().zip(values).skip(1) {
            sums.push(match &present {
                Some(present) => Sum::of_present(all, present, rows.clone()),
                None => Sum::of_rows(all, rows.clone()),
            });
            if let (true, Values::Counts(own)) = (self.says_presence(column), all) {
                let own = &own[rows.start.min(own.len())..rows.end.min(own.len())];
                let before = present.get_or_insert_with(|| vec![true; own.len()]);
                before.iter_mut().zip(own).for_each(|(is, own)| *is &= *own != 0);
            }
        }
        sums
    }

    fn of_parts(&self, parts: Vec<Vec<Sum>>) -> Vec<(Column, Statistics)> {
        let mut all: Option<Vec<Sum>> = None;
        for part in parts {
            match &mut all {
                None => all = Some(part),
                Some(all) => all.iter_mut().zip(&part).for_each(|(sum, more)| sum.add(more)),
            }
        }
        let columns = self.columns.iter().skip(1).cloned();
        let statistics = all.into_iter().flatten().map(Sum::statistics);
        columns.zip(statistics).collect()
    }
}
