//! The servo's singular values at a session's configuration.

use cylindroid::control::ConditionReport;

use super::session::Session;

/// The conditioning of the configuration, as reported by the servo.
#[derive(Debug)]
pub(super) struct Measures {
    pub(super) condition: ConditionReport,
    pub(super) length: f64,
}

impl Measures {
    /// `None` without a servo.
    pub(super) fn of(session: &mut Session) -> Option<Self> {
        let q = session.state().q().to_vec();
        let length = session.options().length;
        let condition = session.servo_mut()?.condition(&q).ok()?;
        Some(Self { condition, length })
    }
}
