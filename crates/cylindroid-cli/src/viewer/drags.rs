//! What clients move, for a program that waits for it: of each thing only the newest.

use cylindroid::Pose;

use super::messages::Message;
use super::session::Session;

/// Something that somebody has moved on a page.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Drag {
    /// The target, to this `world_from_target`.
    Target(Pose),
    /// Joints, to this configuration.
    Configuration(Vec<f64>),
    /// An obstacle, to this `world_from_obstacle`.
    Obstacle {
        /// Its name.
        name: String,
        /// Its new pose.
        pose: Pose,
    },
}

impl Drag {
    fn is_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Target(_), Self::Target(_))
            | (Self::Configuration(_), Self::Configuration(_)) => true,
            (Self::Obstacle { name, .. }, Self::Obstacle { name: other, .. }) => name == other,
            _ => false,
        }
    }
}

/// What a message moves.
#[derive(Debug)]
pub(super) enum Moves {
    Target,
    Configuration,
    Obstacle(String),
}

impl Moves {
    /// `None` for messages that move nothing by hand, or that let the servo do it: `by_steps`.
    pub(super) fn of(message: &Message) -> Option<Self> {
        match message {
            Message::Target(_) => Some(Self::Target),
            Message::Joint(_) | Message::Configuration(_) | Message::Reset(_) => {
                Some(Self::Configuration)
            }
            Message::MoveObstacle(moved) => Some(Self::Obstacle(moved.name.clone())),
            _ => None,
        }
    }

    /// What the next steps of the servo move by hand: the target while the tool follows a twist or
    /// brakes after it, joints while they move with the tool at rest.
    pub(super) fn by_steps(session: &Session) -> Option<Self> {
        if session.twist().is_some() {
            Some(Self::Target)
        } else if session.self_motion() != 0.0 {
            Some(Self::Configuration)
        } else {
            None
        }
    }

    /// Where it is in the session.
    pub(super) fn drag(self, session: &Session) -> Option<Drag> {
        Some(match self {
            Self::Target => Drag::Target(session.target()),
            Self::Configuration => Drag::Configuration(session.state().q().to_vec()),
            Self::Obstacle(name) => {
                let found = session.obstacles().iter().find(|o| o.name == name)?;
                Drag::Obstacle { pose: found.world_from_shape, name }
            }
        })
    }
}

/// The newest drags, in the order in which the first of each came.
#[derive(Debug, Default)]
pub(super) struct Drags(Vec<Drag>);

impl Drags {
    pub(super) fn put(&mut self, drag: Drag) {
        match self.0.iter_mut().find(|waiting| waiting.is_of_same(&drag)) {
            Some(waiting) => *waiting = drag,
            None => self.0.push(drag),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn take(&mut self) -> Vec<Drag> {
        std::mem::take(&mut self.0)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    use cylindroid::catalogue;
    use tokio::runtime::Builder;

    use super::super::mailbox::Mailbox;
    use super::super::messages::read;
    use super::super::shared_session::{Program, SharedSession};
    use super::super::start::{Start, StartBodies};
    use super::*;

    const PATIENCE: Duration = Duration::from_secs(60);

    /// What a program of a panda is told after these messages, until it has enough.
    fn told(messages: &[&str], mut is_enough: impl FnMut(&[Drag], &Session) -> bool) -> Vec<Drag> {
        let robot = catalogue::load("panda").unwrap();
        let (q, tool) = (robot.home().to_vec(), robot.tool().into());
        let start = Start::new((robot, "panda"), &q, tool, &[], StartBodies::default()).unwrap();
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_time().build().unwrap();
        let _inside = runtime.enter();
        let program = Some(Program::default());
        let shared = SharedSession::begin(Arc::new(start), None, program).unwrap();
        let client = shared.join(Arc::new(Mailbox::default()), false);
        for message in messages {
            assert!(client.obey(read(message).unwrap()).is_ok(), "{message}");
        }
        let (begin, mut all) = (Instant::now(), Vec::new());
        while !shared.read(|inner| is_enough(&all, &inner.session)) {
            assert!(begin.elapsed() < PATIENCE, "{all:?}");
            all.extend(shared.next_drags(Duration::from_millis(100)).unwrap());
        }
        all
    }

    /// The tool follows the twist, then brakes: the last target is that of the robot at rest.
    #[test]
    fn a_twist_moves_the_target_until_the_robot_rests() {
        let twist = r#"{"type": "twist", "linear": [0, 0.1, 0], "angular": [0, 0, 0]}"#;
        let mut last = None;
        let all = told(&[twist], |all, session| {
            last = Some(Drag::Target(session.target()));
            session.is_resting() && all.last() == last.as_ref()
        });
        let places: Vec<f64> = all
            .iter()
            .map(|drag| match drag {
                Drag::Target(pose) => pose.translation.y,
                other => panic!("{other:?}"),
            })
            .collect();
        assert!(places.len() > 1, "{places:?}");
        assert!(places.windows(2).all(|two| two[0] < two[1] + 1e-9), "{places:?}");
        assert!(places[places.len() - 1] > 0.01, "{places:?}");
    }

    #[test]
    fn a_self_motion_moves_joints() {
        let all = told(&[r#"{"type": "null_space", "rate": 0.5}"#], |all, _| all.len() > 3);
        let joints: Vec<&Vec<f64>> = all
            .iter()
            .map(|drag| match drag {
                Drag::Configuration(q) => q,
                other => panic!("{other:?}"),
            })
            .collect();
        assert!(joints.windows(2).all(|two| two[0] != two[1]), "{joints:?}");
    }

    /// A target that the servo moves to is moved once, by hand.
    #[test]
    fn steps_to_a_target_move_nothing_by_hand() {
        let target =
            r#"{"type": "target", "position": [0.4, 0.1, 0.5], "quaternion": [0, 1, 0, 0]}"#;
        let all = told(&[target], |all, session| !all.is_empty() && session.is_resting());
        assert!(matches!(all[..], [Drag::Target(_)]), "{all:?}");
    }
}
