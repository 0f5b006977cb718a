mod bad_input;
mod case;
mod laws;
mod mobility;
mod reference;
mod singularity;
mod statics;
