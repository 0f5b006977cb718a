//! Screw systems: their forms, inverses, projectors and conics.

use cylindroid::control::{Servo, ServoOptions, Target, TaskProjection};
use cylindroid::inverse::{
    HyperbolicDamping, HyperbolicOptions, hyperbolic_svd, hyperbolic_with, oblique,
};
use cylindroid::linalg::Metric;
use cylindroid::screws::{Complement, ErrorFormZeros, Projector, ScrewSystem, Signature};
use cylindroid::spatial::{Twist, Wrench};
use cylindroid::{Matrix, Method, ReferenceFrame};

use super::mechanisms::chain;
use super::systems::{Drawn, drawn_until, invertible};
use super::{counts, definite, error, matrix, random_twist, sum, text, twist, verdicts};
use crate::record::{Record, check};
use crate::robots::{self, Random};

/// Zero, infinite, a principal pitch or near one, or any.
fn pitch(random: &mut Random<'_>, system: &ScrewSystem, length: f64) -> f64 {
    let principal = system.principal_pitches();
    match random.below(8) {
        0 => 0.0,
        1 | 2 => f64::INFINITY,
        3 if !principal.is_empty() => principal[0],
        4 if !principal.is_empty() => {
            principal[principal.len() - 1] + length * random.power(-11.0, -3.0)
        }
        5 => length * random.power(7.0, 10.0),
        _ => length * random.within(-3.0, 3.0),
    }
}

/// Over the length.
fn over(length: f64, t: Twist) -> Twist {
    Twist { linear: t.linear * (1.0 / length), ..t }
}

fn projected(record: &mut Record, p: &Projector, random: &mut Random<'_>, length: f64) {
    let t = random_twist(random, length);
    twist(record, over(length, p.motion(t) + p.rest(t) * 0.7));
    let w = Wrench { force: random.vec3(1.0 / length), moment: random.vec3(1.0) };
    let image = p.constraint(w);
    let image = [image.force * length, image.moment].map(|v| sum(&v.to_array()));
    record.number(p.norm() + sum(&image));
    record.number(sum(p.constraint_matrix().as_slice()));
}

#[test]
fn existence_of_inverses() {
    check("geometry_existence", 150, |random, record| {
        let narrow = random.once_in(3);
        let some = random.once_in(6);
        let wanted = |s: &ScrewSystem| some || invertible(s);
        let Drawn { system, length, .. } = drawn_until(random, narrow, wanted);
        let h = pitch(random, &system, length);
        let found = system.existence(h);
        verdicts(record, &[found.exists]);
        if let Some(reason) = found.reason {
            text(record, &format!("{reason:?}")[..8]);
            counts(record, &[reason.to_string().len()]);
        }
        record.number(1e6 * found.threshold + found.margin);
        let Signature { positive, negative, zero } = system.signature(h);
        counts(record, &[positive, negative, zero]);
        if let Some(p) = system.projector(h).filter(|p| p.norm() < 1e4) {
            projected(record, &p, random, length);
        }
    });
}

#[test]
fn pitches_of_choice() {
    check("geometry_pitches", 30, |random, record| {
        let some = random.once_in(8);
        let Drawn { system, .. } = drawn_until(random, false, |s| some || invertible(s));
        let found = system.choose_pitch();
        let finite = found.pitch.map(f64::is_finite);
        verdicts(record, &[found.attained, finite.is_some(), finite == Some(true)]);
        // Rounding decides on the two at ten lengths.
        let own = system.length();
        let nearer = |most: f64| found.curve.iter().filter(|c| c.0.abs() < most * own).count();
        counts(record, &[nearer(9.9), nearer(1e3) - nearer(10.1)]);
        record.numbers(&[found.norm, found.norm_at_infinity]);
        let small = |x: f64| if x < 1e3 { x } else { 1e3 };
        let numbers: Vec<f64> = found
            .curve
            .iter()
            .filter(|c| c.0.abs() < 9.9 * own)
            .map(|(h, n)| h / own + small(*n))
            .collect();
        record.number(sum(&numbers));
        if let Some(h) = found.pitch {
            // A minimum is flat: half the digits.
            record.number(1e-4 * (1e4 * h / own).round());
        }
    });
}

#[test]
fn errors_in_the_form() {
    check("geometry_errors", 100, |random, record| {
        let some = random.once_in(8);
        let wanted = |s: &ScrewSystem| some || invertible(s);
        let Drawn { system, twists, length, .. } = drawn_until(random, false, wanted);
        let t = match random.below(3) {
            0 if !twists.is_empty() => twists[0],
            _ => random_twist(random, length),
        };
        let h = pitch(random, &system, length);
        let value = system.error_form(t, h).map(|e| e / if h.is_infinite() { 1.0 } else { length });
        record.number(value.unwrap_or(-999.0));
        match system.error_form_zeros(t).unwrap() {
            ErrorFormZeros::At(zeros) => {
                counts(record, &[zeros.len()]);
                record.number(sum(&zeros.iter().map(|h| h / length).collect::<Vec<_>>()));
            }
            other => record.word(&other),
        }
    });
}

#[test]
fn projectors_of_twists() {
    check("geometry_projectors", 160, |random, record| {
        let some = random.once_in(4);
        let wanted = |s: &ScrewSystem| some || invertible(s);
        let Drawn { system, twists, options, length } = drawn_until(random, false, wanted);
        let h = pitch(random, &system, length);
        let count = if random.once_in(3) { random.below(6) } else { 6 - system.order() };
        let mut others: Vec<Twist> = (0..count).map(|_| random_twist(random, length)).collect();
        if random.once_in(6) && !twists.is_empty() && count > 0 {
            others[0] = twists[0] + others[0] * random.power(-5.0, -1.0);
        }
        if random.once_in(4) {
            others.iter_mut().for_each(|t| t.angular = t.angular * 1e-10);
        }
        let bad = [f64::NAN, 1.0][random.below(2)];
        let complement = match random.below(8) {
            0 => Complement::Reciprocal { h: bad },
            1 | 2 => Complement::Reciprocal { h },
            3 => Complement::Reciprocal { h: length * random.within(-1.0, 1.0) },
            _ => Complement::Twists(&others),
        };
        match error(record, Projector::of(&twists, complement, &options)) {
            Some(Ok(p)) => projected(record, &p, random, length),
            Some(Err(reason)) => {
                text(record, &format!("{reason:?}")[..8]);
                counts(record, &[reason.to_string().len()]);
            }
            None => {}
        }
    });
}

#[test]
fn conics_of_pitches() {
    check("geometry_conics", 80, |random, record| {
        let narrow = random.once_in(4);
        let Drawn { system, length, .. } = drawn_until(random, narrow, |s| s.order() == 3);
        let Some(conics) = system.pitch_conics() else {
            counts(record, &[system.order()]);
            return;
        };
        let mut pitches = vec![0.0, f64::INFINITY, f64::NAN, length * random.within(-2.0, 2.0)];
        pitches.extend(system.principal_pitches());
        for h in &pitches {
            counts(record, &[conics.kind(*h) as usize, conics.points(*h, 7).len()]);
        }
        let points =
            |h: f64, count: usize| conics.points(h, count).iter().map(Vec::len).collect::<Vec<_>>();
        counts(record, &[points(pitches[3], 1), points(pitches[3], 9)].concat());
        let size =
            |f: [[f64; 3]; 3]| sum(&f.as_flattened().iter().map(|x| x.abs()).collect::<Vec<_>>());
        record.number(size(conics.klein) / length + 0.7 * size(conics.angular));
        for h in &pitches {
            for curve in conics.points(*h, 5) {
                let squares: Vec<f64> = curve.iter().map(|x| sum(&x.map(|a| a * a))).collect();
                record.number(sum(&squares));
            }
        }
        let x = [0.6, -0.2, 0.5];
        let back = conics.coordinates(conics.twist(x)).unwrap();
        record.number(sum(&back));
        let away = conics.coordinates(random_twist(random, length));
        record.number(sum(&away.unwrap().map(f64::abs)));
    });
}

/// Inverses that rest on the projectors.
#[test]
fn hyperbolic_inverses() {
    check("geometry_hyperbolic", 90, |random, record| {
        let some = random.once_in(4);
        let wanted = |s: &ScrewSystem| some || invertible(s);
        let Drawn { system, twists, options, length } = drawn_until(random, false, wanted);
        let unit = |i: usize| if i < 3 { length } else { 1.0 };
        let j = Matrix::from_fn(6, twists.len(), |r, c| twists[c].to_array()[r]);
        let h = pitch(random, &system, length);
        let damping = match random.below(4) {
            0 => HyperbolicDamping::Gram { lambda: length * random.within(-0.5, 0.5) },
            1 => HyperbolicDamping::Invariant { mu: length * random.power(-2.0, 0.0) },
            _ => HyperbolicDamping::None,
        };
        let joint = definite(random, twists.len());
        let metric = random.once_in(2).then(|| Metric::new("joint", &joint).unwrap());
        let all = HyperbolicOptions { scale: options, damping, joint_metric: metric.clone() };
        if let Some(found) = error(record, hyperbolic_with(&j, h, &all)) {
            verdicts(record, &[found.reason.is_none()]);
            if found.reason.is_none() && found.matrix.max_abs() < 1e4 {
                let scaled = |r: usize, c: usize| found.matrix[(r, c)] * unit(c);
                matrix(record, &Matrix::from_fn(j.cols(), 6, scaled));
            }
        }
        if let Some(svd) = error(record, hyperbolic_svd(&j, h, &options, metric.as_ref())) {
            let Signature { positive, negative, zero } = svd.signature;
            counts(record, &[svd.verdict.name().len(), positive, negative, zero]);
            record.number(sum(&svd.squares.iter().map(|g| g / length).collect::<Vec<_>>()));
            if let Some(polar) = svd.polar() {
                matrix(record, &polar.signs);
            }
        }
        let others = 6 - system.order();
        let complement = Matrix::from_fn(6, others, |r, _| random.within(-1.0, 1.0) * unit(r));
        if let Some(found) = error(record, oblique(&j, &complement, &all)) {
            verdicts(record, &[found.reason.is_none()]);
        }
    });
}

/// Servos that take on a part of a twist.
#[test]
fn projections_of_tasks() {
    check("geometry_tasks", 110, |random, record| {
        let robot = match random.below(3) {
            0 => chain(random),
            1 => robots::robot(random, false),
            _ => robots::of_catalogue(random, false),
        };
        let damping = match random.below(2) {
            0 => HyperbolicDamping::Gram { lambda: random.within(-0.5, 0.5) },
            _ => HyperbolicDamping::Invariant { mu: random.power(-3.0, 0.0) },
        };
        let h = [0.0, random.within(-1.0, 1.0), f64::INFINITY][random.below(3)];
        let count = random.below(4);
        let complement = (0..count).map(|_| random_twist(random, 1.0)).collect();
        let references =
            [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];
        let reference = references[random.below(3)];
        let projection = match random.below(3) {
            0 => TaskProjection::Hyperbolic { h },
            1 => TaskProjection::DampedHyperbolic { h: h.min(1.0), damping },
            _ => TaskProjection::Oblique { complement, reference },
        };
        let mut options = ServoOptions::new(&robot);
        options.projection = projection;
        options.largest_projection = [1e3, 10.0, 2.0][random.below(3)];
        options.fallback = [None, Some(TaskProjection::Orthogonal)][random.below(2)].clone();
        options.method = Method::Truncated { eps: 1e-6 };
        let Some(mut servo) = error(record, Servo::new(&robot, options)) else { return };
        let q = random.configuration(&robot);
        let pose = robot.state(&q).unwrap().pose(robot.tool()).unwrap();
        let feed_forward = random_twist(random, 1e-3);
        let Some(step) = error(record, servo.step(&q, Target { pose, feed_forward })) else {
            return;
        };
        verdicts(record, &[servo.is_stopped(), servo.no_inverse().is_some()]);
        if let Some(reason) = servo.no_inverse() {
            text(record, &format!("{reason:?}")[..8]);
            counts(record, &[reason.to_string().len()]);
        }
        counts(record, &[step.rank]);
        record.number(step.singular_ratio);
        record.number(1e3 * sum(servo.joint_velocities()));
    });
}
