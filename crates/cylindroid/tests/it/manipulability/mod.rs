mod batch;
mod ellipsoid;
mod gradient;
mod metrics;
mod polytope;
mod reference;
mod serial;
