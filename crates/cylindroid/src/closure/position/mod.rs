//! Loop closure at position level: configurations in which all loops and contacts are closed.
//!
//! `loop_closure` evaluates the residuals and their Jacobian; `assembly` solves them by damped
//! Gauss-Newton from an initial guess. Start there. `coordinates` holds the lists of coordinates.
//! `predictor_corrector` tracks one branch of closed configurations, and `continuation` moves
//! coordinates along it up to a singularity or limit. `assembly_modes` searches for all assemblies
//! from the random restarts of `initial_guesses`; `configuration_signature` distinguishes them.
//! `platform` makes coordinates of the pose of an end effector, so that it can be prescribed.
//! Maps move it with `platform_path` and follow `singular_curve`s, by the `loop_equations` and the
//! `signed_singularity` of one mechanism; zones end at the `nearest_singularity`.

pub(crate) mod assembly;
pub(crate) mod assembly_modes;
pub(crate) mod configuration_signature;
pub(crate) mod continuation;
pub(crate) mod coordinates;
pub(crate) mod initial_guesses;
#[cfg(feature = "formats")]
pub(crate) mod load;
pub(crate) mod loop_closure;
#[cfg(feature = "sweep")]
pub(crate) mod loop_equations;
#[cfg(feature = "sweep")]
pub(crate) mod nearest_singularity;
#[cfg(feature = "formats")]
pub(crate) mod parametric_model;
pub(crate) mod platform;
#[cfg(feature = "sweep")]
pub(crate) mod platform_path;
pub(crate) mod predictor_corrector;
#[cfg(feature = "sweep")]
pub(crate) mod signed_singularity;
#[cfg(feature = "sweep")]
pub(crate) mod singular_curve;
