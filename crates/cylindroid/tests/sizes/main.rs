//! Zero is a size: every public function of the library, called with no and with one joint, link,
//! drive, loop, contact, row, sample and name, returns a result or an error.
//!
//! `calls` lists the functions, and `cargo xtask small-sizes` compares the list with the sources:
//! a new public function is an error until it is there. Arguments are drawn at random from values of
//! their types (`seeds`), to which results of earlier calls are added; a function whose arguments
//! never occur is an error as well. What a function documents as a panic is checked at its line.

#![allow(clippy::unwrap_used)] // helpers of tests stop where tests do

mod argument;
mod calls;
mod seeds;
mod values;
mod world;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::panic::{set_hook, take_hook};

use world::{Outcome, World};

const ROUNDS: usize = 3;
/// Calls of each function in a round.
const TIMES: usize = 20;

thread_local! {
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

#[test]
fn every_call_of_small_sizes_returns() {
    let folder = tempfile::tempdir().unwrap();
    let mut world = World::new();
    seeds::fill(&mut world, folder.path());
    let mut waiting: BTreeMap<&str, &str> = BTreeMap::new();
    let mut panics: BTreeMap<(&str, String), String> = BTreeMap::new();
    let usual = take_hook();
    set_hook(Box::new(|info| {
        let place = info.location().map(|l| format!("{}:{}", l.file(), l.line()));
        PANIC.with_borrow_mut(|text| *text = place.unwrap_or_default());
    }));
    let functions = calls::all();
    for round in 0..ROUNDS {
        for function in &functions {
            for _ in 0..TIMES {
                match function.call(&mut world) {
                    Outcome::Returned => {
                        waiting.remove(function.path);
                    }
                    Outcome::Missing(what) => {
                        if round == 0 {
                            waiting.insert(function.path, what);
                        }
                        break;
                    }
                    Outcome::Panicked(arguments) => {
                        let place = PANIC.with_borrow(String::clone);
                        panics.entry((function.path, place)).or_insert(arguments);
                    }
                }
            }
        }
    }
    set_hook(usual);
    for ((path, place), arguments) in &panics {
        println!("{path}({arguments}) panics at {place}");
    }
    for (path, what) in &waiting {
        println!("{path} was never called: no {what}");
    }
    assert!(panics.is_empty() && waiting.is_empty());
}

#[test]
fn functions_are_listed_once() {
    let paths: Vec<&str> = calls::all().iter().map(|f| f.path).collect();
    assert_eq!(paths.iter().collect::<BTreeSet<_>>().len(), paths.len());
}
