//! Screw systems of known class in random frames, spanned by random twists.
//!
//! The normal forms are written down here once more, after tables 1 and 2 of the paper with the
//! angular part first, so that those of the library are held to something.

use cylindroid::linalg::Svd;
use cylindroid::screws::{Class, ScrewOptions};
use cylindroid::spatial::{Pose, Twist, Vec3};
use cylindroid::{Matrix, screws};

use crate::support::Random;

/// Order and class: all there are of order one to five.
pub(super) const CLASSES: [(usize, Class); 23] = [
    (1, Class::H),
    (1, Class::Inf),
    (2, Class::IA),
    (2, Class::IB),
    (2, Class::IIA),
    (2, Class::IIB),
    (2, Class::IIC),
    (3, Class::IA1),
    (3, Class::IA2),
    (3, Class::IIA),
    (3, Class::IB0),
    (3, Class::IB3),
    (3, Class::IIB),
    (3, Class::IC),
    (3, Class::IIC),
    (3, Class::IID),
    (4, Class::IA),
    (4, Class::IB),
    (4, Class::IIA),
    (4, Class::IIB),
    (4, Class::IIC),
    (5, Class::H),
    (5, Class::Inf),
];

/// A class with numbers, in units of the characteristic length.
#[derive(Debug, Clone)]
pub(super) struct Form {
    pub(super) order: usize,
    pub(super) class: Class,
    pub(super) pitches: Vec<f64>,
    pub(super) slope: Option<f64>,
}

fn six(w: [f64; 3], v: [f64; 3]) -> [f64; 6] {
    [v[0], v[1], v[2], w[0], w[1], w[2]]
}

impl Form {
    /// Pitches within 2 and at least 0.2 apart, one in four of them zero; slopes up to 2.
    pub(super) fn random(random: &mut Random, order: usize, class: Class) -> Self {
        let count = match class {
            Class::IA | Class::IA2 | Class::IB3 => 2,
            Class::IA1 => 3,
            Class::H | Class::IIA | Class::IIB | Class::IB0 => 1,
            Class::IIC if order == 3 => 1,
            _ => 0,
        };
        let mut pitches: Vec<f64> = vec![];
        while pitches.len() < count {
            let h = if random.within(0.0, 4.0) < 1.0 { 0.0 } else { random.within(-2.0, 2.0) };
            if pitches.iter().all(|p: &f64| (p - h).abs() > 0.2) {
                pitches.push(h);
            }
        }
        if class != Class::IA2 {
            pitches.sort_by(|a, b| b.total_cmp(a));
        }
        let leans = matches!(class, Class::IB | Class::IB0 | Class::IC);
        let slope = leans.then(|| (random.within(-0.5, 2.0)).max(0.0));
        Self { order, class, pitches, slope }
    }

    /// The rows of the tables; for orders 4 and 5 those of the reciprocal system.
    pub(super) fn rows(&self) -> Vec<[f64; 6]> {
        let h = |i: usize| self.pitches[i.min(self.pitches.len() - 1)];
        let p = self.slope.unwrap_or(0.0);
        let o = [0.0; 3];
        let screw = |i: usize, h: f64| {
            let mut e = [0.0; 3];
            e[i] = 1.0;
            six(e, e.map(|x| x * h))
        };
        let small = if self.order > 3 { 6 - self.order } else { self.order };
        match (small, self.class) {
            (_, Class::H) => vec![screw(0, h(0))],
            (_, Class::Inf) => vec![six(o, [1.0, 0.0, 0.0])],
            (2, Class::IA | Class::IIA) => vec![screw(0, h(0)), screw(1, h(1))],
            (2, Class::IB) => vec![screw(0, 0.0), six(o, [1.0, p, 0.0])],
            (2, Class::IIB) => vec![screw(0, h(0)), six(o, [0.0, 1.0, 0.0])],
            (2, Class::IIC) => vec![six(o, [1.0, 0.0, 0.0]), six(o, [0.0, 1.0, 0.0])],
            (3, Class::IA1 | Class::IA2 | Class::IIA) => {
                vec![screw(0, h(0)), screw(1, h(1)), screw(2, h(2))]
            }
            (3, Class::IB0) => vec![screw(0, h(0)), screw(1, h(0)), six(o, [1.0, 0.0, p])],
            (3, Class::IB3 | Class::IIB) => {
                vec![screw(0, h(0)), screw(1, h(1)), six(o, [0.0, 0.0, 1.0])]
            }
            (3, Class::IC) => vec![screw(0, 0.0), six(o, [0.0, 1.0, 0.0]), six(o, [1.0, 0.0, p])],
            (3, Class::IIC) => {
                vec![screw(0, h(0)), six(o, [0.0, 1.0, 0.0]), six(o, [0.0, 0.0, 1.0])]
            }
            (3, Class::IID) => (0..3)
                .map(|i| {
                    let mut e = [0.0; 6];
                    e[i] = 1.0;
                    e
                })
                .collect(),
            other => panic!("no normal form {other:?}"),
        }
    }

    /// An orthonormal basis of the system itself.
    pub(super) fn basis(&self) -> Vec<[f64; 6]> {
        let rows = self.rows();
        if self.order <= 3 {
            return orthonormal(&rows, 6);
        }
        // Reciprocal twists are across the exchanged halves.
        let halves: Vec<_> = rows.iter().map(|r| std::array::from_fn(|i| r[(i + 3) % 6])).collect();
        let all: Vec<_> = halves.iter().copied().chain(unit_vectors()).collect();
        orthonormal(&all, 6).split_off(rows.len())
    }
}

fn unit_vectors() -> impl Iterator<Item = [f64; 6]> {
    (0..6).map(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
}

/// What is new in each vector, in their order, until there are `most`.
fn orthonormal(vectors: &[[f64; 6]], most: usize) -> Vec<[f64; 6]> {
    let mut basis: Vec<[f64; 6]> = vec![];
    for v in vectors {
        let mut x = *v;
        for _ in 0..2 {
            for b in &basis {
                let along: f64 = x.iter().zip(b).map(|(a, b)| a * b).sum();
                x.iter_mut().zip(b).for_each(|(a, b)| *a -= along * b);
            }
        }
        let norm = x.iter().map(|a| a * a).sum::<f64>().sqrt();
        if norm > 0.1 && basis.len() < most {
            basis.push(x.map(|a| a / norm));
        }
    }
    basis
}

/// Where a form stands and what it is spanned by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setting {
    /// Characteristic length.
    pub(super) length: f64,
    /// Distance of the canonical frame from the origin, over the length.
    pub(super) offset: f64,
    /// Relative error of the linear and of the angular part of each twist.
    pub(super) noise: f64,
}

impl Setting {
    pub(super) const PLAIN: Self = Self { length: 1.0, offset: 1.0, noise: 0.0 };

    pub(super) fn options(&self) -> ScrewOptions {
        let options = ScrewOptions::with_length(self.length);
        if self.noise > 0.0 { ScrewOptions { noise: self.noise, ..options } } else { options }
    }

    /// The error that is left at the axes: digits are lost on the way to the origin.
    pub(super) fn error(&self) -> f64 {
        self.noise.max(f64::EPSILON) * self.offset.max(1.0)
    }

    /// Not far along the first axis of the form: moments would then be small and their rounding
    /// not, which is noise.
    pub(super) fn pose(&self, random: &mut Random) -> Pose {
        let rotation = random.rotation();
        let (along, angle) = (random.within(-0.8, 0.8), random.within(-3.1, 3.1));
        let across = f64::sqrt(1.0 - along * along);
        let direction = Vec3::new(along, across * angle.cos(), across * angle.sin());
        Pose { rotation, translation: rotation * direction * (self.offset * self.length) }
    }
}

/// Condition of the unit columns.
fn condition(columns: &Matrix, rank: usize) -> f64 {
    let mut unit = columns.clone();
    for j in 0..unit.cols() {
        let norm = unit.column(j).iter().map(|x| x * x).sum::<f64>().sqrt();
        unit.column_mut(j).iter_mut().for_each(|x| *x /= norm);
    }
    let svd = Svd::of(&unit);
    svd.value(0) / svd.value(rank - 1)
}

/// As many random combinations of a basis, of conditioning below 10 and of sizes 0.1 to 10.
pub(super) fn combinations(random: &mut Random, basis: &[[f64; 6]], count: usize) -> Vec<[f64; 6]> {
    loop {
        let c = random.matrix(basis.len(), count);
        if condition(&c, basis.len()) > 10.0 {
            continue;
        }
        return (0..count)
            .map(|j| {
                let size = 10_f64.powf(random.within(-1.0, 1.0));
                std::array::from_fn(|i| {
                    size * basis.iter().enumerate().map(|(k, b)| b[i] * c[(k, j)]).sum::<f64>()
                })
            })
            .collect();
    }
}

/// `count` twists that span the form in the frame `pose`, with the errors of the setting.
pub(super) fn spanning(
    random: &mut Random,
    basis: &[[f64; 6]],
    count: usize,
    pose: Pose,
    setting: &Setting,
) -> Vec<Twist> {
    combinations(random, basis, count)
        .into_iter()
        .map(|x| {
            let there = Twist::from_array(x);
            let size = x.iter().map(|a| a * a).sum::<f64>().sqrt();
            let scaled = Twist { linear: there.linear * setting.length, ..there };
            let t = pose.adjoint(scaled);
            let far = t.linear.norm().max(setting.length * size);
            Twist {
                linear: t.linear + random.vec3(setting.noise * far),
                angular: t.angular + random.vec3(setting.noise * size),
            }
        })
        .collect()
}

pub(super) fn matrix(twists: &[Twist]) -> Matrix {
    Matrix::from_fn(6, twists.len(), |i, j| twists[j].to_array()[i])
}

/// A system of a class in a random frame.
pub(super) fn system(
    random: &mut Random,
    form: &Form,
    extra: usize,
    setting: &Setting,
) -> (screws::ScrewSystem, Vec<Twist>, Pose) {
    let pose = setting.pose(random);
    let twists = spanning(random, &form.basis(), form.order + extra, pose, setting);
    let system = screws::ScrewSystem::of(&twists, &setting.options()).unwrap();
    (system, twists, pose)
}
