//! Overlays drawn on a mechanism: ellipsoids, screws and surfaces, computed by the library.
//!
//! Vectors to be drawn are scaled to metres in the world frame; the values are given separately.

mod ellipsoid;
mod lost;

use cylindroid::Vec3;
use cylindroid::screws::{Line, Screw, ScrewSystem};
use serde::Serialize;

use self::ellipsoid::{Ellipsoid, EllipsoidJson, ellipsoid};
use self::lost::{LostJson, lost};
use super::json::PoseJson;
use super::measures::Measures;
use super::names::Overlay;
use super::session::Session;
use crate::commands::screws::basis_screws::basis_screws;
use crate::output::ScrewJson;

/// Number of rulings of a cylindroid.
const RULINGS: usize = 72;

/// An overlay, or the reason why it is empty.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(untagged)]
pub(super) enum Shown {
    Empty(EmptyJson),
    Ellipsoid(EllipsoidJson),
    Axes(AxesJson),
    System(SystemJson),
    Reciprocal(ReciprocalJson),
    Cylindroid(CylindroidJson),
    Lost(LostJson),
}

/// An empty overlay with the reason.
fn empty(why: impl Into<String>) -> Shown {
    Shown::Empty(EmptyJson { empty: why.into() })
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Empty"))]
pub(super) struct EmptyJson {
    empty: String,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "JointAxes"))]
pub(super) struct AxesJson {
    axes: Vec<AxisJson>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "AxisScrew"))]
pub(super) struct AxisJson {
    name: String,
    screw: ScrewJson,
    actuated: bool,
    coordinate: Option<usize>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "PrincipalScrews"))]
pub(super) struct SystemJson {
    order: usize,
    gibson_hunt: &'static str,
    meaning: &'static str,
    ambiguous: bool,
    #[cfg_attr(test, ts(type = "(number | null)[]"))]
    principal_pitches: Vec<f64>,
    screws: Vec<ScrewJson>,
    canonical: PoseJson,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Reciprocal"))]
pub(super) struct ReciprocalJson {
    order: usize,
    gibson_hunt: &'static str,
    meaning: &'static str,
    screws: Vec<ScrewJson>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Cylindroid"))]
pub(super) struct CylindroidJson {
    #[cfg_attr(test, ts(type = "\"system\" | \"reciprocal\""))]
    of: &'static str,
    #[cfg_attr(test, ts(type = "[number | null, number | null]"))]
    pitches: [f64; 2],
    rulings: Vec<RulingJson>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Ruling"))]
struct RulingJson {
    from: [f64; 3],
    to: [f64; 3],
    #[cfg_attr(test, ts(type = "number | null"))]
    pitch: f64,
}

/// The overlay for the current state.
pub(super) fn shown(overlay: Overlay, session: &Session, measures: Option<&Measures>) -> Shown {
    let drawn = |kind| {
        let nothing = || empty("The actuated joints have no effect at the tool point here.");
        Ok(ellipsoid(session, kind)?.map_or_else(nothing, Shown::Ellipsoid))
    };
    let found = match overlay {
        Overlay::Velocity => drawn(Ellipsoid::Velocity),
        Overlay::AngularVelocity => drawn(Ellipsoid::AngularVelocity),
        Overlay::ActiveForce => drawn(Ellipsoid::ActiveForce),
        Overlay::PassiveForce => drawn(Ellipsoid::PassiveForce),
        Overlay::JointAxes => Ok(Shown::Axes(AxesJson { axes: axes(session) })),
        Overlay::PrincipalScrews => session.screw_system().map(|s| principal(&s)),
        Overlay::Reciprocal => session.screw_system().map(|s| reciprocal(&s)),
        Overlay::Cylindroid => session.screw_system().map(|s| cylindroid(&s)),
        Overlay::LostDirection => Ok(lost(session, measures).map_or_else(empty, Shown::Lost)),
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

fn principal(system: &ScrewSystem) -> Shown {
    match system.order() {
        0 => return empty("Nothing moves the tool: the system is empty."),
        6 => {
            return empty(
                "The tool moves in all six directions: every screw belongs to the system.",
            );
        }
        _ => {}
    }
    Shown::System(SystemJson {
        order: system.order(),
        gibson_hunt: system.class().name(),
        meaning: system.normal_form().meaning(),
        ambiguous: system.is_ambiguous(),
        principal_pitches: system.principal_pitches(),
        screws: system.principal_screws().iter().map(Into::into).collect(),
        canonical: system.canonical_pose().into(),
    })
}

fn reciprocal(system: &ScrewSystem) -> Shown {
    match system.order() {
        0 => return empty("Nothing moves the tool: every wrench is resisted by the structure."),
        6 => {
            return empty(
                "The tool moves in all six directions: no wrench is reciprocal to all motions.",
            );
        }
        _ => {}
    }
    Shown::Reciprocal(ReciprocalJson {
        order: 6 - system.order(),
        gibson_hunt: system.reciprocal().class().name(),
        meaning: system.reciprocal().normal_form().meaning(),
        screws: basis_screws(&system.reciprocal()).iter().map(Into::into).collect(),
    })
}

fn cylindroid(system: &ScrewSystem) -> Shown {
    let order = system.order();
    let pencil = system.pencil(RULINGS);
    if pencil.is_empty() {
        return empty(format!(
            "Only systems of order two or four (reciprocal) have a cylindroid; here {}.",
            match order {
                1 => "the order is one".to_owned(),
                n => format!("the order is {n}"),
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
