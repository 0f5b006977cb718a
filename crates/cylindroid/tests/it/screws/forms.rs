//! The invariant forms of twists and wrenches.

use cylindroid::Matrix;
use cylindroid::screws::{Line, Screw};
use cylindroid::spatial::{Pose, Twist, Vec3, Wrench};

use crate::support::Random;

const PITCHES: [f64; 7] = [0.0, 0.3, -0.7, 5.0, -40.0, f64::INFINITY, f64::NEG_INFINITY];

fn wrench(random: &mut Random) -> Wrench {
    Wrench { force: random.vec3(1.0), moment: random.vec3(1.0) }
}

/// Near the origin, and up to 1e6 away.
fn poses(random: &mut Random) -> impl Iterator<Item = (Pose, f64)> {
    [1.0, 1e3, 1e6].into_iter().map(|far| {
        let translation = random.vec3(far);
        (Pose { rotation: random.rotation(), translation }, far)
    })
}

/// Rounding of v_a . w_b: the entries of v grow with the distance.
fn rounding(far: f64, h: f64) -> f64 {
    64.0 * f64::EPSILON * (far + if h.is_finite() { h.abs() } else { 0.0 })
}

#[test]
fn adjoints_change_no_form_of_twists() {
    let mut random = Random(1);
    for _ in 0..300 {
        let (a, b) = (random.twist(), random.twist());
        for (pose, far) in poses(&mut random) {
            let (c, d) = (pose.adjoint(a), pose.adjoint(b));
            for h in PITCHES {
                let change = (c.pitch_form(d, h) - a.pitch_form(b, h)).abs();
                assert!(change <= rounding(far, h), "h = {h}, {far} away: {change:e}");
            }
            assert!((c.klein(d) - a.klein(b)).abs() <= rounding(far, 0.0));
            assert!((c.killing(d) - a.killing(b)).abs() <= 4.0 * rounding(1.0, 0.0));
        }
    }
}

#[test]
fn coadjoints_change_no_form_of_wrenches() {
    let mut random = Random(2);
    for _ in 0..300 {
        let (a, b) = (wrench(&mut random), wrench(&mut random));
        for (pose, far) in poses(&mut random) {
            let (c, d) = (pose.coadjoint(a), pose.coadjoint(b));
            for h in PITCHES {
                let change = (c.pitch_form(d, h) - a.pitch_form(b, h)).abs();
                assert!(change <= 4.0 * rounding(far, h), "h = {h}, {far} away: {change:e}");
            }
        }
    }
}

/// The matrix of the bracket with `a`, from the structure of se(3): [[w x, v x], [0, w x]].
fn ad(a: Twist) -> Matrix {
    let cross = |u: Vec3, i: usize, j: usize| {
        let mut unit = [0.0; 3];
        unit[j] = 1.0;
        u.cross(Vec3::from_array(unit))[i]
    };
    Matrix::from_fn(6, 6, |i, j| match (i / 3, j / 3) {
        (0, 1) => cross(a.linear, i, j - 3),
        (1, 0) => 0.0,
        _ => cross(a.angular, i % 3, j % 3),
    })
}

#[test]
fn killing_is_the_trace_of_two_brackets() {
    let mut random = Random(3);
    for _ in 0..100 {
        let (a, b) = (random.twist(), random.twist());
        let image = ad(a).mul_vec(&b.to_array());
        crate::support::assert_close("[a, b]", &image, &a.bracket(b).to_array(), 1e-15);
        let product = &ad(a) * &ad(b);
        let trace: f64 = (0..6).map(|i| product[(i, i)]).sum();
        assert!((a.killing(b) - trace).abs() < 1e-14);
        assert!((a.pitch_form(b, f64::INFINITY) - 0.25 * trace).abs() < 1e-14);
    }
}

/// Zero on the screws of pitch h and on no other: <s, s>_h = a^2 (h_s - h).
#[test]
fn a_form_vanishes_on_the_screws_of_its_pitch() {
    let mut random = Random(4);
    // Numbers with few digits: every operation is exact.
    let line = Line { point: Vec3::new(3.0, -2.0, 5.0), direction: Vec3::Y };
    let exact = Screw { axis: line, pitch: -0.625, amplitude: 1.5 }.twist();
    assert_eq!(exact.pitch_form(exact, -0.625), 0.0);
    assert_eq!(exact.pitch_form(exact, 0.0), -0.625 * 2.25);
    let slide = Twist { linear: Vec3::new(1.0, 2.0, 3.0), angular: Vec3::ZERO };
    for h in PITCHES {
        assert_eq!(slide.pitch_form(slide, h), 0.0, "a translation is of every form");
    }
    for _ in 0..300 {
        let axis = Line::through(random.vec3(2.0), random.vec3(1.0)).unwrap();
        let (pitch, amplitude) = (random.within(-3.0, 3.0), random.within(0.1, 2.0));
        let s = Screw { axis, pitch, amplitude }.twist();
        for h in [pitch, 0.0, 1.0, -7.0] {
            let expected = amplitude * amplitude * (pitch - h);
            assert!((s.pitch_form(s, h) - expected).abs() < 1e-13, "{h}");
        }
    }
}

/// A twist is h-reciprocal to another iff the other, lowered, does no work on it.
#[test]
fn lowered_is_the_form_as_a_wrench() {
    let mut random = Random(5);
    for _ in 0..300 {
        let (a, b, f) = (random.twist(), random.twist(), wrench(&mut random));
        for h in PITCHES {
            let form = a.pitch_form(b, h);
            let size = 64.0 * f64::EPSILON * (1.0 + if h.is_finite() { h.abs() } else { 0.0 });
            assert!((a.power(b.lowered(h)) - form).abs() <= size);
            assert!((b.pitch_form(a, h) - form).abs() <= size, "symmetric");
            let pose = random.pose();
            let moved = pose.coadjoint(a.lowered(h)) - pose.adjoint(a).lowered(h);
            assert!(moved.to_array().iter().all(|x| x.abs() <= size), "{moved:?}");
            if h.is_infinite() {
                continue;
            }
            let size = size * (1.0 + h * h);
            let dual = a.lowered(h).pitch_form(b.lowered(h), h);
            assert!((dual - form).abs() <= 4.0 * size, "{h}: {dual} {form}");
            let back = a.lowered(h).raised(h) - a;
            assert!(back.to_array().iter().all(|x| x.abs() <= 8.0 * size), "{h}: {back:?}");
            let back = f.raised(h).lowered(h) - f;
            assert!(back.to_array().iter().all(|x| x.abs() <= 8.0 * size), "{h}: {back:?}");
        }
        // The h-reciprocal partner of (w, v) is (w, v + 2 h w) of an ordinary reciprocal one.
        let h = random.within(-3.0, 3.0);
        let reciprocal = a - b * (a.klein(a) / a.klein(b));
        let shifted =
            Twist { linear: reciprocal.linear + reciprocal.angular * (2.0 * h), ..reciprocal };
        let size = 1.0 + reciprocal.angular.norm() + reciprocal.linear.norm();
        assert!(a.pitch_form(shifted, h).abs() < 1e-13 * size * (1.0 + h.abs()));
    }
}

/// Where the pitch is infinite the form on wrenches is what remains of it: f_a . f_b.
#[test]
fn infinite_pitch_is_the_limit() {
    let mut random = Random(6);
    for _ in 0..100 {
        let (a, b) = (random.twist(), random.twist());
        let (f, g) = (wrench(&mut random), wrench(&mut random));
        for h in [1e8, -1e8] {
            let limit = a.pitch_form(b, h) / h.abs() * h.signum();
            assert!((limit - a.pitch_form(b, h * f64::INFINITY)).abs() < 1e-7);
            let limit = f.pitch_form(g, h) / (4.0 * h);
            assert!((limit - f.pitch_form(g, f64::INFINITY)).abs() < 1e-7);
        }
    }
}

/// What is no pitch gives no number that could pass for one.
#[test]
fn nan_stays_nan() {
    let mut random = Random(7);
    let (a, b, f) = (random.twist(), random.twist(), wrench(&mut random));
    assert!(a.pitch_form(b, f64::NAN).is_nan());
    assert!(f.pitch_form(f, f64::NAN).is_nan());
    assert!(!a.lowered(f64::NAN).is_finite());
    assert!(!f.raised(f64::NAN).is_finite());
    // The form at infinity has no inverse.
    for wrench in [f, Wrench::ZERO] {
        assert!(!wrench.raised(f64::INFINITY).is_finite());
    }
}
