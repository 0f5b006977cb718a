//! Coordinate partitioning: the passive joints of a closed chain as functions of the actuated ones.
//!
//! Formula  C_p s_p + C_a s_a = -r (rows of loops and contacts, r their residuals), solved for each
//!          set of loops that share joints by itself: `coordinate_partitioning/coupled_loops.rs`
//! Units    rows and columns of lengths divided by the characteristic length; rates outside in
//!          rad/s and m/s
//! Valid    where all ranks are clear and the actuated joints take a large share of every motion;
//!          says so elsewhere, where `actuation_map.rs` holds. No allocation
//! Why so   the actuation map of regular configurations, at a tenth of the time; linear in the number
//!          of loops that share no joints
//! Source   Wehage & Haug 1982
//! Checked  tests in this file

mod coupled_loops;

use super::limb_graph::Sets;
use crate::closure::constraint::constraint_rows::{
    ConstraintRow, ConstraintRows, for_each_rate, joints_with_rate, rate_unit,
};
use crate::closure::constraint::loop_closure_error::LoopClosureError;
use crate::closure::constraint::velocity_constraint::Unit;
use crate::error::Result;
use crate::kinematics::State;
use crate::model::{LoopJoint, Mechanism};
use coupled_loops::{CoupledLoops, Velocity};

/// The loop constraints at a configuration, solved for the passive joints.
#[derive(Debug, Clone)]
pub(crate) struct CoordinatePartitioning {
    state: State,
    constraints: ConstraintRows,
    rows: Vec<ConstraintRow>,
    /// The place of each row in its set.
    row_places: Vec<usize>,
    /// Loops that share joints; the joints of no loop are a set too.
    sets: Vec<CoupledLoops>,
    /// The set of each loop joint and contact; `None` if no joint moves it.
    set_of_pair: Vec<Option<usize>>,
    /// The set of each of the n coordinates and e actuated loop joints, and the column in it; `None`
    /// if locked.
    columns: Vec<Option<(usize, usize)>>,
    /// The place among them of each loop joint of one coordinate; `None` if it is passive.
    loop_places: Vec<Option<usize>>,
    /// Lower bound of the actuated share of a motion at the configuration solved last.
    least_share: f64,
}

impl CoordinatePartitioning {
    /// For the loops and contacts of a mechanism; the coordinates `locked` are fixed.
    pub(crate) fn new(mechanism: &Mechanism, locked: &[usize]) -> Result<Self> {
        let constraints = ConstraintRows::of(mechanism)?;
        let state = mechanism.state(mechanism.home())?;
        let loops = joints_with_rate(mechanism);
        let mut actuated = mechanism.n()..;
        let loop_places: Vec<Option<usize>> =
            loops.iter().map(|l| if l.actuated { actuated.next() } else { None }).collect();
        let velocities = velocities(mechanism, &loops, locked);

        let mut rows = Vec::with_capacity(constraints.most_rows().sum());
        constraints.load(&state, &mut rows);
        // Joints that move the same loop joint or contact belong together: the first one of each.
        let mut together = Sets::new(velocities.len());
        let mut first_of_pair = vec![None; constraints.most_rows().count()];
        let mut join = |pair: usize, place: usize| {
            if velocities[place].is_some() {
                together.merge(place, *first_of_pair[pair].get_or_insert(place));
            }
        };
        for_each_rate(&state, &rows, |i, coordinate, _| join(rows[i].pair, coordinate));
        for row in &rows {
            if let Some(place) = row.rate_of.and_then(|k| loop_places[k]) {
                join(row.pair, place);
            }
        }

        // Sets in the order of their first joints; that of the joints of no loop has no first one.
        let mut in_loops = vec![false; velocities.len()];
        first_of_pair.iter().flatten().for_each(|&place| in_loops[together.of(place)] = true);
        let mut firsts: Vec<Option<usize>> = Vec::new();
        let mut members: Vec<[Vec<Velocity>; 2]> = Vec::new();
        let mut set_of = vec![None; velocities.len()];
        for (place, velocity) in velocities.into_iter().enumerate() {
            let Some((is_actuated, velocity)) = velocity else { continue };
            let first = Some(together.of(place)).filter(|&first| in_loops[first]);
            let set = firsts.iter().position(|f| *f == first).unwrap_or_else(|| {
                firsts.push(first);
                members.push(Default::default());
                members.len() - 1
            });
            set_of[place] = Some(set);
            members[set][usize::from(is_actuated)].push(velocity);
        }
        let set_of_pair: Vec<Option<usize>> =
            first_of_pair.into_iter().map(|first| first.and_then(|p: usize| set_of[p])).collect();
        let mut most_rows = vec![0; members.len()];
        for (set, rows) in set_of_pair.iter().zip(constraints.most_rows()) {
            set.iter().for_each(|&set| most_rows[set] += rows);
        }
        let sets: Vec<CoupledLoops> = members
            .into_iter()
            .zip(most_rows)
            .map(|([passive, actuated], t)| CoupledLoops::new(passive, actuated, t))
            .collect();
        let mut columns = vec![None; set_of.len()];
        for (set, loops) in sets.iter().enumerate() {
            for (column, velocity) in loops.velocities().iter().enumerate() {
                columns[velocity.place] = Some((set, column));
            }
        }
        Ok(Self {
            state,
            constraints,
            row_places: Vec::with_capacity(rows.len()),
            rows,
            sets,
            set_of_pair,
            columns,
            loop_places,
            least_share: 0.0,
        })
    }

    /// Number of coordinates and actuated loop joints.
    pub(crate) fn velocities(&self) -> usize {
        self.columns.len()
    }

    /// Lower bound of the actuated share of all motions at the configuration solved last [-].
    pub(crate) fn least_share(&self) -> f64 {
        self.least_share
    }

    /// The mechanism at the configuration loaded last.
    pub(crate) fn state(&self) -> &State {
        &self.state
    }

    /// Computes the constraint rows at `q`.
    ///
    /// # Errors
    /// A `q` of the wrong size or with a non-finite entry.
    pub(crate) fn load(&mut self, q: &[f64]) -> Result<LoopClosureError> {
        self.state.set(q)?;
        let closure_error = self.constraints.load(&self.state, &mut self.rows);
        let length = self.state.mechanism().reach();
        let Self { state, rows, row_places, sets, set_of_pair, columns, loop_places, .. } = self;
        // Rates of passive loop joints add no constraint.
        rows.retain(|row| {
            set_of_pair[row.pair].is_some() && row.rate_of.is_none_or(|k| loop_places[k].is_some())
        });
        sets.iter_mut().for_each(CoupledLoops::clear);
        row_places.clear();
        for row in rows.iter() {
            let set = set_of_pair[row.pair].map(|set| &mut sets[set]);
            row_places.extend(set.map(|set| set.push_row(row.unit.size(length), row.residual)));
        }
        let mut add = |i: usize, place: usize, rate: f64| {
            if let Some((set, column)) = columns[place] {
                sets[set].add(row_places[i], column, rate);
            }
        };
        for_each_rate(state, rows, &mut add);
        for (i, row) in rows.iter().enumerate() {
            if let Some(place) = row.rate_of.and_then(|k| loop_places[k]) {
                add(i, place, -1.0);
            }
        }
        Ok(closure_error)
    }

    /// Solves the loaded rows for the passive joints, `weights` for the actuated ones of the n + e
    /// (or none); false where a rank is not clear, or where the actuated joints may take a small
    /// share of a motion.
    pub(crate) fn solve(&mut self, weights: &[f64]) -> bool {
        let mut largest = 0.0_f64;
        for set in &mut self.sets {
            let Some(dependence) = set.solve(weights) else { return false };
            largest = largest.max(dependence);
        }
        // The actuated share of a motion is at least 1 / sqrt(1 + |T|^2), T that of the joints that
        // depend on the actuated ones: the largest of the sets, which share no joint.
        self.least_share = (1.0 + largest).sqrt().recip();
        true
    }

    /// d: number of independent actuated motions.
    pub(crate) fn motions(&self) -> usize {
        self.sets.iter().map(CoupledLoops::motions).sum()
    }

    /// Motion `j` of the d: the rates of the n coordinates and e loop joints for y = e_j.
    pub(crate) fn motion_into(&mut self, j: usize, rates: &mut [f64]) {
        rates.fill(0.0);
        if let Some((set, j)) = set_of(&mut self.sets, j, CoupledLoops::motions) {
            set.motion_into(j, rates);
        }
    }

    /// Number of motions of the passive joints alone.
    pub(crate) fn passive_motions(&self) -> usize {
        self.sets.iter().map(CoupledLoops::passive_motions).sum()
    }

    /// Motion `j` of them, of unit norm (scaled).
    pub(crate) fn passive_motion_into(&mut self, j: usize, rates: &mut [f64]) {
        rates.fill(0.0);
        if let Some((set, j)) = set_of(&mut self.sets, j, CoupledLoops::passive_motions) {
            set.passive_motion_into(j, rates);
        }
    }

    /// The change of the n coordinates and e loop joints that closes the loops to first order, in two
    /// parts: that of the passive joints alone, `passive_step`, and that of the actuated ones with
    /// the passive ones that follow them, `actuated_step`; zero without more actuated joints than degrees
    /// of freedom.
    pub(crate) fn correction_into(&mut self, passive_step: &mut [f64], actuated_step: &mut [f64]) {
        passive_step.fill(0.0);
        actuated_step.fill(0.0);
        for set in &mut self.sets {
            set.correction_into(passive_step, actuated_step);
        }
    }
}

/// The n coordinates and e actuated loop joints, with true for actuated ones; `None` if locked.
fn velocities(
    mechanism: &Mechanism,
    loops: &[&LoopJoint],
    locked: &[usize],
) -> Vec<Option<(bool, Velocity)>> {
    let length = mechanism.reach();
    let own = mechanism.coordinates().iter().map(|c| (c.actuated, Unit::of(c.kind)));
    let actuated = loops.iter().filter(|l| l.actuated).map(|l| (true, rate_unit(l)));
    own.chain(actuated)
        .enumerate()
        .map(|(place, (is_actuated, unit))| {
            let velocity = Velocity { place, scale: unit.size(length) };
            (!locked.contains(&place)).then_some((is_actuated, velocity))
        })
        .collect()
}

/// The set of motion `j` of all, and the place of the motion among those of the set.
fn set_of(
    sets: &mut [CoupledLoops],
    mut j: usize,
    motions: fn(&CoupledLoops) -> usize,
) -> Option<(&mut CoupledLoops, usize)> {
    for set in sets {
        let count = motions(set);
        if j < count {
            return Some((set, j));
        }
        j -= count;
    }
    None
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::closure::ActuationMap;
    use crate::closure::assemble;
    use crate::linalg::{Matrix, Svd, norm};
    use crate::model::catalogue;
    use crate::model::formats::toml;
    use crate::scalar::uniform;
    use crate::tolerance::MIN_ACTUATED_SHARE;

    /// Columns of both span the same space: each is its projection on the other.
    fn same_span(a: &Matrix, b: &Matrix, tolerance: f64, of: &str) {
        assert_eq!(a.cols(), b.cols(), "{of}");
        let both = Svd::of(&Matrix::hstack(a.rows(), &[a, b]));
        let own = Svd::of(a);
        for j in 0..a.cols() {
            assert!(own.value(j) > 1e-3 * own.value(0), "{of}");
        }
        for j in a.cols()..both.len() {
            assert!(both.value(j) < tolerance * both.value(0), "{of}: {}", both.value(j));
        }
    }

    /// The motions are those of the actuation map, unit y has actuated rates of weighted length
    /// one, and the correction closes the loops to second order.
    #[test]
    fn it_is_the_actuation_map_of_regular_configurations() {
        let mut state = 7_u64;
        let mut next = move || 2.0 * uniform(&mut state) - 1.0;
        let mut solved = 0;
        let robots = catalogue::names().iter().map(|name| catalogue::load(name).unwrap());
        for mechanism in robots.chain([parallelograms()]).filter(Mechanism::is_closed) {
            let name = mechanism.name();
            let n = mechanism.n();
            let mut partitioning = CoordinatePartitioning::new(&mechanism, &[]).unwrap();
            let m = partitioning.velocities();
            for round in 0..20 {
                let guess: Vec<f64> = mechanism.home().iter().map(|x| x + 0.2 * next()).collect();
                let Ok(found) = assemble(&mechanism, &guess, &[]) else { continue };
                let weights: Vec<f64> = match round % 2 {
                    0 => Vec::new(),
                    _ => (0..n).map(|_| 1.0 + 0.8 * next()).collect(),
                };
                let at = mechanism.state(&found.q).unwrap();
                let map = ActuationMap::of(&at, &weights, &[]).unwrap();
                partitioning.load(&found.q).unwrap();
                if !partitioning.solve(&weights) {
                    continue;
                }
                solved += 1;
                let d = partitioning.motions();
                let mut motions = Matrix::zeros(m, d);
                for j in 0..d {
                    partitioning.motion_into(j, motions.column_mut(j));
                    // W^(1/2) times the actuated rates has length one.
                    let y = map.project(motions.column(j));
                    assert!((norm(&y) - 1.0).abs() < 1e-9, "{name}: {}", norm(&y));
                }
                let k = partitioning.passive_motions();
                let mut idle = Matrix::zeros(m, k);
                for j in 0..k {
                    partitioning.passive_motion_into(j, idle.column_mut(j));
                }
                same_span(&motions, &map.motions, 1e-8, name);
                if k > 0 {
                    same_span(&idle, &map.uncontrolled, 1e-8, name);
                } else {
                    assert_eq!(map.uncontrolled.cols(), 0, "{name}");
                }
                assert!(map.shares.iter().all(|s| *s >= MIN_ACTUATED_SHARE), "{name}");

                let open: Vec<f64> = found.q.iter().map(|x| x + 1e-5 * next()).collect();
                let gap =
                    |error: LoopClosureError| error.distance / mechanism.reach() + error.angle;
                let before = gap(partitioning.load(&open).unwrap());
                assert!(partitioning.solve(&weights), "{name}");
                let (mut change, mut actuated_step) = (vec![0.0; m], vec![0.0; m]);
                partitioning.correction_into(&mut change, &mut actuated_step);
                change.iter_mut().zip(&actuated_step).for_each(|(c, d)| *c += d);
                let closer = mechanism.integrate(&open, &change[..n], 1.0).unwrap();
                let after = gap(partitioning.load(&closer).unwrap());
                assert!(after < 1e-3 * before + 1e-13, "{name}: {before:e} to {after:e}");
            }
        }
        assert_eq!(solved, 9 * 20);
    }

    /// Two parallelograms in series, each turned by its own joint, an arm between them and one of a
    /// driven and a passive joint at the end.
    fn parallelograms() -> Mechanism {
        let joint = |name: &str, between: [&str; 2], origin: [f64; 2], actuated: bool| {
            format!(
                "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nbetween = {between:?}\n\
                 origin = {origin:?}\nactuated = {actuated}\n"
            )
        };
        let text = [
            "name = \"parallelograms\"\ndimension = 2\nreference = \"hand\"\n".to_owned(),
            joint("q1", ["ground", "l1"], [0.0, 0.0], true),
            joint("a1", ["l1", "c1"], [0.02, 0.1], false),
            joint("b1", ["ground", "r1"], [0.1, 0.0], false),
            joint("d1", ["r1", "c1"], [0.12, 0.1], false),
            joint("elbow", ["c1", "base"], [0.02, 0.15], true),
            joint("q2", ["base", "l2"], [0.0, 0.2], true),
            joint("a2", ["l2", "c2"], [0.03, 0.3], false),
            joint("b2", ["base", "r2"], [0.1, 0.2], false),
            joint("d2", ["r2", "c2"], [0.14, 0.3], false),
            joint("wrist", ["c2", "palm"], [0.03, 0.4], true),
            joint("finger", ["palm", "hand"], [0.03, 0.5], false),
        ];
        toml::parse(&text.concat(), Path::new("parallelograms.toml")).unwrap()
    }

    /// A driven wedge lifts a slider: their rates are 1 and the slope, so that the actuated share of
    /// the motion is 1 / sqrt(1 + slope^2).
    #[test]
    fn the_share_of_a_wedge_is_that_of_its_slope() {
        for slope in [0.1, 0.5, 2.0] {
            let joint = |name: &str, between: [&str; 2], axis: [f64; 2], actuated: bool| {
                format!(
                    "[[joint]]\nname = \"{name}\"\ntype = \"prismatic\"\nbetween = {between:?}\n\
                     axis = {axis:?}\nactuated = {actuated}\n"
                )
            };
            let text = [
                "name = \"wedge\"\ndimension = 2\nreference = \"lift\"\n".to_owned(),
                joint("drive", ["ground", "wedge"], [1.0, 0.0], true),
                joint("guide", ["ground", "lift"], [0.0, 1.0], false),
                joint("slope", ["wedge", "lift"], [1.0, -slope], false),
            ];
            let wedge = toml::parse(&text.concat(), Path::new("wedge.toml")).unwrap();
            let mut partitioning = CoordinatePartitioning::new(&wedge, &[]).unwrap();
            partitioning.load(wedge.home()).unwrap();
            assert!(partitioning.solve(&[]), "{slope}");
            let expected = 1.0 / slope.hypot(1.0);
            let found = partitioning.least_share();
            assert!((found - expected).abs() < 1e-12, "{slope}: {found}");
        }
    }

    /// Loops that share no joint are solved by themselves, the joints of none besides.
    #[test]
    fn loops_that_share_no_joint_are_apart() {
        let sets = |mechanism: &Mechanism, locked: &[usize]| {
            let partitioning = CoordinatePartitioning::new(mechanism, locked).unwrap();
            let mut sizes: Vec<usize> =
                partitioning.sets.iter().map(|set| set.velocities().len()).collect();
            sizes.sort_unstable();
            sizes
        };
        assert_eq!(sets(&parallelograms(), &[]), [3, 3, 3]);
        assert_eq!(sets(&catalogue::load("stewart").unwrap(), &[]).len(), 1);
    }
}
