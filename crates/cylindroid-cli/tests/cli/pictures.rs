//! Pictures: what is drawn has the numbers of the reports, in the plane and in space.

use std::fs;

use serde_json::Value;

use crate::{json, numbers, refused, text};

type Point = [f64; 2];

/// A curve with its colour, stroke width and points: in the units of the axes of its panel, where
/// these have ticks, otherwise in hundredths of a pixel.
#[derive(Debug)]
struct Curve {
    colour: String,
    width: u32,
    points: Vec<Point>,
}

struct Picture {
    svg: String,
    curves: Vec<Curve>,
    /// Centres of circles with radius and fill.
    circles: Vec<(Point, u32, String)>,
}

fn attribute<'a>(line: &'a str, name: &str) -> &'a str {
    let start = format!(" {name}=\"");
    line.split_once(&start).unwrap().1.split_once('"').unwrap().0
}

/// The line through the first and the last tick: value = slope * position + offset.
fn line_through(ticks: &[(f64, f64)]) -> Option<(f64, f64)> {
    let ((p, a), (q, b)) = (*ticks.first()?, *ticks.last()?);
    let slope = (b - a) / (q - p);
    (ticks.len() > 1).then_some((slope, a - slope * p))
}

impl Picture {
    fn read(svg: String) -> Self {
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        let (mut curves, mut circles) = (Vec::new(), Vec::new());
        let mut ticks: [Vec<(f64, f64)>; 2] = [Vec::new(), Vec::new()];
        let lines: Vec<&str> = svg.lines().collect();
        for (i, line) in lines.iter().enumerate() {
            let number = |name: &str| attribute(line, name).parse::<f64>().unwrap();
            if line.starts_with("<text") {
                let value = lines[i + 1].parse::<f64>().ok();
                if line.contains("rotate(") {
                    ticks = [Vec::new(), Vec::new()]; // the name of an axis: a new panel
                } else if let (Some(value), true) = (value, line.contains("0.76em")) {
                    ticks[0].push((number("x"), value));
                } else if let (Some(value), "end") = (value, attribute(line, "text-anchor")) {
                    ticks[1].push((number("y"), value));
                }
            } else if line.starts_with("<polyline") {
                let axes = [line_through(&ticks[0]), line_through(&ticks[1])];
                let point = |pair: &str| {
                    let (x, y) = pair.split_once(',').unwrap();
                    let xy = [x, y].map(|x| x.parse::<f64>().unwrap());
                    match axes {
                        [Some((a, b)), Some((c, d))] => [a * xy[0] + b, c * xy[1] + d],
                        _ => xy,
                    }
                };
                curves.push(Curve {
                    colour: attribute(line, "stroke").to_owned(),
                    width: number("stroke-width") as u32,
                    points: attribute(line, "points").split_whitespace().map(point).collect(),
                });
            } else if line.starts_with("<circle") {
                let fill = attribute(line, "fill").to_owned();
                circles.push(([number("cx"), number("cy")], number("r") as u32, fill));
            }
        }
        Self { svg, curves, circles }
    }

    /// The solid ellipses of a colour.
    fn ellipses(&self, colour: &str) -> Vec<&Curve> {
        let all = self.curves.iter();
        all.filter(|c| c.colour == colour && c.width == 300 && c.points.len() > 300).collect()
    }

    /// The scale that the legend gives for ellipses, in a unit per metre.
    fn scale(&self, unit: &str) -> f64 {
        let end = format!("\u{a0}{unit}\u{a0}per\u{a0}m");
        let line = self.svg.lines().find(|l| l.contains(&end)).unwrap();
        line.split_once(&end).unwrap().0.rsplit('\u{a0}').next().unwrap().parse().unwrap()
    }
}

/// Runs `manipulability` with a plot: the picture and the report.
fn drawn(arguments: &[&str]) -> (Picture, Value) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("e.svg");
    let all = [&["manipulability"], arguments, &["--plot", file.to_str().unwrap()]].concat();
    let report = json(&all, 0);
    (Picture::read(fs::read_to_string(&file).unwrap()), report)
}

/// The centre of an ellipse, and A A^T of its semi-axes A, from points at equal steps of its
/// parameter.
fn moments(curve: &Curve) -> (Point, [f64; 3]) {
    let points = &curve.points[..curve.points.len() - 1];
    let n = points.len() as f64;
    let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let square = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| {
        2.0 * points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>() / n
    });
    (mean, square)
}

fn squares(shape: &Value) -> [f64; 3] {
    let axes: Vec<Vec<f64>> = shape["semi_axes"].as_array().unwrap().iter().map(numbers).collect();
    [(0, 0), (0, 1), (1, 1)].map(|(i, j)| axes.iter().map(|a| a[i] * a[j]).sum())
}

/// Every ellipse of the figure has the semi-axes and directions of the report, at the reference
/// point; in axes of its own, at zero.
#[track_caller]
fn check(arguments: &[&str], reference: Option<[f64; 3]>) -> Value {
    let (picture, report) = drawn(arguments);
    let planes = report["drawn"]["planes"].as_array().unwrap();
    for (quantity, colour, unit) in
        [("velocity", "#1F77B4", "m/s"), ("force_exerted", "#D65F00", "N")]
    {
        let shapes: Vec<&Value> = planes
            .iter()
            .filter(|p| p[quantity]["semi_axes"].as_array().unwrap().len() == 2)
            .collect();
        let curves = picture.ellipses(colour);
        assert_eq!(curves.len(), shapes.len(), "{quantity} of {arguments:?}");
        let scale = if reference.is_some() { picture.scale(unit) } else { 1.0 };
        for (curve, plane) in curves.into_iter().zip(shapes) {
            let (centre, square) = moments(curve);
            let expected = squares(&plane[quantity]);
            let size = expected[0].max(expected[2]);
            for (got, expected) in square.iter().zip(expected) {
                let got = got * scale * scale;
                assert!((got - expected).abs() < 2e-3 * size, "{arguments:?}: {got}, {expected}");
            }
            for (i, name) in plane["components"].as_array().unwrap().iter().enumerate() {
                let axis = ["x", "y", "z"].iter().position(|a| name == a);
                let expected = reference.zip(axis).map_or(0.0, |(r, axis)| r[axis]);
                let near = 2e-3 * (square[0].max(square[2])).sqrt() + 1e-3;
                assert!((centre[i] - expected).abs() < near, "{arguments:?}: {centre:?}");
            }
        }
    }
    report
}

#[test]
fn ellipses_have_the_numbers_of_the_report_in_the_plane() {
    for view in ["projection", "section"] {
        for actuated in ["q1,q2", "q2,q4", "q1,q2,q3"] {
            let arguments = ["five-bar", "--actuated", actuated, "--view", view];
            check(&arguments, Some([1.0, 2.0, 0.0]));
        }
    }
    let (picture, report) = drawn(&["five-bar", "--actuated", "q2,q4"]);
    let size = |shape: &Value| numbers(&shape["semi_axes"][0]).iter().map(|x| x * x).sum::<f64>();
    let plane = &report["drawn"]["planes"][0];
    assert!((size(&plane["velocity"]).sqrt() - 1.175391).abs() < 1e-6);
    assert!(picture.svg.contains("semi-axes 1.18 and 0.425 m/s"), "{}", picture.svg);
    assert!(picture.svg.contains("projection: rz free") && !picture.svg.contains("zero"));
    assert!(picture.svg.contains("q3") && !picture.svg.contains("within the limits"));
    let (picture, _) = drawn(&["five-bar", "--view", "section"]);
    assert!(picture.svg.contains("section: rz zero"));
    assert!(picture.svg.contains("within the limits of the joint torques"));
    // The whole task is the table: roots of its efficiencies.
    let report = check(&["five-bar", "--task", "x,y"], Some([1.0, 2.0, 0.0]));
    let task = numbers(&report["kinematic"]["finite"]);
    let plane = &report["drawn"]["planes"][0];
    let drawn = plane["velocity"]["semi_axes"].as_array().unwrap();
    for (axis, efficiency) in drawn.iter().zip(task) {
        let square: f64 = numbers(axis).iter().map(|x| x * x).sum();
        assert!((square / efficiency - 1.0).abs() < 1e-12);
    }
}

#[test]
fn ellipses_have_the_numbers_of_the_report_in_space() {
    for view in ["projection", "section"] {
        check(&["stewart", "--view", view], Some([0.0, 0.0, 1.0]));
        check(&["panda", "--task", "rx,ry,rz", "--view", view], None);
    }
    check(&["panda", "--task", "x,rz"], None);
    check(&["five-bar", "--task", "x,y,rz", "--metric", "length"], None);
    let report = check(&["panda", "--task", "x,z"], Some(at_of("panda")));
    assert_eq!(report["drawn"]["planes"][0]["components"], serde_json::json!(["x", "z"]));
}

fn at_of(model: &str) -> [f64; 3] {
    let pose = json(&["fk", model], 0);
    let position = pose["position"].as_array().or_else(|| pose["pose"]["position"].as_array());
    let position = position.unwrap();
    [0, 1, 2].map(|i| position[i].as_f64().unwrap())
}

/// A direction without bound is a strip between two lines, as wide as the report says.
#[test]
fn unbounded_directions_are_strips() {
    let (picture, report) = drawn(&["five-bar", "--actuated", "q1"]);
    let velocity = &report["drawn"]["planes"][0]["velocity"];
    assert!(numbers(&velocity["unbounded"][0])[0].abs() < 1e-12);
    let half = numbers(&velocity["semi_axes"][0])[0].abs() / picture.scale("m/s");
    let sides: Vec<f64> = picture
        .curves
        .iter()
        .filter(|c| c.colour == "#BE232D" && c.width == 200 && c.points[0][0] < 1e3)
        .map(|c| c.points[0][0])
        .filter(|x| (x - 1.0).abs() < 2.0 * half)
        .collect();
    assert_eq!(sides.len(), 2, "{sides:?}");
    for (side, expected) in sides.iter().zip([1.0 + half, 1.0 - half]) {
        assert!((side - expected).abs() < 1e-3, "{sides:?}");
    }
    assert!(picture.svg.contains("not controlled by the actuators"));
    // Stretched out: a line of velocities, and forces that need no torque.
    let (line, _) = drawn(&["3r", "--q", "0,0,0"]);
    assert!(line.svg.contains("nothing across") && line.svg.contains("without torque"));
}

/// Exerted and resisted forces are told apart, also where they coincide.
#[test]
fn exerted_and_resisted_forces_are_told_apart() {
    let (alike, _) = drawn(&["stewart"]);
    assert!(alike.svg.contains("exerted and resisted alike"));
    assert!(!alike.svg.contains("#008C69"), "nothing is resisted beyond");
    let (apart, report) = drawn(&["five-bar", "--view", "section"]);
    assert!(apart.svg.contains("resisted with the same torques and structural support"));
    assert!(apart.curves.iter().any(|c| c.colour == "#008C69"));
    let plane = &report["drawn"]["planes"][0];
    assert_ne!(plane["force_exerted"], plane["force_resisted"]);
}

#[test]
fn drawn_for_all_kinds() {
    for model in ["panda", "stewart", "delta", "two-arm", "four-bar", "watt", "3rrr", "youbot"] {
        for view in ["projection", "section"] {
            let (picture, _) = drawn(&[model, "--view", view]);
            assert_eq!(picture.svg.contains("held object"), model == "two-arm");
        }
    }
    let table = text(&["manipulability", "five-bar"]);
    assert!(!table.contains("drawn"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("e.svg");
    let path = path.to_str().unwrap();
    let table = text(&["manipulability", "five-bar", "--plot", path]);
    assert!(table.contains("drawn, projection") && table.contains("not the roots"), "{table}");
    let table = text(&["manipulability", "five-bar", "--task", "x,y", "--plot", path]);
    assert!(table.contains("The semi-axes are the roots of the efficiencies."), "{table}");
    assert!(refused(&["manipulability", "five-bar", "--plot", "e.png"]).contains(".svg"));
    let one = refused(&["manipulability", "five-bar", "--task", "x", "--plot", path]);
    assert!(one.contains("two or three components"), "{one}");
    assert!(refused(&["manipulability", "five-bar", "--view", "section"]).contains("--plot"));
}

/// The conics of a three-system: along each the pitch is the same; two lines and two points are
/// those of the principal pitches; axes of the file lie on the lines of pitch zero.
#[test]
fn conics_of_a_three_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, plot) = (path("axes.csv"), path("axes.svg"));
    fs::write(&csv, "0,0,0,0,0,1\n0,0,-0.2,1,0,0\n0.1,0,0,0,1,0\n").unwrap();
    let report = json(&["screws", &csv, "--length", "0.5", "--plot", &plot], 0);
    let pitches = numbers(&report["principal_pitches"]);
    let picture = Picture::read(fs::read_to_string(&plot).unwrap());
    let corners: Vec<Point> =
        picture.circles.iter().filter(|c| c.1 == 300 && c.2 == "#000000").map(|c| c.0).collect();
    // The last is that of the legend.
    let [a, b, c, _] = corners[..] else { panic!("{corners:?}") };
    // Barycentric coordinates are homogeneous ones of the principal screws.
    let area = |p: Point, q: Point, r: Point| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let pitch = |p: Point| {
        let x = [area(p, b, c), area(a, p, c), area(a, b, p)];
        let square: f64 = x.iter().map(|x| x * x).sum();
        x.iter().zip(&pitches).map(|(x, h)| h * x * x).sum::<f64>() / square
    };
    let plane = |c: &&Curve| c.points.iter().all(|p| p[1] > 67_000.0) && c.points.len() > 50;
    let raw = raw_curves(&picture.svg);
    let (mut lines, mut regular) = (0, 0);
    for curve in raw.iter().filter(plane) {
        let all: Vec<f64> = curve.points.iter().map(|p| pitch(*p)).collect();
        let (low, high) = all.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
        assert!(high - low < 1e-3 * 0.2, "{low} to {high}");
        match curve.width {
            300 => {
                assert!(low.abs() < 1e-4 && high.abs() < 1e-4, "{low} to {high}");
                lines += 1;
            }
            _ => regular += 1,
        }
    }
    assert!(lines >= 2 && regular > 8, "{lines} lines, {regular} conics");
    for circle in picture.circles.iter().filter(|c| c.1 == 400 && c.2 == "#008C69") {
        if circle.0[1] > 68_000.0 {
            assert!(pitch(circle.0).abs() < 1e-3, "{circle:?}");
        }
    }
    for h in ["h = 0.111803", "h = 0\n", "h = -0.111803"] {
        assert!(picture.svg.contains(h), "{h:?}");
    }
    // One system of every other kind.
    for twists in
        ["1,0,0,0,0,0\n0,1,0,0,0,0\n0,0,1,0,0,0\n", "0,0,0,1,0,0\n0,0,0,0,1,0\n0,0,0,0,0,1\n"]
    {
        fs::write(&csv, twists).unwrap();
        text(&["screws", &csv, "--plot", &plot]);
        assert!(fs::read_to_string(&plot).unwrap().contains("one pitch"));
    }
}

/// Curves in hundredths of a pixel.
fn raw_curves(svg: &str) -> Vec<Curve> {
    let lines = svg.lines().filter(|l| l.starts_with("<polyline"));
    let text: String = lines.map(|l| format!("{l}\n")).collect();
    Picture::read(format!("<svg>\n{text}</svg>")).curves
}

/// Rounding is not written: a best pitch at zero is zero, a centre at zero is zero.
#[test]
fn no_rounding_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("s.svg");
    let plot = plot.to_str().unwrap();
    for model in ["3r", "youbot", "ur5e", "panda", "delta", "puma560"] {
        let table = text(&["screws", model, "--plot", plot]);
        let svg = fs::read_to_string(plot).unwrap();
        for part in svg.split("h = ").skip(1).chain(table.split("h = ").skip(1)) {
            let word = part.split_whitespace().next().unwrap();
            assert!(!word.contains("e-"), "{model}: h = {word}");
        }
        assert!(!table.contains("leans"));
    }
}
