//! `control::TimeLaw`: bounds, optimality, continuity, derivatives, degenerate cases.

use cylindroid::Error;
use cylindroid::control::{KinematicBounds, LawSample, TimeLaw};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

fn law(distance: f64, velocity: f64, acceleration: f64, jerk: f64) -> TimeLaw {
    TimeLaw::new(distance, KinematicBounds { velocity, acceleration, jerk }).unwrap()
}

/// A positive number whose order of magnitude is uniform.
fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(|e| 10f64.powf(e))
}

fn any_bounds() -> impl Strategy<Value = KinematicBounds> {
    let velocity = prop_oneof![8 => log_uniform(-3.0, 3.0), 1 => Just(INF)];
    let limits = prop_oneof![
        6 => (log_uniform(-3.0, 3.0), log_uniform(-3.0, 5.0)),
        2 => (log_uniform(-3.0, 3.0), Just(INF)),
        1 => (Just(INF), log_uniform(-3.0, 5.0)),
    ];
    (velocity, limits).prop_map(|(velocity, (acceleration, jerk))| KinematicBounds {
        velocity,
        acceleration,
        jerk,
    })
}

fn any_distance() -> impl Strategy<Value = f64> {
    (log_uniform(-9.0, 3.0), any::<bool>()).prop_map(|(h, back)| if back { -h } else { h })
}

/// The tree of cases of the textbook (Biagiotti & Melchiorri 2008, sections 3.2.1 and 3.4.2).
fn textbook_duration(h: f64, bounds: KinematicBounds) -> f64 {
    let KinematicBounds { velocity: v, acceleration: a, jerk: j } = bounds;
    if j == INF {
        return if h * a >= v * v { h / v + v / a } else { 2.0 * (h / a).sqrt() };
    }
    if v * j >= a * a {
        let ta = a / j + v / a;
        if h >= v * ta {
            h / v + ta
        } else if h >= 2.0 * a.powi(3) / (j * j) {
            (a * a / j + (a.powi(4) / (j * j) + 4.0 * a * h).sqrt()) / a
        } else {
            4.0 * (h / (2.0 * j)).cbrt()
        }
    } else if h >= 2.0 * v * (v / j).sqrt() {
        h / v + 2.0 * (v / j).sqrt()
    } else {
        4.0 * (h / (2.0 * j)).cbrt()
    }
}

#[test]
fn durations_of_the_textbook_cases() {
    let cases = [
        (law(3.0, 1.0, 2.0, INF), 3.5),           // trapezoid
        (law(2.0, 10.0, 0.5, INF), 4.0),          // triangle
        (law(2.0, 2.0, 2.0, INF), 2.0),           // their border
        (law(10.0, 5.0, 10.0, 30.0), 17.0 / 6.0), // seven segments
        (law(10.0, 10.0, 10.0, 30.0), 1.0 / 3.0 + (37.0_f64 / 9.0).sqrt()), // no cruise
        (law(10.0, 1.0, 100.0, 4.0), 11.0),       // no hold
        (law(2.0, 10.0, 10.0, 1.0), 4.0),         // jerk alone
        (law(2.0, INF, INF, 1.0), 4.0),
        (law(2.0, INF, 0.5, INF), 4.0),
        (law(-2.0, 10.0, 10.0, 1.0), 4.0),
    ];
    for (i, (law, expected)) in cases.into_iter().enumerate() {
        assert!((law.duration() - expected).abs() < 4e-15 * expected, "{i}: {}", law.duration());
    }
}

#[test]
fn each_case_has_its_segments() {
    // (jerk, hold, cruise) present
    for (law, present) in [
        (law(10.0, 5.0, 10.0, 30.0), [true, true, true]),
        (law(10.0, 10.0, 10.0, 30.0), [true, true, false]),
        (law(10.0, 1.0, 100.0, 4.0), [true, false, true]),
        (law(2.0, 10.0, 10.0, 1.0), [true, false, false]),
        (law(3.0, 1.0, 2.0, INF), [false, true, true]),
        (law(2.0, 10.0, 0.5, INF), [false, true, false]),
    ] {
        let t = law.switches();
        let found = [t[1] - t[0], t[2] - t[1], t[4] - t[3]].map(|length| length > 1e-12);
        assert_eq!(found, present, "{law:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn duration_is_that_of_the_textbook(h in log_uniform(-6.0, 3.0),
            v in log_uniform(-3.0, 3.0), a in log_uniform(-3.0, 3.0), j in log_uniform(-3.0, 4.0)) {
        for jerk in [j, INF] {
            let bounds = KinematicBounds { velocity: v, acceleration: a, jerk };
            let expected = textbook_duration(h, bounds);
            let got = TimeLaw::new(h, bounds).unwrap().duration();
            prop_assert!((got - expected).abs() <= 1e-12 * expected, "{got} {expected}");
        }
    }

    /// Pontryagin's condition for the shortest time: at every moment one bound is reached.
    #[test]
    fn bounds_are_kept_and_one_is_always_reached(h in any_distance(), bounds in any_bounds()) {
        let law = TimeLaw::new(h, bounds).unwrap();
        let peaks = law.extrema();
        let over = 1.0 + 1e-14;
        prop_assert!(peaks.velocity <= bounds.velocity * over, "{peaks:?}");
        prop_assert!(peaks.acceleration <= bounds.acceleration * over, "{peaks:?}");
        prop_assert!(peaks.jerk <= bounds.jerk * over, "{peaks:?}");
        for pair in law.switches().windows(2) {
            if pair[1] - pair[0] > 1e-9 * law.duration() {
                let LawSample { velocity, acceleration, jerk, .. } = law.at(0.5 * (pair[0] + pair[1]));
                let reached = [
                    velocity.abs() / bounds.velocity,
                    acceleration.abs() / bounds.acceleration,
                    jerk.abs() / bounds.jerk,
                ];
                prop_assert!(reached.iter().any(|r| (r - 1.0).abs() < 1e-12), "{reached:?} {law:?}");
            }
        }
    }

    #[test]
    fn samples_stay_between_the_ends_and_within_bounds(h in any_distance(),
            bounds in any_bounds(), share in -0.2..1.2) {
        let law = TimeLaw::new(h, bounds).unwrap();
        let s = law.at(share * law.duration());
        let over = 1.0 + 1e-14;
        prop_assert!(s.velocity.abs() <= bounds.velocity * over, "{s:?}");
        prop_assert!(s.acceleration.abs() <= bounds.acceleration * over, "{s:?}");
        prop_assert!(s.jerk.abs() <= bounds.jerk * over, "{s:?}");
        let way = s.position / h;
        prop_assert!((0.0..=1.0).contains(&way), "{s:?}");
        prop_assert!(s.velocity / h >= 0.0, "never backwards: {s:?}");
    }

    #[test]
    fn no_jump_at_any_switch(h in any_distance(), bounds in any_bounds()) {
        let law = TimeLaw::new(h, bounds).unwrap();
        let (peaks, step) = (law.extrema(), 1e-9 * law.duration());
        for t in law.switches() {
            let (before, after) = (law.at(t - step), law.at(t + step));
            let jump = (after.position - before.position).abs();
            prop_assert!(jump <= 2.001 * step * peaks.velocity + 1e-14 * h.abs(), "position {t}");
            let jump = (after.velocity - before.velocity).abs();
            prop_assert!(jump <= 2.001 * step * peaks.acceleration + 1e-14 * peaks.velocity,
                "velocity {t}: {jump}");
            let jump = (after.acceleration - before.acceleration).abs();
            prop_assert!(bounds.jerk == INF
                || jump <= 2.001 * step * peaks.jerk + 1e-14 * peaks.acceleration,
                "acceleration {t}: {jump}");
        }
    }

    /// The five-point rule is exact for the cubics that the segments are.
    #[test]
    fn derivatives_are_those_of_the_position(h in any_distance(), bounds in any_bounds()) {
        let law = TimeLaw::new(h, bounds).unwrap();
        for pair in law.switches().windows(2) {
            let (middle, step) = (0.5 * (pair[0] + pair[1]), 0.2 * (pair[1] - pair[0]));
            if step < 1e-3 * law.duration() {
                continue;
            }
            let x = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| law.at(middle + k * step));
            let rate = |f: fn(&LawSample) -> f64|
                (f(&x[0]) - 8.0 * f(&x[1]) + 8.0 * f(&x[3]) - f(&x[4])) / (12.0 * step);
            let peaks = law.extrema();
            for (got, expected, scale) in [
                (rate(|s| s.position), x[2].velocity, peaks.velocity),
                (rate(|s| s.velocity), x[2].acceleration, peaks.acceleration),
                (rate(|s| s.acceleration), x[2].jerk, peaks.acceleration / law.duration()),
            ] {
                prop_assert!((got - expected).abs() <= 1e-10 * scale.max(expected.abs()),
                    "{got} {expected} {law:?}");
            }
        }
    }

    /// Simpson's rule is exact for the velocity, the midpoint rule for the acceleration.
    #[test]
    fn velocity_integrates_to_the_distance(h in any_distance(), bounds in any_bounds()) {
        let law = TimeLaw::new(h, bounds).unwrap();
        let (mut distance, mut velocity) = (0.0, 0.0);
        for pair in law.switches().windows(2) {
            let (length, middle) = (pair[1] - pair[0], law.at(0.5 * (pair[0] + pair[1])));
            let ends = law.at(pair[0]).velocity + law.at(pair[1]).velocity;
            distance += length * (ends + 4.0 * middle.velocity) / 6.0;
            velocity += length * middle.acceleration;
        }
        // The switches themselves are rounded to the resolution of the time.
        let clock = 2.0 * f64::EPSILON * law.duration() * law.extrema().acceleration;
        let (slack, exact) = (clock * law.duration(), 1e-13 * h.abs());
        prop_assert!((distance - h).abs() <= exact + slack, "{distance} {h}");
        prop_assert!(velocity.abs() <= 1e-12 * law.extrema().velocity + clock, "{velocity}");
    }

    #[test]
    fn stretching_scales_time_exactly(h in any_distance(), bounds in any_bounds(),
            k in 1.0..50.0_f64, share in 0.0..1.0) {
        let law = TimeLaw::new(h, bounds).unwrap();
        let slow = law.scaled_to_duration(k * law.duration()).unwrap();
        prop_assert_eq!(slow.duration(), k * law.duration());
        let (fast, slow) = (law.at(share * law.duration()), slow.at(share * slow.duration()));
        let peaks = law.extrema();
        prop_assert!((slow.position - fast.position).abs() <= 1e-13 * h.abs());
        // Both times are rounded to their resolution, in which the velocity changes.
        let clock = 4.0 * f64::EPSILON * law.duration() * peaks.acceleration;
        let apart = (slow.velocity * k - fast.velocity).abs();
        prop_assert!(apart <= 1e-12 * peaks.velocity + clock, "{apart}");
    }
}

#[test]
fn ends_are_exact_and_at_rest() {
    for law in [law(0.1, 0.3, 0.7, 11.0), law(-1e-12, 1.0, 1.0, INF), law(1e6, 0.1, 3.0, 9.0)] {
        let rest = |position| LawSample { position, ..LawSample::default() };
        for late in [0.0, 1e-9, 1.0, INF] {
            assert_eq!(law.at(law.duration() + late), rest(law.distance()));
        }
        for early in [-1e-300, -1.0, -INF, f64::NAN] {
            assert_eq!(law.at(early), rest(0.0));
        }
        assert_eq!(law.at(0.0).position, 0.0);
    }
}

#[test]
fn no_distance_takes_no_time() {
    for jerk in [2.0, INF] {
        let law = law(0.0, 1.0, 1.0, jerk);
        assert_eq!(law.duration(), 0.0);
        for t in [-1.0, 0.0, 1.0] {
            assert_eq!(law.at(t), LawSample::default());
        }
        let slow = law.scaled_to_duration(3.0).unwrap();
        assert_eq!(slow.duration(), 3.0);
        assert_eq!(slow.at(1.0), LawSample::default());
    }
}

#[test]
fn extreme_magnitudes_are_finite_or_refused() {
    let numbers = [5e-324, 1e-300, 1e-160, 1e-12, 1.0, 1e12, 1e160, 1e300, INF];
    for h in &numbers[..8] {
        for velocity in numbers {
            for acceleration in numbers {
                for jerk in numbers {
                    let Ok(law) =
                        TimeLaw::new(*h, KinematicBounds { velocity, acceleration, jerk })
                    else {
                        continue;
                    };
                    for share in [0.0, 0.1, 0.25, 0.5, 0.6, 0.99, 1.0] {
                        let s = law.at(share * law.duration());
                        let all = [s.position, s.velocity, s.acceleration, s.jerk];
                        assert!(all.iter().all(|x| x.is_finite()), "{law:?} {s:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn bad_input_is_named() {
    let good = KinematicBounds { velocity: 1.0, acceleration: 2.0, jerk: 3.0 };
    for bad in [0.0, -0.0, -1.0, f64::NAN, -INF] {
        for (bounds, name) in [
            (KinematicBounds { velocity: bad, ..good }, "velocity bound"),
            (KinematicBounds { acceleration: bad, ..good }, "acceleration bound"),
            (KinematicBounds { jerk: bad, ..good }, "jerk bound"),
        ] {
            for h in [1.0, 0.0] {
                let error = TimeLaw::new(h, bounds).unwrap_err();
                assert!(
                    matches!(&error, Error::InvalidOption { option, value, .. }
                        if *option == name && *value == bad.to_string()),
                    "{error}"
                );
            }
        }
    }
    let jump = KinematicBounds { acceleration: INF, jerk: INF, ..good };
    assert!(TimeLaw::new(1.0, jump).unwrap_err().to_string().contains("would jump"));
    for h in [f64::NAN, INF, -INF] {
        assert!(matches!(TimeLaw::new(h, good), Err(Error::NotFinite { .. })));
    }
    let law = TimeLaw::new(1.0, good).unwrap();
    for duration in [0.0, -1.0, 0.999 * law.duration(), INF, f64::NAN] {
        let error = law.scaled_to_duration(duration).unwrap_err();
        assert!(matches!(error, Error::InvalidOption { option: "duration", .. }), "{error}");
    }
    assert_eq!(law.scaled_to_duration(law.duration()).unwrap(), law);
}
