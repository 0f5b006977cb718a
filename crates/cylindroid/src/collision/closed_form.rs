//! Closed forms of distances: segments and points, a point and a box or cylinder, a half-space.
//!
//! Formula  segments c_i + s_i u_i, |s_i| <= h_i, w = c_1 - c_2, b = u_1 . u_2:
//!          s_1 = (b u_2.w - u_1.w) / |u_1 x u_2|^2, clamped; s_2 = b s_1 + u_2.w, clamped; s_1 again
//!          half-space: n . p of its point that is deepest below
//! Shapes   cores only; radii are subtracted by `distance.rs`
//! Valid    all lengths, zero among them. For parallel segments the middle of the common part; for
//!          segments that cross, the normal of both
//! Source   Ericson 2005, Real-Time Collision Detection, section 5.1.9 (about centres, so that the
//!          result does not depend on the order)
//! Checked  tests/collision/laws.rs

use super::convex::Placed;
use super::separation::Separation;
use crate::scalar::clamp;
use crate::spatial::Vec3;
use crate::tolerance::{PARALLEL_SEGMENTS, ZERO_SEPARATION};

/// The separation of two cores, where it has a closed form; the normal from a to b.
#[inline]
pub(super) fn separation(a: Placed<'_>, b: Placed<'_>) -> Option<Separation> {
    if let (Some(h), Some(k)) = (a.shape.core.half_length(), b.shape.core.half_length()) {
        return Some(segments(a, h, b, k));
    }
    if matches!(b.shape.core, super::convex::Core::HalfSpace) {
        return Some(half_space(a, b));
    }
    if a.shape.core.half_length() == Some(0.0) {
        return point(a, b);
    }
    None
}

/// True if the pair has a closed form only in the other order.
pub(super) fn is_reversed(a: Placed<'_>, b: Placed<'_>) -> bool {
    let is_point = |p: Placed<'_>| p.shape.core.half_length() == Some(0.0);
    let is_segment = |p: Placed<'_>| p.shape.core.half_length().is_some();
    matches!(a.shape.core, super::convex::Core::HalfSpace) || (is_point(b) && !is_segment(a))
}

#[inline]
fn segments(a: Placed<'_>, h: f64, b: Placed<'_>, k: f64) -> Separation {
    let (c, d) = (a.world_from_shape.translation, b.world_from_shape.translation);
    if h == 0.0 && k == 0.0 {
        return between(c, d, || Vec3::Z);
    }
    let (u, v) = (a.world_from_shape.rotation.z_axis(), b.world_from_shape.rotation.z_axis());
    let w = c - d;
    let (cosine, along_u, along_v) = (u.dot(v), u.dot(w), v.dot(w));
    let cross = u.cross(v);
    let sine_squared = cross.dot(cross);
    let mut s = if sine_squared > PARALLEL_SEGMENTS {
        clamp((cosine * along_v - along_u) / sine_squared, -h, h)
    } else {
        // The middle of the part that both share, or the end nearer to the other one.
        let (low, high) = ((-along_u - k).max(-h), (-along_u + k).min(h));
        if low <= high { 0.5 * (low + high) } else { clamp(-along_u, -h, h) }
    };
    let free = cosine * s + along_v;
    let t = clamp(free, -k, k);
    if t != free {
        s = clamp(cosine * t - along_u, -h, h);
    }
    between(c + u * s, d + v * t, || {
        // Across both: the centres are on neither side.
        let normal = cross.unit(ZERO_SEPARATION).or_else(|| {
            // Collinear, and over one another: any direction across.
            let other = if u.x.abs() < 0.5 { Vec3::X } else { Vec3::Y };
            u.cross(other).unit(ZERO_SEPARATION)
        });
        normal.unwrap_or(Vec3::Z)
    })
}

/// From p to q; where they coincide, along the normal given.
#[inline]
fn between(p: Vec3, q: Vec3, normal: impl FnOnce() -> Vec3) -> Separation {
    let gap = q - p;
    let distance = gap.norm();
    let normal = if distance > ZERO_SEPARATION { gap * (1.0 / distance) } else { normal() };
    Separation { distance, point_a: p, point_b: q, normal }
}

fn half_space(a: Placed<'_>, b: Placed<'_>) -> Separation {
    let up = b.world_from_shape.rotation.z_axis();
    let into = a.world_from_shape.rotation.inverse() * -up;
    let deepest = *a.world_from_shape * a.shape.core.support(into);
    let distance = up.dot(deepest - b.world_from_shape.translation);
    let point_b = deepest - up * distance;
    Separation { distance, point_a: deepest, point_b, normal: -up }
}

fn point(a: Placed<'_>, b: Placed<'_>) -> Option<Separation> {
    let p = a.world_from_shape.translation;
    let rotation = b.world_from_shape.rotation;
    let local = rotation.inverse() * (p - b.world_from_shape.translation);
    let (_, outward, distance) = b.shape.core.project(local)?;
    let outward = rotation * outward;
    let point_b = p - outward * distance;
    Some(Separation { distance, point_a: p, point_b, normal: -outward })
}
