mod bad_input;
pub(crate) mod case;
mod laws;
mod mobility;
mod reference;
mod singularity;
mod statics;
