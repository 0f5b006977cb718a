//! The secondary tasks as one table: name, parameters and velocities of each.
//!
//! A new task is a file with its `add`, a row here and its rows in docs/guide/control.md: the
//! enum, its names, defaults and checks, `--secondary` of the command line, the argument of Python
//! and the tests over [`SecondaryTask::all`] are made from the row.
//!
//! Checked  tests/it/parameters.rs, tests/it/servo/secondary.rs

use super::{Context, centring, limit_avoidance, manipulability, posture};
use crate::error::{Error, Result};
use crate::model::Mechanism;

/// Hands the table to a macro. A row: documentation, variant, name, a configuration where the task
/// has one, parameters (documentation, name, unit, domain, default), and the velocities, which do
/// not allocate.
///
/// Exported for the docstrings of the Python package, which are literals.
#[doc(hidden)]
#[macro_export]
macro_rules! secondary_tasks {
    ($take:ident) => {
        $take! {
            /// Towards a preferred configuration.
            Posture = "posture" (
                /// The configuration (all n coordinates of the mechanism).
                q
            ) {
                /// Velocity for each unit of distance.
                gain: "1/s" in Finite = 1.0;
            } => |context, out| posture::add(context, q, gain, out),

            /// Towards the middle of the joint limits.
            Centring = "centring" () {
                /// Velocity for each unit of distance.
                gain: "1/s" in Finite = 1.0;
            } => |context, out| centring::add(context, gain, out),

            /// Away from joint limits that are near.
            LimitAvoidance = "limit-avoidance" () {
                /// Velocity at the limit.
                gain: "rad/s or m/s" in Finite = 1.0;
                /// Distance at which it sets in, as a share of the range.
                margin: "-" in Positive = 0.1;
            } => |context, out| limit_avoidance::add(context, gain, margin, out),

            /// Towards larger manipulability (Yoshikawa) of the task, in the metric of the joint
            /// weights.
            Manipulability = "manipulability" () {
                /// Velocity for each unit of the gradient.
                gain: "rad/s" in Finite = 1.0;
            } => |context, out| manipulability::add(context, gain, out),
        }
    };
}

/// Makes [`SecondaryTask`] from the table.
macro_rules! define {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal ($($(#[doc = $own_doc:literal])+ $own:ident)?) {
            $(
                $(#[doc = $about:literal])+
                $parameter:ident: $unit:literal in $domain:ident = $default:expr;
            )+
        } => |$context:ident, $out:ident| $add:expr,
    )+) => {
        /// A secondary task, projected onto the null space of the end-effector task.
        #[derive(Debug, Clone, PartialEq)]
        #[non_exhaustive]
        pub enum SecondaryTask {
            $(
                $(#[doc = $doc])+
                $variant {
                    $($(#[doc = $own_doc])+ $own: Vec<f64>,)?
                    $(
                        $(#[doc = $about])+
                        #[doc = concat!(" Unit: ", $unit, ".")]
                        $parameter: f64,
                    )+
                },
            )+
        }

        $crate::inverse::impl_parameters! {
            SecondaryTask: $(
                $(#[doc = $doc])+
                $variant = $name {
                    $($(#[doc = $about])+ $parameter: $unit in $domain = $default;)+
                }
            )+
        }

        impl SecondaryTask {
            /// The names of the tasks.
            pub const NAMES: [&'static str; [$($name),+].len()] = [$($name),+];

            /// Every task with its default parameters; `posture` is the configuration of the
            /// posture task.
            #[must_use]
            pub fn all(posture: &[f64]) -> [Self; Self::NAMES.len()] {
                [$(Self::$variant { $($own: posture.to_vec(),)? $($parameter: $default),+ }),+]
            }

            /// Adds the joint velocities of the task for the chain's coordinates to `out`. No
            /// allocation.
            pub(in super::super) fn add_velocities(
                &self,
                context: &mut Context<'_>,
                out: &mut [f64],
            ) {
                match self {
                    $(Self::$variant { $($own,)? $($parameter),+ } => {
                        $(let $parameter = *$parameter;)+
                        let ($context, $out) = (context, out);
                        $add;
                    })+
                }
            }
        }
    };
}

secondary_tasks!(define);

impl SecondaryTask {
    /// The task of this name with its default parameters; `posture` is the configuration of the
    /// task "posture".
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str, posture: &[f64]) -> Result<Self> {
        let found = Self::all(posture).into_iter().find(|task| task.name() == name);
        found.ok_or_else(|| Error::unknown("secondary task", name, Self::NAMES))
    }

    /// The same task with another value of a parameter.
    ///
    /// ```
    /// use cylindroid::control::SecondaryTask;
    ///
    /// let task = SecondaryTask::named("limit-avoidance", &[])?.with("margin", 0.2)?;
    /// assert_eq!(task, SecondaryTask::LimitAvoidance { gain: 1.0, margin: 0.2 });
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the parameters of the task; a value outside the domain.
    pub fn with(mut self, parameter: &str, value: f64) -> Result<Self> {
        let all = self.parameters();
        match self.parameters_mut().find(|(p, _)| p.name == parameter) {
            Some((row, place)) => {
                row.check(value)?;
                *place = value;
            }
            None => {
                let names = all.iter().map(|p| p.name);
                return Err(Error::unknown("parameter of a secondary task", parameter, names));
            }
        }
        Ok(self)
    }

    /// Refuses parameters outside their domains, a posture of another mechanism, and tasks that the
    /// loops of a mechanism do not allow.
    pub(in crate::control) fn check(&self, mechanism: &Mechanism) -> Result<()> {
        self.check_parameters()?;
        if let Self::Posture { q, .. } = self {
            mechanism.check_q("posture", q)?;
        }
        if mechanism.is_closed() && self.needs_hessian() {
            let all = Self::all(&[]);
            let others: Vec<&str> =
                all.iter().filter(|task| !task.needs_hessian()).map(Self::name).collect();
            return Err(Error::InvalidOption {
                option: "secondary",
                value: self.name().to_owned(),
                reason: format!(
                    "'{}' has loops, in which its gradient would be that of the cut tree; use {}",
                    mechanism.name(),
                    others.join(", ")
                ),
            });
        }
        Ok(())
    }

    /// True if the task reads the derivatives of the Jacobian, which are those of a tree.
    pub(in super::super) const fn needs_hessian(&self) -> bool {
        matches!(self, Self::Manipulability { .. })
    }
}
