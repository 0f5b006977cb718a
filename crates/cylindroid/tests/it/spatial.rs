use std::f64::consts::{FRAC_PI_2, PI};

use cylindroid::spatial::{
    Pose, Quaternion, Rotation, Rpy, Twist, Vec3, Wrench, Xyz, Zyz, exp, exp_derivative, log,
    log_derivative, rotation_exp_derivative, rotation_log_derivative,
};

use crate::support::{Random, assert_close, entries, pose_entries};

/// Angles at which anything could go wrong: zero, tiny, both sides of the series' switches, pi.
fn angles() -> Vec<f64> {
    let switch = cylindroid::tolerance::SMALL_ANGLE;
    let small = 2.0 * cylindroid::tolerance::SMALL_TANGENT.sqrt().atan();
    vec![
        0.0,
        f64::MIN_POSITIVE,
        1e-200,
        1e-16,
        1e-9,
        1e-5,
        small * (1.0 - 1e-15),
        small,
        small * (1.0 + 1e-15),
        0.1,
        switch * (1.0 - 1e-15),
        switch,
        switch * (1.0 + 1e-15),
        1.0,
        2.0,
        3.0,
        PI - 1e-5,
        PI - 1e-9,
        PI - 1e-15,
        PI,
    ]
}

fn axes() -> Vec<Vec3> {
    let mut random = Random(1);
    let mut axes = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::X * -1.0, Vec3::new(0.0, -0.6, 0.8)];
    axes.extend((0..20).map(|_| random.vec3(1.0).unit(0.0).unwrap()));
    axes
}

#[test]
fn log_inverts_exp_for_rotations() {
    for angle in angles() {
        for axis in axes() {
            let r = Rotation::exp(axis * angle);
            let back = r.log();
            assert!(back.is_finite());
            assert!(back.norm() <= PI + 1e-15);
            assert_close(
                "exp log",
                &entries(Rotation::exp(back).matrix()),
                &entries(r.matrix()),
                2e-15,
            );
            if angle < PI - 1e-6 {
                let relative = (back - axis * angle).norm() / angle.max(f64::MIN_POSITIVE);
                assert!(relative < 1e-9 || angle == 0.0, "{angle}: {relative}");
            }
        }
    }
}

/// The digits of small angles are kept: 1e-200 comes back as 1e-200.
#[test]
fn log_keeps_the_digits_of_small_angles() {
    for angle in [1e-200, 1e-100, 1e-30, 1e-12, 1e-8, 1e-4, 0.1] {
        let back = Rotation::exp(Vec3::new(angle, 0.0, 0.0)).log().x;
        assert!((back / angle - 1.0).abs() < 1e-15, "{angle} came back as {back}");
    }
}

#[test]
fn at_pi_the_axis_is_chosen_deterministically() {
    let half_turn =
        |x: f64, y: f64, z: f64| Quaternion { w: 0.0, x, y, z }.rotation().unwrap().log();
    assert_close("x", &half_turn(-1.0, 0.0, 0.0).to_array(), &[PI, 0.0, 0.0], 0.0);
    assert_close("z", &half_turn(0.0, 0.0, -1.0).to_array(), &[0.0, 0.0, PI], 0.0);
    let mixed = half_turn(0.0, -0.6, 0.8).to_array();
    assert_close("yz", &mixed, &[0.0, 0.6 * PI, -0.8 * PI], 1e-15);
}

#[test]
fn exp_and_log_are_inverse_for_poses() {
    let mut random = Random(2);
    for angle in angles() {
        for axis in axes() {
            let x = Twist { linear: random.vec3(3.0), angular: axis * angle };
            let pose = exp(x);
            assert_close("exp log", &pose_entries(exp(log(pose))), &pose_entries(pose), 2e-14);
        }
    }
}

/// The screw motion by small steps is the definition of exp.
#[test]
fn exp_is_the_limit_of_small_steps() {
    let x = Twist { linear: Vec3::new(0.3, -0.2, 0.5), angular: Vec3::new(0.4, 1.1, -0.7) };
    let small = exp(x * (1.0 / 1024.0));
    let mut pose = Pose::IDENTITY;
    for _ in 0..1024 {
        pose = pose * small;
    }
    assert_close("steps", &pose_entries(pose), &pose_entries(exp(x)), 1e-13);
}

/// Finite differences of exp: `exp(x + dx) exp(x)^-1` to first order.
#[test]
fn derivative_of_exp_by_finite_differences() {
    let mut random = Random(3);
    let h = 1e-5;
    for angle in angles() {
        for axis in axes() {
            let x = Twist { linear: random.vec3(1.0), angular: axis * angle };
            let d = random.twist();
            let difference = (log(exp(x + d * h) * exp(x).inverse())
                - log(exp(x - d * h) * exp(x).inverse()))
                * (0.5 / h);
            let exact = exp_derivative(x).apply(d);
            assert_close("d exp", &difference.to_array(), &exact.to_array(), 1e-9);
        }
    }
}

#[test]
fn derivatives_of_exp_and_log_are_inverse() {
    let mut random = Random(4);
    for angle in angles() {
        for axis in axes() {
            let x = Twist { linear: random.vec3(1.0), angular: axis * angle };
            let d = random.twist();
            let back = log_derivative(x).apply(exp_derivative(x).apply(d));
            assert_close("D^-1 D", &back.to_array(), &d.to_array(), 2e-14);
            let w = x.angular;
            let v = rotation_log_derivative(w) * (rotation_exp_derivative(w) * d.linear);
            assert_close("V^-1 V", &v.to_array(), &d.linear.to_array(), 1e-14);
        }
    }
}

#[test]
fn power_is_invariant() {
    let mut random = Random(5);
    for _ in 0..1000 {
        let (a_from_b, twist) = (random.pose(), random.twist());
        let wrench = Wrench { force: random.vec3(1.0), moment: random.vec3(1.0) };
        let (in_b, in_a) =
            (twist.power(wrench), a_from_b.adjoint(twist).power(a_from_b.coadjoint(wrench)));
        assert!((in_a - in_b).abs() < 1e-14, "{in_a} and {in_b}");
        let p = random.vec3(2.0);
        let moved = twist.at_point(p).power(wrench.at_point(p));
        assert!((moved - in_b).abs() < 1e-14, "{moved} and {in_b}");
    }
}

#[test]
fn adjoint_laws() {
    let mut random = Random(6);
    for _ in 0..1000 {
        let (a, b, t, u) = (random.pose(), random.pose(), random.twist(), random.twist());
        let both = (a * b).adjoint(t);
        assert_close("Ad(ab)", &both.to_array(), &a.adjoint(b.adjoint(t)).to_array(), 1e-14);
        let back = a.inverse().adjoint(a.adjoint(t));
        assert_close("Ad(a^-1) Ad(a)", &back.to_array(), &t.to_array(), 2e-14);
        // Ad from conjugation: a exp(t) a^-1 = exp(Ad_a t)
        let conjugate = a * exp(t) * a.inverse();
        assert_close(
            "a exp a^-1",
            &pose_entries(conjugate),
            &pose_entries(exp(a.adjoint(t))),
            2e-14,
        );
        // Ad is a map of Lie algebras, and the bracket is antisymmetric.
        let bracket = a.adjoint(t.bracket(u));
        assert_close(
            "Ad [t, u]",
            &bracket.to_array(),
            &a.adjoint(t).bracket(a.adjoint(u)).to_array(),
            1e-13,
        );
        assert_close("[t, u]", &t.bracket(u).to_array(), &(-u.bracket(t)).to_array(), 1e-15);
        let wrench = Wrench { force: random.vec3(1.0), moment: random.vec3(1.0) };
        let back = a.inverse().coadjoint(a.coadjoint(wrench));
        assert_close("coadjoint", &back.to_array(), &wrench.to_array(), 2e-14);
    }
}

#[test]
fn angles_round_trip_also_at_gimbal_lock() {
    let mut random = Random(8);
    let near = [0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-3];
    let ends = [0.0, FRAC_PI_2, PI, -FRAC_PI_2, 1.0];
    let special = ends.iter().flat_map(|end| near.iter().map(move |d| end - d));
    for _ in 0..200 {
        for middle in special.clone() {
            let (a, c) = (random.within(-3.0, 3.0), random.within(-3.0, 3.0));
            let rpy = Rpy { roll: a, pitch: middle, yaw: c }.rotation();
            assert_close(
                "rpy",
                &entries(Rpy::of(rpy).rotation().matrix()),
                &entries(rpy.matrix()),
                4e-15,
            );
            let zyz = Zyz { alpha: a, beta: middle, gamma: c }.rotation();
            assert_close(
                "zyz",
                &entries(Zyz::of(zyz).rotation().matrix()),
                &entries(zyz.matrix()),
                4e-15,
            );
            let xyz = Xyz { alpha: a, beta: middle, gamma: c }.rotation();
            let about = |axis, angle| Rotation::about(axis, angle).unwrap();
            let expected = about(Vec3::X, a) * about(Vec3::Y, middle) * about(Vec3::Z, c);
            assert_close("xyz", &entries(xyz.matrix()), &entries(expected.matrix()), 1e-15);
            assert_close(
                "angles of xyz",
                &entries(Xyz::of(xyz).rotation().matrix()),
                &entries(xyz.matrix()),
                4e-15,
            );
            let q = rpy.to_quaternion();
            assert!(q.w >= 0.0);
            assert_close(
                "quaternion",
                &entries(q.rotation().unwrap().matrix()),
                &entries(rpy.matrix()),
                1e-15,
            );
        }
    }
}

/// URDF's meaning of rpy: about fixed x, then fixed y, then fixed z.
#[test]
fn rpy_is_about_fixed_axes() {
    let about = |axis, angle| Rotation::about(axis, angle).unwrap();
    let expected = about(Vec3::Z, 0.3) * about(Vec3::Y, -0.7) * about(Vec3::X, 1.9);
    let got = Rpy { roll: 1.9, pitch: -0.7, yaw: 0.3 }.rotation();
    assert_close("rpy", &entries(got.matrix()), &entries(expected.matrix()), 1e-15);
}

#[test]
fn z_to_is_exact_for_coordinate_axes() {
    for axis in axes() {
        let r = Rotation::z_to(axis).unwrap();
        assert_close("z", &r.z_axis().to_array(), &axis.to_array(), 1e-15);
        let m = r.matrix();
        assert_close(
            "R^T R",
            &entries(m.transpose() * m),
            &entries(Rotation::IDENTITY.matrix()),
            1e-15,
        );
        assert!((m.determinant() - 1.0).abs() < 1e-15);
    }
    for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::X * -1.0, Vec3::Y * -1.0, Vec3::Z * -1.0] {
        let m = Rotation::z_to(axis).unwrap().matrix();
        assert!(entries(m).iter().all(|x| *x == 0.0 || x.abs() == 1.0), "{m:?}");
    }
    assert!(Rotation::z_to(Vec3::ZERO).is_none());
    assert!(Rotation::about(Vec3::new(f64::NAN, 0.0, 1.0), 1.0).is_none());
}

#[test]
fn matrices_that_are_no_poses_are_refused() {
    let mut m = Pose::IDENTITY.to_matrix();
    assert_eq!(Pose::from_matrix(m).unwrap(), Pose::IDENTITY);
    m[0][0] = 1.1;
    assert!(Pose::from_matrix(m).unwrap_err().to_string().contains("orthonormal"));
    m[0][0] = -1.0; // a mirror
    assert!(Pose::from_matrix(m).is_err());
    m[0][0] = f64::NAN;
    assert!(Pose::from_matrix(m).unwrap_err().to_string().contains("not finite"));
    let mut transposed = Pose::IDENTITY.to_matrix();
    transposed[3][0] = 0.5;
    assert!(Pose::from_matrix(transposed).unwrap_err().to_string().contains("transposed"));
    assert!(Quaternion { w: 0.0, x: 0.0, y: 0.0, z: 0.0 }.rotation().is_err());
}

/// Six printed digits become a rotation to rounding.
#[test]
fn printed_digits_are_repaired() {
    let mut random = Random(9);
    for _ in 0..100 {
        let rows = random.rotation().matrix().to_rows().map(|r| r.map(|x| (x * 1e6).round() / 1e6));
        let r = Rotation::from_matrix(cylindroid::spatial::Mat3::from_rows(rows)).unwrap().matrix();
        assert_close(
            "R^T R",
            &entries(r.transpose() * r),
            &entries(Rotation::IDENTITY.matrix()),
            1e-14,
        );
    }
}

/// Never NaN for finite input, however long or short; always a rotation.
#[test]
fn exp_and_unit_of_any_length() {
    for x in [5e-324, 1e-310, 1e-200, 1e-20, 1.0, 1e20, 1e160, 1e300, f64::MAX] {
        for r in [Vec3::new(x, 0.0, 0.0), Vec3::new(-x, x, 0.5 * x), Vec3::new(x, x, x)] {
            let m = Rotation::exp(r).matrix();
            let error = entries(m.transpose() * m - Rotation::IDENTITY.matrix());
            assert_close("R^T R", &error, &[0.0; 9], 1e-14);
            assert!((m.determinant() - 1.0).abs() < 1e-14);
            if let Some(unit) = r.unit(0.0) {
                assert!((unit.norm() - 1.0).abs() < 1e-15, "{r:?}: {unit:?}");
            } else {
                assert_eq!(r.norm(), f64::INFINITY, "{r:?}");
            }
        }
    }
    assert_eq!(Rotation::exp(Vec3::ZERO), Rotation::IDENTITY);
    assert!(!Rotation::exp(Vec3::new(f64::NAN, 0.0, 0.0)).matrix().is_finite());
    assert!(!Rotation::exp(Vec3::new(f64::INFINITY, 0.0, 0.0)).matrix().is_finite());
}
