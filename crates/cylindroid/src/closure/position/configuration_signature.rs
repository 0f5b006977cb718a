//! Configuration signature: the positions of landmarks on the links, by which assembly modes are
//! distinguished.
//!
//! Formula  a landmark is p / L or d in world axes, its rate (v + w x p) / L or w x d: p the point
//!          of a joint or contact, d its axis or normal; also x and y of the reference frame, of
//!          end links of branches and of free bodies, whose whole pose counts
//! Shapes   signature: 3 values for each landmark; rates: 3 rows each, a column for each coordinate
//! Units    none: L is the characteristic length, rates per scaled coordinate
//! Valid    any mechanism
//! Why so   poses of all links would distinguish a rod between a universal and a spherical joint
//!          from the same rod rotated about itself: 64 names for one configuration of a Stewart
//!          platform. Coordinates would distinguish angles that differ by a full turn, and
//!          equivalent rotation vectors
//! Checked  tests/it/closure/modes.rs

use super::coordinates::unit_of;
use crate::kinematics::State;
use crate::linalg::Matrix;
use crate::model::{JointKind, Mechanism};
use crate::spatial::{Pose, Twist, Vec3};

/// The landmarks of a mechanism.
#[derive(Debug, Clone)]
pub(crate) struct Landmarks {
    landmarks: Vec<Landmark>,
    length: f64,
}

#[derive(Debug, Clone, Copy)]
struct Landmark {
    link: usize,
    /// In the axes of the link.
    vector: Vec3,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Point,
    Direction,
}

impl Landmarks {
    pub(crate) fn of(mechanism: &Mechanism) -> Self {
        let mut landmarks = Vec::new();
        let mut add = |link: usize, pose: Pose, directions: &[Vec3]| {
            landmarks.push(Landmark { link, vector: pose.translation, kind: Kind::Point });
            landmarks.extend(directions.iter().map(|d| Landmark {
                link,
                vector: pose.rotation * *d,
                kind: Kind::Direction,
            }));
        };
        let mut touched = vec![0; mechanism.links().len()];
        for joint in mechanism.joints() {
            add(joint.parent, joint.parent_from_joint, axis_of(joint.kind, &joint.axis));
            touched[joint.parent] += 1;
            touched[joint.child] += 1;
            if joint.kind == JointKind::Free {
                add(joint.child, Pose::IDENTITY, &BODY_AXES);
            }
        }
        for joint in mechanism.loops() {
            add(joint.a, joint.link_a_from_joint, axis_of(joint.kind, &joint.axis));
            touched[joint.a] += 1;
            touched[joint.b] += 1;
        }
        for contact in mechanism.contacts() {
            add(contact.a, contact.link_a_from_contact, &[Vec3::Z]);
            add(contact.b, contact.link_b_from_contact, &[Vec3::Z]);
            touched[contact.a] += 1;
            touched[contact.b] += 1;
        }
        let reference = mechanism.frame_of(mechanism.reference());
        add(reference.link, reference.link_from_frame, &BODY_AXES);
        for (link, _) in touched.iter().enumerate().filter(|(_, touched)| **touched == 1) {
            add(link, Pose::IDENTITY, &BODY_AXES);
        }
        Self { landmarks, length: mechanism.reach() }
    }

    /// Number of landmarks.
    pub(crate) fn len(&self) -> usize {
        self.landmarks.len()
    }

    /// Their positions for the link poses `links`.
    pub(crate) fn at(&self, links: &[Pose]) -> Vec<Vec3> {
        self.landmarks.iter().map(|m| self.place(m, links[m.link])).collect()
    }

    fn place(&self, landmark: &Landmark, world_from_link: Pose) -> Vec3 {
        match landmark.kind {
            Kind::Point => (world_from_link * landmark.vector) * (1.0 / self.length),
            Kind::Direction => world_from_link.rotation * landmark.vector,
        }
    }

    /// For each landmark, true if none of `motions` moves it by more than `tolerance`: columns are
    /// scaled changes of the coordinates `places`.
    pub(crate) fn resting(
        &self,
        state: &State,
        places: &[usize],
        motions: &Matrix,
        tolerance: f64,
    ) -> Vec<bool> {
        let mechanism = state.mechanism();
        let poses = link_poses(state);
        let now = self.at(&poses);
        let rates: Vec<Vec<f64>> = (0..motions.cols())
            .map(|k| {
                let mut rates = vec![0.0; mechanism.n()];
                for (&j, x) in places.iter().zip(motions.column(k)) {
                    rates[j] = x * unit_of(mechanism, j);
                }
                rates
            })
            .collect();
        let rests = |landmark: &Landmark, at: &Vec3| {
            let tip = state.tip(mechanism.link_frame(landmark.link));
            rates.iter().all(|rates| {
                let mut twist = Twist::ZERO;
                tip.for_each_column(Vec3::ZERO, |_, c, unit| twist = twist + unit * rates[c]);
                let turned = twist.angular.cross(*at);
                let rate = match landmark.kind {
                    Kind::Point => twist.linear * (1.0 / self.length) + turned,
                    Kind::Direction => turned,
                };
                rate.norm() <= tolerance
            })
        };
        self.landmarks.iter().zip(&now).map(|(landmark, at)| rests(landmark, at)).collect()
    }
}

/// The poses of all links.
pub(crate) fn link_poses(state: &State) -> Vec<Pose> {
    let mechanism = state.mechanism();
    (0..mechanism.links().len()).map(|link| state.link_pose(link)).collect()
}

/// The largest displacement of a link between two configurations: distance over the characteristic
/// length, or angle.
pub(crate) fn max_displacement(a: &[Pose], b: &[Pose], mechanism: &Mechanism) -> f64 {
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| {
        let distance = (a.translation - b.translation).norm() / mechanism.reach();
        most.max(distance).max(a.rotation.angle_to(b.rotation))
    })
}

const BODY_AXES: [Vec3; 2] = [Vec3::X, Vec3::Y];

/// The axis that belongs to the signature of a joint: none if the joint leaves the second link more
/// than one rotation.
fn axis_of(kind: JointKind, axis: &Vec3) -> &[Vec3] {
    match kind {
        JointKind::Universal { .. } | JointKind::Spherical | JointKind::Free | JointKind::Fixed => {
            &[]
        }
        _ => std::slice::from_ref(axis),
    }
}

/// The largest distance of the chosen landmarks between two signatures [-]; zero without any.
pub(crate) fn signature_distance(a: &[Vec3], b: &[Vec3], chosen: impl Fn(usize) -> bool) -> f64 {
    let pairs = a.iter().zip(b).enumerate().filter(|(i, _)| chosen(*i));
    pairs.fold(0.0, |most: f64, (_, (a, b))| most.max((*a - *b).norm()))
}
