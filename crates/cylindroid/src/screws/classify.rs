//! Classification of a screw system of order one to three (Gibson-Hunt), with its canonical frame.
//!
//! Formula  the decomposition of the 3 x k block of angular parts splits the system into screws
//!          with orthonormal directions w_i and translations T; then the symmetric part A of w_i .
//!          v_j has the principal pitches as eigenvalues, and angles between T and the w_i separate
//!          the rest
//! Shapes   an orthonormal basis of k <= 3 vectors [v / L; w]
//! Units    all without unit: lengths are ratios to L
//! Valid    always gives a class: a quantity at or below its tolerance counts as zero. Every
//!          compared quantity is kept, so that a narrow verdict can be recognised
//! Source   Gibson & Hunt 1990; Donelan & Selig, section 4. The decision by singular values and
//!          eigenvalues instead of determinants is ours: a determinant has no scale
//! Checked  tests/it/screws/classes.rs

use super::class::Class;
use super::span::{Span, angular, join, linear};
use crate::linalg::{Matrix, Svd, SymmetricEigen};
use crate::spatial::{Mat3, Rotation, Vec3};
use crate::tolerance::{CENTER_FREEDOM, ORIGIN_DETERMINED, ZERO_AXIS};

/// The margin of a classification: a quantity compared with the tolerance below which it counts as
/// zero.
///
/// The quantities are the singular values of the 3 x k block of angular parts, which split a system
/// into screws with orthonormal directions w_i and translations T; differences of the principal
/// pitches, the eigenvalues of the symmetric part of A = (w_i . v_j); and angles between T and the
/// w_i. A value close to its threshold is a narrow verdict.
///
/// Source: Gibson & Hunt 1990; Donelan & Selig, section 4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// The compared quantity.
    pub quantity: &'static str,
    /// Its value, without unit: lengths are ratios to the characteristic length.
    pub value: f64,
    /// At or below this it counts as zero.
    pub threshold: f64,
}

/// A system of order one to three in its canonical frame.
#[derive(Debug, Clone)]
pub(crate) struct Classified {
    pub(crate) class: Class,
    /// In units of L.
    pub(crate) pitches: Vec<f64>,
    pub(crate) slope: Option<f64>,
    /// Axes and origin (relative to the centre, in units of L) of the canonical frame.
    pub(crate) rotation: Rotation,
    pub(crate) origin: Vec3,
    pub(crate) margins: Vec<Margin>,
    /// True if a quantity may lie on the other side of its threshold at another point at which the
    /// centre may be.
    pub(crate) depends_on_center: bool,
}

/// The screws of the system with orthonormal directions, and its translations.
struct Split {
    screws: Vec<[f64; 6]>,
    translations: Vec<Vec3>,
    /// The distance by which the centre may lie elsewhere; zero where translations have no angular
    /// part beyond noise, or where the centre is not free.
    way: f64,
    /// The change of a translation's direction on this way.
    turn: f64,
}

/// A verdict before the origin is known: axes, pitch along each of the first axes.
struct Verdict {
    class: Class,
    pitches: Vec<f64>,
    slope: Option<f64>,
    axes: [Vec3; 3],
}

/// `noise`: the angular part of a translation that noise may leave.
pub(crate) fn classify(span: &Span, tolerance: f64, noise: f64) -> Classified {
    let mut margins = Vec::with_capacity(4);
    let split = split(span, tolerance, noise, &mut margins);
    let mut depends_on_center = false;
    // A quantity and its change with the centre.
    let mut is_zero = |quantity: &'static str, value: f64, change: f64| {
        margins.push(Margin { quantity, value, threshold: tolerance });
        depends_on_center |= (value - tolerance).abs() < change;
        value <= tolerance
    };
    let verdict = match (span.k(), split.translations.as_slice()) {
        (1, []) => one_screw(&split),
        (1, [t]) => along(Class::Inf, vec![], None, *t, perpendicular(*t)),
        (2, []) => two_screws(&split, &mut is_zero),
        (2, [t]) => screw_and_translation(&split, *t, &mut is_zero),
        (2, [t, u]) => along(Class::IIC, vec![], None, *t, *u),
        (3, []) => three_screws(&split, &mut is_zero),
        (3, [t]) => two_screws_and_translation(&split, *t, &mut is_zero),
        (3, [t, u]) => screw_and_plane(&split, *t, *u, &mut is_zero),
        _ => along(Class::IID, vec![], None, Vec3::X, Vec3::Y),
    };
    let origin = origin(&split, &verdict);
    Classified {
        class: verdict.class,
        pitches: verdict.pitches,
        slope: verdict.slope,
        rotation: Rotation::assume(Mat3 { cols: verdict.axes }).renormalised(),
        origin,
        margins,
        depends_on_center,
    }
}

/// Screws with orthonormal angular parts, then translations: the basis turned by the right
/// singular vectors of its angular block.
fn split(span: &Span, tolerance: f64, noise: f64, margins: &mut Vec<Margin>) -> Split {
    let k = span.k();
    // A row of zeros makes the block tall: the decomposition then has all right singular vectors.
    let block = Matrix::from_fn(4, k, |i, j| if i < 3 { span.vectors()[j][3 + i] } else { 0.0 });
    let svd = Svd::of(&block);
    let (screws, translations) = (Vec::with_capacity(k), Vec::with_capacity(k));
    let mut split = Split { screws, translations, way: 0.0, turn: 0.0 };
    for i in 0..k {
        let sigma = svd.value(i);
        let mut x = [0.0; 6];
        for (b, v) in span.vectors().iter().zip(svd.v(i)) {
            x.iter_mut().zip(b).for_each(|(xi, bi)| *xi += v * bi);
        }
        margins.push(Margin {
            quantity: "angular part of a screw",
            value: sigma,
            threshold: tolerance,
        });
        if sigma > tolerance {
            split.screws.push(x.map(|a| a / sigma));
        } else {
            let t = linear(&x);
            split.translations.push(t * (1.0 / t.norm()));
            if sigma > noise && !split.screws.is_empty() {
                for e in span.free_translations(tolerance) {
                    split.way = CENTER_FREEDOM;
                    split.turn = split.turn.max(angular(&x).cross(e).norm() * split.way);
                }
            }
        }
    }
    split
}

fn along(class: Class, pitches: Vec<f64>, slope: Option<f64>, x: Vec3, y: Vec3) -> Verdict {
    // Exactly orthonormal, whatever rounding left.
    let x = x * (1.0 / x.norm());
    let y = y - x * x.dot(y);
    let y = y * (1.0 / y.norm());
    Verdict { class, pitches, slope, axes: [x, y, x.cross(y)] }
}

/// A unit vector across `a`: exact for the coordinate axes.
fn perpendicular(a: Vec3) -> Vec3 {
    Rotation::z_to(a).map_or(Vec3::X, Rotation::x_axis)
}

fn pitch(x: &[f64; 6]) -> f64 {
    linear(x).dot(angular(x))
}

/// Principal pitches, largest first, and the directions of their screws.
fn principal(screws: &[[f64; 6]]) -> ([f64; 3], [Vec3; 3]) {
    let mut a = [[0.0; 3]; 3];
    for (i, x) in screws.iter().enumerate() {
        for (j, y) in screws.iter().enumerate().skip(i) {
            a[i][j] = 0.5 * (linear(x).dot(angular(y)) + linear(y).dot(angular(x)));
        }
    }
    let eigen = SymmetricEigen::of(a, screws.len());
    let direction = |i: usize| {
        screws.iter().zip(eigen.vectors[i]).fold(Vec3::ZERO, |s, (x, c)| s + angular(x) * c)
    };
    (eigen.values, [0, 1, 2].map(direction))
}

fn one_screw(split: &Split) -> Verdict {
    let x = &split.screws[0];
    along(Class::H, vec![pitch(x)], None, angular(x), perpendicular(angular(x)))
}

const GAP: &str = "difference of principal pitches";

fn two_screws(split: &Split, is_zero: &mut impl FnMut(&'static str, f64, f64) -> bool) -> Verdict {
    let (h, w) = principal(&split.screws);
    if is_zero(GAP, h[0] - h[1], 0.0) {
        return along(Class::IIA, vec![0.5 * (h[0] + h[1])], None, w[0], w[1]);
    }
    along(Class::IA, vec![h[0], h[1]], None, w[0], w[1])
}

fn screw_and_translation(
    split: &Split,
    t: Vec3,
    is_zero: &mut impl FnMut(&'static str, f64, f64) -> bool,
) -> Verdict {
    let x = &split.screws[0];
    let w = angular(x);
    let lean = w.dot(t);
    if is_zero("cosine of translation and axis", lean.abs(), split.turn) {
        return along(Class::IIB, vec![pitch(x)], None, w, t);
    }
    let t = if lean < 0.0 { -t } else { t };
    let across = t - w * w.dot(t);
    let slope = across.norm() / lean.abs();
    let y = if across.norm() > ZERO_AXIS { across } else { perpendicular(w) };
    along(Class::IB, vec![], Some(slope), w, y)
}

fn three_screws(
    split: &Split,
    is_zero: &mut impl FnMut(&'static str, f64, f64) -> bool,
) -> Verdict {
    let (h, w) = principal(&split.screws);
    match (is_zero(GAP, h[0] - h[1], 0.0), is_zero(GAP, h[1] - h[2], 0.0)) {
        (true, true) => along(Class::IIA, vec![(h[0] + h[1] + h[2]) / 3.0], None, w[0], w[1]),
        (true, false) => along(Class::IA2, vec![h[2], 0.5 * (h[0] + h[1])], None, w[2], w[0]),
        (false, true) => along(Class::IA2, vec![h[0], 0.5 * (h[1] + h[2])], None, w[0], w[1]),
        (false, false) => along(Class::IA1, h.to_vec(), None, w[0], w[1]),
    }
}

fn two_screws_and_translation(
    split: &Split,
    t: Vec3,
    is_zero: &mut impl FnMut(&'static str, f64, f64) -> bool,
) -> Verdict {
    let (a, b) = (&split.screws[0], &split.screws[1]);
    let n = angular(a).cross(angular(b));
    let n = n * (1.0 / n.norm());
    let in_plane = t - n * n.dot(t);
    if is_zero("translation in the plane of the axes", in_plane.norm(), split.turn) {
        let (h, w) = principal(&split.screws);
        // A screw changes by the translation times the way, and its pitch by the cosine of this.
        let change = 2.0 * split.way * (in_plane.norm() + split.turn);
        if is_zero(GAP, h[0] - h[1], change) {
            return along(Class::IIB, vec![0.5 * (h[0] + h[1])], None, w[0], w[1]);
        }
        return along(Class::IB3, vec![h[0], h[1]], None, w[0], w[1]);
    }
    let n = if n.dot(t) < 0.0 { -n } else { n };
    let e1 = in_plane * (1.0 / in_plane.norm());
    let e2 = n.cross(e1);
    // The screw of the system along e2: its pitch does not feel the translation, which is across.
    let x = combine(a, e2.dot(angular(a)), b, e2.dot(angular(b)));
    let h = pitch(&x);
    along(Class::IB0, vec![h], Some(n.dot(t) / in_plane.norm()), e1, e2)
}

fn screw_and_plane(
    split: &Split,
    t: Vec3,
    u: Vec3,
    is_zero: &mut impl FnMut(&'static str, f64, f64) -> bool,
) -> Verdict {
    let x = &split.screws[0];
    let w = angular(x);
    if is_zero("axis in the plane of the translations", w.dot(t).hypot(w.dot(u)), 2.0 * split.turn)
    {
        return along(Class::IIC, vec![pitch(x)], None, w, t);
    }
    let normal = t.cross(u);
    let across = w.cross(normal);
    let across = across * (1.0 / across.norm());
    let other = normal.cross(across); // on the side of w
    // The second axis is turned about, if need be, so that p is not negative.
    let slope = other.dot(w.cross(across)) / other.dot(w);
    along(Class::IC, vec![], Some(slope.abs()), w, if slope < 0.0 { -across } else { across })
}

fn combine(a: &[f64; 6], alpha: f64, b: &[f64; 6], beta: f64) -> [f64; 6] {
    std::array::from_fn(|i| alpha * a[i] + beta * b[i])
}

/// The point at which the screws along the axes have the pitches of the form and no other linear
/// velocity, up to the translations: least squares of `v_i + w_i x o - h_i e_i` across T. Where it
/// is not determined (along the axis of a single screw, say) it stays nearest to the centre.
fn origin(split: &Split, verdict: &Verdict) -> Vec3 {
    let plane = Span::of_independent(split.translations.iter().map(|t| join(*t, Vec3::ZERO)));
    let across = |x: Vec3| {
        let mut rest = join(x, Vec3::ZERO);
        plane.project_out(&mut rest);
        linear(&rest)
    };
    let mut a = [[0.0; 3]; 3];
    let mut rhs = Vec3::ZERO;
    for (i, e) in verdict.axes.iter().take(split.screws.len()).enumerate() {
        // The screw of the system along e.
        let coefficients: Vec<f64> = split.screws.iter().map(|x| e.dot(angular(x))).collect();
        let v =
            split.screws.iter().zip(&coefficients).fold(Vec3::ZERO, |s, (x, c)| s + linear(x) * *c);
        let h = match verdict.class {
            Class::IB | Class::IC => 0.0,
            _ => *verdict.pitches.get(i).or(verdict.pitches.last()).unwrap_or(&0.0),
        };
        rhs -= across(v - *e * h).cross(*e);
        for (j, unit) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            let column = across(e.cross(unit)).cross(*e).to_array();
            for (row, c) in a.iter_mut().zip(column).take(j + 1) {
                row[j] += c;
            }
        }
    }
    let eigen = SymmetricEigen::of(a, 3);
    let mut o = Vec3::ZERO;
    for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
        if *value > ORIGIN_DETERMINED {
            let e = Vec3::from_array(vector);
            o += e * (e.dot(rhs) / value);
        }
    }
    o
}

/// The system that a normal form spans in its frame, for the residual.
pub(crate) fn placed(classified: &Classified, generators: &[[f64; 6]]) -> Span {
    let r = classified.rotation;
    Span::of_independent(generators.iter().map(|g| {
        let w = r * angular(g);
        join(r * linear(g) + classified.origin.cross(w), w)
    }))
}
