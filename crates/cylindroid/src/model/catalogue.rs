//! Temporary catalogue.
use super::*;
use crate::error::Result;
use crate::spatial::*;
pub fn names() -> &'static [&'static str] {
    &["panda", "ur5e", "puma560", "iiwa14", "youbot", "3r"]
}
pub fn load(name: &str) -> Result<Mechanism> {
    use std::f64::consts::FRAC_PI_2 as H;
    let mut b = Mechanism::builder(name);
    let (rows, modified): (Vec<[f64; 3]>, bool) = match name {
        "panda" => (
            vec![
                [0., 0., 0.333],
                [0., -H, 0.],
                [0., H, 0.316],
                [0.0825, H, 0.],
                [-0.0825, -H, 0.384],
                [0., H, 0.],
                [0.088, H, 0.],
            ],
            true,
        ),
        "ur5e" => (
            vec![
                [0., H, 0.1625],
                [-0.425, 0., 0.],
                [-0.3922, 0., 0.],
                [0., H, 0.1333],
                [0., -H, 0.0997],
                [0., 0., 0.0996],
            ],
            false,
        ),
        "puma560" => (
            vec![
                [0., H, 0.0],
                [0.4318, 0., 0.],
                [0.0203, -H, 0.15005],
                [0., H, 0.4318],
                [0., -H, 0.],
                [0., 0., 0.],
            ],
            false,
        ),
        "iiwa14" => (
            vec![
                [0., -H, 0.36],
                [0., H, 0.],
                [0., H, 0.42],
                [0., -H, 0.],
                [0., -H, 0.4],
                [0., H, 0.],
                [0., 0., 0.126],
            ],
            false,
        ),
        "youbot" => (
            vec![
                [0.033, H, 0.147],
                [0.155, 0., 0.],
                [0.135, 0., 0.],
                [0., H, 0.],
                [0., 0., 0.2175],
            ],
            false,
        ),
        _ => (vec![[0., H, 0.4], [0.4, 0., 0.], [0.4, 0., 0.]], false),
    };
    let lim: Vec<(f64, f64, f64, f64)> = match name {
        "panda" => vec![
            (-2.8973, 2.8973, 2.175, 15.),
            (-1.7628, 1.7628, 2.175, 7.5),
            (-2.8973, 2.8973, 2.175, 10.),
            (-3.0718, -0.0698, 2.175, 12.5),
            (-2.8973, 2.8973, 2.61, 15.),
            (-0.0175, 3.7525, 2.61, 20.),
            (-2.8973, 2.8973, 2.61, 20.),
        ],
        "ur5e" => vec![
            (-6.283, 6.283, 3.14, f64::INFINITY),
            (-6.283, 6.283, 3.14, f64::INFINITY),
            (-3.14, 3.14, 3.14, f64::INFINITY),
            (-6.283, 6.283, 3.14, f64::INFINITY),
            (-6.283, 6.283, 3.14, f64::INFINITY),
            (-6.283, 6.283, 3.14, f64::INFINITY),
        ],
        _ => vec![(-2.9, 2.9, 2.0, f64::INFINITY); 7],
    };
    let n = rows.len();
    let mut pending = Pose::IDENTITY;
    for (i, [a, alpha, d]) in rows.iter().copied().enumerate() {
        let rx = Pose {
            rotation: Rpy { roll: alpha, pitch: 0., yaw: 0. }.rotation(),
            translation: Vec3::X * a,
        };
        let dz = Pose::from_translation(Vec3::Z * d);
        let before = if modified { pending * rx * dz } else { pending };
        pending = if modified { Pose::IDENTITY } else { dz * rx };
        b.joint(JointSpec {
            parent_from_joint: before,
            limits: Limits {
                lower: lim[i].0,
                upper: lim[i].1,
                velocity: lim[i].2,
                acceleration: lim[i].3,
                effort: f64::INFINITY,
            },
            ..JointSpec::new(
                &format!("joint{}", i + 1),
                JointKind::Revolute,
                &format!("link{i}"),
                &format!("link{}", i + 1),
            )
        });
    }
    let tip = if name == "panda" {
        Pose { rotation: Rotation::about_z(-H / 2.), translation: Vec3::Z * (0.107 + 0.1034) }
    } else {
        pending
    };
    let t = if name == "panda" { "hand_tcp" } else { "tool0" };
    b.frame(t, &format!("link{n}"), tip).tool(t);
    let p = std::f64::consts::PI;
    match name {
        "panda" => {
            b.home(&[0., -p / 4., 0., -3. * p / 4., 0., p / 2., p / 4.]);
        }
        "ur5e" => {
            b.home(&[0., -H, H, -H, -H, 0.]);
        }
        "iiwa14" => {
            b.home(&[0., 0.5, 0., -1.2, 0., 1.0, 0.]);
        }
        "puma560" => {
            b.home(&[0., 0.785, p, 0., 0.785, 0.].map(|x: f64| x.min(2.9)));
        }
        "youbot" => {
            b.home(&[0., 0.5, 0.6, 0.7, 0.]);
        }
        _ => {
            b.home(&[0., 0.5, 0.6]);
        }
    }
    b.build()
}
