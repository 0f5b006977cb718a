//! A mechanism as lines through its joints: what a picture shows of it.

use cylindroid::model::{Joint, JointKind};
use cylindroid::{Pose, Result, State, Vec3};

/// How a joint is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// Turns, about one axis or several.
    Turning,
    /// Slides.
    Sliding,
    /// A contact.
    Contact,
}

/// A joint or contact.
#[derive(Debug, Clone)]
pub(crate) struct Spot {
    pub(crate) name: String,
    pub(crate) point: Vec3,
    pub(crate) mark: Mark,
    pub(crate) driven: bool,
    /// True where one of its links is the ground.
    pub(crate) grounded: bool,
}

/// Points of links and joints in world (m).
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    /// Of every link that moves, where its joints are; no point twice.
    pub(crate) links: Vec<Vec<Vec3>>,
    /// What slides, from one link to the other.
    pub(crate) slides: Vec<[Vec3; 2]>,
    pub(crate) spots: Vec<Spot>,
}

impl Skeleton {
    /// Of a mechanism; `reference` is a point on the link of that index.
    pub(crate) fn new(state: &State, (link, reference): (usize, Vec3)) -> Result<Self> {
        let mechanism = state.mechanism();
        let poses: Vec<Pose> = mechanism
            .links()
            .iter()
            .map(|l| Ok(state.pose(mechanism.frame(&l.name)?)))
            .collect::<Result<_>>()?;
        let is_child = |i: usize| mechanism.joints().iter().any(|j| j.child == i);
        let ground: Vec<bool> = (0..poses.len()).map(|i| !is_child(i)).collect();
        let mut points: Vec<Vec<Vec3>> = vec![Vec::new(); poses.len()];
        let near = 1e-6 * mechanism.reach();
        let mut add = |link: usize, point: Vec3| {
            if !points[link].iter().any(|p| (*p - point).norm() < near) {
                points[link].push(point);
            }
        };
        let mut skeleton = Self { links: Vec::new(), slides: Vec::new(), spots: Vec::new() };
        let mut spot =
            |name: &str, [a, b]: [Vec3; 2], kind: JointKind, driven: bool, grounded: bool| {
                let mark = match kind {
                    JointKind::Prismatic | JointKind::Cylindrical => Mark::Sliding,
                    _ => Mark::Turning,
                };
                if (a - b).norm() > near {
                    skeleton.slides.push([a, b]);
                }
                let name = name.to_owned();
                skeleton.spots.push(Spot { name, point: a, mark, driven, grounded });
            };
        for joint in mechanism.joints() {
            // A free body hangs on nothing that could be drawn.
            if matches!(joint.kind, JointKind::Free | JointKind::Planar) {
                continue;
            }
            let Joint { parent, child, .. } = *joint;
            let a = (poses[parent] * joint.parent_from_joint).translation;
            let b = (poses[child] * joint.joint_from_child.inverse()).translation;
            add(parent, a);
            add(child, b);
            if joint.kind.dof() > 0 {
                let (kind, driven) = (joint.kind, joint.actuated);
                spot(&joint.name, [a, b], kind, driven, ground[parent]);
            }
        }
        for joint in mechanism.loops() {
            let a = (poses[joint.a] * joint.link_a_from_joint).translation;
            let b = (poses[joint.b] * joint.link_b_from_joint).translation;
            add(joint.a, a);
            add(joint.b, b);
            let grounded = ground[joint.a] || ground[joint.b];
            spot(&joint.name, [a, b], joint.kind, joint.actuated, grounded);
        }
        for contact in mechanism.contacts() {
            let point = (poses[contact.b] * contact.link_b_from_contact).translation;
            add(contact.a, (poses[contact.a] * contact.link_a_from_contact).translation);
            add(contact.b, point);
            skeleton.spots.push(Spot {
                name: contact.name.clone(),
                point,
                mark: Mark::Contact,
                driven: false,
                grounded: ground[contact.a] || ground[contact.b],
            });
        }
        if !ground[link] {
            add(link, reference);
        }
        let moving = points.into_iter().zip(&ground).filter(|(p, ground)| !**ground && p.len() > 1);
        skeleton.links = moving.map(|(p, _)| p).collect();
        Ok(skeleton)
    }

    /// All points that are drawn.
    pub(crate) fn points(&self) -> impl Iterator<Item = Vec3> + '_ {
        let links = self.links.iter().flatten().copied();
        links.chain(self.spots.iter().map(|s| s.point))
    }
}
