//! The servo takes the same steps wherever the mechanism stands, in metres and in millimetres, in
//! whatever order its file lists the joints.

use cylindroid::closure::assemble;
use cylindroid::control::{Target, simulate};
use cylindroid::model::{CoordinateKind, Dimension};
use cylindroid::{Mechanism, Servo, ServoOptions, catalogue};

use super::parsed;
use super::view::View;
use crate::support::Random;

/// A number from -1 to 1 that belongs to a name.
fn by_name(name: &str) -> f64 {
    let sum = name.bytes().fold(7_u32, |sum, b| (sum * 31 + u32::from(b)) % 1009);
    f64::from(sum) / 504.5 - 1.0
}

/// The configurations on the way to a pose nearby, by the names of the coordinates, without units;
/// and how the motion ended.
fn driven(m: &Mechanism, length: f64) -> (String, Vec<(String, f64)>) {
    let unit = |kind: CoordinateKind| match kind {
        CoordinateKind::Angle => Some(1.0),
        CoordinateKind::Length => Some(length),
        _ => None,
    };
    let guess: Vec<f64> = m
        .coordinates()
        .iter()
        .zip(m.home())
        .map(|(c, q)| q + 0.1 * by_name(&c.name) * unit(c.kind).unwrap_or(0.0))
        .collect();
    let goal = assemble(m, &guess, &[]).unwrap().q;
    let mut options = ServoOptions::new(m);
    options.dt = 2e-3;
    options.tolerance.position *= length;
    options.speed.linear = 0.2 * length;
    options.speed.angular = 0.5;
    options.secondary = options.default_secondary(m).unwrap();
    let tool = options.end_effector;
    let target = m.state(&goal).unwrap().pose(tool).unwrap();
    let mut servo = Servo::new(m, options).unwrap();
    let mut numbers = Vec::new();
    let mut step = 0;
    let names: Vec<_> = m.coordinates().iter().map(|c| (c.name.clone(), unit(c.kind))).collect();
    let mut note = |at: &str, q: &[f64]| {
        let known = names.iter().zip(q).filter_map(|((n, u), q)| u.map(|u| (n, q / u)));
        numbers.extend(known.map(|(name, q)| (format!("{at} {name}"), q)));
    };
    let result = simulate(
        &mut servo,
        m.home(),
        20.0,
        |_| (Target::from(target), true),
        |sample| {
            step += 1;
            if step == 50 {
                note("early", sample.q);
            }
        },
    )
    .unwrap();
    note("late", &result.q);
    numbers.push(("singular ratio".to_owned(), result.min_singular_ratio));
    numbers.sort_by(|a, b| a.0.cmp(&b.0));
    let limits: Vec<&str> = result.limits_hit.iter().map(|(c, _)| names[*c].0.as_str()).collect();
    (format!("{} {:?} {} {limits:?}", result.reached, result.stall, result.steps), numbers)
}

#[test]
fn the_servo_takes_the_same_steps_in_every_view() {
    let mut random = Random(17);
    for name in catalogue::names() {
        let file = format!("{}/src/model/catalogue/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).unwrap();
        let original = parsed(&text, name);
        let planar = original.dimension() == Dimension::Planar;
        let (end, numbers) = driven(&original, 1.0);
        let shuffled = !text.contains("\nhome");
        let scales = if text.contains("[[robot]]") { [1.0; 3] } else { [1.0, 1e3, 1e-3] };
        for scale in scales {
            let far = if scale < 1.0 { 0.1 } else { 100.0 };
            let view = View::random(&mut random, planar, [scale, far], shuffled);
            let seen = parsed(&view.of(&text, &mut random), name);
            let (seen_end, seen_numbers) = driven(&seen, scale);
            assert_eq!(seen_end, end, "{name} scaled by {scale}");
            assert_eq!(seen_numbers.len(), numbers.len(), "{name}");
            for ((what, x), (seen_what, y)) in numbers.iter().zip(&seen_numbers) {
                assert_eq!(seen_what, what, "{name}");
                assert!((x - y).abs() <= 1e-8, "{name} scaled by {scale}: {what} {x} {y}");
            }
        }
    }
}
