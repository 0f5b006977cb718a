//! Convex shapes: a core and a radius around it.
//!
//! Formula  shape = core + ball(radius); support point of the core, farthest along a direction d:
//!          segment (0, 0, sign(d_z) h), box sign(d) h, cylinder r (d_x, d_y) / |(d_x, d_y)| and
//!          sign(d_z) h, ellipsoid r^2 d / |r d|, hull by ascent over its edges
//! Units    m, in axes of the shape
//! Why so   spheres and capsules are points and segments with a radius: their distance has a closed
//!          form, and a pair that penetrates by less than its radii has separate cores, whose normal
//!          is exact; general penetration is needed only beyond
//! Source   van den Bergen 2003, Collision Detection in Interactive 3D Environments, ch. 4
//! Checked  tests/collision/laws.rs

use std::sync::Arc;

use super::hull::Hull;
use crate::scalar::clamp;
use crate::spatial::{Pose, Vec3};

/// A convex set about the origin of its own axes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Core {
    Point,
    /// Along z.
    Segment {
        half: f64,
    },
    Box {
        half: Vec3,
    },
    /// Along z.
    Cylinder {
        radius: f64,
        half: f64,
    },
    Ellipsoid {
        radii: Vec3,
    },
    Hull(Arc<Hull>),
    /// z <= 0.
    HalfSpace,
}

/// A core and the radius around it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Convex {
    pub(super) core: Core,
    pub(super) radius: f64,
}

/// A convex shape in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) shape: &'a Convex,
    pub(super) world_from_shape: &'a Pose,
}

impl Core {
    /// A point of the core that is farthest along `d`; the origin for a half-space.
    #[inline]
    pub(super) fn support(&self, d: Vec3) -> Vec3 {
        // Lengths below `MIN_POSITIVE` have no finite reciprocal.
        let signed = |x: f64, by: f64| if by < 0.0 { -x } else { x };
        match self {
            Self::Point | Self::HalfSpace => Vec3::ZERO,
            Self::Segment { half } => Vec3::new(0.0, 0.0, signed(*half, d.z)),
            Self::Box { half } => {
                Vec3::new(signed(half.x, d.x), signed(half.y, d.y), signed(half.z, d.z))
            }
            Self::Cylinder { radius, half } => {
                let across = d.x.hypot(d.y);
                let scale = if across >= f64::MIN_POSITIVE { radius / across } else { 0.0 };
                Vec3::new(d.x * scale, d.y * scale, signed(*half, d.z))
            }
            Self::Ellipsoid { radii } => {
                let scaled = Vec3::new(radii.x * d.x, radii.y * d.y, radii.z * d.z);
                let norm = scaled.norm();
                let scale = if norm >= f64::MIN_POSITIVE { 1.0 / norm } else { 0.0 };
                Vec3::new(radii.x * scaled.x, radii.y * scaled.y, radii.z * scaled.z) * scale
            }
            Self::Hull(hull) => hull.support(d),
        }
    }

    /// Radius of the smallest ball about the origin that contains the core.
    pub(super) fn bound(&self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Segment { half } => *half,
            Self::Box { half } => half.norm(),
            Self::Cylinder { radius, half } => radius.hypot(*half),
            Self::Ellipsoid { radii } => radii.x.max(radii.y).max(radii.z),
            Self::Hull(hull) => hull.bound(),
            Self::HalfSpace => f64::INFINITY,
        }
    }

    /// Half the length, for a point or a segment.
    pub(super) fn half_length(&self) -> Option<f64> {
        match self {
            Self::Point => Some(0.0),
            Self::Segment { half } => Some(*half),
            _ => None,
        }
    }

    /// For a box or a cylinder and a point p: the nearest point of the surface, the unit outward
    /// normal there (zero where p is on an edge or touches) and the signed distance.
    pub(super) fn project(&self, p: Vec3) -> Option<(Vec3, Vec3, f64)> {
        match self {
            Self::Box { half } => Some(project_on_box(*half, p)),
            Self::Cylinder { radius, half } => Some(project_on_cylinder(*radius, *half, p)),
            _ => None,
        }
    }
}

fn project_on_box(half: Vec3, p: Vec3) -> (Vec3, Vec3, f64) {
    let (h, x) = (half.to_array(), p.to_array());
    let nearest = Vec3::from_array(std::array::from_fn(|i| clamp(x[i], -h[i], h[i])));
    let gap = p - nearest;
    let distance = gap.norm();
    if distance > 0.0 {
        return (nearest, gap * (1.0 / distance), distance);
    }
    let depth = |i: usize| h[i] - x[i].abs();
    let face = (0..3).min_by(|&i, &j| depth(i).total_cmp(&depth(j))).unwrap_or(0);
    let side = if x[face] < 0.0 { -1.0 } else { 1.0 };
    let (mut point, mut normal) = (x, [0.0; 3]);
    (point[face], normal[face]) = (side * h[face], side);
    (Vec3::from_array(point), Vec3::from_array(normal), -depth(face))
}

fn project_on_cylinder(radius: f64, half: f64, p: Vec3) -> (Vec3, Vec3, f64) {
    let across = p.x.hypot(p.y);
    let side = if p.z < 0.0 { -1.0 } else { 1.0 };
    let radial = if across > 0.0 { Vec3::new(p.x / across, p.y / across, 0.0) } else { Vec3::X };
    let (r, z) = (across.min(radius), clamp(p.z, -half, half));
    let nearest = radial * r + Vec3::Z * z;
    let gap = p - nearest;
    let distance = gap.norm();
    if (across > radius || p.z.abs() > half) && distance > 0.0 {
        return (nearest, gap * (1.0 / distance), distance);
    }
    let (to_side, to_end) = (radius - across, half - p.z.abs());
    if to_side < to_end {
        (radial * radius + Vec3::Z * p.z, radial, -to_side)
    } else {
        (Vec3::new(p.x, p.y, side * half), Vec3::Z * side, -to_end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::uniform;

    /// The ball contains the farthest points of all directions, and one of them lies on it.
    #[test]
    fn the_smallest_ball() {
        let mut cores = vec![Core::Point, Core::Segment { half: 0.7 }];
        for [x, y, z] in [[0.3, 0.5, 0.9], [0.9, 0.3, 0.5], [0.5, 0.9, 0.3]] {
            cores.push(Core::Box { half: Vec3::new(x, y, z) });
            cores.push(Core::Cylinder { radius: x, half: y });
            cores.push(Core::Ellipsoid { radii: Vec3::new(x, y, z) });
            let ends = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
            let octahedron = ends.iter().flat_map(|end| [*end, -*end]).collect::<Vec<_>>();
            let (hull, _) = Hull::of(&octahedron).unwrap();
            cores.push(Core::Hull(Arc::new(hull)));
        }
        let mut state = 3;
        for core in cores {
            let mut farthest = 0.0_f64;
            for _ in 0..4000 {
                let d = Vec3::from_array(std::array::from_fn(|_| 2.0 * uniform(&mut state) - 1.0));
                farthest = farthest.max(core.support(d).norm());
            }
            let bound = core.bound();
            assert!(farthest <= bound * (1.0 + 1e-12), "{core:?}: {farthest} {bound}");
            assert!(farthest >= 0.99 * bound, "{core:?}: {farthest} {bound}");
        }
    }
}
