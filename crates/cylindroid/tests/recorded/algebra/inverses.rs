//! Inverses: all methods, many at a time, weighted, hyperbolic; points along directions.

use cylindroid::inverse::{
    self, Domain, HyperbolicDamping, HyperbolicOptions, Inverse, InverseBatch, Weights,
};
use cylindroid::linalg::Metric;
use cylindroid::screws::ScrewOptions;
use cylindroid::spatial::Rotation;
use cylindroid::{Matrix, Method, Pose, Result, Vec3};

use super::matrices::metric;
use super::{KINDS, Sums, any, plain, sum, times, vector};
use crate::record::{Record, check};
use crate::robots::Random;

/// With parameters for singular values of this size.
fn method(random: &mut Random<'_>, size: f64) -> Method {
    let mut method = Method::ALL[random.below(Method::ALL.len())];
    for (parameter, value) in method.parameters_mut() {
        *value = match parameter.unit {
            "-" if parameter.name == "shape" => random.power(-1.0, 2.0),
            "-" => random.power(-4.0, -0.1),
            _ => size * random.power(-2.0, 0.5),
        };
    }
    method
}

/// A matrix whose entries have a size near one, or not at all, and that size.
fn matrix(random: &mut Random<'_>, m: usize, n: usize) -> (Matrix, f64) {
    let kind = random.below(KINDS);
    let a = any(random, kind, m, n);
    let size = if a.max_abs() > 0.0 { a.max_abs() } else { 1.0 };
    (a, size)
}

/// Everything but what rounding leaves of zero.
fn of_inverse(sums: &mut Sums, found: &Result<Inverse>) {
    match found {
        Err(error) => sums.count(error.to_string().len()),
        Ok(found) => {
            let largest = found.singular_values.first().copied().unwrap_or(0.0);
            let clear = found.singular_values.iter().filter(|s| **s > 1e-12 * largest);
            let flags = [found.exists, found.reason.is_some()].map(usize::from);
            let count = 10 * found.rank + found.dropped.len() + 3 * flags[0] + 5 * flags[1];
            sums.count(count);
            sums.scaled(&clear.copied().collect::<Vec<_>>());
            sums.size(found.threshold);
            sums.scaled(found.matrix.as_slice());
            if found.gap < 1e10 {
                sums.size(found.gap);
            }
            for lost in found.dropped.iter().filter(|d| d.singular_value > 1e-12 * largest) {
                sums.number(lost.singular_value / largest);
                sums.number(lost.filter_factor);
                sums.number(sum(&lost.direction));
            }
        }
    }
}

#[test]
fn methods() {
    check("algebra_methods", 200, |random, record| {
        let mut sums = Sums::default();
        let mut names = String::new();
        for _ in 0..3 {
            let (m, n) = [(6, 7), (6, 6), (3, 7), (6, 4), (2, 2), (1, 3)][random.below(6)];
            let (a, size) = matrix(random, m, n);
            let method = method(random, size);
            names += &method.name()[..1];
            of_inverse(&mut sums, &method.inverse(&a));
        }
        record.word(&names);
        sums.write(record);
    });
}

/// Motions from small to large ones.
#[test]
fn selectively_damped() {
    check("algebra_selective", 90, |random, record| {
        let mut sums = Sums::default();
        for _ in 0..3 {
            let (m, n) = [(6, 7), (6, 6), (3, 5), (4, 2)][random.below(4)];
            let (a, size) = matrix(random, m, n);
            let (most, share) = (random.power(-2.0, 2.0), random.power(-2.0, 1.0));
            let task =
                vector(random, m).iter().map(|x| x * size * most * share).collect::<Vec<_>>();
            of_inverse(&mut sums, &inverse::selectively_damped(&a, &task, most));
        }
        sums.write(record);
    });
}

#[test]
fn weighted() {
    check("algebra_weighted", 70, |random, record| {
        let (m, n) = (1 + random.below(6), 1 + random.below(7));
        let a = plain(random, m, n);
        let mut own = |n: usize| -> Option<Metric> {
            let n = if random.once_in(20) { n + 1 } else { n };
            (!random.once_in(4)).then(|| metric(random, n))
        };
        let weights = Weights { joint: own(n), task: own(m) };
        let method = method(random, 1.0);
        let mut sums = Sums::default();
        of_inverse(&mut sums, &inverse::weighted(&a, method, &weights));
        sums.write(record);
    });
}

/// All numbers of lanes, whole and left over, all kinds side by side.
#[test]
fn batches() {
    check("algebra_batches", 90, |random, record| {
        let (m, n) = [(6, 7), (6, 6), (7, 6), (3, 7), (5, 2), (1, 4), (1, 1)][random.below(7)];
        let truncated = Method::Truncated { eps: random.power(-8.0, -0.3) };
        let method = if random.once_in(4) { method(random, 1.0) } else { truncated };
        let count = [1, 2, 3, 4, 5, 7, 8, 9, 13][random.below(9)];
        let all: Vec<Matrix> = (0..count)
            .map(|_| match random.below(4) {
                0 => matrix(random, m, n).0,
                1 => {
                    let size = [1e-70, 1e-58, 1e-45, 1e45, 1e58, 1e70][random.below(6)];
                    times(&plain(random, m, n), |_, _| size)
                }
                _ => plain(random, m, n),
            })
            .collect();
        let numbers: Vec<f64> = all.iter().flat_map(|a| a.to_rows().concat()).collect();
        let found = InverseBatch::new(method, m, n).unwrap().inverses(&numbers).unwrap();
        let (each, values) = (m * n, m.min(n));
        let mut sums = Sums::default();
        for (i, rank) in found.ranks.iter().enumerate() {
            sums.scaled(&found.singular_values[i * values..][..rank.rank]);
            sums.size(rank.threshold);
            sums.scaled(&found.matrices[i * each..][..each]);
            if rank.gap < 1e10 {
                sums.size(rank.gap);
            }
        }
        record.word(&found.ranks.iter().map(|r| r.rank).collect::<Vec<_>>());
        sums.write(record);
    });
}

/// Near the thresholds at which a batch hands over.
#[test]
fn ends_of_batches() {
    check("algebra_batch_ends", 60, |random, record| {
        let eps = [0.0, 1e-7, 1e-2][random.below(3)];
        let least = [1.2e-6, 0.8e-6, 1.2e-2, 0.8e-2, 1.0, 1e-9][random.below(6)];
        let size = random.power(-65.0, 65.0);
        let turn = Rotation::exp(random.vec3(2.0));
        let other = Rotation::exp(random.vec3(2.0));
        let axes = [other.x_axis(), other.y_axis(), other.z_axis()].map(|x| x.to_array());
        let values = [size, 0.5 * size, least * size];
        let columns = [turn.x_axis(), turn.y_axis(), turn.z_axis()].map(|x| x.to_array());
        let entry = |i: usize, j: usize| -> f64 {
            (0..3).map(|l| columns[l][i] * values[l] * axes[l][j]).sum()
        };
        let a = Matrix::from_fn(3, 3, entry);
        let batch = InverseBatch::new(Method::Truncated { eps }, 3, 3).unwrap();
        let found = batch.inverses(&a.to_rows().concat()).unwrap();
        record.word(&found.ranks[0].rank);
        let mut sums = Sums::default();
        sums.size(found.ranks[0].threshold);
        if found.ranks[0].gap < 1e10 {
            sums.size(found.ranks[0].gap);
        }
        sums.scaled(&found.singular_values[..2]);
        sums.write(record);
        let mut sums = Sums::default();
        sums.scaled(&found.matrices);
        sums.write(record);
    });
}

/// More than a part of them, and what is refused.
#[test]
fn large_and_refused_batches() {
    check("algebra_large_batches", 10, |random, record| {
        let method = method(random, 1.0);
        let batch = InverseBatch::new(method, 2, 3).unwrap();
        let count = InverseBatch::CHUNK + random.below(300);
        let mut numbers = vector(random, 6 * count);
        let found = batch.inverses(&numbers).unwrap();
        record.word(&found.ranks.iter().map(|r| r.rank).sum::<usize>());
        record.numbers(&[sum(&found.singular_values), sum(&found.matrices)]);
        let place = random.below(numbers.len());
        numbers[place] = f64::NAN;
        record.word(&batch.inverses(&numbers).map_err(|e| e.to_string().len()).err());
        record.word(&batch.inverses(&numbers[..place]).map_err(|e| e.to_string().len()).err());
        let shape = (random.below(2), random.below(3));
        record.word(&InverseBatch::new(method, shape.0, shape.1).map_err(|e| e.to_string()).err());
        let bad = Method::Truncated { eps: [1.0, -0.1, f64::NAN][random.below(3)] };
        record.word(&bad.check().map_err(|e| e.to_string()).err());
        let numbers = [0.0, -1.0, 1.0, 0.5, 1e-300, f64::INFINITY, f64::NAN, f64::NEG_INFINITY];
        for domain in [Domain::Positive, Domain::Fraction, Domain::Finite, Domain::Extended] {
            let within = numbers.iter().filter(|x| domain.contains(**x)).count();
            record.word(&(within, domain.describe().len()));
        }
        let j = Matrix::from_fn(2, 3, |i, j| if i + j == 2 { f64::INFINITY } else { 1.0 });
        let mut sums = Sums::default();
        of_inverse(&mut sums, &method.inverse(&j));
        sums.write(record);
    });
}

/// Joints of pitch 0, of a pitch, infinite; anyhow, parallel, through a point, dependent.
fn twists(random: &mut Random<'_>, m: usize, size: f64) -> Matrix {
    let structure = random.below(6);
    let (about, pose) = (random.vec3(1.0), random.pose(size));
    let mut j = Matrix::zeros(6, m);
    for c in 0..m {
        let (w, point) = match structure {
            0 => (about, random.vec3(size)),
            1 => (random.vec3(1.0), Vec3::ZERO),
            2 => ([Vec3::X, Vec3::Y, Vec3::Z][c % 3], Vec3::X * (c as f64 * size)),
            _ => (random.vec3(1.0), random.vec3(size)),
        };
        let pitch = if random.once_in(4) { random.within(-0.5, 0.5) * size } else { 0.0 };
        let (v, w) = match random.below(6) {
            0 => (w * size, Vec3::ZERO),
            _ => (point.cross(w) + w * pitch, w),
        };
        let (v, w) = (pose.rotation * v, pose.rotation * w);
        let v = v + pose.translation.cross(w);
        let column = [v.to_array(), w.to_array()];
        j.column_mut(c).copy_from_slice(column.as_flattened());
    }
    if structure == 3 && m > 1 {
        let first = j.column(0).to_vec();
        j.column_mut(m - 1).iter_mut().zip(first).for_each(|(x, y)| *x = -2.0 * y);
    }
    j
}

fn scale(random: &mut Random<'_>, size: f64) -> ScrewOptions {
    let center = random.once_in(3).then(|| random.vec3(3.0 * size));
    ScrewOptions { center, ..ScrewOptions::with_length(size) }
}

fn of_reason(record: &mut Record, reason: Option<impl std::fmt::Debug>) {
    let name = reason.map(|r| format!("{r:?}").split([' ', '{']).next().unwrap().to_owned());
    record.word(&name);
}

#[test]
fn hyperbolic() {
    check("algebra_hyperbolic", 200, |random, record| {
        let (m, size) = (1 + random.below(7), random.power(-2.0, 2.0));
        let j = twists(random, m, size);
        let h = [0.0, f64::INFINITY, random.within(-1.0, 1.0) * size][random.below(4).min(2)];
        let damping = match random.below(4) {
            0 => HyperbolicDamping::Gram { lambda: random.within(-1.0, 1.0) * size },
            1 => HyperbolicDamping::Invariant { mu: random.power(-2.0, 0.0) * size },
            _ => HyperbolicDamping::None,
        };
        let joint_metric = random.once_in(2).then(|| metric(random, m));
        let options = HyperbolicOptions { scale: scale(random, size), joint_metric, damping };
        let found = inverse::hyperbolic_with(&j, h, &options);
        let mut sums = Sums::default();
        if let Ok(found) = &found {
            record.word(&(found.rank, found.exists, found.dropped.len()));
            of_reason(record, found.reason);
            sums.scaled(found.matrix.as_slice());
            sums.scaled(&found.singular_values[..found.rank]);
            sums.size(found.threshold);
            found.dropped.iter().for_each(|lost| sums.number(sum(&lost.direction)));
        } else {
            record.word(&found.map_err(|e| e.to_string().len()).err());
        }
        let mut out = Matrix::zeros(m, 6);
        let none = inverse::hyperbolic_into(&j, h, &options.scale, &mut out);
        record.word(&none.as_ref().map(Option::is_some).ok());
        sums.scaled(out.as_slice());
        sums.write(record);
    });
}

#[test]
fn oblique() {
    check("algebra_oblique", 50, |random, record| {
        let (m, size) = (1 + random.below(5), random.power(-2.0, 2.0));
        let c = 6 - m + random.below(3).saturating_sub(1);
        let (j, others) = (twists(random, m, size), twists(random, c, size));
        let joint_metric = random.once_in(2).then(|| metric(random, m));
        let options = HyperbolicOptions {
            scale: scale(random, size),
            joint_metric,
            ..HyperbolicOptions::default()
        };
        let found = inverse::oblique(&j, &others, &options).unwrap();
        record.word(&(found.rank, found.exists, found.dropped.len()));
        of_reason(record, found.reason);
        let mut sums = Sums::default();
        sums.scaled(found.matrix.as_slice());
        found.dropped.iter().for_each(|lost| sums.number(sum(&lost.direction)));
        sums.write(record);
    });
}

#[test]
fn hyperbolic_values() {
    check("algebra_hyperbolic_values", 80, |random, record| {
        let (m, size) = (1 + random.below(7), random.power(-2.0, 2.0));
        let j = twists(random, m, size);
        let h = [0.0, 0.5 * size, random.within(-1.0, 1.0) * size][random.below(3)];
        let joint_metric = random.once_in(2).then(|| metric(random, m));
        let svd = inverse::hyperbolic_svd(&j, h, &scale(random, size), joint_metric.as_ref());
        let svd = svd.unwrap();
        record.word(&(svd.verdict.name(), svd.signature, svd.verdict.description().len()));
        let mut sums = Sums::default();
        sums.scaled(&svd.squares);
        sums.scaled(&svd.values());
        sums.write(record);
        let polar = svd.polar();
        let parts = polar.iter().flat_map(|p| [&p.isometry, &p.stretch, &p.signs]);
        for parts in [parts.collect(), vec![&svd.left, &svd.right]] {
            let mut sums = Sums::default();
            parts.iter().for_each(|part| sums.scaled(part.as_slice()));
            sums.write(record);
        }
    });
}

#[test]
fn points_along_directions() {
    check("algebra_point_directions", 100, |random, record| {
        let (m, size) = (1 + random.below(7), random.power(-2.0, 2.0));
        let j = twists(random, m, size);
        let axis = Vec3::from_array(std::array::from_fn(|i| j[(3 + i, 0)]));
        let point = [Vec3::ZERO, axis * size, random.vec3(size)][random.below(3)];
        let far = random.pose(0.0);
        let direction = match random.below(4) {
            0 => axis.cross(point),
            1 => Vec3::X,
            2 => Vec3::ZERO,
            _ => Pose::from_translation(random.vec3(2.0)) * (far.rotation * Vec3::X),
        };
        match inverse::point_direction(&j, point, direction) {
            Ok(found) => {
                record.word(&(found.along.is_some(), found.still.cols()));
                let mut sums = Sums::default();
                if let Some(along) = &found.along {
                    sums.scaled(along);
                }
                sums.number(sum(found.still.as_slice()));
                sums.write(record);
            }
            Err(error) => record.word(&error.to_string().len()),
        }
    });
}
