//! Spectra of efficiencies, ellipsoids, polytopes and gradients.

use cylindroid::closure::{ClosedChain, Constraint, ConstraintBlocks, MotionSpace, Relation};
use cylindroid::linalg::{Interval, Metric};
use cylindroid::manipulability::{
    Ellipsoid, EllipsoidView, Goal, Gradient, Index, Manipulability, Measure, Metrics, Polytope,
    Spectrum, force_polytope, force_range, gradient, internal_force_manipulability,
    velocity_polytope, velocity_range,
};
use cylindroid::model::{JointKind, JointSpec};
use cylindroid::{Matrix, Mechanism, Pose, Vec3, catalogue};

use super::mechanisms::{chain, configuration, ring, tree};
use super::{
    counts, definite, error, integers, random_matrix, selection, span, sum, text, verdicts,
};
use crate::record::{Record, check};
use crate::robots::{self, Random};

/// A serial arm or a closed chain: matrices of integers of low rank, or of random numbers, with rows
/// of different sizes.
fn constraint(random: &mut Random<'_>) -> Constraint {
    let d = [2, 3, 6][random.below(3)];
    let (serial, joints) = (random.once_in(3), 1 + random.below(5));
    let (rows, passive) = (d + random.below(4), random.below(4));
    let whole = random.once_in(3);
    let mut block = |rows: usize, cols: usize| {
        if whole {
            integers(random, rows, cols, rows.min(cols).max(1))
        } else {
            random_matrix(random, rows, cols)
        }
    };
    if serial {
        return Constraint::serial(&block(d, joints + d - 1)).unwrap();
    }
    let mut actuated = block(rows, joints);
    let mut grasp = block(d, rows);
    let passive = block(rows, passive);
    if random.once_in(3) {
        // A joint that moves nothing; a component that nothing moves; a row twice.
        actuated.column_mut(0).fill(0.0);
        let first = grasp.column(0).to_vec();
        grasp.column_mut(1).copy_from_slice(&first);
    }
    Constraint::new(ConstraintBlocks { actuated, passive, grasp }).unwrap()
}

fn metrics(random: &mut Random<'_>, relation: &Relation) -> Metrics {
    let (joints, object) = (relation.joints(), relation.object());
    let mut metrics = Metrics::UNIT;
    if random.once_in(2) {
        metrics = metrics.with_object(&definite(random, object)).unwrap();
    }
    match random.below(4) {
        0 => metrics = metrics.with_joint(&definite(random, joints)).unwrap(),
        1 => {
            let limits: Vec<f64> = (0..joints).map(|_| random.power(-1.0, 1.0)).collect();
            metrics = metrics.with_velocity_limits(&limits).unwrap();
            metrics = metrics.with_torque_limits(&limits).unwrap();
        }
        _ => {}
    }
    if random.once_in(4) {
        metrics = metrics.with_wrench(&definite(random, object)).unwrap();
    }
    if random.once_in(4) {
        metrics = metrics.with_torque(&definite(random, joints)).unwrap();
    }
    metrics
}

fn spectrum(record: &mut Record, found: &Spectrum) {
    counts(record, &[found.finite.len(), found.zeros.cols(), found.infinite.cols()]);
    record.number(sum(&found.finite.iter().map(|d| d.pair.angle()).collect::<Vec<_>>()));
    record.number(span(&found.zeros) + 0.7 * span(&found.infinite));
    let squares = |x: &[f64]| sum(&x.iter().map(|a| a * a).collect::<Vec<_>>());
    let directions = found
        .finite
        .iter()
        .map(|d| squares(&d.joint) + 2.0 * squares(&d.object) + d.joint[0] * d.object[0]);
    record.number(sum(&directions.collect::<Vec<_>>()));
}

#[test]
fn spectra() {
    check("geometry_spectra", 40, |random, record| {
        let constraint = constraint(random);
        let relation = MotionSpace::of(&constraint).relation();
        let metrics = metrics(random, &relation);
        verdicts(record, &[metrics.is_dual()]);
        let Some(found) = error(record, Manipulability::of(&relation, &metrics)) else { return };
        spectrum(record, &found.kinematic);
        spectrum(record, &found.force);
        record.number(found.kinematic.volume());
        let ends = [found.kinematic.anisotropy(), found.force.largest(), found.force.smallest()];
        record.number(sum(&ends.map(|x| x.unwrap_or(0.0).min(1e6).max(1e-6).log10())));
        let (active, passive) = (found.active_force(), found.passive_force());
        counts(record, &[active.infinite.cols(), passive.zeros.cols()]);
        let angles = Index::ALL.map(|index| {
            let values = index.values(&found);
            let angles: Vec<f64> = values.iter().map(|e| e.sqrt().atan()).collect();
            sum(&angles) + values.len() as f64
        });
        record.number(sum(&angles));
    });
}

#[test]
fn internal_forces() {
    check("geometry_internal", 40, |random, record| {
        let constraint = constraint(random);
        let torque = Metric::new("torque", &definite(random, constraint.actuated())).unwrap();
        let force = Metric::new("force", &definite(random, constraint.rows())).unwrap();
        let torque = random.once_in(2).then_some(&torque);
        let force = random.once_in(2).then_some(&force);
        let found = internal_force_manipulability(&constraint, torque, force);
        if let Some(found) = error(record, found) {
            spectrum(record, &found);
        }
        let wrong = Metric::diagonal("wrong", &[1.0; 17]).unwrap();
        let _ = error(record, internal_force_manipulability(&constraint, Some(&wrong), force));
        let _ = error(record, internal_force_manipulability(&constraint, torque, Some(&wrong)));
    });
}

/// Squared, so that signs and equal axes do not matter.
fn ellipsoid(record: &mut Record, found: &Ellipsoid) {
    let sizes = [found.components(), found.semi_axes.cols(), found.unbounded.cols()];
    counts(record, &sizes);
    record.number(span(&found.semi_axes) + 0.7 * span(&found.unbounded));
}

#[test]
fn ellipsoids() {
    check("geometry_ellipsoids", 40, |random, record| {
        let d = [2, 3, 6][random.below(3)];
        let (axes, endless) = (1 + random.below(d), random.below(3));
        let mut scale: Vec<f64> = (0..d).map(|_| random.power(-2.0, 2.0)).collect();
        if random.once_in(4) {
            // So small that it counts as zero, or nearly so.
            scale[d - 1] = random.power(-10.0, -6.0);
        }
        let mut semi_axes = if random.once_in(3) {
            integers(random, d, axes, 2)
        } else {
            random_matrix(random, d, axes)
        };
        let mut unbounded = match random.below(3) {
            0 => random_matrix(random, d, endless.min(d - 1)),
            1 => selection(&[random.below(d)], d).transpose(),
            _ => Matrix::zeros(d, 0),
        };
        for (i, size) in scale.iter().enumerate() {
            (0..axes).for_each(|j| semi_axes[(i, j)] *= size);
            (0..unbounded.cols()).for_each(|j| unbounded[(i, j)] *= size);
        }
        if random.once_in(4) {
            (0..axes).for_each(|j| semi_axes[(0, j)] = 0.0);
        }
        let whole = Ellipsoid { semi_axes, unbounded };
        let choices = [vec![0], vec![1, 0], (0..d).rev().collect(), vec![0, 0], vec![0, d]];
        for components in &choices {
            for view in EllipsoidView::ALL {
                if let Some(found) = error(record, whole.seen(view, components)) {
                    ellipsoid(record, &found);
                }
            }
        }
    });
}

#[test]
fn ellipsoids_of_relations() {
    check("geometry_relations", 30, |random, record| {
        let relation = MotionSpace::of(&constraint(random)).relation();
        let metrics = metrics(random, &relation);
        let Some(found) = error(record, Manipulability::of(&relation, &metrics)) else { return };
        for spectrum in [&found.kinematic, &found.force] {
            let whole = Ellipsoid::of(spectrum);
            if whole.semi_axes.max_abs() < 1e3 {
                ellipsoid(record, &whole);
                ellipsoid(record, &whole.section(&[1]).unwrap());
            }
        }
        let map = random_matrix(random, 2, relation.object());
        let own = metrics.for_task(&map).unwrap();
        let task = relation.task(&map).unwrap();
        if let Some(found) = error(record, Manipulability::of(&task, &own)) {
            spectrum(record, &found.kinematic);
            spectrum(record, &found.force);
        }
        let _ = error(record, Manipulability::of(&task, &metrics));
        let bad = [0.0, -1.0, f64::NAN, f64::INFINITY][random.below(4)];
        let _ = error(record, Metrics::UNIT.with_velocity_limits(&[1.0, bad]));
        let _ = error(record, Metrics::UNIT.with_torque_limits(&[bad]));
    });
}

fn limits(random: &mut Random<'_>, count: usize) -> Vec<Interval> {
    let one_sided = random.once_in(3);
    let least = if one_sided { 0.0 } else { -2.0 };
    let mut one = || Interval {
        lower: [least, -1.0, -1.0, -random.power(-1.0, 1.0)][random.below(4)],
        upper: [1.0, 1.0, if one_sided { 2.0 } else { 0.0 }, random.power(-1.0, 1.0)]
            [random.below(4)],
    };
    (0..count).map(|_| one()).collect()
}

fn polytope(record: &mut Record, found: &Polytope) {
    let hull = &found.hull;
    let complete = usize::from(hull.complete);
    counts(record, &[hull.vertices.len(), hull.facets.len(), complete, hull.span.cols()]);
    let spans = span(&found.unbounded) + 0.7 * span(&hull.span);
    // Without their order.
    let squares = hull.vertices.iter().map(|v| {
        let size: f64 = v.iter().enumerate().map(|(i, x)| x * x / (i as f64 + 1.3)).sum();
        size.min(1e6)
    });
    let offsets: f64 = hull.facets.iter().map(|f| f.offset * f.offset).sum();
    record.number(squares.sum::<f64>() + offsets + spans);
}

#[test]
fn polytopes() {
    check("geometry_polytopes", 60, |random, record| {
        let constraint = constraint(random);
        let whole = MotionSpace::of(&constraint).relation();
        let components = [vec![0], vec![0, 1], vec![1, 0]][random.below(3)].clone();
        let relation = whole.task(&selection(&components, whole.object())).unwrap();
        let limits = limits(random, relation.joints());
        for found in [velocity_range(&whole, &limits), force_range(&whole, &limits)] {
            let Some(found) = error(record, found) else { continue };
            counts(record, &[found.iter().filter(|r| r.lower.is_infinite()).count()]);
            let ends: Vec<f64> = found
                .iter()
                .filter(|r| r.lower.is_finite())
                .map(|r| r.lower + 3.0 * r.upper)
                .collect();
            record.number(sum(&ends));
        }
        if let Some(found) = error(record, velocity_polytope(&relation, &limits)) {
            polytope(record, &found);
        }
        if let Some(found) = error(record, force_polytope(&relation, &limits)) {
            polytope(record, &found);
        }
        let mut bad = limits;
        let last = bad.len() - 1;
        bad[last].upper = [f64::INFINITY, -1.0, f64::NAN][random.below(3)];
        let _ = error(record, velocity_range(&whole, &bad));
        let _ = error(record, force_polytope(&whole, &bad[1..]));
    });
}

fn slopes(record: &mut Record, found: &Gradient) {
    match found {
        Gradient::Exists { value, gradient, error } => {
            let size = value.abs().max(1e-6);
            record.number(size.log10() + sum(gradient) / size);
            if *error > 0.0 {
                record.number(1e3 * error / size);
            }
        }
        Gradient::Repeated { value, multiplicity } => {
            counts(record, &[*multiplicity]);
            record.number(*value);
        }
        Gradient::Nothing => text(record, "nothing"),
    }
}

fn gradients(record: &mut Record, mechanism: &Mechanism, q: &[f64], random: &mut Random<'_>) {
    let state = mechanism.state(q).unwrap();
    let d = mechanism.dimension().components().len();
    let map = match random.below(3) {
        0 => Some(random_matrix(random, 2, d)),
        1 => Some(selection(&[0], d)),
        _ => None,
    };
    let mut metrics = Metrics::UNIT;
    if random.once_in(2) {
        let size = map.as_ref().map_or(d, Matrix::rows);
        metrics = metrics.with_object(&definite(random, size)).unwrap();
    }
    if random.once_in(2) {
        let joints = ClosedChain::of(&state, None, None).unwrap().constraint.actuated();
        metrics = metrics.with_joint(&definite(random, joints)).unwrap();
    }
    let goal = Goal { task: map.as_ref(), ..Goal::default() };
    for measure in Measure::ALL {
        if let Some(found) = error(record, gradient(&state, goal, &metrics, measure)) {
            slopes(record, &found);
        }
    }
}

#[test]
fn gradients_of_trees() {
    check("geometry_gradients", 64, |random, record| {
        let mechanism = match random.below(4) {
            0 => robots::of_catalogue(random, false),
            1 => chain(random),
            _ => tree(random, false),
        };
        let q = configuration(random, &mechanism);
        gradients(record, &mechanism, &q, random);
    });
}

#[test]
fn gradients_of_loops() {
    check("geometry_loop_gradients", 20, |random, record| {
        let (mechanism, q) = match random.below(4) {
            0 => {
                let ring = ring(random);
                let q = configuration(random, &ring);
                (ring, q)
            }
            1 => {
                let bars = robots::five_bar(random);
                let q = bars.home().to_vec();
                (bars, q)
            }
            _ => {
                let name = ["five-bar", "3rrr", "stewart", "four-bar"][random.below(4)];
                let mechanism = catalogue::load(name).unwrap();
                let q = mechanism.home().to_vec();
                (mechanism, q)
            }
        };
        gradients(record, &mechanism, &q, random);
    });
}

/// Slides at right angles: all efficiencies are equal, or nearly so, or there is none.
#[test]
fn repeated_efficiencies() {
    check("geometry_repeated", 32, |random, record| {
        let count = random.below(4);
        let mut builder = Mechanism::builder("gantry");
        builder.joint(JointSpec::new("fixed", JointKind::Fixed, "world", "l0"));
        for (i, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate().take(count) {
            builder.joint(JointSpec {
                axis,
                ..JointSpec::new(
                    &format!("s{i}"),
                    JointKind::Prismatic,
                    &format!("l{i}"),
                    &format!("l{}", i + 1),
                )
            });
        }
        let last = format!("l{count}");
        builder.frame("tip", &last, Pose::IDENTITY).tool("tip").reference("tip");
        let gantry = builder.build().unwrap();
        let state = gantry.state(&vec![0.1; count]).unwrap();
        let weights: Vec<f64> = (0..count)
            .map(|_| 1.0 + [0.0, 0.0, 1.0, random.power(-8.0, -6.0)][random.below(4)])
            .collect();
        let metrics = Metrics::UNIT.with_joint(&Matrix::diagonal(&weights)).unwrap();
        for measure in Measure::ALL {
            if let Some(found) = error(record, gradient(&state, Goal::default(), &metrics, measure))
            {
                slopes(record, &found);
            }
        }
    });
}
