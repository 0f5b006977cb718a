//! Admittance: the compliance of a tool, a twist in response to a wrench.
//!
//! Formula  the page of [`Admittance`]
//! Shapes   6 x 6, both linear first
//! Units    c_f m/s/N, c_m rad/s/(N m)
//! Valid    positive semidefinite symmetric part: the tool yields and never pushes back
//! Why so   tested after division by the roots of the diagonal, so that the verdict does not depend
//!          on the unit of length
//! Source   Hogan 1985 (impedance and admittance)
//! Checked  tests/it/servo/hybrid.rs::admittance_*

use std::array::from_fn;

use crate::error::{Error, Result, all_finite};
use crate::linalg::SymmetricEigen;
use crate::spatial::{Pose, Twist, Vec3, Wrench};
use crate::tolerance::PASSIVE;

/// A linear map from wrenches to twists in one frame.
///
/// ```text
/// twist = C wrench;   at a point p: v(p) = c_f f, w = c_m m(p);   in another frame Ad C Ad^T
/// ```
///
/// C is 6 x 6, linear parts first, with a positive semidefinite symmetric part: the tool yields and
/// never pushes back. `c_f` in m/s/N, `c_m` in rad/s/(N m).
///
/// Source: Hogan 1985.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Admittance {
    rows: [[f64; 6]; 6],
}

/// Compliance gains of a tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdmittanceGain {
    /// For forces, isotropic [m/s/N].
    pub force: f64,
    /// For moments about the point, isotropic [rad/s/(N m)]; zero for a tool that does not rotate.
    pub moment: f64,
}

impl Admittance {
    /// Isotropic admittance at the point `point` (m).
    ///
    /// ```
    /// use cylindroid::control::{Admittance, AdmittanceGain};
    /// use cylindroid::{Vec3, Wrench};
    ///
    /// // 10 N move the point at 0.02 m/s; the tool does not rotate.
    /// let gain = AdmittanceGain { force: 0.002, moment: 0.0 };
    /// let admittance = Admittance::at(Vec3::ZERO, gain)?;
    /// let twist = admittance.apply(Wrench { force: Vec3::X * 10.0, moment: Vec3::Z });
    /// assert_eq!((twist.linear, twist.angular), (Vec3::X * 0.02, Vec3::ZERO));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Negative or non-finite gains, a non-finite point.
    pub fn at(point: Vec3, gain: AdmittanceGain) -> Result<Self> {
        Error::check_finite("point of the admittance", &point.to_array())?;
        for (option, value) in
            [("force admittance", gain.force), ("moment admittance", gain.moment)]
        {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(refuse(option, value.to_string()));
            }
        }
        let admittance = Self::of(|wrench| {
            let wrench = wrench.at_point(point);
            let (linear, angular) = (wrench.force * gain.force, wrench.moment * gain.moment);
            Twist { linear, angular }.at_point(-point)
        });
        Error::check_finite("admittance", admittance.rows.as_flattened())?;
        Ok(admittance)
    }

    /// The map with these rows: twist (linear first) from wrench (force first).
    ///
    /// ```
    /// use cylindroid::control::Admittance;
    ///
    /// let mut rows = [[0.0; 6]; 6];
    /// rows[2][2] = 0.001; // yields along z only
    /// assert!(Admittance::from_rows(rows).is_ok());
    /// rows[2][2] = -0.001; // would push back
    /// assert!(Admittance::from_rows(rows).is_err());
    /// ```
    ///
    /// # Errors
    /// Non-finite entries; a map that would push back against some wrench.
    pub fn from_rows(rows: [[f64; 6]; 6]) -> Result<Self> {
        Error::check_finite("admittance", rows.as_flattened())?;
        let root = |i: usize| rows[i][i].max(0.0).sqrt();
        let entry = |i: usize, j: usize| {
            let symmetric = 0.5 * rows[i][j] + 0.5 * rows[j][i];
            // For a zero diagonal entry, the row and column must be zero to be semidefinite.
            if symmetric == 0.0 { 0.0 } else { symmetric / (root(i) * root(j)) }
        };
        let scaled: [[f64; 6]; 6] = from_fn(|i| from_fn(|j| entry(i, j)));
        let smallest = if all_finite(scaled.as_flattened()) {
            SymmetricEigen::of(scaled, 6).values[5]
        } else {
            f64::NEG_INFINITY
        };
        if smallest < -PASSIVE {
            return Err(refuse("admittance", format!("{rows:?}")));
        }
        Ok(Self { rows })
    }

    /// The twist of a wrench.
    #[must_use]
    pub fn apply(&self, wrench: Wrench) -> Twist {
        let w = wrench.to_array();
        Twist::from_array(self.rows.map(|row| row.iter().zip(w).map(|(c, w)| c * w).sum()))
    }

    /// The same admittance in another frame; `self` is in frame b.
    ///
    /// ```
    /// use cylindroid::control::{Admittance, AdmittanceGain};
    /// use cylindroid::{Pose, Rotation, Vec3, Wrench};
    ///
    /// let b = Admittance::at(Vec3::X, AdmittanceGain { force: 0.002, moment: 0.1 })?;
    /// let a_from_b = Pose { rotation: Rotation::about_z(0.5), translation: Vec3::Y };
    /// let wrench = Wrench { force: Vec3::X, moment: Vec3::Z };
    /// // The same response, computed in either frame.
    /// let response = b.seen_from(a_from_b).apply(a_from_b.coadjoint(wrench));
    /// assert!((response - a_from_b.adjoint(b.apply(wrench))).linear.norm() < 1e-15);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn seen_from(&self, a_from_b: Pose) -> Self {
        let b_from_a = a_from_b.inverse();
        Self::of(|wrench| a_from_b.adjoint(self.apply(b_from_a.coadjoint(wrench))))
    }

    /// The rows of the map.
    #[must_use]
    pub fn rows(&self) -> [[f64; 6]; 6] {
        self.rows
    }

    fn of(map: impl Fn(Wrench) -> Twist) -> Self {
        let mut rows = [[0.0; 6]; 6];
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let column = map(Wrench::from_array(unit)).to_array();
            rows.iter_mut().zip(column).for_each(|(row, c)| row[j] = c);
        }
        Self { rows }
    }
}

fn refuse(option: &'static str, value: String) -> Error {
    Error::InvalidOption {
        option,
        value,
        reason: "a tool that pushes back against a force runs away from it; take gains that are \
                 not negative, or a map whose symmetric part is positive semidefinite"
            .to_owned(),
    }
}
