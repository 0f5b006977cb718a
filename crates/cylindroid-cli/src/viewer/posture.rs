//! The part of a state that its configuration determines: poses, singular values, loops, overlays.

use std::collections::BTreeMap;

use cylindroid::closure::LoopClosureError;
use cylindroid::{Pose, Result};
use serde::Serialize;

use super::bodies::DistancesJson;
use super::json::PoseJson;
use super::measures::Measures;
use super::names::Overlay;
use super::overlays::{Shown, shown};
use super::session::Session;

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Posture"))]
pub(super) struct PostureJson<'a> {
    q: &'a [f64],
    links: Vec<PoseJson>,
    tool: PoseJson,
    singular: Option<SingularJson>,
    outside_limits: Vec<usize>,
    loops: Vec<LoopJson>,
    contacts: Vec<ContactJson>,
    closure_error: Option<ClosureErrorJson>,
    #[cfg_attr(test, ts(type = "Partial<OverlayData>"))]
    overlays: BTreeMap<&'static str, Shown>,
    obstacles: Vec<PoseJson>,
    distances: Option<DistancesJson<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Singular"))]
struct SingularJson {
    values: Vec<f64>,
    threshold: f64,
    rank: usize,
    #[cfg_attr(test, ts(type = "number | null"))]
    gap: f64,
    ratio: f64,
    length: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LoopEnds"))]
struct LoopJson {
    a: [f64; 3],
    b: [f64; 3],
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ContactPoints"))]
struct ContactJson {
    point: [f64; 3],
    normal: [f64; 3],
    other: [f64; 3],
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ClosureError"))]
struct ClosureErrorJson {
    distance: f64,
    angle: f64,
    closed: bool,
}

/// Poses and measures of a session where it is, with these overlays, and the pairs of bodies that
/// are closer than `margin` (m).
pub(super) fn posture<'a>(
    session: &'a mut Session,
    measures: Option<&Measures>,
    overlays: &[Overlay],
    margin: Option<f64>,
) -> Result<PostureJson<'a>> {
    session.find_near(margin)?;
    let session = &*session;
    let (mechanism, state, options) = (session.mechanism(), session.state(), session.options());
    let poses: Vec<Pose> = mechanism
        .frame_ids()
        .take(mechanism.links().len())
        .map(|frame| state.pose(frame))
        .collect::<Result<_>>()?;
    let loops = mechanism.loops().iter().map(|l| LoopJson {
        a: (poses[l.a] * l.link_a_from_joint).translation.to_array(),
        b: (poses[l.b] * l.link_b_from_joint).translation.to_array(),
    });
    let contacts = mechanism.contacts().iter().map(|c| {
        let on_a = poses[c.a] * c.link_a_from_contact;
        ContactJson {
            point: on_a.translation.to_array(),
            normal: on_a.rotation.z_axis().to_array(),
            other: (poses[c.b] * c.link_b_from_contact).translation.to_array(),
        }
    });
    let closure_error =
        if mechanism.is_closed() { Some(LoopClosureError::of(state)?) } else { None };
    Ok(PostureJson {
        q: state.q(),
        links: poses.iter().map(|p| (*p).into()).collect(),
        tool: state.pose(options.end_effector)?.into(),
        singular: measures.map(|m| SingularJson {
            values: m.condition.inverse.singular_values.clone(),
            threshold: m.condition.inverse.threshold,
            rank: m.condition.inverse.rank,
            gap: m.condition.inverse.gap,
            ratio: m.condition.singular_ratio,
            length: m.length,
        }),
        outside_limits: mechanism.outside_limits(state.q()).collect(),
        loops: loops.collect(),
        contacts: contacts.collect(),
        closure_error: closure_error.map(|g| ClosureErrorJson {
            distance: g.distance,
            angle: g.angle,
            closed: g.is_closed(mechanism.reach()),
        }),
        overlays: overlays.iter().map(|o| (o.name(), shown(*o, session, measures))).collect(),
        obstacles: session.obstacles().iter().map(|o| o.world_from_shape.into()).collect(),
        distances: session.distances(margin),
    })
}
