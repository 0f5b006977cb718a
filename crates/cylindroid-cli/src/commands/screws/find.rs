//! What `screws` computes.

use cylindroid::inverse::{HyperbolicOptions, PointDirection, point_direction};
use cylindroid::screws::{Involution, Line, Screw, ScrewOptions, ScrewSystem, involution};
use cylindroid::{Result, Vec3};

use super::hyperbolic::{Asked, AtPitch};
use super::joint_metric;
use super::twists::Twists;
use crate::args::ScrewsArgs;

/// The twists and the results.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) twists: Twists,
    pub(super) system: ScrewSystem,
    pub(super) screws: Vec<Option<Screw>>,
    /// Involution of the joint axes of zero pitch, if there are at least two.
    pub(super) involution: Option<Involution>,
    /// The joint velocities that move the point along the direction, if both are given.
    pub(super) point: Option<PointDirection>,
    /// At the pitches of --h.
    pub(super) pitches: Vec<AtPitch>,
    /// With --twist.
    pub(super) asked: Option<Asked>,
}

pub(super) fn find(twists: Twists, args: &ScrewsArgs) -> Result<Found> {
    let options = ScrewOptions {
        length: args.length.unwrap_or(twists.length),
        center: args.center.map(|c| Vec3::from_array(c.0)),
        noise: args.noise.unwrap_or(ScrewOptions::default().noise),
    };
    let system = ScrewSystem::of(&twists.twists, &options)?;
    let screws: Vec<Option<Screw>> = twists.twists.iter().map(|t| Screw::of(*t)).collect();
    let lines = lines(&screws, &system);
    // The twists of a closed chain are a basis: their axes are not those of joints.
    let single = lines.len() < 2 || twists.is_of_loops();
    let involution = if single { None } else { Some(involution(&lines, &options)?) };
    let point = match (args.point, args.direction) {
        (Some(point), Some(direction)) => Some(point_direction(
            &twists.matrix(),
            Vec3::from_array(point.0),
            Vec3::from_array(direction.0),
        )?),
        _ => None,
    };
    let asked = args.twist.map(|t| Asked::of(&system, Twists::in_order(args, t.0))).transpose()?;
    let matrix = twists.matrix();
    let twist = asked.as_ref().map(|a| a.twist);
    let metric = args.joint_metric.as_ref().map(|w| joint_metric::of(&twists, w)).transpose()?;
    let at = |h: &f64| {
        let options = HyperbolicOptions {
            scale: options,
            joint_metric: metric.clone(),
            ..HyperbolicOptions::default()
        };
        AtPitch::find(&matrix, (&system, &options), *h, twist)
    };
    let pitches = args.h.iter().map(at).collect::<Result<_>>()?;
    Ok(Found { twists, system, screws, involution, point, pitches, asked })
}

/// The axes of the screws of pitch zero, to the tolerance of the system.
fn lines(screws: &[Option<Screw>], system: &ScrewSystem) -> Vec<Line> {
    let is_line = |s: &&Screw| s.pitch.abs() <= system.tolerance() * system.length();
    screws.iter().flatten().filter(is_line).map(|s| s.axis).collect()
}
