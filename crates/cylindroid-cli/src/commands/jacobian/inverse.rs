//! The inverse of the Jacobian and the joint velocities for one twist.

use std::collections::BTreeMap;
use std::io::Write;

use clap::ValueEnum as _;
use cylindroid::inverse::{Inverse, TruncatedDirection};
use cylindroid::linalg::Matrix;
use cylindroid::tolerance::MAX_MAGNITUDE;
use cylindroid::{EndEffector, Error, ReferenceFrame, Result, State, Twist};
use serde::Serialize;

use crate::args::JacobianArgs;
use crate::commands::inverse_selection::{as_typed, check_pitch, parameters_in_effect, selection};
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
pub(super) struct InverseJson {
    name: String,
    /// The parameters in effect, defaults included.
    parameters: BTreeMap<&'static str, f64>,
    pub(super) exists: bool,
    reason: Option<String>,
    /// A row for each coordinate, six columns, linear first; null if it does not exist.
    matrix: Option<Vec<Vec<f64>>>,
    singular_values: Vec<f64>,
    rank: usize,
    /// null where nothing was dropped but exact zeros.
    gap: f64,
    threshold: f64,
    dropped: Vec<DroppedJson>,
    /// With --twist.
    #[serde(skip_serializing_if = "Option::is_none")]
    twist: Option<[f64; 6]>,
    /// For the twist; null if there is no inverse.
    #[serde(skip_serializing_if = "Option::is_none")]
    joint_velocities: Option<Option<Vec<f64>>>,
    /// The twist that these joint velocities produce.
    #[serde(skip_serializing_if = "Option::is_none")]
    realised: Option<Option<Vec<f64>>>,
}

#[derive(Debug, Serialize)]
struct DroppedJson {
    /// Unit vector; of the methods in the scaled task [v / length; w].
    direction: Vec<f64>,
    singular_value: f64,
    filter_factor: f64,
}

impl From<&TruncatedDirection> for DroppedJson {
    fn from(d: &TruncatedDirection) -> Self {
        Self {
            direction: d.direction.clone(),
            singular_value: d.singular_value,
            filter_factor: d.filter_factor,
        }
    }
}

/// The inverse, if one of its options or a twist was given.
pub(super) fn find(
    args: &JacobianArgs,
    state: &State,
    tool: EndEffector,
    (reference, jacobian): (ReferenceFrame, &Matrix),
    length: f64,
) -> Result<Option<InverseJson>> {
    if args.twist.is_none() && !args.inverse.is_given() {
        return Ok(None);
    }
    let angles = args.analytical.and_then(|angles| angles.to_possible_value());
    let analytical = angles.map(|angles| ("--analytical", angles.get_name().to_owned()));
    let relative = args.relative_to.clone().map(|frame| ("--relative-to", frame));
    if let Some((option, value)) = analytical.or(relative) {
        return Err(Error::InvalidOption {
            option,
            value,
            reason: "inverses are those of the geometric Jacobian, whose task is a twist in the \
                     world; omit the option"
                .to_owned(),
        });
    }
    check_pitch(&args.inverse, None, "here", (state, tool, length))?;
    let choice = selection(&args.inverse, None).choice(length).map_err(as_typed)?;
    let twist = args.twist.map(|t| t.0);
    if let Some(twist) = twist {
        Error::check_within("--twist", &twist, MAX_MAGNITUDE)?;
    }
    let inverse = choice.inverse(state, tool, reference, twist.map(Twist::from_array))?;
    let applied = |t: [f64; 6]| inverse.exists.then(|| inverse.matrix.mul_vec(&t));
    let joint_velocities = twist.map(applied);
    let realised = joint_velocities.as_ref().map(|v| v.as_ref().map(|v| jacobian.mul_vec(v)));
    let Inverse { matrix, singular_values, rank, gap, threshold, dropped, exists, reason } =
        inverse;
    Ok(Some(InverseJson {
        name: args.inverse.name().to_owned(),
        parameters: parameters_in_effect(&args.inverse)?,
        exists,
        reason: reason.map(|r| r.to_string()),
        matrix: exists.then(|| matrix.to_rows()),
        singular_values,
        rank,
        gap,
        threshold,
        dropped: dropped.iter().map(Into::into).collect(),
        twist,
        joint_velocities,
        realised,
    }))
}

pub(super) fn print(
    out: &mut dyn Write,
    found: &InverseJson,
    joint_names: &[&str],
    components: &[&str; 6],
) -> anyhow::Result<()> {
    writeln!(out)?;
    let dropped: Vec<String> = found
        .dropped
        .iter()
        .map(|d| {
            let share = number(output::without_rounding(d.filter_factor));
            format!("({}), filter factor {share}", output::entries(&d.direction))
        })
        .collect();
    output::pairs(
        out,
        [
            ("inverse", found.name.clone()),
            ("parameters", parameters(&found.parameters)),
            ("exists", found.reason.as_ref().map_or_else(String::new, |r| format!("no: {r}"))),
            ("rank", found.rank.to_string()),
            ("dropped directions", dropped.join("; ")),
        ],
    )?;
    if let Some(matrix) = &found.matrix {
        writeln!(out, "\nInverse: joint velocities [rad/s or m/s] per unit of each component")?;
        output::matrix(out, joint_names, components, matrix)?;
    }
    let (Some(twist), Some(velocities)) = (&found.twist, &found.joint_velocities) else {
        return Ok(());
    };
    let Some((velocities, realised)) =
        velocities.as_ref().zip(found.realised.as_ref().and_then(Option::as_ref))
    else {
        return Ok(());
    };
    writeln!(out, "\nJoint velocities for the twist")?;
    let mut columns = vec![("", Align::Left)];
    columns.extend(joint_names.iter().map(|name| (*name, Align::Right)));
    let row = |name: &str, values: &[f64]| {
        let cells = values.iter().map(|x| output::entries(&[*x]));
        std::iter::once(name.to_owned()).chain(cells).collect::<Vec<String>>()
    };
    output::table(out, &columns, [row("[rad/s or m/s]", velocities)])?;
    writeln!(out)?;
    let mut columns = vec![("twist", Align::Left)];
    columns.extend(components.iter().map(|name| (*name, Align::Right)));
    Ok(output::table(out, &columns, [row("requested", twist), row("realised", realised)])?)
}

fn parameters(given: &BTreeMap<&'static str, f64>) -> String {
    let one = |(name, value): (&&str, &f64)| match value.is_infinite() {
        true => format!("{name} infinite"),
        false => format!("{name} {}", number(*value)),
    };
    given.iter().map(one).collect::<Vec<_>>().join(", ")
}
