//! The class `Distances`.

use cylindroid::State;
use cylindroid::collision::{CollisionModel, NearPair};
use pyo3::prelude::*;

use crate::arrays::{self, Array};
use crate::error::Result;

/// Pairs of shapes that are near each other, nearest first.
///
/// Attributes
/// ----------
/// pairs : list of tuple of str
///     The links or obstacles a and b of each pair; several shapes of one link are several pairs.
/// distances : ndarray, (k,)
///     Negative: penetration depth [m].
/// points_a, points_b : ndarray, (k, 3)
///     Closest points, in the world; in penetration the deepest ones [m].
/// normals : ndarray, (k, 3)
///     Unit normals from a to b: `points_b - points_a` is the distance times the normal.
/// gradients : ndarray, (k, n)
///     Derivatives of the distances: `gradients @ qd` are their rates.
#[pyclass(frozen, name = "Distances", module = "cylindroid")]
#[derive(Debug)]
pub(crate) struct PyDistances {
    near: Vec<NearPair>,
    pairs: Vec<[String; 2]>,
    gradients: Vec<Vec<f64>>,
    n: usize,
}

impl PyDistances {
    pub(super) fn of(model: &mut CollisionModel, state: &State, margin: f64) -> Result<Self> {
        let mut near = Vec::new();
        model.near(state, margin, &mut near)?;
        near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok(Self {
            pairs: near.iter().map(|n| model.names(n.pair).map(str::to_owned)).collect(),
            gradients: near.iter().map(|n| model.gradient(state, n)).collect(),
            n: state.q().len(),
            near,
        })
    }

    fn vectors<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&NearPair) -> cylindroid::Vec3 + Send + Sync,
    ) -> Result<Array<'py>> {
        arrays::rows(py, Some(self.near.len()), 3, self.near.iter().map(|n| of(n).to_array()))
    }
}

#[pymethods]
impl PyDistances {
    #[getter]
    fn pairs(&self) -> Vec<(&str, &str)> {
        self.pairs.iter().map(|[a, b]| (a.as_str(), b.as_str())).collect()
    }

    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> Array<'py> {
        let all: Vec<f64> = self.near.iter().map(|n| n.distance).collect();
        arrays::vector(py, &all)
    }

    #[getter]
    fn points_a<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.vectors(py, |n| n.point_a)
    }

    #[getter]
    fn points_b<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.vectors(py, |n| n.point_b)
    }

    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        self.vectors(py, |n| n.normal)
    }

    #[getter]
    fn gradients<'py>(&self, py: Python<'py>) -> Result<Array<'py>> {
        arrays::rows(py, Some(self.near.len()), self.n, self.gradients.iter())
    }

    fn __len__(&self) -> usize {
        self.near.len()
    }

    fn __repr__(&self) -> String {
        match (self.near.first(), self.pairs.first()) {
            (Some(n), Some([a, b])) => {
                let count = self.near.len();
                format!("<Distances: {count} pairs, '{a}' and '{b}' at {:.6} m>", n.distance)
            }
            _ => "<Distances: no pairs>".to_owned(),
        }
    }
}
