//! Designs that are optimal: values of parameters of a mechanism file that minimise or maximise
//! indices over configurations, and the trade-offs of several indices (Pareto front).
//!
//! Read in this order: `options` (what is optimised), `indices` (the numbers of a design), `simplex`
//! (one refinement), `search` (samples, refinements, front), `pareto` (dominance), `result`.
//!
//! ```
//! use std::path::Path;
//! use cylindroid::ParametricModel;
//! use cylindroid::sweep::{
//!     DesignObjective, Optimisation, OptimisationOptions, ParameterRange, Sense, Source,
//! };
//!
//! // The length of a forearm for which an arm is isotropic at 135 degrees: 1 / sqrt 2.
//! let text = "dimension = 2\nreference = 'hand'\nreference_point = ['1 + b', 0]\n\
//!     [parameters]\nb = 0.9\n\
//!     [[joint]]\nname = 'shoulder'\ntype = 'revolute'\nbetween = ['ground', 'arm']\norigin = [0, 0]\n\
//!     [[joint]]\nname = 'elbow'\ntype = 'revolute'\nbetween = ['arm', 'hand']\norigin = [1, 0]\n";
//! let model = ParametricModel::of_text(text, Path::new("arm.toml"), &[])?;
//! let mut options = OptimisationOptions {
//!     ranges: vec![ParameterRange { name: "b".to_owned(), from: 0.2, to: 2.0 }],
//!     objectives: vec![DesignObjective::named("condition", Sense::Minimise)?],
//!     ..OptimisationOptions::default()
//! };
//! let elbow = 0.75 * std::f64::consts::PI;
//! options.sweep.source = Source::Configurations(vec![0.0, elbow]);
//! options.sweep.task = Some(cylindroid::ik::Task::named("x,y", model.nominal())?);
//! let found = Optimisation::new(&model, options)?.run(None, |_| true)?.unwrap();
//! assert!((found.designs[0].values[0] - 0.5_f64.sqrt()).abs() < 1e-6);
//! # Ok::<(), cylindroid::Error>(())
//! ```

mod indices;
mod options;
mod pareto;
mod result;
mod search;
mod simplex;

pub use options::{DesignObjective, OptimisationOptions, Sense, Statistic};
pub use result::{OptimalDesign, Optimum, Refinement};
pub use search::Optimisation;
