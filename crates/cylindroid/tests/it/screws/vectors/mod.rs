//! Every case of the reference set of screw systems (tests/data/screws.json): computed with exact
//! fractions where the entries are fractions, with 40 digits elsewhere, by the authors of the
//! corrected theory. Twists there are angular first; here the halves are exchanged.

mod arms;
mod examples;
mod lines;
mod normal_forms;
mod projections;

use cylindroid::inverse::HyperbolicOptions;
use cylindroid::linalg::Matrix;
use cylindroid::screws::ScrewOptions;
use cylindroid::spatial::Twist;
use serde_json::Value;

fn reference() -> Value {
    let text = include_str!("../../../data/screws.json");
    serde_json::from_str(text).unwrap()
}

fn number(v: &Value) -> f64 {
    match v {
        Value::Number(n) => n.as_f64().unwrap(),
        Value::String(s) => match s.split_once('/') {
            Some((a, b)) => a.parse::<f64>().unwrap() / b.parse::<f64>().unwrap(),
            None => s.parse().unwrap(),
        },
        _ => panic!("not a number: {v}"),
    }
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(number).collect()
}

/// A list of rows as it stands.
pub(super) fn reference_matrix(v: &Value) -> Matrix {
    plain(v)
}

/// The exact entries where there are any.
fn plain(v: &Value) -> Matrix {
    let rows = v.get("exact").or_else(|| v.get("float")).unwrap_or(v);
    let rows: Vec<Vec<f64>> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|r| if r.is_array() { numbers(r) } else { vec![number(r)] })
        .collect();
    Matrix::from_rows(&rows).unwrap()
}

fn swap(i: usize) -> usize {
    (i + 3) % 6
}

/// Columns are twists (or wrenches).
fn twists(v: &Value) -> Matrix {
    let m = plain(v);
    Matrix::from_fn(6, m.cols(), |i, j| m[(swap(i), j)])
}

/// Acts on twists, gives rates.
fn rates(v: &Value) -> Matrix {
    let m = plain(v);
    Matrix::from_fn(m.rows(), 6, |i, j| m[(i, swap(j))])
}

/// Acts on twists, gives twists.
fn operator(v: &Value) -> Matrix {
    let m = plain(v);
    Matrix::from_fn(6, 6, |i, j| m[(swap(i), swap(j))])
}

fn with_length(length: f64) -> HyperbolicOptions {
    HyperbolicOptions { scale: ScrewOptions::with_length(length), ..HyperbolicOptions::default() }
}

fn column(m: &Matrix, j: usize) -> Twist {
    Twist::from_array(m.column(j).try_into().unwrap())
}

fn scaled_tolerance(expected: &Matrix, relative: f64) -> f64 {
    relative * expected.max_abs().max(1.0)
}
