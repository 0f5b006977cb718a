//! Determinants and pencils.

use cylindroid::linalg::Matrix;
use cylindroid::screws::{Line, ScrewOptions, ScrewSystem, gram, gram_determinant};
use cylindroid::spatial::{Pose, Twist, Vec3};

use crate::support::Random;

fn matrix(twists: &[Twist]) -> Matrix {
    Matrix::from_fn(6, twists.len(), |i, j| twists[j].to_array()[i])
}

/// -s12^2 for two lines and 2 s12 s23 s31 for three, s_ij = <s_i, s_j>_0.
#[test]
fn determinants_of_two_and_three_lines() {
    let mut random = Random(31);
    for _ in 0..50 {
        let lines: Vec<Twist> = (0..3)
            .map(|_| Line::through(random.vec3(1.0), random.vec3(1.0)).unwrap().twist())
            .collect();
        let s = |i: usize, j: usize| lines[i].klein(lines[j]);
        let two = gram_determinant(&matrix(&lines[..2]), 0.0).unwrap();
        assert!((two + s(0, 1) * s(0, 1)).abs() < 1e-13, "{two}");
        let three = gram_determinant(&matrix(&lines), 0.0).unwrap();
        assert!((three - 2.0 * s(0, 1) * s(1, 2) * s(2, 0)).abs() < 1e-13, "{three}");
        let g = gram(&matrix(&lines), 0.3).unwrap();
        assert_eq!(g[(0, 2)], lines[0].pitch_form(lines[2], 0.3));
    }
    // 4 (h - h_a) (h - h_b) over 2 Q_h: without the 4 over Q_h.
    let pair = [(0.3, Vec3::X), (-0.2, Vec3::Y)].map(|(h, e)| Twist { linear: e * h, angular: e });
    for h in [-1.0, 0.0, 0.7] {
        let determinant = gram_determinant(&matrix(&pair), h).unwrap();
        assert!((determinant - (0.3 - h) * (-0.2 - h)).abs() < 1e-14);
    }
    assert_eq!(gram_determinant(&Matrix::zeros(6, 7), 0.0), Ok(0.0));
    assert!(gram_determinant(&Matrix::zeros(5, 2), 0.0).is_err());
}

/// The axes of a two-system IA lie on z (x^2 + y^2) = (h_b - h_a) x y in its canonical frame, with
/// pitches h_a cos^2 + h_b sin^2.
#[test]
fn the_pencil_sweeps_the_cylindroid() {
    let mut random = Random(32);
    for _ in 0..20 {
        let pose = random.pose();
        let (a, b) = (random.within(0.1, 1.0), random.within(-1.0, 0.0));
        let twists = [
            Twist { linear: Vec3::X * a, angular: Vec3::X },
            Twist { linear: Vec3::Y * b, angular: Vec3::Y },
        ]
        .map(|t| pose.adjoint(t));
        let system = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        let home: Pose = system.canonical_pose().inverse();
        let screws = system.pencil(24);
        assert_eq!(screws.len(), 24);
        for (i, screw) in screws.iter().enumerate() {
            assert!(system.sine_to(screw.twist()) < 1e-12);
            let point = home * screw.axis.point;
            let d = home.rotation * screw.axis.direction;
            assert!(d.z.abs() < 1e-12);
            // Every axis crosses the z axis of the frame at right angles.
            let height = point.z;
            assert!((Vec3::new(point.x, point.y, 0.0).cross(d)).norm() < 1e-12);
            assert!((height - (b - a) * d.x * d.y).abs() < 1e-12, "{height}");
            let t = std::f64::consts::PI * i as f64 / 24.0;
            let pitch = a * t.cos().powi(2) + b * t.sin().powi(2);
            assert!((screw.pitch - pitch).abs() < 1e-12);
        }
    }
    let one = ScrewSystem::of(
        &[Line::through(Vec3::ZERO, Vec3::X).unwrap().twist()],
        &ScrewOptions::default(),
    );
    assert!(one.unwrap().pencil(5).is_empty());
}
