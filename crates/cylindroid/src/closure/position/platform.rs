//! Platform coordinates: a mechanism whose end effector is tied to a chain of slides and rotations,
//! so that the components of its pose are coordinates like those of joints.
//!
//! Formula  world_from_tool = world_from_zero * slides(x, y, z) * rotation: a loop joint without
//!          freedom ties the end of the chain to the tool
//! Shapes   coordinates: those of the mechanism in their order, then those of the platform
//! Units    m, rad
//! Frame    slides along the axes of `world_from_zero`, in the plane x and y; rotations: yaw, pitch
//!          and roll about z, y and x (`R = Rz(yaw) Ry(pitch) Rx(roll)`), in the plane about z, or a
//!          rotation vector where none of them is prescribed
//! Valid    any mechanism, serial arms too, whose chain becomes a loop. Angles are singular at a pitch
//!          of a quarter turn, if some of them are free; the rotation vector is not
//! Why so   inverse kinematics of closed chains is then assembly with platform coordinates
//!          prescribed, and everything that closes, tracks and examines loops applies. Rows for the
//!          pose beside those of the loops would need a second form of each of these
//! Source   the virtual chain of Kong & Gosselin 2007, Type Synthesis of Parallel Mechanisms
//! Checked  tests/map/inverse.rs

use crate::error::Result;
use crate::kinematics::EndEffector;
use crate::model::{Dimension, JointKind, JointSpec, LoopJointSpec, Mechanism};
use crate::spatial::{Pose, Rotation, Rpy, Vec3};

/// The rotations of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PlatformRotation {
    /// None: the orientation of the zero pose.
    Fixed,
    /// About one axis, in the axes of the zero pose.
    About(Vec3),
    /// Yaw, pitch and roll; in the plane about z.
    #[cfg_attr(not(feature = "sweep"), expect(dead_code, reason = "of maps"))]
    Angles,
    /// All, as a rotation vector; in the plane about z.
    Free,
}

/// The chain that carries the platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlatformChain {
    /// The pose of the tool where all coordinates are zero.
    pub(crate) world_from_zero: Pose,
    /// The slides that exist, along x, y and z of the zero pose.
    pub(crate) slides: [bool; 3],
    pub(crate) rotation: PlatformRotation,
}

/// A mechanism with platform coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Platform {
    /// Its first coordinates are those of the mechanism.
    pub(crate) mechanism: Mechanism,
    /// Without platform coordinates.
    inner: Mechanism,
    chain: PlatformChain,
    /// The tool in the frame of the end effector: the given one, in the plane rotated such that it
    /// differs from the world by a rotation about z.
    tool: EndEffector,
}

impl Platform {
    /// # Errors
    /// A frame of another mechanism, a tool that is not finite.
    pub(crate) fn of(
        mechanism: &Mechanism,
        end_effector: EndEffector,
        chain: PlatformChain,
    ) -> Result<Self> {
        mechanism.check_frame(end_effector.frame)?;
        let planar = mechanism.dimension() == Dimension::Planar;
        let home = mechanism.state(mechanism.home())?;
        let mut tool = end_effector;
        if planar {
            let turned = home.pose_of(end_effector).rotation;
            tool.frame_from_tool.rotation = tool.frame_from_tool.rotation
                * turned.inverse()
                * Rotation::about_z(Rpy::of(turned).yaw);
        }
        let chain = if planar { chain.in_plane() } else { chain };
        let inner = mechanism.clone();
        let platform = Self { mechanism: inner.clone(), inner, chain, tool };
        let start = platform.coordinates_of(home.pose_of(tool));
        Ok(Self { mechanism: platform.with_chain(&start)?, ..platform })
    }

    fn with_chain(&self, start: &[f64]) -> Result<Mechanism> {
        let inner = &self.inner;
        let prefix = unused_prefix(inner);
        let mut builder = inner.copied(inner.home())?;
        let mut parent = inner.links()[inner.root()].name.clone();
        let mut place = self.chain.world_from_zero;
        let mut from = 0;
        for (name, kind, axis) in self.chain.joints(inner.dimension()) {
            let (joint, child) = (format!("{prefix}{name}"), format!("{prefix}after {name}"));
            builder.joint(JointSpec {
                parent_from_joint: std::mem::replace(&mut place, Pose::IDENTITY),
                axis,
                actuated: false,
                ..JointSpec::new(&joint, kind, &parent, &child)
            });
            builder.start(&joint, &start[from..from + kind.dof()]);
            from += kind.dof();
            parent = child;
        }
        let frame = inner.frame_of(self.tool.frame);
        let link = &inner.links()[frame.link].name;
        // A tool on the root is at its place or nowhere: a link of its own keeps the ends apart.
        let end = format!("{prefix}end");
        builder.joint(JointSpec {
            parent_from_joint: place,
            actuated: false,
            ..JointSpec::new(&format!("{prefix}fixed"), JointKind::Fixed, &parent, &end)
        });
        builder.loop_joint(LoopJointSpec {
            link_b_from_joint: frame.link_from_frame * self.tool.frame_from_tool,
            ..LoopJointSpec::new(&format!("{prefix}tie"), JointKind::Fixed, &end, link)
        });
        builder.reference(&end);
        Ok(builder.build()?.with_lengths_of(inner))
    }

    /// The coordinates of the platform at a pose of the tool; components without coordinate count
    /// as zero.
    pub(crate) fn coordinates_of(&self, world_from_tool: Pose) -> Vec<f64> {
        let zero_from_tool = self.chain.world_from_zero.inverse() * world_from_tool;
        let p = zero_from_tool.translation.to_array();
        let mut all: Vec<f64> = (0..3).filter(|&i| self.chain.slides[i]).map(|i| p[i]).collect();
        let rotation = zero_from_tool.rotation;
        match self.chain.rotation {
            PlatformRotation::Fixed => {}
            PlatformRotation::About(axis) => {
                all.push(axis.unit(0.0).map_or(0.0, |axis| axis.dot(rotation.log())));
            }
            PlatformRotation::Angles => {
                let Rpy { roll, pitch, yaw } = Rpy::of(rotation);
                all.extend([yaw, pitch, roll]);
            }
            PlatformRotation::Free => all.extend(rotation.log().to_array()),
        }
        all
    }

    /// Number of coordinates without those of the platform.
    #[cfg_attr(not(feature = "sweep"), expect(dead_code, reason = "of maps"))]
    pub(crate) fn n(&self) -> usize {
        self.inner.n()
    }

    /// The names of the platform's coordinates.
    #[cfg_attr(not(feature = "sweep"), expect(dead_code, reason = "of maps"))]
    pub(crate) fn components(&self) -> Vec<&'static str> {
        let joints = self.chain.joints(self.inner.dimension());
        let names = joints.into_iter().flat_map(|(name, kind, _)| match kind {
            JointKind::Spherical => vec!["rx", "ry", "rz"],
            _ => vec![name],
        });
        names.collect()
    }

    /// The configuration of the mechanism with the platform at the pose of its tool.
    ///
    /// # Errors
    /// As [`Mechanism::check_q`].
    pub(crate) fn extended(&self, q: &[f64]) -> Result<Vec<f64>> {
        let mut all = q.to_vec();
        all.extend(self.coordinates_of(self.inner.state(q)?.pose_of(self.tool)));
        Ok(all)
    }
}

impl PlatformChain {
    /// In the plane: x and y, the rotation about z, and a zero pose that lies in it.
    fn in_plane(self) -> Self {
        let [x, y, _] = self.slides;
        let zero = self.world_from_zero;
        Self {
            world_from_zero: Pose {
                rotation: Rotation::about_z(Rpy::of(zero.rotation).yaw),
                ..zero
            },
            slides: [x, y, false],
            rotation: match self.rotation {
                PlatformRotation::Fixed => PlatformRotation::Fixed,
                _ => PlatformRotation::About(Vec3::Z),
            },
        }
    }

    /// Names, kinds and axes of its joints.
    fn joints(&self, dimension: Dimension) -> Vec<(&'static str, JointKind, Vec3)> {
        let slides = [("x", Vec3::X), ("y", Vec3::Y), ("z", Vec3::Z)];
        let exists = slides.into_iter().zip(self.slides).filter(|(_, exists)| *exists);
        let mut all: Vec<_> =
            exists.map(|((name, axis), _)| (name, JointKind::Prismatic, axis)).collect();
        match self.rotation {
            PlatformRotation::Fixed => {}
            PlatformRotation::About(axis) => {
                let name = if dimension == Dimension::Planar { "rz" } else { "turn" };
                all.push((name, JointKind::Revolute, axis));
            }
            PlatformRotation::Angles => all.extend([
                ("yaw", JointKind::Revolute, Vec3::Z),
                ("pitch", JointKind::Revolute, Vec3::Y),
                ("roll", JointKind::Revolute, Vec3::X),
            ]),
            PlatformRotation::Free => all.push(("rotation", JointKind::Spherical, Vec3::Z)),
        }
        all
    }
}

/// A prefix that no name of the mechanism has.
fn unused_prefix(mechanism: &Mechanism) -> String {
    let names = || {
        let links = mechanism.links().iter().map(|l| &l.name);
        let joints = mechanism.joints().iter().map(|j| &j.name);
        let loops = mechanism.loops().iter().map(|l| &l.name);
        let contacts = mechanism.contacts().iter().map(|c| &c.name);
        let frames = mechanism.frames().iter().map(|f| &f.name);
        links.chain(joints).chain(loops).chain(contacts).chain(frames)
    };
    let mut prefix = "platform.".to_owned();
    while names().any(|name| name.starts_with(&prefix)) {
        prefix.insert(0, '_');
    }
    prefix
}
