//! `mobility`: how a mechanism can move, and what holds it.

use std::io::Write;
use std::process::ExitCode;

use cylindroid::closure::{Mobility, Subspace};
use serde::Serialize;

use super::{HeadJson, Posed};
use crate::args::ClosedArgs;
use crate::commands::Style;
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
struct MobilityJson<'a> {
    #[serde(flatten)]
    head: HeadJson<'a>,
    dof: usize,
    /// Of the relation between driven joints and reference frame, as the next four.
    redundancy: usize,
    indeterminacy: usize,
    coordinate: usize,
    internal: usize,
    zero_torque: usize,
    hyperstatic: usize,
    idle: usize,
    grubler: i64,
    /// Smallest singular value kept over the largest dropped; null where nothing was dropped.
    rank_gap: f64,
    /// A row of each basis is a motion: driven, passive, then components of the reference frame.
    dof_basis: Vec<Vec<f64>>,
    idle_basis: Vec<Vec<f64>>,
    /// Torques of the driven joints in balance.
    internal_basis: Vec<Vec<f64>>,
    /// Wrenches (force first) held without torques.
    zero_torque_basis: Vec<Vec<f64>>,
    joints: Vec<JointJson<'a>>,
    /// Counts that hang on little, in words.
    doubts: Vec<String>,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    moves: bool,
    /// Largest share in a motion of unit length [-].
    share: f64,
    /// Can move with all driven joints at rest.
    free: bool,
    /// Can move with the driven joints and the reference frame at rest.
    idle: bool,
}

pub(crate) fn run(
    args: &ClosedArgs,
    style: Style,
    out: &mut dyn Write,
) -> anyhow::Result<ExitCode> {
    let posed = Posed::new(args)?;
    let mobility = Mobility::of(&posed.chain.constraint);
    match style {
        Style::Json => output::json(out, &describe(&posed, &mobility))?,
        Style::Table => print(out, &posed, &mobility)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn vectors(space: &Subspace) -> Vec<Vec<f64>> {
    (0..space.basis.cols()).map(|j| space.basis.column(j).to_vec()).collect()
}

fn describe<'a>(posed: &'a Posed, m: &Mobility) -> MobilityJson<'a> {
    let chain = &posed.chain;
    let names = chain.actuated.iter().chain(&chain.passive);
    MobilityJson {
        head: posed.into(),
        dof: m.dof.dimension(),
        redundancy: m.relation.redundancy,
        indeterminacy: m.relation.indeterminacy,
        coordinate: m.relation.coordinate,
        internal: m.internal.dimension(),
        zero_torque: m.zero_torque.dimension(),
        hyperstatic: m.hyperstatic.dimension(),
        idle: m.idle.dimension(),
        grubler: m.grubler,
        rank_gap: m.dof.cut.rank.gap,
        dof_basis: vectors(&m.dof),
        idle_basis: vectors(&m.idle),
        internal_basis: vectors(&m.internal),
        zero_torque_basis: vectors(&m.zero_torque),
        joints: names
            .zip(&m.joints)
            .map(|(joint, j)| JointJson {
                joint,
                moves: j.moves,
                share: j.share,
                free: j.free_of_actuators,
                idle: j.idle,
            })
            .collect(),
        doubts: m.doubts.iter().map(ToString::to_string).collect(),
    }
}

fn print(out: &mut dyn Write, posed: &Posed, m: &Mobility) -> anyhow::Result<()> {
    let mut lines = posed.heading();
    let gap = m.dof.cut.rank.gap;
    let gap = if gap.is_infinite() { "clear".to_owned() } else { format!("gap {}", number(gap)) };
    lines.push(("degrees of freedom", format!("{} ({gap})", m.dof.dimension())));
    lines.push(("Grubler's formula", grubler(m)));
    output::pairs(out, lines)?;
    writeln!(out)?;
    let r = &m.relation;
    let rows: [(&str, usize, &str); 7] = [
        ("coordinate", r.coordinate, "motions of the reference frame that the driven joints set"),
        (
            "redundancy",
            r.redundancy,
            "motions of driven joints that leave the reference frame at rest",
        ),
        (
            "indeterminacy",
            r.indeterminacy,
            "motions of the reference frame with driven joints at rest",
        ),
        ("idle", m.idle.dimension(), "motions of passive joints alone"),
        ("internal", m.internal.dimension(), "torques of driven joints that balance each other"),
        (
            "zero_torque",
            m.zero_torque.dimension(),
            "wrenches on the reference frame held without torque",
        ),
        (
            "hyperstatic",
            m.hyperstatic.dimension(),
            "forces in loops and contacts that nothing determines",
        ),
    ];
    let columns = [("kind", Align::Left), ("count", Align::Right), ("what it counts", Align::Left)];
    let rows = rows.map(|(name, n, what)| vec![name.to_owned(), n.to_string(), what.to_owned()]);
    output::table(out, &columns, rows)?;
    writeln!(out)?;
    let columns = [
        ("joint", Align::Left),
        ("driven", Align::Left),
        ("moves", Align::Left),
        ("with the drives at rest", Align::Left),
    ];
    let chain = &posed.chain;
    let names = chain.actuated.iter().chain(&chain.passive).enumerate();
    let yes = |b: bool| if b { "yes" } else { "no" }.to_owned();
    let joints = names.zip(&m.joints).map(|((i, name), j)| {
        let rest = match (j.idle, j.free_of_actuators) {
            (true, _) => "spins alone",
            (false, true) => "moves",
            (false, false) => "rests",
        };
        vec![name.clone(), yes(i < chain.actuated.len()), yes(j.moves), rest.to_owned()]
    });
    output::table(out, &columns, joints)?;
    for doubt in &m.doubts {
        writeln!(out, "doubtful: {doubt}")?;
    }
    Ok(())
}

/// The formula, and what the geometry adds to it.
fn grubler(m: &Mobility) -> String {
    let dof = i64::try_from(m.dof.dimension()).unwrap_or(i64::MAX);
    match dof - m.grubler {
        0 => format!("{} (the geometry is ordinary)", m.grubler),
        more => format!("{} (it misses {more}: constraints that say the same)", m.grubler),
    }
}
