//! Rotations, poses, twists and their logarithms at 0, at pi and at all sizes.

use std::f64::consts::PI;

use cylindroid::kinematics::velocity_conversion;
use cylindroid::spatial::{
    Derivative6, Mat3, Pose, Quaternion, Rotation, Rpy, Twist, Vec3, Wrench, Xyz, Zyz, exp,
    exp_derivative, log, log_derivative, rotation_exp_derivative, rotation_log_derivative,
};

use super::{direction, entries, error, matrix, pose, random_twist, sum, twist, vector, verdicts};
use crate::record::{Record, check};
use crate::robots::Random;

/// At and near 0, at the switch of the series, near pi, beyond it, and far beyond.
fn angle(random: &mut Random<'_>) -> f64 {
    match random.below(10) {
        0 => 0.0,
        1 => 1e-9,
        2 => PI - random.power(-6.0, -1.0),
        3 => random.within(0.4, 0.6),
        4 => random.power(-4.0, -0.5),
        5 => random.within(3.3, 30.0),
        6 => [37.0, 314.0, 999.5, 54_321.0][random.below(4)],
        _ => random.within(-3.1, 3.1),
    }
}

fn angles(record: &mut Record, rotation: Rotation) {
    let Rpy { roll, pitch, yaw } = Rpy::of(rotation);
    let rpy = Rpy { roll, pitch, yaw };
    let maps = entries(rpy.rotation().matrix()) + 0.7 * entries(rpy.omega_from_rates());
    record.number(sum(&[roll, pitch, yaw, maps]));
    let zyz = Zyz::of(rotation);
    let maps = entries(zyz.rotation().matrix()) + 0.7 * entries(zyz.omega_from_rates());
    record.number(sum(&[zyz.alpha, zyz.beta, zyz.gamma, maps]));
    let xyz = Xyz::of(rotation);
    let maps = entries(xyz.rotation().matrix()) + 0.7 * entries(xyz.omega_from_rates());
    record.number(sum(&[xyz.alpha, xyz.beta, xyz.gamma, maps]));
}

fn quaternion(record: &mut Record, q: Quaternion, scale: f64) {
    record.number(sum(&[q.w, q.x, q.y, q.z]));
    let longer = Quaternion { w: q.w * scale, x: q.x * scale, y: q.y * scale, z: q.z * scale };
    if let Some(rotation) = error(record, longer.rotation()) {
        record.number(entries(rotation.matrix()));
    }
}

#[test]
fn vectors_and_angles() {
    check("geometry_rotations", 56, |random, record| {
        let (axis, angle) = (direction(random), angle(random));
        let rotation = Rotation::exp(axis * angle);
        record.number(entries(rotation.matrix()));
        vector(record, rotation.log());
        let scale = random.power(-3.0, 3.0);
        quaternion(record, rotation.to_quaternion(), scale);
        let other = Rotation::exp(random.vec3(2.0));
        record.number(rotation.angle_to(other));
        let about = Rotation::about(axis * scale, angle).unwrap();
        let about_z = Rotation::about_z(angle);
        record.number(entries(about.matrix()) + 0.7 * entries(about_z.matrix()));
        record.number(entries(Rotation::z_to(axis * scale).unwrap().matrix()));
        vector(record, other.x_axis() + other.y_axis() * 2.0 + other.z_axis() * 3.0);
        // Digits are lost at the pole of the angles.
        angles(record, other);
        if random.once_in(3) {
            angles(record, rotation);
        }
    });
}

#[test]
fn poles_of_the_angles() {
    check("geometry_poles", 40, |random, record| {
        // Exactly there, or this far away: nothing is drawn that is not a fraction of a power of two.
        let away = [0.0, 0.0, 1e-15, 1e-12, 1e-3][random.below(5)];
        let bend = [0.5 * PI, -0.5 * PI, 0.0, PI][random.below(4)] + away;
        let turns = [0.75, -1.25, 2.5][random.below(3)];
        let rpy = Rpy { roll: turns, pitch: bend, yaw: 0.25 }.rotation();
        let zyz = Zyz { alpha: turns, beta: bend, gamma: 0.375 }.rotation();
        let xyz = Xyz { alpha: turns, beta: bend, gamma: -0.5 }.rotation();
        for rotation in [rpy, zyz, xyz] {
            angles(record, rotation);
        }
    });
}

/// Relative errors of rounding are seen a million times larger.
#[test]
fn digits_of_logarithms() {
    check("geometry_digits", 36, |random, record| {
        let size = [1e-150, 1e-9, 0.015_625, 0.031_25, 0.0625, 0.25, 0.5, 1.0, 2.0, 3.0, 3.125]
            [random.below(11)];
        let oblique = [Vec3::new(0.6, 0.0, -0.8), Vec3::new(-0.6, 0.8, 0.0)][random.below(2)];
        let axis = [Vec3::X, Vec3::Y, Vec3::Z, oblique][random.below(4)];
        let turn = axis * size;
        let back = Rotation::exp(turn).log();
        record.number(1e7 * ((back - turn).norm() / size));
        let half = Rotation::about(axis, PI).unwrap();
        vector(record, half.log());
        quaternion(record, half.to_quaternion(), 1.0);
        let (x, linear) = (Twist { linear: axis * 0.5, angular: turn }, Vec3::new(0.5, 0.25, 1.0));
        let t = Twist { linear, ..x };
        let way = log(exp(t)) - t;
        record.number(1e6 * way.linear.norm());
        let there = log_derivative(t).apply(exp_derivative(t).apply(x)) - x;
        record.number(1e6 * (there.linear.norm() + there.angular.norm()));
        let large = [1e-290, 1e-200, 1e-141, 1e139, 1e141, 1e200, 1e290][random.below(7)];
        let long = (axis + Vec3::new(0.0, 0.25, 0.5)) * large;
        record.numbers(&[long.norm().log10(), sum(&long.unit(0.0).unwrap().to_array())]);
        let far = long * f64::INFINITY;
        let units = [long.unit(large), long.unit(2.0 * large), far.unit(0.0)];
        verdicts(record, &units.map(|u| u.is_some()));
        let tiny = Vec3::new(3e-310, -4e-310, 0.0);
        vector(record, tiny.unit(0.0).unwrap());
        let huge = Rotation::exp(Vec3::new(1.3e308, 1.3e308, 0.0) * [0.5, 1.0][random.below(2)]);
        record.number(entries(huge.matrix()));
    });
}

fn derivative(record: &mut Record, d: Derivative6, t: Twist) {
    record.number(entries(d.diagonal) + 0.7 * sum(&d.apply(t).to_array()));
    record.number(entries(d.coupling));
}

#[test]
fn exponentials_of_twists() {
    check("geometry_exponentials", 44, |random, record| {
        let size = random.power(-2.0, 2.0);
        let vector = direction(random) * angle(random).min(3.1);
        let x = Twist { linear: random.vec3(size), angular: vector };
        let t = random_twist(random, size);
        derivative(record, exp_derivative(x), t);
        let near = Twist { angular: vector * 0.9, ..x };
        derivative(record, log_derivative(near), t);
        pose(record, exp(x));
        twist(record, log(exp(near)));
        let inverse = entries(rotation_log_derivative(near.angular));
        record.number(entries(rotation_exp_derivative(vector)) + 0.7 * inverse);
        let (a, b) = (random.pose(size), random.pose(size));
        twist(record, a.screw_to(b));
        twist(record, a.error_to(b));
    });
}

#[test]
fn poses_and_forms() {
    check("geometry_poses", 24, |random, record| {
        let size = random.power(-2.0, 2.0);
        let (a, b) = (random.pose(size), random.pose(size));
        pose(record, a * b.inverse());
        vector(record, (a * b) * random.vec3(size));
        let (t, u) = (random_twist(random, size), random_twist(random, size));
        let w = Wrench { force: random.vec3(1.0), moment: random.vec3(size) };
        let v = Wrench { force: random.vec3(1.0), moment: random.vec3(size) };
        twist(record, a.adjoint(t));
        record.number(sum(&a.coadjoint(w).to_array()));
        twist(record, (-t).bracket(u) + t.at_point(b.translation) * 0.5);
        record.number(sum(&(w - v.at_point(a.translation) * 0.5).to_array()));
        record.numbers(&[t.power(w), t.klein(u), t.killing(u)]);
        let h = [random.within(-2.0, 2.0), 0.0, f64::INFINITY, f64::NEG_INFINITY][random.below(4)];
        record.numbers(&[t.pitch_form(u, h), w.pitch_form(v, h)]);
        record.number(sum(&t.lowered(h).to_array()));
        if h.is_finite() {
            twist(record, w.raised(h));
        }
        matrix(record, &velocity_conversion(a));
        let (r, s) = (a.rotation.matrix(), b.rotation.matrix());
        record.numbers(&[(r - s * 0.5).max_abs(), (r + s).determinant()]);
        vector(record, r.tr_mul(b.translation));
        verdicts(record, &[a.is_finite(), t.is_finite(), w.is_finite()]);
    });
}

/// Matrices that are no rotations, nearly rotations, or not finite.
#[test]
fn matrices_of_poses() {
    check("geometry_matrices", 48, |random, record| {
        let mut rows = random.pose(2.0).to_matrix();
        let (i, j) = (random.below(3), random.below(3));
        match random.below(8) {
            0 => rows[i][j] += 0.3,
            1 => rows[i][j] += 1.1e-5 * [0.1, 1.0, 3.0][random.below(3)],
            2 => rows[i].iter_mut().for_each(|x| *x = -*x),
            3 => rows[i][j] = [f64::NAN, f64::INFINITY][random.below(2)],
            4 => rows[3][j] = 0.5,
            5 => rows[i][3] = [1e119, 1.2e120, -2e120, 1e121][random.below(4)],
            _ => {}
        }
        if let Some(found) = error(record, Pose::from_matrix(rows)) {
            pose(record, found);
            let error = found.rotation.matrix();
            record.number(1e5 * (error.transpose() * error - Mat3::IDENTITY).max_abs());
        }
        let part = Mat3::from_rows([0, 1, 2].map(|i: usize| [rows[i][0], rows[i][1], rows[i][2]]));
        if let Some(found) = error(record, Rotation::from_matrix(part)) {
            record.number(1e3 * (found.matrix() - part).max_abs());
            record.number(entries(found.renormalised().matrix()));
        }
        let about = Rotation::about(random.vec3(2e-9), 1.0).is_some();
        verdicts(record, &[about, part.is_finite()]);
        let scale = [0.0, f64::NAN, 1e300, 1e-300][random.below(4)];
        let q = Quaternion { w: 0.5, x: -0.5, y: 0.1, z: 0.2 };
        quaternion(record, q, scale);
    });
}
