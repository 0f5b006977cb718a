//! Every case of the reference set of screw systems (tests/data/screws.json): computed with exact
//! fractions where the entries are fractions, with 40 digits elsewhere, by the authors of the
//! corrected theory. Twists there are angular first; here the halves are exchanged.

use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions};
use cylindroid::linalg::Matrix;
use cylindroid::screws::{
    Class, Line, NoInverse, Screw, ScrewOptions, ScrewSystem, involution, transversals,
};
use cylindroid::spatial::{Mat3, Pose, Rotation, Twist, Vec3, Wrench};
use serde_json::Value;

use crate::support::assert_matrix;

pub(super) fn reference() -> Value {
    let text = include_str!("../../data/screws.json");
    serde_json::from_str(text).unwrap()
}

fn number(v: &Value) -> f64 {
    match v {
        Value::Number(n) => n.as_f64().unwrap(),
        Value::String(s) => match s.split_once('/') {
            Some((a, b)) => a.parse::<f64>().unwrap() / b.parse::<f64>().unwrap(),
            None => s.parse().unwrap(),
        },
        _ => panic!("not a number: {v}"),
    }
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(number).collect()
}

/// The exact entries where there are any.
fn plain(v: &Value) -> Matrix {
    let rows = v.get("exact").or_else(|| v.get("float")).unwrap_or(v);
    let rows: Vec<Vec<f64>> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|r| if r.is_array() { numbers(r) } else { vec![number(r)] })
        .collect();
    Matrix::from_rows(&rows).unwrap()
}

fn swap(i: usize) -> usize {
    (i + 3) % 6
}

/// Columns are twists (or wrenches).
pub(super) fn twists(v: &Value) -> Matrix {
    let m = plain(v);
    Matrix::from_fn(6, m.cols(), |i, j| m[(swap(i), j)])
}

/// Acts on twists, gives rates.
fn rates(v: &Value) -> Matrix {
    let m = plain(v);
    Matrix::from_fn(m.rows(), 6, |i, j| m[(i, swap(j))])
}

/// Acts on twists, gives twists.
fn operator(v: &Value) -> Matrix {
    let m = plain(v);
    Matrix::from_fn(6, 6, |i, j| m[(swap(i), swap(j))])
}

fn with_length(length: f64) -> HyperbolicOptions {
    HyperbolicOptions { scale: ScrewOptions::with_length(length), ..HyperbolicOptions::default() }
}

fn column(m: &Matrix, j: usize) -> Twist {
    Twist::from_array(m.column(j).try_into().unwrap())
}

fn scaled_tolerance(expected: &Matrix, relative: f64) -> f64 {
    relative * expected.max_abs().max(1.0)
}

#[test]
fn examples_1_and_4() {
    let data = &reference()["example1_4"];
    let j = twists(&data["J"]);
    let system = ScrewSystem::of_columns(&j, &ScrewOptions::default()).unwrap();
    assert_eq!(system.class().name(), data["class"].as_str().unwrap());
    assert!((system.normal_form().slope.unwrap() - number(&data["p"])).abs() < 1e-12);
    assert!(system.principal_pitches()[0].abs() < 1e-14);
    let s = twists(&data["s"]);
    for case in data["cases"].as_array().unwrap() {
        let h = number(&case["h"]);
        let inverse = inverse::hyperbolic(&j, h).unwrap();
        assert!(inverse.exists && inverse.reason.is_none());
        let expected = rates(&case["Jph"]);
        assert_matrix("J+h", &inverse.matrix, &expected, 1e-12);
        assert_matrix("P_h", &(&j * &inverse.matrix), &operator(&case["P_h"]), 1e-12);
        let projector = system.projector(h).unwrap();
        assert_matrix("P_h", &projector.matrix(), &operator(&case["P_h"]), 1e-12);
        let v = &inverse.matrix * &s;
        assert_matrix("v", &v, &plain(&case["v_for_s"]), 1e-12);
        let rest = column(&s, 0) - column(&(&j * &v), 0);
        assert!((rest.pitch_form(rest, h) - number(&case["Phi_half"])).abs() < 1e-12);

        let damped = inverse::hyperbolic_with(
            &j,
            h,
            &HyperbolicOptions {
                damping: HyperbolicDamping::Gram { lambda: 1.0 },
                ..HyperbolicOptions::default()
            },
        )
        .unwrap();
        let expected = rates(&case["damped_Lambda_I"]);
        assert_matrix("damped", &damped.matrix, &expected, scaled_tolerance(&expected, 1e-12));
    }
    // h = 0 is the principal pitch.
    let none = inverse::hyperbolic(&j, 0.0).unwrap();
    assert!(!none.exists && none.matrix[(0, 0)].is_nan());
    assert!(
        matches!(none.reason, Some(NoInverse::PrincipalPitch { pitch }) if pitch.abs() < 1e-12)
    );
}

/// The symbolic entries, with the corrected one of row 3 and column 2.
#[test]
fn example_1_symbolic() {
    let j = twists(&reference()["example1_4"]["J"]);
    for h in [0.3, -0.7, 2.0, 11.0] {
        let m = inverse::hyperbolic(&j, h).unwrap().matrix;
        // In the order of the paper (angular first): entries (2,2) and (3,2).
        let entry = -(16.0 * h * h + 16.0 * h + 3.0) / (32.0 * h);
        assert!((m[(1, swap(1))] - entry).abs() < 1e-12);
        let corrected = (16.0 * h * h + 16.0 * h - 1.0) / (32.0 * h);
        assert!((m[(2, swap(1))] - corrected).abs() < 1e-12);
    }
}

#[test]
fn example_2() {
    for case in reference()["example2"]["cases"].as_array().unwrap() {
        let j = twists(&case["J"]);
        let inverse = inverse::hyperbolic(&j, number(&case["h"])).unwrap();
        assert!(inverse.exists);
        assert_matrix("J+h", &inverse.matrix, &rates(&case["Jph"]), 1e-12);
        assert_matrix("P_h", &(&j * &inverse.matrix), &operator(&case["P_h"]), 1e-12);
    }
}

/// The set of rates is {rates : J rates in S}, of dimension one; the image of S under the
/// pseudoinverse, which the paper gives, is all of R^3.
#[test]
fn example_3() {
    let data = &reference()["example3"];
    let j = twists(&data["J"]);
    let (x, q) = (numbers(&data["x"]), numbers(&data["q"]));
    let vec3 = |v: &[f64]| Vec3::new(v[0], v[1], v[2]);
    let found = inverse::point_direction(&j, vec3(&x), vec3(&q)).unwrap();
    let expected = numbers(&data["correct_solution_direction"]);
    let norm = expected.iter().map(|e| e * e).sum::<f64>().sqrt();
    let set: Vec<Vec<f64>> = found
        .along
        .iter()
        .cloned()
        .chain((0..found.still.cols()).map(|c| found.still.column(c).to_vec()))
        .collect();
    assert_eq!(set.len(), data["dim_correct"].as_u64().unwrap() as usize);
    let length = set[0].iter().map(|e| e * e).sum::<f64>().sqrt();
    let cosine: f64 = set[0].iter().zip(&expected).map(|(a, b)| a * b).sum();
    assert!((cosine.abs() - length * norm).abs() < 1e-12 * length * norm);

    let s = twists(&data["S_basis"]);
    let four = ScrewSystem::of_columns(&s, &ScrewOptions::default()).unwrap();
    assert_eq!((four.order(), four.class()), (4, Class::IIA));
    let image = &inverse::hyperbolic(&j, 1.0).unwrap().matrix * &s;
    assert_eq!(cylindroid::linalg::Svd::of(&image).machine_rank().rank, 3);
}

#[test]
fn rank_deficient() {
    for case in reference()["rank_deficient"].as_array().unwrap() {
        let j = twists(&case["J"]);
        let inverse = inverse::hyperbolic(&j, number(&case["h"])).unwrap();
        assert_eq!(inverse.rank, case["rank"].as_u64().unwrap() as usize);
        let expected = rates(&case["Jph"]);
        assert_matrix("J+h", &inverse.matrix, &expected, scaled_tolerance(&expected, 1e-12));
        let plain = inverse::truncated(&j, 1e-12).unwrap().matrix;
        let equal = plain.max_difference(&expected) < 1e-9;
        assert_eq!(equal, case["equals_moore_penrose"].as_bool().unwrap());
    }
}

#[test]
fn wrench_side() {
    for case in reference()["wrench_side"].as_array().unwrap() {
        let (j, h) = (twists(&case["J"]), number(&case["h"]));
        let system = ScrewSystem::of_columns(&j, &ScrewOptions::default()).unwrap();
        let projector = system.projector(h).unwrap();
        assert_matrix("P_h", &projector.matrix(), &operator(&case["P_h"]), 1e-12);
        let expected = operator(&case["Pstar_h"]);
        for c in 0..6 {
            let mut unit = [0.0; 6];
            unit[c] = 1.0;
            let image = projector.constraint(Wrench::from_array(unit)).to_array();
            crate::support::assert_close("P*_h", &image, expected.column(c), 1e-12);
        }
        // The pseudoinverse of the annihilator's basis gives the same projector.
        let w = twists(&case["W_basis_of_annihilator"]);
        assert_matrix("W W+h", &(&w * &rates(&case["Wph"])), &expected, 1e-12);
    }
}

#[test]
fn oblique() {
    for case in reference()["general_projection"].as_array().unwrap() {
        let (j, z) = (twists(&case["J"]), twists(&case["Z"]));
        let expected = operator(&case["P"]);
        let tolerance = scaled_tolerance(&expected, 1e-12);
        let inverse = inverse::oblique(&j, &z, &HyperbolicOptions::default()).unwrap();
        assert!(inverse.exists);
        assert_matrix("J J+", &(&j * &inverse.matrix), &expected, tolerance);
        let [s, t] =
            [&j, &z].map(|m| ScrewSystem::of_columns(m, &ScrewOptions::default()).unwrap());
        assert_matrix("P", &s.projector_along(&t).unwrap().matrix(), &expected, tolerance);
    }
}

#[test]
fn normal_forms() {
    for case in reference()["normal_forms"].as_array().unwrap() {
        let j = twists(&case["J"]);
        let length = number(&case["L"]);
        let name = format!("{} {} L = {length}", case["k"], case["class"]);
        let options = ScrewOptions::with_length(length);
        let system = ScrewSystem::of_columns(&j, &options).unwrap();
        assert_eq!(system.order() as u64, case["k"].as_u64().unwrap(), "{name}");
        assert_eq!(system.class().name(), case["class"].as_str().unwrap(), "{name}");
        assert!(!system.is_ambiguous(), "{name}: {:?}", system.margins());
        assert!(system.residual() < 1e-9, "{name}: {}", system.residual());
        let close = |got: &[f64], expected: &[f64]| {
            assert_eq!(got.len(), expected.len(), "{name}: {got:?} {expected:?}");
            for (g, e) in got.iter().zip(expected) {
                assert!((g - e).abs() < 1e-9 * length, "{name}: {got:?} {expected:?}");
            }
        };
        let form = system.normal_form();
        close(&form.pitches, &numbers(&case["nf_pitches"]));
        close(&system.principal_pitches(), &numbers(&case["principal_pitches"]));
        match case["p"].as_f64() {
            Some(p) => assert!((form.slope.unwrap() - p).abs() < 1e-9, "{name}"),
            None => assert!(form.slope.is_none(), "{name}"),
        }
        assert_eq!(
            system.class().never_invertible() && system.order() != 0,
            case["never"].as_bool().unwrap(),
            "{name}"
        );
        for screw in system.principal_screws() {
            let twist = screw.twist();
            assert!(system.sine_to(twist) < 1e-9, "{name}: principal screw is of the system");
            for other in system.basis() {
                let size = length.max(screw.axis.point.norm());
                let form = twist.pitch_form(other, screw.pitch);
                assert!(form.abs() < 1e-9 * size, "{name}: radical, {form}");
            }
        }
        for (h, exists) in case["exists"].as_object().unwrap() {
            let h: f64 = h.parse().unwrap();
            let existence = system.existence(h);
            assert_eq!(
                existence.exists,
                exists.as_bool().unwrap(),
                "{name} h = {h}: {existence:?}"
            );
            assert_eq!(existence.reason.is_none(), existence.exists, "{name}");
            let inverse = inverse::hyperbolic_with(&j, h, &with_length(length)).unwrap();
            assert_eq!((inverse.exists, inverse.reason), (existence.exists, existence.reason));
        }
        // At L and the origin: the entries of a projector have the units of their places.
        let unit = |m: &Matrix| {
            let s = |i: usize| if i < 3 { length } else { 1.0 };
            Matrix::from_fn(6, 6, |a, b| m[(a, b)] * s(b) / s(a))
        };
        if !case["P_h_0.37L"].is_null() {
            let h = 0.37 * length;
            let expected = unit(&operator(&case["P_h_0.37L"]));
            let got = unit(&system.projector(h).unwrap().matrix());
            assert_matrix(
                &format!("{name} P_h"),
                &got,
                &expected,
                scaled_tolerance(&expected, 1e-9),
            );
            let inverse = inverse::hyperbolic_with(&j, h, &with_length(length)).unwrap();
            let expected = rates(&case["Jph_0.37L"]);
            let relative = |m: &Matrix| {
                Matrix::from_fn(m.rows(), 6, |a, b| m[(a, b)] * if b < 3 { length } else { 1.0 })
            };
            let (got, expected) = (relative(&inverse.matrix), relative(&expected));
            assert_matrix(
                &format!("{name} J+h"),
                &got,
                &expected,
                scaled_tolerance(&expected, 1e-9),
            );
        }
        match system.projector(f64::INFINITY) {
            Some(p) => {
                let expected = unit(&operator(&case["P_inf"]));
                let got = unit(&p.matrix());
                let name = format!("{name} P_inf");
                assert_matrix(&name, &got, &expected, scaled_tolerance(&expected, 1e-9));
            }
            None => assert!(case["P_inf"].is_null(), "{name}"),
        }
        // The reciprocal system, and the span itself, as orthogonal projectors at the origin.
        let span = orthogonal(&system.basis(), length);
        let expected = operator(&case["projector_span"]);
        if length == 1.0 {
            assert_matrix(&name, &span, &expected, 1e-9);
            let reciprocal = orthogonal(&system.reciprocal().basis(), length);
            let expected = operator(&case["projector_reciprocal"]);
            assert_matrix(&name, &reciprocal, &expected, 1e-9);
        }
    }
}

/// The orthogonal projector on the span of twists, linear parts over `length`, at the origin.
fn orthogonal(basis: &[Twist], length: f64) -> Matrix {
    let scaled = Matrix::from_fn(6, basis.len(), |i, j| {
        basis[j].to_array()[i] / if i < 3 { length } else { 1.0 }
    });
    let plus = inverse::truncated(&scaled, 1e-9).unwrap().matrix;
    &scaled * &plus
}

fn lines_of(v: &Value) -> Vec<Line> {
    let m = twists(v);
    (0..m.cols()).map(|j| Screw::of(column(&m, j)).unwrap().axis).collect()
}

#[test]
fn lines() {
    for case in reference()["lines"].as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let placed = case["frames"].as_array().unwrap().iter().map(|f| &f["lines"]);
        for lines in [&case["lines"]].into_iter().chain(placed) {
            let lines = lines_of(lines);
            let found = involution(&lines, &ScrewOptions::default()).unwrap();
            assert_eq!(found.system.order() as u64, case["rank"].as_u64().unwrap(), "{name}");
            assert_eq!(found.system.class().name(), case["class"].as_str().unwrap(), "{name}");
            assert_eq!(found.independent, case["independent"].as_bool().unwrap(), "{name}");
            assert_eq!(
                found.in_involution,
                case["involution_gram_criterion"].as_bool().unwrap(),
                "{name}"
            );
            let radical = case["radical_dim"].as_u64().unwrap() as usize;
            assert_eq!(found.null_twists.len(), radical, "{name}");
            for z in &found.null_twists {
                assert!(found.system.sine_to(*z) < 1e-9, "{name}: null twist is of the span");
                let wrench = z.lowered(0.0);
                for line in &lines {
                    assert!(line.twist().power(wrench).abs() < 1e-9, "{name}: no torque");
                }
            }
            let t = &found.transversals;
            assert_eq!(*t, transversals(&lines, &ScrewOptions::default()).unwrap());
            match &case["transversals_real"] {
                Value::String(s) if s == "inf" => assert!(t.infinitely_many, "{name}"),
                Value::String(_) => {
                    assert!(!t.infinitely_many && t.lines.is_empty(), "{name}: {t:?}");
                    assert_eq!(t.at_infinity.len(), 1, "{name}");
                }
                count => {
                    assert!(!t.infinitely_many, "{name}");
                    assert_eq!(t.lines.len() as u64, count.as_u64().unwrap(), "{name}: {t:?}");
                }
            }
            for transversal in &t.lines {
                for line in &lines {
                    let meets = line.twist().klein(transversal.twist()).abs();
                    assert!(meets < 1e-7, "{name}: transversal misses a line by {meets}");
                }
            }
        }
    }
}

#[test]
fn counterexamples_to_the_paper() {
    let data = &reference()["counterexamples"];
    let options = ScrewOptions::default();
    // Theorem 3 (iii) needs the point of tangency to be of the system.
    let case = &data["thm3_iii"];
    let j = twists(&case["J"]);
    let z = twists(&Value::Array(
        case["z"].as_array().unwrap().iter().map(|x| Value::Array(vec![x.clone()])).collect(),
    ));
    let (s, z) = (column(&j, 0), column(&z, 0));
    assert_eq!((z.pitch_form(z, 0.0), s.pitch_form(z, 0.0)), (0.0, 0.0));
    assert_eq!(s.pitch_form(s, 0.0), number(&case["gram"]));
    assert!(inverse::hyperbolic(&j, 0.0).unwrap().exists);
    // Four independent lines in involution with one transversal, and with none.
    let one =
        involution(&lines_of(&data["m4_single_transversal_in_involution"]), &options).unwrap();
    assert!(one.in_involution && one.independent && one.transversals.double);
    assert_eq!(one.transversals.lines.len(), 1);
    let mut pitches = one.system.reciprocal().principal_pitches();
    pitches.sort_by(f64::total_cmp);
    assert!((pitches[0] + 0.4).abs() < 1e-12 && pitches[1].abs() < 1e-12, "{pitches:?}");
    let none = involution(&lines_of(&data["m4_no_transversal_in_involution"]), &options).unwrap();
    assert!(none.in_involution && none.independent && none.transversals.lines.is_empty());
    assert_eq!(none.system.class(), Class::IIB);
    assert!(none.null_screw.unwrap().is_translation());
    assert_eq!(none.wrench.unwrap().force, Vec3::ZERO);
    let five = involution(&lines_of(&data["m5_parallel_to_plane"]), &options).unwrap();
    assert!(five.in_involution && five.independent && five.null_screw.unwrap().is_translation());
    // A damped form that is singular although its damping is positive.
    let case = &data["damped_singular"];
    let damping = HyperbolicDamping::Gram { lambda: number(&case["Lambda"]) };
    let options = HyperbolicOptions { damping, ..HyperbolicOptions::default() };
    let found =
        inverse::hyperbolic_with(&twists(&case["J"]), number(&case["h"]), &options).unwrap();
    assert!(!found.exists);
    assert!(matches!(
        found.reason,
        Some(NoInverse::DampingMeetsEigenvalue { eigenvalue }) if (eigenvalue + 1.0).abs() < 1e-12
    ));
}

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
            crate::support::assert_close(place, &plain, &expected, 1e-9);
            for (h, key) in [(0.1, "h_rates_h=0.1m"), (1.0, "h_rates_h=1m")] {
                let found =
                    inverse::hyperbolic_with(&moved, h * unit, &with_length(0.655 * unit)).unwrap();
                let got = found.matrix.mul_vec(&s);
                crate::support::assert_close(place, &got, &numbers(&case[key]), 1e-9);
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
        crate::support::assert_close(
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

/// The canonical frame of the reference, where it is determined up to symmetries: the normal form
/// placed there spans the same system as ours.
#[test]
fn canonical_frames() {
    for case in reference()["normal_forms"].as_array().unwrap() {
        let length = number(&case["L"]);
        let j = twists(&case["J"]);
        let system = ScrewSystem::of_columns(&j, &ScrewOptions::with_length(length)).unwrap();
        let r = plain(&case["frame_R"]);
        let t = numbers(&case["frame_t"]);
        let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|k| r[(i, k)]));
        let theirs = Pose {
            rotation: Rotation::from_matrix(Mat3::from_rows(rows)).unwrap(),
            translation: Vec3::new(t[0], t[1], t[2]),
        };
        for pose in [theirs, system.canonical_pose()] {
            let placed: Vec<Twist> =
                system.normal_form().twists().into_iter().map(|g| pose.adjoint(g)).collect();
            let options =
                ScrewOptions { center: Some(system.center()), ..ScrewOptions::with_length(length) };
            let placed = ScrewSystem::of(&placed, &options).unwrap();
            let placed = if system.order() > 3 { placed.reciprocal() } else { placed };
            let sine = system.sine_to_system(&placed);
            assert!(sine < 1e-8, "{} {}: {sine}", case["k"], case["class"]);
        }
    }
}
