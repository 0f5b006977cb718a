mod metrics;
mod polytope;
mod reference;
mod serial;
