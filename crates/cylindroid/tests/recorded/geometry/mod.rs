//! Rotations, screws, kinematics and manipulability: numbers of random mechanisms and of degenerate
//! ones.

mod batches;
mod efficiencies;
mod joints;
mod lines;
mod mechanisms;
mod projectors;
mod rotations;
mod stiffness;
mod systems;

use cylindroid::spatial::{Mat3, Pose, Rotation, Twist, Vec3};
use cylindroid::{Error, Matrix, Screw};

use crate::record::Record;
use crate::robots::Random;

/// A sum of numbers with weights that differ.
fn sum(numbers: &[f64]) -> f64 {
    numbers.iter().enumerate().map(|(i, x)| x / (i as f64 + 1.3)).sum()
}

fn vector(record: &mut Record, v: Vec3) {
    record.number(sum(&v.to_array()));
}

fn twist(record: &mut Record, t: Twist) {
    record.number(sum(&t.to_array()));
}

fn pose(record: &mut Record, p: Pose) {
    record.number(sum(p.to_matrix().as_flattened()));
}

fn entries(m: Mat3) -> f64 {
    sum(m.to_rows().as_flattened())
}

/// Its entries in a sum.
fn matrix(record: &mut Record, m: &Matrix) {
    record.number(sum(m.as_slice()));
}

/// A A^T in a sum: the same for all orthonormal bases and signs of columns.
fn span(columns: &Matrix) -> f64 {
    sum((columns * &columns.transpose()).as_slice())
}

/// Small numbers in a word.
fn counts(record: &mut Record, counts: &[usize]) {
    let all: Vec<String> = counts.iter().map(ToString::to_string).collect();
    record.word(&format_args!("{}.", all.join(".")));
}

/// Yes or no to each.
fn verdicts(record: &mut Record, verdicts: &[bool]) {
    counts(record, &[verdicts.iter().fold(1, |all, v| 2 * all + usize::from(*v))]);
}

/// Its beginning, its length and its digits.
fn text(record: &mut Record, text: &str) {
    let beginning: String = text.chars().filter(|c| c.is_alphabetic()).take(9).collect();
    let digits: String = text.chars().filter(char::is_ascii_digit).take(12).collect();
    record.word(&format_args!("{beginning}{}:{digits}", text.len()));
}

/// Pitch and amplitude, and direction times point, which do not depend on the sign of the direction.
fn screw(record: &mut Record, s: &Screw) {
    record.number(s.pitch);
    record.number(s.amplitude + sum(&s.axis.point.to_array()));
}

fn error<T>(record: &mut Record, result: Result<T, Error>) -> Option<T> {
    match &result {
        Ok(_) => {}
        // The value has digits that rounding decides.
        Err(Error::InvalidOption { option, reason, .. }) => {
            text(record, &format!("{option} {reason}"));
        }
        Err(error) => text(record, &error.to_string()),
    }
    result.ok()
}

fn selection(components: &[usize], d: usize) -> Matrix {
    Matrix::from_fn(components.len(), d, |i, j| f64::from(u8::from(components[i] == j)))
}

fn random_matrix(random: &mut Random<'_>, rows: usize, cols: usize) -> Matrix {
    Matrix::from_fn(rows, cols, |_, _| random.within(-1.0, 1.0))
}

/// A product of matrices of small integers, of this rank at most.
fn integers(random: &mut Random<'_>, rows: usize, cols: usize, rank: usize) -> Matrix {
    let mut factor = |m, n| Matrix::from_fn(m, n, |_, _| random.below(7) as f64 - 3.0);
    let (a, b) = (factor(rows, rank), factor(rank, cols));
    &a * &b
}

/// Symmetric and positive definite.
fn definite(random: &mut Random<'_>, n: usize) -> Matrix {
    let a = random_matrix(random, n, n);
    let gram = &a * &a.transpose();
    let mean = |i: usize, j: usize| 0.5 * (gram[(i, j)] + gram[(j, i)]);
    Matrix::from_fn(n, n, |i, j| mean(i, j) + if i == j { 0.3 } else { 0.0 })
}

/// Along a coordinate axis, in a plane of two of them, or anywhere.
fn direction(random: &mut Random<'_>) -> Vec3 {
    let sign = if random.once_in(2) { 1.0 } else { -1.0 };
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let first = axes[random.below(3)] * sign;
    match random.below(4) {
        0 => first,
        1 => (first + axes[random.below(3)] * random.within(0.1, 0.9)).unit(0.0).unwrap(),
        _ => (random.vec3(1.0) + first * 0.1).unit(0.0).unwrap(),
    }
}

fn random_twist(random: &mut Random<'_>, length: f64) -> Twist {
    Twist { linear: random.vec3(length), angular: random.vec3(1.0) }
}

/// Axes along those of the parent, or anywhere.
fn placement(random: &mut Random<'_>, size: f64) -> Pose {
    let quarter = std::f64::consts::FRAC_PI_2;
    let translation = match random.below(4) {
        0 => Vec3::ZERO,
        1 => direction(random) * size,
        _ => random.vec3(size),
    };
    let rotation = match random.below(4) {
        0 => Rotation::IDENTITY,
        1 => Rotation::about(Vec3::X, quarter).unwrap(),
        2 => Rotation::about(direction(random), quarter * random.below(4) as f64).unwrap(),
        _ => return random.pose(size),
    };
    Pose { rotation, translation }
}
