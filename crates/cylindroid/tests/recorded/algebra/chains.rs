//! Mechanisms as matrices: mobility, polytopes, grasps, steps of inverse kinematics, batches.

use cylindroid::closure::{
    ClosedChain, Constraint, ConstraintBlocks, FingerContact, Friction, GraspMetric,
    MobilityCounts, MotionSpace, Relation, Singularities, WrenchSpace, grasp_quality,
};
use cylindroid::ik::{Analytic, Budget, Goal, IkOptions, Task, solve};
use cylindroid::kinematics::KinematicsBatch;
use cylindroid::linalg::{Cut, Hull, Interval};
use cylindroid::manipulability::{
    BatchOptions, Manipulability, ManipulabilityBatch, Metrics, force_polytope, force_range,
    velocity_polytope, velocity_range,
};
use cylindroid::model::{ContactCurvature, JointKind, JointSpec, Limits};
use cylindroid::{Matrix, Mechanism, Pose, ReferenceFrame, Rotation, Vec3, catalogue};

use super::{KINDS, Sums, any, plain, sum};
use crate::record::{Record, check};
use crate::robots::{Random, five_bar, of_catalogue, robot, spatial_loop};

fn of_cut(sums: &mut Sums, cut: &Cut) {
    sums.count(cut.rank.rank);
    sums.size(cut.rank.threshold);
    sums.size(cut.kept);
    if cut.dropped > 1e-12 && cut.dropped > 1e-11 * cut.kept {
        sums.size(cut.dropped);
    }
}

/// Blocks of any matrices; regular ones more often.
fn constraint(random: &mut Random<'_>) -> Constraint {
    let (t, a) = (random.below(9), random.below(7));
    let (p, d) = (random.below(7), random.below(7));
    let mut one = |m: usize, n: usize| {
        if m * n == 0 {
            return Matrix::zeros(m, n);
        }
        let kind = random.below(2 * KINDS);
        match kind {
            // Entries of one unit.
            5 => plain(random, m, n),
            _ => any(random, kind, m, n),
        }
    };
    let blocks = ConstraintBlocks { actuated: one(t, a), passive: one(t, p), grasp: one(d, t) };
    Constraint::new(blocks).unwrap()
}

#[test]
fn mobility_of_matrices() {
    check("algebra_mobility", 130, |random, record| {
        let constraint = constraint(random);
        let motions = MotionSpace::of(&constraint);
        let relation = motions.relation();
        record.word(&(motions.dof(), motions.hyperstatic(), motions.gruebler_kutzbach()));
        let counts = relation.dimensions();
        let counts = [counts.relation, counts.coordinate, counts.redundancy, counts.indeterminacy]
            .into_iter()
            .chain([counts.internal, counts.zero_torque]);
        record.word(&counts.map(|c| format!("{c:02}")).collect::<String>());
        let mut sums = Sums::default();
        of_cut(&mut sums, &motions.cut());
        sums.size(motions.tolerance());
        relation.cuts().iter().for_each(|cut| of_cut(&mut sums, cut));
        sums.write(record);
        let counts = MobilityCounts::of(&motions, &relation);
        let d = Singularities::of(&motions, &relation, &counts).distances;
        let mut sums = Sums::default();
        for distance in [d.type_i, d.type_ii, d.configuration_space, d.passive] {
            sums.size(distance);
        }
        let all = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
        all.kinematic.values().into_iter().for_each(|value| sums.size(value));
        relation.finite_pairs().iter().for_each(|p| sums.number(p.0 + 0.3 * p.1));
        sums.write(record);
        record.number(sum(motions.basis().as_slice()));
        for parts in [relation.motions(), relation.forces()] {
            let mut sums = Sums::default();
            for part in [&parts.zero, &parts.infinite, &parts.joint, &parts.object] {
                sums.scaled(part.as_slice());
            }
            sums.write(record);
        }
    });
}

/// Of a serial or a closed chain, with an object of at most three coordinates.
fn relation(random: &mut Random<'_>) -> Relation {
    let (d, n) = (1 + random.below(3), 1 + random.below(6));
    if random.once_in(2) {
        let kind = [0, 8, 10, 13, 13][random.below(5)];
        let jacobian = any(random, kind, d, n);
        return MotionSpace::of(&Constraint::serial(&jacobian).unwrap()).relation();
    }
    let (t, p) = (d + random.below(4), random.below(5));
    let blocks = ConstraintBlocks {
        actuated: plain(random, t, n),
        passive: plain(random, t, p),
        grasp: plain(random, d, t),
    };
    MotionSpace::of(&Constraint::new(blocks).unwrap()).relation()
}

fn of_hull(record: &mut Record, hull: &Hull) {
    record.word(&(hull.vertices.len(), hull.facets.len(), hull.span.cols(), hull.complete));
    let offsets: Vec<f64> = hull.facets.iter().map(|f| f.offset).collect();
    let normals: Vec<f64> = hull.facets.iter().flat_map(|f| f.normal.clone()).collect();
    let corners = hull.facets.iter().flat_map(|f| f.vertices.iter().map(|&v| v as f64));
    let corners: Vec<f64> = corners.collect();
    let gaps = hull.facets.iter().filter(|f| f.gap < 1e-8).count();
    record.word(&gaps);
    record.number(offsets.iter().sum::<f64>() + 0.3 * offsets.iter().map(|x| x * x).sum::<f64>());
    record.number(sum(&hull.polygon().concat()));
    record.number(sum(&[&offsets, &hull.vertices.concat(), &normals, &corners].map(|x| sum(x))));
}

#[test]
fn polytopes() {
    check("algebra_polytopes", 100, |random, record| {
        let relation = relation(random);
        let mut limit = || {
            let (lower, upper) = (random.within(0.1, 2.0), random.within(0.1, 2.0));
            match random.below(6) {
                0 => Interval { lower: 0.0, upper },
                1 => Interval { lower: -lower, upper: 0.0 },
                2 => Interval::symmetric(1.0),
                _ => Interval { lower: -lower, upper },
            }
        };
        let limits: Vec<Interval> = (0..relation.joints()).map(|_| limit()).collect();
        let mut sums = Sums::default();
        for ends in [velocity_range(&relation, &limits), force_range(&relation, &limits)] {
            ends.unwrap().iter().flat_map(|i| [i.lower, i.upper]).for_each(|x| sums.size(x));
        }
        sums.write(record);
        for found in [velocity_polytope(&relation, &limits), force_polytope(&relation, &limits)] {
            let found = found.unwrap();
            record.word(&found.unbounded.cols());
            of_hull(record, &found.hull);
        }
    });
}

/// What is refused, and what is allowed just so.
#[test]
fn intervals() {
    check("algebra_intervals", 40, |random, record| {
        let ends = [-1.0, 0.0, 2.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-3];
        let limit = Interval { lower: ends[random.below(7)], upper: ends[random.below(7)] };
        let one = MotionSpace::of(&Constraint::serial(&plain(random, 1, 1)).unwrap()).relation();
        record.word(&limit.is_around_zero());
        match velocity_range(&one, &[limit]) {
            Ok(ends) => record.numbers(&[ends[0].lower, ends[0].upper]),
            Err(error) => record.word(&error.to_string().len()),
        }
    });
}

#[test]
fn grasps() {
    check("algebra_grasps", 70, |random, record| {
        let planar = !random.once_in(4);
        let count = 1 + random.below(4);
        let finger = |random: &mut Random<'_>| {
            let mut point = random.vec3(1.0);
            if planar {
                point.z = 0.0;
            }
            let normal = -point.unit(1e-3).unwrap_or(Vec3::X);
            let mu = random.within(0.1, 1.0);
            let friction = match random.below(3) {
                0 => Friction::None,
                1 if planar => Friction::Hard { mu },
                1 => Friction::None,
                _ => Friction::Hard { mu },
            };
            let strength = [1.0, 0.5, 3.0][random.below(3)];
            let curvature = ContactCurvature::default();
            FingerContact { point, normal, friction, strength, curvature }
        };
        let contacts: Vec<FingerContact> = (0..count).map(|_| finger(random)).collect();
        let length = random.power(-1.0, 1.0);
        let space = WrenchSpace { point: random.vec3(0.2), length, planar };
        let metric = [GraspMetric::L1, GraspMetric::LInf][random.below(2)];
        let found = grasp_quality(&contacts, space, metric).unwrap();
        record.word(&found.closed);
        record.numbers(&[found.epsilon.upper, found.epsilon.lower, sum(&found.weakest)]);
    });
}

/// A search cut short: where it is depends on every step.
#[test]
fn steps_of_inverse_kinematics() {
    check("algebra_steps", 150, |random, record| {
        let with_shapes = random.once_in(3);
        let robot = robot(random, with_shapes);
        let target = robot.state(&random.configuration(&robot)).unwrap();
        let target = target.pose(robot.tool()).unwrap();
        let components = std::array::from_fn(|_| !random.once_in(3));
        let axes = [ReferenceFrame::Local, ReferenceFrame::LocalWorldAligned][random.below(2)];
        let task = if random.once_in(2) { Task::POSE } else { Task { components, axes } };
        let goal = Goal::frame(robot.tool(), task, target);
        // Said twice it has no closed form.
        let goals = if random.once_in(2) { vec![goal] } else { vec![goal, goal] };
        let options = IkOptions {
            initial_guess: Some(random.configuration(&robot)),
            budget: Budget { iterations: 1 + random.below(25), time: None },
            ..IkOptions::default()
        };
        match solve(&robot, &goals, &options) {
            Ok(found) => {
                record.word(&(found.success, found.iterations, found.restarts, found.found_by));
                // Files write limits of 1e5 for no limits.
                let near = found.q.iter().filter(|x| x.abs() < 100.0).copied();
                record.number(sum(&near.collect::<Vec<_>>()));
                let errors = [found.position_error, found.orientation_error];
                record.numbers(&errors.map(|e| e * 1e3));
            }
            Err(error) => record.word(&error.to_string().len()),
        }
    });
}

/// Six joints whose axes may be parallel or meet.
fn arm(random: &mut Random<'_>) -> Mechanism {
    let unit = |random: &mut Random<'_>| random.vec3(1.0).unit(0.1).unwrap_or(Vec3::X);
    let mut axes: [Vec3; 6] = std::array::from_fn(|_| unit(random));
    let mut points: [Vec3; 6] = std::array::from_fn(|_| random.vec3(0.5));
    match random.below(6) {
        0 => (points[4], points[5]) = (points[3], points[3]),
        1 => {
            (points[4], points[5], points[2]) = (points[3], points[3], points[1]);
        }
        2 => {
            (points[4], points[5], axes[2]) = (points[3], points[3], axes[1]);
        }
        3 => (axes[2], axes[3], points[5]) = (axes[1], -axes[1], points[4]),
        4 => {
            (axes[2], axes[3]) = (axes[1], axes[1]);
        }
        _ => (points[4], points[5], axes[1]) = (points[3], points[3], axes[0]),
    }
    let (mut builder, mut before) = (Mechanism::builder("arm"), random.pose(0.3));
    for (i, (axis, point)) in axes.into_iter().zip(points).enumerate() {
        let here = Pose::from_translation(point);
        builder.joint(JointSpec {
            parent_from_joint: before * here,
            axis,
            limits: Limits { lower: -6.0, upper: 6.0, ..Limits::NONE },
            ..JointSpec::new(
                &format!("q{i}"),
                JointKind::Revolute,
                &format!("l{i}"),
                &format!("l{}", i + 1),
            )
        });
        before = here.inverse();
    }
    let tip = Pose { rotation: Rotation::exp(random.vec3(2.0)), translation: random.vec3(0.3) };
    builder.frame("tip", "l6", tip).tool("tip");
    builder.build().unwrap()
}

#[test]
fn closed_forms() {
    check("algebra_closed_forms", 80, |random, record| {
        let robot = match random.below(4) {
            0 => catalogue::load(["ur5e", "puma560", "crx10ia"][random.below(3)])
                .or_else(|_| catalogue::load("ur5e"))
                .unwrap(),
            _ => arm(random),
        };
        let Ok(mut ik) = Analytic::of(&robot, robot.tool()) else {
            record.word(&"none");
            return;
        };
        let mut q: Vec<f64> = (0..6).map(|_| random.within(-3.0, 3.0)).collect();
        if random.once_in(4) {
            q[1 + random.below(5)] = 0.0;
        }
        let target = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let found = ik.solve(target, &[0.1; 6]).unwrap();
        record.word(&(ik.geometry().to_string(), found.len(), found.is_open()));
        let free: Vec<bool> = found.iter().flat_map(|s| s.free).collect();
        record.word(&free.iter().filter(|f| **f).count());
        for solutions in found.chunks(4) {
            record.number(sum(&solutions.iter().flat_map(|s| s.q).collect::<Vec<_>>()));
        }
    });
}

/// Angles of all sizes, all numbers of lanes.
#[test]
fn batches_of_configurations() {
    check("algebra_configurations", 80, |random, record| {
        let with_shapes = random.once_in(4);
        let robot = robot(random, with_shapes);
        let batch = KinematicsBatch::new(&robot, robot.tool()).unwrap();
        let count = 1 + random.below(11);
        let mut one = || match random.below(12) {
            0 => random.below(190_001) as f64 - 95e3,
            1 => random.below(20_000_001) as f64 - 1e7,
            2 => [0.0, std::f64::consts::FRAC_PI_2, -std::f64::consts::PI][random.below(3)],
            _ => random.within(-7.0, 7.0),
        };
        let q: Vec<f64> = (0..count * robot.n()).map(|_| one()).collect();
        let reference =
            [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned]
                [random.below(3)];
        let size = robot.reach().max(1e-3);
        match batch.poses(&q) {
            Ok(poses) => {
                let jacobians = batch.jacobians(&q, reference).unwrap();
                let most = jacobians.iter().fold(size, |m, x| m.max(x.abs()));
                record.number(sum(&poses) / poses.iter().fold(size, |m, x| m.max(x.abs())));
                record.number(sum(&jacobians) / most);
            }
            Err(error) => record.word(&error.to_string().len()),
        }
    });
}

/// A positive definite form, of one weight now and then.
fn form(random: &mut Random<'_>, n: usize) -> Matrix {
    let size = random.power(-1.0, 1.0);
    if random.once_in(3) {
        return Matrix::from_fn(n, n, |i, j| if i == j { size } else { 0.0 });
    }
    let root = plain(random, n, n);
    let square = &root.transpose() * &root;
    Matrix::from_fn(n, n, |i, j| square[(i, j)] + if i == j { size } else { 0.0 })
}

/// Closed chains near home, several at a time.
#[test]
fn batches_of_closed_chains() {
    check("algebra_closed_chains", 70, |random, record| {
        let robot = match random.below(4) {
            0 => five_bar(random),
            1 => spatial_loop(random),
            2 => of_catalogue(random, true),
            _ => of_catalogue(random, false),
        };
        let length = random.once_in(3).then(|| random.power(-2.0, 1.0));
        let home = robot.state(robot.home()).unwrap();
        let constraint = ClosedChain::of(&home, None, length).unwrap().constraint;
        let (joints, object) = (constraint.actuated(), constraint.object());
        let rows = 1 + random.below(object.max(1));
        let task = (rows < object && random.once_in(3)).then(|| plain(random, rows, object));
        let measured = task.as_ref().map_or(object, Matrix::rows);
        let mut metrics = Metrics::UNIT;
        if random.once_in(3) {
            metrics = metrics.with_object(&form(random, measured)).unwrap();
        }
        if random.once_in(3) {
            metrics = metrics.with_joint(&form(random, joints)).unwrap();
        }
        let options = BatchOptions { length, task, metrics, ..BatchOptions::default() };
        let batch = match ManipulabilityBatch::new(&robot, &options) {
            Ok(batch) => batch,
            Err(error) => {
                record.word(&error.to_string().len());
                return;
            }
        };
        let spread = [0.0, 1e-3, 0.1, 0.5][random.below(4)];
        let count = 1 + random.below(6);
        let mut one = |x: &f64| x + spread * random.within(-1.0, 1.0);
        let q: Vec<f64> = (0..count).flat_map(|_| robot.home().to_vec()).collect();
        let q: Vec<f64> = q.iter().map(&mut one).collect();
        let found = batch.analyse(&q).unwrap();
        let width = ManipulabilityBatch::WIDTH;
        // Counts, indices, closure errors, distances.
        let columns: [Vec<usize>; 4] =
            [(2..11).collect(), (15..width).collect(), vec![0, 1], (11..15).collect()];
        for columns in columns {
            let mut sums = Sums::default();
            for (row, column) in (0..count).flat_map(|row| columns.iter().map(move |c| (row, c))) {
                let x = found[row * width + column];
                let near_zero = x.abs() < 1e-10;
                sums.size(if near_zero { 0.0 } else { x });
            }
            sums.write(record);
        }
    });
}
