//! Results written down. A change of the library that changes one of them fails here, and is either a
//! mistake or is written down again: `cargo xtask record`.
//!
//! Valid    Records say that a result is the same as before, not that it is right: laws, referees and
//!          published results are in the other tests. They watch over what no law determines, such as
//!          the number of rounds of a search, the start it takes and the way a motion goes
//! Why so   the inputs are random, so that rare branches are taken and units and frames are mixed

#![allow(clippy::unwrap_used, clippy::panic)] // a case that fails is named

mod algebra;
mod closure_mobility;
mod closure_position;
mod control;
mod geometry;
mod ik;
#[path = "../limits/one_task.rs"]
mod one_task;
mod record;
#[path = "../limits/robots.rs"]
#[allow(dead_code)] // used in part
mod robots;
#[path = "../limits/rounds.rs"]
#[allow(dead_code)] // used in part
mod rounds;
mod servo;
#[path = "../limits/watch.rs"]
#[allow(dead_code)] // used in part
mod watch;
