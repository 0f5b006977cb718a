//! Denavit-Hartenberg arms against the plain product of the textbook's 4 x 4 matrices.

use cylindroid::model::Limits;
use cylindroid::model::formats::dh::{self, Arm, Convention, Row};
use cylindroid::{Mechanism, Pose, Vec3};

use crate::fk::{assert_close, frame};
use crate::{read_toml, refused};

type Matrix4 = [[f64; 4]; 4];

fn product(a: Matrix4, b: Matrix4) -> Matrix4 {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

/// Siciliano et al. 2009, eq. 2.52.
fn standard(a: f64, alpha: f64, d: f64, theta: f64) -> Matrix4 {
    let ((s, c), (sa, ca)) = (theta.sin_cos(), alpha.sin_cos());
    [
        [c, -s * ca, s * sa, a * c],
        [s, c * ca, -c * sa, a * s],
        [0.0, sa, ca, d],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// Craig, Introduction to Robotics, eq. 3.6.
fn modified(a: f64, alpha: f64, d: f64, theta: f64) -> Matrix4 {
    let ((s, c), (sa, ca)) = (theta.sin_cos(), alpha.sin_cos());
    [
        [c, -s, 0.0, a],
        [s * ca, c * ca, -sa, -sa * d],
        [s * sa, c * sa, ca, ca * d],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

fn rows() -> Vec<Row> {
    let row = |name: &str, a, alpha, d, theta, prismatic| Row {
        name: name.to_owned(),
        a,
        alpha,
        d,
        theta,
        prismatic,
        flip: false,
        limits: Limits::NONE,
    };
    vec![
        row("q1", 0.3, 1.1, 0.5, 0.2, false),
        row("q2", -0.4, -0.7, 0.1, -1.3, false),
        row("q3", 0.2, 2.5, 0.6, 0.9, true),
        row("q4", 0.05, -1.6, -0.2, 3.0, false),
    ]
}

#[test]
fn both_conventions_are_the_product_of_their_matrices() {
    let q = [0.7, -1.1, 0.25, 2.2];
    for convention in [Convention::Standard, Convention::Modified] {
        let matrix = match convention {
            Convention::Standard => standard,
            Convention::Modified => modified,
        };
        let base = Pose::from_translation(Vec3::new(1.0, 2.0, 3.0));
        let flange = Pose::from_translation(Vec3::new(0.0, 0.0, 0.1));
        let arm = Arm {
            convention,
            rows: rows(),
            ground_from_base: Some(base),
            last_from_flange: flange,
        };
        let mut builder = Mechanism::builder("dh");
        for joint in dh::joints(&arm) {
            builder.joint(joint);
        }
        let m = builder.build().unwrap();
        assert_eq!(m.n(), 4);
        assert_eq!(m.frame_of(m.tool()).name, "flange");

        let mut expected = base.to_matrix();
        for (row, q) in rows().iter().zip(q) {
            let (d, theta) =
                if row.prismatic { (row.d + q, row.theta) } else { (row.d, row.theta + q) };
            expected = product(expected, matrix(row.a, row.alpha, d, theta));
        }
        expected = product(expected, flange.to_matrix());
        let expected = Pose::from_matrix(expected).unwrap();
        assert_close(frame(&m, &q, "flange"), expected, 1e-14);
    }
}

/// Joint i of the standard convention turns about z of frame i - 1.
#[test]
fn standard_joints_lie_on_the_axis_before() {
    let arm = Arm {
        convention: Convention::Standard,
        rows: rows(),
        ground_from_base: None,
        last_from_flange: Pose::IDENTITY,
    };
    let mut builder = Mechanism::builder("dh");
    for joint in dh::joints(&arm) {
        builder.joint(joint);
    }
    let m = builder.build().unwrap();
    let row = &rows()[0];
    let frame1 = Pose::from_matrix(standard(row.a, row.alpha, row.d, row.theta)).unwrap();
    for q2 in [0.0, 0.4, -2.0] {
        let link2 = frame(&m, &[0.0, q2, 0.0, 0.0], "link2");
        assert!((link2.rotation.z_axis() - frame1.rotation.z_axis()).norm() < 1e-14);
        let away = link2.translation - frame1.translation;
        assert!(away.cross(frame1.rotation.z_axis()).norm() < 1e-14);
    }
}

#[test]
fn the_table_is_read_from_a_file() {
    let text = "[dh]\nconvention = \"standard\"\nbase = { xyz = [0, 0, 1] }\nrows = [\n\
        { name = \"a\", a = 1, alpha = 0.5, limits = { lower = -1, upper = 1 } },\n\
        { name = \"b\", type = \"prismatic\", d = 2 },\n]";
    let m = read_toml(text).unwrap();
    assert_eq!(m.name(), "test");
    assert_eq!(m.coordinates()[0].limits.upper, 1.0);
    assert!(m.joints().iter().filter(|j| j.kind.dof() > 0).all(|j| j.actuated));
    let frames: Vec<&str> = m.frames().iter().map(|f| f.name.as_str()).collect();
    assert_eq!(frames, ["ground", "base", "link1", "link2", "flange"]);
    let expected = product(standard(1.0, 0.5, 0.0, 0.3), standard(0.0, 0.0, 2.5, 0.0));
    let expected = Pose::from_translation(Vec3::Z) * Pose::from_matrix(expected).unwrap();
    assert_close(frame(&m, &[0.3, 0.5], "flange"), expected, 1e-15);

    for (from, to, says) in [
        ("\"standard\"", "\"standart\"", "no convention named 'standart'; nearest: standard"),
        ("convention = \"standard\"\n", "", "[dh] has no convention"),
        ("alpha", "alfa", "no key named 'alfa'; nearest: alpha"),
        ("\"prismatic\"", "\"sliding\"", "no joint type named 'sliding'"),
        ("name = \"b\", ", "", "a row of [dh] has no name"),
        ("name = \"b\"", "name = \"a\"", "two joints are named 'a'"),
        ("[dh]", "dimension = 2\n[dh]", "three-dimensional"),
        ("[dh]", "joint = []\n[dh]", "not both"),
    ] {
        let changed = text.replace(from, to);
        let error = refused(&changed, read_toml(&changed));
        assert!(error.message.contains(says), "{error}");
    }
}

/// A flipped joint has the opposite q: revolute and prismatic, in both conventions, from files too.
#[test]
fn flipped_joints_subtract_their_coordinate() {
    for convention in [Convention::Standard, Convention::Modified] {
        let poses = |flip: bool, sign: f64| {
            let rows = rows().into_iter().map(|row| Row { flip, ..row }).collect();
            let (ground_from_base, last_from_flange) = (None, Pose::IDENTITY);
            let mut builder = Mechanism::builder("flipped");
            for joint in dh::joints(&Arm { convention, rows, ground_from_base, last_from_flange }) {
                builder.joint(joint);
            }
            let m = builder.build().unwrap();
            frame(&m, &[0.7, -1.1, 0.25, 2.2].map(|q| sign * q), "flange")
        };
        assert_close(poses(true, -1.0), poses(false, 1.0), 1e-14);
    }
    let file = |flip: &str| {
        let row = format!("{{ name = 'q', a = 1, alpha = 0, d = 0, theta = 0.5{flip} }}");
        read_toml(&format!("[dh]\nconvention = 'standard'\nrows = [{row}]")).unwrap()
    };
    assert_close(
        frame(&file(", flip = true"), &[-0.3], "flange"),
        frame(&file(""), &[0.3], "flange"),
        1e-15,
    );
}
