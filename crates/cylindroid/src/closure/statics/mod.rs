//! Statics: joint torques, contact forces and grasps in equilibrium.
//!
//! `joint_torques` balances a wrench by torques, `contact_forces` by forces at the contacts;
//! `transmitted_wrenches` combines these forces into one wrench for each loop joint and contact.
//! `internal_force_relation` relates torques to the contact forces that they cause without a wrench,
//! `elastic_chain` adds the deflections of joints and links to the constraint.
//! `force_closure` computes the quality of a grasp, by `smallest_support` where a hull is not
//! enough; `grasp_contacts` reads the contacts from a mechanism. `grasp_mobility` decides whether
//! the fingers immobilise the object: `contact_gap` computes the gaps to second order,
//! `equilibrium_forces` the forces that balance each other, `relative_curvature` their forms and
//! `central_path` the one that blocks all motions, and `separating_direction` an escape. Read them in
//! this order.

mod central_path;
pub(crate) mod contact_forces;
mod contact_gap;
pub(crate) mod elastic_chain;
mod equilibrium_forces;
pub(crate) mod force_closure;
pub(crate) mod grasp_contacts;
pub(crate) mod grasp_mobility;
pub(crate) mod internal_force_relation;
pub(crate) mod joint_torques;
mod nearest_point;
mod relative_curvature;
mod separating_direction;
mod smallest_support;
pub(crate) mod transmitted_wrenches;
