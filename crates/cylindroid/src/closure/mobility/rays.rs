//! Rays: first-order motions followed a finite way, with the loops closed as far as they can be.
//!
//! Formula  for a unit vector d of first-order motions, the curve x = s d, y(s) of the
//!          Lyapunov-Schmidt reduction, tracked from s = 0 in steps that start at 1/128 and are
//!          1/16 at most; its residual g(s) is analytic: zero all along where the motion lies on a
//!          branch, and asymptotically c s^p where it does not
//! Shapes   d: k
//! Units    s: rad, or characteristic lengths; g: none (scaled)
//! Valid    d belongs to the names of the coordinates, so that neither the order of the joints nor
//!          the basis of the motions changes it. A ray ends at the latest at the distance
//!          [`TRACKED`], earlier where Newton's method fails: y(s) turns back there
//! Why so   a single short step cannot distinguish a finite motion from a contact of high order: of
//!          c s^8 a step of 0.01 leaves 1e-16
//! Checked  tests/it/closure/finite.rs, tests/it/linkages/published.rs

use super::lyapunov_schmidt::{LyapunovSchmidt, ReducedPoint};
use crate::error::Result;
use crate::linalg::norm;
use crate::tolerance::{CLEARLY_OPEN, TRACKED};

/// First step, and the largest one.
const STEPS: (f64, f64) = (1.0 / 128.0, 1.0 / 16.0);
/// Maximum number of halvings of the first step.
const HALVINGS: i32 = 8;
/// Number of rays, each to both sides.
const RAYS: u64 = 3;
/// A power is asymptotic if it is this near to an integer [-].
const NEAR_INTEGER: f64 = 0.25;

/// A point on a ray.
pub(crate) struct RayPoint {
    pub(crate) q: Vec<f64>,
    /// s.
    pub(crate) distance: f64,
    /// |g|.
    pub(crate) residual: f64,
}

/// A first-order motion followed a finite way.
pub(crate) struct Ray {
    /// Ordered by distance; empty if not even a short step converges.
    pub(crate) points: Vec<RayPoint>,
}

impl Ray {
    /// Along the unit vector `direction`, no farther than `length`.
    pub(crate) fn of(
        reduction: &LyapunovSchmidt<'_>,
        direction: &[f64],
        length: f64,
    ) -> Result<Self> {
        let mut points: Vec<RayPoint> = Vec::new();
        if reduction.is_unconstrained() {
            let x: Vec<f64> = direction.iter().map(|x| length * x).collect();
            let end = reduction.step(&x)?;
            points.extend(end.map(|p| RayPoint { q: p.q, distance: length, residual: 0.0 }));
            return Ok(Self { points });
        }
        let along = |s: f64| -> Vec<f64> { direction.iter().map(|x| s * x).collect() };
        let least = STEPS.0 * 0.5_f64.powi(HALVINGS);
        let mut step = STEPS.0;
        loop {
            let last = points.last();
            let here = last.map_or(0.0, |p| p.distance);
            if here + 0.5 * step >= length || step < least {
                return Ok(Self { points });
            }
            let next = match last {
                None => reduction.step(&along(step))?,
                Some(last) => reduction.step_from(&last.q, &along(step))?,
            };
            match next {
                Some(ReducedPoint { q, residual, .. }) => {
                    let residual = norm(&residual);
                    points.push(RayPoint { q, distance: here + step, residual });
                    step = (here + step).min(STEPS.1);
                }
                // Later on a shorter step would only come nearer to where the curve turns back.
                None if here > 0.0 && step <= 0.25 * STEPS.1.min(here) => {
                    return Ok(Self { points });
                }
                None => step *= 0.5,
            }
        }
    }

    /// Length of the ray.
    pub(crate) fn length(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.distance)
    }

    /// The largest residual over its tolerance.
    fn openness(&self, reduction: &LyapunovSchmidt<'_>) -> f64 {
        let open = |p: &RayPoint| p.residual / reduction.tolerance_at(p.distance);
        self.points.iter().map(open).fold(0.0, f64::max)
    }
}

/// p of the residual c s^p on two opposite rays: from distances of which one is twice the other, at
/// which it is far above rounding. The mean of both sides cancels the next power; what remains is
/// extrapolated to s = 0.
fn power(reduction: &LyapunovSchmidt<'_>, [one, other]: [&Ray; 2]) -> Option<f64> {
    let mean = |p: &RayPoint| -> Option<f64> {
        let same = other.points.iter().find(|o| (o.distance - p.distance).abs() < 1e-9)?;
        let least = CLEARLY_OPEN * reduction.tolerance_at(p.distance);
        (p.residual.min(same.residual) > least).then(|| (p.residual * same.residual).sqrt())
    };
    let mut powers = one.points.iter().filter_map(|near| {
        let twice = one.points.iter().find(|p| (p.distance - 2.0 * near.distance).abs() < 1e-9)?;
        Some((mean(twice)? / mean(near)?).log2())
    });
    let first = powers.next()?;
    Some(powers.next().map_or(first, |second| (4.0 * first - second) / 3.0))
}

/// Rays in several directions.
pub(crate) struct Rays {
    pub(crate) rays: Vec<Ray>,
    /// Length of the shortest.
    pub(crate) tracked: f64,
    /// Largest residual over its tolerance: at most 1 if all motions are finite as far as tracked.
    pub(crate) openness: f64,
    /// Largest residual [-].
    pub(crate) residual: f64,
    /// The power with which the residual grows, if it is an integer in every direction.
    pub(crate) power: Option<u32>,
}

impl Rays {
    /// In both senses of some directions.
    pub(crate) fn of(reduction: &LyapunovSchmidt<'_>) -> Result<Self> {
        let mut rays = Vec::new();
        let single = reduction.motions() == 1 || reduction.dependent() == 0;
        // On a manifold one generic direction shows as much as several.
        let several = if single { 1 } else { RAYS };
        for number in 0..several {
            let d = reduction.direction(number);
            let back: Vec<f64> = d.iter().map(|x| -x).collect();
            rays.push(Ray::of(reduction, &d, TRACKED)?);
            rays.push(Ray::of(reduction, &back, TRACKED)?);
        }
        let residuals = rays.iter().flat_map(|r| &r.points).map(|p| p.residual);
        let pairs = rays.chunks_exact(2);
        let powers: Option<Vec<f64>> = pairs.map(|p| power(reduction, [&p[0], &p[1]])).collect();
        Ok(Self {
            tracked: rays.iter().map(Ray::length).fold(TRACKED, f64::min),
            openness: rays.iter().map(|r| r.openness(reduction)).fold(0.0, f64::max),
            residual: residuals.fold(0.0, f64::max),
            power: powers.and_then(|p| integer(&p)),
            rays,
        })
    }

    /// The configurations at the ends of the rays.
    pub(crate) fn ends(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.rays.iter().filter_map(|r| r.points.last()).map(|p| &p.q)
    }

    /// The shortest distance at which the residual is clearly above rounding in some direction, and
    /// all rays still go; otherwise that of the first step of all.
    pub(crate) fn open_distance(&self, reduction: &LyapunovSchmidt<'_>) -> f64 {
        let first = self.rays.iter().filter_map(|r| r.points.first()).map(|p| p.distance);
        let first = first.fold(f64::INFINITY, f64::min);
        let open = self.rays.iter().flat_map(|r| &r.points).filter(|p| {
            p.distance <= self.tracked
                && p.residual > CLEARLY_OPEN * reduction.tolerance_at(p.distance)
        });
        let open = open.map(|p| p.distance).fold(f64::INFINITY, f64::min);
        if open.is_finite() { open } else { first }
    }
}

/// The integer that all are near to.
fn integer(powers: &[f64]) -> Option<u32> {
    let least = powers.iter().copied().fold(f64::INFINITY, f64::min).round();
    let all = powers.iter().all(|p| (p - least).abs() <= NEAR_INTEGER);
    (all && (1.0..64.0).contains(&least)).then_some(least as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tolerance::CLOSURE_RANK;

    #[test]
    fn powers_are_near_one_integer() {
        assert_eq!(integer(&[2.0 + 0.5 * NEAR_INTEGER, 2.0 - 0.5 * NEAR_INTEGER]), Some(2));
        for apart in [1.5 * NEAR_INTEGER, -1.5 * NEAR_INTEGER] {
            assert_eq!(integer(&[2.0 + apart, 2.0 + apart]), None);
            assert_eq!(integer(&[2.0, 2.0 + apart]), None);
        }
        assert_eq!(integer(&[0.0, 0.0]), None);
        assert_eq!(integer(&[64.0]), None);
        assert_eq!(integer(&[f64::NAN]), None);
        assert_eq!(integer(&[]), None);
    }

    /// A point that is open has a residual of 1.
    fn ray(points: &[(f64, bool)]) -> Ray {
        let point = |&(distance, is_open)| RayPoint {
            q: Vec::new(),
            distance,
            residual: if is_open { 1.0 } else { 0.0 },
        };
        Ray { points: points.iter().map(point).collect() }
    }

    /// What opens counts as far as all rays go, their end included.
    #[test]
    fn rays_open_where_all_of_them_still_go() {
        let robot = crate::model::catalogue::load("four-bar").unwrap();
        let (q, length) = (robot.home(), robot.reach());
        let reduction = LyapunovSchmidt::of(&robot, q, length, CLOSURE_RANK).unwrap();
        for (own, expected) in [
            (&[(0.1, false), (0.2, true)][..], 0.05),
            (&[(0.1, false), (0.12, true), (0.2, true)], 0.12),
            (&[(0.1, false), (0.15, true)], 0.15),
            (&[(0.1, false), (0.15, false)], 0.05),
        ] {
            let rays = vec![ray(own), ray(&[(0.05, false), (0.15, false)])];
            let tracked = rays.iter().map(Ray::length).fold(TRACKED, f64::min);
            let rays = Rays { rays, tracked, openness: 0.0, residual: 0.0, power: None };
            assert_eq!(rays.open_distance(&reduction), expected, "{own:?}");
        }
    }
}
