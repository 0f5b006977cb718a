//! Lines, screws, involution, transversals and eigenscrews.

use cylindroid::screws::{
    EigenscrewKind, Line, Screw, ScrewOptions, Transversals, eigenscrews, gram, gram_determinant,
    involution, transversals,
};
use cylindroid::spatial::{Pose, Twist, Vec3};
use cylindroid::{Matrix, inverse};

use super::{
    counts, definite, direction, error, integers, matrix, random_matrix, random_twist, screw, sum,
    text, twist, vector, verdicts,
};
use crate::record::{Record, check};
use crate::robots::Random;

fn line(random: &mut Random<'_>, size: f64) -> Line {
    Line { point: random.vec3(size), direction: direction(random) }
}

/// Parallel to it, opposite, the same line, one that meets it, nearly parallel, or any.
fn beside(random: &mut Random<'_>, a: &Line, size: f64) -> Line {
    let along = a.direction * random.within(-2.0, 2.0);
    match random.below(9) {
        8 => Line { point: a.point + along + random.vec3(1e-15 * size), ..*a },
        0 => Line { point: random.vec3(size), direction: a.direction },
        1 => Line { point: random.vec3(size), direction: -a.direction },
        2 => Line { point: a.point + along, direction: a.direction },
        3 => Line { point: a.point + along, direction: direction(random) },
        4 => {
            let turn = random.vec3(1.0) * random.power(-11.0, -4.0);
            let direction = (a.direction + turn).unit(0.0).unwrap();
            Line { point: random.vec3(size), direction }
        }
        _ => line(random, size),
    }
}

#[test]
fn normals_of_two_lines() {
    check("geometry_normals", 60, |random, record| {
        let size = random.power(-2.0, 2.0);
        let a = line(random, size);
        let b = beside(random, &a, size);
        let (ab, ba) = (a.common_normal(&b), b.common_normal(&a));
        verdicts(record, &[ab.unique, ba.unique]);
        for n in [ab, ba] {
            record.number(n.distance / size + 0.7 * n.angle);
        }
        for n in [ab, ba] {
            record.number(sum(&(n.from + n.to * 0.7).to_array()) / size);
        }
        let point = random.vec3(size);
        vector(record, a.nearest(point) * (1.0 / size));
        twist(record, a.twist());
        let through = Line::transversal_through(point, &a, &b);
        record.word(&through.is_some());
        let tiny = random.vec3(3e-9);
        record.word(&Line::through(point, tiny).is_some());
        vector(record, ab.direction);
        if let Some(found) = through {
            vector(record, found.direction);
        }
    });
}

#[test]
fn screws_of_twists() {
    check("geometry_screws", 60, |random, record| {
        let size = random.power(-2.0, 2.0);
        let mut t = random_twist(random, size);
        match random.below(8) {
            0 => t.angular = Vec3::ZERO,
            1 => t.linear = Vec3::ZERO,
            2 => t = Twist::ZERO,
            3 => t = t * [1e-300, 1e-200, 1e150, 1e300][random.below(4)],
            4 => t.angular = t.angular * [1e-300, 1e-309, 1e-15][random.below(3)],
            5 => t.linear = t.angular.cross(random.vec3(size)),
            6 => t.linear.x = [f64::NAN, f64::INFINITY, 1e308][random.below(3)],
            _ => {}
        }
        let found = Screw::of(t);
        let translation = found.is_some_and(|s| s.is_translation());
        verdicts(record, &[found.is_some(), translation]);
        let Some(s) = found else { return };
        record.number(s.amplitude.log10());
        vector(record, s.axis.direction);
        record.number(s.pitch);
        vector(record, s.axis.point);
        let back = s.twist() * (1.0 / s.amplitude);
        record.number(back.angular.norm());
        record.number(sum(&back.linear.to_array()));
    });
}

/// Up to six lines: in general, in planes and bundles, on a regulus, all across one line, parallel
/// to a plane, or repeated.
fn lines(random: &mut Random<'_>, size: f64) -> Vec<Line> {
    let count = [1, 2, 3, 4, 4, 4, 5, 6][random.below(8)];
    let world = random.pose(size);
    let way = random.below(12);
    let ruled = |s: f64| {
        // z = x y, ruled by y = s, z = s x.
        Line { point: Vec3::new(0.0, s * size, 0.0), direction: Vec3::new(1.0, 0.0, s) }
    };
    let mut one = |i: usize| match way {
        0 => Line { point: Vec3::ZERO, direction: direction(random) },
        1 => {
            let point = random.vec3(size);
            let d = random.vec3(1.0);
            Line { point: Vec3::new(point.x, point.y, 0.0), direction: Vec3::new(d.x, d.y, 0.0) }
        }
        2 => ruled(i as f64 - 1.5),
        3 => Line { point: Vec3::X * random.within(-size, size), direction: random.vec3(1.0) },
        4 => {
            let d = random.vec3(1.0);
            Line { point: random.vec3(size), direction: Vec3::new(d.x, d.y, 0.0) }
        }
        5 if i > 0 => ruled(1.0),
        6 => Line { point: random.vec3(size), direction: Vec3::Z },
        7 if i == 0 => Line { point: Vec3::ZERO, direction: Vec3::X },
        7 => Line { point: Vec3::X * (i as f64 * size), direction: random.vec3(1.0) },
        _ => line(random, size),
    };
    let there = |l: Line| Line {
        point: world * l.point,
        direction: (world.rotation * l.direction).unit(0.0).unwrap(),
    };
    (0..count).map(|i| there(one(i))).collect()
}

fn met(record: &mut Record, found: &Transversals, size: f64) {
    verdicts(record, &[found.infinitely_many, found.double]);
    counts(record, &[found.lines.len(), found.at_infinity.len()]);
    for line in &found.lines {
        let foot = line.nearest(Vec3::ZERO) * (1.0 / size);
        record.number(sum(&[foot.norm(), line.direction.x.abs(), line.direction.y.abs()]));
    }
    found.at_infinity.iter().for_each(|d| record.number(d.x.abs() + 0.7 * d.z.abs()));
}

#[test]
fn lines_in_involution() {
    check("geometry_involution", 150, |random, record| {
        let size = random.power(-1.5, 1.5);
        let lines = lines(random, size);
        let options = ScrewOptions::with_length(size * random.power(-0.3, 0.3));
        let found = involution(&lines, &options).unwrap();
        counts(record, &[found.lines, found.null_twists.len()]);
        let screw = found.null_screw.is_some();
        verdicts(record, &[found.in_involution, found.independent, screw]);
        record.number(found.margin + 1e8 * found.threshold);
        met(record, &found.transversals, size);
        met(record, &transversals(&lines, &options).unwrap(), size);
        if let [t] = found.null_twists[..] {
            let s = Screw::of(t).unwrap();
            let w = found.wrench.unwrap();
            record.number(s.pitch / size + 0.7 * s.amplitude);
            record.number(w.force.norm() + 0.7 * w.moment.norm() / size);
        }
    });
}

/// Stiffness matrices of full rank and less, of springs and of integers, indefinite, and no
/// stiffness.
fn stiffness(random: &mut Random<'_>, length: f64) -> Matrix {
    let size = random.power(-2.0, 4.0);
    // Far away, and in other units, the rank is that at the place of the springs, if anywhere.
    let far = if random.once_in(3) { random.power(2.0, 3.2) } else { random.power(-1.0, 1.0) };
    let offset = length * far;
    let frame = random.pose(offset);
    let own = match random.below(9) {
        0 => {
            let rank = 1 + random.below(6);
            let a = integers(random, 6, rank, rank);
            &a * &a.transpose()
        }
        1 => {
            let rank = 1 + random.below(5);
            let a = random_matrix(random, 6, rank);
            &a * &a.transpose()
        }
        2 => {
            let a = random_matrix(random, 6, 6);
            Matrix::from_fn(6, 6, |i, j| a[(i, j)] + a[(j, i)])
        }
        3 => Matrix::diagonal(&[0.0, 0.0, 0.0, 1.0, 2.0, random.within(0.0, 2.0)]),
        4 => Matrix::diagonal(&[2.0, random.within(1.0, 2.0), 1.0, 0.0, 0.0, 0.0]),
        5 => Matrix::diagonal(&[3.0, 0.0, 0.0, 0.0, 2.0, 1.0]),
        6 => Matrix::diagonal(&[1.0, 1.0, 1.0, 0.5, 0.5, random.power(-14.0, -1.0)]),
        _ => definite(random, 6),
    };
    let unit = [1.0, 1.0, 1.0, length, length, length];
    let map = cylindroid::kinematics::velocity_conversion(frame.inverse());
    let scaled = Matrix::from_fn(6, 6, |i, j| own[(i, j)] * size * unit[i] * unit[j]);
    let moved = &(&map.transpose() * &scaled) * &map;
    Matrix::from_fn(6, 6, |i, j| 0.5 * (moved[(i, j)] + moved[(j, i)]))
}

#[test]
fn eigenscrews_of_stiffness() {
    check("geometry_eigenscrews", 76, |random, record| {
        let exponent = [1.0, 7.0][random.below(2)];
        let length = random.power(-exponent, exponent);
        let mut k = stiffness(random, length);
        let h = [0.0, random.within(-1.0, 1.0) * length, 100.0 * length][random.below(3)];
        if random.once_in(20) {
            k[(1, 4)] += k.max_abs() * 1e-8;
        }
        let Some(found) = error(record, eigenscrews(&k, h)) else { return };
        let size = k.max_abs() * length;
        counts(record, &[found.screws.len()]);
        verdicts(record, &[found.spring_pitch.is_some()]);
        match found.kind {
            EigenscrewKind::Indefinite { smallest } => record.number(smallest),
            EigenscrewKind::Defective { rank, missing } => counts(record, &[rank, missing]),
            EigenscrewKind::Semidefinite { rank } => counts(record, &[rank]),
            _ => text(record, found.kind.name()),
        }
        let values: Vec<f64> = found.screws.iter().map(|e| e.eigenvalue / size).collect();
        record.number(sum(&values));
        record.number(found.spring_pitch.unwrap_or(0.0) / length);
        for e in &found.screws {
            let s = e.screw().unwrap();
            record.number(s.pitch / length + e.wrench.force.norm() + e.twist.klein(e.twist));
        }
        let bad = [f64::NAN, f64::INFINITY][random.below(2)];
        let _ = error(record, eigenscrews(&k, bad));
        let _ = error(record, eigenscrews(&k.columns_between(0, 5), h));
    });
}

#[test]
fn gram_matrices() {
    check("geometry_gram", 40, |random, record| {
        let columns = random.below(9);
        let rank = 1 + random.below(4);
        let j = match random.below(3) {
            0 => integers(random, 6, columns, rank),
            _ => random_matrix(random, 6, columns),
        };
        let h = [0.0, random.within(-2.0, 2.0), f64::INFINITY, f64::NEG_INFINITY][random.below(4)];
        matrix(record, &gram(&j, h).unwrap());
        record.number(gram_determinant(&j, h).unwrap());
        let mut out = Matrix::zeros(columns, 6);
        let center = random.once_in(2).then(|| random.vec3(1.0));
        let scale = ScrewOptions { center, ..ScrewOptions::with_length(random.power(-1.0, 1.0)) };
        if let Some(reason) = error(record, inverse::hyperbolic_into(&j, h, &scale, &mut out)) {
            match reason {
                Some(reason) => text(record, &reason.to_string()),
                None => matrix(record, &out),
            }
        }
        let _ = error(record, gram(&j.rows_between(0, 5), h));
    });
}

/// Poses along a screw, for completeness of its parts.
#[test]
fn motions_along_screws() {
    check("geometry_motions", 20, |random, record| {
        let pitch = [0.0, random.within(-1.0, 1.0), f64::INFINITY][random.below(3)];
        let s = Screw { axis: line(random, 1.0), pitch, amplitude: random.power(-2.0, 1.0) };
        twist(record, s.twist());
        let moved = random.pose(1.0);
        let found = Screw::of(moved.adjoint(s.twist())).unwrap();
        screw(record, &found);
        let there = cylindroid::spatial::exp(s.twist());
        super::pose(record, there * Pose::from_translation(s.axis.point));
    });
}
