//! Designs: the rows are those of each design, whatever the parts; the isotropic five-bars are found.

use std::f64::consts::SQRT_2;
use std::fs;
use std::path::Path;

use cylindroid::sweep::{
    Axis, DesignSpace, ParameterRange, Quantity, Source, Sweep, SweepOptions, Table, Values,
    WriteOptions,
};
use cylindroid::{Error, ParametricModel, Result};

use crate::bits;

pub(crate) const ARM: &str = r#"
dimension = 2
reference = "hand"
reference_point = ["a + b", 0]

[parameters]
a = { value = 0.5, lower = 0.1, upper = 1.0, unit = "m" }
b = "0.8 * a"
reach = { value = "a + b", upper = 1.5 }

[[joint]]
name = "shoulder"
type = "revolute"
between = ["ground", "arm"]
origin = [0, 0]
limits = { lower = "-a", upper = 1 }

[[joint]]
name = "elbow"
type = "revolute"
between = ["arm", "hand"]
origin = ["a", 0]
"#;

fn arm() -> ParametricModel {
    ParametricModel::of_text(ARM, Path::new("arm.toml"), &[]).unwrap()
}

pub(crate) fn five_bar() -> ParametricModel {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/designs.toml");
    ParametricModel::read(path.to_str().unwrap(), &[]).unwrap()
}

pub(crate) fn axis(name: &str, from: f64, to: f64, count: u64) -> Axis {
    Axis { name: name.to_owned(), from, to, count }
}

fn grid(axes: &[Axis]) -> DesignSpace {
    DesignSpace::Grid(axes.to_vec())
}

fn options(source: Source, quantities: &[Quantity]) -> SweepOptions {
    SweepOptions { source, quantities: quantities.to_vec(), part_rows: 7, ..Default::default() }
}

fn counts<'a>(table: &'a Table, name: &str) -> &'a [u64] {
    match table.column(name) {
        Some(Values::Counts(counts)) => counts,
        other => panic!("{name}: {other:?}"),
    }
}

/// The rows of a design are those of a sweep of the mechanism with its values.
#[test]
fn rows_are_those_of_each_design() {
    const EACH: u64 = 10;
    let quantities = [Quantity::Pose, Quantity::Condition, Quantity::LimitDistance];
    for source in [
        Source::Samples { count: EACH, seed: 3 },
        Source::Grid { axes: vec![axis("elbow", 0.0, 1.0, EACH)], rest: Vec::new() },
        Source::Configurations((0..2 * EACH).map(|i| 0.1 * i as f64).collect()),
    ] {
        let spaces = [
            grid(&[axis("a", 0.2, 0.8, 3), axis("b", 0.3, 0.4, 2)]),
            DesignSpace::Samples {
                ranges: ["a", "b"]
                    .map(|name| ParameterRange { name: name.to_owned(), from: 0.2, to: 0.6 })
                    .to_vec(),
                count: 6,
                seed: 1,
            },
        ];
        for space in spaces {
            let sweep =
                Sweep::of_designs(&arm(), space, options(source.clone(), &quantities)).unwrap();
            assert_eq!((sweep.rows(), sweep.designs()), (6 * EACH, Some(6)));
            let names: Vec<&str> = sweep.columns().iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names[..6], ["index", "design", "design_valid", "a", "b", "shoulder"]);
            assert_eq!((&*sweep.columns()[3].unit, &*sweep.columns()[4].unit), ("m", ""));
            let whole = sweep.table(0..sweep.rows()).unwrap();
            assert_eq!(counts(&whole, "index"), (0..6 * EACH).collect::<Vec<_>>());
            for design in 0..6 {
                let rows = design * EACH..(design + 1) * EACH;
                let table = sweep.table(rows).unwrap();
                let value = |name: &str| table.numbers(name).unwrap()[0];
                assert!(counts(&table, "design").iter().all(|d| *d == design));
                assert!(counts(&table, "design_valid").iter().all(|valid| *valid == 1));
                let own = arm().with(&[("a", value("a")), ("b", value("b"))]).unwrap();
                let single = Sweep::new(&own, options(source.clone(), &quantities)).unwrap();
                let single = single.table(0..EACH).unwrap();
                assert_eq!(bits(&table)[5..], bits(&single)[1..]);
            }
            // Rows across designs.
            let part = bits(&sweep.table(7..43).unwrap());
            let same: Vec<Vec<u64>> = bits(&whole).iter().map(|c| c[7..43].to_vec()).collect();
            assert_eq!(part, same);
        }
    }
}

/// The condition of the five-bar's Jacobian from its constraints: each rod keeps its length, so
/// rod . velocity = (crank turned by a quarter . rod) q'.
fn condition(table: &Table, row: usize) -> f64 {
    let [crank, rod, base, x, y] = ["crank", "rod", "base", "point_x", "point_y"]
        .map(|name| table.numbers(name).unwrap()[row]);
    let inverse = [-1.0, 1.0].map(|side| {
        let (dx, dy) = (x - side * base, y);
        let d = dx.hypot(dy);
        let along = (crank * crank - rod * rod + d * d) / (2.0 * d);
        let across = (crank * crank - along * along).sqrt() * side;
        let elbow = [(along * dx + across * dy) / d, (along * dy - across * dx) / d];
        let rod = [dx - elbow[0], dy - elbow[1]];
        let rate = rod[1] * elbow[0] - rod[0] * elbow[1];
        [rod[0] / rate, rod[1] / rate]
    });
    let [[a, b], [c, d]] = inverse;
    let (sum, determinant) = (a * a + b * b + c * c + d * d, (a * d - b * c).abs());
    let larger = (sum + 2.0 * determinant).sqrt() + (sum - 2.0 * determinant).max(0.0).sqrt();
    larger * larger / (4.0 * determinant)
}

/// Isotropic are the designs whose rods are perpendicular and whose cranks reach the points from
/// which they leave: (rod / sqrt 2 - base)^2 + (y - rod / sqrt 2)^2 = crank^2 for x = 0.
#[test]
fn isotropic_five_bars_are_found() {
    let measures = options(Source::Home, &[Quantity::Pose, Quantity::Measures]);
    for (rod, base, y) in [(0.6, 0.3, 0.8), (0.5 * SQRT_2, 0.5, 1.1), (0.9, 0.2, 1.2)] {
        let half = rod / SQRT_2;
        let crank = (half - base).hypot(y - half);
        let fixed =
            [axis("rod", rod, rod, 1), axis("base", base, base, 1), axis("point_y", y, y, 1)];
        let varied = [axis("crank", 0.9 * crank, 1.1 * crank, 41), axis("point_x", -0.05, 0.05, 5)];
        let space = grid(&[&fixed[..], &varied].concat());
        let sweep = Sweep::of_designs(&five_bar(), space, measures.clone()).unwrap();
        let table = sweep.table(0..sweep.rows()).unwrap();
        let anisotropy = table.numbers("anisotropy").unwrap();
        assert!(counts(&table, "design_valid").iter().all(|valid| *valid == 1));
        let mut best = 0;
        for row in 0..table.rows() {
            // Of efficiencies, which are squares of singular values.
            let expected = condition(&table, row).powi(2);
            let difference = (anisotropy[row] - expected).abs();
            // Equal singular values are the roots of a double one: half of the digits.
            let tolerance = if expected < 1.0 + 1e-6 { 1e-7 } else { 1e-9 * expected };
            assert!(difference < tolerance, "{row}: {} for {expected}", anisotropy[row]);
            if anisotropy[row] < anisotropy[best] {
                best = row;
            }
        }
        let of = |name: &str| table.numbers(name).unwrap()[best];
        assert!((of("crank") - crank).abs() < 1e-12 && of("point_x").abs() < 1e-12);
        assert!((anisotropy[best] - 1.0).abs() < 1e-7, "{}", anisotropy[best]);
        assert!((of("y") - y).abs() < 1e-12 && counts(&table, "dof")[best] == 2);
    }
}

/// Three slides along a cone about z, whose rods make the angle `bend` with them, and a platform that
/// does not turn: an Orthoglide where rods and slides are perpendicular to one another.
pub(crate) fn orthoglide() -> ParametricModel {
    let mut text = String::from(
        "reference = 'platform'\nreference_point = [0, 0, 0]\n[parameters]\n\
         cone = { value = 0.9, lower = 0.1, upper = 1.5, unit = 'rad' }\n\
         bend = { value = 0.1, lower = -0.5, upper = 0.5, unit = 'rad' }\nrod = 'cone + bend'\n",
    );
    for i in 0..3 {
        text += &format!("c{i} = 'cos({i} * 2 * pi / 3)'\ns{i} = 'sin({i} * 2 * pi / 3)'\n");
    }
    let mut joint = |name: String, kind: &str, between: [String; 2], more: &str| {
        let [a, b] = between;
        text += &format!("[[joint]]\nname = '{name}'\ntype = '{kind}'\n");
        text += &format!("between = ['{a}', '{b}']\n{more}\n");
    };
    for i in 0..3 {
        let link = |name: &str| format!("{name}{i}");
        let slide = format!("['sin(cone) * c{i}', 'sin(cone) * s{i}', 'cos(cone)']");
        let end = format!("['-sin(rod) * c{i}', '-sin(rod) * s{i}', '-cos(rod)']");
        let more = format!("origin = {end}\naxis = {slide}\nactuated = true");
        joint(link("drive"), "prismatic", ["ground".to_owned(), link("slide")], &more);
        let (across, third) = (
            format!("['-s{i}', 'c{i}', 0]"),
            format!("['cos(rod) * c{i}', 'cos(rod) * s{i}', '-sin(rod)']"),
        );
        let more = format!("origin = {end}\naxis = {across}\naxis2 = {third}");
        joint(link("cardan"), "universal", [link("slide"), link("rod")], &more);
        let between = [link("rod"), "platform".to_owned()];
        joint(link("ball"), "spherical", between, "origin = [0, 0, 0]");
    }
    let axes = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"];
    let links = ["ground", "along_x", "along_xy", "platform"].map(str::to_owned);
    for (i, axis) in axes.iter().enumerate() {
        let between = [links[i].clone(), links[i + 1].clone()];
        let more = format!("origin = [0, 0, 0]\naxis = {axis}");
        joint(format!("guide{i}"), "prismatic", between, &more);
    }
    ParametricModel::of_text(&text, Path::new("orthoglide.toml"), &[]).unwrap()
}

/// Rods w and slides d: w . v = (w . d) q', so the Jacobian is isotropic where the rods are
/// perpendicular, and one metre of a slide is one metre of the platform where they lie along the
/// slides (Wenger & Chablat 2000).
#[test]
fn the_isotropic_orthoglide_is_found() {
    let right = (1.0 / 3.0_f64.sqrt()).acos();
    let axes = [axis("cone", right - 0.3, right + 0.3, 13), axis("bend", -0.2, 0.2, 9)];
    let measures = options(Source::Home, &[Quantity::Measures]);
    let sweep = Sweep::of_designs(&orthoglide(), grid(&axes), measures).unwrap();
    let table = sweep.table(0..sweep.rows()).unwrap();
    let of = |name: &str| table.numbers(name).unwrap();
    let [cone, bend, anisotropy, largest, smallest] =
        ["cone", "bend", "anisotropy", "largest", "smallest"].map(of);
    let mut isotropic = 0;
    for i in 0..table.rows() {
        let rod = cone[i] + bend[i];
        let values = [3.0 * rod.cos().powi(2), 1.5 * rod.sin().powi(2)];
        let expected = values[0].max(values[1]) / values[0].min(values[1]);
        let found = (counts(&table, "design_valid")[i], counts(&table, "dof")[i]);
        assert_eq!(found, (1, 3), "{i}");
        assert!((anisotropy[i] / expected - 1.0).abs() < 1e-9, "{i}: {}", anisotropy[i]);
        if anisotropy[i] < 1.0 + 1e-9 {
            isotropic += 1;
            let factor = bend[i].cos().powi(2);
            assert!((rod - right).abs() < 1e-9 && (largest[i] - factor).abs() < 1e-9);
        }
    }
    // The bends of the grid that a cone of the grid makes up for; with unit factor one of them.
    assert_eq!(isotropic, 9);
    let unit = |i: &usize| (largest[*i] - 1.0).abs() < 1e-9 && (smallest[*i] - 1.0).abs() < 1e-9;
    let found: Vec<usize> = (0..table.rows()).filter(unit).collect();
    assert_eq!(found.len(), 1);
    assert!((cone[found[0]] - right).abs() < 1e-12 && bend[found[0]].abs() < 1e-12);
}

#[test]
fn designs_without_a_mechanism_have_no_numbers() {
    let source = Source::Samples { count: 2, seed: 0 };
    let quantities = [Quantity::Pose, Quantity::GibsonHunt];
    let space = grid(&[axis("a", 0.7, 0.9, 3)]);
    let sweep = Sweep::of_designs(&arm(), space, options(source, &quantities)).unwrap();
    let table = sweep.table(0..6).unwrap();
    // reach = 1.8 a is at most 1.5.
    assert_eq!(counts(&table, "design_valid"), [1, 1, 1, 1, 0, 0]);
    let x = table.numbers("x").unwrap();
    assert!(x[..4].iter().all(|x| x.is_finite()) && x[4..].iter().all(|x| x.is_nan()));
    assert_eq!(table.numbers("a").unwrap(), [0.7, 0.7, 0.8, 0.8, 0.9, 0.9]);
    // Rods too short to meet.
    let space = grid(&[axis("rod", 0.05, 0.65, 5)]);
    let home = options(Source::Home, &[Quantity::Measures]);
    let sweep = Sweep::of_designs(&five_bar(), space, home).unwrap();
    let table = sweep.table(0..5).unwrap();
    let valid = counts(&table, "design_valid");
    assert_eq!((valid[0], valid[4]), (0, 1));
    for (i, valid) in valid.iter().enumerate() {
        let model = five_bar().with(&[("rod", table.numbers("rod").unwrap()[i])]);
        assert_eq!(model.is_ok(), *valid == 1);
        assert_eq!(table.numbers("anisotropy").unwrap()[i].is_nan(), *valid == 0);
    }
}

#[test]
fn folders_of_designs_are_resumed() {
    let space = || grid(&[axis("a", 0.2, 0.9, 9)]);
    let source = || Source::Samples { count: 5, seed: 0 };
    let quantities = [Quantity::Pose, Quantity::Yoshikawa];
    let sweep = Sweep::of_designs(&arm(), space(), options(source(), &quantities)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let contents = |name: &str| {
        let file = |i: usize| folder.path().join(name).join(format!("part-{i:06}.parquet"));
        (0..7).map(|i| fs::read(file(i)).unwrap()).collect::<Vec<_>>()
    };
    for (name, threads) in [("one", 1), ("eight", 8)] {
        let own = WriteOptions { threads: threads.try_into().ok(), resume: false };
        let summary = sweep.write(&folder.path().join(name), &own, |_| true).unwrap();
        assert_eq!((summary.rows, summary.parts, summary.complete), (45, 7, true));
    }
    assert!(contents("one") == contents("eight"));
    let whole = contents("one");
    fs::remove_file(folder.path().join("one/part-000003.parquet")).unwrap();
    let resume = WriteOptions { threads: None, resume: true };
    let again = sweep.write(&folder.path().join("one"), &resume, |_| true).unwrap();
    assert_eq!(again.computed, 7);
    assert!(contents("one") == whole);

    // A file with other numbers, other values and other designs are other recipes.
    let refused = |model: &ParametricModel, space: DesignSpace| {
        let sweep = Sweep::of_designs(model, space, options(source(), &quantities)).unwrap();
        let found = sweep.write(&folder.path().join("one"), &resume, |_| true);
        found.unwrap_err().to_string()
    };
    let text = ARM.replace("upper = 1 }", "upper = 2 }");
    let other = ParametricModel::of_text(&text, Path::new("arm.toml"), &[]).unwrap();
    let message = refused(&other, space());
    assert!(message.contains("file_checksum") || message.contains("model_checksum"), "{message}");
    let message = refused(&arm(), grid(&[axis("a", 0.2, 0.8, 9)]));
    assert!(message.contains("designs.space"), "{message}");
    // A plain sweep of the same mechanism too.
    let plain = Sweep::new(arm().nominal(), options(source(), &quantities)).unwrap();
    let message = plain.write(&folder.path().join("one"), &resume, |_| true).unwrap_err();
    assert!(message.to_string().contains("another recipe"), "{message}");
}

#[test]
fn wrong_designs_are_refused() {
    let of = |space: DesignSpace| -> Result<Sweep> {
        let source = Source::Samples { count: 5, seed: 0 };
        Sweep::of_designs(&arm(), space, options(source, &[Quantity::Pose]))
    };
    let refused = |axes: &[Axis]| of(grid(axes)).unwrap_err().to_string();
    assert!(refused(&[]).contains("one parameter at least"));
    assert!(refused(&[axis("aa", 0.2, 0.3, 2)]).contains("no parameter named 'aa'; nearest: a"));
    let twice = [axis("a", 0.2, 0.3, 2), axis("a", 0.2, 0.3, 2)];
    assert!(refused(&twice).contains("only once"));
    assert!(refused(&[axis("a", 0.2, 1.3, 2)]).contains("its range is 0.1 to 1"));
    assert!(refused(&[axis("a", 0.2, f64::NAN, 2)]).contains("is not finite"));
    assert!(refused(&[axis("a", 0.2, 0.3, 0)]).contains("one value at least"));
    let samples = |count| DesignSpace::Samples {
        ranges: vec![ParameterRange { name: "a".to_owned(), from: 0.2, to: 0.3 }],
        count,
        seed: 0,
    };
    assert!(of(samples(0)).unwrap_err().to_string().contains("1 to 2^32"));
    assert!(of(samples(1)).is_ok());
    // A name of both a coordinate and a parameter.
    let text = ARM.replace("\"elbow\"", "\"a\"");
    let both = ParametricModel::of_text(&text, Path::new("arm.toml"), &[]).unwrap();
    let source = Source::Samples { count: 5, seed: 0 };
    let space = grid(&[axis("a", 0.2, 0.3, 2)]);
    let error = Sweep::of_designs(&both, space, options(source, &[])).unwrap_err();
    assert!(matches!(error, Error::InvalidOption { option: "over", .. }), "{error}");
}
