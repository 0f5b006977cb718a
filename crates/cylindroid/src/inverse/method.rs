//! The inverse methods (pseudoinverses) as one table: name, parameters and gains of each.
//!
//! A new method is a file with its `gains`, a row here and its rows in docs/guide/inverses.md: the
//! enum, its names, defaults and checks, the flags of the command line, the keyword arguments of
//! Python, the controls of the viewer and the tests over [`Method::ALL`] are made from the row.
//!
//! Why so   a macro, since every row declares the fields of a variant: `Method::Damped { damping }`
//!          is checked by the compiler, where a list of names and values would be looked up
//! Checked  tests/it/parameters.rs, tests/it/inverse.rs

use super::damped::gains as damped;
use super::numerical_filtering::{Filter, gains as numerical_filtering};
use super::selectively_damped::gains as selectively_damped;
use super::singular_value_filtering::gains as singular_value_filtering;
use super::truncated::gains as truncated;
use super::variable_damping::gains as variable_damping;
use crate::error::{Error, Result};
use crate::linalg::Svd;
use crate::tolerance;

/// Hands the table to a macro. A row: documentation, variant, name, parameters (documentation,
/// name, unit, domain, default), and the gains `1 / s_i` is replaced by; they return the singular
/// value below which a direction counts as dropped, and do not allocate.
///
/// Exported for the docstrings of the Python package, which are literals.
#[doc(hidden)]
#[macro_export]
macro_rules! inverse_methods {
    ($take:ident) => {
        $take! {
            /// Truncated pseudoinverse: singular values at or below `eps` times the largest are
            /// cut. Exact elsewhere; jumps there.
            Truncated = "truncated" {
                /// Relative threshold at which singular values are cut.
                eps: "-" in Fraction = tolerance::TRUNCATION;
            } => |svd, _task, out| truncated(svd, eps, out),

            /// Damped least squares `J^T (J J^T + damping^2)^-1`: smooth everywhere, exact nowhere.
            Damped = "damped" {
                /// Damping, in the unit of the (scaled) singular values.
                damping: "rad" in Positive = tolerance::DAMPING;
            } => |svd, _task, out| damped(svd, damping, out),

            /// Damped least squares with a damping that rises from zero as the smallest singular
            /// value falls below the onset.
            VariableDamping = "variable-damping" {
                /// Share of the largest singular value below which damping sets in.
                onset: "-" in Fraction = tolerance::DAMPING_ONSET;
                /// Damping at the singularity, in the unit of the (scaled) singular values.
                damping: "rad" in Positive = tolerance::DAMPING;
            } => |svd, _task, out| variable_damping(svd, onset, damping, out),

            /// Numerical filtering: a little damping in all directions near a singularity, strong
            /// damping along the weakest one.
            NumericalFiltering = "numerical-filtering" {
                /// Share of the largest singular value below which damping sets in.
                onset: "-" in Fraction = tolerance::DAMPING_ONSET;
                /// Damping of all directions at the singularity, in the unit of the (scaled)
                /// singular values.
                damping: "rad" in Positive = 0.1 * tolerance::DAMPING;
                /// Additional damping of the weakest direction, in the unit of the (scaled)
                /// singular values.
                filter: "rad" in Positive = tolerance::DAMPING;
            } => |svd, _task, out| {
                let weakest = filter;
                let filter = Filter { onset, damping, weakest };
                numerical_filtering(svd, filter, out)
            },

            /// Selectively damped least squares: each direction is slowed down as far as its joint
            /// velocities require.
            SelectivelyDamped = "selectively-damped" {
                /// Largest velocity of any joint.
                max_joint_velocity: "rad/s or m/s" in Positive = std::f64::consts::FRAC_PI_4;
            } => |svd, task, out| selectively_damped(svd, max_joint_velocity, task, out),

            /// Singular value filtering: a smooth function replaces each singular value and never
            /// falls below the floor.
            SingularValueFiltering = "singular-value-filtering" {
                /// Shape nu of the filter: the larger, the closer to the exact inverse away from
                /// zero.
                shape: "-" in Positive = 10.0;
                /// Smallest filtered singular value, in the unit of the (scaled) singular values.
                floor: "rad" in Positive = tolerance::DAMPING;
            } => |svd, _task, out| singular_value_filtering(svd, shape, floor, out),
        }
    };
}

/// Makes [`Method`] from the table.
macro_rules! define {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal {
            $(
                $(#[doc = $about:literal])+
                $parameter:ident: $unit:literal in $domain:ident = $default:expr;
            )+
        } => |$svd:ident, $task:ident, $out:ident| $gains:expr,
    )+) => {
        /// A method to invert a Jacobian near its singularities (a robust pseudoinverse).
        ///
        /// ```
        /// let mut method = cylindroid::Method::named("truncated")?;
        /// for (parameter, value) in method.parameters_mut() {
        ///     assert_eq!(parameter.name, "eps");
        ///     *value = 1e-6;
        /// }
        /// assert_eq!(method, cylindroid::Method::Truncated { eps: 1e-6 });
        /// # Ok::<(), cylindroid::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum Method {
            $(
                $(#[doc = $doc])+
                $variant {
                    $(
                        $(#[doc = $about])+
                        #[doc = concat!(" Unit: ", $unit, ".")]
                        $parameter: f64,
                    )+
                },
            )+
        }

        $crate::inverse::impl_parameters! {
            Method: $(
                $(#[doc = $doc])+
                $variant = $name {
                    $($(#[doc = $about])+ $parameter: $unit in $domain = $default;)+
                }
            )+
        }

        impl Method {
            /// Every method with its default parameters, for singular values scaled by a
            /// characteristic length.
            pub const ALL: [Self; [$($name),+].len()] =
                [$(Self::$variant { $($parameter: $default),+ }),+];

            /// Writes the gain of each direction and returns the singular value below which a
            /// direction counts as dropped. `task` is the motion to be inverted, which only
            /// selectively damped least squares reads. No allocation.
            pub(crate) fn gains(&self, svd: &Svd, task: &[f64], out: &mut [f64]) -> f64 {
                match *self {
                    $(Self::$variant { $($parameter),+ } => {
                        let ($svd, $task, $out) = (svd, task, out);
                        $gains
                    })+
                }
            }
        }
    };
}

inverse_methods!(define);

impl Default for Method {
    /// The truncated pseudoinverse.
    fn default() -> Self {
        Self::Truncated { eps: tolerance::TRUNCATION }
    }
}

impl Method {
    /// The method of this name with its default parameters.
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|m| m.name() == name)
            .ok_or_else(|| Error::unknown("inverse", name, Self::ALL.iter().map(Self::name)))
    }

    /// Refuses parameters outside their domains.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] with the parameter and its value.
    pub fn check(&self) -> Result<()> {
        self.check_parameters()
    }
}
