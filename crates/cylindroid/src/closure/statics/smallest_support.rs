//! Smallest value of a support function on the unit sphere, by branch and bound.
//!
//! Formula  for w in the body, h(n) >= w . n; on a spherical simplex w . n is smallest at a corner,
//!          so that max over w of min over the corners is a lower bound; simplices whose bound is
//!          not within the tolerance of the smallest value found are bisected at their longest edge
//! Shapes   d <= 6
//! Units    of the body
//! Valid    any bounded body. Both bounds are certified; where the limit on simplices is reached,
//!          they are those of the last round that was complete
//! Why so   an expanding polytope needs a hundred facets for each vertex in six dimensions: on a
//!          grasp with a ring of equally weak directions, as two opposite soft fingers have it, it
//!          exceeds any limit. Simplices of the sphere need no neighbours, and little memory
//! Source   conical subdivision: Horst & Tuy 1996, chapter 4
//! Checked  tests/it/closure/grasp.rs

use crate::linalg::dot;

/// Most rounds in which the element of the body that bounds a simplex is improved.
const ROUNDS: usize = 8;

/// Rounds of the search, each with half the gap of the one before.
const COARSER: i32 = 4;

pub(super) type Vector = [f64; 6];

/// Bounds of the smallest value and the direction of the upper one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Smallest {
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) direction: Vector,
}

/// The requirements on a search.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    pub(super) dimension: usize,
    /// Maximum difference of the bounds.
    pub(super) gap: f64,
    /// The gap is also at most this times the upper bound, where that is positive.
    pub(super) relative_gap: f64,
    pub(super) max_simplices: usize,
}

#[derive(Clone, Copy)]
struct Corner {
    normal: Vector,
    /// The point of the body farthest along it.
    point: Vector,
}

#[derive(Clone, Copy)]
struct Simplex {
    corners: [Corner; 6],
    lower: f64,
}

/// The smallest value over unit vectors of a support function, given as a map from a unit vector to
/// a farthest point; `known` is a direction at which the value is small.
pub(super) fn smallest_support(
    search: Search,
    known: Vector,
    support: impl Fn(&Vector) -> Vector,
) -> Smallest {
    let mut found = Smallest { lower: f64::NEG_INFINITY, upper: f64::INFINITY, direction: known };
    // The number of simplices grows with the gap to the power of -5/2: what precedes the last round
    // costs little, and is kept where that one meets the limit.
    for halvings in (0..COARSER).rev() {
        let gap = search.gap * f64::from(1 << halvings);
        let mut tree = Tree { search: Search { gap, ..search }, support: &support, found };
        let complete = tree.search();
        found = tree.found;
        if !complete {
            break;
        }
    }
    Smallest { lower: found.lower.min(found.upper), ..found }
}

struct Tree<F> {
    search: Search,
    support: F,
    found: Smallest,
}

impl<F: Fn(&Vector) -> Vector> Tree<F> {
    /// True unless the limit was reached first.
    fn search(&mut self) -> bool {
        let d = self.search.dimension;
        self.corner(self.found.direction);
        let mut open = Vec::new();
        for signs in 0..1_usize << d {
            let corners = std::array::from_fn(|i| {
                let mut normal = [0.0; 6];
                if i < d {
                    normal[i] = if signs >> i & 1 == 0 { 1.0 } else { -1.0 };
                }
                self.corner(normal)
            });
            open.push(self.bounded(corners, f64::NEG_INFINITY));
        }
        let mut lower = f64::INFINITY;
        let mut count = open.len();
        while let Some(simplex) = open.pop() {
            if simplex.lower >= self.target() {
                lower = lower.min(simplex.lower);
            } else if count >= self.search.max_simplices {
                return false;
            } else {
                count += 2;
                open.extend(self.halves(&simplex));
            }
        }
        self.found.lower = self.found.lower.max(lower);
        true
    }

    fn corner(&mut self, normal: Vector) -> Corner {
        let point = (self.support)(&normal);
        let value = dot(&normal, &point);
        if value < self.found.upper && normal != [0.0; 6] {
            (self.found.upper, self.found.direction) = (value, normal);
        }
        Corner { normal, point }
    }

    /// A simplex with at least this bound needs no bisection.
    fn target(&self) -> f64 {
        let Search { gap, relative_gap, .. } = self.search;
        let upper = self.found.upper;
        upper - if upper > 0.0 { gap.min(relative_gap * upper) } else { gap }
    }

    fn bounded(&mut self, corners: [Corner; 6], inherited: f64) -> Simplex {
        let d = self.search.dimension;
        let used = &corners[..d];
        let middle = unit(used.iter().fold([0.0; 6], |s, c| sum(&s, &c.normal)));
        let smallest = |w: &Vector| {
            used.iter()
                .enumerate()
                .map(|(i, c)| (i, dot(w, &c.normal)))
                .fold((0, f64::INFINITY), |m, x| if x.1 < m.1 { x } else { m })
        };
        // Negative products are smallest inside; the plane of the corners is at least this far from
        // the origin.
        let inside = smallest(&middle).1;
        // Fictitious play: mixtures of the middle's point and of the corners' own.
        let mut w = self.corner(middle).point;
        let mut best = f64::NEG_INFINITY;
        for round in 0..ROUNDS {
            let (i, value) = smallest(&w);
            best = best.max(if value < 0.0 { value / inside } else { value });
            if best >= self.target() {
                break;
            }
            let share = 1.0 / (round + 2) as f64;
            w.iter_mut().zip(corners[i].point).for_each(|(x, y)| *x += share * (y - *x));
        }
        Simplex { corners, lower: best.max(inherited) }
    }

    fn halves(&mut self, simplex: &Simplex) -> [Simplex; 2] {
        let corners = &simplex.corners;
        let d = self.search.dimension;
        let mut longest = (2.0, 0, 0);
        for i in 0..d {
            for j in i + 1..d {
                let cosine = dot(&corners[i].normal, &corners[j].normal);
                if cosine < longest.0 {
                    longest = (cosine, i, j);
                }
            }
        }
        let (_, i, j) = longest;
        let middle = self.corner(unit(sum(&corners[i].normal, &corners[j].normal)));
        [i, j].map(|k| {
            let mut half = *corners;
            half[k] = middle;
            self.bounded(half, simplex.lower)
        })
    }
}

fn sum(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

fn unit(a: Vector) -> Vector {
    let length = dot(&a, &a).sqrt();
    a.map(|x| x / length)
}
