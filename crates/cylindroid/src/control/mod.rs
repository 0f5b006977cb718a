//! Cartesian control: the servo loop, its limits, its secondary tasks, time laws and paths.

mod drive;
mod limits;
mod options;
mod saturation;
mod secondary;
mod servo;
mod stall;

pub use drive::{Outcome, Sample, drive};
pub use limits::{LimitKind, Motion1, RateBounds};
pub use options::{Gain, Projector, ServoOptions, Speed, Task, Tolerance};
pub use saturation::Saturation;
pub use secondary::Secondary;
pub use servo::{Servo, Status, Step, Target};
pub use stall::Stall;
