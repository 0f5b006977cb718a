//! The C ABI of cylindroid: mechanisms, states, Jacobians, inverse kinematics, the servo, batches,
//! mobility and inverses, for C and C++ programs.
//!
//! The functions check their arguments, call the library and write numbers; no mathematics is here.
//! `include/cylindroid.h` is generated from these files, `include/cylindroid.hpp` wraps it for C++17.
//!
//! - `status`: status codes, the text of the last error, and the guard that no panic passes
//! - `arguments`: pointers as slices and poses
//! - `mechanism`, `state`, `ik`, `servo`, `batch`, `analysis`: one file per handle
//!
//! Checked  tests/header.rs, tests/programs.rs

#![allow(
    unsafe_code, // pointers of C; each function states what it requires
    non_camel_case_types, // the names of C
    clippy::missing_safety_doc, // stands once, in the header and in `arguments`
)]

mod analysis;
mod arguments;
mod batch;
mod ik;
mod mechanism;
mod servo;
mod state;
mod status;

pub use analysis::*;
pub use arguments::{CYL_DEFAULT_FRAME, cyl_reference};
pub use batch::*;
pub use ik::*;
pub use mechanism::*;
pub use servo::*;
pub use state::*;
pub use status::*;
