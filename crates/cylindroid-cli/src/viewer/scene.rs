//! The message `scene`: links, joints, frames and choices of a session.

use cylindroid::control::NamedInverse;
use cylindroid::model::{Geometry, Link, Mechanism, Visual};
use cylindroid::{Pose, Servo};
use serde::Serialize;

use crate::output::MimicJson;

use super::beside::ModelBeside;
use super::inverse_parameters::{Chosen, PITCH};
use super::json::PoseJson;
use super::names::{Overlay, REPORTS};
use super::reaching::is_adjustable;
use super::session::Session;

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "scene")]
pub(super) struct Scene<'a> {
    name: &'a str,
    format: &'a str,
    closed: bool,
    #[cfg_attr(test, ts(type = "2 | 3"))]
    dimension: usize,
    reach: f64,
    links: Vec<LinkJson<'a>>,
    joints: Vec<JointJson<'a>>,
    coordinates: Vec<CoordinateJson<'a>>,
    frames: Vec<FrameJson<'a>>,
    frame: &'a str,
    task: TaskJson<'a>,
    loops: Vec<LoopJson<'a>>,
    contacts: Vec<ContactJson<'a>>,
    objects: Vec<ObjectJson<'a>>,
    actuators: Vec<ActuatorJson<'a>>,
    self_motions: usize,
    method: &'a Chosen,
    methods: Vec<ChoiceJson>,
    overlays: Vec<OverlayJson>,
    #[cfg_attr(test, ts(type = "ReportName[]"))]
    reports: [&'static str; 4],
    home: &'a [f64],
    obstacles: Vec<ObstacleJson<'a>>,
    avoidance: Option<AvoidanceJson>,
    beside: &'a [ModelBeside],
    ignored: usize,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Obstacle"))]
struct ObstacleJson<'a> {
    name: &'a str,
    #[serde(flatten)]
    shape: ShapeJson<'a>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Avoidance"))]
struct AvoidanceJson {
    gap: f64,
    margin: f64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneLink"))]
struct LinkJson<'a> {
    name: &'a str,
    visuals: Vec<VisualJson<'a>>,
    collisions: Vec<CollisionJson<'a>>,
    anchors: Vec<AnchorJson<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Visual"))]
struct VisualJson<'a> {
    #[serde(flatten)]
    shape: ShapeJson<'a>,
    pose: PoseJson,
    rgba: Option<[f64; 4]>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "CollisionShape"))]
struct CollisionJson<'a> {
    #[serde(flatten)]
    shape: ShapeJson<'a>,
    pose: PoseJson,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Shape"))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(super) enum ShapeJson<'a> {
    Box {
        size: [f64; 3],
    },
    Cylinder {
        radius: f64,
        length: f64,
    },
    Capsule {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    Ellipsoid {
        radii: [f64; 3],
    },
    HalfSpace,
    Mesh {
        url: Option<String>,
        #[cfg_attr(test, ts(type = "\"stl\" | \"dae\" | \"obj\" | null"))]
        format: Option<&'static str>,
        scale: [f64; 3],
        uri: &'a str,
        problem: Option<String>,
    },
}

/// A point of a link, in its frame.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Anchor"))]
struct AnchorJson<'a> {
    name: &'a str,
    kind: AnchorKind,
    position: [f64; 3],
}

#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
enum AnchorKind {
    Joint,
    Child,
    Loop,
    Contact,
    Frame,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneJoint"))]
struct JointJson<'a> {
    name: &'a str,
    #[cfg_attr(test, ts(type = "JointKind"))]
    kind: &'static str,
    parent: usize,
    child: usize,
    origin: PoseJson,
    axis: [f64; 3],
    coordinates: Vec<usize>,
    actuated: bool,
    mimic: Option<MimicJson<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Coordinate"))]
struct CoordinateJson<'a> {
    name: &'a str,
    joint: usize,
    #[cfg_attr(test, ts(type = "\"rad\" | \"m\""))]
    unit: &'static str,
    #[cfg_attr(test, ts(type = "number | null"))]
    lower: f64,
    #[cfg_attr(test, ts(type = "number | null"))]
    upper: f64,
    #[cfg_attr(test, ts(type = "number | null"))]
    velocity: f64,
    actuated: bool,
    adjustable: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneFrame"))]
struct FrameJson<'a> {
    name: &'a str,
    link: usize,
    /// In the frame of the link.
    pose: PoseJson,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneTask"))]
struct TaskJson<'a> {
    name: &'a str,
    components: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneLoop"))]
struct LoopJson<'a> {
    name: &'a str,
    #[cfg_attr(test, ts(type = "JointKind"))]
    kind: &'static str,
    a: usize,
    b: usize,
    axis: [f64; 3],
    actuated: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneContact"))]
struct ContactJson<'a> {
    name: &'a str,
    kind: &'static str,
    a: usize,
    b: usize,
    friction: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "SceneObject"))]
struct ObjectJson<'a> {
    link: usize,
    name: &'a str,
    reference: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Actuator"))]
struct ActuatorJson<'a> {
    name: &'a str,
    #[cfg_attr(test, ts(type = "JointKind"))]
    kind: &'static str,
    actuated: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Method"))]
struct ChoiceJson {
    name: &'static str,
    description: &'static str,
    parameters: Vec<ParameterJson>,
    pitch: bool,
    servo: bool,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Parameter"))]
struct ParameterJson {
    name: &'static str,
    unit: &'static str,
    default: f64,
    description: &'static str,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "OverlayInfo"))]
struct OverlayJson {
    #[cfg_attr(test, ts(type = "OverlayName"))]
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    frame: &'static str,
}

impl<'a> Scene<'a> {
    pub(super) fn of(session: &'a Session) -> Self {
        let mechanism = session.mechanism();
        let options = session.options();
        let link = |i: usize| mechanism.links()[i].name.as_str();
        let joints = mechanism.joints().iter().map(|j| JointJson {
            name: &j.name,
            kind: j.kind.name(),
            parent: j.parent,
            child: j.child,
            origin: j.parent_from_joint.into(),
            axis: j.axis.to_array(),
            coordinates: j.coordinates.clone().collect(),
            actuated: j.actuated,
            mimic: j.mimic.as_ref().map(MimicJson::from),
        });
        let coordinates = mechanism.coordinates().iter().map(|c| CoordinateJson {
            name: &c.name,
            joint: c.joint,
            unit: c.kind.unit(),
            lower: c.limits.lower,
            upper: c.limits.upper,
            velocity: c.limits.velocity,
            actuated: c.actuated,
            adjustable: is_adjustable(mechanism, c),
        });
        let loops = mechanism.loops().iter().map(|l| LoopJson {
            name: &l.name,
            kind: l.kind.name(),
            a: l.a,
            b: l.b,
            axis: l.axis.to_array(),
            actuated: l.actuated,
        });
        let contacts = mechanism.contacts().iter().map(|c| ContactJson {
            name: &c.name,
            kind: c.kind.name(),
            a: c.a,
            b: c.b,
            friction: c.friction,
        });
        let all = cylindroid::ik::Task::COMPONENTS.into_iter().zip(options.task.components);
        Self {
            name: mechanism.name(),
            format: mechanism.report().format,
            closed: mechanism.is_closed(),
            dimension: mechanism.dimension().number(),
            reach: mechanism.reach(),
            links: links(session),
            joints: joints.collect(),
            coordinates: coordinates.collect(),
            frames: mechanism
                .frames()
                .iter()
                .map(|f| FrameJson { name: &f.name, link: f.link, pose: f.link_from_frame.into() })
                .collect(),
            frame: session.frame(),
            task: TaskJson {
                name: session.task_name(),
                components: all.filter(|(_, on)| *on).map(|(name, _)| name).collect(),
            },
            loops: loops.collect(),
            contacts: contacts.collect(),
            objects: objects(mechanism)
                .into_iter()
                .map(|(i, reference)| ObjectJson { link: i, name: link(i), reference })
                .collect(),
            actuators: actuators(mechanism),
            self_motions: session.servo().map_or(0, Servo::redundancy),
            method: session.method(),
            methods: methods(session),
            overlays: Overlay::ALL.into_iter().map(overlay).collect(),
            reports: REPORTS,
            home: session.home(),
            obstacles: obstacles(session),
            avoidance: session.avoided().map(|(gap, margin)| AvoidanceJson { gap, margin }),
            beside: session.beside(),
            ignored: mechanism.report().ignored.len(),
        }
    }
}

fn overlay(o: Overlay) -> OverlayJson {
    OverlayJson { name: o.name(), title: o.title(), unit: o.unit(), frame: o.frame() }
}

/// All inverses except those that need a complement, which the page cannot specify.
fn methods(session: &Session) -> Vec<ChoiceJson> {
    let whole = session.options().task.components == [true; 6];
    let choice = |inverse: NamedInverse| {
        let own = inverse.parameters.iter().filter(|p| p.name != PITCH);
        ChoiceJson {
            name: inverse.name,
            description: inverse.description,
            parameters: own
                .map(|p| ParameterJson {
                    name: p.name,
                    unit: p.unit,
                    default: p.default,
                    description: p.description,
                })
                .collect(),
            pitch: inverse.is_partial,
            servo: !inverse.is_partial || whole,
        }
    };
    NamedInverse::all().filter(|i| !i.takes_complement).map(choice).collect()
}

fn links(session: &Session) -> Vec<LinkJson<'_>> {
    let mechanism = session.mechanism();
    let mut all: Vec<LinkJson<'_>> = mechanism
        .links()
        .iter()
        .map(|l| LinkJson {
            name: &l.name,
            visuals: visuals(session, l),
            collisions: collisions(session, l),
            anchors: Vec::new(),
        })
        .collect();
    let mut add = |link: usize, name, kind, pose: Pose| {
        all[link].anchors.push(AnchorJson { name, kind, position: pose.translation.to_array() });
    };
    for j in mechanism.joints() {
        add(j.child, &j.name, AnchorKind::Joint, j.joint_from_child.inverse());
        add(j.parent, &j.name, AnchorKind::Child, j.parent_from_joint);
    }
    for l in mechanism.loops() {
        add(l.a, &l.name, AnchorKind::Loop, l.link_a_from_joint);
        add(l.b, &l.name, AnchorKind::Loop, l.link_b_from_joint);
    }
    for c in mechanism.contacts() {
        add(c.a, &c.name, AnchorKind::Contact, c.link_a_from_contact);
        add(c.b, &c.name, AnchorKind::Contact, c.link_b_from_contact);
    }
    let controlled = mechanism.frame_of(session.options().end_effector.frame);
    let tool = controlled.link_from_frame * session.options().end_effector.frame_from_tool;
    add(controlled.link, &controlled.name, AnchorKind::Frame, tool);
    all
}

fn visuals<'a>(session: &'a Session, link: &'a Link) -> Vec<VisualJson<'a>> {
    let visual = |v: &'a Visual| {
        let (pose, rgba) = (v.link_from_shape.into(), v.rgba);
        Some(VisualJson { shape: shape(session, &v.geometry)?, pose, rgba })
    };
    link.visuals.iter().filter_map(visual).collect()
}

fn collisions<'a>(session: &'a Session, link: &'a Link) -> Vec<CollisionJson<'a>> {
    let all = link.collisions.iter();
    all.filter_map(|c| {
        Some(CollisionJson { shape: shape(session, &c.geometry)?, pose: c.link_from_shape.into() })
    })
    .collect()
}

fn obstacles(session: &Session) -> Vec<ObstacleJson<'_>> {
    let all = session.obstacles().iter();
    // Arguments and messages have no other shapes.
    all.filter_map(|o| Some(ObstacleJson { name: &o.name, shape: shape(session, &o.shape)? }))
        .collect()
}

/// `None`: a kind of shape that the page cannot draw.
fn shape<'a>(session: &'a Session, geometry: &'a Geometry) -> Option<ShapeJson<'a>> {
    Some(match geometry {
        Geometry::Box { size } => ShapeJson::Box { size: size.to_array() },
        Geometry::Cylinder { radius, length } => {
            ShapeJson::Cylinder { radius: *radius, length: *length }
        }
        Geometry::Capsule { radius, length } => {
            ShapeJson::Capsule { radius: *radius, length: *length }
        }
        Geometry::Sphere { radius } => ShapeJson::Sphere { radius: *radius },
        Geometry::Ellipsoid { radii } => ShapeJson::Ellipsoid { radii: radii.to_array() },
        Geometry::HalfSpace => ShapeJson::HalfSpace,
        Geometry::Mesh { uri, path, scale } => {
            let served = session.folders().served(uri, path.as_deref());
            ShapeJson::Mesh {
                url: served.url,
                format: served.format,
                scale: scale.to_array(),
                uri,
                problem: served.problem,
            }
        }
        _ => return None,
    })
}

/// The link of the reference frame, then the other links in contact.
fn objects(mechanism: &Mechanism) -> Vec<(usize, bool)> {
    if !mechanism.is_closed() {
        return Vec::new();
    }
    let mut all = vec![(mechanism.frame_of(mechanism.reference()).link, true)];
    for contact in mechanism.contacts() {
        if all.iter().all(|(link, _)| *link != contact.b) {
            all.push((contact.b, false));
        }
    }
    all
}

/// The joints that can be actuated: movable, and no mimic joints.
fn actuators(mechanism: &Mechanism) -> Vec<ActuatorJson<'_>> {
    if !mechanism.is_closed() {
        return Vec::new();
    }
    let tree = mechanism.joints().iter().filter(|j| j.kind.dof() > 0 && j.mimic.is_none());
    let tree =
        tree.map(|j| ActuatorJson { name: &j.name, kind: j.kind.name(), actuated: j.actuated });
    let closing = mechanism.loops().iter().filter(|l| l.kind.dof() == 1);
    let closing =
        closing.map(|l| ActuatorJson { name: &l.name, kind: l.kind.name(), actuated: l.actuated });
    tree.chain(closing).collect()
}
