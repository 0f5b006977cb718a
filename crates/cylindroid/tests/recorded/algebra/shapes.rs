//! Distances of two shapes: all kinds, anywhere, far and touching and overlapping.

use cylindroid::collision::{Separation, distance};
use cylindroid::model::Geometry;
use cylindroid::spatial::Rotation;
use cylindroid::{Pose, Result, Vec3};

use super::sum;
use crate::record::{Record, check};
use crate::robots::Random;

/// The kinds of [`shape`].
pub(super) const SHAPES: usize = 10;

/// A shape of the k-th kind, some tenths of `size` large; the first ones are bounded.
pub(super) fn shape(random: &mut Random<'_>, kind: usize, size: f64) -> Geometry {
    let mut length = || size * random.within(0.05, 0.3);
    match kind {
        0 => Geometry::Sphere { radius: length() },
        1 => Geometry::Capsule { radius: length(), length: 2.0 * length() },
        2 => Geometry::Box { size: Vec3::new(length(), length(), length()) },
        3 => Geometry::Cylinder { radius: length(), length: length() },
        4 => Geometry::Ellipsoid { radii: Vec3::new(length(), length(), length()) },
        5 => hull(random, 60, size),
        6 => hull(random, 12, size),
        7 => Geometry::Capsule { radius: 0.0, length: length() },
        8 => Geometry::ConvexHull {
            points: (0..30).map(|_| random.vec3(0.2 * size) - Vec3::Z * (0.1 * size)).collect(),
        },
        _ => Geometry::HalfSpace,
    }
}

/// Points on a stretched ball.
fn hull(random: &mut Random<'_>, count: usize, size: f64) -> Geometry {
    let stretched = Vec3::new(0.3, 0.2, 0.1) * size;
    let one = |d: Vec3| Vec3::new(d.x * stretched.x, d.y * stretched.y, d.z * stretched.z);
    let points = (0..count).map(|_| one(random.vec3(1.0).unit(1e-3).unwrap_or(Vec3::X)));
    Geometry::ConvexHull { points: points.collect() }
}

/// Lengths over the size of the shapes.
fn of_separation(record: &mut Record, found: Result<Separation>, about: Vec3, size: f64) {
    match found {
        Ok(s) => {
            record.number(s.distance / size);
            let place = (s.point_a - about) * (1.0 / size);
            record.number(sum(&[s.normal.to_array(), place.to_array()].concat()));
            let closed = s.point_b - s.point_a - s.normal * s.distance;
            record.word(&(closed.norm() < 1e-9 * size));
        }
        Err(error) => record.word(&error.to_string().len()),
    }
}

/// Two shapes at a distance of their own, or at random.
struct Case {
    shapes: [Geometry; 2],
    poses: [Pose; 2],
    size: f64,
}

impl Case {
    fn new(random: &mut Random<'_>, kinds: [usize; 2]) -> Self {
        let size = random.power(-2.0, 2.0);
        let shapes = kinds.map(|kind| shape(random, kind, size));
        let mut first = random.pose(10.0 * size);
        let apart = [2.0, 0.3, 0.05, 0.0][random.below(4)] * size;
        let mut second = random.pose(apart);
        second.translation += first.translation;
        match random.below(5) {
            0 => second.rotation = first.rotation,
            1 => (first.rotation, second.rotation) = Default::default(),
            _ => {}
        }
        let mut own = Self { shapes, poses: [first, second], size };
        if random.once_in(2) {
            own.move_to([0.0, 1e-6, 1e-3, -1e-3, -0.02, 0.5][random.below(6)] * size);
        }
        own
    }

    fn found(&self) -> Result<Separation> {
        distance((&self.shapes[0], self.poses[0]), (&self.shapes[1], self.poses[1]))
    }

    /// Moves the second shape along the normal until the distance is this one.
    fn move_to(&mut self, wanted: f64) {
        for _ in 0..2 {
            if let Ok(s) = self.found() {
                self.poses[1].translation += s.normal * (wanted - s.distance);
            }
        }
    }
}

/// All pairs of kinds, in both orders.
#[test]
fn pairs_of_shapes() {
    check("algebra_shapes", 500, |random, record| {
        let kinds = [0, 1].map(|_| random.below(SHAPES));
        let case = Case::new(random, kinds);
        of_separation(record, case.found(), case.poses[0].translation, case.size);
    });
}

/// Lines that are parallel, cross, meet, lie on one another.
#[test]
fn segments() {
    check("algebra_segments", 250, |random, record| {
        let radius = [0.0, 0.1, 0.02][random.below(3)];
        let lengths = [0, 1].map(|_| [0.0, 1.0, 0.3, 2.0][random.below(4)]);
        let capsule = |length| Geometry::Capsule { radius, length };
        let angle = [0.0, 1e-13, 1e-9, 1e-3, 0.7, std::f64::consts::FRAC_PI_2][random.below(6)];
        let grid = |random: &mut Random<'_>| [0.0, 0.5, -0.5, 0.2, 1.0][random.below(5)];
        let place = Vec3::new(grid(random), grid(random), grid(random));
        let relative = Pose { rotation: Rotation::exp(Vec3::X * angle), translation: place };
        let base = if random.once_in(3) { Pose::IDENTITY } else { random.pose(2.0) };
        let found = distance((&capsule(lengths[0]), base), (&capsule(lengths[1]), base * relative));
        of_separation(record, found, base.translation, 1.0);
    });
}

/// Points within, on and beyond faces, edges, rims and axes of a box and a cylinder.
#[test]
fn points() {
    check("algebra_points", 250, |random, record| {
        let solid = match random.below(2) {
            0 => Geometry::Box { size: Vec3::new(1.0, 0.6, 0.4) },
            _ => Geometry::Cylinder { radius: 0.4, length: 1.0 },
        };
        let places = [0.0, 0.4, 0.5, -0.3, 0.2, -0.7, 0.1, 1.3];
        let mut one = || places[random.below(8)] + [0.0, 1e-3][random.below(2)];
        let local = Vec3::new(one(), one(), one());
        let ball = Geometry::Sphere { radius: [0.0, 0.05][random.below(2)] };
        let pose = if random.once_in(2) { Pose::IDENTITY } else { random.pose(1.0) };
        let at = Pose { rotation: random.pose(0.0).rotation, translation: pose * local };
        let found = if random.once_in(2) {
            distance((&ball, at), (&solid, pose))
        } else {
            distance((&solid, pose), (&ball, at))
        };
        of_separation(record, found, pose.translation, 1.0);
    });
}

/// Boxes and hulls that touch at faces, edges and corners, flat ones among them.
#[test]
fn faces_and_corners() {
    check("algebra_faces", 220, |random, record| {
        let flat = [0.0, 0.0, 0.2, 0.4];
        let mut edge = || flat[random.below(4)];
        let sizes = [0, 1].map(|_| Vec3::new(edge() + 0.1, edge(), edge()));
        let solid = |random: &mut Random<'_>, size: Vec3| match random.below(12) {
            9 => Geometry::Box { size: Vec3::ZERO },
            10 => Geometry::Ellipsoid { radii: Vec3::ZERO },
            11 => Geometry::Ellipsoid { radii: size * 0.5 },
            0..3 => corners(size),
            3..6 => Geometry::Cylinder { radius: 0.5 * size.x, length: size.z },
            _ => Geometry::Box { size },
        };
        let shapes = sizes.map(|size| solid(random, size));
        let turn = [0.0, 0.25, 0.5, 0.3][random.below(4)] * std::f64::consts::PI;
        let axis = [Vec3::X, Vec3::Z, Vec3::new(1.0, 1.0, 0.0)][random.below(3)];
        let places = [0.0, 0.1, 0.2, 0.25, 0.4];
        let apart = if random.once_in(5) { 0.0 } else { 1.0 };
        let mut one = || apart * places[random.below(5)];
        let pose = Pose {
            rotation: Rotation::exp(axis * turn),
            translation: Vec3::new(one(), one(), one()),
        };
        let base = if random.once_in(2) { Pose::IDENTITY } else { random.pose(0.5) };
        let found = distance((&shapes[0], base), (&shapes[1], base * pose));
        of_separation(record, found, base.translation, 1.0);
    });
}

/// The corners of a box, some of them twice.
fn corners(size: Vec3) -> Geometry {
    let side = |bit: usize| if bit == 0 { -0.5 } else { 0.5 };
    let corner =
        |i: usize| Vec3::new(side(i & 1) * size.x, side(i & 2) * size.y, side(i & 4) * size.z);
    Geometry::ConvexHull { points: (0..10).map(|i| corner(i % 8)).collect() }
}

#[test]
fn refused_shapes() {
    check("algebra_refused_shapes", 40, |random, record| {
        let bad = [-0.1, f64::NAN, f64::INFINITY, 1e160, 0.0, 0.2];
        let mut one = || bad[random.below(6)];
        let lengths = [one(), one(), one()];
        let [x, y, z] = lengths;
        let all = Vec3::new(x, y, z);
        let shape = match random.below(10) {
            0 => Geometry::Sphere { radius: x },
            1 => Geometry::Capsule { radius: x, length: y },
            2 => Geometry::Box { size: all },
            3 => Geometry::Cylinder { radius: x, length: y },
            4 => Geometry::Ellipsoid { radii: all },
            5 => Geometry::ConvexHull { points: vec![all, Vec3::X] },
            6 => Geometry::ConvexHull { points: vec![] },
            7 => Geometry::Mesh { uri: "none".to_owned(), path: None, scale: all },
            8 => {
                Geometry::Mesh { uri: "none".to_owned(), path: Some("none.obj".into()), scale: all }
            }
            _ => Geometry::HalfSpace,
        };
        let other = if random.once_in(3) { Geometry::HalfSpace } else { corners(Vec3::X) };
        let at = Pose::from_translation(Vec3::new(0.3, 2.0, [1.0, f64::NAN][random.below(2)]));
        let found = distance((&shape, Pose::IDENTITY), (&other, at));
        of_separation(record, found, Vec3::ZERO, 1.0);
    });
}
