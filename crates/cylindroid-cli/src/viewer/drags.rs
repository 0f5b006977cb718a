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
    /// `None` for messages that move nothing by hand.
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
