//! Loop-closure constraints: from joints, contacts and the reference link to one matrix equation.
//!
//! `velocity_constraint` is the equation `J_a q_a + J_p q_p = G^T u` with its scales;
//! `constraint_rows` makes a row of each wrench that a loop joint or contact constrains;
//! `closed_chain` puts the rows of a mechanism together. Read them in this order.
//! `rate_rank` decides the rank of rows.
//! `closed_chain_batched` computes the same rows for several configurations at once.

pub(crate) mod closed_chain;
pub(crate) mod closed_chain_batched;
pub(crate) mod constraint_rows;
pub(crate) mod loop_closure_error;
pub(crate) mod rate_rank;
pub(crate) mod velocity_constraint;
