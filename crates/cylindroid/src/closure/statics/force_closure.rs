//! Force closure of a grasp: the wrenches that contacts with friction can resist, and the quality
//! epsilon.
//!
//! Formula  w = sum G_i f_i, f_i in the cone |f_t / mu|^2 + |m_n / (mu_t)|^2 <= f_n^2, f_n >= 0;
//!          epsilon = min over unit n of h(n), the support function of these w, with the sum of all
//!          f_n at most 1 (`L1`, Q1) or each f_n at most its strength (`LInf`, Q-infinity)
//! Shapes   G_i: d x k, columns normal, tangents, and the moment about the normal for soft fingers
//! Units    mu has none, the torsional coefficient is a length (m); moments are divided by the
//!          characteristic length, so that epsilon is a force (per unit of f_n for `L1`)
//! Frame    the wrench acts on the object, at the point and in the axes of its twist
//! Valid    any contacts. epsilon > 0 is force closure. It is returned between two certified
//!          bounds: the friction cones are round, not approximated by pyramids
//! Why so   pyramids of eight edges err by up to 8 % and depend on their orientation; the hull of
//!          all their edges in six dimensions has thousands of facets, of which only one is needed
//! Source   Ferrari & Canny 1992; Zheng 2013; cones of soft fingers Howe & Cutkosky 1996
//! Checked  tests/it/closure/grasp.rs

use super::nearest_point::{NearestPoint, nearest_point};
use super::smallest_support::{Search, Smallest, Vector, smallest_support};
use crate::error::{Error, Result};
use crate::linalg::{Hull, HullGoal, HullOptions, Qr, dot, norm};
use crate::model::{ContactCurvature, Dimension};
use crate::spatial::Vec3;
use crate::tolerance::{GRASP_QUALITY, HULL, LENGTHS, MAX_FACETS, MAX_SIMPLICES, ORTHONORMAL};

/// The friction model of a finger.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Friction {
    /// Frictionless: a force along the normal.
    None,
    /// A hard finger: a force within the friction cone of the coefficient `mu`.
    Hard {
        /// Coefficient of friction [-].
        mu: f64,
    },
    /// A soft finger: also a moment about the normal, within an ellipsoid with the tangential
    /// force.
    Soft {
        /// Coefficient of friction [-].
        mu: f64,
        /// Largest moment over normal force (m).
        torsion: f64,
    },
}

impl Friction {
    /// Coefficient of friction [-]; zero if frictionless.
    #[must_use]
    pub const fn mu(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Hard { mu } | Self::Soft { mu, .. } => mu,
        }
    }

    /// Largest moment over normal force (m); none unless the finger is soft.
    #[must_use]
    pub const fn torsion(self) -> Option<f64> {
        match self {
            Self::None | Self::Hard { .. } => None,
            Self::Soft { torsion, .. } => Some(torsion),
        }
    }
}

/// A finger on the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerContact {
    /// Contact point (m).
    pub point: Vec3,
    /// Unit normal into the object: the direction in which the finger pushes.
    pub normal: Vec3,
    /// The friction model.
    pub friction: Friction,
    /// Largest normal force (N), used by [`GraspMetric::LInf`].
    pub strength: f64,
    /// Curvature of finger and object, in world axes, used by
    /// [`grasp_mobility`](super::super::grasp_mobility()).
    pub curvature: ContactCurvature,
}

impl FingerContact {
    /// Refuses a normal that is no unit vector, non-finite values, and contacts outside the plane.
    pub(super) fn check(&self, space: WrenchSpace) -> Result<()> {
        let (point, normal) = (self.point, self.normal);
        for (name, value) in [("contact point", point), ("contact normal", normal)] {
            Error::check_finite(name, &value.to_array())?;
        }
        if (normal.norm() - 1.0).abs() > ORTHONORMAL {
            return Err(refuse(
                "normal",
                normal.norm(),
                "it must be a unit vector; divide it by its length",
            ));
        }
        if space.planar && (normal.z.abs() > ORTHONORMAL || point.z.abs() > ORTHONORMAL) {
            return Err(refuse("normal", normal.z, "a planar contact must lie in the plane z = 0"));
        }
        Ok(())
    }
}

/// The norm of the normal forces that is bounded in Ferrari and Canny's quality measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GraspMetric {
    /// Q1: the normal forces of all fingers sum to at most 1 N.
    L1,
    /// Q-infinity: the normal force of each finger is at most its strength.
    LInf,
}

impl GraspMetric {
    /// The name in reports: "l1" or "linf".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::L1 => "l1",
            Self::LInf => "linf",
        }
    }
}

/// The point, length and dimension of the wrenches of a grasp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrenchSpace {
    /// The point that moments are about (m).
    pub point: Vec3,
    /// The characteristic length that moments are divided by (m).
    pub length: f64,
    /// True for objects in the plane x-y: forces in it, moments about z.
    pub planar: bool,
}

impl WrenchSpace {
    fn components(self) -> &'static [usize] {
        if self.planar { Dimension::Planar } else { Dimension::Spatial }.components()
    }
}

/// Bounds of the quality epsilon of Ferrari and Canny: the norm of the smallest wrench that the
/// bounded contact forces cannot resist, in its worst direction (N, moments divided by the
/// characteristic length). Not positive without force closure: less the distance of the set of wrenches
/// from zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpsilonQuality {
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

/// The quality of a grasp.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspQuality {
    /// True for force closure: every wrench can be resisted with large enough forces.
    pub closed: bool,
    /// The quality epsilon, with certified bounds.
    pub epsilon: EpsilonQuality,
    /// The worst direction, moments divided by the length: for an open grasp a direction in which
    /// no wrench can be resisted.
    pub weakest: Vec<f64>,
}

/// The quality of a grasp with these contacts.
///
/// ```text
/// w = sum_i G_i f_i,   |f_t / mu|^2 + |m_n / (mu_t)|^2 <= f_n^2,   f_n >= 0
/// epsilon = min over |n| = 1 of max w . n
///     with sum f_n <= 1 (L1), or each f_n <= its strength (LInf)
/// ```
///
/// The wrench w acts on the object, with moments divided by the length of `space`: epsilon is a
/// force (per unit of f_n for L1), and positive for force closure. It is returned with certified
/// lower and upper bounds; friction cones are round.
///
/// Source: Ferrari & Canny 1992; Zheng 2013; soft fingers Howe & Cutkosky 1996.
///
/// ```
/// use cylindroid::closure::{FingerContact, Friction, GraspMetric, WrenchSpace, grasp_quality};
/// use cylindroid::Vec3;
/// use cylindroid::model::ContactCurvature;
///
/// // Two hard fingers press a disc between them.
/// let finger = |x: f64| FingerContact {
///     point: Vec3::new(x, 0.0, 0.0),
///     normal: Vec3::new(-x, 0.0, 0.0),
///     friction: Friction::Hard { mu: 0.5 },
///     strength: 1.0,
///     curvature: ContactCurvature::default(),
/// };
/// let space = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: true };
/// let quality = grasp_quality(&[finger(-1.0), finger(1.0)], space, GraspMetric::L1)?;
/// assert!(quality.closed && quality.epsilon.lower > 0.0);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// A contact normal that is no unit vector, a negative coefficient, a strength that is not
/// positive, non-finite values; a length that is not one of [`LENGTHS`].
pub fn grasp_quality(
    contacts: &[FingerContact],
    space: WrenchSpace,
    metric: GraspMetric,
) -> Result<GraspQuality> {
    Error::check_range("length", space.length, &LENGTHS)?;
    let fingers: Vec<Finger> =
        contacts.iter().map(|c| Finger::new(c, space, metric)).collect::<Result<_>>()?;
    let d = space.components().len();
    let body = |n: &[f64]| body_point(&fingers, metric, n);
    // The smallest value of all directions that the hull asks for.
    let mut known = (f64::INFINITY, [0.0; 6]);
    let support = |n: &[f64]| -> Vec<f64> {
        let wrench = body(n);
        let value = dot(n, &wrench);
        if value < known.0 {
            known = (value, six(n));
        }
        wrench[..d].to_vec()
    };
    let hull = Hull::of(
        d,
        support,
        HullOptions {
            goal: HullGoal::NearestFacet,
            tolerance: GRASP_QUALITY,
            max_facets: MAX_FACETS,
        },
    );
    let size = hull.vertices.iter().map(|v| norm(v)).fold(0.0, f64::max);
    let open = || nearest_point(d, size, |n| body(n));
    if hull.span.cols() < d {
        return Ok(flat(&hull, size, open()));
    }
    let mut found = Smallest {
        lower: hull.nearest_facet().map_or(f64::NEG_INFINITY, |f| f.offset),
        upper: known.0,
        direction: known.1,
    };
    let search = Search {
        dimension: d,
        gap: GRASP_QUALITY * size,
        relative_gap: f64::INFINITY,
        max_simplices: MAX_SIMPLICES,
    };
    if !hull.complete {
        let refined = smallest_support(search, found.direction, |n| body(n));
        found = Smallest { lower: refined.lower.max(found.lower), ..refined };
    }
    if found.lower <= HULL * size && found.upper > HULL * size {
        // The bounds leave the verdict open. The wrenches of one finger at a time are closed
        // exactly if those of all together are, and belong to these.
        let search = Search { relative_gap: 0.5, ..search };
        let one = |n: &Vector| body_point(&fingers, GraspMetric::L1, n);
        let certain = smallest_support(search, found.direction, one);
        let value = dot(&certain.direction, &body(&certain.direction));
        if value < found.upper {
            (found.upper, found.direction) = (value, certain.direction);
        }
        found.lower = found.lower.max(certain.lower);
    }
    let closed = found.lower > HULL * size;
    if !closed {
        // Facets bound it from below only around the origin.
        let nearest = open();
        found.lower = -norm(&nearest.point);
        if nearest.lower > 0.0 && -nearest.lower <= found.upper {
            (found.upper, found.direction) = (-nearest.lower, nearest.away);
        }
    }
    Ok(GraspQuality {
        closed,
        epsilon: EpsilonQuality { lower: found.lower.min(found.upper), upper: found.upper },
        weakest: found.direction[..d].to_vec(),
    })
}

/// The wrench of the fingers that is farthest along `n`.
fn body_point(fingers: &[Finger], metric: GraspMetric, n: &[f64]) -> Vector {
    let mut wrench = [0.0; 6];
    match metric {
        GraspMetric::L1 => {
            let mut best = f64::NEG_INFINITY;
            for finger in fingers {
                let (reach, point) = finger.farthest(n);
                if reach > best {
                    (best, wrench) = (reach, point);
                }
            }
        }
        GraspMetric::LInf => {
            for finger in fingers {
                let (reach, point) = finger.farthest(n);
                if reach > 0.0 {
                    wrench.iter_mut().zip(point).for_each(|(w, x)| *w += x);
                }
            }
        }
    }
    wrench
}

fn six(n: &[f64]) -> Vector {
    std::array::from_fn(|i| n.get(i).copied().unwrap_or(0.0))
}

/// A flat set of wrenches resists nothing normal to it; if it does not contain zero, it even pushes
/// to one side only.
fn flat(hull: &Hull, size: f64, nearest: NearestPoint) -> GraspQuality {
    let distance = norm(&nearest.point);
    let (weakest, epsilon) = if distance > HULL * size && nearest.lower > 0.0 {
        (
            nearest.away[..hull.span.rows()].to_vec(),
            EpsilonQuality { lower: -distance, upper: -nearest.lower },
        )
    } else {
        let across = Qr::plain(hull.span.clone()).complement();
        (across.column(0).to_vec(), EpsilonQuality { lower: 0.0, upper: 0.0 })
    };
    GraspQuality { closed: false, epsilon, weakest }
}

/// A contact with scaled columns: strength and friction are absorbed, so that the cone is `|rest|
/// <= first`.
struct Finger {
    columns: [Vector; 4],
}

impl Finger {
    fn new(contact: &FingerContact, space: WrenchSpace, metric: GraspMetric) -> Result<Self> {
        contact.check(space)?;
        let FingerContact { point, normal, friction, strength, .. } = *contact;
        if metric == GraspMetric::LInf {
            Error::check_positive("strength", strength)?;
        }
        let (mu, torsion) = (friction.mu(), friction.torsion().unwrap_or(0.0));
        for (name, value) in [("mu", mu), ("torsion", torsion)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(refuse(
                    name,
                    value,
                    "coefficients of friction must be finite and not negative",
                ));
            }
        }
        let arm = point - space.point;
        let size = if metric == GraspMetric::LInf { strength } else { 1.0 };
        let column = |force: Vec3, moment: Vec3, scale: f64| -> Vector {
            let moment = (arm.cross(force) + moment) * (1.0 / space.length);
            let w = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
            let components = space.components();
            std::array::from_fn(|i| components.get(i).map_or(0.0, |&c| w[c] * scale * size))
        };
        let [first, second, torsion] = if space.planar {
            [Vec3::new(-normal.y, normal.x, 0.0), Vec3::ZERO, Vec3::ZERO]
        } else {
            let first = across(normal);
            [first, normal.cross(first), normal * torsion]
        };
        let columns = [
            column(normal, Vec3::ZERO, 1.0),
            column(first, Vec3::ZERO, mu),
            column(second, Vec3::ZERO, mu),
            column(Vec3::ZERO, torsion, 1.0),
        ];
        Ok(Self { columns })
    }

    /// Support function along `n` for a normal force of one, and the wrench that attains it.
    fn farthest(&self, n: &[f64]) -> (f64, Vector) {
        let g = self.columns.map(|c| dot(&c, n));
        let slip = norm(&g[1..]);
        let mut wrench = self.columns[0];
        if slip > 0.0 {
            for (column, along) in self.columns[1..].iter().zip(&g[1..]) {
                wrench.iter_mut().zip(column).for_each(|(w, c)| *w += c * (along / slip));
            }
        }
        (g[0] + slip, wrench)
    }
}

/// A unit vector normal to `n`.
fn across(n: Vec3) -> Vec3 {
    let axis = if n.x.abs() < 0.6 { Vec3::X } else { Vec3::new(0.0, 1.0, 0.0) };
    let t = n.cross(axis);
    t * (1.0 / t.norm())
}

fn refuse(option: &'static str, value: f64, reason: &str) -> Error {
    Error::InvalidOption { option, value: value.to_string(), reason: reason.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Also of normals along the axes of the frame, both ways.
    #[test]
    fn directions_across_a_normal() {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        let along = axes.iter().flat_map(|axis| [*axis, -*axis]);
        let tilted = [Vec3::new(0.8, 0.0, 0.6), Vec3::new(-0.48, 0.64, -0.6)];
        for n in along.chain(tilted) {
            let t = across(n);
            assert!(t.dot(n).abs() < 1e-15 && (t.norm() - 1.0).abs() < 1e-15, "{n:?}: {t:?}");
        }
    }

    /// A contact of an object in the plane x-y lies in it, on neither side of it.
    #[test]
    fn contacts_out_of_the_plane_are_refused() {
        let contact = |height: f64, lean: f64| FingerContact {
            point: Vec3::new(0.1, 0.2, height),
            normal: Vec3::new(0.8, (0.36 - lean * lean).sqrt(), lean),
            friction: Friction::Hard { mu: 0.5 },
            strength: 1.0,
            curvature: ContactCurvature::default(),
        };
        let space = |planar| WrenchSpace { point: Vec3::ZERO, length: 1.0, planar };
        assert!(contact(0.0, 0.0).check(space(true)).is_ok());
        for (height, lean) in [(0.1, 0.0), (-0.1, 0.0), (0.0, 0.3), (0.0, -0.3)] {
            let error = contact(height, lean).check(space(true)).unwrap_err().to_string();
            assert!(error.contains("must lie in the plane z = 0"), "{error}");
            assert!(contact(height, lean).check(space(false)).is_ok());
        }
    }
}
