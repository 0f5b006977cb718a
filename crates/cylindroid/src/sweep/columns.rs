//! Rows into columns: a transpose of blocks.
//!
//! Shapes   rows: N x stride, row-major; a column for each of the first entries of a row
//! Valid    all numbers are moved as they are
//! Why so   one column at a time reads one number of each cache line and asks for room for each: a
//!          third of the time of a sweep. Here as many rows as a register has lanes are read at once,
//!          and each column gets a full register
//! Checked  tests::columns_are_those_of_the_rows

use crate::scalar::{Array, SimdFloat};
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Avx512, Lanes4, Lanes8};

/// Appends the first entries of rows to as many columns.
pub(super) fn append(rows: &[f64], stride: usize, columns: &mut [&mut Vec<f64>]) {
    #[cfg(target_arch = "x86_64")]
    {
        #[allow(unsafe_code)] // the one way to call functions compiled for more
        // SAFETY: the tokens prove that the processor has these features.
        unsafe {
            if let Some(cpu) = Avx512::detect() {
                return append_avx512(cpu, rows, stride, columns);
            }
            if let Some(cpu) = Avx2::detect() {
                return append_avx2(cpu, rows, stride, columns);
            }
        }
    }
    append_with::<Array<4>>((), rows, stride, columns);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn append_avx512(cpu: Avx512, rows: &[f64], stride: usize, columns: &mut [&mut Vec<f64>]) {
    append_with::<Lanes8>(cpu, rows, stride, columns);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn append_avx2(cpu: Avx2, rows: &[f64], stride: usize, columns: &mut [&mut Vec<f64>]) {
    append_with::<Lanes4>(cpu, rows, stride, columns);
}

#[inline(always)]
fn append_with<R: SimdFloat>(
    _: R::Cpu,
    rows: &[f64],
    stride: usize,
    columns: &mut [&mut Vec<f64>],
) {
    let width = columns.len().min(stride);
    if width == 0 {
        return;
    }
    let count = rows.len() / stride;
    let mut to: Vec<&mut [f64]> = columns
        .iter_mut()
        .take(width)
        .map(|column| {
            let before = column.len();
            column.resize(before + count, 0.0);
            &mut column[before..]
        })
        .collect();
    let mut entries = vec![R::splat(0.0); width];
    let whole = count - count % R::LANES;
    let (blocks, rest) = rows.split_at(whole * stride);
    for (block, from) in blocks.chunks_exact(R::LANES * stride).enumerate() {
        R::gather(from, stride, &mut entries);
        for (column, own) in to.iter_mut().zip(&entries) {
            own.store(&mut column[block * R::LANES..]);
        }
    }
    for (i, row) in rest.chunks_exact(stride).enumerate() {
        for (column, x) in to.iter_mut().zip(row) {
            column[whole + i] = *x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_those_of_the_rows() {
        for (count, stride, width) in
            [(0, 3, 3), (1, 1, 1), (7, 42, 42), (8, 7, 7), (29, 16, 5), (64, 2, 2), (5, 3, 0)]
        {
            let number = |row: usize, column: usize| (100 * row + column) as f64;
            let rows: Vec<f64> =
                (0..count * stride).map(|k| number(k / stride, k % stride)).collect();
            let form = |append: fn(&[f64], usize, &mut [&mut Vec<f64>])| {
                let mut columns = vec![vec![-1.0]; width];
                append(&rows, stride, &mut columns.iter_mut().collect::<Vec<_>>());
                for (j, column) in columns.iter().enumerate() {
                    assert_eq!(column[0], -1.0);
                    let expected: Vec<f64> = (0..count).map(|row| number(row, j)).collect();
                    assert_eq!(column[1..], expected, "{count} x {stride}, column {j}");
                }
            };
            form(append);
            form(|rows, stride, columns| append_with::<Array<4>>((), rows, stride, columns));
        }
    }
}
