//! Screw systems of all classes, in all frames and units, near the boundaries of their classes: what
//! they are.

use cylindroid::Matrix;
use cylindroid::screws::{Class, NormalForm, ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Pose, Twist, Vec3};

use super::{counts, random_twist, span, sum, vector, verdicts};
use crate::record::{Record, check};
use crate::robots::Random;

const CLASSES: [(usize, Class); 15] = [
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
];

/// A system with the twists that span it.
pub(super) struct Drawn {
    pub(super) system: ScrewSystem,
    pub(super) twists: Vec<Twist>,
    pub(super) options: ScrewOptions,
    /// The unit of its pitches.
    pub(super) length: f64,
}

/// Pitches zero or up to 2, in pairs far apart or so near that the class is narrow.
fn pitches(random: &mut Random<'_>, narrow: bool) -> Vec<f64> {
    let first = [0.0, 1.0, random.within(-2.0, 2.0)][random.below(3)];
    let gap = if narrow { random.power(-9.5, -3.0) } else { random.within(0.2, 1.0) };
    vec![first, first - gap, first - gap - random.within(0.2, 1.0)]
}

/// In units of the length.
fn normal_form(random: &mut Random<'_>, narrow: bool) -> NormalForm {
    let (order, class) = CLASSES[random.below(CLASSES.len())];
    let own = pitches(random, narrow);
    let count = match class {
        Class::IA | Class::IB3 | Class::IA2 => 2,
        Class::IA1 => 3,
        _ => 1,
    };
    let slope = match random.below(3) {
        0 => 0.0,
        1 if narrow => random.power(-10.0, -5.0),
        _ => random.within(0.0, 2.0),
    };
    // As some are inclined by the inverse of this.
    let slope = if narrow && random.once_in(4) { 1.0 / slope.max(1e-9) } else { slope };
    NormalForm { class, order, pitches: own[..count].to_vec(), slope: Some(slope) }
}

/// Of a class, reciprocal to one, in general, or all translations.
fn generators(random: &mut Random<'_>, narrow: bool) -> Vec<Twist> {
    let random_twists = |random: &mut Random<'_>, count: usize| -> Vec<Twist> {
        (0..count).map(|_| random_twist(random, 1.0)).collect()
    };
    match random.below(16) {
        0 => [Vec3::X, Vec3::Y, Vec3::Z]
            .into_iter()
            .map(|linear| Twist { linear, angular: Vec3::ZERO })
            .collect(),
        1 => {
            let count = random.below(7);
            random_twists(random, count)
        }
        2..6 => {
            let twists = normal_form(random, narrow).twists();
            ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap().reciprocal().basis()
        }
        _ => normal_form(random, narrow).twists(),
    }
}

/// Sums of them, a few more than needed, of different sizes.
fn combined(random: &mut Random<'_>, of: &[Twist]) -> Vec<Twist> {
    let count = if of.is_empty() { 0 } else { of.len() + random.below(3) };
    if random.once_in(5) {
        return of.to_vec();
    }
    let mut one = || {
        let size = random.power(-1.0, 1.0);
        of.iter().fold(Twist::ZERO, |t, g| t + *g * (size * random.within(-1.0, 1.0)))
    };
    (0..count).map(|_| one()).collect()
}

pub(super) fn drawn(random: &mut Random<'_>, narrow: bool) -> Drawn {
    let length = random.power(-2.0, 2.0);
    let own = generators(random, narrow);
    let mut twists = combined(random, &own);
    let offset = [0.0, 1.0, random.power(0.0, 1.5), random.power(1.5, 3.0)][random.below(4)];
    let pose = random.pose(offset * length);
    let exactly = narrow || random.once_in(2);
    let noise = if exactly { f64::EPSILON } else { random.power(-12.0, -8.0) };
    let there = |t: Twist| pose.adjoint(Twist { linear: t.linear * length, ..t });
    twists.iter_mut().for_each(|t| *t = there(*t));
    if !exactly {
        for t in &mut twists {
            let size = (t.linear.norm() / length).max(t.angular.norm());
            *t = *t + random_twist(random, length) * (0.3 * noise * size);
        }
    }
    match random.below(10) {
        0 => twists.push(Twist::ZERO),
        1 if !twists.is_empty() => twists.push(random_twist(random, length) * 1e-14),
        2 if narrow && !twists.is_empty() => {
            let away = random_twist(random, length) * random.power(-13.0, -5.0);
            twists.push(twists[0] + away);
        }
        _ => {}
    }
    let options = ScrewOptions {
        length: length * [1.0, random.power(-1.0, 1.0)][random.below(2)],
        center: random.once_in(4).then(|| pose * random.vec3(length)),
        noise,
    };
    let system = ScrewSystem::of(&twists, &options).unwrap();
    Drawn { system, twists, options, length }
}

/// One that is wanted, if there is one among the first eight.
pub(super) fn drawn_until(
    random: &mut Random<'_>,
    narrow: bool,
    wanted: impl Fn(&ScrewSystem) -> bool,
) -> Drawn {
    let mut found = drawn(random, narrow);
    for _ in 0..7 {
        if wanted(&found.system) {
            break;
        }
        found = drawn(random, narrow);
    }
    found
}

/// With an inverse for some pitch.
pub(super) fn invertible(system: &ScrewSystem) -> bool {
    !system.class().never_invertible() && (1..6).contains(&system.order())
}

/// In units of the length.
fn basis(system: &ScrewSystem) -> Matrix {
    let l = system.length();
    let twists = system.basis();
    let there = Pose::from_translation(-system.center());
    Matrix::from_fn(6, twists.len(), |i, j| {
        there.adjoint(twists[j]).to_array()[i] / if i < 3 { l } else { 1.0 }
    })
}

/// What it is, the steady things first.
pub(super) fn kind(record: &mut Record, system: &ScrewSystem) {
    let form = system.normal_form();
    let (order, ambiguous) = (system.order(), u8::from(system.is_ambiguous()));
    record.word(&format_args!("{}.{order}.{}.{ambiguous}", form.class, form.order));
    let length = system.length();
    let pitches: Vec<f64> = form.pitches.iter().map(|h| h / length).collect();
    record.number(sum(&pitches));
    record.number(1e6 * system.tolerance() + 1e9 * system.rank().threshold);
    if let Some(p) = form.slope.filter(|p| *p < 1e3) {
        record.number(p);
    }
}

/// Where it is.
fn place(record: &mut Record, system: &ScrewSystem) {
    let length = system.length();
    let margins = system.margins().iter();
    let margins: Vec<f64> = margins.map(|m| m.value + 1e6 * m.threshold).collect();
    record.number(sum(&margins));
    vector(record, system.center() * (1.0 / length));
    record.number(span(&basis(system)));
    let Pose { rotation, translation } = system.canonical_pose();
    vector(record, translation * (1.0 / length));
    let [x, y] = [rotation.x_axis(), rotation.y_axis()]
        .map(|axis| sum(&[axis.x * axis.x, axis.x * axis.y, axis.y * axis.z]));
    record.number(x + 0.7 * y);
    record.number(sum(&rotation.matrix().to_rows()[0]));
}

#[test]
fn what_they_are() {
    check("geometry_systems", 120, |random, record| {
        let Drawn { system, length, .. } = drawn(random, false);
        kind(record, &system);
        let words: Vec<&str> = system.margins().iter().map(|m| m.quantity).collect();
        let words = words.concat().len() + system.normal_form().meaning().len();
        counts(record, &[words]);
        record.number(system.length() / length);
        let gap = system.rank().gap;
        verdicts(record, &[gap.is_infinite(), gap > 1e4]);
        place(record, &system);
    });
}

#[test]
fn which_are_narrow() {
    check("geometry_narrow", 150, |random, record| {
        let Drawn { system, .. } = drawn(random, true);
        kind(record, &system);
        counts(record, &[system.normal_form().meaning().len()]);
        record.number(1e6 * system.residual());
        let margins = system.margins().iter();
        let margins: Vec<f64> = margins.map(|m| m.value.max(1e-10).log10()).collect();
        record.number(sum(&margins));
    });
}

#[test]
fn their_principal_screws() {
    check("geometry_principal", 60, |random, record| {
        let Drawn { system, length, .. } = drawn_until(random, false, invertible);
        counts(record, &[system.principal_screws().len()]);
        for s in system.principal_screws() {
            let point = s.axis.point * (1.0 / length);
            record.number(s.pitch / length + 0.7 * s.amplitude + sum(&point.to_array()));
        }
        let pencil = system.pencil(5);
        counts(record, &[pencil.len()]);
        pencil.iter().for_each(|s| {
            let point = s.axis.point * (1.0 / length);
            let numbers = [s.pitch.min(1e4) / length, s.amplitude, sum(&point.to_array())];
            record.number(sum(&numbers));
        });
    });
}

#[test]
fn their_sums_and_intersections() {
    check("geometry_sums", 60, |random, record| {
        let Drawn { system, twists, options, length } = drawn(random, false);
        let mut others: Vec<Twist> = twists.iter().take(random.below(3)).copied().collect();
        (0..random.below(3)).for_each(|_| others.push(random_twist(random, length)));
        let other_options =
            ScrewOptions { length: options.length * [1.0, 2.0][random.below(2)], ..options };
        let other = ScrewSystem::of(&others, &other_options).unwrap();
        for derived in [system.sum(&other), system.intersection(&other), system.reciprocal()] {
            kind(record, &derived);
        }
        record.number(system.sine_to_system(&other) + 0.7 * other.sine_to_system(&system));
        let member = twists.first().copied().unwrap_or(Twist::ZERO);
        let away = random_twist(random, length);
        for t in [member, away, Twist::ZERO, member + away * random.power(-10.0, -4.0)] {
            record.number(system.sine_to(t) + f64::from(u8::from(system.contains(t))));
        }
        let h = [0.0, length * random.within(-2.0, 2.0), f64::INFINITY][random.below(3)];
        kind(record, &system.h_reciprocal(h));
        let along = other.projector_along(&system.reciprocal());
        verdicts(record, &[along.is_some()]);
        if let Some(projector) = along.filter(|p| p.norm() < 1e3) {
            record.number(projector.norm() + sum(projector.matrix().as_slice()));
        }
    });
}

/// Options out of their domains, and twists that are not finite.
#[test]
fn refused() {
    check("geometry_refused", 16, |random, record| {
        let bad = [0.0, -1.0, f64::NAN, f64::INFINITY][random.below(4)];
        let noise = [0.0, 0.099, 0.1, -1e-9, f64::NAN][random.below(5)];
        let center = [None, Some(Vec3::new(f64::NAN, 0.0, 1.0)), Some(Vec3::X)][random.below(3)];
        let length = [1.0, bad][random.below(2)];
        let mut twists = vec![random_twist(random, 1.0); 2];
        twists[1].linear.y = [0.5, f64::NAN, f64::INFINITY][random.below(3)];
        let found = ScrewSystem::of(&twists, &ScrewOptions { length, center, noise });
        if let Some(system) = super::error(record, found) {
            kind(record, &system);
        }
        let short = super::random_matrix(random, 5, 2);
        let _ = super::error(record, ScrewSystem::of_columns(&short, &ScrewOptions::default()));
    });
}
