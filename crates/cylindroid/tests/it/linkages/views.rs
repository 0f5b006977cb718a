//! The same mechanism elsewhere, turned, in other units and with its tables in another order: every
//! number is the same.

use cylindroid::closure::{
    ClosedChain, Diagnosis, FiniteMobility, LimbScrews, Mobility, MobilityEvidence, MotionSpace,
    Transmission, assemble,
};
use cylindroid::model::CoordinateKind;
use cylindroid::spatial::Vec3;
use cylindroid::{Mechanism, catalogue};

use super::view::View;
use super::{names, parsed, text};
use crate::support::Random;

/// Everything that is said, without units; `length` is the unit of lengths.
fn said(m: &Mechanism, length: f64) -> (Vec<String>, Vec<(String, f64)>) {
    let state = m.state(m.home()).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let mobility = Mobility::of(&chain.constraint);
    let found = Diagnosis::of(&state, None, None).unwrap();
    let mut dimensions: Vec<usize> = found.finite.branches.iter().map(|b| b.dimension).collect();
    dimensions.sort_unstable();
    let mut words = vec![
        found.verdict.to_string(),
        found.verdict.motion(),
        format!("{:?} {dimensions:?}", found.generic.counts),
        format!("{:?}", mobility.relation),
        format!("{} {}", mobility.idle.dimension(), mobility.hyperstatic.dimension()),
    ];
    let d = found.distances;
    let mut numbers = vec![
        ("length".to_owned(), m.reach() / length),
        ("type I".to_owned(), d.type_i),
        ("type II".to_owned(), d.type_ii),
        ("configuration space".to_owned(), d.configuration_space),
        ("passive".to_owned(), d.passive),
    ];
    let names = chain.actuated.iter().chain(&chain.passive);
    for (name, j) in names.zip(&mobility.joints) {
        numbers.push((format!("share of {name}"), j.share));
        words.push(format!("{name} {} {} {}", j.moves, j.free_of_actuators, j.idle));
    }
    for (i, (sine, cosine)) in chain_pairs(&chain).into_iter().enumerate() {
        numbers.push((format!("sine {i:02}"), sine));
        numbers.push((format!("tangent {i:02}"), sine / cosine));
    }
    let screws = LimbScrews::of(&state, None, None).unwrap();
    for limb in &screws.limbs {
        let mut joints = limb.joints.clone();
        joints.sort();
        let classes = [&limb.twists, &limb.constraint, &limb.actuation]
            .map(|s| format!("{}{}", s.order(), s.class()));
        words.push(format!("{joints:?} {} {classes:?}", limb.serial));
    }
    if let Some(t) = Transmission::of(&screws, &found.generic) {
        for a in &t.actuators {
            words.push(format!("{} {} {}", a.name, a.input.is_some(), a.output.is_some()));
            numbers.extend(a.input.map(|x| (format!("input {}", a.name), x)));
            numbers.extend(a.output.map(|x| (format!("output {}", a.name), x)));
        }
        numbers.extend(t.local.map(|x| ("local".to_owned(), x)));
        numbers.extend(t.constraint.map(|x| ("constraint".to_owned(), x)));
    }
    words.push(format!("{:?}", found.verdict.zlatanov()));
    for (what, screws) in
        [("blocked", &found.blocked), ("lost", &found.lost), ("gained", &found.gained)]
    {
        words.push(format!("{} {what}", screws.len()));
    }
    words.push(format!("redundant {:?} idle {:?}", sorted(&found.redundant), sorted(&found.idle)));
    for (what, system) in [("twists", &screws.twists), ("constraint", &screws.constraint)] {
        words.push(format!("{what} {}{}", system.order(), system.class()));
    }
    // Assembled from a guess by name, coordinate by coordinate.
    let guess: Vec<f64> = m
        .coordinates()
        .iter()
        .zip(m.home())
        .map(|(c, q)| match c.kind {
            CoordinateKind::Angle => q + 0.05 * (by_name(&c.name) - 0.5),
            CoordinateKind::Length => q + 0.05 * length * (by_name(&c.name) - 0.5),
            // Their components depend on the axes of the world.
            _ => *q,
        })
        .collect();
    let assembly = assemble(m, &guess, &[]).unwrap();
    words.push(format!("closed {}", assembly.closed));
    // At a singular point the nearest assembly is accurate to the root of rounding.
    if assembly.closed && found.verdict.is_regular() {
        for (c, q) in m.coordinates().iter().zip(&assembly.q) {
            let unit = match c.kind {
                CoordinateKind::Angle => 1.0,
                CoordinateKind::Length => length,
                _ => continue,
            };
            numbers.push((format!("assembled {}", c.name), q / unit));
        }
    }
    words.sort();
    numbers.sort_by(|a, b| a.0.cmp(&b.0));
    (words, numbers)
}

fn sorted(names: &[String]) -> Vec<&String> {
    let mut names: Vec<&String> = names.iter().collect();
    names.sort();
    names
}

/// A number from 0 to 1 that belongs to a name.
fn by_name(name: &str) -> f64 {
    let sum = name.bytes().fold(7_u32, |sum, b| (sum * 31 + u32::from(b)) % 1009);
    f64::from(sum) / 1009.0
}

/// The efficiencies in scaled units.
fn chain_pairs(chain: &ClosedChain) -> Vec<(f64, f64)> {
    MotionSpace::of(&chain.constraint).relation().finite_pairs()
}

/// `views`: scale, distance in metres, and whether the tables are shuffled.
fn compare(name: &str, text: &str, views: &[(f64, f64, bool)], tolerance: f64) {
    let mut random = Random(11);
    let original = parsed(text, name);
    let planar = original.dimension() == cylindroid::model::Dimension::Planar;
    let (words, numbers) = said(&original, 1.0);
    for &(scale, far, shuffled) in views {
        let view = View::random(&mut random, planar, [scale, far], shuffled);
        let seen = view.of(text, &mut random);
        let (seen_words, seen_numbers) = said(&parsed(&seen, name), scale);
        let what = format!("{name} scaled by {scale}, shuffled {shuffled}");
        assert_eq!(seen_words, words, "{what}");
        assert_eq!(seen_numbers.len(), numbers.len(), "{what}");
        for ((label, x), (seen_label, y)) in numbers.iter().zip(&seen_numbers) {
            assert_eq!(label, seen_label, "{what}");
            let same = x == y || (x - y).abs() <= tolerance * x.abs().max(1e-3);
            // A mechanism whose axes all meet in one point has no length of its own.
            assert!(same || label == "length" && *x == 1.0, "{what}: {label} {x} {y}");
        }
    }
}

#[test]
fn linkages_look_the_same_from_everywhere() {
    for name in names() {
        let text = text(&name);
        let views = [
            (1.0, 100.0, false),
            (1e3, 100.0, false),
            (1e-3, 0.1, false),
            (1.0, 0.0, true),
            (1.0, 100.0, true),
        ];
        compare(&name, &text, &views, 1e-9);
        // Of a mechanism of millimetres a hundred metres away, eleven digits are left: too few for
        // a search of branches, and for the power with which `cascade2` opens, by 4e-7 half a radian
        // away.
        let m = parsed(&text, &name);
        let finite = FiniteMobility::of(&m.state(m.home()).unwrap(), None).unwrap();
        if finite.evidence != MobilityEvidence::Search && name != "cascade2" {
            compare(&name, &text, &[(1e-3, 100.0, false)], 1e-6);
        }
    }
}

#[test]
fn the_catalogue_looks_the_same_from_everywhere() {
    for name in catalogue::names() {
        let file = format!("{}/src/model/catalogue/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).unwrap();
        // A home is a list in the order of the joints.
        let shuffled = !text.contains("\nhome");
        compare(name, &text, &[(1.0, 100.0, false), (1.0, 100.0, shuffled)], 1e-9);
        // The lengths of robots of other files are not in this one.
        if !text.contains("[[robot]]") {
            let views = [(1e3, 100.0, shuffled), (1e-3, 0.1, shuffled)];
            compare(name, &text, &views, 1e-9);
            compare(name, &text, &[(1e-3, 100.0, false)], 1e-6);
        }
    }
}

/// The text of a random mechanism: a platform on limbs of random joints, one limb or several.
fn random_text(random: &mut Random) -> String {
    let mut whole = |n: usize| (random.within(0.0, n as f64) as usize).min(n - 1);
    let limbs = 2 + whole(3);
    let shapes: Vec<Vec<usize>> =
        (0..limbs).map(|_| (0..2 + whole(3)).map(|_| whole(6)).collect()).collect();
    let mut text = "name = \"random\"\nreference = \"platform\"\n".to_owned();
    let mut any = || random.within(-1.0, 1.0);
    text += &format!("reference_point = [{}, {}, {}]\n", any(), any(), any());
    for (limb, kinds) in shapes.iter().enumerate() {
        for (i, kind) in kinds.iter().enumerate() {
            let link = |i: usize| match i {
                0 => "ground".to_owned(),
                i if i == kinds.len() => "platform".to_owned(),
                i => format!("l{limb}{i}"),
            };
            let (a, b) = (link(i), link(i + 1));
            let names =
                ["revolute", "prismatic", "cylindrical", "universal", "spherical", "helical"];
            text += &format!(
                "[[joint]]\nname = \"j{limb}{i}\"\ntype = \"{}\"\nbetween = [\"{a}\", \"{b}\"]\n",
                names[*kind]
            );
            text += &format!("origin = [{}, {}, {}]\n", any(), any(), any());
            let axis = Vec3::new(any(), any(), any());
            let other = axis.cross(Vec3::new(any(), any(), any()));
            let row = |v: Vec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
            match kind {
                3 => text += &format!("axis = {}\naxis2 = {}\n", row(axis), row(other)),
                4 => {}
                5 => text += &format!("axis = {}\npitch = {}\n", row(axis), 0.2 * any()),
                _ => text += &format!("axis = {}\n", row(axis)),
            }
            if (limb + i) % 3 != 1 && matches!(kind, 0 | 1 | 5) {
                text += "actuated = true\n";
            }
        }
    }
    text
}

#[test]
fn random_mechanisms_look_the_same_from_everywhere() {
    let mut random = Random(23);
    for round in 0..80 {
        let text = random_text(&mut random);
        let views = [(1.0, 100.0, true), (1e3, 100.0, false), (1e-3, 0.1, true)];
        // Distances are known to rounding times the conditioning of the mechanism.
        compare(&format!("random {round}"), &text, &views, 1e-8);
    }
}
