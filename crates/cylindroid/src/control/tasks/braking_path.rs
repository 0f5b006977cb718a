//! The way on which all joints, each braking at its own limit, come to rest after a step, and whether
//! bodies touch on it.
//!
//! Formula  configuration after k steps  q_k = q + dt sum v_j, v_0 = v, v_(j+1) = v_j reduced by A dt;
//!          all pairs apart at q_1, q_2, ... Steps are left out while no pair moves further than its
//!          distance:  sum_c l_c max_(h<i<=k) |q_i - q_h|_c < d(q_h), l_c the lever of coordinate c
//!          With a jerk limit v_j of `servo/jerk_limited_stop.rs`.
//!          In a closed chain the actuated joints brake and the others follow: steps are left out
//!          while  sum_c l_c |q_k - q_h|_c < d(q_h) + d(q_k)
//! Units    m, rad or m of the coordinates, s
//! Valid    obstacles that rest; levers are those of the present configuration. Closed chains away
//!          from type II singularities, between two looks without turns of the passive joints
//! Cost     a sum over the joints while all pairs are further apart than they move; otherwise at
//!          most `LOOKS` configurations. No allocation
//! Source   Fraichard & Asama, Inevitable collision states, Advanced Robotics 18 (2004), 1001-1024
//! Checked  tests/it/servo/braking_path.rs, tests/allocation/main.rs

use super::motions::Motions;
use super::options::{CollisionAvoidance, MOST_PAIRS};
use crate::collision::{CollisionModel, NearPair};
use crate::control::servo::{JerkLimitedStop, LoopMotions};
use crate::control::solver::bounds::VelocityBounds;
use crate::error::Result;
use crate::kinematics::State;
use crate::model::{Limits, Mechanism};

/// Configurations of a path at which distances are evaluated, at most; a path with more of them
/// counts as not clear.
const LOOKS: usize = 32;

/// Passive joints go so many times as far as they would at the velocities of the present
/// configuration, at most.
const BENT: f64 = 3.0;

/// Steps of a path at most: joints without deceleration never rest.
const MOST_STEPS: f64 = 1e6;

/// Memory of the paths, and what is known of the last one.
#[derive(Debug, Clone)]
pub(super) struct BrakingPath {
    /// True if the path of the last velocities is clear, after a step that ends at `expected`.
    pub(super) is_clear: bool,
    pub(super) expected: Vec<f64>,
    /// Of the obstacles.
    pub(super) revision: u64,
    /// How each coordinate comes to rest.
    joints: Vec<Braking>,
    /// A configuration of the path, and changes of the coordinates: up to it, or the largest ones of a
    /// part of the path.
    state: State,
    q: Vec<f64>,
    change: Vec<f64>,
    /// Pairs that the path may bring together, with distances, and a row of levers for each.
    doubtful: Vec<(usize, f64)>,
    levers: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    pub(super) accelerations: Vec<f64>,
    /// Of the velocities while braking; the unknowns that have them.
    pub(super) bounds: Vec<VelocityBounds>,
    pub(super) unknowns: Vec<f64>,
    far: Vec<NearPair>,
    loops: Option<Box<LoopPath>>,
}

/// What a path of a closed chain needs besides.
#[derive(Debug, Clone)]
struct LoopPath {
    motions: LoopMotions,
    /// True for the actuated ones of the coordinates and actuated loop joints.
    are_actuated: Vec<bool>,
    /// The last configuration of the path that was looked at, and the changes from it to a later one.
    last: Vec<f64>,
    moved: Vec<f64>,
    /// Distances of the doubtful pairs there.
    distances: Vec<f64>,
}

/// What a path starts from: the state, its near pairs, and the distance of all others at least.
#[derive(Clone, Copy)]
pub(super) struct Start<'a> {
    pub(super) state: &'a State,
    pub(super) near: &'a [NearPair],
    pub(super) margin: f64,
}

/// Velocities of the first step and what brakes them.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub(super) velocities: &'a [f64],
    /// Changes of the velocities in the first step, divided by its duration.
    pub(super) accelerations: &'a [f64],
    pub(super) limits: &'a [Limits],
    pub(super) dt: f64,
}

/// How a coordinate comes to rest, its first step with the velocity that is looked at.
#[derive(Debug, Clone, Copy)]
enum Braking {
    /// The way of the first step, and how much less each further one has.
    Steady { way: f64, less: f64 },
    /// The way of the first step, and the stop after it.
    JerkLimited { way: f64, stop: JerkLimitedStop },
}

impl Braking {
    fn new(velocity: f64, acceleration: f64, limits: &Limits, dt: f64) -> Self {
        let way = dt * velocity;
        if limits.jerk < f64::INFINITY {
            let stop = JerkLimitedStop::new(limits, velocity, acceleration, dt);
            Self::JerkLimited { way, stop }
        } else {
            Self::Steady { way, less: limits.acceleration * dt * dt }
        }
    }

    /// Steps until it rests.
    fn steps(&self) -> f64 {
        match self {
            Self::Steady { way: 0.0, .. } => 0.0,
            // Without an acceleration limit the first step is the last.
            Self::Steady { way, less } => (way.abs() / less).floor() + 1.0,
            Self::JerkLimited { stop, .. } => 1.0 + stop.steps(),
        }
    }

    /// Change of the coordinate after some steps.
    fn change_after(&self, steps: f64) -> f64 {
        if steps <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Steady { way, less } => {
                let own = steps.min(self.steps());
                let lost = if own > 1.0 { 0.5 * less * own * (own - 1.0) } else { 0.0 };
                way.signum() * (own * way.abs() - lost)
            }
            Self::JerkLimited { way, stop } => way + stop.way(steps - 1.0),
        }
    }

    /// The largest change between two steps, or more: a joint with a jerk limit may turn round on its
    /// way.
    fn largest_change(&self, from: f64, to: f64) -> f64 {
        match self {
            Self::Steady { .. } => (self.change_after(to) - self.change_after(from)).abs(),
            Self::JerkLimited { way, stop } => {
                let first = if from < 1.0 && to >= 1.0 { way.abs() } else { 0.0 };
                let from = (from - 1.0).max(0.0);
                first + stop.largest_change(from, (to - 1.0).max(from))
            }
        }
    }
}

impl BrakingPath {
    /// For a robot at rest, with this number of pairs.
    pub(super) fn new(mechanism: &Mechanism, motions: &Motions, pairs: usize) -> Result<Self> {
        let n = mechanism.n();
        let loops = motions.loops().map(|motions| LoopPath {
            motions: motions.clone(),
            are_actuated: motions.are_actuated(),
            last: vec![0.0; n],
            moved: vec![0.0; motions.velocities()],
            distances: Vec::with_capacity(MOST_PAIRS),
        });
        let v = motions.loops().map_or(n, LoopMotions::velocities);
        Ok(Self {
            is_clear: false,
            expected: vec![0.0; n],
            revision: 0,
            joints: Vec::with_capacity(v),
            state: mechanism.state(mechanism.home())?,
            q: vec![0.0; n],
            change: vec![0.0; v],
            doubtful: Vec::with_capacity(MOST_PAIRS),
            levers: vec![0.0; MOST_PAIRS * n],
            velocities: vec![0.0; v],
            accelerations: vec![0.0; v],
            bounds: vec![VelocityBounds::NONE; v],
            unknowns: vec![0.0; motions.unknowns()],
            far: Vec::with_capacity(pairs),
            loops: loops.map(Box::new),
        })
    }

    /// Forgets the last path.
    pub(super) const fn reset(&mut self) {
        self.is_clear = false;
    }

    /// True if the last path was clear, the obstacles are the same, and the robot is where it was to
    /// be: no body is off by more than half of the gap.
    pub(super) fn is_continued(&mut self, state: &State, collisions: &CollisionAvoidance) -> bool {
        let model = &collisions.model;
        self.change.fill(0.0);
        let off = self.change.iter_mut().zip(&self.expected).zip(state.q());
        off.for_each(|((off, expected), q)| *off = q - expected);
        let mut ways = (0..model.bodies().len()).map(|b| model.way(state, b, &self.change));
        let is_same = self.is_clear && self.revision == model.revision();
        is_same && ways.all(|way| way <= 0.5 * collisions.gap)
    }

    /// The pair that the path of these velocities may bring together.
    pub(super) fn contact(
        &mut self,
        start: Start<'_>,
        model: &mut CollisionModel,
        motion: Motion<'_>,
    ) -> Result<Option<usize>> {
        self.joints.clear();
        let all = motion.velocities.iter().zip(motion.accelerations).zip(motion.limits);
        self.joints.extend(all.map(|((v, a), limits)| Braking::new(*v, *a, limits, motion.dt)));
        if let Some(loops) = &mut self.loops {
            let joints = self.joints.iter_mut().zip(&loops.are_actuated);
            let passive = joints.filter(|(_, is_actuated)| !**is_actuated);
            passive.for_each(|(joint, _)| *joint = Braking::Steady { way: 0.0, less: 0.0 });
            if !loops.motions.set_closed(start.state.q())? {
                return Ok(None);
            }
        }
        let steps = self.joints.iter().map(Braking::steps).fold(0.0, f64::max).min(MOST_STEPS);
        if let Some(pair) = self.load_doubtful(start, model, steps)? {
            return Ok(Some(pair));
        }
        if self.doubtful.is_empty() {
            return Ok(None);
        }
        if self.loops.is_some() {
            return self.contact_of_loops(model, steps);
        }
        let mut now = 0.0;
        for _ in 0..LOOKS {
            let clear = self.clear_until(now, steps);
            if clear >= steps {
                return Ok(None);
            }
            now = clear.max(now + 1.0);
            let changes = self.change.iter_mut().zip(&self.joints);
            changes.for_each(|(change, joint)| *change = joint.change_after(now));
            self.q.copy_from_slice(start.state.q());
            start.state.mechanism().integrate_in_place(&mut self.q, &self.change, 1.0);
            self.state.set(&self.q)?;
            model.place(&self.state);
            for (pair, distance) in &mut self.doubtful {
                *distance = model.distance_of(*pair);
                // Nor is NaN a distance.
                if !(*distance > 0.0) {
                    return Ok(Some(*pair));
                }
            }
            if now >= steps {
                return Ok(None);
            }
        }
        let nearest = self.doubtful.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        Ok(nearest.map(|(pair, _)| *pair))
    }

    /// The same of a closed chain, whose doubtful pairs are loaded.
    fn contact_of_loops(
        &mut self,
        model: &mut CollisionModel,
        steps: f64,
    ) -> Result<Option<usize>> {
        let n = self.q.len();
        let Some(loops) = &mut self.loops else { return Ok(None) };
        loops.last.copy_from_slice(loops.motions.q());
        let (mut now, mut ahead) = (0.0, steps);
        for _ in 0..LOOKS {
            let to = (now + ahead).min(steps);
            for (change, joint) in self.change.iter_mut().zip(&self.joints) {
                *change = joint.change_after(to) - joint.change_after(now);
            }
            let follows = loops.motions.follow(&self.change, &mut loops.moved)?;
            loops.distances.clear();
            if follows {
                self.state.set(loops.motions.q())?;
                model.place(&self.state);
                for (pair, _) in &self.doubtful {
                    let distance = model.distance_of(*pair);
                    // Nor is NaN a distance.
                    if !(distance > 0.0) {
                        return Ok(Some(*pair));
                    }
                    loops.distances.push(distance);
                }
            }
            loops.moved.iter_mut().for_each(|moved| *moved = moved.abs());
            let between = self.doubtful.iter().zip(&loops.distances);
            let mut pairs = between.zip(self.levers.chunks_exact(n));
            let is_clear = follows
                && (ahead <= 1.0
                    || pairs.all(|(((_, d), then), row)| way_with(row, &loops.moved) < d + then));
            if is_clear {
                (now, ahead) = (to, 2.0 * ahead);
                loops.last.copy_from_slice(loops.motions.q());
                let distances = self.doubtful.iter_mut().zip(&loops.distances);
                distances.for_each(|((_, distance), then)| *distance = *then);
                if now >= steps {
                    return Ok(None);
                }
            } else if ahead <= 1.0 || !loops.motions.set_closed(&loops.last)? {
                break; // the loops cannot be followed
            } else {
                ahead = (0.5 * (to - now)).floor().max(1.0);
            }
        }
        let nearest = self.doubtful.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        Ok(nearest.map(|(pair, _)| *pair))
    }

    /// The pairs that are apart and may come together on the way, with their levers; one of them if
    /// there are too many.
    fn load_doubtful(
        &mut self,
        start: Start<'_>,
        model: &mut CollisionModel,
        steps: f64,
    ) -> Result<Option<usize>> {
        let n = self.q.len();
        if let Some(loops) = &mut self.loops {
            self.change.iter_mut().zip(&self.joints).for_each(|(change, joint)| {
                *change = joint.change_after(steps);
            });
            loops.moved.fill(0.0);
            loops.motions.add_following(&self.change, &mut loops.moved);
        }
        self.load_largest_changes(0.0, steps);
        if let Some(loops) = &self.loops {
            let all = self.change.iter_mut().zip(&loops.moved);
            all.for_each(|(change, moved)| *change = BENT * change.max(moved.abs()));
        }
        let ways = (0..model.bodies().len()).map(|b| model.way(start.state, b, &self.change));
        let furthest = 2.0 * ways.fold(0.0, f64::max);
        self.doubtful.clear();
        let near = if furthest < start.margin && start.near.len() < MOST_PAIRS {
            start.near
        } else {
            model.near(start.state, furthest, &mut self.far)?;
            &self.far
        };
        for near in near.iter().filter(|near| near.distance > 0.0 && near.distance <= furthest) {
            let place = self.doubtful.len();
            if place == MOST_PAIRS {
                return Ok(Some(near.pair));
            }
            let row = &mut self.levers[place * n..][..n];
            model.levers_into(start.state, near.pair, row);
            if near.distance <= way_with(row, &self.change) {
                self.doubtful.push((near.pair, near.distance));
            }
        }
        Ok(None)
    }

    /// The last step up to which no pair can move by its distance since that of the last look.
    fn clear_until(&mut self, now: f64, steps: f64) -> f64 {
        let (mut clear, mut beyond) = (now, steps);
        let n = self.q.len();
        while clear < beyond {
            let middle = (0.5 * (clear + beyond)).ceil();
            self.load_largest_changes(now, middle);
            let mut pairs = self.doubtful.iter().zip(self.levers.chunks_exact(n));
            if pairs.all(|((_, distance), row)| way_with(row, &self.change) < *distance) {
                clear = middle;
            } else {
                beyond = middle - 1.0;
            }
        }
        clear
    }

    /// The largest changes of the coordinates between two steps.
    fn load_largest_changes(&mut self, from: f64, to: f64) {
        let changes = self.change.iter_mut().zip(&self.joints);
        changes.for_each(|(change, joint)| *change = joint.largest_change(from, to));
    }
}

/// The way of a pair with these levers, at most, for these largest changes.
fn way_with(levers: &[f64], change: &[f64]) -> f64 {
    let parts = levers.iter().zip(change).filter(|(_, change)| **change != 0.0);
    parts.map(|(lever, change)| lever * change).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::CollisionOptions;
    use crate::control::tasks::options::TaskServoOptions;
    use crate::model::{Collision, Geometry, JointKind, JointSpec, Link};
    use crate::scalar::uniform;
    use crate::spatial::{Pose, Vec3};

    /// The positions of a joint that brakes, step by step, relative to the start.
    fn simulated(velocity: f64, acceleration: f64, limits: &Limits, dt: f64) -> Vec<f64> {
        let (mut v, mut a, mut ways) = (velocity, acceleration, vec![0.0, dt * velocity]);
        while v != 0.0 || (limits.jerk < f64::INFINITY && a.abs() > 1.001 * limits.jerk * dt) {
            let next = if limits.jerk < f64::INFINITY {
                JerkLimitedStop::new(limits, v, a, dt).next()
            } else {
                (v.abs() - limits.acceleration * dt).max(0.0).copysign(v)
            };
            (v, a) = (next, (next - v) / dt);
            ways.push(ways[ways.len() - 1] + dt * v);
        }
        ways
    }

    /// Also of joints that turn round on their way to rest, with and without limits of the jerk.
    #[test]
    fn changes_are_those_of_braking_step_by_step() {
        let mut seed = 3;
        let mut next = || 2.0 * uniform(&mut seed) - 1.0;
        let mut turns = 0;
        for round in 0..600 {
            let dt = 0.004;
            // Slow ones that brake hard turn round.
            let (v, a) =
                [(next(), 1.5 * next()), (0.05 * next().abs(), -1.5 * next().abs())][round % 2];
            let jerk = if round % 3 == 0 { f64::INFINITY } else { 10.0_f64.powf(1.0 + next()) };
            let limits = Limits { acceleration: 1.5 + next(), jerk, ..Limits::NONE };
            let joint = Braking::new(v, a, &limits, dt);
            let ways = simulated(v, a, &limits, dt);
            assert!((joint.steps() - (ways.len() - 1) as f64).abs() <= 2.0, "{joint:?}");
            let end = joint.change_after(joint.steps());
            assert!((end - ways[ways.len() - 1]).abs() < 1e-9, "{end} {joint:?}");
            let from = (0.5 * (1.0 + next()) * ways.len() as f64) as usize % ways.len();
            for from in [0, from] {
                let (mut furthest, mut is_turning) = (0.0_f64, false);
                for (to, way) in ways.iter().enumerate().skip(from) {
                    let change = joint.change_after(to as f64);
                    assert!((change - way).abs() < 1e-9, "{to}: {change} {way} {joint:?}");
                    furthest = furthest.max((way - ways[from]).abs());
                    is_turning |= furthest > 1.1 * (way - ways[from]).abs();
                    let told = joint.largest_change(from as f64, to as f64);
                    assert!(told > furthest - 1e-9, "{from} {to}: {told} {furthest} {joint:?}");
                    // The first step and what follows count apart where they go different ways.
                    let most = furthest + if from == 0 { 2.0 * dt * v.abs() } else { 0.0 };
                    assert!(told < most + 1e-9, "{from} {to}: {told} {most} {joint:?}");
                }
                turns += usize::from(is_turning);
            }
        }
        assert!(turns > 50, "{turns}");
    }

    /// A path is that of the last step where the obstacles are the same and no body is off by more than
    /// half of the gap, whichever joints put it there.
    #[test]
    fn a_path_is_continued_where_the_robot_is_nearly_where_it_was_to_be() {
        let mut builder = Mechanism::builder("slides");
        let ball = Geometry::Sphere { radius: 0.1 };
        let shape = Collision { geometry: ball.clone(), ..Collision::default() };
        builder.link(Link { collisions: vec![shape], ..Link::named("ball") });
        builder.joint(JointSpec::new("x", JointKind::Prismatic, "base", "beam"));
        builder.joint(JointSpec::new("y", JointKind::Prismatic, "beam", "ball"));
        let robot = builder.build().unwrap();
        let limits: Vec<Limits> = robot.coordinates().iter().map(|c| c.limits).collect();
        let options = TaskServoOptions::new(&robot);
        let motions = Motions::new(&robot, &options, &limits).unwrap();
        let mut model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        model.add_obstacle("ball", &ball, Pose::from_translation(Vec3::Z * 9.0)).unwrap();
        let gap = 0.02;
        let mut collisions = CollisionAvoidance { model, gap, margin: 0.1 };
        let mut path = BrakingPath::new(&robot, &motions, 1).unwrap();
        let start = [0.3, -0.2];
        path.expected.copy_from_slice(&start);
        path.revision = collisions.model.revision();
        for (x, y, expected) in [
            (0.0, 0.0, true),
            (0.49, 0.0, true),
            (-0.3, -0.19, true),
            (0.0, 0.51, false),
            (0.3, -0.21, false),
            (-0.51, 0.0, false),
        ] {
            let state = robot.state(&[start[0] + x * gap, start[1] + y * gap]).unwrap();
            path.is_clear = true;
            assert_eq!(path.is_continued(&state, &collisions), expected, "{x} {y}");
            path.is_clear = false;
            assert!(!path.is_continued(&state, &collisions));
        }
        path.is_clear = true;
        let state = robot.state(&start).unwrap();
        collisions.model.move_obstacle("ball", Pose::from_translation(Vec3::Z * 8.0)).unwrap();
        assert!(!path.is_continued(&state, &collisions));
        path.revision = collisions.model.revision();
        assert!(path.is_continued(&state, &collisions));
        path.reset();
        assert!(!path.is_continued(&state, &collisions));
    }
}
