//! Mobility and singularities of closed chains: counts, bases, branches, modes, screws of limbs.

mod aligned;
mod chains;
mod digest;
mod finite;
mod limbs;
mod loops;
mod matrices;
mod modes;
mod parallel;
mod singular;
