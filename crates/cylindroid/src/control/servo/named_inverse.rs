//! Inverses by name, as users choose them: methods, hyperbolic and oblique pseudoinverses, their
//! parameters, and a fallback.
//!
//! One table for all front ends: the command line makes its flags and help from it, Python its
//! docstrings, the viewer its controls.
//!
//! Fails    unknown names, with the nearest; parameters of another inverse; a parameter that must
//!          be given and is missing; a fallback for a method, which needs none
//! Checked  tests/it/parameters.rs

use super::inverse_choice::InverseChoice;
use super::options::ServoOptions;
use super::projection::TaskProjection;
use crate::error::{Error, Result};
use crate::inverse::{Domain, HyperbolicDamping, Method, Parameter};
use crate::kinematics::ReferenceFrame;
use crate::spatial::Twist;
use crate::tolerance::LENGTHS;

const PITCH: Parameter = Parameter::new(
    ["h", "m/rad", "Pitch of the form; may be infinite. A length of the order of the arm."],
    Domain::Extended,
    0.1,
)
.required();
const MU: Parameter = Parameter::new(
    ["mu", "m/rad", "Invariant damping of the hyperbolic pseudoinverse."],
    Domain::Positive,
    0.01,
)
.required();
const LAMBDA: Parameter = Parameter::new(
    ["lambda", "m/rad", "Damping of the Gram matrix, of either sign."],
    Domain::Finite,
    0.01,
)
.required();

/// An inverse that a servo can be given by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NamedInverse {
    /// Its name.
    pub name: &'static str,
    /// Formula and behaviour in one or two sentences.
    pub description: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// True for hyperbolic and oblique inverses: they may not exist, or may enlarge a motion too
    /// much (also where damping makes them exist), and so can have a fallback or be one.
    pub is_partial: bool,
    /// True if it is given a complement: the twists along which a motion may be changed.
    pub takes_complement: bool,
}

/// A row of the projections: values of the parameters in their order, and the complement.
type Build = fn(&[f64], &[Twist]) -> TaskProjection;

/// Those that choose the realised part of a motion, each with the [`TaskProjection`] that it makes.
const PROJECTIONS: [(NamedInverse, Build); 4] = [
    (
        partial(
            TaskProjection::NAMES[0],
            "Hyperbolic pseudoinverse (Donelan & Selig): frame- and unit-invariant joint \
             velocities; the discarded part is h-reciprocal to all motions of the arm.",
            &[PITCH],
        ),
        |values, _| TaskProjection::Hyperbolic { h: values[0] },
    ),
    (
        partial(
            TaskProjection::NAMES[1],
            "Hyperbolic pseudoinverse with invariant damping; always exists.",
            &[PITCH, MU],
        ),
        |values, _| TaskProjection::DampedHyperbolic {
            h: values[0],
            damping: HyperbolicDamping::Invariant { mu: values[1] },
        },
    ),
    (
        partial(
            TaskProjection::NAMES[2],
            "Hyperbolic pseudoinverse with damping of the Gram matrix.",
            &[PITCH, LAMBDA],
        ),
        |values, _| TaskProjection::DampedHyperbolic {
            h: values[0],
            damping: HyperbolicDamping::Gram { lambda: values[1] },
        },
    ),
    (
        NamedInverse {
            takes_complement: true,
            ..partial(
                TaskProjection::NAMES[3],
                "Oblique projection: the discarded part is a sum of given twists.",
                &[],
            )
        },
        |_, complement| TaskProjection::Oblique {
            complement: complement.to_vec(),
            reference: ReferenceFrame::Local,
        },
    ),
];

const fn partial(
    name: &'static str,
    description: &'static str,
    parameters: &'static [Parameter],
) -> NamedInverse {
    NamedInverse { name, description, parameters, is_partial: true, takes_complement: false }
}

impl NamedInverse {
    /// All of them: the methods first, then the hyperbolic and oblique ones.
    ///
    /// ```
    /// use cylindroid::control::NamedInverse;
    ///
    /// let damped = NamedInverse::all().find(|i| i.name == "damped").unwrap();
    /// assert_eq!(damped.parameters[0].name, "damping");
    /// ```
    pub fn all() -> impl Iterator<Item = Self> {
        let methods = Method::ALL.into_iter().map(|method| Self {
            name: method.name(),
            description: method.description(),
            parameters: method.parameters(),
            is_partial: false,
            takes_complement: false,
        });
        methods.chain(PROJECTIONS.map(|(inverse, _)| inverse))
    }

    /// The one of this name.
    ///
    /// ```
    /// use cylindroid::control::NamedInverse;
    ///
    /// assert!(NamedInverse::named("hyperbolic")?.parameters.len() > 0);
    /// assert!(NamedInverse::named("hyperbole").is_err()); // the message lists the nearest names
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] with the nearest names.
    pub fn named(name: &str) -> Result<Self> {
        Self::all()
            .find(|i| i.name == name)
            .ok_or_else(|| Error::unknown("inverse", name, Self::all().map(|i| i.name)))
    }
}

/// An inverse as a user names it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InverseSelection<'a> {
    /// Its name, see [`NamedInverse::all`].
    pub name: &'a str,
    /// Parameters by name; the others keep their defaults.
    pub parameters: Vec<(&'a str, f64)>,
    /// Twists of the tool, in its axes, along which a motion may be changed (`oblique`).
    pub complement: Vec<Twist>,
    /// The inverse that takes over where this one does not exist or enlarges a motion too much.
    pub fallback: Option<&'a str>,
}

impl InverseSelection<'_> {
    /// Sets method, projection and fallback of a servo.
    ///
    /// ```
    /// use cylindroid::control::InverseSelection;
    /// use cylindroid::{Method, ServoOptions, catalogue};
    ///
    /// let mut options = ServoOptions::new(&catalogue::load("panda")?);
    /// let parameters = vec![("damping", 0.05)];
    /// InverseSelection { name: "damped", parameters, ..Default::default() }.apply(&mut options)?;
    /// assert_eq!(options.method, Method::Damped { damping: 0.05 });
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownName`] for an inverse, a parameter or a fallback; [`Error::InvalidOption`]
    /// for a parameter of another inverse, outside its domain, or required and missing, and for a
    /// fallback of a method (truncated, damped, ...), which needs none.
    pub fn apply(&self, options: &mut ServoOptions) -> Result<()> {
        let chosen = NamedInverse::named(self.name)?;
        let fallback = self.fallback.map(|name| self.find_fallback(&chosen, name)).transpose()?;
        // A servo inverts the projected task by the default method.
        let plain = NamedInverse::named(Method::default().name())?;
        let by_method = chosen.is_partial.then_some(plain);
        let more: Vec<NamedInverse> = fallback.iter().copied().chain(by_method).collect();
        self.refuse_foreign(&chosen, &more)?;
        let method = self.method_of(&chosen)?;
        let projection = self.projection(&chosen)?;
        let fallback = fallback.map(|f| self.projection(&f)).transpose()?;
        options.method = method;
        (options.projection, options.fallback) = (projection, fallback);
        Ok(())
    }

    /// The inverse for single Jacobians, with the characteristic length in m; a fallback, which
    /// belongs to a servo, is not part of it.
    ///
    /// ```
    /// use cylindroid::ReferenceFrame;
    /// use cylindroid::control::InverseSelection;
    ///
    /// let robot = cylindroid::load("youbot")?;
    /// let state = robot.state(&[0.4, 0.6, 0.9, 0.5, 0.2])?;
    /// let parameters = vec![("h", 0.1)];
    /// let selection = InverseSelection { name: "hyperbolic", parameters, ..Default::default() };
    /// let choice = selection.choice(robot.reach())?;
    /// assert!(choice.inverse(&state, robot.tool(), ReferenceFrame::World, None)?.exists);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`InverseSelection::apply`]; a length that is not one of [`LENGTHS`].
    pub fn choice(&self, length: f64) -> Result<InverseChoice> {
        Error::check_range("length", length, &LENGTHS)?;
        let chosen = NamedInverse::named(self.name)?;
        self.refuse_foreign(&chosen, &[])?;
        let method = self.method_of(&chosen)?;
        Ok(InverseChoice { method, projection: self.projection(&chosen)?, length })
    }

    /// The method of this name with these parameters.
    ///
    /// # Errors
    /// As [`InverseSelection::apply`]; [`Error::UnknownName`] also for hyperbolic and oblique
    /// inverses, which are no methods.
    pub fn method(&self) -> Result<Method> {
        let method = Method::named(self.name)?;
        self.refuse_foreign(&NamedInverse::named(self.name)?, &[])?;
        self.with_values(method)
    }

    /// Its own method, or the default one beside a projection.
    fn method_of(&self, chosen: &NamedInverse) -> Result<Method> {
        self.with_values(if chosen.is_partial {
            Method::default()
        } else {
            Method::named(chosen.name)?
        })
    }

    fn with_values(&self, mut method: Method) -> Result<Method> {
        for (parameter, value) in method.parameters_mut() {
            *value = self.value(parameter.name).unwrap_or(*value);
            parameter.check(*value)?;
        }
        Ok(method)
    }

    fn value(&self, name: &str) -> Option<f64> {
        self.parameters.iter().rev().find(|(n, _)| *n == name).map(|(_, value)| *value)
    }

    /// The default method stands for the orthogonal projection.
    fn find_fallback(&self, chosen: &NamedInverse, name: &str) -> Result<NamedInverse> {
        let plain = Method::default().name();
        let possible = || NamedInverse::all().filter(|i| i.is_partial || i.name == plain);
        if !chosen.is_partial {
            let partial: Vec<&str> = PROJECTIONS.iter().map(|(i, _)| i.name).collect();
            return Err(Error::InvalidOption {
                option: "fallback",
                value: name.to_owned(),
                reason: format!(
                    "the inverse '{}' always exists; a fallback is for {}",
                    chosen.name,
                    partial.join(", ")
                ),
            });
        }
        possible()
            .find(|i| i.name == name)
            .ok_or_else(|| Error::unknown("fallback", name, possible().map(|i| i.name)))
    }

    /// Refuses parameters that neither the chosen inverse nor one of the `more` in use has.
    fn refuse_foreign(&self, chosen: &NamedInverse, more: &[NamedInverse]) -> Result<()> {
        let in_use = || std::iter::once(chosen).chain(more);
        for &(name, value) in &self.parameters {
            if in_use().any(|i| i.parameters.iter().any(|p| p.name == name)) {
                continue;
            }
            let having = |i: &NamedInverse| i.parameters.iter().find(|p| p.name == name);
            let owners: Vec<&str> =
                NamedInverse::all().filter(|i| having(i).is_some()).map(|i| i.name).collect();
            let Some(known) = NamedInverse::all().find_map(|i| having(&i)) else {
                let names = NamedInverse::all().flat_map(|i| i.parameters).map(|p| p.name);
                return Err(Error::unknown("parameter of an inverse", name, names));
            };
            let own: Vec<&str> = chosen.parameters.iter().map(|p| p.name).collect();
            return Err(Error::InvalidOption {
                option: known.name,
                value: value.to_string(),
                reason: format!(
                    "the inverse '{}' has {}; this parameter belongs to {}",
                    chosen.name,
                    if own.is_empty() {
                        "no parameters".to_owned()
                    } else {
                        format!("no such parameter but {}", own.join(", "))
                    },
                    owners.join(", ")
                ),
            });
        }
        if !self.complement.is_empty() && !in_use().any(|i| i.takes_complement) {
            let takers: Vec<&str> =
                NamedInverse::all().filter(|i| i.takes_complement).map(|i| i.name).collect();
            return Err(Error::InvalidOption {
                option: "give_up",
                value: format!("{} motions", self.complement.len()),
                reason: format!("it belongs to the inverse {}", takers.join(", ")),
            });
        }
        Ok(())
    }

    fn projection(&self, inverse: &NamedInverse) -> Result<TaskProjection> {
        let Some((_, build)) = PROJECTIONS.iter().find(|(i, _)| i.name == inverse.name) else {
            return Ok(TaskProjection::Orthogonal);
        };
        let mut values = Vec::new();
        for parameter in inverse.parameters {
            let Some(value) = self.value(parameter.name) else {
                return Err(Error::InvalidOption {
                    option: parameter.name,
                    value: String::new(),
                    reason: format!(
                        "the inverse '{}' needs this parameter, in {}: try {}",
                        inverse.name, parameter.unit, parameter.default
                    ),
                });
            };
            parameter.check(value)?;
            values.push(value);
        }
        Ok(build(&values, &self.complement))
    }
}
