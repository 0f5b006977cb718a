//! Gibson-Hunt classes of screw systems and their normal forms.
//!
//! Shapes   orders 0 to 6; a system of order 4 or 5 carries the class of its reciprocal system
//! Units    pitches in m/rad; `slope` (p of the tables) is the tangent of an angle
//! Source   Gibson & Hunt 1990; Donelan & Selig, tables 1 and 2 (complete and right as printed;
//!          their table 3 of systems without a pseudoinverse lacks IID)
//! Checked  tests/it/screws/classes.rs, tests/it/screws/vectors/

use std::fmt;

use crate::spatial::{Twist, Vec3};
use crate::tolerance::SCREW_CLASS;

/// The Gibson-Hunt class of a screw system, invariant under rigid motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Class {
    /// Order 0: no motion at all.
    Zero,
    /// One screw of finite pitch (orders 1 and 5).
    H,
    /// One translation (orders 1 and 5).
    Inf,
    /// Two screws of different finite pitch that cross at right angles (orders 2 and 4).
    IA,
    /// A rotation and a translation not perpendicular to it (orders 2 and 4).
    IB,
    /// All directions of a plane or of space with one pitch (orders 2 to 4).
    IIA,
    /// As [`Class::IIA`] with one less direction and a translation perpendicular to it (orders 2 to
    /// 4).
    IIB,
    /// Translations of a plane, of order 3 with a screw across it (orders 2 to 4).
    IIC,
    /// Three different principal pitches (order 3).
    IA1,
    /// Two of three principal pitches equal (order 3).
    IA2,
    /// Two directions of one pitch and a translation oblique to them (order 3).
    IB0,
    /// Two different pitches and the translation perpendicular to both (order 3).
    IB3,
    /// A screw and two translations not both perpendicular to it (order 3).
    IC,
    /// All translations (order 3).
    IID,
    /// Order 6: every motion.
    Full,
}

impl Class {
    /// Its name in the literature: `h`, `inf`, `IA`, `IIB`, `IB0`, ...
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zero => "0",
            Self::H => "h",
            Self::Inf => "inf",
            Self::IA => "IA",
            Self::IB => "IB",
            Self::IIA => "IIA",
            Self::IIB => "IIB",
            Self::IIC => "IIC",
            Self::IA1 => "IA1",
            Self::IA2 => "IA2",
            Self::IB0 => "IB0",
            Self::IB3 => "IB3",
            Self::IC => "IC",
            Self::IID => "IID",
            Self::Full => "6",
        }
    }

    /// The composition of a system of this class (for orders 4 and 5: its reciprocal system).
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Zero => "no motion",
            Self::H => "one screw of finite pitch",
            Self::Inf => "one translation",
            Self::IA => "two screws of different pitches that cross at right angles: a cylindroid",
            Self::IB => "parallel screws of all pitches, and a translation not across their axes",
            Self::IIA => "screws of one pitch in all directions through a point",
            Self::IIB => "screws of one pitch, and the translation across their axes",
            Self::IIC => "the translations of a plane",
            Self::IA1 => "three screws of different pitches that cross at right angles",
            Self::IA2 => "three screws that cross at right angles, two of one pitch",
            Self::IB0 => {
                "screws of one pitch in parallel planes, and a translation not across the planes"
            }
            Self::IB3 => "two screws of different pitches, and the translation across both",
            Self::IC => "parallel screws, and two translations not both across them",
            Self::IID => "all translations",
            Self::Full => "every motion",
        }
    }

    /// True if no system of this class and order has a hyperbolic pseudoinverse for any pitch.
    /// (Of the same letters, a 2-system IIC and a 3-system IIC have none, a 4-system neither.)
    #[must_use]
    pub const fn never_invertible(self) -> bool {
        matches!(self, Self::Inf | Self::IIB | Self::IIC | Self::IB3 | Self::IC | Self::IID)
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A class with its moduli: the parameters that distinguish two systems of one class.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalForm {
    /// The class.
    pub class: Class,
    /// Order of the system that the form describes: that of the reciprocal system for orders 4 and
    /// 5, otherwise that of the system itself.
    pub order: usize,
    /// The pitches of the form [m/rad], largest first; the single one of IA2 comes first.
    pub pitches: Vec<f64>,
    /// The p of classes IB, IB0 and IC: the inclination of the translation to the axis.
    pub slope: Option<f64>,
}

impl NormalForm {
    /// The composition of a system of this form: [`Class::meaning`] with the direction of the
    /// translation, which the slope decides in classes IB and IB0.
    ///
    /// ```
    /// use cylindroid::screws::{ScrewOptions, ScrewSystem};
    /// use cylindroid::{Twist, Vec3};
    ///
    /// let rotation = |angular| Twist { linear: Vec3::ZERO, angular };
    /// let slide = |linear| Twist { linear, angular: Vec3::ZERO };
    /// let meaning = |translation| {
    ///     let twists = [rotation(Vec3::X), slide(translation)];
    ///     let system = ScrewSystem::of(&twists, &ScrewOptions::default())?;
    ///     Ok::<_, cylindroid::Error>(system.normal_form().meaning())
    /// };
    /// assert_eq!(meaning(Vec3::X)?, "screws of all pitches on one axis");
    /// assert!(meaning(Vec3::new(1.0, 0.5, 0.0))?.ends_with("oblique to their axes"));
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn meaning(&self) -> &'static str {
        let leans = self.slope.is_some_and(|p| p.abs() > SCREW_CLASS);
        match (self.class, leans) {
            (Class::IB, false) => "screws of all pitches on one axis",
            (Class::IB, true) => {
                "parallel screws of all pitches, and a translation oblique to their axes"
            }
            (Class::IB0, false) => {
                "screws of one pitch in parallel planes, and a translation in these planes"
            }
            (Class::IB0, true) => {
                "screws of one pitch in parallel planes, and a translation oblique to the planes"
            }
            (class, _) => class.meaning(),
        }
    }

    /// The generators of the form in its own frame.
    #[must_use]
    pub fn twists(&self) -> Vec<Twist> {
        let h = |i: usize| self.pitches.get(i).or(self.pitches.last()).copied().unwrap_or(0.0);
        let p = self.slope.unwrap_or(0.0);
        let screw = |e: Vec3, pitch: f64| Twist { linear: e * pitch, angular: e };
        let slide = |linear: Vec3| Twist { linear, angular: Vec3::ZERO };
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        match (self.class, self.order) {
            (Class::H, _) => vec![screw(x, h(0))],
            (Class::Inf, _) => vec![slide(x)],
            (Class::IA | Class::IIA, 2) => vec![screw(x, h(0)), screw(y, h(1))],
            (Class::IB, _) => vec![screw(x, 0.0), slide(x + y * p)],
            (Class::IIB, 2) => vec![screw(x, h(0)), slide(y)],
            (Class::IIC, 2) => vec![slide(x), slide(y)],
            (Class::IA1 | Class::IA2 | Class::IIA, _) => {
                vec![screw(x, h(0)), screw(y, h(1)), screw(z, h(2))]
            }
            (Class::IB0, _) => vec![screw(x, h(0)), screw(y, h(0)), slide(x + z * p)],
            (Class::IB3 | Class::IIB, _) => vec![screw(x, h(0)), screw(y, h(1)), slide(z)],
            (Class::IC, _) => vec![screw(x, 0.0), slide(y), slide(x + z * p)],
            (Class::IIC, _) => vec![screw(x, h(0)), slide(y), slide(z)],
            (Class::IID, _) => vec![slide(x), slide(y), slide(z)],
            (Class::IA | Class::Zero | Class::Full, _) => vec![],
        }
    }
}
