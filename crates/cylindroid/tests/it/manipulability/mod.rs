mod metrics;
mod reference;
mod serial;
