//! The gallery of linkages: a row for each file of the test data, with its published and its
//! computed verdict, and a drawing. `cargo xtask book --outputs` writes both.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use cylindroid::closure::{Diagnosis, LocalStructure, SingularityKind, Verdict};
use cylindroid::model::Dimension;
use cylindroid::{Mechanism, Pose, Vec3};
use serde_json::Value;

use super::{ROOT, WRITE};

const PAGE: &str = "docs/guide/linkages.md";
const FILES: &str = "crates/cylindroid/tests/data/linkages";
const HEAD: &str = "| | linkage | source | degrees of freedom | verdict |\n|---|---|---|---|---|\n";
/// Width, height and margin of a drawing [px].
const SIZE: [f64; 3] = [96.0, 72.0, 6.0];

#[test]
fn the_gallery_shows_what_is_published_and_computed() {
    let root = Path::new(ROOT).canonicalize().unwrap();
    let expected = fs::read_to_string(root.join(FILES).join("expected.json")).unwrap();
    let expected: Value = serde_json::from_str(&expected).unwrap();
    let mut table = HEAD.to_owned();
    let mut cases: Vec<(&String, &Value)> = expected["cases"].as_object().unwrap().iter().collect();
    cases.sort_by_key(|(name, _)| *name);
    for (name, case) in cases {
        let path = root.join(FILES).join(format!("{name}.toml"));
        let text = fs::read_to_string(&path).unwrap();
        let m = cylindroid::model::formats::toml::parse(&text, &path).unwrap();
        let found = Diagnosis::of(&m.state(m.home()).unwrap(), None, None).unwrap();
        let verdict = &found.verdict;
        let [dof, finite] = ["dof", "finite_dof"].map(|key| case[key].as_u64().unwrap());
        let second = found.finite.second_order.as_ref();
        assert_eq!(
            (verdict.dof() as u64, verdict.finite_dof()),
            (dof, Some(finite as usize)),
            "{name}"
        );
        let dof = if dof == finite {
            dof.to_string()
        } else {
            format!("{finite} ({dof} to first order)")
        };
        let words = in_words(verdict, second.map(|s| s.rigidity.name()));
        let source = case["source"].as_str().unwrap();
        writeln!(
            table,
            "| ![{name}](../figures/linkages/{name}.svg) | [{name}](../../{FILES}/{name}.toml) | \
             {source} | {dof} | {words} |"
        )
        .unwrap();
        let picture: PathBuf = root.join(format!("docs/figures/linkages/{name}.svg"));
        if std::env::var_os(WRITE).is_some() {
            fs::create_dir_all(picture.parent().unwrap()).unwrap();
            fs::write(&picture, drawing(&m)).unwrap();
        }
        assert!(picture.exists(), "{} is missing", picture.display());
    }
    let page = fs::read_to_string(root.join(PAGE)).unwrap();
    let before = page.find(HEAD).unwrap();
    let end = page[before..].find("\n\n").map_or(page.len(), |end| before + end + 1);
    if std::env::var_os(WRITE).is_some() {
        let page = format!("{}{table}{}", &page[..before], &page[end..]);
        fs::write(root.join(PAGE), page).unwrap();
    } else {
        assert_eq!(&page[before..end], table, "'cargo xtask book --outputs' writes the table");
    }
}

fn in_words(verdict: &Verdict, second_order: Option<&str>) -> String {
    let kind = |kind: &SingularityKind| match kind {
        SingularityKind::TypeI => "type I",
        SingularityKind::TypeII => "type II",
        SingularityKind::TypeIII => "type III",
        SingularityKind::ConfigurationSpace => "configuration space",
        SingularityKind::Passive => "passive",
        _ => "other",
    };
    let kinds: Vec<&str> = verdict.kinds().iter().map(kind).collect();
    let mut words = match verdict.structure() {
        LocalStructure::Rigid => "rigid".to_owned(),
        _ if kinds.is_empty() => "regular".to_owned(),
        _ => kinds.join(", "),
    };
    if !verdict.everywhere().is_empty() {
        words += " (architecture singularity)";
    }
    if verdict.structure().is_singular() {
        write!(words, ": {}", verdict.structure().name()).unwrap();
        if let Some(second_order) = second_order.filter(|_| verdict.finite_dof() == Some(0)) {
            write!(words, ", {second_order}").unwrap();
        }
    }
    words
}

/// Links as polygons between their joints, without the ground; joints as points, the actuated ones
/// filled.
fn drawing(m: &Mechanism) -> String {
    let state = m.state(m.home()).unwrap();
    let poses: Vec<Pose> =
        m.links().iter().map(|link| state.pose(m.frame(&link.name).unwrap()).unwrap()).collect();
    let flat = |p: Vec3| match m.dimension() {
        Dimension::Planar => [p.x, -p.y],
        _ => [0.87 * (p.x - p.y), -0.9 * p.z + 0.42 * (p.x + p.y)],
    };
    let mut links: Vec<Vec<[f64; 2]>> = vec![Vec::new(); poses.len()];
    let mut spots = Vec::new();
    let mut ground = vec![true; poses.len()];
    for j in m.joints() {
        let a = flat((poses[j.parent] * j.parent_from_joint).translation);
        let b = flat((poses[j.child] * j.joint_from_child.inverse()).translation);
        links[j.parent].push(a);
        links[j.child].push(b);
        ground[j.child] = false;
        spots.push((a, j.actuated));
        spots.push((b, j.actuated));
    }
    for j in m.loops() {
        let a = flat((poses[j.a] * j.link_a_from_joint).translation);
        let b = flat((poses[j.b] * j.link_b_from_joint).translation);
        links[j.a].push(a);
        links[j.b].push(b);
        spots.push((a, j.actuated));
    }
    let reference = m.frame_of(m.reference());
    links[reference.link].push(flat(state.pose(m.reference()).unwrap().translation));
    let all: Vec<[f64; 2]> = links.iter().flatten().copied().collect();
    let bound = |axis: usize, most: fn(f64, f64) -> f64, start: f64| {
        all.iter().fold(start, |bound, p| most(bound, p[axis]))
    };
    let low = [bound(0, f64::min, f64::INFINITY), bound(1, f64::min, f64::INFINITY)];
    let high = [bound(0, f64::max, -f64::INFINITY), bound(1, f64::max, -f64::INFINITY)];
    let [width, height, margin] = SIZE;
    let span = [high[0] - low[0], high[1] - low[1]];
    let scale = ((width - 2.0 * margin) / span[0].max(1e-9))
        .min((height - 2.0 * margin) / span[1].max(1e-9));
    let place = |p: [f64; 2]| {
        let at = |axis: usize, size: f64| {
            0.5 * size + scale * (p[axis] - 0.5 * (low[axis] + high[axis]))
        };
        [at(0, width), at(1, height)]
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n<g fill=\"#5b7fd9\" fill-opacity=\"0.15\" \
         stroke=\"#5b7fd9\" stroke-width=\"1.5\" stroke-linejoin=\"round\">\n"
    );
    for (points, _) in links.iter().zip(&ground).filter(|(p, ground)| !**ground && p.len() > 1) {
        let points: Vec<String> = around(points)
            .iter()
            .map(|p| place(*p))
            .map(|[x, y]| format!("{x:.1},{y:.1}"))
            .collect();
        writeln!(svg, "<polygon points=\"{}\"/>", points.join(" ")).unwrap();
    }
    svg += "</g>\n";
    let mut drawn: Vec<String> = Vec::new();
    // Actuated joints first, so that passive ones at the same place do not hide them.
    spots.sort_by_key(|spot| !spot.1);
    for (spot, actuated) in spots {
        let [x, y] = place(spot);
        let at = format!("cx=\"{x:.1}\" cy=\"{y:.1}\"");
        if drawn.contains(&at) {
            continue;
        }
        let fill = if actuated { "#e0662f" } else { "#ffffff" };
        writeln!(svg, "<circle {at} r=\"2.2\" fill=\"{fill}\" stroke=\"#808080\"/>").unwrap();
        drawn.push(at);
    }
    svg + "</svg>\n"
}

/// The points of a link in the order of their directions from the centre.
fn around(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = points.len() as f64;
    let centre = [0, 1].map(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / n);
    let mut sorted = points.to_vec();
    let angle = |p: &[f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
    sorted.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    sorted
}
