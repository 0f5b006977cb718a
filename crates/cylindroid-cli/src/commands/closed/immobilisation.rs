//! The part of `grasp` on fixed fingers without friction: mobility to first and to second order.

use std::io::Write;

use cylindroid::closure::{FingerContact, GraspMobility};
use cylindroid::model::SurfaceCurvature;
use serde::Serialize;

use crate::output::{self, Align, number};

#[derive(Debug, Serialize)]
pub(super) struct ImmobilisationJson<'a> {
    verdict: &'static str,
    /// Null if undecided.
    immobile: Option<bool>,
    reason: &'static str,
    first_order_mobility: usize,
    /// Null without equilibrium.
    second_order_mobility: Option<usize>,
    equilibria: Vec<Vec<f64>>,
    forces: &'a [f64],
    free_motions: Vec<Vec<f64>>,
    /// [1/m].
    curvatures: &'a [f64],
    escape: Option<EscapeJson<'a>>,
    ambiguous: bool,
}

#[derive(Debug, Serialize)]
struct EscapeJson<'a> {
    velocity: &'a [f64],
    acceleration: &'a [f64],
}

impl<'a> ImmobilisationJson<'a> {
    pub(super) fn of(found: &'a GraspMobility) -> Self {
        Self {
            verdict: found.immobilisation.name(),
            immobile: found.immobilisation.is_immobile(),
            reason: found.immobilisation.explanation(),
            first_order_mobility: found.first_order_mobility,
            second_order_mobility: found.second_order_mobility,
            equilibria: output::columns(&found.equilibria),
            forces: &found.forces,
            free_motions: output::columns(&found.free_motions),
            curvatures: &found.curvatures,
            escape: found.escape.as_ref().map(|escape| EscapeJson {
                velocity: &escape.velocity,
                acceleration: &escape.acceleration,
            }),
            ambiguous: found.ambiguous,
        }
    }

    /// Names and values for the head of the table.
    pub(super) fn pairs(&self) -> Vec<(&'static str, String)> {
        let second = self.second_order_mobility.map_or_else(|| "-".to_owned(), |m| m.to_string());
        let mut pairs = vec![
            ("without friction", format!("{}: {}", self.verdict, self.reason)),
            (
                "mobility",
                format!("{} to first order, {second} to second", self.first_order_mobility),
            ),
        ];
        if self.ambiguous {
            let warning = "the rank of the contact normals is ambiguous: give the geometry with \
                           more digits";
            pairs.push(("warning", warning.to_owned()));
        }
        pairs
    }

    /// The free motions, with the eigenvalue of each.
    pub(super) fn print(
        &self,
        out: &mut dyn Write,
        components: &[&'static str],
    ) -> anyhow::Result<()> {
        if self.curvatures.is_empty() {
            return Ok(());
        }
        let mut columns = vec![("free motion", Align::Left)];
        columns.extend(components.iter().map(|c| (*c, Align::Right)));
        columns.push(("curvature [1/m]", Align::Right));
        let rows = self.free_motions.iter().zip(self.curvatures).enumerate().map(
            |(i, (motion, curvature))| {
                let mut row = vec![(i + 1).to_string()];
                row.extend(motion.iter().map(|x| output::entries(&[*x])));
                row.push(output::entries(&[*curvature]));
                row
            },
        );
        output::table(out, &columns, rows)?;
        writeln!(out)?;
        Ok(())
    }
}

#[derive(Debug, Serialize)]
pub(super) struct CurvatureJson {
    finger: SurfaceJson,
    object: SurfaceJson,
}

#[derive(Debug, Serialize)]
struct SurfaceJson {
    /// [1/m]; null for a sharp point or edge.
    principal: [f64; 2],
    /// Of the first one, world.
    direction: [f64; 3],
}

impl CurvatureJson {
    pub(super) fn of(finger: &FingerContact) -> Self {
        let of = |surface: SurfaceCurvature| SurfaceJson {
            principal: surface.principal,
            direction: surface.direction.to_array(),
        };
        Self { finger: of(finger.curvature.finger), object: of(finger.curvature.object) }
    }

    /// Of finger and object, for the table.
    pub(super) fn cells(&self) -> [String; 2] {
        [&self.finger, &self.object].map(|surface| {
            let one = |k: f64| if k.is_infinite() { "sharp".to_owned() } else { number(k) };
            match surface.principal {
                [first, second] if first == second => one(first),
                both => both.map(one).join(", "),
            }
        })
    }
}
