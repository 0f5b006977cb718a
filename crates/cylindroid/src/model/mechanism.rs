//! The mechanism: one immutable graph of links, joints and frames, cheap to clone and to share.
//!
//! Checked  tests/it/graph.rs, tests/it/kinematics.rs

use std::sync::Arc;

use super::contact::Contact;
use super::dimension::Dimension;
use super::elasticity::Elasticity;
use super::joint::{Joint, Limits};
use super::link::Link;
use super::loop_joint::LoopJoint;
use super::magnitude;
use super::node::{Node, NodeKind};
use super::report::LoadReport;
use super::tool_choice::ToolChoice;
use crate::error::{Error, Result, all_within};
use crate::scalar::fnv1a;
use crate::spatial::{Pose, Rotation, Twist, Vec3, exp};
use crate::tolerance::MAX_MAGNITUDE;

/// A robot or mechanism. Immutable; clones share the data.
#[derive(Debug, Clone)]
pub struct Mechanism {
    pub(super) data: Arc<Data>,
}

#[derive(Debug, Clone)]
pub(super) struct Data {
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    pub(super) loops: Vec<LoopJoint>,
    /// Names of loop joints that may be open at home.
    pub(super) unassembled: Vec<String>,
    pub(super) contacts: Vec<Contact>,
    pub(super) dimension: Dimension,
    pub(super) reference: FrameId,
    pub(super) frames: Vec<Frame>,
    /// Hash of the frame names, which identifies the mechanism of a frame.
    pub(super) frame_key: u64,
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) nodes: Vec<Node>,
    pub(super) home: Vec<f64>,
    pub(super) tool: FrameId,
    pub(super) tool_choice: ToolChoice,
    pub(super) reach: f64,
    pub(super) far: f64,
    pub(super) elasticity: Elasticity,
    pub(super) disabled_collisions: Vec<[usize; 2]>,
    pub(super) report: LoadReport,
}

/// One entry of `q`.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// The joint's name; with a suffix (`.x`, `.slide`, `.rx`, ...) where the joint has several.
    pub name: String,
    /// Index of the joint.
    pub joint: usize,
    /// Its kind.
    pub kind: CoordinateKind,
    /// Its limits, narrowed by those of mimic joints that follow it.
    pub limits: Limits,
    /// True if it is actuated.
    pub actuated: bool,
}

/// The kind of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CoordinateKind {
    /// Angle (rad).
    Angle,
    /// Length (m).
    Length,
    /// Component of a rotation vector (rad); its rate is an angular velocity in child axes.
    RotationVector,
    /// Position of a free body (m); its rate is a velocity in child axes.
    Position,
}

impl CoordinateKind {
    /// True for metres, false for radians.
    #[must_use]
    pub const fn is_length(self) -> bool {
        matches!(self, Self::Length | Self::Position)
    }

    /// Its SI unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        if self.is_length() { "m" } else { "rad" }
    }
}

/// A named frame on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Its name; link frames have the name of the link.
    pub name: String,
    /// The link it is fixed to.
    pub link: usize,
    /// Its pose on the link.
    pub link_from_frame: Pose,
    /// Slot of the moving frame that carries it (0: ground), and its pose there.
    pub(crate) slot: usize,
    pub(crate) slot_from_frame: Pose,
}

/// Identifies a frame of one mechanism, or of another whose frames have the same names in the same
/// order. From [`Mechanism::frame`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FrameId {
    pub(super) index: usize,
    pub(super) frame_key: u64,
}

/// FNV-1a over the names, each terminated by a byte that no name contains.
pub(super) fn frame_key(frames: &[Frame]) -> u64 {
    fnv1a(frames.iter().flat_map(|f| f.name.bytes().chain([0xff])))
}

impl Mechanism {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.data.name
    }

    /// Number of coordinates: entries of `q` and of the joint velocities.
    #[must_use]
    pub fn n(&self) -> usize {
        self.data.coordinates.len()
    }

    /// The coordinates, in the order of `q`.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.data.coordinates
    }

    /// The name of velocity `i` of a servo: of a coordinate, from n on of an actuated loop joint; or
    /// nothing.
    #[must_use]
    pub fn velocity_name(&self, i: usize) -> &str {
        let closing = self.data.loops.iter().filter(|l| l.actuated).map(|l| &l.name);
        let mut all = self.data.coordinates.iter().map(|c| &c.name).chain(closing);
        all.nth(i).map_or("", |name| name)
    }

    /// The links, root first.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.data.links
    }

    /// The joints of the spanning tree, parents before children: all that have coordinates.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.data.joints
    }

    /// The loop joints, in the order of the file.
    #[must_use]
    pub fn loops(&self) -> &[LoopJoint] {
        &self.data.loops
    }

    /// The loop joints that a file gives by two frames and that may be open at home: none after
    /// loading, which assembles home.
    #[must_use]
    pub fn unassembled(&self) -> &[String] {
        &self.data.unassembled
    }

    /// The contacts, in the order of the file.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.data.contacts
    }

    /// True if loops or contacts constrain `q`.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        !(self.data.loops.is_empty() && self.data.contacts.is_empty())
    }

    /// Its dimension: the plane x-y or space.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.data.dimension
    }

    /// The frame whose motion is the goal (reference): twist and wrench of its link are taken at
    /// its origin, in world axes. The file's reference, otherwise the tool.
    #[must_use]
    pub fn reference(&self) -> FrameId {
        self.data.reference
    }

    /// The actuated coordinates (indices into `q`). An actuated loop joint has no coordinate; see
    /// [`Mechanism::loops`].
    pub fn actuated(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.n()).filter(|&i| self.data.coordinates[i].actuated)
    }

    /// The limits of the coordinate or loop joint of this name.
    ///
    /// ```
    /// let five_bar = cylindroid::catalogue::load("five-bar")?;
    /// assert_eq!(five_bar.limits_of("q1").unwrap().velocity, 2.0);
    /// assert!(five_bar.limits_of("q5").unwrap().velocity.is_infinite()); // closes the loop
    /// assert_eq!(five_bar.limits_of("q6"), None);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn limits_of(&self, name: &str) -> Option<Limits> {
        let coordinate = self.data.coordinates.iter().find(|c| c.name == name);
        let closing = || self.data.loops.iter().find(|l| l.name == name).map(|l| l.limits);
        coordinate.map(|c| c.limits).or_else(closing)
    }

    /// The frames: link frames first, then named ones.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.data.frames
    }

    /// A frame by name.
    ///
    /// ```
    /// let robot = cylindroid::load("panda")?;
    /// let hand = robot.frame("hand_tcp")?;
    /// assert_eq!(robot.frame_of(hand).name, "hand_tcp");
    /// assert!(robot.frame("hand").is_err()); // the message lists the nearest names
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// The name of a joint is that of the frame it moves, where this is the frame of its child, as
    /// in URDF.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn frame(&self, name: &str) -> Result<FrameId> {
        let named = self.data.frames.iter().position(|f| f.name == name);
        let moved = |j: &&Joint| j.name == name && j.joint_from_child == Pose::IDENTITY;
        let of_joint = || self.data.joints.iter().find(moved).map(|j| j.child);
        let index = named.or_else(of_joint).ok_or_else(|| {
            Error::unknown("frame", name, self.data.frames.iter().map(|f| f.name.as_str()))
        })?;
        Ok(FrameId { index, frame_key: self.data.frame_key })
    }

    /// The ids of all frames, in the order of [`Mechanism::frames`].
    pub fn frame_ids(&self) -> impl Iterator<Item = FrameId> + '_ {
        let frame_key = self.data.frame_key;
        (0..self.data.frames.len()).map(move |index| FrameId { index, frame_key })
    }

    /// The frame of a link: those of the links come first.
    pub(crate) fn link_frame(&self, link: usize) -> FrameId {
        FrameId { index: link, frame_key: self.data.frame_key }
    }

    /// The frame of an id.
    ///
    /// # Panics
    /// If the id belongs to another mechanism; [`Mechanism::check_frame`] checks this.
    #[must_use]
    pub fn frame_of(&self, id: FrameId) -> &Frame {
        assert!(self.owns(id), "the frame is not one of mechanism '{}'", self.name());
        &self.data.frames[id.index]
    }

    /// Returns an error for the id of a frame of another mechanism.
    ///
    /// # Errors
    /// [`Error::InvalidOption`].
    pub fn check_frame(&self, id: FrameId) -> Result<()> {
        if self.owns(id) {
            return Ok(());
        }
        Err(Error::InvalidOption {
            option: "frame",
            value: format!("number {} of another mechanism", id.index),
            reason: format!("ask this one for it, with frame(name) of '{}'", self.name()),
        })
    }

    fn owns(&self, id: FrameId) -> bool {
        id.frame_key == self.data.frame_key && id.index < self.data.frames.len()
    }

    /// The default frame (tool): that of the file, otherwise the one that its name suggests (`tcp`,
    /// `tool`, `gripper`, ...), otherwise the end of the longest chain; see [`ToolChoice`].
    #[must_use]
    pub fn tool(&self) -> FrameId {
        self.data.tool
    }

    /// The home configuration: that of the file, otherwise zero, or the middle of limits that
    /// exclude zero. Zero for closed chains, whose loops close there.
    #[must_use]
    pub fn home(&self) -> &[f64] {
        &self.data.home
    }

    /// The load report: what was read and what was ignored.
    #[must_use]
    pub fn report(&self) -> &LoadReport {
        &self.data.report
    }

    pub(crate) fn nodes(&self) -> &[Node] {
        &self.data.nodes
    }

    /// Returns an error for a `q` of the wrong size or with non-finite values, naming the joint.
    ///
    /// ```
    /// let robot = cylindroid::load("ur5e")?;
    /// let mut q = robot.home().to_vec();
    /// q[1] = f64::NAN;
    /// let error = robot.check_q("start", &q).unwrap_err();
    /// assert!(error.to_string().contains("start[1]"));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Dimension`], [`Error::NotFinite`], [`Error::OutOfRange`].
    pub fn check_q(&self, what: &str, q: &[f64]) -> Result<()> {
        if q.len() != self.n() {
            let names: Vec<&str> = self.data.coordinates.iter().map(|c| c.name.as_str()).collect();
            return Err(Error::Dimension {
                what: what.to_owned(),
                expected: self.n(),
                got: q.len(),
                hint: format!("in this order: {}", names.join(", ")),
            });
        }
        if all_within(q, MAX_MAGNITUDE) {
            return Ok(());
        }
        magnitude::check(q, |i| format!("{what}[{i}] ({})", self.data.coordinates[i].name))
    }

    /// Number of configurations in `rows`.
    pub(crate) fn count_rows(&self, what: &str, rows: &[f64]) -> Result<usize> {
        let n = self.n();
        if rows.len().checked_rem(n).unwrap_or(rows.len()) != 0 {
            return Err(Error::rows(what, rows.len().next_multiple_of(n.max(1)), rows.len(), n));
        }
        Ok(rows.len().checked_div(n).unwrap_or(0))
    }

    /// Returns an error for rows of n values with a non-finite one, naming row and joint.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::OutOfRange`]; [`Error::Dimension`] for an incomplete last row.
    pub fn check_rows(&self, what: &str, rows: &[f64]) -> Result<()> {
        if all_within(rows, MAX_MAGNITUDE) {
            return Ok(());
        }
        let mut rows = rows.chunks(self.n().max(1)).enumerate();
        rows.try_for_each(|(i, row)| self.check_q(&format!("{what}[{i}]"), row))
    }

    /// Coordinates outside their position limits; NaN is outside.
    ///
    /// ```
    /// let robot = cylindroid::load("panda")?;
    /// let mut q = robot.home().to_vec();
    /// q[3] = 1.0; // the elbow cannot bend that way
    /// assert_eq!(robot.outside_limits(&q).collect::<Vec<_>>(), [3]);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    pub fn outside_limits<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
        self.data
            .coordinates
            .iter()
            .zip(q)
            .enumerate()
            .filter(|(_, (c, x))| !(c.limits.lower..=c.limits.upper).contains(*x))
            .map(|(i, _)| i)
    }

    /// `q` after `dt` seconds at constant joint velocities: `q + dt * rates`, with rotation vectors
    /// and free bodies integrated on their group.
    ///
    /// ```
    /// let robot = cylindroid::load("ur5e")?;
    /// let q = robot.integrate(&[0.0; 6], &[0.1, 0.0, 0.0, 0.0, 0.0, -0.2], 0.5)?;
    /// assert_eq!(q, [0.05, 0.0, 0.0, 0.0, 0.0, -0.1]);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Mechanism::check_q`].
    pub fn integrate(&self, q: &[f64], rates: &[f64], dt: f64) -> Result<Vec<f64>> {
        self.check_q("q", q)?;
        self.check_q("rates", rates)?;
        Error::check_within("dt", &[dt], MAX_MAGNITUDE)?;
        self.check_q("dt * rates", &rates.iter().map(|x| dt * x).collect::<Vec<_>>())?;
        let mut next = q.to_vec();
        self.integrate_in_place(&mut next, rates, dt);
        Ok(next)
    }

    /// [`Mechanism::integrate`] without validation and allocation.
    pub(crate) fn integrate_in_place(&self, q: &mut [f64], rates: &[f64], dt: f64) {
        for (i, coordinate) in self.data.coordinates.iter().enumerate() {
            if matches!(coordinate.kind, CoordinateKind::Angle | CoordinateKind::Length) {
                q[i] += rates[i] * dt;
            }
        }
        for node in self.nodes() {
            let c = node.coordinate;
            match node.kind {
                NodeKind::Fixed
                | NodeKind::Revolute
                | NodeKind::Prismatic
                | NodeKind::Helical(_) => {}
                NodeKind::Spherical => {
                    let here = Rotation::exp(vec3(q, c));
                    let turn = Rotation::exp(vec3(rates, c) * dt);
                    let next = if node.multiplier < 0.0 { turn * here } else { here * turn };
                    put(q, c, next.renormalised().log());
                }
                NodeKind::Free => {
                    let here =
                        Pose { rotation: Rotation::exp(vec3(q, c + 3)), translation: vec3(q, c) };
                    let twist = Twist { linear: vec3(rates, c), angular: vec3(rates, c + 3) };
                    let next = here * exp(twist * dt);
                    put(q, c, next.translation);
                    put(q, c + 3, next.rotation.renormalised().log());
                }
            }
        }
    }
}

fn vec3(x: &[f64], i: usize) -> Vec3 {
    Vec3::new(x[i], x[i + 1], x[i + 2])
}

fn put(x: &mut [f64], i: usize, v: Vec3) {
    x[i..i + 3].copy_from_slice(&v.to_array());
}
