//! Whether the ranges of MJCF limit: `limited` and its kin.
//!
//! Formula  "true": limited; "auto" or missing: limited if lower < upper; "false": not
//! Valid    hinges, slides and balls, and actuators; a free joint has no range
//! Fails    "true" with a lower end that is not below the upper one; a range without "true" or "false"
//!          where `<compiler autolimits="false">`
//! Why so   MuJoCo 4.0 reads such files so, or refuses them; a range that limits nothing is noted
//! Source   mujoco.readthedocs.io, XML reference, compiler/autolimits, joint/limited
//! Checked  tests/formats/mjcf_strict.rs::ranges_*

use super::compiler::Compiler;
use super::defaults::Element;
use crate::error::Result;
use crate::model::formats::xml::Reader;

impl Compiler {
    /// The range of a joint or an actuator, by the names of the attribute and of its flag; `None` where
    /// it does not limit.
    pub(super) fn range(
        &self,
        reader: &mut Reader<'_>,
        element: &Element<'_>,
        [range, flag]: [&str; 2],
        owner: &str,
    ) -> Result<Option<[f64; 2]>> {
        let given = element.vector::<2>(reader, range)?;
        let [lower, upper] = given.unwrap_or_default();
        let is_explicit = match element.text(flag) {
            None | Some("auto") => None,
            Some("true") => Some(true),
            Some("false") => Some(false),
            Some(other) => {
                let message = format!("{flag} is '{other}', not true, false or auto");
                return Err(element.refuse(reader, flag, message));
            }
        };
        let tag = element.node.tag_name().name();
        match is_explicit {
            Some(true) if lower >= upper => {
                let message = format!(
                    "<{tag}> '{owner}' has {flag} = \"true\", and the lower end {lower} of its \
                     {range} is not below the upper end {upper}"
                );
                let place = if given.is_some() { range } else { flag };
                Err(element.refuse(reader, place, message))
            }
            None if !self.autolimits && [lower, upper] != [0.0; 2] => {
                let message = format!(
                    "<{tag}> '{owner}' has {range} without {flag} = \"true\" or \"false\", and \
                     autolimits is \"false\""
                );
                Err(element.refuse(reader, range, message))
            }
            Some(false) => Ok(None),
            None if lower >= upper => {
                if given.is_some() {
                    let place = element.source_element(range).unwrap_or(element.node);
                    let why = "its lower end is not below its upper end: MuJoCo takes it for none";
                    let what = format!("attribute '{range}' of <{tag}>");
                    reader.note(place, what, why, owner);
                }
                Ok(None)
            }
            _ => Ok(given),
        }
    }
}
