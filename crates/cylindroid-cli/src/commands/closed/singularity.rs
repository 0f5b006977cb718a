//! What `mobility` says about singular configurations and finite motion.

use std::io::Write;

use cylindroid::closure::{
    Diagnosis, FiniteMobility, GenericMobility, LocalStructure, MobilityCounts, SingularityKind,
};
use cylindroid::model::Dimension;
use cylindroid::screws::Screw;
use serde::Serialize;

use super::{Posed, list};
use crate::output::{self, Align, ScrewJson, number};

#[derive(Debug, Serialize)]
pub(super) struct SingularityJson {
    regular: bool,
    /// In words.
    kinds: Vec<String>,
    /// True if every configuration of the branch is singular, and the kinds that they all have.
    everywhere: bool,
    everywhere_kinds: Vec<String>,
    /// Zlatanov's types: "RI", "RO", "II", "IO", "RPM", "IIM".
    zlatanov: Vec<&'static str>,
    distances: DistancesJson,
    generic: CountsJson,
    /// Other closed configurations that the generic counts come from.
    compared_with: usize,
    /// Wrenches resisted without torque, as screws; those beyond the generic ones.
    blocked: Vec<ScrewJson>,
    /// Motions of the reference frame.
    lost: Vec<ScrewJson>,
    gained: Vec<ScrewJson>,
    /// Actuated joints that move with the reference frame at rest, beyond the generic ones.
    redundant: Vec<String>,
    /// Passive coordinates that move alone, beyond the generic ones.
    idle: Vec<String>,
    /// False where what is generic could not be told from what is not.
    separated: bool,
}

#[derive(Debug, Serialize)]
struct DistancesJson {
    type_i: f64,
    type_ii: f64,
    configuration_space: f64,
    passive: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct CountsJson {
    rank: usize,
    idle: usize,
    redundancy: usize,
    indeterminacy: usize,
    zero_torque: usize,
}

#[derive(Debug, Serialize)]
pub(super) struct FiniteJson {
    evidence: String,
    certain: bool,
    /// "regular", "bifurcation", "cone", "shaky", "shaky-rigid", "rigid" or "unknown".
    structure: &'static str,
    /// Distance to which the motions were tracked [rad, or characteristic lengths].
    tracked: f64,
    /// Power of the distance with which the loops open; null if they do not, or it differs.
    contact_order: Option<u32>,
    /// "prestress stable", "second-order rigid" or "second-order flexible".
    second_order: Option<&'static str>,
    branches: Vec<BranchJson>,
    /// Motions to first order that do not exist: rates of q.
    shaky: Vec<Vec<f64>>,
}

#[derive(Debug, Serialize)]
struct BranchJson {
    dimension: usize,
    tracked: f64,
    /// Its generic counts.
    generic: CountsJson,
    /// Rates of q, a list each.
    motions: Vec<Vec<f64>>,
}

impl From<&Diagnosis> for SingularityJson {
    fn from(d: &Diagnosis) -> Self {
        let at = &d.distances;
        let everywhere = d.verdict.everywhere();
        let screws = |of: &[Screw]| of.iter().map(Into::into).collect();
        Self {
            regular: d.verdict.is_regular(),
            kinds: d.verdict.kinds().iter().map(ToString::to_string).collect(),
            everywhere: !everywhere.is_empty(),
            everywhere_kinds: everywhere.iter().map(ToString::to_string).collect(),
            zlatanov: d.verdict.zlatanov().iter().map(|t| t.name()).collect(),
            distances: DistancesJson {
                type_i: at.type_i,
                type_ii: at.type_ii,
                configuration_space: at.configuration_space,
                passive: at.passive,
            },
            generic: d.generic.counts.into(),
            compared_with: d.generic.others,
            blocked: screws(&d.blocked),
            lost: screws(&d.lost),
            gained: screws(&d.gained),
            redundant: d.redundant.clone(),
            idle: d.idle.clone(),
            separated: d.separated,
        }
    }
}

impl From<MobilityCounts> for CountsJson {
    fn from(counts: MobilityCounts) -> Self {
        let MobilityCounts { rank, idle, redundancy, indeterminacy, zero_torque } = counts;
        Self { rank, idle, redundancy, indeterminacy, zero_torque }
    }
}

impl FiniteJson {
    pub(super) fn of(f: &FiniteMobility, structure: LocalStructure, g: &GenericMobility) -> Self {
        let branch = |(b, counts): (&cylindroid::closure::Branch, &MobilityCounts)| BranchJson {
            dimension: b.dimension,
            tracked: b.tracked,
            generic: (*counts).into(),
            motions: output::columns(&b.motions),
        };
        Self {
            evidence: f.evidence.to_string(),
            certain: f.certain,
            structure: structure.name(),
            tracked: f.tracked,
            contact_order: f.contact_order,
            second_order: f.second_order.as_ref().map(|s| s.rigidity.name()),
            branches: f.branches.iter().zip(&g.branches).map(branch).collect(),
            shaky: output::columns(&f.shaky),
        }
    }
}

/// The verdict, what is lost and gained, and the distances.
pub(super) fn lines(posed: &Posed, d: &Diagnosis) -> Vec<(&'static str, String)> {
    let planar = posed.mechanism.dimension() == Dimension::Planar;
    let branches = d.generic.branches.len();
    let mut lines = vec![
        ("singularity", d.verdict.to_string()),
        ("types of Zlatanov", zlatanov(d)),
        (
            "compared with",
            match (d.generic.others, branches) {
                (0, _) => "no other configuration: none was reached".to_owned(),
                (n, 1) => format!("{n} configurations of its branch, a finite way off"),
                (n, _) => format!("{n} configurations of its {branches} branches"),
            },
        ),
    ];
    let mut named = |name, screws: &[Screw], word: &dyn Fn(&Screw, bool) -> String| {
        let words: Vec<String> = screws.iter().map(|s| word(s, planar)).collect();
        lines.push((name, words.join("; ")));
    };
    named("blocked", &d.blocked, &|s, planar| {
        format!("{} is resisted without torque", wrench_in_words(s, planar))
    });
    named("lost", &d.lost, &motion_in_words);
    named("gained", &d.gained, &motion_in_words);
    let of = |names: &[String]| if names.is_empty() { String::new() } else { list(names) };
    if d.verdict.kinds().contains(&SingularityKind::TypeI) || !d.blocked.is_empty() {
        lines.push(("actuators without effect", of(&d.redundant)));
    }
    lines.push(("idle joints gained", of(&d.idle)));
    if !d.separated {
        lines.push((
            "note",
            "the generic part could not be separated from the excess at this configuration: all is \
             listed"
                .to_owned(),
        ));
    }
    let at = &d.distances;
    let closed = posed.mechanism.is_closed();
    let distances: Vec<String> = [
        ("type I", at.type_i, true),
        ("type II", at.type_ii, closed),
        ("configuration space", at.configuration_space, closed),
        ("passive", at.passive, !posed.chain.passive.is_empty()),
    ]
    .into_iter()
    .filter(|(_, x, told)| x.is_finite() && *told)
    .map(|(name, x, _)| format!("{name} {}", number(x)))
    .collect();
    lines.push(("distances, 0 to 1", distances.join(", ")));
    lines
}

fn zlatanov(d: &Diagnosis) -> String {
    let types: Vec<String> = d.verdict.zlatanov().iter().map(ToString::to_string).collect();
    types.join(", ")
}

fn point(screw: &Screw, planar: bool) -> String {
    let p = screw.axis.point;
    coordinates(&[p.x, p.y, p.z], planar)
}

/// Rounding, and the accuracy of spaces at nearby configurations, shown as zero.
fn coordinates(all: &[f64; 3], planar: bool) -> String {
    let clean = all.map(|x| if x.abs() < 1e-9 { 0.0 } else { x });
    format!("({})", output::entries(if planar { &clean[..2] } else { &clean }))
}

fn direction(screw: &Screw, planar: bool) -> String {
    let d = screw.axis.direction;
    coordinates(&[d.x, d.y, d.z], planar)
}

/// As zero where it is rounding.
fn pitch(screw: &Screw) -> Option<String> {
    let text = output::entries(&[screw.pitch]);
    (text != "0").then_some(text)
}

/// A motion as a screw, in words.
pub(crate) fn motion_in_words(s: &Screw, planar: bool) -> String {
    let along = direction(s, planar);
    if s.is_translation() {
        return format!("a translation along {along}");
    }
    let at = point(s, planar);
    match pitch(s) {
        _ if planar => format!("a rotation about the point {at} m"),
        None => format!("a rotation about the line through {at} m along {along}"),
        Some(pitch) => {
            format!("a screw of pitch {pitch} m/rad about the line through {at} m along {along}")
        }
    }
}

fn wrench_in_words(s: &Screw, planar: bool) -> String {
    let along = direction(s, planar);
    if s.is_translation() {
        return if planar { "a moment".to_owned() } else { format!("a couple about {along}") };
    }
    let at = point(s, planar);
    match pitch(s) {
        None => format!("a force along the line through {at} m, direction {along}"),
        Some(pitch) => {
            format!("a wrench of pitch {pitch} m along the line through {at} m, direction {along}")
        }
    }
}

/// The branches and what is shaky, joint by joint, where first order does not tell all.
pub(super) fn ways(out: &mut dyn Write, posed: &Posed, f: &FiniteMobility) -> anyhow::Result<()> {
    if f.branches.len() < 2 && f.shaky.cols() == 0 {
        return Ok(());
    }
    // The largest rate is one, the first not negative.
    let scaled = |motion: Vec<f64>| -> Vec<f64> {
        let largest = motion.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let first = motion.iter().find(|x| x.abs() > 1e-3 * largest).copied().unwrap_or(1.0);
        motion.iter().map(|x| x / largest.copysign(first)).collect()
    };
    let mut names = Vec::new();
    let mut motions = Vec::new();
    for (i, branch) in f.branches.iter().enumerate() {
        for (j, motion) in output::columns(&branch.motions).into_iter().enumerate() {
            let more =
                if branch.motions.cols() > 1 { format!(".{}", j + 1) } else { String::new() };
            names.push(format!("branch {}{more}", i + 1));
            motions.push(scaled(motion));
        }
    }
    for (i, motion) in output::columns(&f.shaky).into_iter().enumerate() {
        names.push(format!("shaky {}", i + 1));
        motions.push(scaled(motion));
    }
    writeln!(out)?;
    writeln!(out, "Joint velocities of the branches at this configuration, and of shaky motions")?;
    let mut columns = vec![("joint", Align::Left)];
    columns.extend(names.iter().map(|n| (n.as_str(), Align::Right)));
    let rows = posed.mechanism.coordinates().iter().enumerate().map(|(i, c)| {
        let mut row = vec![c.name.clone()];
        row.extend(motions.iter().map(|m| output::entries(&[m[i]])));
        row
    });
    Ok(output::table(out, &columns, rows)?)
}
