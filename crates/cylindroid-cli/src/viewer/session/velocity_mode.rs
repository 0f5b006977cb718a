//! A session in velocity mode: the tool follows a twist while commands arrive, then it brakes.

use cylindroid::control::{Status, TwistStatus};
use cylindroid::{Error, Result, Twist};

use super::super::avoidance::LastStep;
use super::super::messages::Complaint;
use super::twist_command::Driven;
use super::{REST, Session};

impl Session {
    /// The twist that is followed, world axes, at the tool; zero while the servo brakes.
    pub(in super::super) fn twist(&self) -> Option<Twist> {
        self.driven.as_ref().map(Driven::desired)
    }

    /// Follows a twist until the next command or until this one is too old.
    pub(in super::super) fn follow(&mut self, twist: Twist) -> std::result::Result<(), Complaint> {
        Error::check_finite("twist", &twist.to_array()).map_err(|e| Complaint::of("twist", &e))?;
        if !self.is_playing {
            let way_out = "send play, then the twist";
            return Err(Complaint::new("twist", "pause", "the servo is paused", way_out));
        }
        self.driven = Some(Driven { twist, is_new: true, age: 0.0 });
        self.self_motion = None;
        // Velocities are kept: commands follow one another.
        (self.last, self.trouble) = (None, None);
        self.is_resting = false;
        Ok(())
    }

    /// A step of velocity mode; at rest the target is at the tool.
    pub(super) fn step_driven(&mut self, q: &mut [f64]) -> Result<()> {
        let (Ok(servo), Some(driven)) = (&mut self.servo, &mut self.driven) else { return Ok(()) };
        let last = match &mut self.avoidance {
            Some((_, Ok(avoidance))) => avoidance.follow(q, driven.desired())?,
            _ => {
                let command = driven.is_new.then_some(driven.twist);
                let step = servo.step_twist(q, command)?;
                servo.advance(q);
                let (status, stall) = match step.status {
                    TwistStatus::AtRest => (Status::Reached, None),
                    TwistStatus::Braking | TwistStatus::Following => (Status::Moving, None),
                    TwistStatus::Stalled => (Status::Stalled, Some(servo.stall())),
                };
                LastStep { status, stall, pair: None }
            }
        };
        driven.is_new = false;
        driven.age += self.options.dt;
        let is_over = driven.desired() == Twist::ZERO;
        self.steps += 1;
        if is_over && self.velocities().iter().all(|rate| rate.abs() < REST) {
            (self.driven, self.is_resting) = (None, true);
            self.last = Some(LastStep { status: Status::Reached, stall: None, pair: None });
            self.rest();
        } else {
            self.last = Some(last);
        }
        Ok(())
    }

    fn velocities(&self) -> &[f64] {
        match (&self.servo, &self.avoidance) {
            (_, Some((_, Ok(avoidance)))) => avoidance.joint_velocities(),
            (Ok(servo), _) => servo.joint_velocities(),
            _ => &[],
        }
    }
}
