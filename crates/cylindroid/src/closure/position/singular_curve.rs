//! Curves of configurations on which a distance to a singularity or to a position limit vanishes.
//!
//! Formula  r(x) = 0, g(x) = 0 for all coordinates x that are not held: g = u^T J v, with u and v the
//!          singular vectors of the smallest generic singular value of a block of the Jacobian and
//!          grad g = u^T (dJ/dv), since second derivatives of r commute; or g = q_i - limit.
//!          Predictor along the kernel of [J; grad g], corrector: Newton of least norm
//! Shapes   x: m coordinates, [J; grad g]: (t + 1) x m of generic rank m - 1
//! Units    none: lengths are divided by the characteristic length
//! Valid    where g changes its sign or falls to zero with the distance. Curves that cross are followed
//!          straight on. Where a singular motion goes on (a finite self-motion: an arm whose tip is on
//!          its first axis), what vanishes is a surface; it is crossed at right angles to that motion, if
//!          the motion is straight in the coordinates
//! Fails    where the curve has a corner; it ends there
//! Why so   a contour of a grid is as accurate as its cells; the smallest singular value with fixed
//!          singular vectors is smooth and needs no derivative of a determinant
//! Source   Allgower & Georg 1990, chapters 2 and 6; Bohigas et al. 2013 for singularities as
//!          solutions of extended systems
//! Checked  tests/map/five_bar.rs, tests/map/planar_platform.rs, tests/map/options.rs

use super::configuration_signature::{Landmarks, link_poses};
use super::coordinates::{columns, largest_change, moved};
use super::loop_equations::LoopEquations;
use super::signed_singularity::SignedSingularity;
use crate::error::{Result, all_finite};
use crate::linalg::{Matrix, Svd, dot, norm};
use crate::model::{CoordinateKind, Mechanism};
use crate::scalar::clamp;
use crate::spatial::Vec3;
use crate::tolerance::{LIMIT_MET, LOCUS_AT_REST, LOCUS_MET, LOCUS_STEP, SURFACE_RANK};

/// Maximum number of Newton steps.
const MAX_NEWTON: usize = 25;
/// Maximum number of points of a curve.
const MAX_POINTS: usize = 20_000;
/// Shortest and longest step [rad, or characteristic lengths].
const STEPS: (f64, f64) = (1e-9, 0.1);
/// Steps that an axis of the box has at least.
const STEPS_OF_BOX: f64 = 200.0;
/// Cosine of the largest turn of the tangent within a step.
const TURN: f64 = 0.99;
/// Length of a part of a self-motion by which it is known [rad, or characteristic lengths].
const SELF_MOTION: f64 = 0.05;
/// Square of the distance to a segment over the square of its length, up to which a point lies on it [-].
const ON_SEGMENT: f64 = 0.01;
/// Halvings that find the end of a curve at the boundary of its domain: from the longest step to the
/// shortest.
const HALVINGS: usize = 27;

/// What vanishes on a curve.
#[derive(Debug, Clone)]
pub(crate) enum Vanishing {
    Singularity(SignedSingularity),
    Limit { coordinate: usize, value: f64 },
}

/// Where a curve is followed.
#[derive(Debug, Clone)]
pub(crate) struct CurveDomain {
    /// Coordinates with their smallest and largest value.
    pub(crate) bounds: Vec<(usize, f64, f64)>,
    /// A distance to singularities that keeps this sign.
    pub(crate) side: Option<(SignedSingularity, f64)>,
}

/// A polyline of configurations, with the landmarks by which curves are compared.
#[derive(Debug, Clone, Default)]
pub(crate) struct Curve {
    pub(crate) points: Vec<Vec<f64>>,
    landmarks: Vec<Vec<Vec3>>,
    /// True if each point is one of a self-motion.
    self_motion: bool,
    pub(crate) closed: bool,
}

/// A point of a curve and its place among others of the curve.
#[derive(Debug, Clone)]
pub(crate) struct Seed {
    pub(crate) q: Vec<f64>,
    landmarks: Vec<Vec3>,
    self_motion: bool,
}

/// Follows curves.
#[derive(Debug, Clone)]
pub(crate) struct CurveTracer {
    equations: LoopEquations,
    vanishing: Vanishing,
    domain: CurveDomain,
    unknown: Vec<usize>,
    /// Generic rank of the loops over the unknown.
    rank: usize,
    marks: Landmarks,
}

/// A point on a curve with the decomposition of the system there.
pub(super) struct CurvePoint {
    pub(super) q: Vec<f64>,
    a: Matrix,
    svd: Svd,
    /// The singular motion that goes on, of the unknown, while such a surface is crossed.
    motion: Option<Vec<f64>>,
}

impl Curve {
    /// True if the curve passes through a point, or through another one of its self-motion.
    pub(crate) fn passes(&self, seed: &Seed) -> bool {
        let on_curve = |ends: &[Vec<Vec3>]| on_segment(&seed.landmarks, &ends[0], &ends[1]);
        self.self_motion == seed.self_motion && self.landmarks.windows(2).any(on_curve)
    }
}

/// True if a point lies on a segment, to a tenth of its length.
fn on_segment(at: &[Vec3], from: &[Vec3], to: &[Vec3]) -> bool {
    let (mut along, mut square, mut away) = (0.0, 0.0, 0.0);
    for ((p, a), b) in at.iter().zip(from).zip(to) {
        let (d, e) = (*b - *a, *p - *a);
        along += d.dot(e);
        square += d.dot(d);
        away += e.dot(e);
    }
    let share = clamp(along / square.max(f64::MIN_POSITIVE), 0.0, 1.0);
    let distance = away - 2.0 * share * along + share * share * square;
    distance <= ON_SEGMENT * square + LOCUS_MET
}

impl CurveTracer {
    pub(crate) fn new(
        equations: LoopEquations,
        vanishing: Vanishing,
        domain: CurveDomain,
        (unknown, rank): (Vec<usize>, usize),
    ) -> Self {
        let marks = Landmarks::of(equations.mechanism());
        Self { equations, vanishing, domain, unknown, rank, marks }
    }

    pub(crate) fn set_vanishing(&mut self, vanishing: Vanishing) {
        self.vanishing = vanishing;
    }

    pub(super) fn mechanism(&self) -> &Mechanism {
        self.equations.mechanism()
    }

    /// The coordinates that are not held.
    pub(super) fn unknown(&self) -> &[usize] {
        &self.unknown
    }

    /// The change of a coordinate (m or rad) per unit of its scaled change.
    pub(super) fn unit(&self, coordinate: usize) -> f64 {
        self.equations.unit(coordinate)
    }

    /// The landmarks of a configuration; within a self-motion its coordinates that rest.
    fn landmarks(&mut self, q: &[f64], self_motion: bool) -> Result<Vec<Vec3>> {
        if !self_motion {
            self.equations.set(q)?;
            return Ok(self.marks.at(&link_poses(self.equations.state())));
        }
        let motion = self.motion(q)?;
        let coordinates = self.equations.mechanism().coordinates();
        let place = |i: usize| {
            if motion[i].abs() > LOCUS_AT_REST {
                Vec3::ZERO
            } else if coordinates[i].kind == CoordinateKind::Angle {
                // Whole turns are no difference.
                Vec3::new(q[i].cos(), q[i].sin(), 0.0)
            } else {
                Vec3::new(q[i] / self.unit(i), 0.0, 0.0)
            }
        };
        Ok((0..q.len()).map(place).collect())
    }

    /// The point of the curve nearest to a guess, if Newton's method finds one in the domain.
    pub(crate) fn refine(&mut self, guess: &[f64]) -> Result<Option<Seed>> {
        let Some(point) = self.corrected(guess.to_vec(), false)? else { return Ok(None) };
        if !self.contains(&point.q)? {
            return Ok(None);
        }
        let self_motion = self.moves_on(&point)?;
        let landmarks = self.landmarks(&point.q, self_motion)?;
        Ok(Some(Seed { q: point.q, landmarks, self_motion }))
    }

    /// True if the singular motion at a point leads to other points, the bounded coordinates at rest.
    fn moves_on(&mut self, at: &CurvePoint) -> Result<bool> {
        // Of higher rank, the system of a curve has no such motion.
        if at.svd.rank(SURFACE_RANK).rank > self.rank {
            return Ok(false);
        }
        let motion = self.motion_of_unknown(&at.q)?;
        if motion.iter().all(|x| *x == 0.0) {
            return Ok(false);
        }
        let change: Vec<f64> = motion.iter().map(|x| SELF_MOTION * x).collect();
        let guess = moved(self.equations.mechanism(), &at.q, &self.unknown, &change);
        let Some(other) = self.corrected(guess.clone(), false)? else { return Ok(false) };
        let bounded: Vec<usize> = self.domain.bounds.iter().map(|&(i, ..)| i).collect();
        Ok(self.apart(&self.unknown, &other.q, &guess) <= 0.2 * SELF_MOTION
            && self.apart(&bounded, &other.q, &at.q) <= LOCUS_AT_REST)
    }

    /// The singular vector of the vanishing value at a configuration, of all coordinates and scaled;
    /// zero at a limit.
    pub(crate) fn motion(&mut self, q: &[f64]) -> Result<Vec<f64>> {
        let mut motion = vec![0.0; q.len()];
        if let Vanishing::Singularity(singularity) = &self.vanishing {
            self.equations.set(q)?;
            let svd = Svd::of(&singularity.block(&self.equations.jacobian));
            if let Some(last) = singularity.rank.checked_sub(1) {
                for (&i, x) in singularity.columns.iter().zip(svd.v(last)) {
                    motion[i] = *x;
                }
            }
        }
        Ok(motion)
    }

    /// [`Self::motion`] of the unknown.
    fn motion_of_unknown(&mut self, q: &[f64]) -> Result<Vec<f64>> {
        let motion = self.motion(q)?;
        Ok(self.unknown.iter().map(|&i| motion[i]).collect())
    }

    /// The whole curve through a point on it, within the domain; what there is of it where `go_on`
    /// ends it, which is asked before each step.
    pub(crate) fn trace(&mut self, seed: &Seed, go_on: &dyn Fn() -> bool) -> Result<Curve> {
        let mut curve = self.half(seed, 1.0, go_on)?;
        if !curve.closed {
            let mut back = self.half(seed, -1.0, go_on)?;
            back.points.reverse();
            back.landmarks.reverse();
            back.points.pop();
            back.landmarks.pop();
            back.points.append(&mut curve.points);
            back.landmarks.append(&mut curve.landmarks);
            curve = back;
        }
        Ok(curve)
    }

    fn half(&mut self, seed: &Seed, sign: f64, go_on: &dyn Fn() -> bool) -> Result<Curve> {
        let mut curve = Curve { self_motion: seed.self_motion, ..Curve::default() };
        let Some(mut here) = self.corrected(seed.q.clone(), seed.self_motion)? else {
            return Ok(curve);
        };
        let Some(mut tangent) = self.first_tangent(&here, sign) else { return Ok(curve) };
        self.push(&mut curve, here.q.clone())?;
        let mut step = 0.1 * self.longest(&tangent);
        for _ in (1..MAX_POINTS).take_while(|_| go_on()) {
            step = step.min(self.longest(&tangent));
            let next = loop {
                if step < STEPS.0 {
                    return Ok(curve);
                }
                if let Some(next) = self.stepped(&here, &tangent, step)? {
                    break next;
                }
                step *= 0.5;
            };
            if !self.contains(&next.0.q)? {
                let last = self.end(&here, &tangent, step)?;
                self.push(&mut curve, last)?;
                return Ok(curve);
            }
            (here, tangent) = next;
            self.push(&mut curve, here.q.clone())?;
            let count = curve.landmarks.len();
            if count > 3 {
                let ends = [&curve.landmarks[count - 2], &curve.landmarks[count - 1]];
                if on_segment(&curve.landmarks[0], ends[0], ends[1]) {
                    curve.closed = true;
                    // The last point is the first one.
                    curve.points[count - 1] = curve.points[0].clone();
                    curve.landmarks[count - 1] = curve.landmarks[0].clone();
                    return Ok(curve);
                }
            }
            step *= 1.5;
        }
        Ok(curve)
    }

    /// The last point in the domain within a step that leaves it.
    fn end(&mut self, here: &CurvePoint, tangent: &[f64], step: f64) -> Result<Vec<f64>> {
        let (mut inside, mut outside) = (0.0, step);
        let mut last = here.q.clone();
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            match self.stepped(here, tangent, middle)? {
                Some((point, _)) if self.contains(&point.q)? => {
                    inside = middle;
                    last = point.q;
                }
                _ => outside = middle,
            }
        }
        Ok(last)
    }

    /// The point after a step, with its tangent, if it is certainly on the same curve.
    fn stepped(
        &mut self,
        here: &CurvePoint,
        tangent: &[f64],
        step: f64,
    ) -> Result<Option<(CurvePoint, Vec<f64>)>> {
        let change: Vec<f64> = tangent.iter().map(|x| step * x).collect();
        let guess = moved(self.equations.mechanism(), &here.q, &self.unknown, &change);
        let Some(point) = self.corrected(guess.clone(), here.motion.is_some())? else {
            return Ok(None);
        };
        let apart = self.apart(&self.unknown, &point.q, &guess);
        let next = self.tangent(&point, tangent);
        let turned: f64 = next.iter().zip(tangent).map(|(a, b)| a * b).sum();
        // Rotation vectors may come back as equivalent ones.
        let near = apart <= 0.2 * step || apart > 1.0;
        Ok((near && turned >= TURN).then_some((point, next)))
    }

    /// The distance of two configurations over some coordinates.
    fn apart(&self, some: &[usize], a: &[f64], b: &[f64]) -> f64 {
        let square = |&i: &usize| ((a[i] - b[i]) / self.unit(i)).powi(2);
        some.iter().map(square).sum::<f64>().sqrt()
    }

    /// The longest step: a share of the box along each of its axes.
    fn longest(&self, tangent: &[f64]) -> f64 {
        let mut longest = STEPS.1;
        for &(i, lower, upper) in &self.domain.bounds {
            let Some(place) = self.unknown.iter().position(|&u| u == i) else { continue };
            let rate = (tangent[place] * self.equations.unit(i)).abs();
            longest = longest.min((upper - lower) / STEPS_OF_BOX / rate.max(f64::MIN_POSITIVE));
        }
        longest.max(STEPS.0)
    }

    fn push(&mut self, curve: &mut Curve, q: Vec<f64>) -> Result<()> {
        let landmarks = self.landmarks(&q, curve.self_motion)?;
        curve.points.push(q);
        curve.landmarks.push(landmarks);
        Ok(())
    }

    /// True within the box, the limits and on the side.
    fn contains(&mut self, q: &[f64]) -> Result<bool> {
        let within = |&(i, lower, upper): &(usize, f64, f64)| {
            let slack = LIMIT_MET * (1.0 + lower.abs().max(upper.abs()));
            q[i] >= lower - slack && q[i] <= upper + slack
        };
        if !self.domain.bounds.iter().all(within) {
            return Ok(false);
        }
        let mechanism = self.equations.mechanism();
        let followed = match self.vanishing {
            Vanishing::Limit { coordinate, .. } => Some(coordinate),
            Vanishing::Singularity(_) => None,
        };
        let beyond = mechanism
            .outside_limits(q)
            .any(|i| Some(i) != followed && mechanism.coordinates()[i].limits.exclude(q[i]));
        if beyond {
            return Ok(false);
        }
        let Some((singularity, sign)) = &self.domain.side else { return Ok(true) };
        self.equations.set(q)?;
        let block = singularity.block(&self.equations.jacobian);
        Ok(singularity.value(&block, &Svd::of(&block)) * sign >= 0.0)
    }

    /// A unit vector of the kernel, by the projection of some vector.
    fn first_tangent(&self, at: &CurvePoint, sign: f64) -> Option<Vec<f64>> {
        let m = self.unknown.len();
        let along = |k: usize| {
            let mut unit = vec![0.0; m];
            unit[k] = sign;
            self.projected(at, &unit)
        };
        let longest = (0..m).map(along).max_by(|a, b| norm(a).total_cmp(&norm(b)))?;
        let size = norm(&longest);
        (size > LOCUS_STEP).then(|| longest.iter().map(|x| x / size).collect())
    }

    fn tangent(&self, at: &CurvePoint, before: &[f64]) -> Vec<f64> {
        let projected = self.projected(at, before);
        let size = norm(&projected).max(f64::MIN_POSITIVE);
        projected.iter().map(|x| x / size).collect()
    }

    /// The part of a vector in the kernel, without the self-motion.
    pub(super) fn projected(&self, at: &CurvePoint, x: &[f64]) -> Vec<f64> {
        let rank = self.rank + usize::from(at.motion.is_none());
        let back = at.svd.solve(&at.a.mul_vec(x), rank);
        let mut kernel: Vec<f64> = x.iter().zip(back).map(|(x, y)| x - y).collect();
        if let Some(motion) = &at.motion {
            let along = dot(&kernel, motion) / dot(motion, motion).max(f64::MIN_POSITIVE);
            kernel.iter_mut().zip(motion).for_each(|(x, m)| *x -= along * m);
        }
        kernel
    }

    /// Newton's method of least norm from a guess; with `self_motion` to the surface of one.
    pub(super) fn corrected(
        &mut self,
        mut q: Vec<f64>,
        self_motion: bool,
    ) -> Result<Option<CurvePoint>> {
        let rank = self.rank + usize::from(!self_motion);
        for _ in 0..MAX_NEWTON {
            let (a, b) = self.system(&q)?;
            let svd = Svd::of(&a);
            let open = norm(&b[..b.len() - 1]);
            let value = b.last().map_or(0.0, |x| x.abs());
            if open <= LOCUS_MET && value <= LOCUS_MET {
                let motion = self_motion.then(|| self.motion_of_unknown(&q)).transpose()?;
                return Ok(Some(CurvePoint { q, a, svd, motion }));
            }
            let mut change = svd.solve(&b, rank);
            let size = largest_change(self.equations.mechanism(), &self.unknown, &change);
            let factor = if size > STEPS.1 { -STEPS.1 / size } else { -1.0 };
            change.iter_mut().for_each(|x| *x *= factor);
            q = moved(self.equations.mechanism(), &q, &self.unknown, &change);
            if !all_finite(&q) {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// [J; grad g] and [r; g].
    fn system(&mut self, q: &[f64]) -> Result<(Matrix, Vec<f64>)> {
        self.equations.set(q)?;
        let (loops, m) = (self.equations.loop_rows(), self.unknown.len());
        let rates = columns(&self.equations.jacobian, &self.unknown);
        let mut b = self.equations.residuals.clone();
        let mut gradient = vec![0.0; m];
        match &self.vanishing {
            Vanishing::Limit { coordinate, value } => {
                let unit = self.equations.unit(*coordinate);
                b.push((q[*coordinate] - value) / unit);
                for (x, &i) in gradient.iter_mut().zip(&self.unknown) {
                    *x = f64::from(u8::from(i == *coordinate));
                }
            }
            Vanishing::Singularity(singularity) => {
                let svd = Svd::of(&singularity.block(&self.equations.jacobian));
                let last = singularity.rank.saturating_sub(1);
                b.push(svd.value(last));
                let (u, v) = (svd.u(last), svd.v(last));
                let from = singularity.first_row();
                let mechanism = self.equations.mechanism().clone();
                for side in [LOCUS_STEP, -LOCUS_STEP] {
                    let change: Vec<f64> = v.iter().map(|x| side * x).collect();
                    let near = moved(&mechanism, q, &singularity.columns, &change);
                    self.equations.set(&near)?;
                    for (x, &i) in gradient.iter_mut().zip(&self.unknown) {
                        let column = &self.equations.jacobian.column(i)[from..];
                        let sum: f64 = u.iter().zip(column).map(|(u, j)| u * j).sum();
                        *x += sum / (2.0 * side);
                    }
                }
            }
        }
        let a = Matrix::from_fn(
            loops + 1,
            m,
            |i, j| {
                if i < loops { rates[(i, j)] } else { gradient[j] }
            },
        );
        Ok((a, b))
    }
}

#[cfg(test)]
mod tests {
    use super::{Vec3, on_segment};

    #[test]
    fn points_on_a_segment() {
        let to = [Vec3::X * 3.0, Vec3::Z * 4.0];
        let is_on = |x: f64, z: f64, y: f64| {
            on_segment(&[Vec3::new(x, y, 0.0), Vec3::Z * z], &[Vec3::ZERO; 2], &to)
        };
        // Its length is 5: what is nearer than 0.5 lies on it.
        assert!(is_on(0.0, 0.0, 0.0) && is_on(3.0, 4.0, 0.0) && is_on(1.5, 2.0, 0.45));
        assert!(!is_on(1.5, 2.0, 0.55) && !is_on(3.4, 4.4, 0.0) && !is_on(-0.4, -0.4, 0.0));
        assert!(is_on(3.2, 4.3, 0.0) && is_on(-0.2, -0.3, 0.0) && !is_on(0.0, 2.0, 0.0));
    }
}
