//! `mobility`: the motions of a mechanism, and the wrenches that its structure resists.

use std::io::Write;

use cylindroid::closure::{
    Constraint, Diagnosis, JointMobility, Mobility, MobilityCounts, ModeOptions, MotionBlock,
    internal_forces,
};
use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use super::limbs::{LimbJson, Limbs, TransmissionJson};
use super::operation_modes;
use super::singularity::{self, FiniteJson, SingularityJson};
use super::{HeadJson, Posed, list};
use crate::args::MobilityArgs;
use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
struct MobilityJson<'a> {
    #[serde(flatten)]
    head: HeadJson<'a>,
    dof: usize,
    /// Of finite motion; null where the loops are open.
    finite_dof: Option<usize>,
    finite: FiniteJson,
    singularity: SingularityJson,
    /// Of the relation between actuated joints and reference frame, as the next four.
    redundancy: usize,
    indeterminacy: usize,
    coordinate: usize,
    internal: usize,
    zero_torque: usize,
    /// dim ker G: forces of loop joints and contacts without a wrench on the reference frame.
    internal_forces: usize,
    hyperstatic: usize,
    idle: usize,
    gruebler_kutzbach: i64,
    /// Smallest singular value kept over the largest dropped; null where nothing was dropped.
    rank_gap: f64,
    /// A row of each basis is a motion: actuated, passive, then components of the reference frame.
    dof_basis: Vec<Vec<f64>>,
    idle_basis: Vec<Vec<f64>>,
    /// Torques of the actuated joints in balance.
    internal_basis: Vec<Vec<f64>>,
    /// Wrenches (force first) resisted without torques.
    zero_torque_basis: Vec<Vec<f64>>,
    /// The motions by what moves (eqs. 3 to 5 of Bicchi and Prattichizzo).
    blocks: Vec<BlockJson>,
    /// Coordinate motions counted with the frame at rest and with passive joints at rest.
    coordinate_overlap: usize,
    joints: Vec<JointJson<'a>>,
    limbs: Vec<LimbJson>,
    /// Null where the indices are not defined.
    transmission: Option<TransmissionJson>,
    /// Counts that hang on little, in words.
    ambiguous_ranks: Vec<String>,
}

#[derive(Debug, Serialize)]
struct BlockJson {
    name: &'static str,
    /// Of its columns in the paper.
    symbol: &'static str,
    count: usize,
    /// Rows as of `dof_basis`.
    basis: Vec<Vec<f64>>,
}

impl From<MotionBlock<'_>> for BlockJson {
    fn from(block: MotionBlock<'_>) -> Self {
        Self {
            name: block.name,
            symbol: block.symbol,
            count: block.motions.dimension(),
            basis: output::columns(&block.motions.basis),
        }
    }
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    moves: bool,
    /// Largest share in a motion of unit length [-].
    share: f64,
    /// Can move with all actuated joints at rest.
    free: bool,
    /// Can move with the actuated joints and the reference frame at rest.
    idle: bool,
}

pub(crate) fn run(args: &MobilityArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let posed = Posed::new(&args.closed)?;
    if let Some(starts) = args.modes {
        let options = ModeOptions { starts, seed: args.seed };
        return operation_modes::run(&posed, options, style, out);
    }
    let (mobility, diagnosis, limbs) = find(&posed)?;
    match style {
        Style::Json => output::json(out, &describe(&posed, &mobility, &diagnosis, &limbs))?,
        Style::Table => print(out, &posed, &mobility, &diagnosis, &limbs)?,
    }
    Ok(Exit::SUCCESS)
}

/// The object of `--json`.
pub(crate) fn report(posed: &Posed) -> anyhow::Result<Box<RawValue>> {
    let (mobility, diagnosis, limbs) = find(posed)?;
    Ok(to_raw_value(&describe(posed, &mobility, &diagnosis, &limbs))?)
}

fn find(posed: &Posed) -> cylindroid::Result<(Mobility, Diagnosis, Limbs)> {
    let chain = &posed.chain;
    let mobility = Mobility::of(&chain.constraint);
    let length = chain.constraint.length();
    let diagnosis = Diagnosis::of(&posed.state()?, Some(chain.reference), Some(length))?;
    let limbs = Limbs::of(posed, &diagnosis)?;
    Ok((mobility, diagnosis, limbs))
}

fn describe<'a>(
    posed: &'a Posed,
    m: &Mobility,
    found: &Diagnosis,
    limbs: &Limbs,
) -> MobilityJson<'a> {
    let chain = &posed.chain;
    let names = chain.actuated.iter().chain(&chain.passive);
    MobilityJson {
        head: posed.into(),
        dof: m.dof.dimension(),
        finite_dof: found.finite.finite,
        finite: FiniteJson::of(&found.finite, found.verdict.structure(), &found.generic),
        singularity: found.into(),
        redundancy: m.relation.redundancy,
        indeterminacy: m.relation.indeterminacy,
        coordinate: m.relation.coordinate,
        internal: m.internal.dimension(),
        zero_torque: m.zero_torque.dimension(),
        internal_forces: internal_forces(&chain.constraint).dimension(),
        hyperstatic: m.hyperstatic.dimension(),
        idle: m.idle.dimension(),
        gruebler_kutzbach: m.gruebler_kutzbach,
        rank_gap: m.dof.cut.rank.gap,
        dof_basis: output::columns(&m.dof.basis),
        idle_basis: output::columns(&m.idle.basis),
        internal_basis: output::columns(&m.internal.basis),
        zero_torque_basis: output::columns(&m.zero_torque.basis),
        blocks: m.blocks().map(BlockJson::from).into(),
        coordinate_overlap: m.coordinate_kinds.overlap,
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
        limbs: limbs.json(),
        transmission: limbs.transmission(),
        ambiguous_ranks: m.ambiguous_ranks.iter().map(ToString::to_string).collect(),
    }
}

fn print(
    out: &mut dyn Write,
    posed: &Posed,
    m: &Mobility,
    found: &Diagnosis,
    limbs: &Limbs,
) -> anyhow::Result<()> {
    output::pairs(out, posed.heading())?;
    writeln!(out)?;
    let gap = m.dof.cut.rank.gap;
    let gap = if gap.is_infinite() {
        "a clear rank".to_owned()
    } else {
        format!("rank gap {}", number(gap))
    };
    let mut lines = vec![
        ("degrees of freedom", format!("{} to first order ({gap})", m.dof.dimension())),
        ("finite motion", found.verdict.motion()),
        ("Gruebler-Kutzbach", gruebler_kutzbach(m)),
    ];
    lines.extend(singularity::lines(posed, found));
    lines.extend(joints(posed, &m.joints));
    output::pairs(out, lines)?;
    writeln!(out)?;
    counts(out, &posed.chain.constraint, m, &found.generic.counts)?;
    blocks(out, m)?;
    limbs.print(out)?;
    singularity::ways(out, posed, &found.finite)?;
    if !m.ambiguous_ranks.is_empty() {
        writeln!(out)?;
    }
    for warning in &m.ambiguous_ranks {
        writeln!(out, "warning: {warning}")?;
    }
    Ok(())
}

/// What is counted, here and in ordinary configurations.
fn counts(
    out: &mut dyn Write,
    constraint: &Constraint,
    m: &Mobility,
    generic: &MobilityCounts,
) -> anyhow::Result<()> {
    let r = &m.relation;
    let rows: [(&str, usize, Option<usize>, &str); 8] = [
        (
            "coordinate",
            r.coordinate,
            None,
            "motions of the reference frame controlled by the actuated joints",
        ),
        (
            "redundancy",
            r.redundancy,
            Some(generic.redundancy),
            "motions of actuated joints with the reference frame at rest",
        ),
        (
            "indeterminacy",
            r.indeterminacy,
            Some(generic.indeterminacy),
            "motions of the reference frame with actuated joints at rest",
        ),
        ("idle", m.idle.dimension(), Some(generic.idle), "motions of passive joints alone"),
        (
            "internal",
            m.internal.dimension(),
            None,
            "torques of actuated joints in equilibrium, without a wrench on the frame",
        ),
        (
            "internal_forces",
            internal_forces(constraint).dimension(),
            None,
            "forces in loops and contacts without a wrench on the frame (ker G)",
        ),
        (
            "zero_torque",
            m.zero_torque.dimension(),
            Some(generic.zero_torque),
            "wrenches on the reference frame in equilibrium without torque",
        ),
        (
            "hyperstatic",
            m.hyperstatic.dimension(),
            None,
            "undetermined forces in loops and contacts",
        ),
    ];
    let columns = [
        ("kind", Align::Left),
        ("here", Align::Right),
        ("generic", Align::Right),
        ("meaning", Align::Left),
    ];
    let rows = rows.map(|(name, n, generic, what)| {
        let generic = generic.map_or_else(String::new, |n| n.to_string());
        vec![name.to_owned(), n.to_string(), generic, what.to_owned()]
    });
    Ok(output::table(out, &columns, rows)?)
}

/// The motions by what moves.
fn blocks(out: &mut dyn Write, m: &Mobility) -> anyhow::Result<()> {
    writeln!(out)?;
    let columns = [
        ("motions by what moves", Align::Left),
        ("symbol", Align::Left),
        ("count", Align::Right),
        ("moving", Align::Left),
    ];
    let row = |name: &str, symbol: &str, count: usize, meaning: &str| {
        vec![name.to_owned(), symbol.to_owned(), count.to_string(), meaning.to_owned()]
    };
    let mut rows: Vec<_> = m
        .blocks()
        .iter()
        .map(|b| row(b.name, b.symbol, b.motions.dimension(), b.meaning))
        .collect();
    let overlap = m.coordinate_kinds.overlap;
    if overlap > 0 {
        let text = "in coordinate_passive and coordinate_object: counted twice";
        rows.push(row("overlap", "", overlap, text));
    }
    Ok(output::table(out, &columns, rows)?)
}

/// Which joints move, in all motions and with the actuators at rest.
fn joints(posed: &Posed, mobility: &[JointMobility]) -> [(&'static str, String); 4] {
    let chain = &posed.chain;
    let names: Vec<&String> = chain.actuated.iter().chain(&chain.passive).collect();
    let those = |of: &dyn Fn(&JointMobility) -> bool| -> Vec<String> {
        let all = names.iter().zip(mobility);
        all.filter(|(_, j)| of(j)).map(|(name, _)| (*name).clone()).collect()
    };
    let some = |names: Vec<String>| if names.is_empty() { String::new() } else { list(&names) };
    let moving = those(&|j| j.moves);
    let all = moving.len() == names.len();
    let with_drives_at_rest = those(&|j| j.free_of_actuators);
    [
        (
            "joints that move",
            match names.len() {
                0 => "none".to_owned(),
                n if all => format!("all {n}"),
                _ => list(&moving),
            },
        ),
        ("locked by geometry", some(those(&|j| !j.moves))),
        (
            "with actuators at rest",
            if with_drives_at_rest.is_empty() {
                "no joint moves".to_owned()
            } else if with_drives_at_rest.len() == chain.passive.len() {
                format!("all {} passive joints still move", chain.passive.len())
            } else {
                format!("{} still move", list(&with_drives_at_rest))
            },
        ),
        ("idle joints", some(those(&|j| j.idle))),
    ]
}

/// The formula, and what the geometry adds to it.
fn gruebler_kutzbach(m: &Mobility) -> String {
    let dof = i64::try_from(m.dof.dimension()).unwrap_or(i64::MAX);
    match dof - m.gruebler_kutzbach {
        0 => format!("{} (no dependent constraints)", m.gruebler_kutzbach),
        more => {
            format!("{} ({more} dependent constraints are not counted)", m.gruebler_kutzbach)
        }
    }
}
