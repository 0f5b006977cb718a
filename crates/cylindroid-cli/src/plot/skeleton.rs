//! A mechanism as lines through its joints: what a picture shows of it.

use cylindroid::model::JointKind;
use cylindroid::{State, Vec3};

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
    pub(crate) actuated: bool,
}

/// A body that contacts hold and no joint guides.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub(crate) name: String,
    /// Where it is held, and the reference point if it is on the body.
    pub(crate) points: Vec<Vec3>,
}

impl Held {
    pub(crate) fn middle(&self) -> Vec3 {
        let sum = self.points.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        sum * (1.0 / self.points.len().max(1) as f64)
    }
}

/// Points of links and joints in world (m).
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    /// Of every link that moves, where its joints are; no point twice.
    pub(crate) links: Vec<Vec<Vec3>>,
    /// What slides, from one link to the other.
    pub(crate) slides: Vec<[Vec3; 2]>,
    pub(crate) spots: Vec<Spot>,
    pub(crate) objects: Vec<Held>,
    /// Points attached to the ground.
    pub(crate) bases: Vec<Vec3>,
}

/// The points of each link, no point twice.
struct Points {
    of: Vec<Vec<Vec3>>,
    near: f64,
}

impl Points {
    fn add(&mut self, link: usize, point: Vec3) {
        if !self.of[link].iter().any(|p| (*p - point).norm() < self.near) {
            self.of[link].push(point);
        }
    }
}

fn slides(kind: JointKind) -> bool {
    matches!(kind, JointKind::Prismatic | JointKind::Cylindrical)
}

impl Skeleton {
    /// Of a mechanism; `reference` is a point on the link of that index.
    pub(crate) fn new(state: &State, (link, reference): (usize, Vec3)) -> Self {
        let mechanism = state.mechanism();
        let count = mechanism.links().len();
        let is_child = |i: usize| mechanism.joints().iter().any(|j| j.child == i);
        let ground: Vec<bool> = (0..count).map(|i| !is_child(i)).collect();
        let near = 1e-6 * mechanism.reach();
        let mut points = Points { of: vec![Vec::new(); count], near };
        let mut sliders = Vec::new();
        let mut skeleton = Self {
            links: Vec::new(),
            slides: Vec::new(),
            spots: Vec::new(),
            objects: Vec::new(),
            bases: Vec::new(),
        };
        for (joint, axis) in mechanism.joints().iter().zip(state.joint_axes()) {
            // A free body hangs on nothing that could be drawn.
            if matches!(joint.kind, JointKind::Free | JointKind::Planar) {
                continue;
            }
            let (a, b) = (axis.on_parent.point, axis.on_child.point);
            points.add(joint.parent, a);
            points.add(joint.child, b);
            if ground[joint.parent] {
                skeleton.bases.push(a);
            }
            if joint.kind.dof() > 0 {
                if slides(joint.kind) {
                    sliders.push((skeleton.spots.len(), joint.parent));
                }
                skeleton.joint([a, b], joint.kind, near, |mark| Spot {
                    name: joint.name.clone(),
                    point: a,
                    mark,
                    actuated: joint.actuated,
                });
            }
        }
        for (joint, axis) in mechanism.loops().iter().zip(state.loop_joint_axes()) {
            let (a, b) = (axis.on_parent.point, axis.on_child.point);
            points.add(joint.a, a);
            points.add(joint.b, b);
            skeleton.joint([a, b], joint.kind, near, |mark| Spot {
                name: joint.name.clone(),
                point: a,
                mark,
                actuated: joint.actuated,
            });
            if ground[joint.a] || ground[joint.b] {
                skeleton.bases.push(a);
            }
        }
        for (contact, [on_first, point]) in mechanism.contacts().iter().zip(state.contact_points())
        {
            points.add(contact.a, on_first);
            points.add(contact.b, point);
            skeleton.spots.push(Spot {
                name: contact.name.clone(),
                point,
                mark: Mark::Contact,
                actuated: false,
            });
            if ground[contact.a] || ground[contact.b] {
                skeleton.bases.push(point);
            }
        }
        // A link with an outline shows where it is; others end in the reference.
        if !ground[link] && points.of[link].len() < 3 {
            points.add(link, reference);
        }
        // A slide that starts in another joint is marked on the way.
        for (i, link) in sliders {
            let at = skeleton.spots[i].point;
            let others = skeleton.spots.iter().enumerate();
            let hidden = others.clone().any(|(j, s)| j != i && (s.point - at).norm() < near);
            if let (true, [a, b]) = (hidden, points.of[link].as_slice()) {
                skeleton.spots[i].point = (*a + *b) * 0.5;
            }
        }
        let guided = |i: usize| {
            let is_bond = |kind: JointKind| !matches!(kind, JointKind::Free | JointKind::Planar);
            mechanism.joints().iter().any(|j| is_bond(j.kind) && (j.parent == i || j.child == i))
                || mechanism.loops().iter().any(|l| l.a == i || l.b == i)
        };
        let touched = |i: usize| mechanism.contacts().iter().any(|c| c.a == i || c.b == i);
        for (i, points) in points.of.into_iter().enumerate() {
            if ground[i] || points.is_empty() {
                continue;
            }
            if touched(i) && !guided(i) {
                let name = mechanism.links()[i].name.clone();
                skeleton.objects.push(Held { name, points });
            } else if points.len() > 1 {
                skeleton.links.push(points);
            }
        }
        skeleton
    }

    fn joint(&mut self, ends: [Vec3; 2], kind: JointKind, near: f64, spot: impl Fn(Mark) -> Spot) {
        if (ends[0] - ends[1]).norm() > near {
            self.slides.push(ends);
        }
        self.spots.push(spot(if slides(kind) { Mark::Sliding } else { Mark::Turning }));
    }

    /// All points that are drawn.
    pub(crate) fn points(&self) -> impl Iterator<Item = Vec3> + '_ {
        let links = self.links.iter().flatten().copied();
        links.chain(self.spots.iter().map(|s| s.point)).chain(self.bases.iter().copied())
    }
}
