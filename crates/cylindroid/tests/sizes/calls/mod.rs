//! The public functions of the library, a file for each module. A line names a function, and where
//! its arguments are generic, have a documented range, or are functions, calls it.

mod closure;
mod collision;
mod control;
mod ik;
mod inverse;
mod kinematics;
mod linalg;
mod manipulability;
mod model;
mod screws;
mod spatial;
mod sweep;

use crate::world::Function;

/// `path;` or `path = call;`.
macro_rules! calls {
    ($($path:path $(= $call:expr)?;)*) => {
        pub(super) fn all() -> Vec<$crate::world::Function> {
            vec![$($crate::world::Function::new(
                stringify!($path),
                $crate::calls::calls!(@ $path $(, $call)?),
            )),*]
        }
    };
    (@ $path:path) => { $path };
    (@ $path:path, $call:expr) => { $call };
}
use calls;

/// What the calls below name.
mod prelude {
    pub(super) use std::num::NonZeroUsize;
    pub(super) use std::path::Path;

    pub(super) use cylindroid::closure::{
        ActuationMap, ClosedChain, Constraint, ContactProperties, Mobility, MotionSpace,
    };
    pub(super) use cylindroid::collision::{CollisionModel, NearPair};
    pub(super) use cylindroid::control::{InverseChoice, NamedInverse, Target, Task, TaskServo};
    pub(super) use cylindroid::ik::Analytic;
    pub(super) use cylindroid::kinematics::{Chain, KinematicsBatch, OrientationRates};
    pub(super) use cylindroid::linalg::{Metric, Qr, Svd, SymmetricEigen};
    pub(super) use cylindroid::model::formats::srdf::Srdf;
    pub(super) use cylindroid::model::{Builder, Inclusion, JointLimits, LoadReport, Visual};
    pub(super) use cylindroid::sweep::{
        Map, MapOptions, Optimisation, Part, SharedFolder, Sweep, Values, WriteOptions,
    };
    pub(super) use cylindroid::*;

    pub(super) use super::calls;

    /// True if the state is one of the mechanism of the shapes, and the pair may be: gradients have no
    /// errors.
    pub(super) fn same(c: &CollisionModel, s: &State, near: &NearPair) -> bool {
        let links = |m: &Mechanism| (m.name().to_owned(), m.joints().to_vec());
        let is_link = |l: Option<usize>| l.is_none_or(|l| l < s.mechanism().links().len());
        links(c.mechanism()) == links(s.mechanism()) && is_link(near.link_a) && is_link(near.link_b)
    }
}

/// What a result holds in its fields.
fn parts() -> Vec<Function> {
    use cylindroid::closure::{ClosedChain, Diagnosis};
    use cylindroid::manipulability::{Manipulability, Polytope, Spectrum};
    use cylindroid::screws::Eigenscrews;
    use cylindroid::sweep::Map;
    vec![
        Function::new("ClosedChain.constraint", |of: &'static ClosedChain| &of.constraint),
        Function::new("ClosedChain.units", |of: &'static ClosedChain| &of.units),
        Function::new("Diagnosis.generic", |of: &'static Diagnosis| &of.generic),
        Function::new("Diagnosis.verdict", |of: &'static Diagnosis| &of.verdict),
        Function::new("Eigenscrews.screws", |of: &'static Eigenscrews| of.screws.as_slice()),
        Function::new("Manipulability.force", |of: &'static Manipulability| &of.force),
        Function::new("Map.modes", |of: &'static Map| of.modes.as_slice()),
        Function::new("Polytope.hull", |of: &'static Polytope| &of.hull),
        Function::new("Spectrum.finite", |of: &'static Spectrum| of.finite.first().map(|d| d.pair)),
    ]
}

pub(crate) fn all() -> Vec<Function> {
    [
        parts(),
        closure::all(),
        collision::all(),
        control::all(),
        ik::all(),
        inverse::all(),
        kinematics::all(),
        linalg::all(),
        manipulability::all(),
        model::all(),
        screws::all(),
        spatial::all(),
        sweep::all(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
