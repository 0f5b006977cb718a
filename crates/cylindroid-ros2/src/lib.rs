//! A ROS 2 node around the servo of cylindroid, over DDS in Rust: it builds without a ROS
//! installation.
//!
//! Read `parameters`, then `controller`, which turns messages into commands and knows nothing of
//! DDS, and `node`, the loop at a fixed rate. `topics` are the subscriptions and publications,
//! `network` the domain and the interfaces that they may use.

pub mod controller;
pub mod joints;
pub mod messages;
pub mod network;
pub mod node;
pub mod parameters;
mod record;
pub mod report;
mod servo_options;
mod signals;
mod targets;
mod topics;
mod transforms;
