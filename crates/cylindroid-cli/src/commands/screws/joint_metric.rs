//! The metric of joint velocities of `screws --joint-metric`.

use cylindroid::linalg::Metric;
use cylindroid::{Error, Matrix, Result};

use super::super::closed::measured;
use super::twists::Twists;
use crate::values::Weights;

/// Of the joints that move the frame, in their order; `inertia` is the mass matrix of the model with
/// all other joints at rest.
pub(super) fn of(twists: &Twists, given: &Weights) -> Result<Metric> {
    if *given != Weights::Inertia {
        return measured::metric("--joint-metric", given, &twists.names);
    }
    let refuse = |reason: &str| Error::InvalidOption {
        option: "--joint-metric",
        value: "inertia".to_owned(),
        reason: reason.to_owned(),
    };
    let Some((robot, _, q)) = &twists.robot else {
        return Err(refuse("a file of twists has no masses; give weights or a matrix"));
    };
    if twists.is_of_loops() {
        return Err(refuse(
            "the twists of a closed chain are a basis and not those of joints; use \
             manipulability --wq inertia",
        ));
    }
    robot.check_masses()?;
    let mass = robot.state(q)?.mass_matrix();
    let place = |name: &String| robot.coordinates().iter().position(|c| c.name == *name);
    let own: Vec<usize> = twists.names.iter().filter_map(place).collect();
    let own = Matrix::from_fn(own.len(), own.len(), |i, j| mass[(own[i], own[j])]);
    Metric::new("--joint-metric", &own)
}
