//! A mechanism file that is read once and built with several values of its parameters.
//!
//! Why so   designs are counted in thousands, and reading a file takes longer than building it;
//!          here the file may change meanwhile
//! Checked  tests/formats/parameters.rs::a_parametric_model_*

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::load::{load_with_parameters, read_text};
use crate::error::Result;
use crate::model::{Mechanism, Parameter, catalogue, formats};

/// A mechanism file that is read once and built with several values of its parameters.
///
/// ```
/// use cylindroid::ParametricModel;
///
/// let text = r#"
/// [parameters]
/// length = { value = 0.4, lower = 0.1, upper = 1.0, unit = "m" }
///
/// [[joint]]
/// name = "shoulder"
/// type = "revolute"
/// between = ["ground", "arm"]
/// origin = [0, 0, 0]
/// axis = [0, 0, 1]
///
/// [[frame]]
/// name = "tip"
/// link = "arm"
/// xyz = ["length", 0, 0]
/// "#;
/// let arms = ParametricModel::of_text(text, "arm.toml".as_ref(), &[])?;
/// let long = arms.with(&[("length", 0.8)])?;
/// let tip = long.state(&[0.0])?.pose(long.frame("tip")?)?;
/// assert_eq!(tip.translation.x, 0.8);
/// assert!(arms.with(&[("length", 2.0)]).is_err());
/// # Ok::<(), cylindroid::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ParametricModel {
    text: Cow<'static, str>,
    path: PathBuf,
    /// The name of a catalogue model.
    catalogue: Option<String>,
    given: Vec<(String, f64)>,
    nominal: Mechanism,
}

impl ParametricModel {
    /// Reads a model file, or takes a catalogue model, with these values of parameters.
    ///
    /// # Errors
    /// Those of [`load_with_parameters`](crate::load_with_parameters); a file of another format.
    pub fn read(name_or_path: &str, given: &[(&str, f64)]) -> Result<Self> {
        let (text, path) = formats::load::mechanism_text(name_or_path)?;
        let is_catalogue = catalogue::names().contains(&name_or_path);
        Self::new(text, path, is_catalogue.then(|| name_or_path.to_owned()), given)
    }

    /// The text of a mechanism file; the path is used as in [`load_text`](crate::load_text).
    ///
    /// # Errors
    /// Those of [`load_text`](crate::load_text), and of values.
    pub fn of_text(text: &str, path: &Path, given: &[(&str, f64)]) -> Result<Self> {
        Self::new(text.to_owned().into(), path.to_owned(), None, given)
    }

    fn new(
        text: Cow<'static, str>,
        path: PathBuf,
        catalogue: Option<String>,
        given: &[(&str, f64)],
    ) -> Result<Self> {
        let nominal = build(&text, &path, catalogue.as_deref(), given)?;
        let given = given.iter().map(|(name, x)| ((*name).to_owned(), *x)).collect();
        Ok(Self { text, path, catalogue, given, nominal })
    }

    /// The mechanism with the values that were given, otherwise those of the file.
    #[must_use]
    pub fn nominal(&self) -> &Mechanism {
        &self.nominal
    }

    /// The parameters, in the order of the file.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        self.nominal.parameters()
    }

    /// The mechanism with these values; other parameters are those of [`ParametricModel::nominal`].
    ///
    /// # Errors
    /// Unknown parameters, values out of range, and all errors of a file whose numbers follow from
    /// these values, loops that cannot be closed among them.
    pub fn with(&self, values: &[(&str, f64)]) -> Result<Mechanism> {
        let is_new = |name: &str| values.iter().all(|(other, _)| *other != name);
        let kept = self.given.iter().map(|(name, x)| (name.as_str(), *x));
        let mut all: Vec<(&str, f64)> = kept.filter(|(name, _)| is_new(name)).collect();
        all.extend(values);
        build(&self.text, &self.path, self.catalogue.as_deref(), &all)
    }

    /// The text of the file.
    #[cfg(feature = "sweep")]
    pub(crate) fn text(&self) -> &str {
        &self.text
    }
}

fn build(
    text: &str,
    path: &Path,
    catalogue: Option<&str>,
    given: &[(&str, f64)],
) -> Result<Mechanism> {
    match catalogue {
        Some(name) => load_with_parameters(name, given),
        None => read_text(text, path, given),
    }
}
