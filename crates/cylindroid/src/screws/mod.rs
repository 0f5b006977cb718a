//! Screws, lines and screw systems: the geometry of instantaneous motion, in numbers that do not
//! change with the frame.
//!
//! ```
//! use cylindroid::screws::{Class, Line, ScrewOptions, ScrewSystem};
//! use cylindroid::Vec3;
//!
//! // Two axes at right angles, 0.2 m apart: the cylindroid between pitches -0.1 and 0.1 m/rad.
//! let yaw = Line { point: Vec3::ZERO, direction: Vec3::Z };
//! let pitch = Line { point: Vec3::new(0.0, 0.2, 0.0), direction: Vec3::X };
//! let system = ScrewSystem::of(&[yaw.twist(), pitch.twist()], &ScrewOptions::default())?;
//! assert_eq!(system.class(), Class::IA);
//! let pitches = system.principal_pitches();
//! assert!((pitches[0] - 0.1).abs() < 1e-15 && (pitches[1] + 0.1).abs() < 1e-15);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod class;
mod classify;
mod curve;
mod eigenscrews;
mod error_form;
mod existence;
mod instant_projector;
mod involution;
mod pitch_conics;
mod projector;
mod projector_fixed;
mod scaled_projector;
mod screw;
mod signature;
mod span;
mod span_estimation;
mod subspace_algebra;
mod system;
mod transversals;

pub use class::{Class, NormalForm};
pub use classify::Margin;
pub use curve::{gram, gram_determinant};
pub use eigenscrews::{Eigenscrew, EigenscrewKind, Eigenscrews, eigenscrews};
pub use error_form::ErrorFormZeros;
pub use existence::{Existence, NoInverse, PitchChoice};
pub use instant_projector::Complement;
pub use involution::{Involution, involution};
pub use pitch_conics::{ConicKind, PitchConics};
pub use projector::Projector;
pub(crate) use projector_fixed::independent_coordinates;
pub(crate) use scaled_projector::ScaledProjector;
pub use screw::{CommonNormal, Line, Screw};
pub use signature::Signature;
pub use span_estimation::ScrewOptions;
pub use system::ScrewSystem;
pub use transversals::{Transversals, transversals};
