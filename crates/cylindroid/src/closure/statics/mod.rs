//! Statics: joint torques, contact forces and grasps in equilibrium.
//!
//! `joint_torques` balances a wrench by torques, `contact_forces` by forces at the contacts;
//! `transmitted_wrenches` combines these forces into one wrench for each loop joint and contact.
//! `internal_force_relation` relates torques to the contact forces that they cause without a wrench,
//! `elastic_chain` adds the deflections of joints and links to the constraint.
//! `force_closure` computes the quality of a grasp, by `smallest_support` where a hull is not
//! enough; `grasp_contacts` reads the contacts from a mechanism. Read them in this order.

pub(crate) mod contact_forces;
pub(crate) mod elastic_chain;
pub(crate) mod force_closure;
pub(crate) mod grasp_contacts;
pub(crate) mod internal_force_relation;
pub(crate) mod joint_torques;
mod smallest_support;
pub(crate) mod transmitted_wrenches;
