//! `statics`: torques for a wrench, and the forces in loops and contacts.

use std::io::Write;

use cylindroid::closure::{
    Mobility, MotionSpace, StaticLoad, contact_forces, joint_torques, row_compliance,
    transmitted_wrenches,
};
use cylindroid::{Error, Result};
use serde::Serialize;

use super::stiffness::StiffnessJson;
use super::transmitted_wrench::TransmittedWrenchJson;
use super::{HeadJson, Posed, measured, stiffness, transmitted_wrench};
use crate::args::StaticsArgs;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::output::{self, Align};

#[derive(Debug, Serialize)]
struct StaticsJson<'a> {
    #[serde(flatten)]
    head: HeadJson<'a>,
    /// The components of wrenches.
    components: &'static [&'static str],
    wrench: &'a [f64],
    /// Of the actuated joints, the least in size [N m or N].
    torques: Vec<f64>,
    /// The part of the wrench that the structure resists without torques.
    structural: Vec<f64>,
    /// The part that nothing balances.
    unbalanced: Vec<f64>,
    /// True if forces of loops and contacts are elastic, else they are the least in size.
    elastic: bool,
    /// Under the wrench (less what is unbalanced) and the torques.
    forces: Vec<TransmittedWrenchJson>,
    /// Torques in balance without a wrench, with the forces that go with each.
    internal: Vec<InternalJson>,
    /// Forces that neither torques nor the wrench determine, one entry for each.
    hyperstatic: Vec<Vec<TransmittedWrenchJson>>,
    /// Wrenches resisted without torques.
    zero_torque_basis: Vec<Vec<f64>>,
    /// With elastic joints and links; null where nothing is elastic.
    stiffness: Option<StiffnessJson>,
}

#[derive(Debug, Serialize)]
struct InternalJson {
    torques: Vec<f64>,
    forces: Vec<TransmittedWrenchJson>,
}

pub(crate) fn run(args: &StaticsArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let posed = Posed::new(&args.closed)?;
    let report = find(&posed, args)?;
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &posed, &report)?,
    }
    Ok(Exit::SUCCESS)
}

fn find<'a>(posed: &'a Posed, args: &'a StaticsArgs) -> Result<StaticsJson<'a>> {
    let components = posed.components();
    let wrench = args.wrench.0.as_slice();
    if wrench.len() != components.len() {
        return Err(Error::Dimension {
            what: "--wrench".to_owned(),
            expected: components.len(),
            got: wrench.len(),
            hint: match components.len() {
                3 => "in the plane: fx, fy, mz".to_owned(),
                _ => "forces, then moments: fx, fy, fz, mx, my, mz".to_owned(),
            },
        });
    }
    let chain = &posed.chain;
    let constraint = &chain.constraint;
    let motions = MotionSpace::of(constraint);
    let relation = motions.relation();
    let mobility = Mobility::from_parts(constraint, &motions, &relation);
    let weights = args.wtau.as_ref();
    let weights = weights.map(|w| measured::metric("--wtau", w, &chain.actuated)).transpose()?;
    let found = joint_torques(&relation, wrench, weights.as_ref())?;

    let state = posed.state()?;
    let closings: Vec<&str> = posed.closings();
    let compliance = match &args.compliance {
        None => None,
        Some(given) => {
            given.check("loop joint or contact", &closings)?;
            let of = |name: &&str| {
                given.of(name).ok_or_else(|| Error::InvalidOption {
                    option: "--compliance",
                    value: (*name).to_owned(),
                    reason:
                        "no compliance is given; give a number for all, or name=number for each"
                            .to_owned(),
                })
            };
            let all: Vec<f64> = closings.iter().map(of).collect::<Result<_>>()?;
            Some(row_compliance(&state, chain, &all)?)
        }
    };
    let balanced: Vec<f64> = wrench.iter().zip(&found.unbalanced).map(|(w, u)| w - u).collect();
    let through = |torques: &[f64], wrench: &[f64]| -> Result<Vec<TransmittedWrenchJson>> {
        let load = StaticLoad { torques, wrench };
        let forces = contact_forces(constraint, &motions, load, compliance.as_ref())?.forces;
        Ok(transmitted_wrenches(&state, chain, &forces)?.into_iter().map(Into::into).collect())
    };
    let nothing = vec![0.0; components.len()];
    let internal = output::columns(&mobility.internal.basis)
        .into_iter()
        .map(|torques| Ok(InternalJson { forces: through(&torques, &nothing)?, torques }))
        .collect::<Result<_>>()?;
    let hyperstatic = output::columns(&mobility.hyperstatic.basis)
        .iter()
        .map(|t| Ok(transmitted_wrenches(&state, chain, t)?.into_iter().map(Into::into).collect()))
        .collect::<Result<_>>()?;
    Ok(StaticsJson {
        head: posed.into(),
        components,
        wrench,
        forces: through(&found.torques, &balanced)?,
        torques: found.torques,
        structural: found.structural,
        unbalanced: found.unbalanced,
        elastic: compliance.is_some(),
        internal,
        hyperstatic,
        zero_torque_basis: output::columns(&mobility.zero_torque.basis),
        stiffness: stiffness::find(posed, args.stiffness.as_ref(), wrench)?,
    })
}

fn print(out: &mut dyn Write, posed: &Posed, report: &StaticsJson<'_>) -> anyhow::Result<()> {
    let mut lines = posed.heading();
    let left = report.unbalanced.iter().any(|x| x.abs() > 0.0);
    if left {
        let text = "a part of the wrench (below): the reference frame gives way to it";
        lines.push(("unbalanced", text.to_owned()));
    }
    output::pairs(out, lines)?;
    writeln!(out)?;
    let mut columns = vec![("[N, N m]", Align::Left)];
    columns.extend(report.components.iter().map(|c| (*c, Align::Right)));
    let row = |name: &str, w: &[f64]| {
        let cells = w.iter().map(|x| output::entries(&[*x]));
        std::iter::once(name.to_owned()).chain(cells).collect::<Vec<_>>()
    };
    let mut rows = vec![
        row("wrench on the frame", report.wrench),
        row("structural", &report.structural),
        row("unbalanced", &report.unbalanced),
    ];
    rows.extend(report.zero_torque_basis.iter().map(|w| row("zero-torque wrench (basis)", w)));
    output::table(out, &columns, rows)?;
    writeln!(out)?;
    let mut columns = vec![("actuated joint", Align::Left), ("torque [N m or N]", Align::Right)];
    let names: Vec<String> = (1..=report.internal.len()).map(|i| format!("internal {i}")).collect();
    columns.extend(names.iter().map(|n| (n.as_str(), Align::Right)));
    let joints = posed.chain.actuated.iter().enumerate().map(|(i, name)| {
        let mut cells = vec![name.clone(), output::entries(&[report.torques[i]])];
        cells.extend(report.internal.iter().map(|h| output::entries(&[h.torques[i]])));
        cells
    });
    output::table(out, &columns, joints)?;
    if !report.forces.is_empty() {
        let title = if report.elastic { "elastic forces" } else { "least forces" };
        transmitted_wrench::forces(out, title, &report.forces)?;
    }
    let shown = report.internal.iter().filter(|h| !h.forces.is_empty());
    for (i, internal) in shown.enumerate() {
        transmitted_wrench::forces(out, &format!("with internal {}", i + 1), &internal.forces)?;
    }
    for (i, undetermined) in report.hyperstatic.iter().enumerate() {
        transmitted_wrench::forces(out, &format!("undetermined {}", i + 1), undetermined)?;
    }
    if let Some(found) = &report.stiffness {
        stiffness::print(out, posed, report.components, found)?;
    }
    Ok(())
}
