//! Screws, screw systems, lines in involution.

pub(crate) mod eigenscrews;
mod error_form;
mod existence;
pub(crate) mod forms;
pub(crate) mod involution;
mod lines;
mod pitch;
mod pitch_conics;
pub(crate) mod projector;
mod screw;
mod system;
pub(crate) mod transversals;

use cylindroid::Vec3;
use cylindroid::screws::ScrewOptions;

use crate::arrays::Numbers;
use crate::error::Result;

pub(crate) use eigenscrews::PyEigenscrews;
pub(crate) use error_form::PyErrorFormZeros;
pub(crate) use existence::PyExistence;
pub(crate) use forms::finite_twist;
pub(crate) use involution::PyInvolution;
pub(crate) use pitch_conics::PyPitchConics;
pub(crate) use projector::PyProjector;
pub(crate) use screw::{PyScrew, screw_list};
pub(crate) use system::{PyMargin, PyScrewSystem};
pub(crate) use transversals::PyTransversals;

/// Scale and noise of twists.
pub(crate) fn scale_of(
    length: Option<f64>,
    center: Option<&Numbers<'_>>,
    noise: Option<f64>,
) -> Result<ScrewOptions> {
    let default = ScrewOptions::default();
    Ok(ScrewOptions {
        length: length.unwrap_or(default.length),
        center: center.map(|c| c.entries::<3>("center")).transpose()?.map(Vec3::from_array),
        noise: noise.unwrap_or(default.noise),
    })
}
