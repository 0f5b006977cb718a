//! Singularity-free zones against closed forms and dense searches that share no code with them.

use std::f64::consts::PI;
use std::path::Path;

use cylindroid::sweep::{LocusKind, Zone, ZoneOptions, ZoneShape};
use cylindroid::{Error, Mechanism, Rotation, Vec3};

use crate::robots::{five_bar, three_rpr};

fn names(all: &[&str]) -> Vec<String> {
    all.iter().map(|name| (*name).to_owned()).collect()
}

fn held(all: &[(&str, f64)]) -> Vec<(String, Option<f64>)> {
    all.iter().map(|(name, value)| ((*name).to_owned(), Some(*value))).collect()
}

fn zone(mechanism: &Mechanism, components: &[&str], options: ZoneOptions) -> Zone {
    Zone::of(mechanism, ZoneOptions { components: names(components), ..options }).unwrap()
}

/// The first zero of a function of the way along a ray, which is a polynomial of this degree or less.
fn first_root(f: impl Fn(f64) -> f64, farthest: f64) -> f64 {
    const STEPS: usize = 400;
    let at = |i: usize| farthest * i as f64 / STEPS as f64;
    let mut before = f(0.0);
    for i in 1..=STEPS {
        let now = f(at(i));
        if before * now <= 0.0 {
            let (mut low, mut high) = (at(i - 1), at(i));
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if before * f(middle) > 0.0 { low = middle } else { high = middle }
            }
            return 0.5 * (low + high);
        }
        before = now;
    }
    f64::INFINITY
}

/// The smallest value over directions of k components: the best of many, then steps that shrink.
fn smallest(k: usize, on_box: bool, along: impl Fn(&[f64]) -> f64) -> f64 {
    let to_size = |x: &[f64]| -> Vec<f64> {
        let size = if on_box {
            x.iter().fold(0.0_f64, |a, x| a.max(x.abs()))
        } else {
            x.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        x.iter().map(|x| x / size).collect()
    };
    let mut random = crate::support::Random(11);
    let mut all: Vec<(f64, Vec<f64>)> = (0..4000)
        .map(|_| {
            let d = to_size(&(0..k).map(|_| random.within(-1.0, 1.0)).collect::<Vec<_>>());
            (along(&d), d)
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refined = all.into_iter().take(12).map(|(mut best, mut d)| {
        let mut step = 0.1;
        while step > 1e-10 {
            let mut moved = false;
            for i in 0..k {
                for side in [-step, step] {
                    let mut next = d.clone();
                    next[i] += side;
                    let next = to_size(&next);
                    let value = along(&next);
                    if value < best {
                        (best, d, moved) = (value, next, true);
                    }
                }
            }
            // Random directions as well, for valleys that are oblique.
            for _ in 0..6 {
                let next: Vec<f64> =
                    d.iter().map(|x| x + step * random.within(-1.0, 1.0)).collect();
                let next = to_size(&next);
                let value = along(&next);
                if value < best {
                    (best, d, moved) = (value, next, true);
                }
            }
            if !moved {
                step *= 0.7;
            }
        }
        best
    });
    refined.fold(f64::INFINITY, f64::min)
}

/// The determinant of a matrix, by elimination.
fn determinant<const N: usize>(mut a: [[f64; N]; N]) -> f64 {
    let mut product = 1.0;
    for k in 0..N {
        let pivot = (k..N).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        if pivot != k {
            a.swap(pivot, k);
            product = -product;
        }
        product *= a[k][k];
        if a[k][k] == 0.0 {
            return 0.0;
        }
        let row = a[k];
        for below in &mut a[k + 1..] {
            let factor = below[k] / row[k];
            below.iter_mut().zip(row).for_each(|(x, above)| *x -= factor * above);
        }
    }
    product
}

const BASE: [[f64; 2]; 3] = [[-1.0, -0.8], [1.2, -0.7], [0.1, 1.3]];
const PLATFORM: [[f64; 2]; 3] = [[-0.4, -0.2], [0.5, -0.3], [0.1, 0.4]];

/// The lines of the legs of a 3-RPR meet in a point.
fn of_three_legs([x, y, turn]: [f64; 3]) -> f64 {
    let (s, c) = turn.sin_cos();
    determinant(std::array::from_fn(|i| {
        let [bx, by] = PLATFORM[i];
        let end = [x + c * bx - s * by, y + s * bx + c * by];
        let (dx, dy) = (end[0] - BASE[i][0], end[1] - BASE[i][1]);
        [dx, dy, end[0] * dy - end[1] * dx]
    }))
}

#[test]
fn zones_of_a_3rpr_are_those_of_its_determinant() {
    let mechanism = three_rpr(BASE, PLATFORM, "limits = { lower = -20, upper = 20 }");
    for shape in [ZoneShape::Ball, ZoneShape::Box] {
        let on_box = shape == ZoneShape::Box;
        for turn in [0.0, 0.3] {
            let centre = held(&[("rz", turn)]);
            let options = ZoneOptions { shape, held: centre, rays: 64, ..ZoneOptions::default() };
            let found = zone(&mechanism, &["x", "y"], options);
            let along = |d: &[f64]| first_root(|t| of_three_legs([t * d[0], t * d[1], turn]), 6.0);
            let expected = smallest(2, on_box, along);
            assert_eq!(found.bounds[0].kind, LocusKind::TypeTwo, "{turn}");
            assert!((found.size - expected).abs() < 1e-9, "{turn}: {} {expected}", found.size);
            let p = &found.bounds[0].point;
            assert!(of_three_legs([p[0], p[1], turn]).abs() < 1e-9, "{p:?}");
            // All rays but those along the components that end at other bounds.
            assert!(found.confirmed >= 64, "{}", found.confirmed);
            assert!(found.certified > 50, "{} of {}", found.certified, found.confirmed);
        }
        // Lengths beside an angle.
        let scales = vec![1.0, 1.0, 0.8];
        let options = ZoneOptions { shape, scales, rays: 200, ..ZoneOptions::default() };
        let found = zone(&mechanism, &["x", "y", "rz"], options);
        let along =
            |d: &[f64]| first_root(|t| of_three_legs([t * d[0], t * d[1], 0.8 * t * d[2]]), 3.9);
        let expected = smallest(3, on_box, along);
        assert!((found.size - expected).abs() < 1e-8, "{shape:?}: {} {expected}", found.size);
    }
}

/// A platform that is moved, turned and scaled, with its legs in another order, has the same zone.
#[test]
fn zones_do_not_depend_on_frame_size_and_order() {
    const LIMITS: &str = "limits = { lower = -20, upper = 20 }";
    let (sin, cos) = 0.7_f64.sin_cos();
    for shape in [ZoneShape::Ball, ZoneShape::Box] {
        // The sides of a box do not turn with the mechanism.
        let (sin, cos) = if shape == ZoneShape::Box { (0.0, -1.0) } else { (sin, cos) };
        let size = |mechanism: &Mechanism, scale: f64, at: [f64; 2]| {
            let centre = held(&[("x", at[0]), ("y", at[1]), ("rz", 0.0)]);
            let options = ZoneOptions { shape, held: centre, ..ZoneOptions::default() };
            let plane = zone(mechanism, &["x", "y"], options.clone());
            let scales = vec![scale, scale, 0.8];
            let all = zone(mechanism, &["x", "y", "rz"], ZoneOptions { scales, ..options });
            assert_eq!(plane.bounds[0].kind, LocusKind::TypeTwo);
            [plane.size / scale, all.size]
        };
        let expected = size(&three_rpr(BASE, PLATFORM, LIMITS), 1.0, [0.0, 0.0]);
        // The platform's home, and with it the characteristic length, stays where it is.
        for (scale, order, at) in [(2.0, [2, 0, 1], [0.4, -0.3]), (0.1, [1, 0, 2], [-0.03, 0.05])] {
            let turned =
                |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y].map(|c| scale * c);
            let base = order.map(|i| turned(BASE[i])).map(|[x, y]| [x + at[0], y + at[1]]);
            let platform = order.map(|i| turned(PLATFORM[i]));
            let found = size(&three_rpr(base, platform, LIMITS), scale, at);
            for (a, b) in found.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-8 * b, "{shape:?} {scale}: {found:?} {expected:?}");
            }
        }
    }
}

/// Of type I, at the circles where a leg is straight, and of type II, where coupler and rod are aligned.
#[test]
fn balls_of_a_five_bar_are_those_of_its_circles() {
    let mechanism = five_bar();
    let found = zone(&mechanism, &["x", "y"], ZoneOptions { rays: 64, ..ZoneOptions::default() });
    // The tip at (1, 2), cranks 2 and 1 about (0, 0) and (2, 0), links 1 and sqrt 2.
    let [left, right] = [5.0_f64.sqrt(), 5.0_f64.sqrt()];
    let root = 2.0_f64.sqrt();
    let circles = (3.0 - left).min(left - 1.0).min(root + 1.0 - right).min(right - root + 1.0);
    assert!((found.size - circles).abs() < 1e-9, "{} {circles}", found.size);
    assert_eq!(found.bounds[0].kind, LocusKind::TypeOne);
    // Every bound is the nearest point of its circle, or lies where the links are aligned.
    for bound in &found.bounds {
        let state = mechanism.state(&bound.q).unwrap();
        let tip = state.pose(mechanism.reference()).unwrap().translation;
        assert!((tip.x - bound.point[0]).hypot(tip.y - bound.point[1]) < 1e-9);
        let apart = (bound.point[0] - 1.0).hypot(bound.point[1] - 2.0);
        assert!((apart - bound.distance).abs() < 1e-12);
    }
}

/// Of any size and in any way to assemble: circles where a leg is straight or folded, and where both
/// rods are on one line, in the way of the centre.
#[test]
fn balls_of_random_five_bars_are_those_of_a_dense_search() {
    // The first, and some of the next thousand whose bound had been one of another way to assemble
    // beside a straight leg, or the end of a ray before a folded leg.
    let hard = [40, 115, 156, 416, 446, 459, 567, 679, 717, 828];
    check_five_bars(|number| number < 12 || hard.contains(&number));
}

#[test]
#[ignore = "takes minutes"]
fn balls_of_a_thousand_five_bars_are_those_of_a_dense_search() {
    check_five_bars(|_| true);
}

fn check_five_bars(is_chosen: impl Fn(i32) -> bool) {
    let mut random = crate::support::Random(20);
    for number in 0..1000 {
        let mut point = || [random.within(-1.5, 1.5), random.within(-1.5, 1.5)];
        let (ends, tip) = ([point(), point()], point());
        if !is_chosen(number) {
            continue;
        }
        let bases = [[-0.6, 0.0], [0.6, 0.1]];
        let from = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2]| [bx - ax, by - ay];
        let cross = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2]| ax * by - ay * bx;
        let size = |[x, y]: [f64; 2]| x.hypot(y);
        let legs: [_; 2] = std::array::from_fn(|i| {
            let (crank, rod) = (from(bases[i], ends[i]), from(ends[i], tip));
            (bases[i], [size(crank), size(rod)], cross(crank, rod).signum())
        });
        // The rods that end at a point, by the law of cosines.
        let rods = |p: [f64; 2]| {
            legs.map(|(base, [crank, rod], side)| {
                let v = from(base, p);
                let d = size(v);
                let cos = (d * d + crank * crank - rod * rod) / (2.0 * d * crank);
                let sin = side * (1.0 - cos * cos).max(0.0).sqrt();
                let [x, y] = v.map(|x| x * crank / d);
                [v[0] - cos * x - sin * y, v[1] + sin * x - cos * y]
            })
        };
        let along = |d: &[f64]| {
            // Roots of quadratic equations on the circles.
            let on_circles = legs.iter().flat_map(|(base, [crank, rod], _)| {
                let v = from(*base, tip);
                let half = v[0] * d[0] + v[1] * d[1];
                [crank + rod, (crank - rod).abs()]
                    .map(|r| half * half - size(v).powi(2) + r * r)
                    .into_iter()
                    .flat_map(move |root| [-half - root.sqrt(), -half + root.sqrt()])
            });
            let circle = on_circles.filter(|t| *t > 0.0).fold(4.0, f64::min);
            let aligned = |t: f64| {
                let [a, b] = rods([tip[0] + t * d[0], tip[1] + t * d[1]]);
                cross(a, b)
            };
            first_root(aligned, circle).min(circle)
        };
        let expected = smallest(2, false, along);
        if expected < 1e-3 {
            continue;
        }
        let mechanism = crate::robots::five_bar_with(bases, ends, tip);
        let found = zone(&mechanism, &["x", "y"], ZoneOptions::default());
        let off = (found.size - expected).abs();
        assert!(off < 1e-6 * expected, "{number}: {} {expected}", found.size);
    }
}

/// The six legs of the platform of the catalogue: Pluecker coordinates, a cubic in the position.
#[test]
fn balls_of_a_stewart_platform_are_those_of_a_dense_search() {
    let mechanism = cylindroid::load("stewart").unwrap();
    let state = mechanism.state(mechanism.home()).unwrap();
    let frame = |name: String| state.pose(mechanism.frame(&name).unwrap()).unwrap();
    let joint = |name: String| {
        let joint = mechanism.joints().iter().find(|j| j.name == name).unwrap();
        let link = mechanism.links()[joint.parent].name.clone();
        (frame(link) * joint.parent_from_joint).translation
    };
    // The balls are at the ends of the rods; the platform is at (0, 0, 1) without a turn.
    let ends: Vec<[Vec3; 2]> = (1..=6)
        .map(|i| {
            let base = joint(format!("u{i}"));
            let leg = joint(format!("leg{i}"));
            [base, leg - Vec3::new(0.0, 0.0, 1.0)]
        })
        .collect();
    let turn =
        Rotation::exp(Vec3::Z * 0.3) * Rotation::exp(Vec3::Y * 0.1) * Rotation::exp(Vec3::X * 0.2);
    let of_legs = |p: Vec3| {
        determinant(std::array::from_fn(|i| {
            let [base, own] = ends[i];
            let end = p + turn * own;
            let (d, m) = (end - base, base.cross(end));
            [d.x, d.y, d.z, m.x, m.y, m.z]
        }))
    };
    let orientation = [("roll", 0.2), ("pitch", 0.1), ("yaw", 0.3)];
    for (shape, rays) in [(ZoneShape::Ball, 48), (ZoneShape::Box, 24)] {
        let centre = [&[("x", 0.1), ("y", -0.05), ("z", 0.9)][..], &orientation].concat();
        let options = ZoneOptions {
            shape,
            held: held(&centre),
            limits: false,
            rays,
            ..ZoneOptions::default()
        };
        let found = zone(&mechanism, &["x", "y", "z"], options);
        let from = Vec3::new(0.1, -0.05, 0.9);
        let along =
            |d: &[f64]| first_root(|t| of_legs(from + Vec3::new(d[0], d[1], d[2]) * t), 4.0);
        let expected = smallest(3, shape == ZoneShape::Box, along);
        let bound = &found.bounds[0];
        assert_eq!(bound.kind, LocusKind::TypeTwo, "{found:?}");
        assert!((found.size - expected).abs() < 1e-8, "{shape:?}: {} {expected}", found.size);
        let p = Vec3::new(bound.point[0], bound.point[1], bound.point[2]);
        assert!(of_legs(p).abs() < 1e-9, "{}", of_legs(p));
    }
}

/// Joint space of a 3R arm: straight or folded, or its point above the first axis.
#[test]
fn balls_of_an_arm_are_those_of_its_closed_form() {
    let arm = cylindroid::load("3r").unwrap();
    for [shoulder, elbow] in [[0.5, -1.0], [1.2, -1.2], [-0.4, 2.9], [0.1, 0.6]] {
        let start = Some(vec![0.3, shoulder, elbow]);
        let options = ZoneOptions { start, limits: false, rays: 32, ..ZoneOptions::default() };
        let found = zone(&arm, &["joint2", "joint3"], options);
        // cos q2 + cos(q2 + q3) = 2 cos(q2 + q3 / 2) cos(q3 / 2).
        let line = shoulder + 0.5 * elbow;
        let above = |k: f64| (line - 0.5 * PI * k).abs() / 1.25_f64.sqrt();
        let elbow = f64::abs(elbow);
        let expected = elbow.min(PI - elbow).min(above(1.0)).min(above(-1.0));
        assert!((found.size - expected).abs() < 1e-9, "{} {expected}", found.size);
        assert_eq!(found.bounds[0].kind, LocusKind::TypeOne);
        // All three joints: the first one changes nothing.
        let start = Some(vec![0.3, shoulder, found.q[2]]);
        let options = ZoneOptions { start, limits: false, rays: 32, ..ZoneOptions::default() };
        let all = zone(&arm, &["joint1", "joint2", "joint3"], options);
        assert!((all.size - expected).abs() < 1e-9, "{} {expected}", all.size);
    }
    // In the space of the tool: a sphere of two links, and the first axis.
    let start = vec![0.3, 0.5, -1.0];
    let p = arm.state(&start).unwrap().pose(arm.tool()).unwrap().translation;
    let options =
        ZoneOptions { start: Some(start), limits: false, rays: 64, ..ZoneOptions::default() };
    let found = zone(&arm, &["x", "y", "z"], options);
    let (radial, far) = (p.x.hypot(p.y), p.x.hypot(p.y).hypot(p.z - 0.4));
    let expected = (0.8 - far).min(far).min(radial);
    assert!((found.size - expected).abs() < 1e-9, "{} {expected}", found.size);
}

/// A limit is a bound as well, unless limits are ignored.
#[test]
fn limits_are_bounds() {
    let mechanism = three_rpr(BASE, PLATFORM, "limits = { lower = -0.05, upper = 0.05 }");
    let options = || ZoneOptions { rays: 32, ..ZoneOptions::default() };
    let found = zone(&mechanism, &["x", "y"], options());
    assert_eq!(found.bounds[0].kind, LocusKind::Limit);
    assert!(found.bounds[0].limit.as_deref().unwrap().starts_with("leg"));
    // At constant orientation the length of a leg changes by the way at most, along the leg.
    assert!((found.size - 0.05).abs() < 1e-9, "{}", found.size);
    let free = ZoneOptions { limits: false, ..options() };
    assert!(zone(&mechanism, &["x", "y"], free).size > 0.1);
}

/// A door on two hinges is regular, tilted or not, whichever way its handle points.
#[test]
fn doors_are_centres_of_zones() {
    for axis in [Vec3::Z, Vec3::new(1.0, 2.0, 3.0), Vec3::new(-0.3, 0.8, 0.1)] {
        for handle in ["[1, 0, 0]", "[0, 1, 0]", "[0.3, 0.2, 0.4]"] {
            let list = |v: Vec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
            let text = format!(
                "reference = \"door\"\nreference_point = {handle}\n\
                 [[joint]]\nname = \"hinge1\"\ntype = \"revolute\"\n\
                 between = [\"ground\", \"door\"]\norigin = [0, 0, 0]\naxis = {}\n\
                 actuated = true\n\
                 [[joint]]\nname = \"hinge2\"\ntype = \"revolute\"\n\
                 between = [\"ground\", \"door\"]\norigin = {}\naxis = {}\n",
                list(axis),
                list(axis * 0.1),
                list(axis)
            );
            let door = cylindroid::load_text(&text, Path::new("door.toml")).unwrap();
            let options = ZoneOptions { limits: false, ..ZoneOptions::default() };
            let found = zone(&door, &["hinge1"], options);
            assert!(found.size > 0.1, "{axis:?} {handle}: {found:?}");
        }
    }
}

#[test]
fn zones_that_do_not_exist_are_refused() {
    let refused = |model: &str, components: &[&str], options: ZoneOptions| -> Error {
        let robot = cylindroid::load(model).unwrap();
        let components = names(components);
        Zone::of(&robot, ZoneOptions { components, ..options }).unwrap_err()
    };
    let plain = ZoneOptions::default;
    let message = |model: &str, components: &[&str], options: ZoneOptions| {
        refused(model, components, options).to_string()
    };
    assert!(message("five-bar", &[], plain()).contains("name one at least"));
    assert!(message("five-bar", &["x", "x"], plain()).contains("named twice"));
    assert!(matches!(refused("five-bar", &["x", "w"], plain()), Error::UnknownName { .. }));
    let both = ["y", "rz"].map(|name| (name.to_owned(), None)).to_vec();
    let free = ZoneOptions { held: both, ..plain() };
    assert!(message("five-bar", &["x"], free).contains("motions of the mechanism free"));
    assert!(message("panda", &["x", "y", "z"], plain()).contains("free"));
    let joints = ["panda_joint1", "panda_joint2"];
    assert!(message("panda", &joints, plain()).contains("redundant joints"));
    assert!(message("five-bar", &["q3"], plain()).contains("not actuated"));
    let scales = ZoneOptions { scales: vec![1.0, 0.0], ..plain() };
    assert!(message("five-bar", &["x", "y"], scales).contains("positive"));
    let tiny = ZoneOptions { scales: vec![1.0, 1e-200], ..plain() };
    assert!(message("five-bar", &["x", "y"], tiny).starts_with("scales = 1e-200"));
    let far = ZoneOptions { held: held(&[("x", 9.0)]), ..plain() };
    assert!(message("five-bar", &["x", "y"], far).contains("no configuration"));
    let singular = ZoneOptions { start: Some(vec![0.0, 0.3, 0.0]), ..plain() };
    assert!(message("3r", &["joint2", "joint3"], singular).contains("singular"));
    let many = ZoneOptions { rays: 1 << 30, ..plain() };
    assert!(message("five-bar", &["x", "y"], many).contains("2^20"));
}
