//! Rays of a zone: straight ways from the centre to the first singularity or limit.
//!
//! Method   steps of `closure/position/platform_path.rs`, which passes no singularity of the loops over
//!          the coordinates that follow; a step is certified if |J' - J| <= (s + s') / 2 for the other
//!          block J as well, in the Frobenius norm, and halved otherwise down to a share of the ray
//! Units    those of the zone
//! Valid    on a certified ray no singular value vanishes if the block is linear within each step: by
//!          Weyl's inequality it differs from that at the nearer end by less than what it has there.
//!          Steps that are not certified compare signs only
//! Checked  tests/map/zone.rs

use crate::closure::{CentredNorm, Obstruction, PathNode, PlatformPath, SignedSingularity};
use crate::error::Result;
use crate::linalg::{Matrix, Svd, max_abs, norm};
use crate::sweep::sobol::Sobol;

/// First and shortest step, as shares of a ray.
const FIRST: f64 = 0.125;
const SHORTEST: f64 = 1.0 / 512.0;
/// Distance to a singularity that a ray passes, relative to that of the centre.
const NEAR: f64 = 0.5;
/// Distance to a singularity at which a ray ends [-].
const SINGULAR: f64 = 1e-6;
/// Largest difference of the coordinates of one configuration [rad, or characteristic lengths].
const SAME: f64 = 1e-4;

/// Why a ray ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RayEnd {
    /// At its length.
    Whole,
    /// The way is obstructed.
    Obstructed(Obstruction),
    /// The other block is singular.
    Event,
}

/// The end of a ray.
#[derive(Debug, Clone)]
pub(super) struct Shot {
    pub(super) end: RayEnd,
    /// The last configuration.
    pub(super) q: Vec<f64>,
    /// Its distance from the centre.
    pub(super) reached: f64,
    pub(super) certified: bool,
    /// Distances to singularities of both blocks there.
    pub(super) distances: [f64; 2],
    /// The configurations nearest to singularities of both blocks, where a whole ray came near to them
    /// and went on: the locus may be beside it, or touched without a change of sign.
    pub(super) passed: [Option<Vec<f64>>; 2],
}

/// Shoots rays from one centre.
#[derive(Debug, Clone)]
pub(super) struct Rays {
    path: PlatformPath,
    event: SignedSingularity,
    /// Number of the coordinates of the mechanism, which come before those of its platform.
    joints: usize,
    start: PathNode,
    block: Matrix,
    /// Smallest generic singular value, and the distance with its sign.
    value: (f64, f64),
}

impl Rays {
    pub(super) fn new(
        mut path: PlatformPath,
        event: SignedSingularity,
        (centre, joints): (&[f64], usize),
    ) -> Result<Self> {
        let start = path.node(centre)?;
        let block = event.block(&path.equations.jacobian);
        let value = values(&event, &block);
        Ok(Self { path, event, joints, start, block, value })
    }

    /// True if the rest of a ray, from its last configuration to the components of `q`, comes to `q`
    /// or to another singularity of the other block, or is obstructed there.
    pub(super) fn comes_to(&mut self, q: &[f64], last: &Shot, about: &CentredNorm) -> Result<bool> {
        let from = self.path.node(&last.q)?;
        let goal: Vec<f64> = about.places.iter().map(|&i| q[i]).collect();
        let Ok(node) = self.path.go(&from, &goal)? else { return Ok(true) };
        self.path.equations.set(&node.q)?;
        let block = self.event.block(&self.path.equations.jacobian);
        Ok(self.apart(&node.q, q) < SAME || values(&self.event, &block).1.abs() < SINGULAR)
    }

    /// The largest difference of the coordinates of two configurations [rad, or characteristic
    /// lengths].
    pub(super) fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let all = a.iter().zip(b).take(self.joints).enumerate();
        all.fold(0.0, |most, (i, (a, b))| most.max(((a - b) / self.path.equations.unit(i)).abs()))
    }

    /// Distances of the centre to singularities of both blocks.
    pub(super) fn distances(&self) -> [f64; 2] {
        [self.path.by_free.distance(&self.start.svd), self.value.1.abs()]
    }

    /// A ray along a direction of the components over their scales.
    pub(super) fn shoot(
        &mut self,
        about: &CentredNorm,
        direction: &[f64],
        length: f64,
    ) -> Result<Shot> {
        let to = |t: f64| -> Vec<f64> {
            let all = about.centre.iter().zip(direction).zip(&about.scales);
            all.map(|((c, d), w)| c + t * d * w).collect()
        };
        let (mut here, mut block, mut value) = (self.start.clone(), self.block.clone(), self.value);
        let (mut t, mut step, mut certified) = (0.0, FIRST * length, true);
        let following = self.path.by_free.clone();
        let at_centre = self.distances();
        let mut least = at_centre.map(|distance| NEAR * distance);
        let mut nearest: [Option<(f64, Vec<f64>)>; 2] = [None, None];
        let none = || [None, None];
        let shot = |end, node: PathNode, event: f64, certified, passed| Shot {
            end,
            reached: about.size(&about.offset(&node.q)),
            distances: [following.distance(&node.svd), event.abs()],
            q: node.q,
            certified,
            passed,
        };
        while t < length {
            let next = if t + step > length * (1.0 - SHORTEST * 0.5) { length } else { t + step };
            let node = match self.path.go(&here, &to(next))? {
                Ok(node) => node,
                Err((last, why)) => {
                    return Ok(shot(RayEnd::Obstructed(why), last, value.1, certified, none()));
                }
            };
            self.path.equations.set(&node.q)?;
            let there = self.event.block(&self.path.equations.jacobian);
            let now = values(&self.event, &there);
            let turned: f64 =
                there.as_slice().iter().zip(block.as_slice()).map(|(a, b)| (a - b).powi(2)).sum();
            let sure = turned.sqrt() <= 0.5 * (value.0 + now.0);
            if !sure && next - t > SHORTEST * length {
                step = 0.5 * (next - t);
                continue;
            }
            if now.1 * value.1 < 0.0 || now.1.abs() < SINGULAR {
                let (nearer, value) = if now.0 < value.0 { (node, now) } else { (here, value) };
                return Ok(shot(RayEnd::Event, nearer, value.1, certified, none()));
            }
            certified &= sure;
            step = if sure { 2.0 * (next - t) } else { next - t };
            (here, block, value, t) = (node, there, now, next);
            let distances = [following.distance(&here.svd), value.1.abs()];
            for ((distance, least), nearest) in distances.iter().zip(&mut least).zip(&mut nearest) {
                if *distance < *least {
                    (*least, *nearest) = (*distance, Some((t, here.q.clone())));
                }
            }
        }
        let passed = nearest.map(|found| found.filter(|(at, _)| *at < length).map(|(_, q)| q));
        Ok(shot(RayEnd::Whole, here, value.1, certified, passed))
    }
}

fn values(event: &SignedSingularity, block: &Matrix) -> (f64, f64) {
    let svd = Svd::of(block);
    match event.rank.checked_sub(1) {
        None => (f64::INFINITY, 1.0),
        Some(last) => (svd.value(last), event.value(block, &svd)),
    }
}

/// Directions of size one: along the components, to the corners of a box, then evenly spread.
pub(super) struct Directions {
    k: usize,
    corners: usize,
    sobol: Sobol,
    about_box: bool,
}

impl Directions {
    pub(super) fn new(k: usize, about_box: bool, seed: u64) -> Self {
        let corners = if about_box && k > 1 { 1 << k } else { 0 };
        Self { k, corners, sobol: Sobol::new(k.next_multiple_of(2), seed), about_box }
    }

    /// Number of those that do not depend on the seed.
    pub(super) fn fixed(&self) -> usize {
        2 * self.k + self.corners
    }

    pub(super) fn get(&self, number: usize) -> Vec<f64> {
        let k = self.k;
        let mut x = vec![0.0; k];
        if number < 2 * k {
            x[number / 2] = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
            return x;
        }
        if number < self.fixed() {
            let corner = number - 2 * k;
            let sign = |i: usize| if (corner >> i) & 1 == 0 { 1.0 } else { -1.0 };
            return (0..k).map(sign).collect();
        }
        let mut u = vec![0.0; k.next_multiple_of(2)];
        let index = u32::try_from(number - self.fixed()).unwrap_or(u32::MAX);
        self.sobol.write(index, &mut u);
        // Normal numbers by Box and Muller have no favourite direction.
        for (pair, u) in x.chunks_mut(2).zip(u.chunks(2)) {
            let (size, turn) = ((-2.0 * u[0].ln()).sqrt(), std::f64::consts::TAU * u[1]);
            pair[0] = size * turn.cos();
            if let Some(second) = pair.get_mut(1) {
                *second = size * turn.sin();
            }
        }
        let size = if self.about_box { max_abs(&x) } else { norm(&x) };
        x.iter_mut().for_each(|x| *x /= size.max(f64::MIN_POSITIVE));
        x
    }
}
