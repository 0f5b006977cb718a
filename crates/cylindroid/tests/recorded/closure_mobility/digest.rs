//! Many numbers in a few: weighted sums, in which a change or a permutation shows.

use cylindroid::Matrix;
use cylindroid::linalg::Cut;
use cylindroid::screws::{Screw, ScrewSystem};
use cylindroid::spatial::{Twist, Vec3};

use crate::record::Record;

/// A weight between 0.5 and 1.5 for each place.
fn weight(place: usize) -> f64 {
    1.0 + 0.5 * (1.7 * place as f64 + 0.3).sin()
}

/// A weighted sum.
pub(super) fn sum(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().enumerate().map(|(i, x)| weight(i) * x).sum()
}

/// A weighted sum of the entries of a matrix: another one for its transpose.
pub(super) fn entries(m: &Matrix) -> f64 {
    let place = |i: usize, j: usize| weight(i) * weight(7 * j + 3);
    let all = (0..m.cols()).flat_map(|j| (0..m.rows()).map(move |i| (i, j)));
    all.map(|(i, j)| place(i, j) * m[(i, j)]).sum()
}

/// A sum that is the same for all orthonormal bases of one space.
pub(super) fn span(basis: &Matrix) -> f64 {
    if basis.cols() == 0 { 0.0 } else { entries(&(basis * &basis.transpose())) }
}

fn logarithm(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() { x.log10() } else { -1.0 }
}

pub(super) trait Digests {
    fn counts(&mut self, counts: &[usize]);
    /// A number of any size: its logarithm too.
    fn size(&mut self, x: f64);
    /// A number that is right to five digits.
    fn coarse(&mut self, x: f64);
    fn cut(&mut self, cut: Cut);
    fn vec3(&mut self, v: Vec3);
    fn screw(&mut self, screw: &Screw);
    fn system(&mut self, system: &ScrewSystem);
    fn text(&mut self, text: impl std::fmt::Display);
}

impl Digests for Record {
    fn counts(&mut self, counts: &[usize]) {
        self.text(counts.iter().map(ToString::to_string).collect::<Vec<_>>().join("."));
    }

    fn size(&mut self, x: f64) {
        self.number(logarithm(x));
    }

    fn coarse(&mut self, x: f64) {
        self.word(&(1e4 * x).round());
    }

    fn cut(&mut self, cut: Cut) {
        self.word(&cut.rank.rank);
        let dropped = if cut.dropped > 1e-12 { cut.dropped } else { 0.0 };
        self.number(sum([cut.kept, cut.rank.threshold, dropped].map(logarithm)));
    }

    fn vec3(&mut self, v: Vec3) {
        self.number(sum([v.x, v.y, v.z]));
    }

    fn screw(&mut self, screw: &Screw) {
        // Either way along the axis.
        let d = screw.axis.direction;
        self.number((d.x + 0.8 * d.y + 0.6 * d.z).abs());
        self.vec3(screw.axis.point);
        self.numbers(&[screw.pitch, screw.amplitude]);
    }

    fn system(&mut self, system: &ScrewSystem) {
        self.text(format!("{}{}", system.order(), system.class().name()));
        let about = Vec3::new(0.3, -0.2, 0.5);
        let probe = Twist { linear: Vec3::new(0.1, 0.7, -0.4), angular: about };
        let other = Twist { linear: about, angular: probe.linear };
        self.number(sum([probe, other].map(|twist| system.sine_to(twist))));
    }

    fn text(&mut self, text: impl std::fmt::Display) {
        self.word(&text.to_string());
    }
}
