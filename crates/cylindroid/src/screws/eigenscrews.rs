//! Eigenscrews of a stiffness or inertia matrix in a pitch form.
//!
//! Formula  K s_i = l_i D_h s_i with D_h = 2 Q_h,  s_i^T D_h s_j = sign(l_i) [i = j];
//!          K = sum |l_i| W_i W_i^T with W_i = D_h s_i: parallel springs of stiffness |l_i| along
//!          the wrenches W_i
//!          computed from K = R R^T:  R^T D_h^-1 R y_i = l_i y_i,  s_i ~ D_h^-1 R y_i
//! Shapes   K: 6 x 6, symmetric, takes twists to wrenches (both linear part first)
//! Units    h in m/rad; of a stiffness in N/m, N/rad and N m/rad, l_i in N/rad
//! Valid    K positive definite: three l_i positive and three negative at every finite h, each
//!          rising with h. K semidefinite: as many as its rank, less the dimension of the wrenches
//!          of its image that are h-reciprocal to all of it. The l_i do not change with the frame
//! Fails    on a matrix that is not 6 x 6, finite and symmetric. An indefinite K may have complex
//!          eigenvalues and fewer eigenvectors: `kind` says so, and there are no eigenscrews
//! Why so   by the factor R and not by D_h^-1 K, which is not symmetric, nor by K^-1: semidefinite
//!          matrices need no case of their own
//! Source   Ball 1900, chapter IX (principal screws of inertia); Patterson & Lipkin 1993 (h = 0);
//!          Huang & Schimmels 2000 (decomposition)
//! Checked  tests/it/screws/eigenscrews.rs, tests in this file

use super::screw::Screw;
use super::signature::Signature;
use super::span::Scale;
use crate::error::{Error, Result};
use crate::linalg::{Matrix, SymmetricEigen};
use crate::spatial::{Twist, Vec3, Wrench};
use crate::tolerance::{NEARLY_PARALLEL, SCREW_CLASS, STIFFNESS_RANK};

/// The existence of eigenscrews of a symmetric matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum EigenscrewKind {
    /// Positive definite: six, three of positive and three of negative eigenvalue.
    Definite,
    /// Positive semidefinite: as many as the rank.
    Semidefinite {
        /// The rank of the matrix.
        rank: usize,
    },
    /// Positive semidefinite, with wrenches in its image that are h-reciprocal to all of it: so
    /// many eigenscrews fewer than the rank, and as many Jordan blocks of size two at zero.
    Defective {
        /// The rank of the matrix.
        rank: usize,
        /// The dimension of these wrenches.
        missing: usize,
    },
    /// Not semidefinite: the eigenvalues may be complex, and none are computed.
    Indefinite {
        /// The smallest eigenvalue over the largest, at the centre and length of the matrix.
        smallest: f64,
    },
}

impl EigenscrewKind {
    /// Its name: `definite`, `semidefinite`, `defective` or `indefinite`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Definite => "definite",
            Self::Semidefinite { .. } => "semidefinite",
            Self::Defective { .. } => "defective",
            Self::Indefinite { .. } => "indefinite",
        }
    }
}

/// One eigenscrew: see [`eigenscrews`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eigenscrew {
    /// l, positive or negative, never zero: of a stiffness in N/rad, the force along the screw for
    /// 1 rad about it.
    pub eigenvalue: f64,
    /// s, with `2 <s, s>_h` the sign of the eigenvalue.
    pub twist: Twist,
    /// `2 Q_h s`: the wrench of the spring, which the twist s deflects by one.
    pub wrench: Wrench,
}

impl Eigenscrew {
    /// The twist as a screw: axis, pitch and amplitude.
    #[must_use]
    pub fn screw(&self) -> Option<Screw> {
        Screw::of(self.twist)
    }
}

/// The eigenscrews of a symmetric matrix: see [`eigenscrews`].
#[derive(Debug, Clone, PartialEq)]
pub struct Eigenscrews {
    /// Positive eigenvalues first, each sign by falling size.
    pub screws: Vec<Eigenscrew>,
    /// Whether there are six, fewer or none.
    pub kind: EigenscrewKind,
    /// `trace K_fm / trace K_ff` [m/rad]: the one pitch p for which the matrix is a sum of springs
    /// along wrenches of pitch p, where it is positive semidefinite; zero for springs along lines.
    /// `None` for a matrix without translational stiffness.
    pub spring_pitch: Option<f64>,
}

/// The eigenscrews of a stiffness (or inertia) matrix in the form of pitch `h`.
///
/// ```text
/// K s = l D_h s,   s^T D_h s = sign l,   K = sum |l_i| (D_h s_i)(D_h s_i)^T,   D_h = 2 Q_h
/// ```
///
/// `stiffness` is 6 x 6, symmetric, linear part first: it takes a twist to a wrench at the origin
/// of its frame, with the blocks `K_ff` (N/m), `K_fm` (N/rad) and `K_mm` (N m/rad). `h` is in
/// m/rad, finite. The eigenvalues do not change with the frame. For `h = 0` they are the
/// eigenstiffnesses of Patterson and Lipkin, and the eigenscrews of the inertia of a body are
/// Ball's principal screws of inertia.
///
/// ```
/// use cylindroid::screws::{EigenscrewKind, eigenscrews};
/// use cylindroid::Matrix;
///
/// // A body of 2 kg with radii of gyration 0.1, 0.2 and 0.3 m, at its centre of mass.
/// let inertia = Matrix::diagonal(&[2.0, 2.0, 2.0, 0.02, 0.08, 0.18]);
/// let found = eigenscrews(&inertia, 0.0)?;
/// assert_eq!(found.kind, EigenscrewKind::Definite);
/// let pitches: Vec<f64> = found.screws.iter().map(|e| e.screw().unwrap().pitch).collect();
/// for (pitch, expected) in pitches.iter().zip([0.3, 0.2, 0.1, -0.3, -0.2, -0.1]) {
///     assert!((pitch - expected).abs() < 1e-12);
/// }
/// # Ok::<(), cylindroid::Error>(())
/// ```
///
/// Source: Patterson & Lipkin, *Structure of robot compliance*, Journal of Mechanical Design 115,
/// 1993; the chapter `docs/theory/hyperbolic-svd.md` of the book has the theorems.
///
/// # Errors
/// A matrix that is not 6 x 6, finite and symmetric; a pitch that is NaN or infinite.
pub fn eigenscrews(stiffness: &Matrix, h: f64) -> Result<Eigenscrews> {
    Error::check_finite("pitch h", &[h])?;
    Error::check_len("rows of the stiffness K", 6, stiffness.rows())?;
    Error::check_len("columns of the stiffness K", 6, stiffness.cols())?;
    Error::check_finite("stiffness K", stiffness.as_slice())?;
    if !stiffness.is_symmetric() {
        return Err(Error::InvalidOption {
            option: "stiffness K",
            value: "6 x 6 matrix".to_owned(),
            reason: "it must be symmetric; use (K + K^T) / 2".to_owned(),
        });
    }
    let scale = scale_of(stiffness);
    let eigen = SymmetricEigen::of(scaled(stiffness, scale), 6);
    let largest = eigen.values[0].max(-eigen.values[5]);
    let trace = |row: usize, column: usize| -> f64 {
        (0..3).map(|i| stiffness[(row + i, column + i)]).sum()
    };
    let mut found = Eigenscrews {
        screws: vec![],
        kind: EigenscrewKind::Definite,
        spring_pitch: (trace(0, 0) > 0.0).then(|| trace(0, 3) / trace(0, 0)),
    };
    if eigen.values[5] < -STIFFNESS_RANK * largest {
        found.kind = EigenscrewKind::Indefinite { smallest: eigen.values[5] / largest };
        return Ok(found);
    }
    let rank = eigen.values.iter().filter(|x| **x > STIFFNESS_RANK * largest).count();
    let ratio = h / scale.length;
    let image: Vec<Wrench> = eigen.vectors[..rank].iter().map(|x| Wrench::from_array(*x)).collect();
    // Whether the image meets its reciprocal is decided without the sizes of the eigenvalues. The
    // form is regular on all wrenches.
    let plain = SymmetricEigen::of(gram(&image, ratio), rank);
    let threshold = SCREW_CLASS.max(64.0 * f64::EPSILON * ratio.abs());
    let signature = match rank {
        6 => Signature { positive: 3, negative: 3, zero: 0 },
        _ => Signature::of(&plain.values[..rank], threshold),
    };
    let factor: Vec<Wrench> = image.iter().zip(eigen.values).map(|(w, d)| *w * d.sqrt()).collect();
    let reduced = SymmetricEigen::of(gram(&factor, ratio), rank);
    let positive = 0..signature.positive;
    let negative = (rank - signature.negative..rank).rev();
    for i in positive.chain(negative) {
        let eigenvalue = reduced.values[i] / (2.0 * scale.length);
        let sum = factor.iter().zip(reduced.vectors[i]).fold(Wrench::ZERO, |s, (w, y)| s + *w * y);
        let size = (2.0 * scale.length * reduced.values[i].abs()).sqrt();
        let twist = scale.undo(&(sum.raised(ratio) * (1.0 / size)).to_array());
        found.screws.push(Eigenscrew { eigenvalue, twist, wrench: twist.lowered(h) * 2.0 });
    }
    found.kind = match (rank, signature.zero) {
        (6, _) => EigenscrewKind::Definite,
        (_, 0) => EigenscrewKind::Semidefinite { rank },
        (_, missing) => EigenscrewKind::Defective { rank, missing },
    };
    Ok(found)
}

/// `a^T Q_h^-1 b` of wrenches.
fn gram(wrenches: &[Wrench], h: f64) -> [[f64; 6]; 6] {
    let mut g = [[0.0; 6]; 6];
    for (row, a) in g.iter_mut().zip(wrenches) {
        for (x, b) in row.iter_mut().zip(wrenches) {
            *x = a.pitch_form(*b, h);
        }
    }
    g
}

/// The point at which the rotational stiffness is smallest, and the length that makes its trace
/// that of the translational one: they move with the matrix.
fn scale_of(k: &Matrix) -> Scale {
    let block = |row: usize, column: usize| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| k[(row + i, column + j)]))
    };
    let (forces, mixed) = (block(0, 0), block(0, 3));
    let total = forces[0][0] + forces[1][1] + forces[2][2];
    if !(total > 0.0) {
        return Scale { center: Vec3::ZERO, length: 1.0 };
    }
    // (trace F 1 - F) c = sum of f x m over springs.
    let a = std::array::from_fn(|i| {
        std::array::from_fn(|j| if i == j { total - forces[i][i] } else { -forces[i][j] })
    });
    let b =
        Vec3::new(mixed[1][2] - mixed[2][1], mixed[2][0] - mixed[0][2], mixed[0][1] - mixed[1][0]);
    let eigen = SymmetricEigen::of(a, 3);
    let mut center = Vec3::ZERO;
    for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
        if *value > NEARLY_PARALLEL * eigen.values[0] {
            let e = Vec3::from_array(vector);
            center += e * (e.dot(b) / value);
        }
    }
    if !center.is_finite() {
        center = Vec3::ZERO;
    }
    let at_center = scaled(k, Scale { center, length: 1.0 });
    let moments = at_center[3][3] + at_center[4][4] + at_center[5][5];
    let length = (moments / total).sqrt();
    let usable = length > SCREW_CLASS * center.norm() && length.is_normal();
    Scale { center, length: if usable { length } else { 1.0 } }
}

/// The matrix on twists at the centre, with lengths over L.
fn scaled(k: &Matrix, scale: Scale) -> [[f64; 6]; 6] {
    let units: [[f64; 6]; 6] = std::array::from_fn(|i| {
        let mut unit = [0.0; 6];
        unit[i] = 1.0;
        scale.undo(&unit).to_array()
    });
    let images = units.map(|x| k.mul_vec(&x));
    std::array::from_fn(|i| {
        std::array::from_fn(|j| units[i].iter().zip(&images[j]).map(|(a, b)| a * b).sum())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::{Pose, Rotation};

    /// Springs along lines: `points`, directions and stiffnesses of five, fewer than six, so that the
    /// matrix is singular.
    fn springs(placed: Pose, unit: f64) -> Matrix {
        let springs = [
            ([0.3, -0.2, 0.5], [1.0, 0.2, -0.4], 3.0),
            ([-0.6, 0.1, 0.2], [0.1, -0.9, 0.5], 1.0),
            ([0.2, 0.8, -0.3], [-0.3, 0.4, 1.2], 0.5),
            ([0.9, -0.4, 0.1], [0.7, 0.7, 0.1], 2.0),
            ([-0.1, 0.5, 0.7], [0.2, -0.5, -0.8], 4.0),
        ];
        let wrench = |point: [f64; 3], force: [f64; 3]| {
            let force = placed.rotation * Vec3::from_array(force);
            let moment = (placed * Vec3::from_array(point)).cross(force) * unit;
            [force.to_array(), moment.to_array()].concat()
        };
        let wrenches = springs.map(|(point, force, k)| (wrench(point, force), k));
        Matrix::from_fn(6, 6, |i, j| wrenches.iter().map(|(w, k)| k * w[i] * w[j]).sum())
    }

    #[test]
    fn the_scale_moves_with_the_matrix() {
        let Scale { center, length } = scale_of(&springs(Pose::IDENTITY, 1.0));
        for (vector, unit) in [
            (Vec3::new(0.0, 0.0, 1.3), 1.0),
            (Vec3::new(2.0, -0.4, 0.7), 1.0),
            (Vec3::new(0.3, 1.1, -0.9), 1e3),
            (Vec3::new(-1.0, 0.2, 0.0), 1e-6),
        ] {
            let placed = Pose { rotation: Rotation::exp(vector), translation: vector };
            let found = scale_of(&springs(placed, unit));
            let apart = found.center * (1.0 / unit) - placed * center;
            assert!(apart.norm() < 1e-12, "{apart:?}");
            assert!((found.length / (unit * length) - 1.0).abs() < 1e-12, "{vector:?}, {unit}");
        }
    }
}
