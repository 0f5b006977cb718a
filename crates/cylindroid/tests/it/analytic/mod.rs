//! Inverse kinematics by formulas against forward kinematics, and against the search.

mod answers;
mod arms;
mod law;
mod search;
mod singular;
