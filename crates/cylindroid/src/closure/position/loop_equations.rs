//! The equations of loops and drives at many configurations: residuals and Jacobian, scaled, without
//! allocation.
//!
//! Formula  as `loop_closure.rs`; below them a row for the rate of each actuated loop joint, which has
//!          no residual: with the drives held it is zero
//! Shapes   r: t rows of loops; J: (t + drives) x n
//! Units    none: rows and columns of lengths are divided by the characteristic length
//! Valid    any configuration
//! Checked  tests in this file, tests/map/

use super::coordinates::unit_of;
use crate::closure::constraint::constraint_rows::{
    ConstraintRow, ConstraintRows, for_each_rate, joints_with_rate,
};
use crate::error::Result;
use crate::kinematics::State;
use crate::linalg::{Matrix, norm};
use crate::model::Mechanism;

/// The equations of a mechanism, and their values at a configuration.
#[derive(Debug, Clone)]
pub(crate) struct LoopEquations {
    pairs: ConstraintRows,
    state: State,
    rows: Vec<ConstraintRow>,
    /// The row of the rate of each loop joint of one coordinate, if it is actuated.
    drive_rows: Vec<Option<usize>>,
    /// For each constraint row its place.
    places: Vec<Option<usize>>,
    /// The change of each coordinate per unit of its scaled change.
    units: Vec<f64>,
    length: f64,
    loops: usize,
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: Matrix,
    pub(crate) is_closed: bool,
}

impl LoopEquations {
    /// At home.
    ///
    /// # Errors
    /// An actuated loop joint of several coordinates.
    pub(crate) fn of(mechanism: &Mechanism) -> Result<Self> {
        let pairs = ConstraintRows::of(mechanism)?;
        let rates = joints_with_rate(mechanism);
        let loops = pairs.most_rows().sum::<usize>() - rates.len();
        let mut drives = 0;
        let mut drive = |actuated: bool| {
            drives += usize::from(actuated);
            actuated.then_some(loops + drives - 1)
        };
        let drive_rows: Vec<Option<usize>> = rates.iter().map(|l| drive(l.actuated)).collect();
        let n = mechanism.n();
        let mut equations = Self {
            state: mechanism.state(mechanism.home())?,
            rows: Vec::with_capacity(pairs.most_rows().sum()),
            places: Vec::with_capacity(pairs.most_rows().sum()),
            pairs,
            units: (0..n).map(|i| unit_of(mechanism, i)).collect(),
            length: mechanism.reach(),
            loops,
            residuals: vec![0.0; loops],
            jacobian: Matrix::zeros(loops + drives, n),
            drive_rows,
            is_closed: false,
        };
        equations.set(mechanism.home())?;
        Ok(equations)
    }

    /// Number of rows of loops; those of drives follow.
    pub(crate) fn loop_rows(&self) -> usize {
        self.loops
    }

    pub(crate) fn mechanism(&self) -> &Mechanism {
        self.state.mechanism()
    }

    pub(crate) fn state(&self) -> &State {
        &self.state
    }

    /// The change of a coordinate (m or rad) per unit of its scaled change.
    pub(crate) fn unit(&self, coordinate: usize) -> f64 {
        self.units[coordinate]
    }

    /// Moves to `q`.
    ///
    /// # Errors
    /// As [`Mechanism::check_q`].
    pub(crate) fn set(&mut self, q: &[f64]) -> Result<()> {
        self.state.set(q)?;
        let error = self.pairs.load(&self.state, &mut self.rows);
        self.is_closed = error.is_closed(self.length);
        self.places.clear();
        self.residuals.fill(0.0);
        let mut next = 0;
        for row in &self.rows {
            let place = match row.rate_of {
                Some(rate) => self.drive_rows[rate],
                None => {
                    self.residuals[next] = row.scaled_residual(self.length);
                    next += 1;
                    Some(next - 1)
                }
            };
            self.places.push(place);
        }
        let Self { state, rows, places, units, jacobian, length, .. } = self;
        jacobian.as_mut_slice().fill(0.0);
        for_each_rate(state, rows, |i, coordinate, rate| {
            if let Some(place) = places[i] {
                jacobian[(place, coordinate)] +=
                    rate * units[coordinate] / rows[i].unit.size(*length);
            }
        });
        Ok(())
    }

    /// Euclidean norm of the residuals.
    pub(crate) fn residual_norm(&self) -> f64 {
        norm(&self.residuals)
    }
}

#[cfg(all(test, feature = "formats"))]
mod tests {
    use super::*;
    use crate::closure::position::load::load;
    use crate::closure::position::loop_closure::LoopClosure;

    /// The numbers are those of the single evaluation; actuated loop joints have a row.
    #[test]
    fn equations_are_those_of_loop_closure() {
        for (name, drives) in [("five-bar", 0), ("stewart", 0), ("delta", 0), ("watt", 0)] {
            let mechanism = load(name).unwrap();
            let mut equations = LoopEquations::of(&mechanism).unwrap();
            let q: Vec<f64> =
                mechanism.home().iter().enumerate().map(|(i, x)| x + 0.01 * i as f64).collect();
            equations.set(&q).unwrap();
            let expected = LoopClosure::of(&mechanism, &q).unwrap();
            let loops = equations.loop_rows();
            assert_eq!(equations.jacobian.rows(), loops + drives, "{name}");
            assert_eq!(equations.jacobian.rows_between(0, loops), expected.jacobian, "{name}");
            assert_eq!(equations.residuals, expected.residuals);
            assert_eq!(equations.residual_norm(), expected.residual_norm);
        }
        let five_bar = load("five-bar").unwrap().with_actuated(&["q1", "q5"]).unwrap();
        let equations = LoopEquations::of(&five_bar).unwrap();
        assert_eq!(equations.jacobian.rows(), equations.loop_rows() + 1);
    }
}
