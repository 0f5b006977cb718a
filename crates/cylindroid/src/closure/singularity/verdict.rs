//! The verdict on a configuration: mobility and singularities, from which every sentence is
//! derived.
//!
//! Formula  configuration space regular <=> finite dof = first-order dof <=> one branch, whose
//!          tangent space is all of the first-order motions. Types I and II and passive: counts
//!          here against those of the branches. Type II everywhere (architecture singularity):
//!          rank of the actuated motions below min(p, q_a) on the branch, with p motions of
//!          actuated joints and object and q_a actuated joints: i' > max(0, p - q_a)
//! Valid    closed configurations; where the loops are open nothing is claimed. Without a branch
//!          only the configuration space is singular: there is nothing to compare counts with
//! Why so   one value leaves no room for contradictions between the sentences on mobility, on
//!          singularities and on distances
//! Source   Gosselin & Angeles 1990; Zlatanov et al. 1995; Ma & Angeles 1991 (architecture
//!          singularities)
//! Checked  tests/it/closure/verdict.rs, tests/it/linkages/published.rs

use std::fmt;

use super::generic_mobility::GenericMobility;
use super::singularity_types::Excess;
use super::zlatanov::ZlatanovType;
use crate::closure::mobility::counts::MobilityCounts;
use crate::closure::mobility::finite_mobility::{FiniteMobility, MobilityEvidence};
use crate::closure::mobility::second_order::SecondOrderRigidity;
use crate::closure::singularity_kind::SingularityKind;

/// The closed configurations around one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LocalStructure {
    /// The loops are open, or nothing could be decided.
    Unknown,
    /// An isolated configuration without first-order motions: a structure.
    Rigid,
    /// One branch, of the dimension of the first-order motions.
    Regular,
    /// Several branches meet.
    Bifurcation,
    /// One branch, a cone with its apex here.
    Cone,
    /// One branch, and first-order motions that do not lie on it.
    Shaky,
    /// An isolated configuration with first-order motions.
    ShakyRigid,
}

impl LocalStructure {
    fn of(finite: &FiniteMobility) -> Self {
        let Some(dof) = finite.finite else { return Self::Unknown };
        let cone = finite.branches.iter().any(|b| b.motions.cols() > b.dimension);
        match (finite.infinitesimal, dof, finite.branches.len()) {
            (0, ..) => Self::Rigid,
            (k, dof, _) if dof == k => Self::Regular,
            (_, _, 0) => Self::ShakyRigid,
            (_, _, 1) if cone => Self::Cone,
            (_, _, 1) => Self::Shaky,
            _ => Self::Bifurcation,
        }
    }

    /// True if the configuration space is singular here: it is no manifold of the dimension of the
    /// first-order motions.
    #[must_use]
    pub const fn is_singular(self) -> bool {
        matches!(self, Self::Bifurcation | Self::Cone | Self::Shaky | Self::ShakyRigid)
    }

    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Rigid => "rigid",
            Self::Regular => "regular",
            Self::Bifurcation => "bifurcation",
            Self::Cone => "cone",
            Self::Shaky => "shaky",
            Self::ShakyRigid => "shaky-rigid",
        }
    }
}

/// The verdict on a configuration: its mobility, and the kinds of its singularity.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    closed: bool,
    dof: usize,
    finite_dof: Option<usize>,
    branches: usize,
    structure: LocalStructure,
    evidence: MobilityEvidence,
    certain: bool,
    tracked: f64,
    contact_order: Option<u32>,
    second_order: Option<SecondOrderRigidity>,
    excess: Excess,
    everywhere: Vec<SingularityKind>,
    zlatanov: Vec<ZlatanovType>,
}

impl Verdict {
    /// From the counts of a configuration, its finite mobility, and the counts of its branches;
    /// `sizes`: number of actuated joints, and of all columns of the constraint.
    pub(crate) fn of(
        now: &MobilityCounts,
        finite: &FiniteMobility,
        generic: &GenericMobility,
        sizes: [usize; 2],
    ) -> Self {
        let structure = LocalStructure::of(finite);
        let free = |counts: &MobilityCounts| sizes[1].saturating_sub(counts.rank);
        let all = |is: &dyn Fn(&MobilityCounts, usize) -> bool| {
            !generic.branches.is_empty()
                && generic.branches.iter().zip(&finite.branches).all(|(c, b)| is(c, b.dimension))
        };
        let unactuated = all(&|c, _| c.lack_actuation(sizes));
        let folded = structure.is_singular() && all(&|c, dimension| free(c) > dimension);
        let mut excess = Excess::of(now, &generic.counts, unactuated);
        excess.folds = structure.is_singular();
        let everywhere =
            [(unactuated, SingularityKind::TypeII), (folded, SingularityKind::ConfigurationSpace)];
        let zlatanov = match structure {
            LocalStructure::Unknown => Vec::new(),
            LocalStructure::ShakyRigid => vec![ZlatanovType::IncreasedInstantaneousMobility],
            _ => ZlatanovType::of(now, generic, unactuated, sizes),
        };
        Self {
            zlatanov,
            closed: finite.closed,
            dof: finite.infinitesimal,
            finite_dof: finite.finite,
            branches: finite.branches.len(),
            structure,
            evidence: finite.evidence,
            certain: finite.certain,
            tracked: finite.tracked,
            contact_order: finite.contact_order,
            second_order: finite.second_order.as_ref().map(|s| s.rigidity),
            excess,
            everywhere: everywhere.into_iter().filter(|e| e.0).map(|e| e.1).collect(),
        }
    }

    pub(crate) fn excess(&self) -> Excess {
        self.excess
    }

    /// First-order degrees of freedom.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// Degrees of freedom of finite motion; `None` if unknown.
    #[must_use]
    pub fn finite_dof(&self) -> Option<usize> {
        self.finite_dof
    }

    /// The closed configurations around this one.
    #[must_use]
    pub fn structure(&self) -> LocalStructure {
        self.structure
    }

    /// False if branches may have been missed.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.certain
    }

    /// The kinds of its singularity, in the order of [`SingularityKind`]; none for a regular
    /// configuration.
    #[must_use]
    pub fn kinds(&self) -> Vec<SingularityKind> {
        self.excess.kinds()
    }

    /// The kinds of singularity that all configurations of its branch have.
    #[must_use]
    pub fn everywhere(&self) -> &[SingularityKind] {
        &self.everywhere
    }

    /// Zlatanov's types of its singularity; none for a regular configuration. Of a structure that
    /// moves to first order only IIM is decided, where the loops are open nothing.
    #[must_use]
    pub fn zlatanov(&self) -> &[ZlatanovType] {
        &self.zlatanov
    }

    /// True if nothing is singular here, and this is known.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        self.structure != LocalStructure::Unknown && self.kinds().is_empty()
    }

    /// The finite motion, in a sentence without a full stop.
    #[must_use]
    pub fn motion(&self) -> String {
        let (dof, k) = (self.finite_dof.unwrap_or(0), self.dof);
        let unsure = if self.certain { "" } else { "; branches may have been missed" };
        match self.structure {
            LocalStructure::Unknown if !self.closed => {
                "unknown: the loops are open; close them first (`assemble`)".to_owned()
            }
            LocalStructure::Unknown => "unknown: no step converged".to_owned(),
            LocalStructure::Rigid => "none: it is a structure".to_owned(),
            LocalStructure::Regular if self.evidence == MobilityEvidence::Independent => {
                format!("{dof}: all of it, the loop equations are independent")
            }
            LocalStructure::Regular => format!(
                "{dof}: all of it; some loop equations are dependent and stay so, tracked over {} \
                 rad or characteristic lengths{unsure}",
                self.tracked
            ),
            LocalStructure::ShakyRigid => {
                let order = match self.contact_order {
                    Some(p) => format!(": the loops open with power {p} of the motion"),
                    None => String::new(),
                };
                let rigidity = match self.second_order {
                    Some(rigidity) => format!(", {rigidity}"),
                    None => String::new(),
                };
                format!("none: it moves to first order only (shaky){rigidity}{order}{unsure}")
            }
            LocalStructure::Shaky => {
                format!("{dof} of {k}: the others exist to first order only (shaky){unsure}")
            }
            LocalStructure::Cone => {
                format!("{dof} of {k}: its directions form a cone at this configuration{unsure}")
            }
            LocalStructure::Bifurcation => format!(
                "{dof} of {k}: {} branches meet at this configuration (a bifurcation){unsure}",
                self.branches
            ),
        }
    }
}

/// The kinds of singularity, or that there is none.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_regular() {
            return f.write_str("none: the configuration is regular");
        }
        let kinds = self.kinds();
        if kinds.is_empty() {
            return f.write_str(if self.closed {
                "not decided: no step from this configuration converged"
            } else {
                "not decided: the loops are open"
            });
        }
        for (i, kind) in kinds.iter().enumerate() {
            let separator = if i == 0 { "" } else { "; " };
            let all = self.everywhere.contains(kind)
                || *kind == SingularityKind::TypeIII
                    && self.everywhere.contains(&SingularityKind::TypeII);
            let all = if all { ", in every configuration of the branch" } else { "" };
            write!(f, "{separator}{kind}{all}")?;
        }
        Ok(())
    }
}
