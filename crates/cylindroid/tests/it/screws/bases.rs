//! The verdict on a space of twists does not depend on the twists that span it.

use cylindroid::screws::{Class, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Pose, Twist};

use super::sample::{CLASSES, Form, Setting, combinations};
use crate::support::Random;

/// An orthonormal basis of a system that departs from a form by `deviation`, at the axes.
fn near(random: &mut Random, form: &Form, deviation: f64) -> Vec<[f64; 6]> {
    form.basis()
        .into_iter()
        .map(|x| {
            let noise = random.vector(6);
            std::array::from_fn(|i| x[i] + deviation * noise[i])
        })
        .collect()
}

fn placed(basis: &[[f64; 6]], pose: Pose) -> Vec<Twist> {
    basis.iter().map(|x| pose.adjoint(Twist::from_array(*x))).collect()
}

/// Products of plane rotations: as many orthonormal combinations.
fn turned(random: &mut Random, twists: &[Twist]) -> Vec<Twist> {
    let mut twists = twists.to_vec();
    let k = twists.len();
    for _ in 0..3 {
        for i in 0..k {
            for j in i + 1..k {
                let (s, c) = random.within(-3.2, 3.2).sin_cos();
                let (a, b) = (twists[i], twists[j]);
                twists[i] = a * c + b * s;
                twists[j] = b * c - a * s;
            }
        }
    }
    twists
}

/// Systems of all classes, off by 1e-13 to 1e-3, with and without noise, from twelve bases each and
/// in twelve frames.
///
/// A threshold is the same for all bases, and what is compared with it departs by rounding: an
/// orthogonal change of basis does not change the class. One of any conditioning, or of the frame,
/// may change the point at which the twists of a nearly degenerate system are compared; if that
/// changes the class, all verdicts are flagged. No constant was chosen on these seeds.
#[test]
fn verdict_does_not_depend_on_the_basis() {
    let mut changes = [0; 3];
    for seed in [31, 32, 33] {
        let mut random = Random(seed);
        for round in 0..400 {
            let here = NearThreshold::random(&mut random, round);
            for (kind, changes) in changes.iter_mut().enumerate() {
                let verdicts: Vec<_> = (0..12).map(|_| here.verdict(&mut random, kind)).collect();
                if verdicts.iter().any(|v| v.0 != verdicts[0].0) {
                    *changes += 1;
                    let flagged = verdicts.iter().all(|v| v.1);
                    assert!(flagged, "{seed} {round} {kind} {here:?} {verdicts:?}");
                }
            }
        }
    }
    assert!(changes[0] == 0 && changes[1] <= 4 && changes[2] <= 72, "{changes:?}");
}

/// A system near the threshold of a class.
#[derive(Debug)]
struct NearThreshold {
    twists: Vec<Twist>,
    options: ScrewOptions,
}

impl NearThreshold {
    fn random(random: &mut Random, round: usize) -> Self {
        let (order, class) = CLASSES[round % CLASSES.len()];
        let form = Form::random(random, order, class);
        let deviation = 10_f64.powf(random.within(-13.0, -3.0));
        let noise = [f64::EPSILON, 1e-9][round / CLASSES.len() % 2];
        let offset = random.within(0.0, 2.0);
        let pose = Setting { offset, ..Setting::PLAIN }.pose(random);
        let twists = placed(&near(random, &form, deviation), pose);
        Self { twists, options: ScrewOptions { noise, ..ScrewOptions::default() } }
    }

    /// From another orthonormal basis, another basis, or in another frame.
    fn verdict(&self, random: &mut Random, kind: usize) -> ((usize, Class), bool) {
        let (twists, options) = match kind {
            0 => (turned(random, &self.twists), self.options),
            1 => (mixed(random, &self.twists), self.options),
            // Noise is relative to the twists, which a motion makes larger: without.
            _ => {
                let turned = turned(random, &self.twists);
                moved(random, &turned, ScrewOptions::default())
            }
        };
        let system = ScrewSystem::of(&twists, &options).unwrap();
        ((system.order(), system.class()), system.is_ambiguous())
    }
}

/// Up to 100 lengths away, turned, in another unit.
fn moved(
    random: &mut Random,
    twists: &[Twist],
    options: ScrewOptions,
) -> (Vec<Twist>, ScrewOptions) {
    let length = 10_f64.powf(random.within(-3.0, 3.0));
    let offset = random.within(0.0, 100.0);
    let pose = Setting { offset, ..Setting::PLAIN }.pose(random);
    let there = |t: &Twist| {
        let t = pose.adjoint(*t);
        Twist { linear: t.linear * length, ..t }
    };
    (twists.iter().map(there).collect(), ScrewOptions { length, ..options })
}

/// Twists of sizes 0.1 to 10, conditioned up to 10.
fn mixed(random: &mut Random, twists: &[Twist]) -> Vec<Twist> {
    let unit: Vec<[f64; 6]> =
        (0..twists.len()).map(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)))).collect();
    combinations(random, &unit, twists.len())
        .into_iter()
        .map(|c| twists.iter().zip(c).fold(Twist::ZERO, |s, (t, c)| s + *t * c))
        .collect()
}
