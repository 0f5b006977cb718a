mod batch;
mod gradient;
mod metrics;
mod polytope;
mod reference;
mod serial;
