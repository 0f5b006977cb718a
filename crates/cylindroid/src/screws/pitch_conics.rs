//! The conics in which a three-system meets the pitch quadrics, in the plane of its screws.
//!
//! Formula  x^T (K - h W) x = 0 with K = B^T Q_0 B, W = -B^T Q_inf B: a pencil of conics, of which
//!          those of the principal pitches are singular: det(K - h W) = 0
//! Shapes   B: 6 x 3, the generators; x: homogeneous coordinates of a screw of the system
//! Units    h in m/rad; translations among the generators count with the characteristic length
//! Frame    none: the coordinates are those of the generators
//! Valid    order 3, any class. For IA1 the conics of the largest and the smallest pitch are points
//!          and that of the middle pitch is a pair of lines; between them the conics are real and
//!          surround one of the points; outside of them no screw has the pitch
//! Why so   the eigenvectors of a symmetric matrix give all points of a conic in closed form, also
//!          of the singular ones, with no search and no gap
//! Source   Ball 1900, chapter XII (the pitch conics); Donelan & Selig, section 3 and figure 1
//! Checked  tests/it/screws/pitch_conics.rs

use super::system::ScrewSystem;
use crate::linalg::{SymmetricEigen, max_abs, norm};
use crate::spatial::{Twist, Vec3};
use crate::tolerance::SCREW_CLASS;

/// What a conic of the pencil is, over the reals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConicKind {
    /// No screw has the pitch.
    Empty,
    /// One screw: the conic is a pair of conjugate complex lines.
    Point,
    /// A regular conic.
    Regular,
    /// A pair of lines: two pencils (two-systems) of screws of the pitch.
    LinePair,
    /// A double line.
    DoubleLine,
    /// Every screw of the system has the pitch, or is a translation.
    Plane,
}

impl ConicKind {
    /// Its name in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::Point => "point",
            Self::Regular => "regular conic",
            Self::LinePair => "pair of lines",
            Self::DoubleLine => "double line",
            Self::Plane => "whole plane",
        }
    }
}

/// The pencil of pitch conics of a three-system: the screws of each pitch in the projective plane
/// of its screws.
///
/// ```text
/// twist B x,   pitch x^T K x / x^T W x,   conic of pitch h: x^T (K - h W) x = 0
/// ```
///
/// The coordinates x refer to three generators: for class IA1 the principal screws, with rotations
/// of 1 rad/s; translations have the characteristic length per second.
#[derive(Debug, Clone, PartialEq)]
pub struct PitchConics {
    /// The generators B, in the frame of the twists of the system.
    pub generators: [Twist; 3],
    /// K, the Klein form (m/rad for rotations).
    pub klein: [[f64; 3]; 3],
    /// W, the product of angular parts.
    pub angular: [[f64; 3]; 3],
    length: f64,
}

impl PitchConics {
    /// The matrix `K - h W` of the conic of pitch `h` (m/rad); of infinite pitch `-W`.
    #[must_use]
    pub fn conic(&self, h: f64) -> [[f64; 3]; 3] {
        let entry = |i: usize, j: usize| {
            if h.is_infinite() {
                -self.angular[i][j]
            } else {
                self.klein[i][j] - h * self.angular[i][j]
            }
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    /// The kind of the conic of pitch `h`.
    #[must_use]
    pub fn kind(&self, h: f64) -> ConicKind {
        if h.is_nan() {
            return ConicKind::Empty; // no screw has this pitch
        }
        let (_, [plus, minus]) = self.eigen(h);
        match (plus + minus, plus.min(minus)) {
            (3, 0) => ConicKind::Empty,
            (3, _) => ConicKind::Regular,
            (2, 0) => ConicKind::Point,
            (2, _) => ConicKind::LinePair,
            (1, _) => ConicKind::DoubleLine,
            _ => ConicKind::Plane,
        }
    }

    /// Points of the conic of pitch `h`, as closed curves of unit vectors x: a regular conic is one
    /// curve of `count` points and the first again, a line half a great circle, a point a single
    /// vector. Empty and whole conics have none.
    ///
    /// ```
    /// use cylindroid::screws::{ConicKind, Screw, ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let screw = |axis, pitch| Twist { linear: axis * pitch, angular: axis };
    /// let twists = [screw(Vec3::X, 0.3), screw(Vec3::Y, 0.1), screw(Vec3::Z, -0.2)];
    /// let system = ScrewSystem::of(&twists, &ScrewOptions::default())?;
    /// let conics = system.pitch_conics().unwrap();
    /// assert_eq!(conics.kind(0.0), ConicKind::Regular);
    /// for x in &conics.points(0.0, 32)[0] {
    ///     assert!(Screw::of(conics.twist(*x)).unwrap().pitch.abs() < 1e-15);
    /// }
    /// assert_eq!((conics.kind(0.1), conics.points(0.1, 32).len()), (ConicKind::LinePair, 2));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn points(&self, h: f64, count: usize) -> Vec<Vec<[f64; 3]>> {
        let (eigen, signature) = self.eigen(h);
        let [e0, e1, e2] = eigen.vectors;
        let unit = |x: [f64; 3]| {
            let size = norm(&x);
            x.map(|a| a / size)
        };
        let sum = |a: f64, u: [f64; 3], b: f64, v: [f64; 3], c: f64, w: [f64; 3]| {
            unit(std::array::from_fn(|i| a * u[i] + b * v[i] + c * w[i]))
        };
        // Half a great circle is a whole line of the projective plane.
        let line = |u: [f64; 3], v: [f64; 3]| -> Vec<[f64; 3]> {
            let angle = |k: usize| std::f64::consts::PI * k as f64 / count.max(2) as f64;
            let at = |k: usize| angle(k).sin_cos();
            (0..=count.max(2)).map(|k| sum(at(k).1, u, at(k).0, v, 0.0, u)).collect()
        };
        let [l0, l1, l2] = eigen.values.map(|l| l.abs().sqrt());
        let around = |(a, u): (f64, [f64; 3]), (b, v): (f64, [f64; 3]), (c, w): (f64, [f64; 3])| {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / count.max(3) as f64;
            (0..=count.max(3))
                .map(|k| {
                    let (s, t) = angle(k).sin_cos();
                    sum(t / a, u, s / b, v, 1.0 / c, w)
                })
                .collect::<Vec<_>>()
        };
        // Eigenvalues are in descending order.
        match signature {
            [2, 1] => vec![around((l0, e0), (l1, e1), (l2, e2))],
            [1, 2] => vec![around((l1, e1), (l2, e2), (l0, e0))],
            [1, 1] => {
                [1.0, -1.0].map(|sign| line(e1, sum(l2, e0, sign * l0, e2, 0.0, e0))).to_vec()
            }
            [2, 0] => vec![vec![e2]],
            [0, 2] => vec![vec![e0]],
            [1, 0] => vec![line(e1, e2)],
            [0, 1] => vec![line(e0, e1)],
            _ => Vec::new(),
        }
    }

    /// The twist with coordinates x.
    #[must_use]
    pub fn twist(&self, x: [f64; 3]) -> Twist {
        let [a, b, c] = self.generators;
        a * x[0] + b * x[1] + c * x[2]
    }

    /// The coordinates x of a twist of the system, of length one; `None` for a twist of which
    /// nothing lies in the system.
    #[must_use]
    pub fn coordinates(&self, twist: Twist) -> Option<[f64; 3]> {
        let scaled = |t: Twist| {
            let v = t.linear * (1.0 / self.length);
            [v.x, v.y, v.z, t.angular.x, t.angular.y, t.angular.z]
        };
        let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let basis = self.generators.map(scaled);
        let goal = scaled(twist);
        let normal = std::array::from_fn(|i| std::array::from_fn(|j| dot(&basis[i], &basis[j])));
        let eigen = SymmetricEigen::<3>::of(normal, 3);
        let right: [f64; 3] = std::array::from_fn(|i| dot(&basis[i], &goal));
        let mut x = [0.0; 3];
        for (value, v) in eigen.values.iter().zip(&eigen.vectors) {
            let along: f64 = v.iter().zip(&right).map(|(a, b)| a * b).sum::<f64>() / value;
            x.iter_mut().zip(v).for_each(|(x, v)| *x += along * v);
        }
        let size = norm(&x);
        (size > SCREW_CLASS * norm(&goal)).then(|| x.map(|a| a / size))
    }

    /// Eigenvalues and vectors of `K - h W` in units of the length, and how many are positive and
    /// negative.
    fn eigen(&self, h: f64) -> (SymmetricEigen<3>, [usize; 2]) {
        let most = |m: &[[f64; 3]; 3]| max_abs(m.as_flattened());
        let conic = self.conic(h);
        let eigen = SymmetricEigen::<3>::of(conic, 3);
        let size = if h.is_infinite() {
            1.0
        } else {
            most(&self.klein).max(h.abs() * most(&self.angular))
        };
        let zero = SCREW_CLASS * size.max(self.length * SCREW_CLASS);
        let count = |sign: f64| eigen.values.iter().filter(|l| sign * **l > zero).count();
        (eigen, [count(1.0), count(-1.0)])
    }
}

impl ScrewSystem {
    /// The pitch conics of a system of order three; `None` for other orders.
    #[must_use]
    pub fn pitch_conics(&self) -> Option<PitchConics> {
        if self.order() != 3 {
            return None;
        }
        let pose = self.canonical_pose();
        let generators = self.normal_form().twists();
        let scaled = |t: &Twist| {
            let t =
                if t.angular == Vec3::ZERO { *t * (self.length() / t.linear.norm()) } else { *t };
            pose.adjoint(t)
        };
        let [a, b, c] = generators[..] else { return None };
        let generators = [a, b, c].map(|t| scaled(&t));
        let own = [a, b, c].map(|t| pose.inverse().adjoint(scaled(&t)));
        let form = |f: &dyn Fn(Twist, Twist) -> f64| {
            std::array::from_fn(|i| std::array::from_fn(|j| f(own[i], own[j])))
        };
        Some(PitchConics {
            generators,
            klein: form(&|a, b| a.pitch_form(b, 0.0)),
            angular: form(&|a, b| a.angular.dot(b.angular)),
            length: self.length(),
        })
    }
}
