//! Arms: one twist from five frames, and families of a class.

use cylindroid::inverse;
use cylindroid::linalg::Matrix;
use cylindroid::screws::{ScrewOptions, ScrewSystem};
use cylindroid::spatial::{Twist, Vec3};

use super::{column, numbers, reference, swap, twists, with_length};
use crate::support::assert_close;

/// The same arm and twist from five frames and units: Moore-Penrose rates as listed, hyperbolic
/// rates all alike.
#[test]
fn youbot_from_five_frames() {
    for case in reference()["robot_youbot"].as_array().unwrap() {
        let j = twists(&case["J_base_m"]);
        let tcp = numbers(&case["tcp"]);
        let twist = numbers(&case["twist_base_m"]);
        let twist: [f64; 6] = std::array::from_fn(|i| twist[swap(i)]);
        let tool = Vec3::new(tcp[0], tcp[1], tcp[2]);
        let places = [
            ("base,m", Vec3::ZERO, 1.0),
            ("base,mm", Vec3::ZERO, 1e3),
            ("tool,m", tool, 1.0),
            ("tool,mm", tool, 1e3),
            ("world 5m away,m", Vec3::X * -5.0, 1.0),
        ];
        for (place, origin, unit) in places {
            let seen = |t: Twist| {
                let t = t.at_point(origin);
                Twist { linear: t.linear * unit, angular: t.angular }.to_array()
            };
            let mut moved = Matrix::zeros(6, 5);
            for c in 0..5 {
                moved.column_mut(c).copy_from_slice(&seen(column(&j, c)));
            }
            let s = seen(Twist::from_array(twist));
            let plain = inverse::truncated(&moved, 1e-9).unwrap().matrix.mul_vec(&s);
            let expected = numbers(&case["mp_rates"][place]);
            assert_close(place, &plain, &expected, 1e-9);
            for (h, key) in [(0.1, "h_rates_h=0.1m"), (1.0, "h_rates_h=1m")] {
                let found =
                    inverse::hyperbolic_with(&moved, h * unit, &with_length(0.655 * unit)).unwrap();
                let got = found.matrix.mul_vec(&s);
                assert_close(place, &got, &numbers(&case[key]), 1e-9);
            }
        }
        let system = ScrewSystem::of_columns(&j, &ScrewOptions::with_length(0.655)).unwrap();
        assert_eq!(system.class().name(), case["class"].as_str().unwrap());
    }
}

#[test]
fn arm_families() {
    for case in reference()["arm_families"].as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let system =
            ScrewSystem::of_columns(&twists(&case["J"]), &ScrewOptions::default()).unwrap();
        assert_eq!(system.order() as u64, case["k"].as_u64().unwrap(), "{name}");
        assert_eq!(system.class().name(), case["class"].as_str().unwrap(), "{name}");
        assert_close(
            name,
            &system.principal_pitches(),
            &numbers(&case["principal_pitches"]),
            1e-12,
        );
        assert_eq!(system.class().never_invertible(), case["never"].as_bool().unwrap(), "{name}");
        let exists = [-3.0, -0.1, 0.11, 1.0, 7.0].iter().any(|&h| system.existence(h).exists);
        assert_eq!(exists, !system.class().never_invertible(), "{name}");
    }
}
