//! The search for the bounds of a zone.
//!
//! Checked  tests/map/zone.rs

use super::loci::kind_of;
use super::options::MapOptions;
use super::problem::Problem;
use super::result::LocusKind;
use super::zone::{Zone, ZoneBound, ZoneComponent, ZoneOptions, ZoneShape};
use super::zone_problem::problem_of_joints;
use super::zone_rays::{Directions, RayEnd, Rays, Shot};
use crate::closure::{
    CentredNorm, CurveDomain, CurveTracer, Obstruction, PlatformPath, SignedSingularity, Vanishing,
    assemble,
};
use crate::error::{Error, Result};
use crate::model::{CoordinateKind, Mechanism};
use crate::sweep::Axis;
use crate::tolerance::{MAX_MAGNITUDE, PLATFORM_SINGULAR};

/// Largest number of rays.
const MAX_RAYS: usize = 1 << 20;
/// Bounds that one ray may lead to, each before the last one.
const CHAIN: usize = 6;
/// Number of rays, beside the fixed ones, that also look for what they passed.
const PASSED: usize = 32;
/// The last part of the way to a bound, over which its mode is compared with that of the centre.
const BEFORE: f64 = 1e-3;
/// The last part of the size that rays leave out.
const CONFIRMED: f64 = 1e-6;
/// Largest change of a coordinate over the last part of a way [rad, or characteristic lengths].
const SAME_MODE: f64 = 0.5;
/// Distance to a singularity near a bound, relative to that of the centre.
const NEAR: f64 = 0.1;
/// Relative distance of two descriptions of one bound.
const SAME: f64 = 1e-6;
/// The farthest offset of lengths [characteristic lengths].
const FARTHEST: f64 = 4.0;

fn refuse<T>(option: &'static str, value: impl Into<String>, reason: &str) -> Result<T> {
    Err(Error::InvalidOption { option, value: value.into(), reason: reason.to_owned() })
}

impl Zone {
    /// The zone of a mechanism around a configuration.
    ///
    /// ```
    /// use cylindroid::sweep::{LocusKind, Zone, ZoneOptions};
    ///
    /// // How far the coupler of a five-bar may go, whichever way.
    /// let five_bar = cylindroid::load("five-bar")?;
    /// let components = vec!["x".to_owned(), "y".to_owned()];
    /// let zone = Zone::of(&five_bar, ZoneOptions { components, ..ZoneOptions::default() })?;
    /// assert!(zone.size > 0.1 && zone.bounds[0].distance == zone.size);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// Unknown, repeated or mixed components, scales that are not positive, a centre that cannot be
    /// assembled, that is singular or beyond limits, components that leave a motion free,
    /// singularities that are no surfaces, a number of rays out of range.
    #[doc(alias = "singularity-free")]
    pub fn of(mechanism: &Mechanism, options: ZoneOptions) -> Result<Self> {
        Search::new(mechanism, &options)?.run()
    }
}

/// What obstructs rays, what else is singular, and what moves.
struct Parts {
    /// Of the coordinates that follow the components.
    path: SignedSingularity,
    event: SignedSingularity,
    /// All that is not held, and the generic rank of the loops over it.
    unknown: Vec<usize>,
    rank: usize,
}

impl Parts {
    fn of(problem: &Problem, places: &[usize], of_joints: bool) -> Self {
        if !of_joints {
            return Self {
                path: problem.type_one.clone(),
                event: problem.type_two.clone(),
                unknown: problem.unknown.clone(),
                rank: problem.unknown_rank,
            };
        }
        let coordinates = problem.platform.mechanism.coordinates();
        let all = |keep: &dyn Fn(usize) -> bool| {
            (0..coordinates.len()).filter(|&i| keep(i)).collect::<Vec<_>>()
        };
        let follows = all(&|i| !coordinates[i].actuated);
        let unknown = all(&|i| !coordinates[i].actuated || places.contains(&i));
        let loops = problem.equations.loop_rows();
        Self {
            path: SignedSingularity::new(0..loops, follows, problem.jacobians()),
            event: problem.type_one.clone(),
            rank: problem.loop_rank(&unknown),
            unknown,
        }
    }
}

/// The components, the rays and the loci.
pub(super) struct Search {
    problem: Problem,
    zone: Zone,
    about: CentredNorm,
    rays: Rays,
    directions: Directions,
    /// Of what obstructs, of what else is singular, and of limits.
    obstruction: CurveTracer,
    event: CurveTracer,
    limit: CurveTracer,
    of_joints: bool,
    count: usize,
    /// The farthest offset of each component over its scale.
    farthest: Vec<f64>,
}

impl Search {
    pub(super) fn new(mechanism: &Mechanism, options: &ZoneOptions) -> Result<Self> {
        let ZoneOptions { components, shape, .. } = options;
        check(options)?;
        let unlimited;
        let mechanism = if options.limits {
            mechanism
        } else {
            unlimited = mechanism.without_position_limits();
            &unlimited
        };
        let joints: Vec<&str> = mechanism.coordinates().iter().map(|c| c.name.as_str()).collect();
        let of_joints = components.iter().all(|name| joints.contains(&name.as_str()));
        let axis = |name: &String| Axis { name: name.clone(), from: 0.0, to: 0.0, count: 1 };
        let (own, held): (Vec<_>, Vec<_>) =
            options.held.iter().cloned().partition(|(name, _)| components.contains(name));
        let of_map = MapOptions {
            axes: if of_joints { Vec::new() } else { components.iter().map(axis).collect() },
            held,
            end_effector: options.end_effector,
            start: options.start.clone(),
            ..MapOptions::default()
        };
        let problem = if of_joints {
            problem_of_joints(mechanism, of_map)?
        } else {
            Problem::new(mechanism, &of_map)?
        };
        let coordinates = problem.platform.mechanism.coordinates();
        let places: Vec<usize> = if of_joints {
            components.iter().filter_map(|c| joints.iter().position(|name| name == c)).collect()
        } else {
            problem.axes.clone()
        };
        for &i in &places {
            let name = coordinates[i].name.as_str();
            if of_joints && !coordinates[i].actuated {
                return refuse("components", name, "this joint is not actuated, so it follows");
            }
            if coordinates[i].kind == CoordinateKind::RotationVector {
                let reason = "the components of a rotation vector do not move alone";
                return refuse("components", name, reason);
            }
        }
        let centre = centre(&problem, (&places, components), &own, of_joints)?;
        let parts = Parts::of(&problem, &places, of_joints);
        check_parts(&problem, &parts, of_joints)?;
        let is_length = |i: &usize| coordinates[*i].kind.is_length();
        let mixed = places.iter().any(is_length) && !places.iter().all(is_length);
        let length = mechanism.reach();
        let scale = |i: &usize| if mixed && is_length(i) { length } else { 1.0 };
        let scales = match options.scales.as_slice() {
            [] => places.iter().map(scale).collect(),
            given => given.to_vec(),
        };
        let cap = |i: &usize| {
            if is_length(i) { FARTHEST * length } else { std::f64::consts::PI }
        };
        let farthest = places.iter().zip(&scales).map(|(i, scale)| cap(i) / scale).collect();
        let about = CentredNorm {
            centre: places.iter().map(|&i| centre[i]).collect(),
            places: places.clone(),
            scales,
            largest: *shape == ZoneShape::Box,
        };
        let component = |((name, i), scale): ((&String, &usize), &f64)| ZoneComponent {
            name: name.clone(),
            unit: if is_length(i) { "m" } else { "rad" },
            centre: centre[*i],
            scale: *scale,
        };
        let named = |(i, value): &(usize, f64)| {
            let name = problem.components.iter().find(|(_, place)| place == i);
            name.map(|(name, _)| ((*name).to_owned(), *value))
        };
        let zone = Zone {
            components: components.iter().zip(&places).zip(&about.scales).map(component).collect(),
            shape: *shape,
            held: if of_joints {
                Vec::new()
            } else {
                problem.held.iter().filter_map(named).collect()
            },
            size: 0.0,
            bounds: Vec::new(),
            confirmed: 0,
            certified: 0,
            q: centre[..problem.platform.n()].to_vec(),
        };
        let tracer = |vanishing| {
            let domain = CurveDomain { bounds: Vec::new(), side: None };
            let unknown = (parts.unknown.clone(), parts.rank);
            CurveTracer::new(problem.equations.clone(), vanishing, domain, unknown)
        };
        let path = PlatformPath::new(problem.equations.clone(), places, parts.path.clone());
        let rays = Rays::new(path, parts.event.clone(), (&centre, problem.platform.n()))?;
        let [following, other] = rays.distances();
        if following < PLATFORM_SINGULAR || other < PLATFORM_SINGULAR {
            let value = format!("{:?}", zone.q);
            return refuse("start", value, "the centre is singular, so there is no zone around it");
        }
        Ok(Self {
            rays,
            directions: Directions::new(components.len(), about.largest, options.seed),
            obstruction: tracer(Vanishing::Singularity(parts.path)),
            event: tracer(Vanishing::Singularity(parts.event)),
            limit: tracer(Vanishing::Limit { coordinate: 0, value: 0.0 }),
            // Of one component the two ways, which are fixed, are all rays there are.
            count: if components.len() == 1 { 0 } else { options.rays },
            problem,
            zone,
            about,
            of_joints,
            farthest,
        })
    }

    pub(super) fn run(mut self) -> Result<Zone> {
        let along = |direction: &[f64], farthest: &[f64]| {
            let shares = direction.iter().zip(farthest).map(|(d, most)| most / d.abs());
            shares.fold(f64::INFINITY, f64::min)
        };
        let mut size = self.farthest.iter().copied().fold(f64::INFINITY, f64::min);
        let fixed = self.directions.fixed();
        let mut shots = Vec::with_capacity(fixed + self.count);
        for number in 0..fixed + self.count {
            let direction = self.directions.get(number);
            // Those along the components see the other bounds too.
            let length = if number < fixed {
                along(&direction, &self.farthest)
            } else {
                size * (1.0 - CONFIRMED)
            };
            let mut shot = self.rays.shoot(&self.about, &direction, length)?;
            if number >= fixed + PASSED {
                shot.passed = [None, None];
            }
            shots.push((shot.reached, shot.certified));
            self.follow(shot)?;
            let nearest = self.zone.bounds.iter().map(|b| b.distance);
            size = nearest.fold(size, f64::min);
        }
        let passed = |shot: &&(f64, bool)| shot.0 >= size * (1.0 - 2.0 * CONFIRMED);
        self.zone.size = size;
        self.zone.confirmed = shots.iter().filter(passed).count();
        self.zone.certified = shots.iter().filter(passed).filter(|shot| shot.1).count();
        self.zone.bounds.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok(self.zone)
    }

    /// The bounds that the end of a ray leads to.
    fn follow(&mut self, shot: Shot) -> Result<()> {
        let mut shots = vec![shot];
        // Of the singularity that the last ray led to, if it ended before it.
        let mut short_of = None;
        for _ in 0..CHAIN {
            let Some(shot) = shots.pop() else { break };
            let [first, second] = match self.of_joints {
                false => [LocusKind::TypeOne, LocusKind::TypeTwo],
                true => [LocusKind::TypeTwo, LocusKind::TypeOne],
            };
            let coordinates = self.problem.platform.mechanism.coordinates();
            let mut limit = None;
            // What vanishes, and the place of its distance in a shot.
            let (tracer, kind, place, seed) = match (shot.end, &shot.passed) {
                (RayEnd::Whole, [Some(q), event]) => {
                    if event.is_some() {
                        let passed = [None, event.clone()];
                        shots.push(Shot { passed, ..shot.clone() });
                    }
                    (&mut self.obstruction, first, 0, q)
                }
                (RayEnd::Whole, [None, Some(q)]) => (&mut self.event, second, 1, q),
                (RayEnd::Whole, [None, None]) => continue,
                (RayEnd::Obstructed(Obstruction::Singular), _) => {
                    (&mut self.obstruction, first, 0, &shot.q)
                }
                (RayEnd::Event, _) => (&mut self.event, second, 1, &shot.q),
                (RayEnd::Obstructed(Obstruction::Limit(i)), _) => {
                    let (l, x) = (&coordinates[i].limits, shot.q[i]);
                    let value =
                        if (x - l.lower).abs() < (x - l.upper).abs() { l.lower } else { l.upper };
                    self.limit.set_vanishing(Vanishing::Limit { coordinate: i, value });
                    limit = Some(coordinates[i].name.clone());
                    (&mut self.limit, LocusKind::Limit, 2, &shot.q)
                }
            };
            let found = tracer.nearest(seed, &self.about)?;
            let kind = match (kind, &found) {
                (LocusKind::Limit, _) | (_, None) => kind,
                (kind, Some((q, _))) => kind_of(&self.problem, kind, &tracer.motion(q)?),
            };
            if let Some((q, distance)) = found {
                let before = self.before(&q, distance)?;
                let is_short = self.is_short_of(&before, &q, place);
                let again = short_of.is_some_and(|d: f64| (d - distance).abs() <= SAME * distance);
                if is_short && again || self.is_of_mode(&before, &q, place)? {
                    self.add(q, distance, (kind, limit));
                    continue;
                }
                short_of = is_short.then_some(distance);
                shots.push(before);
                if is_short {
                    continue;
                }
            }
            // Without the nearest point, the end of the ray itself is a bound.
            if shot.end != RayEnd::Whole {
                self.add(shot.q, shot.reached, (kind, limit));
            }
        }
        Ok(())
    }

    /// The ray to a bound, up to its last part.
    fn before(&mut self, q: &[f64], distance: f64) -> Result<Shot> {
        let offset = self.about.offset(q);
        let direction: Vec<f64> = offset.iter().map(|x| x / distance).collect();
        self.rays.shoot(&self.about, &direction, distance * (1.0 - BEFORE))
    }

    /// True if the ray to a singularity ended in its neighbourhood, before the last part: where
    /// coordinates change fast, or the centre is nearly singular itself.
    fn is_short_of(&self, before: &Shot, q: &[f64], place: usize) -> bool {
        let at_singularity = match before.end {
            RayEnd::Obstructed(Obstruction::Singular) => place == 0,
            RayEnd::Event => place == 1,
            _ => false,
        };
        at_singularity && self.rays.apart(&before.q, q) < SAME_MODE
    }

    /// True if the ray to a bound meets nothing before, and comes to the configuration there or, where
    /// several are one, to another singular one.
    ///
    /// Near the singularity of what obstructs rays another way to assemble is almost the same: what
    /// else bounds it is a bound only if the last part of the ray leads there.
    fn is_of_mode(&mut self, before: &Shot, q: &[f64], place: usize) -> Result<bool> {
        if before.end != RayEnd::Whole {
            return Ok(false);
        }
        let at_centre = self.rays.distances();
        let is_near = place < 2 && before.distances[place] < NEAR * at_centre[place];
        let is_close = is_near || self.rays.apart(&before.q, q) < SAME_MODE;
        Ok(is_close && (place == 0 || self.rays.comes_to(q, before, &self.about)?))
    }

    fn add(&mut self, q: Vec<f64>, distance: f64, (kind, limit): (LocusKind, Option<String>)) {
        let point: Vec<f64> = self.about.places.iter().map(|&i| q[i]).collect();
        let scales = &self.about.scales;
        let known = |bound: &ZoneBound| {
            let mut pairs = bound.point.iter().zip(&point).zip(scales);
            bound.kind == kind
                && (bound.distance - distance).abs() <= SAME * distance
                && pairs.all(|((a, b), scale)| (a - b).abs() <= SAME.sqrt() * distance * scale)
        };
        if !self.zone.bounds.iter().any(known) {
            let q = q[..self.problem.platform.n()].to_vec();
            self.zone.bounds.push(ZoneBound { kind, limit, distance, point, q });
        }
    }
}

fn check(options: &ZoneOptions) -> Result<()> {
    let ZoneOptions { components, scales, rays, .. } = options;
    if components.is_empty() {
        return refuse("components", "", "name one at least, such as x");
    }
    if components.len() > 12 {
        return refuse("components", components.len().to_string(), "at most 12 are possible");
    }
    for (i, name) in components.iter().enumerate() {
        if components[..i].contains(name) {
            return refuse("components", name.as_str(), "it is named twice");
        }
    }
    if *rays > MAX_RAYS {
        return refuse("rays", rays.to_string(), "at most 2^20 are possible");
    }
    if !scales.is_empty() {
        Error::check_len("scales", components.len(), scales.len())?;
        scales.iter().try_for_each(|x| Error::check_positive("scales", *x))?;
        let range = 1.0 / MAX_MAGNITUDE..=MAX_MAGNITUDE;
        scales.iter().try_for_each(|x| Error::check_range("scales", *x, &range))?;
    }
    Ok(())
}

/// Refuses what has no surfaces of singularities.
fn check_parts(problem: &Problem, parts: &Parts, of_joints: bool) -> Result<()> {
    let free = parts.path.columns.len() - parts.path.rank;
    let model = problem.platform.mechanism.name();
    if free > 0 {
        let reason = format!(
            "the components leave {free} motions of the mechanism free; name or hold more of them"
        );
        return refuse("components", model, &reason);
    }
    if !parts.event.is_signed() && parts.event.rank > 0 {
        let what = if of_joints { "redundant joints or " } else { "" };
        let reason = format!(
            "with {what}passive motions its singularities are no surfaces, so that a zone has no \
             boundary; hold or fix joints"
        );
        return refuse("components", model, &reason);
    }
    Ok(())
}

/// The configuration in the centre, with platform coordinates.
fn centre(
    problem: &Problem,
    (places, names): (&[usize], &[String]),
    own: &[(String, Option<f64>)],
    of_joints: bool,
) -> Result<Vec<f64>> {
    let mechanism = &problem.platform.mechanism;
    let mut guess = problem.start.clone();
    let mut prescribed = problem.prescribed();
    if of_joints {
        prescribed = mechanism.actuated().collect();
    } else {
        for &(i, value) in &problem.held {
            guess[i] = value;
        }
    }
    for (name, value) in own {
        let Some(value) = value else {
            return refuse("free", name.as_str(), "it is a component of the zone");
        };
        Error::check_within(name, &[*value], MAX_MAGNITUDE)?;
        if let Some(place) = names.iter().position(|n| n == name) {
            guess[places[place]] = *value;
        }
    }
    let found = assemble(mechanism, &guess, &prescribed)?;
    if !found.closed {
        return refuse(
            "at",
            mechanism.name(),
            "no configuration has these components; start nearer to them, or change them",
        );
    }
    if let Some(i) = mechanism.outside_limits(&found.q).next() {
        let c = &mechanism.coordinates()[i];
        let reason = "it is beyond its position limits in the centre";
        return refuse("start", format!("{} = {}", c.name, found.q[i]), reason);
    }
    Ok(found.q)
}
