//! Denavit-Hartenberg arms: rows of four numbers to joints.
//!
//! Formula  standard  (i-1)_from_i = Rz(theta) Tz(d) Tx(a) Rx(alpha), joint i along z of i-1
//!          modified  (i-1)_from_i = Rx(alpha) Tx(a) Rz(theta) Tz(d), joint i along z of i
//!          q adds to theta (revolute) or to d (prismatic), a flipped joint subtracts it: the
//!          numbers of a row hold at q = 0
//! Units    a, d in m; alpha, theta in rad
//! Why so   a link's frame lies on the axis of its joint. In the standard convention a row's
//!          Tx(a) Rx(alpha) is therefore part of the next joint's placement, and the frame after
//!          the last row, the flange, is a link of its own; likewise in the modified convention
//! Source   Denavit & Hartenberg 1955; Craig, Introduction to Robotics, 1986 (modified)
//! Checked  tests/formats/dh.rs (against the product of the 4 x 4 matrices)

use crate::model::{JointKind, JointSpec, Limits};
use crate::spatial::{Pose, Rotation, Rpy, Vec3};

/// The Denavit-Hartenberg convention of the rows: standard or modified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Denavit & Hartenberg, Paul, Siciliano: joint i rotates about z of frame i - 1.
    Standard,
    /// Craig, Khalil: joint i rotates about z of frame i.
    Modified,
}

/// One row of a Denavit-Hartenberg table: the parameters a, alpha, d, theta of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the joint.
    pub name: String,
    /// Length along x (m).
    pub a: f64,
    /// Twist about x (rad).
    pub alpha: f64,
    /// Offset along z (m).
    pub d: f64,
    /// Angle about z (rad).
    pub theta: f64,
    /// True if q adds to d, false if it adds to theta.
    pub prismatic: bool,
    /// True if q is subtracted instead of added, as in tables of Jaco and Mico.
    pub flip: bool,
    /// Limits of q.
    pub limits: Limits,
}

/// A serial arm as a Denavit-Hartenberg table.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// The convention of the rows.
    pub convention: Convention,
    /// Rows from the base on.
    pub rows: Vec<Row>,
    /// The pose of frame 0 in the world; `None`: frame 0 is the world, and the root.
    pub ground_from_base: Option<Pose>,
    /// A last constant displacement: the flange in the frame of the last row.
    pub last_from_flange: Pose,
}

/// The joints of an arm given by Denavit-Hartenberg parameters: links `base`, `link1`, ... and
/// `flange`, with the root `ground` if `ground_from_base` is given.
///
/// ```text
/// standard  (i-1)_from_i = Rz(theta) Tz(d) Tx(a) Rx(alpha),  joint i along z of frame i - 1
/// modified  (i-1)_from_i = Rx(alpha) Tx(a) Rz(theta) Tz(d),  joint i along z of frame i
/// ```
///
/// q is added to theta (revolute) or to d (prismatic), subtracted where a row flips: the parameters of a row are those at q = 0,
/// a and d in m, alpha and theta in rad. Link i moves with joint i, and its frame has its origin on
/// the axis of that joint; `flange` is frame N of the table displaced by `last_from_flange`.
///
/// Source: Denavit & Hartenberg 1955; Craig, Introduction to Robotics, 1986 (modified).
///
/// ```
/// use cylindroid::model::formats::dh::{Arm, Convention, Row, joints};
/// use cylindroid::model::{Limits, Mechanism};
/// use cylindroid::{Pose, Vec3};
///
/// // Two parallel revolute joints, 0.5 m apart.
/// let row = |name: &str| Row {
///     name: name.to_owned(),
///     a: 0.5,
///     alpha: 0.0,
///     d: 0.0,
///     theta: 0.0,
///     prismatic: false,
///     flip: false,
///     limits: Limits::NONE,
/// };
/// let arm = Arm {
///     convention: Convention::Standard,
///     rows: vec![row("shoulder"), row("elbow")],
///     ground_from_base: None,
///     last_from_flange: Pose::IDENTITY,
/// };
/// let mut builder = Mechanism::builder("2r");
/// for joint in joints(&arm) {
///     builder.joint(joint);
/// }
/// let robot = builder.build()?;
/// let flange = robot.state(&[0.0, 0.0])?.pose(robot.frame("flange")?)?;
/// assert_eq!(flange.translation, Vec3::X);
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[must_use]
pub fn joints(arm: &Arm) -> Vec<JointSpec> {
    let mut joints = Vec::with_capacity(arm.rows.len() + 2);
    if let Some(pose) = arm.ground_from_base {
        joints.push(fixed("base", "ground", "base", pose));
    }
    let mut parent = "base".to_owned();
    // The displacement from the last joint's frame to the next row.
    let mut pending = Pose::IDENTITY;
    for (i, row) in arm.rows.iter().enumerate() {
        let child = format!("link{}", i + 1);
        let along_x = along_x(row);
        let along_z = Pose {
            rotation: Rotation::about_z(row.theta),
            translation: Vec3::new(0.0, 0.0, row.d),
        };
        let kind = if row.prismatic { JointKind::Prismatic } else { JointKind::Revolute };
        let (placement, after) = match arm.convention {
            Convention::Standard => (pending * along_z, along_x),
            Convention::Modified => (pending * along_x * along_z, Pose::IDENTITY),
        };
        joints.push(JointSpec {
            parent_from_joint: placement,
            axis: if row.flip { -Vec3::Z } else { Vec3::Z },
            limits: row.limits,
            ..JointSpec::new(&row.name, kind, &parent, &child)
        });
        pending = after;
        parent = child;
    }
    joints.push(fixed("flange", &parent, "flange", pending * arm.last_from_flange));
    joints
}

/// `Tx(a) Rx(alpha)`; both commute.
fn along_x(row: &Row) -> Pose {
    Pose {
        rotation: Rpy { roll: row.alpha, ..Rpy::default() }.rotation(),
        translation: Vec3::new(row.a, 0.0, 0.0),
    }
}

fn fixed(name: &str, parent: &str, child: &str, pose: Pose) -> JointSpec {
    JointSpec {
        parent_from_joint: pose,
        actuated: false,
        ..JointSpec::new(name, JointKind::Fixed, parent, child)
    }
}
