mod any_matrices;
mod bad_input;
pub(crate) mod case;
mod grasp;
mod laws;
mod mobility;
mod reference;
mod singularity;
mod statics;
