//! Decompositions of matrices, their spaces, metrics.

use cylindroid::linalg::{ColumnSpace, Cut, Metric, Qr, RowSpace, Svd, SymmetricEigen, Threshold};
use cylindroid::{Matrix, Result};

use super::{KINDS, Sums, any, is_orthonormal, plain, sum, times, vector};
use crate::record::{Record, check};
use crate::robots::Random;

/// Up to nine rows and ten columns; those of arms more often.
fn shape(random: &mut Random<'_>) -> (usize, usize) {
    match random.below(5) {
        0 => (6, 7),
        1 => (6, 6),
        _ => (1 + random.below(9), 1 + random.below(10)),
    }
}

fn any_of_any_shape(random: &mut Random<'_>) -> Matrix {
    let (m, n) = shape(random);
    let kind = random.below(KINDS);
    any(random, kind, m, n)
}

fn left(svd: &Svd, rank: usize) -> Matrix {
    Matrix::from_fn(svd.rows(), rank, |i, j| svd.u(j)[i])
}

fn right(svd: &Svd, rank: usize) -> Matrix {
    Matrix::from_fn(svd.cols(), rank, |i, j| svd.v(j)[i])
}

/// Values that are no rounding, factors, and the truth of the decomposition.
fn of_svd(sums: &mut Sums, svd: &Svd, a: &Matrix) {
    let rank = svd.machine_rank().rank;
    let (u, v) = (left(svd, rank), right(svd, rank));
    let exact = svd.residual(a) < 1e-13 && is_orthonormal(&u) && is_orthonormal(&v);
    sums.count(svd.len() + 10 * rank + usize::from(exact));
    svd.values().take(rank).for_each(|s| sums.size(s));
    for eps in [1e-3, 1e-9] {
        let found = svd.rank(eps);
        sums.count(found.rank);
        sums.size(found.threshold);
        if found.rank < rank {
            sums.size(found.gap);
        }
    }
    sums.number(sum(u.as_slice()));
    sums.number(sum(v.as_slice()));
}

#[test]
fn singular_values_and_vectors() {
    check("algebra_svd", 200, |random, record| {
        let mut sums = Sums::default();
        for _ in 0..3 {
            let a = any_of_any_shape(random);
            of_svd(&mut sums, &Svd::of(&a), &a);
        }
        sums.write(record);
    });
}

#[test]
fn sweeps() {
    check("algebra_sweeps", 300, |random, record| {
        let a = any_of_any_shape(random);
        let svd = Svd::of(&a);
        record.word(&(a.rows(), a.cols(), svd.sweeps()));
    });
}

/// Turning matrices from one warm start to the next, and what no number holds.
#[test]
fn warm_starts() {
    check("algebra_warm", 90, |random, record| {
        let (m, n) = shape(random);
        let (a, b) = (plain(random, m, n), plain(random, m, n));
        let size = random.power(-6.5, 0.0);
        let stops = random.once_in(5);
        let mut svd = Svd::workspace(m, n);
        let (mut now, mut exact) = (a.clone(), true);
        let mut sweeps = Vec::new();
        for step in 0..14 {
            let (sin, cos) = (f64::from(step) * size).sin_cos();
            let zero = stops && step == 8;
            now = times(&a, |i, j| if zero { 0.0 } else { cos + sin * b[(i, j)] / a[(i, j)] });
            svd.decompose_warm(&now);
            exact &= svd.residual(&now) < 1e-13;
            exact &= is_orthonormal(&left(&svd, svd.machine_rank().rank));
            exact &= is_orthonormal(&right(&svd, svd.machine_rank().rank));
            sweeps.push(svd.sweeps());
        }
        record.word(&exact);
        let mut sums = Sums::default();
        of_svd(&mut sums, &svd, &now);
        sums.write(record);
        for count in sweeps {
            record.word(&count);
        }
    });
}

#[test]
fn extreme_numbers() {
    check("algebra_extremes", 40, |random, record| {
        let (m, n) = shape(random);
        let size = [1e307, 1.7e308, 1e-308, 3e-310, f64::NAN, f64::INFINITY][random.below(6)];
        let a = times(&plain(random, m, n), |i, _| if i == 0 { size } else { size.min(1.0) });
        let svd = Svd::of(&a);
        let rank = svd.machine_rank();
        record.word(&(rank.rank, svd.value(0) >= f64::MAX));
        let mut sums = Sums::default();
        for x in [rank.threshold, svd.value(0), a.frobenius_norm(), a.max_abs()] {
            sums.size(x);
        }
        sums.write(record);
    });
}

#[test]
fn row_spaces() {
    check("algebra_row_spaces", 120, |random, record| {
        let a = any_of_any_shape(random);
        let svd = Svd::of(&a);
        let rank = svd.machine_rank().rank;
        let flags: Vec<bool> = (0..1 + random.below(7)).map(|_| random.once_in(2)).collect();
        let first = random.below(9);
        let spaces = [
            RowSpace::exact(&svd),
            RowSpace::first(&svd, first),
            RowSpace::from_kept(&svd, &flags),
        ];
        let x = vector(random, a.cols());
        let left = |space: &RowSpace<'_>| {
            let mut left = x.clone();
            space.project_out(&mut left);
            sum(&left)
        };
        record.word(&(rank, spaces.map(|s| s.rank())));
        record.number(sum(&spaces.each_ref().map(left)));
        let bases = spaces.iter().take(if rank == svd.len() { 3 } else { 1 });
        let bases: Vec<Matrix> = bases.map(RowSpace::null_space_basis).collect();
        record.word(&bases.iter().map(|b| (b.cols(), is_orthonormal(b))).collect::<Vec<_>>());
        record.number(sum(&bases.iter().map(|b| sum(b.as_slice())).collect::<Vec<_>>()));
    });
}

#[test]
fn symmetric_eigenproblems() {
    check("algebra_eigen", 80, |random, record| {
        let mut sums = Sums::default();
        for _ in 0..3 {
            of_eigenproblem(random, &mut sums);
        }
        sums.write(record);
    });
}

fn of_eigenproblem(random: &mut Random<'_>, sums: &mut Sums) {
    let (n, size) = (random.below(8), random.power(-100.0, 100.0));
    let kind = random.below(6);
    let a = plain(random, 6, 6);
    let entries: [[f64; 6]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|j| match kind {
            0 if i != j => 0.0,
            1 if j != i + 3 => 0.0,
            2 => 1.0,
            3 => a[(i, j)] * 10_f64.powi(-3 * (i + j) as i32),
            4 if i == j => 1.0,
            _ => a[(i, j)] * size,
        })
    });
    let block: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| entries[i][j]));
    let (eigen, three) = (SymmetricEigen::of(entries, n), SymmetricEigen::of(block, n));
    for values in [&eigen.values[..], &three.values[..]] {
        sums.scaled(values);
        values.iter().filter(|_| kind == 3).for_each(|x| sums.size(*x));
    }
    sums.number(sum(eigen.vectors.as_flattened()));
    sums.number(sum(three.vectors.as_flattened()));
}

#[test]
fn reflections() {
    check("algebra_qr", 90, |random, record| {
        let a = any_of_any_shape(random);
        let a = times(&a, |_, _| 1.0 / a.max_abs().max(f64::MIN_POSITIVE));
        let x = vector(random, a.rows());
        for qr in [Qr::plain(a.clone()), Qr::pivoted(a.clone())] {
            let (mut there, mut back) = (x.clone(), x.clone());
            qr.apply(&mut there);
            qr.apply_transposed(&mut back);
            let whole = qr.order().iter().map(|&j| j as f64).collect::<Vec<_>>();
            let parts = [sum(&whole), qr.first_pivot(), sum(qr.r().as_slice())];
            record.number(sum(&parts));
            let (basis, complement) = (qr.basis(), qr.complement());
            let parts = [&there, &back, basis.as_slice(), complement.as_slice()].map(sum);
            record.number(sum(&parts));
        }
    });
}

/// Up to the sizes of closed chains, cut anywhere.
#[test]
fn column_spaces() {
    check("algebra_column_spaces", 160, |random, record| {
        let (m, n) = if random.once_in(6) { (18, 14) } else { shape(random) };
        let kind = random.below(KINDS);
        let a = any(random, kind, m, n);
        let eps = random.power(-13.0, 0.0);
        let threshold = match random.below(3) {
            0 => Threshold::Absolute(eps),
            _ => Threshold::Relative(eps),
        };
        let space = ColumnSpace::of(&a, threshold);
        let (basis, complement) = (space.basis(), space.complement());
        let exact = is_orthonormal(&Matrix::hstack(m, &[&basis, &complement]));
        let largest = space.values().first().copied().unwrap_or(0.0);
        let clear: Vec<f64> = space.values().iter().map(|s| s / largest).collect();
        let count = clear.iter().filter(|s| **s > 1e-12).count();
        record.word(&(space.rank(), complement.cols(), space.cut().is_ambiguous(), exact, count));
        let mut sums = Sums::default();
        sums.size(space.cut().rank.threshold);
        sums.size(space.cut().kept);
        sums.number(sum(&clear));
        if space.cut().dropped > 1e-11 * largest {
            sums.size(space.cut().dropped);
            sums.size(space.cut().rank.gap);
        }
        sums.write(record);
        record.number(sum(basis.as_slice()) + 0.3 * sum(complement.as_slice()));
    });
}

#[test]
fn cuts() {
    check("algebra_cuts", 60, |random, record| {
        let mut values: Vec<f64> = (0..random.below(5)).map(|_| random.power(-9.0, 1.0)).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        if random.once_in(3) {
            values.push(0.0);
        }
        let cut = Cut::of(&values, random.power(-9.0, 0.0));
        record.word(&(cut.rank.rank, cut.is_ambiguous()));
        let mut sums = Sums::default();
        for x in [cut.kept, cut.dropped, cut.rank.gap, cut.rank.threshold] {
            sums.size(x);
        }
        sums.write(record);
    });
}

/// A metric of n coordinates.
pub(super) fn metric(random: &mut Random<'_>, n: usize) -> Metric {
    if random.once_in(4) {
        let weights: Vec<f64> = (0..n).map(|_| random.power(-2.0, 2.0)).collect();
        return Metric::diagonal("weights", &weights).unwrap();
    }
    let root = plain(random, n, n);
    let square = &root.transpose() * &root;
    let least = random.power(-3.0, 0.0);
    let entry = |i, j| square[(i, j)] + if i == j { least } else { 0.0 };
    Metric::new("metric", &Matrix::from_fn(n, n, entry)).unwrap()
}

#[test]
fn metrics() {
    check("algebra_metrics", 60, |random, record| {
        let n = 1 + random.below(6);
        let own = metric(random, n);
        record.word(&(own.len(), own.is_empty()));
        let mut sums = Sums::default();
        sums.size(own.diagonal_ratio());
        sums.scaled(own.lower().as_slice());
        sums.scaled(own.dual().lower().as_slice());
        let x = vector(random, n);
        let acts: [fn(&Metric, &mut [f64]); 4] =
            [Metric::apply, Metric::whiten, Metric::unwhiten, Metric::unwhiten_dual];
        for act in acts {
            let mut y = x.clone();
            act(&own, &mut y);
            sums.scaled(&y);
        }
        let (kind, cols) = ([13, 13, 2, 0][random.below(4)], 1 + random.below(n + 1));
        let basis = any(random, kind, n, cols);
        let (mut rows, mut columns) = (basis.clone(), basis.transpose());
        own.whiten_rows(&mut rows);
        own.solve_right(&mut columns);
        sums.scaled(rows.as_slice());
        sums.scaled(columns.as_slice());
        sums.write(record);
        for found in [own.restricted("basis", &basis), own.of_images("map", &basis.transpose())] {
            of_metric(record, found);
        }
    });
}

fn of_metric(record: &mut Record, found: Result<Metric>) {
    match found {
        Ok(metric) => {
            let mut sums = Sums::default();
            sums.scaled(metric.lower().as_slice());
            sums.write(record);
        }
        Err(error) => record.word(&error.to_string().len()),
    }
}

/// Nearly symmetric, indefinite, of another shape, not finite.
#[test]
fn refused_metrics() {
    check("algebra_refused", 40, |random, record| {
        let n = 1 + random.below(4);
        let mut a = plain(random, n, n);
        let size = random.power(-3.0, 3.0);
        for i in 0..n {
            for j in 0..i {
                a[(i, j)] = a[(j, i)] * (1.0 + random.within(-4e-9, 4e-9));
            }
            a[(i, i)] = a[(i, i)] * a[(i, i)] + random.within(0.0, 2.0);
        }
        let a = times(&a, |_, _| size);
        let (rows, odd) = (random.below(n + 1), random.below(n));
        let mut bad = a.clone();
        bad[(odd, odd)] = [f64::NAN, f64::INFINITY, 0.0][random.below(3)];
        for matrix in [a.clone(), a.rows_between(0, rows), bad] {
            of_metric(record, Metric::new("metric", &matrix));
        }
        let weights = [random.within(-1.0, 3.0), random.within(0.0, 1.0)];
        record
            .word(&Metric::diagonal("weights", &weights).map_err(|e| e.to_string().len()).is_ok());
    });
}

#[test]
fn parts_and_products() {
    check("algebra_parts", 40, |random, record| {
        let (a, b) = (any_of_any_shape(random), any_of_any_shape(random));
        let (a, b) = (
            times(&a, |_, _| 1.0 / a.max_abs().max(f64::MIN_POSITIVE)),
            times(&b, |_, _| 1.0 / b.max_abs().max(f64::MIN_POSITIVE)),
        );
        let rows = [random.below(a.rows() + 1), a.rows()];
        let columns = [random.below(a.cols() + 1), a.cols()];
        let x = vector(random, 5);
        let mut y = vec![7.0; 4];
        a.tr_mul_vec_into(&x, &mut y);
        let parts = [
            a.rows_between(rows[0], rows[1]),
            a.columns_between(columns[0], columns[1]),
            &a * &plain(random, a.cols(), 2),
            Matrix::hstack(a.rows(), &[&a, &a]),
            Matrix::vstack(b.cols(), &[&b, &b]),
            Matrix::diagonal(&x),
        ];
        record.number(sum(&parts.map(|part| sum(part.as_slice()))));
        let norms = [a.row_norm(rows[0].min(a.rows() - 1)), a.frobenius_norm(), b.max_abs()];
        record.number(sum(&[sum(&a.mul_vec(&x)), sum(&y), sum(&norms)]));
        record.word(&(a.max_difference(&b) == f64::INFINITY, a.is_finite()));
        let other = |j: usize| times(&a, |i, k| 1.0 + 0.1 * (i + j * k) as f64);
        record.numbers(&[a.max_difference(&other(2)), Svd::of(&a).residual(&other(1))]);
        let size = random.power(-200.0, 200.0);
        let mut sums = Sums::default();
        sums.size(times(&a, |_, _| size).frobenius_norm());
        sums.write(record);
    });
}
