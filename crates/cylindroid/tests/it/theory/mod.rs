//! The counterexamples of the theory chapters of the book (docs/theory), and that every test which
//! they name exists.

mod closed_chains;
mod control;
mod pages;
mod paper_order;
mod screws;
mod sources;
