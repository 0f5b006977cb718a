//! Parameters of methods and tasks: name, unit, default, domain and description, declared once.
//!
//! The command line makes its flags and help from these rows, Python its keyword arguments and
//! docstrings, the viewer its controls, and the book its tables.
//!
//! Checked  tests/it/parameters.rs

use crate::error::{Error, Result};

/// A parameter of an inverse or of a secondary task.
///
/// ```
/// let method = cylindroid::Method::default();
/// let eps = &method.parameters()[0];
/// assert_eq!((eps.name, eps.unit, eps.default), ("eps", "-", 1e-3));
/// assert!(eps.check(0.5).is_ok() && eps.check(1.0).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Its name: the field of the variant; on the command line with `-` in place of `_`.
    pub name: &'static str,
    /// Its unit, `-` for a ratio.
    pub unit: &'static str,
    /// The values that it may take.
    pub domain: Domain,
    /// The value where none is given; where one must be given, a value to try.
    pub default: f64,
    /// Whether it must be given: a choice that no default can make.
    pub required: bool,
    /// One sentence on what it does.
    pub description: &'static str,
}

impl Parameter {
    /// A parameter with a default. The lines of a doc comment begin with a space.
    pub(crate) const fn new(
        [name, unit, description]: [&'static str; 3],
        domain: Domain,
        default: f64,
    ) -> Self {
        let description = description.trim_ascii();
        Self { name, unit, domain, default, required: false, description }
    }

    /// The same parameter, to be given by the caller.
    pub(crate) const fn required(self) -> Self {
        Self { required: true, ..self }
    }

    /// Refuses a value outside the domain.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] with the name, the value and the domain.
    pub fn check(&self, value: f64) -> Result<()> {
        if self.domain.contains(value) {
            return Ok(());
        }
        Err(Error::InvalidOption {
            option: self.name,
            value: value.to_string(),
            reason: format!("it must be {}", self.domain.describe()),
        })
    }
}

/// The values that a parameter may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Domain {
    /// Positive and finite.
    Positive,
    /// At least 0 and below 1.
    Fraction,
    /// Any finite value.
    Finite,
    /// Any value but NaN.
    Extended,
}

impl Domain {
    /// True if the value lies in the domain.
    #[must_use]
    pub const fn contains(self, value: f64) -> bool {
        match self {
            Self::Positive => value > 0.0 && value.is_finite(),
            Self::Fraction => value >= 0.0 && value < 1.0,
            Self::Finite => value.is_finite(),
            Self::Extended => !value.is_nan(),
        }
    }

    /// The domain in words, after "it must be".
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Positive => "positive and finite",
            Self::Fraction => "at least 0 and below 1",
            Self::Finite => "finite",
            Self::Extended => "a number or infinite",
        }
    }
}

/// Names, descriptions, parameters and values of an enum whose variants are rows of a table.
macro_rules! impl_parameters {
    ($type:ident: $(
        $(#[doc = $doc:literal])+
        $variant:ident = $name:literal {
            $(
                $(#[doc = $about:literal])+
                $parameter:ident: $unit:literal in $domain:ident = $default:expr;
            )+
        }
    )+) => {
        impl $type {
            /// Its name in options and reports.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $name,)+
                }
            }

            /// What it does, in one or two sentences.
            #[must_use]
            pub const fn description(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => concat!($($doc),+).trim_ascii(),)+
                }
            }

            /// Its parameters: names, units, domains and defaults.
            #[must_use]
            pub const fn parameters(&self) -> &'static [$crate::inverse::Parameter] {
                use $crate::inverse::{Domain, Parameter};
                match self {
                    $(Self::$variant { .. } => {
                        const ROWS: &[Parameter] = &[$(
                            Parameter::new(
                                [stringify!($parameter), $unit, concat!($($about),+)],
                                Domain::$domain,
                                $default,
                            )
                        ),+];
                        ROWS
                    })+
                }
            }

            /// Its parameters and their values, to be set.
            pub fn parameters_mut(
                &mut self,
            ) -> impl Iterator<Item = (&'static $crate::inverse::Parameter, &mut f64)> {
                let rows = self.parameters();
                let values = match self {
                    $(Self::$variant { $($parameter,)+ .. } => vec![$($parameter),+],)+
                };
                rows.iter().zip(values)
            }

            /// The values of its parameters by name.
            #[must_use]
            pub fn values(&self) -> std::collections::BTreeMap<&'static str, f64> {
                let mut own = Self::clone(self);
                own.parameters_mut().map(|(parameter, value)| (parameter.name, *value)).collect()
            }

            /// Refuses parameters outside their domains.
            fn check_parameters(&self) -> $crate::error::Result<()> {
                let mut own = Self::clone(self);
                own.parameters_mut().try_for_each(|(parameter, value)| parameter.check(*value))
            }
        }
    };
}
pub(crate) use impl_parameters;
