//! The order of the tables of a mechanism file, and of the two links of a joint, do not matter:
//! results are the same for every name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use cylindroid::closure::{
    ClosedChain, Diagnosis, Mobility, MobilityCounts, MotionSpace, Singularities,
};
use cylindroid::manipulability::{Manipulability, Metrics};
use cylindroid::model::formats;
use cylindroid::{Mechanism, ReferenceFrame};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The head of a mechanism file and its `[[...]]` tables.
fn tables(text: &str) -> (String, Vec<String>) {
    let mut head = String::new();
    let mut tables: Vec<String> = Vec::new();
    for line in text.lines() {
        if line.starts_with("[[") {
            tables.push(String::new());
        }
        let part = tables.last_mut().unwrap_or(&mut head);
        part.push_str(line);
        part.push('\n');
    }
    (head, tables)
}

fn shuffled(text: &str, random: &mut Random) -> String {
    let (head, mut tables) = tables(text);
    for i in (1..tables.len()).rev() {
        tables.swap(i, random.next() as usize % (i + 1));
    }
    head + &tables.concat()
}

fn value<'t>(table: &'t str, key: &str) -> Option<&'t str> {
    table.lines().find_map(|l| l.split_once('=').filter(|(k, _)| k.trim() == key)).map(|(_, v)| v)
}

/// Some of the joints written from their second link to their first, with their names: those whose
/// coordinates then have the opposite sign, by definition.
fn turned(text: &str, random: &mut Random) -> (String, Vec<String>) {
    let (mut out, tables) = tables(text);
    let mut names = Vec::new();
    for table in tables {
        let kind = value(&table, "type").unwrap_or("").trim().trim_matches('"').to_owned();
        let can = table.starts_with("[[joint]]") && !table.contains("limits");
        if !can || ["planar", "free", "fixed"].contains(&kind.as_str()) || random.unit() < 0.5 {
            out += &table;
            continue;
        }
        names.push(value(&table, "name").unwrap().trim().trim_matches('"').to_owned());
        for line in table.lines() {
            out += &match line.split_once('=') {
                Some((key, pair)) if key.trim() == "between" => {
                    let links: Vec<&str> = pair.split('"').collect();
                    format!("between = [\"{}\", \"{}\"]", links[3], links[1])
                }
                Some((key, axis)) if key.trim() == "axis" && kind == "universal" => {
                    format!("axis2 ={axis}")
                }
                Some((key, axis)) if key.trim() == "axis2" => format!("axis ={axis}"),
                _ => line.to_owned(),
            };
            out.push('\n');
        }
    }
    (out, names)
}

/// The name of a coordinate when its joint is turned round: the axes of a universal joint change
/// places.
fn partner(name: &str) -> String {
    match name.strip_suffix(".first") {
        Some(joint) => format!("{joint}.second"),
        None => name.replace(".second", ".first"),
    }
}

/// Everything that has a name, at home and at a random configuration; coordinates of turned joints
/// under the name and with the sign that they have in the original.
fn results(m: &Mechanism, turned: &[String]) -> BTreeMap<String, Vec<f64>> {
    let mut all = BTreeMap::new();
    let mut add = |name: String, values: Vec<f64>| {
        assert!(all.insert(name.clone(), values).is_none(), "two results are named {name}");
    };
    let original: Vec<(String, f64)> = m
        .coordinates()
        .iter()
        .map(|c| match turned.contains(&m.joints()[c.joint].name) {
            true => (partner(&c.name), -1.0),
            false => (c.name.clone(), 1.0),
        })
        .collect();
    for l in m.loops() {
        add(format!("loop {}, {}", l.name, l.kind.name()), vec![]);
    }
    let q: Vec<f64> = original
        .iter()
        .map(|(name, sign)| {
            let seed = name.bytes().fold(7, |s: u64, b| s.wrapping_mul(31).wrapping_add(b.into()));
            sign * (Random(seed).unit() - 0.5)
        })
        .collect();
    let reference = m.reference();
    for (at, q) in [("home", m.home()), ("q", &q)] {
        let state = m.state(q).unwrap();
        for (i, link) in m.links().iter().enumerate() {
            let pose = state.pose(m.frame(&link.name).unwrap()).unwrap().to_matrix();
            add(format!("{at}: link {}", m.links()[i].name), pose.as_flattened().to_vec());
        }
        let jacobian = state.jacobian(reference, ReferenceFrame::World).unwrap();
        for (c, (name, sign)) in original.iter().enumerate() {
            let column = jacobian.column(c).iter().map(|x| sign * x).collect();
            add(format!("{at}: column {name}"), column);
        }
    }

    let state = m.state(m.home()).unwrap();
    let chain = ClosedChain::of(&state, None, None).unwrap();
    let motions = MotionSpace::of(&chain.constraint);
    let relation = motions.relation();
    let mobility = Mobility::of(&chain.constraint);
    let counts = [
        mobility.dof.dimension(),
        mobility.redundancy.dimension(),
        mobility.indeterminacy.dimension(),
        mobility.coordinate.dimension(),
        mobility.idle.dimension(),
        mobility.internal.dimension(),
        mobility.zero_torque.dimension(),
        mobility.hyperstatic.dimension(),
    ];
    add("counts".to_owned(), counts.map(|n| n as f64).to_vec());
    add("Gruebler-Kutzbach".to_owned(), vec![mobility.gruebler_kutzbach as f64]);
    add("length".to_owned(), vec![chain.constraint.length()]);
    let generic = MobilityCounts::of(&motions, &relation);
    let found = Singularities::of(&motions, &relation, &generic).distances;
    let distances = [found.type_i, found.type_ii, found.configuration_space, found.passive];
    add("distances".to_owned(), distances.to_vec());
    let names = chain.actuated.iter().chain(&chain.passive);
    for (name, joint) in names.zip(&mobility.joints) {
        // Axes of a universal joint that is turned round change places, those of a spherical
        // joint the axes in which they are given.
        if !name.contains('.') {
            add(format!("share of {name}"), vec![joint.share]);
        }
    }
    if let Ok(found) = Manipulability::of(&relation, &Metrics::default()) {
        add("efficiencies".to_owned(), found.kinematic.values());
    }
    all
}

/// The verdict at home, with its distances.
fn verdict(m: &Mechanism) -> BTreeMap<String, Vec<f64>> {
    let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
    let kinds: Vec<String> = found.verdict.kinds().iter().map(|k| format!("{k:?}")).collect();
    let mut redundant = found.redundant.clone();
    redundant.sort();
    let d = found.distances;
    let finite = found.finite.finite.map_or(-1.0, |n| n as f64);
    BTreeMap::from([
        (format!("kinds {kinds:?}, redundant {redundant:?}"), vec![]),
        ("distances".to_owned(), vec![d.type_i, d.type_ii, d.configuration_space, d.passive]),
        ("finite mobility".to_owned(), vec![finite]),
    ])
}

#[track_caller]
fn assert_same(
    what: &str,
    got: &BTreeMap<String, Vec<f64>>,
    expected: &BTreeMap<String, Vec<f64>>,
) {
    let names = |all: &BTreeMap<String, _>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(got), names(expected), "{what}");
    for (name, expected) in expected {
        let got = &got[name];
        assert_eq!(got.len(), expected.len(), "{what}, {name}");
        for (a, b) in got.iter().zip(expected) {
            let close = (a - b).abs() <= 1e-9 * (1.0 + b.abs());
            assert!(close || a == b, "{what}, {name}: {got:?}, expected {expected:?}");
        }
    }
}

fn read(text: &str, path: &Path) -> Mechanism {
    formats::toml::parse(text, path).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Mechanism files of the catalogue and of the test data.
fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["src/model/catalogue", "tests/data/mechanisms", "tests/data/linkages"];
    let in_folder = |folder: &str| std::fs::read_dir(root.join(folder)).unwrap();
    let paths = folders.into_iter().flat_map(in_folder).map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        paths.filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

#[test]
fn tables_in_any_order() {
    let mut random = Random(1);
    for path in files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected = read(&text, &path);
        let what = path.display().to_string();
        let (values, judged) = (results(&expected, &[]), verdict(&expected));
        for i in 0..10 {
            let m = read(&shuffled(&text, &mut random), &path);
            assert_same(&what, &results(&m, &[]), &values);
            if i % 3 == 0 {
                assert_same(&what, &verdict(&m), &judged);
            }
        }
    }
}

#[test]
fn joints_from_either_link() {
    let mut random = Random(2);
    for path in files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected = read(&text, &path);
        let (values, judged) = (results(&expected, &[]), verdict(&expected));
        for i in 0..10 {
            let (other, names) = turned(&shuffled(&text, &mut random), &mut random);
            let m = read(&other, &path);
            let what = format!("{} {names:?}", path.display());
            assert_same(&what, &results(&m, &names), &values);
            if i % 3 == 0 {
                assert_same(&what, &verdict(&m), &judged);
            }
        }
    }
}
