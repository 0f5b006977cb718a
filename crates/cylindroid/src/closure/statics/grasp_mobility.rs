//! Mobility of a grasped object: immobilisation to first and to second order by fixed frictionless
//! fingers.
//!
//! Formula  gaps d_i of the fingers, d_i' = g_i . u, d_i'' = u^T H_i u (`contact_gap.rs`); f: forces
//!          in equilibrium, sum f_i g_i = 0, f >= 0. Free motions: g_i . u >= 0 for all i; their
//!          dimension is the first-order mobility. The relative curvature form sum f_i H_i on them
//!          does not depend on the parametrisation of the motion
//! Shapes   k contacts, u: d entries (d = 6, or 3 in the plane)
//! Units    sum f_i = 1; motions with |v|^2 + L^2 |w|^2 = 1 at the centre of the contacts, L their
//!          largest distance from it, so that eigenvalues are in 1/m
//! Frame    twists of the object at the point of `space`, world axes
//! Valid    any point contacts; friction and strength do not count. A definite form is a proof, so is
//!          an escape (verified to second order); otherwise the verdict says that it is open
//! Why so   three frictionless fingers in the plane and four in space never immobilise to first
//!          order, but often by their curvature
//! Source   Rimon & Burdick 1998, parts I and II; first order: Reuleaux 1875. The mobility indices
//!          m1 and m2 of part II are `first_order_mobility` and `second_order_mobility`
//! Checked  tests/it/closure/grasp_mobility/mod.rs

use std::fmt;

use super::contact_gap::ContactGap;
use super::equilibrium_forces::{EquilibriumForces, MAX_CONTACTS, MAX_EDGES};
use super::force_closure::{FingerContact, WrenchSpace};
use super::relative_curvature::RelativeCurvature;
use super::separating_direction::separating_direction;
use crate::error::{Error, Result};
use crate::linalg::{ColumnSpace, Matrix, Threshold, dot, norm};
use crate::spatial::Vec3;
use crate::tolerance::{
    CLOSED, CLOSURE_RANK, EQUAL_CURVATURES, LENGTHS, MAX_MAGNITUDE, SECOND_ORDER,
};

/// The verdict on the mobility of a grasped object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Immobilisation {
    /// No first-order free motion: form closure.
    FirstOrder,
    /// All first-order free motions are blocked by curvature, proved by a definite form.
    SecondOrder,
    /// The object can leave the fingers, proved by an escape.
    Mobile,
    /// The form vanishes along a motion: orders above the second decide.
    HigherOrder,
    /// Neither forces that block all motions nor an escape were found.
    NotProved,
}

impl Immobilisation {
    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FirstOrder => "immobile to first order",
            Self::SecondOrder => "immobile to second order",
            Self::Mobile => "mobile",
            Self::HigherOrder => "undecided: higher order",
            Self::NotProved => "undecided: not proved",
        }
    }

    /// The reason, as a sentence.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::FirstOrder => "form closure: no motion is free to first order",
            Self::SecondOrder => {
                "the relative curvature form of the equilibrium forces is negative definite on \
                 the free motions"
            }
            Self::Mobile => "a free motion opens all gaps",
            Self::HigherOrder => {
                "a free motion keeps the gaps closed to second order; orders above the second \
                 decide"
            }
            Self::NotProved => {
                "no equilibrium forces that block all free motions were found, and no free \
                 motion that opens all gaps"
            }
        }
    }

    /// True if the object is immobilised, false if it is mobile; none if undecided.
    #[must_use]
    pub const fn is_immobile(self) -> Option<bool> {
        match self {
            Self::FirstOrder | Self::SecondOrder => Some(true),
            Self::Mobile => Some(false),
            Self::HigherOrder | Self::NotProved => None,
        }
    }
}

impl fmt::Display for Immobilisation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A motion of the object that opens all gaps: it is displaced by exp(t velocity + t^2/2
/// acceleration), twists in world axes at the point of the wrench space.
#[derive(Debug, Clone, PartialEq)]
pub struct Escape {
    /// Twist at the start.
    pub velocity: Vec<f64>,
    /// Its derivative.
    pub acceleration: Vec<f64>,
}

/// The mobility of a grasped object.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspMobility {
    /// The verdict.
    pub immobilisation: Immobilisation,
    /// Dimension of the cone of first-order free motions (m1 of Rimon & Burdick): 0 for form
    /// closure.
    pub first_order_mobility: usize,
    /// Number of eigenvalues of the relative curvature form for `forces` that are not negative (m2
    /// of Rimon & Burdick); none without equilibrium.
    pub second_order_mobility: Option<usize>,
    /// Extreme equilibrium forces, a column for each: normal forces of the contacts that sum to 1.
    /// All forces in equilibrium are their combinations with positive weights.
    pub equilibria: Matrix,
    /// The equilibrium forces of the relative curvature form: the mean of the extreme ones, or, if
    /// their form is not negative definite and others block all free motions, the first that do on
    /// the central path to the form with the least largest eigenvalue. Empty without equilibrium.
    pub forces: Vec<f64>,
    /// Free motions as columns: principal motions of the relative curvature form, with
    /// `|v|^2 + L^2 |w|^2 = 1` at the centre of the contacts.
    pub free_motions: Matrix,
    /// Eigenvalue of the relative curvature form for each free motion, largest first (1/m): the
    /// mean of the gaps' second derivatives, weighted by the forces. Empty without equilibrium.
    pub curvatures: Vec<f64>,
    /// An escape of a mobile object.
    pub escape: Option<Escape>,
    /// True if the rank of the contact normals is numerically ambiguous.
    pub ambiguous: bool,
}

/// The mobility of an object between fixed frictionless fingers, to second order.
///
/// ```text
/// d_i' = g_i . u >= 0,   d_i'' = u^T H_i u,   sum f_i g_i = 0,  f >= 0
/// immobile if sum f_i H_i is negative definite on the free motions u
/// ```
///
/// The curvatures of both bodies count, friction does not.
///
/// Source: Rimon & Burdick 1998, parts I and II.
///
/// ```
/// use cylindroid::Vec3;
/// use cylindroid::closure::{
///     FingerContact, Friction, Immobilisation, WrenchSpace, grasp_mobility,
/// };
/// use cylindroid::model::{ContactCurvature, SurfaceCurvature};
///
/// // Three fingers at the feet of the incircle of an equilateral triangle.
/// let finger = |degrees: f64| {
///     let (sin, cos) = degrees.to_radians().sin_cos();
///     let outward = Vec3::new(cos, sin, 0.0);
///     FingerContact {
///         point: outward,
///         normal: -outward,
///         friction: Friction::None,
///         strength: 1.0,
///         curvature: ContactCurvature::default(),
///     }
/// };
/// let mut fingers = [30.0, 150.0, 270.0].map(finger);
/// let space = WrenchSpace { point: Vec3::ZERO, length: 1.0, planar: true };
/// let triangle = grasp_mobility(&fingers, space)?;
/// assert_eq!(triangle.immobilisation, Immobilisation::SecondOrder);
/// assert_eq!((triangle.first_order_mobility, triangle.second_order_mobility), (1, Some(0)));
///
/// // A disc rotates between them.
/// fingers.iter_mut().for_each(|f| f.curvature.object = SurfaceCurvature::uniform(1.0));
/// assert_eq!(grasp_mobility(&fingers, space)?.immobilisation, Immobilisation::HigherOrder);
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// # Errors
/// Contacts that [`grasp_quality`](super::super::grasp_quality()) refuses; curvatures whose sum
/// is not positive in all directions; too many contacts.
#[doc(alias = "immobilization")]
#[doc(alias = "form closure")]
pub fn grasp_mobility(contacts: &[FingerContact], space: WrenchSpace) -> Result<GraspMobility> {
    Error::check_range("length", space.length, &LENGTHS)?;
    Error::check_within("point", &space.point.to_array(), MAX_MAGNITUDE)?;
    for contact in contacts {
        contact.check(space)?;
    }
    let too_many = |reason: String| Error::InvalidOption {
        option: "contacts",
        value: contacts.len().to_string(),
        reason,
    };
    if contacts.len() > MAX_CONTACTS {
        return Err(too_many(format!("at most {MAX_CONTACTS} contacts; leave out some")));
    }
    let own = own_space(contacts, space);
    let gaps: Vec<ContactGap> = contacts.iter().map(|c| gap(c, own)).collect::<Result<Vec<_>>>()?;
    let d = if space.planar { 3 } else { 6 };
    let grasp = Matrix::from_fn(d, gaps.len(), |i, j| gaps[j].gradient[i]);
    let found = EquilibriumForces::of(&grasp).ok_or_else(|| {
        too_many(format!("more than {MAX_EDGES} extreme equilibrium forces; leave out contacts"))
    })?;
    Ok(Analysis { gaps, space, own, edges: found.edges, ambiguous: found.cut.is_ambiguous() }
        .report(d))
}

/// About the centre of the contacts, with their largest distance from it as length.
fn own_space(contacts: &[FingerContact], space: WrenchSpace) -> WrenchSpace {
    let count = f64::from(u32::try_from(contacts.len().max(1)).unwrap_or(u32::MAX));
    let sum = contacts.iter().fold(Vec3::ZERO, |sum, c| sum + c.point);
    let point = if contacts.is_empty() { space.point } else { sum * (1.0 / count) };
    let farthest = contacts.iter().map(|c| (c.point - point).norm()).fold(0.0, f64::max);
    let length = if farthest > CLOSED * space.length { farthest } else { space.length };
    WrenchSpace { point, length, planar: space.planar }
}

fn gap(contact: &FingerContact, space: WrenchSpace) -> Result<ContactGap> {
    let refuse = |reason: String| Error::InvalidOption {
        option: "curvature",
        value: format!(
            "{:?}, {:?}",
            contact.curvature.finger.principal, contact.curvature.object.principal
        ),
        reason,
    };
    contact.curvature.check(contact.normal, space.planar).map_err(refuse)?;
    let gap = ContactGap::of(contact, space)
        .ok_or_else(|| refuse("the contact has no tangent plane".to_owned()))?;
    if !gap.form.frobenius_norm().is_finite() {
        return Err(refuse(format!("it is out of range for contacts {:e} m apart", space.length)));
    }
    Ok(gap)
}

/// Orthonormal motions with those of equal eigenvalues rotated so that each is a projection of a
/// coordinate axis, the nearest first: rounding does not choose among them, nor the sign.
fn along_axes(motions: &Matrix, values: &[f64]) -> Matrix {
    let (d, m) = (motions.rows(), motions.cols());
    let mut found: Vec<Vec<f64>> = Vec::new();
    let mut from = 0;
    while from < m {
        let equal = |value: &&f64| (values[from] - **value).abs() <= EQUAL_CURVATURES;
        let to = from + values[from..].iter().take_while(equal).count().max(1);
        for _ in from..to {
            // Projections of the axes, without the motions found.
            let remaining = |axis: usize| -> Vec<f64> {
                let mut rest = vec![0.0; d];
                for j in from..to {
                    let column = motions.column(j);
                    rest.iter_mut().zip(column).for_each(|(r, c)| *r += column[axis] * c);
                }
                for own in &found[from..] {
                    let share = dot(own, &rest);
                    rest.iter_mut().zip(own).for_each(|(r, o)| *r -= share * o);
                }
                rest
            };
            let mut best = (0.0, vec![0.0; d]);
            for rest in (0..d).map(remaining) {
                let size = norm(&rest);
                if size > best.0 + EQUAL_CURVATURES {
                    best = (size, rest);
                }
            }
            found.push(best.1.iter().map(|x| x / best.0).collect());
        }
        from = to;
    }
    Matrix::from_fn(d, m, |i, j| found[j][i])
}

/// Mobile if there is an escape.
fn proved_by(escape: Option<&Escape>) -> Immobilisation {
    escape.map_or(Immobilisation::NotProved, |_| Immobilisation::Mobile)
}

struct Analysis {
    gaps: Vec<ContactGap>,
    /// Of the results.
    space: WrenchSpace,
    /// Of the computation.
    own: WrenchSpace,
    edges: Vec<Vec<f64>>,
    ambiguous: bool,
}

impl Analysis {
    fn report(&self, d: usize) -> GraspMobility {
        let k = self.gaps.len();
        let presses: Vec<bool> = (0..k).map(|i| self.edges.iter().any(|e| e[i] > 0.0)).collect();
        let pressing: Vec<usize> = (0..k).filter(|&i| presses[i]).collect();
        let normals = Matrix::from_fn(d, pressing.len(), |i, j| self.gaps[pressing[j]].gradient[i]);
        let space = ColumnSpace::of(&normals, Threshold::Relative(CLOSURE_RANK));
        let kernel = space.complement();
        let m = kernel.cols();
        let mut report = GraspMobility {
            immobilisation: Immobilisation::FirstOrder,
            first_order_mobility: m,
            second_order_mobility: None,
            equilibria: Matrix::from_fn(k, self.edges.len(), |i, j| self.edges[j][i]),
            forces: Vec::new(),
            free_motions: Matrix::zeros(d, 0),
            curvatures: Vec::new(),
            escape: None,
            ambiguous: self.ambiguous || (space.cut().is_ambiguous() && !pressing.is_empty()),
        };
        if self.edges.is_empty() {
            report.free_motions = self.twists(&kernel);
            let rates: Vec<Vec<f64>> = self.gaps.iter().map(|g| g.gradient.clone()).collect();
            let any = || (0..d).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
            let velocity = if k == 0 { Some(any()) } else { separating_direction(&rates) };
            report.escape = velocity.map(|velocity| self.escape(&velocity, &vec![0.0; d]));
            report.immobilisation = proved_by(report.escape.as_ref());
            return report;
        }
        // Forms relative to the largest of the pressing contacts, which is not zero: those on the
        // free motions may all vanish.
        let restricted = |form: &Matrix| &(&kernel.transpose() * form) * &kernel;
        let forms: Vec<Matrix> = self.gaps.iter().map(|g| restricted(&g.form)).collect();
        let sizes = pressing.iter().map(|&i| self.gaps[i].form.frobenius_norm());
        let size = sizes.fold(0.0, f64::max);
        let weighted = |edge: &Vec<f64>| {
            Matrix::from_fn(m, m, |i, j| {
                edge.iter().zip(&forms).map(|(f, form)| f * form[(i, j)] / size).sum()
            })
        };
        let walls: Vec<Vec<f64>> = (0..k)
            .filter(|&i| !presses[i])
            .map(|i| (0..m).map(|j| dot(kernel.column(j), &self.gaps[i].gradient)).collect())
            .collect();
        let forms = self.edges.iter().map(weighted).collect();
        let curvature = RelativeCurvature { forms, walls, motions: m };
        let combination = curvature.blocking();
        let eigen = curvature.eigen(&combination.weights);
        let forces = (0..k).map(|i| {
            self.edges.iter().zip(&combination.weights).map(|(edge, w)| w * edge[i]).sum()
        });
        report.forces = forces.collect();
        let principal = Matrix::from_fn(m, m, |i, j| eigen.vectors[j][i]);
        let principal = along_axes(&(&kernel * &principal), &eigen.values[..m]);
        report.free_motions = self.twists(&principal);
        report.curvatures =
            eigen.values[..m].iter().map(|value| value * size / self.own.length).collect();
        report.second_order_mobility =
            Some(eigen.values[..m].iter().filter(|value| **value >= -SECOND_ORDER).count());
        report.immobilisation = if m == 0 {
            Immobilisation::FirstOrder
        } else if combination.blocks {
            Immobilisation::SecondOrder
        } else {
            match curvature.opening(&combination) {
                Some((least, y)) if least > SECOND_ORDER => {
                    let mut velocity = kernel.mul_vec(&y);
                    // Without walls the opposite motion opens them as much.
                    let first = velocity.iter().find(|x| x.abs() > EQUAL_CURVATURES);
                    if curvature.walls.is_empty() && first.is_some_and(|x| *x < 0.0) {
                        velocity.iter_mut().for_each(|x| *x = -*x);
                    }
                    report.escape = self.second_order_escape(&velocity, &presses);
                    proved_by(report.escape.as_ref())
                }
                // Along this motion all gaps stay closed to second order.
                Some((least, _)) if least >= -SECOND_ORDER => Immobilisation::HigherOrder,
                _ => Immobilisation::NotProved,
            }
        };
        report
    }

    /// With an acceleration for which the gaps that the velocity keeps closed open.
    fn second_order_escape(&self, velocity: &[f64], presses: &[bool]) -> Option<Escape> {
        let d = velocity.len();
        let closed = self.gaps.iter().zip(presses).filter(|(_, presses)| **presses);
        let mut rates: Vec<Vec<f64>> = closed
            .map(|(gap, _)| {
                let mut row = gap.gradient.clone();
                row.push(gap.second(velocity));
                row
            })
            .collect();
        // The share of the velocity is positive.
        rates.push((0..=d).map(|i| if i == d { 1.0 } else { 0.0 }).collect());
        let found = separating_direction(&rates)?;
        let acceleration: Vec<f64> = found[..d].iter().map(|a| a / found[d]).collect();
        Some(self.escape(velocity, &acceleration))
    }

    /// Of scaled twists at the centre of the contacts: at the point of the space, as those of the
    /// free motions.
    fn escape(&self, velocity: &[f64], acceleration: &[f64]) -> Escape {
        let size = norm(velocity);
        // Motions of length one in metres: time is scaled by 1 / (size L).
        let rate = 1.0 / (size * self.own.length);
        let scaled = |u: &[f64], by: f64| self.moved(u.iter().map(|x| x * by).collect());
        Escape { velocity: scaled(velocity, rate), acceleration: scaled(acceleration, rate * rate) }
    }

    /// Unit motions as columns.
    fn twists(&self, scaled: &Matrix) -> Matrix {
        let columns: Vec<Vec<f64>> = (0..scaled.cols())
            .map(|j| self.moved(scaled.column(j).iter().map(|x| x / self.own.length).collect()))
            .collect();
        Matrix::from_fn(scaled.rows(), scaled.cols(), |i, j| columns[j][i])
    }

    /// A twist at the centre, linear part over the length, as twist at the point of the space.
    fn moved(&self, mut u: Vec<f64>) -> Vec<f64> {
        let arm = self.space.point - self.own.point;
        let planar = self.space.planar;
        let angular = if planar { Vec3::new(0.0, 0.0, u[2]) } else { Vec3::new(u[3], u[4], u[5]) };
        let linear = angular.cross(arm).to_array();
        for i in 0..if planar { 2 } else { 3 } {
            u[i] = u[i] * self.own.length + linear[i];
        }
        u
    }
}
