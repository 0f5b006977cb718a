//! Stiffness, compliance and deflection, as a part of `statics`.

use std::collections::BTreeSet;
use std::io::Write;

use cylindroid::manipulability::{Deflection, Stiffness};
use cylindroid::screws::Eigenscrew;
use cylindroid::{Error, Matrix, Result};
use serde::Serialize;

use super::Posed;
use super::transmitted_wrench::TransmittedWrenchJson;
use crate::output::{self, Align, number};
use crate::values::ByName;

#[derive(Debug, Serialize)]
pub(super) struct StiffnessJson {
    /// Wrench for a small displacement at the frame's origin, world axes; null where rigid.
    matrix: Option<Vec<Vec<f64>>>,
    /// Its inverse; null where a motion is free.
    compliance: Option<Vec<Vec<f64>>>,
    /// Lower triangular, of the stiffness.
    cholesky: Option<Vec<Vec<f64>>>,
    /// Of the stiffness in the screw inner product; null in the plane.
    eigenscrews: Option<Vec<EigenscrewJson>>,
    /// Twists without deflection.
    free: Vec<Vec<f64>>,
    /// Wrenches without deflection.
    rigid: Vec<Vec<f64>>,
    /// Forces that neither equilibrium nor elasticity determines.
    undetermined: usize,
    /// Of the frame under the wrench: a small displacement [m, rad].
    deflection: Vec<f64>,
    /// The part of the wrench that free motions give way to.
    unbalanced: Vec<f64>,
    parts: Vec<PartJson>,
    /// Of the actuated joints.
    torques: Vec<f64>,
    forces: Vec<TransmittedWrenchJson>,
    /// Elastic energy [J].
    energy: f64,
}

#[derive(Debug, Serialize)]
struct EigenscrewJson {
    /// The force along the screw for a rotation by 1 rad about it [N/rad].
    eigenvalue: f64,
    point: [f64; 3],
    direction: [f64; 3],
    /// [m/rad]
    pitch: f64,
}

#[derive(Debug, Serialize)]
struct PartJson {
    name: String,
    deflection: Vec<f64>,
}

/// What the file and the command line make elastic; none if nothing is.
pub(super) fn find(
    posed: &Posed,
    given: Option<&ByName>,
    wrench: &[f64],
) -> Result<Option<StiffnessJson>> {
    let mechanism = &posed.mechanism;
    let mut elasticity = mechanism.elasticity().clone();
    if let Some(given) = given {
        let chain = &posed.chain;
        let known: Vec<&str> = [&chain.actuated, &chain.passive]
            .into_iter()
            .flatten()
            .map(String::as_str)
            .chain(mechanism.joints().iter().map(|j| j.name.as_str()))
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect();
        given.check("joint", &known)?;
        given.numbers().try_for_each(|k| Error::check_positive("--stiffness", k))?;
        if chain.actuated.is_empty() && given.named().next().is_none() {
            return Err(Error::InvalidOption {
                option: "--stiffness",
                value: "one number".to_owned(),
                reason: "it is that of the actuated joints, and there are none; name the joints, \
                         as in --stiffness hinge=100"
                    .to_owned(),
            });
        }
        for name in &chain.actuated {
            if let Some(k) = given.of(name) {
                elasticity.stiffness(name, k);
            }
        }
        for (name, k) in given.named().filter(|(n, _)| !chain.actuated.iter().any(|a| a == n)) {
            elasticity.stiffness(name, *k);
        }
    }
    if elasticity.elements.is_empty() {
        return Ok(None);
    }
    let chain = &posed.chain;
    let length = Some(chain.constraint.length());
    let found = Stiffness::of(&posed.state()?, Some(chain.reference), length, &elasticity)?;
    let bent = found.deflection(wrench)?;
    Ok(Some(describe(&found, bent)))
}

fn describe(found: &Stiffness, bent: Deflection) -> StiffnessJson {
    let rows = |m: &Option<Matrix>| m.as_ref().map(Matrix::to_rows);
    StiffnessJson {
        matrix: rows(&found.stiffness),
        compliance: rows(&found.compliance),
        cholesky: rows(&found.cholesky()),
        eigenscrews: found.eigenscrews().map(|all| {
            let one = |e: &Eigenscrew| {
                let screw = e.screw()?;
                Some(EigenscrewJson {
                    eigenvalue: e.eigenvalue,
                    point: screw.axis.point.to_array(),
                    direction: screw.axis.direction.to_array(),
                    pitch: screw.pitch,
                })
            };
            all.screws.iter().filter_map(one).collect()
        }),
        free: output::columns(&found.free),
        rigid: output::columns(&found.rigid),
        undetermined: found.undetermined,
        deflection: bent.twist,
        unbalanced: bent.unbalanced,
        parts: bent
            .parts
            .into_iter()
            .map(|p| PartJson { name: p.name, deflection: p.deflection })
            .collect(),
        torques: bent.torques,
        forces: bent.forces.into_iter().map(Into::into).collect(),
        energy: bent.energy,
    }
}

pub(super) fn print(
    out: &mut dyn Write,
    posed: &Posed,
    components: &[&str],
    report: &StiffnessJson,
) -> anyhow::Result<()> {
    writeln!(out)?;
    match &report.matrix {
        Some(matrix) => square(out, "stiffness [N, N m per m, rad]", components, matrix)?,
        None => writeln!(out, "stiffness: none, some wrenches deflect nothing")?,
    }
    writeln!(out)?;
    match &report.compliance {
        Some(matrix) => square(out, "compliance [m, rad per N, N m]", components, matrix)?,
        None => writeln!(out, "compliance: none, some motions meet no resistance")?,
    }
    if let Some(screws) = &report.eigenscrews {
        writeln!(out)?;
        let columns = [
            ("eigenscrew [N/rad]", Align::Right),
            ("pitch [m/rad]", Align::Right),
            ("direction", Align::Left),
            ("through", Align::Left),
        ];
        let rows = screws.iter().map(|s| {
            vec![
                number(s.eigenvalue),
                number(s.pitch),
                output::entries(&s.direction),
                output::entries(&s.point),
            ]
        });
        output::table(out, &columns, rows)?;
    }
    writeln!(out)?;
    let mut columns = vec![("deflection [m, rad]", Align::Left)];
    columns.extend(components.iter().map(|c| (*c, Align::Right)));
    let row = |name: &str, values: &[f64]| {
        let cells = values.iter().map(|x| output::entries(&[*x]));
        std::iter::once(name.to_owned()).chain(cells).collect::<Vec<_>>()
    };
    output::table(out, &columns, vec![row("of the frame", &report.deflection)])?;
    for (title, basis) in [
        ("wrenches that deflect nothing (basis) [N, N m]", &report.rigid),
        ("motions without resistance (basis) [m, rad]", &report.free),
    ] {
        if basis.is_empty() {
            continue;
        }
        writeln!(out)?;
        columns[0].0 = title;
        let rows = basis.iter().enumerate().map(|(i, x)| row(&(i + 1).to_string(), x));
        output::table(out, &columns, rows)?;
    }
    writeln!(out)?;
    let rows = report.parts.iter().map(|p| vec![p.name.clone(), output::entries(&p.deflection)]);
    let columns = [("elastic part", Align::Left), ("deflection [m, rad]", Align::Left)];
    output::table(out, &columns, rows)?;
    writeln!(out)?;
    let torques = posed.chain.actuated.iter().zip(&report.torques);
    let rows = torques.map(|(name, t)| vec![name.clone(), output::entries(&[*t])]);
    let columns = [("with elasticity", Align::Left), ("torque [N m or N]", Align::Right)];
    output::table(out, &columns, rows)?;
    if !report.forces.is_empty() {
        let title = match report.undetermined {
            0 => "forces with elasticity".to_owned(),
            n => format!("forces with elasticity ({n} undetermined)"),
        };
        super::transmitted_wrench::forces(out, &title, &report.forces)?;
    }
    Ok(())
}

fn square(
    out: &mut dyn Write,
    name: &str,
    components: &[&str],
    matrix: &[Vec<f64>],
) -> anyhow::Result<()> {
    let mut columns = vec![(name, Align::Left)];
    columns.extend(components.iter().map(|c| (*c, Align::Right)));
    /// Entries below this times the roots of their diagonals are rounding.
    const DUST: f64 = 1e-12;
    let rows = components.iter().enumerate().map(|(i, c)| {
        let cell = |j: usize| {
            let (x, size) = (matrix[i][j], matrix[i][i] * matrix[j][j]);
            output::entries(&[if x * x <= DUST * DUST * size { 0.0 } else { x }])
        };
        std::iter::once((*c).to_owned()).chain((0..matrix.len()).map(cell)).collect()
    });
    Ok(output::table(out, &columns, rows)?)
}
