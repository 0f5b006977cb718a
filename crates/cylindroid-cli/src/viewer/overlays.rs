//! What is drawn over a mechanism: ellipsoids, screws and surfaces, from the library's answers.
//!
//! Vectors are in metres of the world, as long as they are to be drawn; numbers stand beside them.

mod ellipsoid;
mod lost;

use cylindroid::closure::ClosedChain;
use cylindroid::kinematics::Chain;
use cylindroid::screws::{Line, Screw, ScrewOptions, ScrewSystem};
use cylindroid::{Error, ReferenceFrame, Result, Twist, Vec3};
use serde::Serialize;

use self::ellipsoid::{Ellipsoid, EllipsoidJson, ellipsoid};
use self::lost::{LostJson, lost};
use super::scene::PoseJson;
use super::session::Session;
use super::snapshot::Measures;
use crate::commands::screws::report::reciprocal_screws;
use crate::output::ScrewJson;

/// Screws of a cylindroid that are drawn.
const RULINGS: usize = 72;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Overlay {
    Velocity,
    AngularVelocity,
    ActiveForce,
    PassiveForce,
    JointAxes,
    PrincipalScrews,
    Reciprocal,
    Cylindroid,
    LostDirection,
}

impl Overlay {
    pub(super) const ALL: [Self; 9] = [
        Self::Velocity,
        Self::AngularVelocity,
        Self::ActiveForce,
        Self::PassiveForce,
        Self::JointAxes,
        Self::PrincipalScrews,
        Self::Reciprocal,
        Self::Cylindroid,
        Self::LostDirection,
    ];

    pub(super) fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|o| o.name() == name);
        found.ok_or_else(|| Error::unknown("overlay", name, Self::ALL.map(Self::name)))
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity-ellipsoid",
            Self::AngularVelocity => "angular-velocity-ellipsoid",
            Self::ActiveForce => "active-force-ellipsoid",
            Self::PassiveForce => "passive-force-ellipsoid",
            Self::JointAxes => "joint-axes",
            Self::PrincipalScrews => "principal-screws",
            Self::Reciprocal => "reciprocal-system",
            Self::Cylindroid => "cylindroid",
            Self::LostDirection => "lost-direction",
        }
    }

    pub(super) const fn title(self) -> &'static str {
        match self {
            Self::Velocity => "Velocity ellipsoid",
            Self::AngularVelocity => "Angular velocity ellipsoid",
            Self::ActiveForce => "Force ellipsoid, exerted (active)",
            Self::PassiveForce => "Force ellipsoid, resisted (passive)",
            Self::JointAxes => "Joint axes as screws",
            Self::PrincipalScrews => "Principal screws",
            Self::Reciprocal => "Reciprocal system",
            Self::Cylindroid => "Cylindroid of a two-system",
            Self::LostDirection => "Lost direction",
        }
    }

    pub(super) const fn unit(self) -> &'static str {
        match self {
            Self::Velocity => "m/s, for rates of the drives of length 1 (rad/s, m/s)",
            Self::AngularVelocity => "rad/s, for rates of the drives of length 1 (rad/s, m/s)",
            Self::ActiveForce => "N, for torques of the drives of length 1 (N m, N)",
            Self::PassiveForce => "N, held with torques of the drives of length 1 (N m, N)",
            Self::JointAxes | Self::PrincipalScrews | Self::Reciprocal => "pitch in m/rad",
            Self::Cylindroid => "pitch in m/rad, along each axis",
            Self::LostDirection => "m and rad, of length 1 with lengths over the reach",
        }
    }

    pub(super) const fn frame(self) -> &'static str {
        match self {
            Self::Velocity | Self::AngularVelocity | Self::LostDirection => {
                "at the tool point, world axes"
            }
            Self::ActiveForce | Self::PassiveForce => {
                "forces at the tool point without moment, world axes"
            }
            Self::JointAxes | Self::PrincipalScrews | Self::Reciprocal | Self::Cylindroid => {
                "seen from the world"
            }
        }
    }
}

/// An overlay, or why there is nothing to see.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Shown {
    Empty { empty: String },
    Ellipsoid(EllipsoidJson),
    Axes { axes: Vec<AxisJson> },
    System(SystemJson),
    Reciprocal(ReciprocalJson),
    Cylindroid(CylindroidJson),
    Lost(LostJson),
}

/// Nothing, in a sentence.
fn empty(why: impl Into<String>) -> Shown {
    Shown::Empty { empty: why.into() }
}

#[derive(Debug, Serialize)]
pub(super) struct AxisJson {
    name: String,
    screw: ScrewJson,
    actuated: bool,
    coordinate: Option<usize>,
}

#[derive(Debug, Serialize)]
pub(super) struct SystemJson {
    order: usize,
    gibson_hunt: &'static str,
    meaning: &'static str,
    ambiguous: bool,
    principal_pitches: Vec<f64>,
    screws: Vec<ScrewJson>,
    canonical: PoseJson,
}

#[derive(Debug, Serialize)]
pub(super) struct ReciprocalJson {
    order: usize,
    gibson_hunt: &'static str,
    meaning: &'static str,
    screws: Vec<ScrewJson>,
}

#[derive(Debug, Serialize)]
pub(super) struct CylindroidJson {
    of: &'static str,
    pitches: [f64; 2],
    rulings: Vec<RulingJson>,
}

#[derive(Debug, Serialize)]
struct RulingJson {
    from: [f64; 3],
    to: [f64; 3],
    pitch: f64,
}

/// The overlay as it is now.
pub(super) fn shown(overlay: Overlay, session: &Session, measures: Option<&Measures>) -> Shown {
    let found = match overlay {
        Overlay::Velocity => ellipsoid(session, Ellipsoid::Velocity),
        Overlay::AngularVelocity => ellipsoid(session, Ellipsoid::AngularVelocity),
        Overlay::ActiveForce => ellipsoid(session, Ellipsoid::ActiveForce),
        Overlay::PassiveForce => ellipsoid(session, Ellipsoid::PassiveForce),
        Overlay::JointAxes => Ok(Shown::Axes { axes: axes(session) }),
        Overlay::PrincipalScrews => system(session).map(|s| principal(&s)),
        Overlay::Reciprocal => system(session).map(|s| reciprocal(&s)),
        Overlay::Cylindroid => system(session).map(|s| cylindroid(&s)),
        Overlay::LostDirection => Ok(lost(session, measures)),
    };
    found.unwrap_or_else(|error| empty(error.to_string()))
}

/// The screws of all joints.
fn axes(session: &Session) -> Vec<AxisJson> {
    let (mechanism, state) = (session.mechanism(), session.state());
    let mut all = Vec::new();
    for (i, joint) in mechanism.joints().iter().enumerate() {
        for (c, screw) in joint.coordinates.clone().zip(state.joint_screws(i)) {
            let own = &mechanism.coordinates()[c];
            let name = if joint.mimic.is_some() { &joint.name } else { &own.name };
            let (screw, actuated) = ((&screw).into(), own.actuated);
            all.push(AxisJson { name: name.clone(), screw, actuated, coordinate: Some(c) });
        }
    }
    for (i, closing) in mechanism.loops().iter().enumerate() {
        let screws = state.loop_screws(i);
        all.extend(screws.iter().map(|screw| AxisJson {
            name: closing.name.clone(),
            screw: screw.into(),
            actuated: closing.actuated,
            coordinate: None,
        }));
    }
    all
}

/// The screw system of what moves the tool: of the joints of a tree, of the motions that a closed
/// chain leaves its object.
pub(super) fn system(session: &Session) -> Result<ScrewSystem> {
    let (mechanism, state) = (session.mechanism(), session.state());
    let of = session.options().end_effector;
    let twists = if mechanism.is_closed() {
        ClosedChain::of(state, Some(of.frame), None)?.reference_twists(state)
    } else {
        let jacobian = state.jacobian(of, ReferenceFrame::World);
        let column = |&c: &usize| Twist::from_array(std::array::from_fn(|i| jacobian.column(c)[i]));
        Chain::new(mechanism, of).coordinates().iter().map(column).collect()
    };
    ScrewSystem::of(&twists, &ScrewOptions::with_length(mechanism.reach()))
}

fn principal(system: &ScrewSystem) -> Shown {
    match system.order() {
        0 => return empty("Nothing moves the tool: the system is empty."),
        6 => return empty("The tool moves in all six ways: every screw belongs to the system."),
        _ => {}
    }
    Shown::System(SystemJson {
        order: system.order(),
        gibson_hunt: system.class().name(),
        meaning: system.class().meaning(),
        ambiguous: system.is_ambiguous(),
        principal_pitches: system.principal_pitches(),
        screws: system.principal_screws().iter().map(Into::into).collect(),
        canonical: system.canonical_pose().into(),
    })
}

fn reciprocal(system: &ScrewSystem) -> Shown {
    match system.order() {
        0 => return empty("Nothing moves the tool: every wrench is held."),
        6 => return empty("The tool moves in all six ways: no wrench is held without work."),
        _ => {}
    }
    Shown::Reciprocal(ReciprocalJson {
        order: 6 - system.order(),
        gibson_hunt: system.reciprocal().class().name(),
        meaning: system.reciprocal().class().meaning(),
        screws: reciprocal_screws(system).iter().map(Into::into).collect(),
    })
}

fn cylindroid(system: &ScrewSystem) -> Shown {
    let order = system.order();
    let pencil = system.pencil(RULINGS);
    if pencil.is_empty() {
        return empty(format!(
            "A system of two screws, or one that is reciprocal to two, has a cylindroid; here {}.",
            match order {
                1 => "there is one screw".to_owned(),
                n => format!("there are {n}"),
            }
        ));
    }
    let far = 10.0 * system.length();
    let origin = system.canonical_pose().translation;
    let near = |s: &Screw| Line { point: s.axis.nearest(origin), ..s.axis };
    let axes: Vec<(Line, f64)> = pencil
        .iter()
        .filter(|s| !s.is_translation())
        .map(|s| (near(s), s.pitch))
        .filter(|(line, pitch)| (line.point - origin).norm() < far && pitch.abs() < far)
        .collect();
    if axes.is_empty() {
        return empty("All screws of the system are translations: there are no axes.");
    }
    let height = axes.iter().map(|(l, _)| (l.point - origin).norm()).fold(0.0, f64::max);
    let half = (1.6 * height).max(0.25 * system.length());
    let end = |p: Vec3| p.to_array();
    let rulings = axes.iter().map(|(l, pitch)| RulingJson {
        from: end(l.point - l.direction * half),
        to: end(l.point + l.direction * half),
        pitch: *pitch,
    });
    let pitches = || axes.iter().map(|(_, h)| *h);
    let least = pitches().fold(f64::INFINITY, f64::min);
    let largest = pitches().fold(f64::NEG_INFINITY, f64::max);
    Shown::Cylindroid(CylindroidJson {
        of: if order == 4 { "reciprocal" } else { "system" },
        pitches: [least, largest],
        rulings: rulings.collect(),
    })
}
