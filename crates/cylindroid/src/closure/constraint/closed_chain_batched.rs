//! The constraint of a mechanism, batched: several configurations at once.
//!
//! Formula  `closed_chain.rs`, scaled: a row for each constraint wrench, then one for each
//!          component of the reference twist, as `J_ref` without its `-1`
//! Shapes   q: n values, each a vector of lanes; rows of q_a + q_p columns, actuated joints first
//! Units    none: lengths are divided by the characteristic length. Loop-closure errors: m, rad
//! Frame    u at the origin of the reference frame, world axes
//! Valid    as [`crate::closure::ClosedChain`], except lanes in which the axes of a universal loop
//!          joint are nearly parallel: their rows must not be used
//! Why so   the joints that move each pair, and their columns, are looked up once for all
//!          configurations
//! Checked  tests/it/manipulability/batch.rs

use super::closed_chain::Columns;
use super::constraint_rows::{self, KinematicPair, PairConstraints};
use super::velocity_constraint::Unit;
use crate::error::Result;
use crate::kinematics::tree_batched::{self, Frame};
use crate::model::{FrameId, Mechanism, Node, NodeKind};
use crate::scalar::{MAX_LANES, SimdFloat};
use crate::spatial::{AlignedPose, Pose, Vec3, Vector3Like, Wrench, dot};
use crate::tolerance::CROSSED_AXES;

/// The part of the constraint that does not depend on the configuration.
#[derive(Debug, Clone)]
pub(crate) struct BatchedConstraintPlan {
    nodes: Vec<Node>,
    pairs: Vec<BatchedPair>,
    reference: AttachedFrame,
    /// The joints that move the reference.
    columns_of: Vec<JacobianColumn>,
    components: &'static [usize],
    length: f64,
    /// Scales of the actuated columns, and of the components of the reference.
    pub(crate) actuated_scale: Vec<f64>,
    pub(crate) object_scale: Vec<f64>,
    passive: usize,
    rows: usize,
}

/// A frame attached to a moving frame.
#[derive(Debug, Clone)]
struct AttachedFrame {
    slot: usize,
    from: AlignedPose,
}

/// A column of a Jacobian: the joint rotates or translates its descendants about or along an axis
/// of its frame.
#[derive(Debug, Clone)]
struct JacobianColumn {
    slot: usize,
    axis: usize,
    turns: bool,
    column: usize,
    /// Per unit of the scaled rate, with the sign of the side on which the joint lies.
    rate: f64,
}

/// A loop joint or contact.
#[derive(Debug, Clone)]
struct BatchedPair {
    ends: [AttachedFrame; 2],
    /// Wrenches with residuals, then the one that measures a rate; the rows scaled.
    rows: Vec<Wrench>,
    residuals: usize,
    /// The unscaled wrenches, if moments are among them.
    turned: Option<Vec<Wrench>>,
    crossed: Option<[Vec3; 2]>,
    /// The column of the rate of the loop joint.
    rate: Option<usize>,
    columns_of: Vec<JacobianColumn>,
}

impl BatchedPair {
    fn len(&self) -> usize {
        self.rows.len() + usize::from(self.crossed.is_some())
    }
}

/// The loop-closure error of the batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BatchedClosureError<R> {
    /// Largest violation along (m) and about (rad) constraint wrenches.
    pub(crate) distance: R,
    pub(crate) angle: R,
    /// 0 in lanes whose rows must not be used.
    pub(crate) usable: R,
}

impl BatchedConstraintPlan {
    /// For a mechanism, its reference frame and a characteristic length.
    pub(crate) fn of(mechanism: &Mechanism, reference: FrameId, length: f64) -> Result<Self> {
        mechanism.check_frame(reference)?;
        let columns = Columns::of(mechanism, &constraint_rows::joints_with_rate(mechanism));
        let actuated = columns.actuated.len();
        let column = |(is_actuated, place): (bool, usize)| {
            if is_actuated { place } else { actuated + place }
        };
        let n = mechanism.n();
        let size = |c: usize| Unit::of(mechanism.coordinates()[c].kind).size(length);
        let places: Vec<(usize, f64)> =
            (0..n).map(|c| (column(columns.places[c]), size(c))).collect();
        let end = |frame: FrameId, place: Pose| {
            let frame = mechanism.frame_of(frame);
            AttachedFrame { slot: frame.slot, from: (frame.slot_from_frame * place).into() }
        };
        let mut rates = columns.places[n..].iter().map(|p| column(*p));
        let mut pairs = Vec::new();
        for constraints in constraint_rows::pair_constraints(mechanism) {
            let PairConstraints { ends, frames, wrenches, crossed, measure } = constraints?;
            let ends = [0, 1].map(|i| end(mechanism.link_frame(ends[i]), frames[i]));
            let scaled = |w: &Wrench| {
                let s = 1.0 / constraint_rows::unit(*w).size(length);
                Wrench { force: w.force * s, moment: w.moment * s }
            };
            let turns = wrenches.iter().any(|w| w.moment != Vec3::ZERO);
            pairs.push(BatchedPair {
                columns_of: between(mechanism.nodes(), &places, ends[0].slot, ends[1].slot),
                ends,
                residuals: wrenches.len(),
                rows: wrenches.iter().chain(&measure).map(scaled).collect(),
                turned: turns.then_some(wrenches),
                crossed,
                rate: measure.and_then(|_| rates.next()),
            });
        }
        let target = end(reference, Pose::IDENTITY);
        let components = mechanism.dimension().components();
        Ok(Self {
            nodes: mechanism.nodes().to_vec(),
            rows: pairs.iter().map(BatchedPair::len).sum(),
            pairs,
            columns_of: between(mechanism.nodes(), &places, 0, target.slot),
            reference: target,
            components,
            length,
            actuated_scale: columns.actuated_units.iter().map(|u| u.size(length)).collect(),
            object_scale: components.iter().map(|&c| if c < 3 { length } else { 1.0 }).collect(),
            passive: columns.passive_units.len(),
        })
    }

    /// Number of rows of loop joints and contacts.
    pub(crate) fn constraint_rows(&self) -> usize {
        self.rows
    }

    /// Number of components of the reference.
    pub(crate) fn object(&self) -> usize {
        self.components.len()
    }

    /// Number of actuated columns.
    pub(crate) fn actuated(&self) -> usize {
        self.actuated_scale.len()
    }

    /// Number of all columns.
    pub(crate) fn columns(&self) -> usize {
        self.actuated() + self.passive
    }

    /// Number of frames that [`BatchedConstraintPlan::write`] needs.
    pub(crate) fn frames(&self) -> usize {
        self.nodes.len() + 1
    }

    /// Writes all rows at q, those of loop joints and contacts first, row by row.
    #[inline(always)]
    pub(crate) fn write<R: SimdFloat>(
        &self,
        q: &[R],
        frames: &mut [Frame<R>],
        rows: &mut [R],
    ) -> BatchedClosureError<R> {
        tree_batched::forward(&self.nodes, q, frames);
        rows.fill(R::splat(0.0));
        let columns = self.columns();
        let mut written = BatchedClosureError {
            distance: R::splat(0.0),
            angle: R::splat(0.0),
            usable: R::splat(1.0),
        };
        let mut from = 0;
        for tie in &self.pairs {
            let rows = &mut rows[from * columns..(from + tie.len()) * columns];
            self.tie(tie, frames, rows, &mut written);
            from += tie.len();
        }
        let tip = frames[self.reference.slot].then(&self.reference.from);
        let rows = &mut rows[from * columns..];
        let inverse = R::splat(1.0 / self.length);
        for way in &self.columns_of {
            let rate = R::splat(way.rate);
            let (v, w) = way.twist(frames, tip.p);
            let v = v.times(inverse);
            let six = [v[0], v[1], v[2], w[0], w[1], w[2]];
            for (row, &c) in rows.chunks_exact_mut(columns).zip(self.components) {
                row[way.column] = rate.mul_add(six[c], row[way.column]);
            }
        }
        written
    }

    #[inline(always)]
    fn tie<R: SimdFloat>(
        &self,
        tie: &BatchedPair,
        frames: &[Frame<R>],
        rows: &mut [R],
        written: &mut BatchedClosureError<R>,
    ) {
        /// Maximum number of rows of a pair: six constraint wrenches and the rate.
        const MOST: usize = 7;
        let k = R::splat;
        let columns = self.columns();
        let a = frames[tie.ends[0].slot].then(&tie.ends[0].from);
        let b = frames[tie.ends[1].slot].then(&tie.ends[1].from);
        let offset = b.p.minus(a.p);
        // Forces act at the second frame.
        let none = [k(0.0); 3];
        let mut wrenches = [(none, none); MOST];
        for (i, w) in tie.rows.iter().enumerate() {
            let force = turned(&a, w.force);
            wrenches[i] = (force, turned(&a, w.moment));
            if i < tie.residuals && tie.turned.is_none() {
                let open = (dot(force, offset) * k(self.length)).abs();
                written.distance = written.distance.max(open);
            }
        }
        if let Some(wrenches) = &tie.turned {
            let closure_error = closure_error(wrenches, &a, &b);
            written.distance = written.distance.max(closure_error[0]);
            written.angle = written.angle.max(closure_error[1]);
        }
        if let Some([first, second]) = tie.crossed {
            let (on_a, on_b) = (turned(&a, first), turned(&b, second));
            let normal = on_a.cross(on_b);
            let size = dot(normal, normal).sqrt();
            let inverse = k(1.0) / size;
            wrenches[tie.rows.len()] = (none, normal.times(inverse));
            let open = (k(first.dot(second)) - dot(on_a, on_b)) * inverse;
            written.angle = written.angle.max(open.abs());
            written.usable = R::select_lt(size, k(CROSSED_AXES), k(0.0), written.usable);
        }
        let wrenches = &wrenches[..tie.len()];
        for way in &tie.columns_of {
            let rate = k(way.rate);
            let (v, w) = way.twist(frames, b.p);
            for (row, (force, moment)) in rows.chunks_exact_mut(columns).zip(wrenches) {
                let power = dot(v, *force) + dot(w, *moment);
                row[way.column] = rate.mul_add(power, row[way.column]);
            }
        }
        if let Some(rate) = tie.rate {
            // Rows and columns of rates have the same scale.
            let place = (tie.rows.len() - 1) * columns + rate;
            rows[place] = rows[place] - k(1.0);
        }
    }
}

impl JacobianColumn {
    /// Velocity of the point p, and angular velocity.
    #[inline(always)]
    fn twist<R: SimdFloat>(&self, frames: &[Frame<R>], p: [R; 3]) -> ([R; 3], [R; 3]) {
        let frame = &frames[self.slot];
        let axis = [frame.x, frame.y, frame.z][self.axis];
        if self.turns { (axis.cross(p.minus(frame.p)), axis) } else { (axis, [R::splat(0.0); 3]) }
    }
}

/// The columns of the motion of slot `b` relative to slot `a`; `places` are column and scale of
/// each coordinate.
fn between(
    nodes: &[Node],
    places: &[(usize, f64)],
    mut a: usize,
    mut b: usize,
) -> Vec<JacobianColumn> {
    let mut columns_of = Vec::new();
    while a != b {
        // A parent has a smaller slot than its children.
        let (slot, sign) = if a > b { (a, -1.0) } else { (b, 1.0) };
        let node = &nodes[slot - 1];
        let mut add = |axis: usize, turns: bool, of: usize, rate: f64| {
            let (column, scale) = places[node.coordinate + of];
            columns_of.push(JacobianColumn {
                slot,
                axis,
                turns,
                column,
                rate: sign * rate * scale,
            });
        };
        match node.kind {
            NodeKind::Fixed => {}
            NodeKind::Revolute => add(2, true, 0, node.multiplier),
            NodeKind::Prismatic => add(2, false, 0, node.multiplier),
            NodeKind::Helical(pitch) => {
                add(2, true, 0, node.multiplier);
                add(2, false, 0, pitch * node.multiplier);
            }
            NodeKind::Spherical => (0..3).for_each(|i| add(i, true, i, node.multiplier)),
            NodeKind::Free => (0..6).for_each(|i| add(i % 3, i >= 3, i, 1.0)),
        }
        let next = if a > b { &mut a } else { &mut b };
        *next = node.parent;
    }
    columns_of
}

/// The loop-closure error along and about `wrenches`, evaluated lane by lane.
#[inline(always)]
fn closure_error<R: SimdFloat>(wrenches: &[Wrench], a: &Frame<R>, b: &Frame<R>) -> [R; 2] {
    let (mut distance, mut angle) = ([0.0; MAX_LANES], [0.0; MAX_LANES]);
    let (a, b) = (poses(a), poses(b));
    for l in 0..R::LANES {
        let closure_error = KinematicPair::new(0, [0, 0], [a[l], b[l]]).closure_error(wrenches);
        (distance[l], angle[l]) = (closure_error.distance, closure_error.angle);
    }
    [R::load(&distance), R::load(&angle)]
}

#[inline(always)]
fn poses<R: SimdFloat>(frame: &Frame<R>) -> [Pose; MAX_LANES] {
    let mut numbers = [[0.0; MAX_LANES]; 12];
    for (i, column) in [frame.x, frame.y, frame.z, frame.p].iter().enumerate() {
        for (j, x) in column.iter().enumerate() {
            x.store(&mut numbers[3 * i + j]);
        }
    }
    let mut poses = [Pose::IDENTITY; MAX_LANES];
    for (l, pose) in poses.iter_mut().enumerate().take(R::LANES) {
        let mut padded = AlignedPose::IDENTITY;
        for j in 0..3 {
            padded.x[j] = numbers[j][l];
            padded.y[j] = numbers[3 + j][l];
            padded.z[j] = numbers[6 + j][l];
            padded.p[j] = numbers[9 + j][l];
        }
        *pose = padded.pose();
    }
    poses
}

/// A vector of the frame, in world axes.
#[inline(always)]
fn turned<R: SimdFloat>(frame: &Frame<R>, v: Vec3) -> [R; 3] {
    frame.transform_vector([R::splat(v.x), R::splat(v.y), R::splat(v.z)])
}
