//! The six manipulability indices, and the usual scalar measures (Yoshikawa's measure, anisotropy).
//!
//! Formula  the pages of [`Index`] and [`Spectrum`]
//! Units    of the efficiencies; the anisotropy has none, the volume their root to the power n
//! Valid    any spectrum. The volume of a serial arm with full rank is Yoshikawa's
//!          sqrt(det J J^T), its anisotropy the squared condition number.
//! Source   Bicchi & Prattichizzo 1998, sections 3 and 4; Yoshikawa 1985
//! Checked  tests/it/manipulability/reference.rs, tests/it/manipulability/serial.rs

use super::efficiency::{Manipulability, Spectrum};

/// The six indices: which side (joints or object) is given, and which is optimised.
///
/// ```text
/// kinematic  |u|^2 / |qd_a|^2     force  |w|^2 / |tau|^2
/// active: the joints are given    passive: the object is given
/// ```
///
/// `qd_a` are the actuated joint velocities, `u` the twist, `tau` the torques, `w` the wrench, in
/// the metrics of [`Metrics`](super::Metrics).
///
/// Source: Bicchi & Prattichizzo 1998, sections 3 and 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Index {
    /// Motion, both sides at their best (eq. 9): finite efficiencies only.
    Kinematic,
    /// Joint velocities given, minimal motion of the object: a zero for each redundant motion.
    ActiveKinematic,
    /// Twist given, minimal joint velocities: an infinite one for each motion that the actuators do
    /// not control.
    PassiveKinematic,
    /// Force, both sides at their best (eq. 17): finite efficiencies only.
    Force,
    /// Torques given (eq. 14): a zero for each internal torque.
    ActiveForce,
    /// Wrench given: an infinite one for each wrench that the structure resists.
    PassiveForce,
}

impl Index {
    /// All six.
    pub const ALL: [Self; 6] = [
        Self::Kinematic,
        Self::ActiveKinematic,
        Self::PassiveKinematic,
        Self::Force,
        Self::ActiveForce,
        Self::PassiveForce,
    ];

    /// Its name in options and reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Kinematic => "kinematic",
            Self::ActiveKinematic => "active-kinematic",
            Self::PassiveKinematic => "passive-kinematic",
            Self::Force => "force",
            Self::ActiveForce => "active-force",
            Self::PassiveForce => "passive-force",
        }
    }

    /// The given quantity and the one that is optimised, in a phrase.
    #[must_use]
    pub const fn description(&self) -> &'static str {
        match self {
            Self::Kinematic => "motion, optimal on both sides",
            Self::ActiveKinematic => "joint velocities given, smallest twist of the object",
            Self::PassiveKinematic => "twist given, smallest joint velocities",
            Self::Force => "force, optimal on both sides",
            Self::ActiveForce => "torques given, smallest wrench",
            Self::PassiveForce => "wrench given, smallest torques",
        }
    }

    /// The efficiencies of this index, largest first, infinities and zeros included.
    ///
    /// The spectrum of motion (or force) has finite efficiencies, zeros and infinite ones; an index
    /// contains the zeros if the joints are given, the infinite ones if the object is given. Units:
    /// of `|u|^2 / |qd_a|^2` for motion and of `|w|^2 / |tau|^2` for force, in the metrics of `m`.
    #[must_use]
    pub fn values(&self, m: &Manipulability) -> Vec<f64> {
        let (spectrum, zeros, infinite) = match self {
            Self::Kinematic => (&m.kinematic, false, false),
            Self::ActiveKinematic => (&m.kinematic, true, false),
            Self::PassiveKinematic => (&m.kinematic, false, true),
            Self::Force => (&m.force, false, false),
            Self::ActiveForce => (&m.force, true, false),
            Self::PassiveForce => (&m.force, false, true),
        };
        let mut values = vec![f64::INFINITY; if infinite { spectrum.infinite.cols() } else { 0 }];
        values.extend(spectrum.values());
        values.extend(vec![0.0; if zeros { spectrum.zeros.cols() } else { 0 }]);
        values
    }
}

impl Spectrum {
    /// Largest finite efficiency, if there is one.
    #[must_use]
    pub fn largest(&self) -> Option<f64> {
        self.finite.first().map(|d| d.pair.efficiency())
    }

    /// Smallest finite efficiency, if there is one.
    #[must_use]
    pub fn smallest(&self) -> Option<f64> {
        self.finite.last().map(|d| d.pair.efficiency())
    }

    /// Largest over smallest finite efficiency, 1 for an isotropic pose.
    ///
    /// ```text
    /// e_1 / e_n,   e_1 >= ... >= e_n the finite efficiencies
    /// ```
    ///
    /// Without unit. For a serial arm, the squared condition number of the Jacobian.
    #[doc(alias = "condition number")]
    #[must_use]
    pub fn anisotropy(&self) -> Option<f64> {
        Some(self.largest()? / self.smallest()?)
    }

    /// Product of the roots of the finite efficiencies: the volume of the ellipsoid up to a
    /// constant (1 for none).
    ///
    /// ```text
    /// prod_i sqrt(e_i),   e_i the finite efficiencies
    /// ```
    ///
    /// For a serial arm of full rank this is Yoshikawa's manipulability measure `sqrt(det J J^T)`.
    /// Its unit is the root of that of an efficiency, to the power of their number.
    ///
    /// Source: Yoshikawa 1985.
    ///
    /// ```
    /// use cylindroid::Matrix;
    /// use cylindroid::closure::{Constraint, MotionSpace};
    /// use cylindroid::manipulability::{Manipulability, Metrics};
    ///
    /// let jacobian = Matrix::from_rows(&[[2.0, 0.0], [0.0, 1.0]]).unwrap();
    /// let relation = MotionSpace::of(&Constraint::serial(&jacobian)?).relation();
    /// let m = Manipulability::of(&relation, &Metrics::UNIT)?;
    /// assert!((m.kinematic.volume() - 2.0).abs() < 1e-12); // sqrt(det J J^T)
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[doc(alias = "Yoshikawa")]
    #[doc(alias = "manipulability measure")]
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.finite.iter().map(|d| d.pair.output / d.pair.input).product()
    }
}
