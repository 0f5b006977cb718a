//! Starts the viewer of a mechanism.

use std::path::PathBuf;
use std::sync::PoisonError;

use cylindroid_cli::show::{ShowOptions, Viewer};
use pyo3::prelude::*;

use super::{OPEN, PyView};
use crate::arrays::Numbers;
use crate::coordinates::Coordinates;
use crate::error::{Result, argument};
use crate::mechanism::{Origin, PyMechanism};

/// Starts the server of a view; `show` documents the arguments.
#[pyfunction]
#[pyo3(signature = (mechanism, q, frame, tool, meshes, host, port, token, frame_ancestors))]
#[expect(clippy::too_many_arguments, reason = "they are those of `show`")]
pub(crate) fn start_view(
    py: Python<'_>,
    #[pyo3(from_py_with = argument)] mechanism: PyRef<'_, PyMechanism>,
    q: Option<Coordinates<'_>>,
    #[pyo3(from_py_with = argument)] frame: Option<&str>,
    tool: Option<Numbers<'_>>,
    #[pyo3(from_py_with = argument)] meshes: Vec<PathBuf>,
    #[pyo3(from_py_with = argument)] host: String,
    #[pyo3(from_py_with = argument)] port: u16,
    #[pyo3(from_py_with = argument)] token: String,
    #[pyo3(from_py_with = argument)] frame_ancestors: Option<String>,
) -> Result<PyView> {
    let q = mechanism.or_home("q", q.as_ref())?.to_vec();
    let end_effector = mechanism.reference_or_tool(frame, tool.as_ref())?;
    let model = file(&mechanism.origin);
    let mechanism = mechanism.inner.clone();
    let options = ShowOptions {
        mechanism: mechanism.clone(),
        model,
        q,
        end_effector,
        meshes,
        host,
        port,
        token,
        frame_ancestors,
    };
    Ok(PyView::new(mechanism, py.detach(|| Viewer::new(options))?))
}

/// Closes all views, at the end of the program.
#[pyfunction]
pub(crate) fn close_views(py: Python<'_>) {
    py.detach(|| {
        let views = std::mem::take(&mut *OPEN.lock().unwrap_or_else(PoisonError::into_inner));
        views.iter().for_each(|viewer| viewer.close());
    });
}

/// True if the page of the viewer is a part of this build.
#[pyfunction]
pub(crate) fn has_page() -> bool {
    Viewer::has_page()
}

/// The file that a mechanism was loaded from, if any.
fn file(origin: &Origin) -> String {
    match origin {
        Origin::Model { model, .. } => model.clone(),
        Origin::Text { path, .. } => path.to_string_lossy().into_owned(),
        Origin::Actuated { of, .. }
        | Origin::Limited { of, .. }
        | Origin::Fixed { of, .. }
        | Origin::Tool { of, .. }
        | Origin::Group { of, .. } => file(&of.origin),
    }
}
