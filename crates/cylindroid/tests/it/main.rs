//! The laws of the library: exact relations, finite differences, singular poses, bad input.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp_const
)]

mod analytic;
mod batch;
mod closure;
mod fixed_joints;
mod graph;
mod hyperbolic;
mod ik;
mod ik_criteria;
mod ik_goals;
mod ik_half_spaces;
mod ik_invariance;
mod ik_long_slides;
mod ik_misses;
mod ik_wide_limits;
mod inverse;
mod inverse_batch;
mod joint_axes;
mod kinematics;
mod linkages;
mod magnitudes;
mod manipulability;
mod mass_matrix;
mod model;
mod parameters;
mod pinocchio;
mod relative_jacobian;
mod screws;
mod servo;
mod simd;
mod spatial;
mod subspaces;
mod support;
mod svd;
mod symmetric_eigen;
mod theory;
mod waypoints;
