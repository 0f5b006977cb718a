//! `[parameters]` of mechanism files: expressions, values given at loading, refusals.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use cylindroid::model::Parameter;
use cylindroid::{Error, Mechanism, ParametricModel, Result, Vec3};

use crate::fk::{closed_at_home, frame};
use crate::mechanism_file::check;
use crate::{ARM_TOML, read_toml};

const FIVE_BAR: &str = include_str!("../data/five_bar_parameters.toml");

/// A planar 2R arm with two parameters.
const ARM: &str = r#"
dimension = 2
reference = "hand"
reference_point = ["upper + lower", 0]

[parameters]
upper = { value = 0.5, lower = 0.1, upper = 1.0, unit = "m" }
lower = "0.8 * upper"
range = "radians(150)"

[[joint]]
name = "shoulder"
type = "revolute"
between = ["ground", "arm"]
origin = [0, 0]
limits = { lower = "-range", upper = "range", velocity = 2 }

[[joint]]
name = "elbow"
type = "revolute"
between = ["arm", "hand"]
origin = ["upper", 0]
"#;

fn with(text: &str, values: &[(&str, f64)]) -> Result<Mechanism> {
    ParametricModel::of_text(text, Path::new("robots/test.toml"), values)
        .map(|model| model.nominal().clone())
}

/// The value of an expression, as the parameter `x` of a file.
fn value(expression: &str) -> f64 {
    let text = ARM.replace("[parameters]", &format!("[parameters]\nx = '{expression}'\na = 3"));
    let m = read_toml(&text).unwrap();
    m.parameters().iter().find(|p| p.name == "x").unwrap().value
}

/// An expression is refused with this message, at this place of it.
#[track_caller]
fn refuse(expression: &str, at: &str, says: &str) {
    let text = ARM.replace("[parameters]", &format!("[parameters]\nx = '{expression}'\na = 3"));
    check(&text, at, says);
}

#[test]
fn expressions_follow_the_rules_of_arithmetic() {
    let cases = [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("10 - 4 - 3", 3.0),
        ("16 / 4 / 2", 2.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("-2 ^ 2", -4.0),
        ("2 ^ -1", 0.5),
        ("2 * -a", -6.0),
        ("--a", 3.0),
        ("+a", 3.0),
        ("1.5e1 + .5 + 2. + 1E-1", 17.6),
        ("pi / 2", PI / 2.0),
        ("sqrt(a * 3)", 3.0),
        ("abs(-a)", 3.0),
        ("atan2(1, -1)", 0.75 * PI),
        ("hypot(3, 4)", 5.0),
        ("min(a, 2) + max(a, 2)", 5.0),
        ("radians(180)", PI),
        ("exp(0)", 1.0),
        ("sin(pi / 6) + cos(pi / 3) + tan(pi / 4)", 2.0),
        ("asin(1) + acos(0) + atan(0)", PI),
        ("  a\t*( 2 )", 6.0),
    ];
    for (text, expected) in cases {
        let got = value(text);
        assert!((got - expected).abs() <= 4e-16 * expected.abs(), "{text} is {got}");
    }
}

#[test]
fn expressions_of_a_number_are_the_number() {
    for x in [0.1_f64, 1.0 / 3.0, 1e-300, 123_456_789.123_456_79, 5e-324, 1e120] {
        assert_eq!(value(&format!("{x:e}")).to_bits(), x.to_bits());
        assert_eq!(value(&x.to_string()).to_bits(), x.to_bits());
    }
}

#[test]
fn expressions_that_are_wrong_are_pointed_at() {
    refuse("a +", "", "the expression ends where a number, a parameter or ( is expected");
    refuse("", "", "the expression ends");
    refuse("a b", "b", "'b' stands where an operator is expected");
    refuse("(a", "", "ends where an operator or ) is expected");
    refuse("a)", ")", "')' stands where an operator");
    refuse("3 * * a", "*", "'*' stands where");
    refuse("2 a", "a", "an operator is expected");
    refuse("1e", "e", "an operator is expected");
    refuse("1 + . ", ".", "'.' is not a number");
    refuse("sqrt a", "a", "where the ( of sqrt is expected");
    refuse("hypot(a)", ")", "argument 2 of hypot");
    refuse("sqrt(a, a)", ",", "an operator or )");
    refuse("a = 3", "=", "an operator is expected");
    refuse("é + 1", "é", "no parameter named 'é'");
    refuse("1 + lowr", "lowr", "no parameter named 'lowr'; nearest: lower");
    refuse("system(a)", "(", "an operator is expected");
    refuse("1 + 2 / (a - 3)", "2 / (a - 3)", "2 / (a - 3) is infinite");
    refuse("1 + sqrt(-a) * 0", "sqrt(-a)", "sqrt(-a) is not a number");
    refuse("min(1, 1 / 0)", "1 / 0", "1 / 0 is infinite");
    refuse("1e999", "1e999", "1e999 is infinite");
    refuse("1e121", "'", "out of range");
    let deep = format!("{}a{}", "(".repeat(1000), ")".repeat(1000));
    refuse(&deep, "", "more than 64 levels");
    refuse(&"-".repeat(100_000), "", "more than 64 levels");
    assert_eq!(value(&format!("{}0", "1 + ".repeat(10_000))), 10_000.0);
}

#[test]
fn numbers_of_the_file_follow_from_parameters() {
    for upper in [0.1, 0.37, 1.0] {
        let m = with(ARM, &[("upper", upper)]).unwrap();
        let lower = 0.8 * upper;
        let (a, b) = (0.3_f64, 0.7_f64);
        let tip = frame(&m, &[a, b], "reference").translation;
        let (x, y) =
            (a.cos() * upper + (a + b).cos() * lower, a.sin() * upper + (a + b).sin() * lower);
        assert!((tip - Vec3::new(x, y, 0.0)).norm() < 1e-15);
        let limits = m.coordinates()[0].limits;
        assert_eq!((limits.lower, limits.upper), (-150_f64.to_radians(), 150_f64.to_radians()));
        let values: Vec<f64> = m.parameters().iter().map(|p| p.value).collect();
        assert_eq!(values, [upper, lower, limits.upper]);
    }
    let given = with(ARM, &[("lower", 0.2)]).unwrap();
    let [upper, lower, _] = given.parameters() else { panic!("three parameters") };
    assert_eq!(
        *upper,
        Parameter {
            name: "upper".to_owned(),
            value: 0.5,
            lower: 0.1,
            upper: 1.0,
            unit: "m".to_owned(),
            description: String::new(),
            expression: String::new(),
        }
    );
    // A given value takes the place of the expression.
    assert_eq!((lower.value, lower.expression.as_str()), (0.2, ""));
    assert_eq!(read_toml(ARM).unwrap().parameters()[1].expression, "0.8 * upper");
}

#[test]
fn loops_are_closed_in_every_design() {
    for (crank, rod, width) in [(0.5, 0.6, 0.6), (0.2, 1.5, 0.0), (1.0, 0.9, 1.7)] {
        let m = with(FIVE_BAR, &[("crank", crank), ("rod", rod), ("width", width)]).unwrap();
        closed_at_home(&m, 1e-15);
        assert_eq!((m.n(), m.loops().len()), (4, 1));
    }
    let refused = with(FIVE_BAR, &[("rod", 0.25)]).unwrap_err().to_string();
    assert!(refused.contains("sqrt(rod^2 - (width / 2)^2) is not a number"), "{refused}");
}

/// Every number of a file as an expression changes no bit of the mechanism.
#[test]
fn a_file_in_expressions_is_the_same_mechanism() {
    fn quoted(value: &mut toml::Value) {
        match value {
            toml::Value::Integer(i) => *value = toml::Value::String(i.to_string()),
            toml::Value::Float(x) if x.is_finite() => *value = toml::Value::String(x.to_string()),
            toml::Value::Array(all) => all.iter_mut().for_each(quoted),
            toml::Value::Table(all) => all.iter_mut().for_each(|(_, value)| quoted(value)),
            _ => {}
        }
    }
    let data = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["tests/data/linkages", "tests/data/mechanisms", "src/model/catalogue"];
    let mut count = 0;
    for folder in folders.map(|folder| data.join(folder)) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            let mut file: toml::Table = text.parse().unwrap();
            file.iter_mut().for_each(|(_, value)| quoted(value));
            file.insert("parameters".to_owned(), toml::Table::new().into());
            let plain = cylindroid::load_text(&text, &path).unwrap();
            let written = cylindroid::load_text(&file.to_string(), &path)
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let parts = |m: &Mechanism| {
                let graph = (m.joints().to_vec(), m.loops().to_vec(), m.contacts().to_vec());
                (graph, m.coordinates().to_vec(), m.home().to_vec(), m.frames().to_vec())
            };
            assert_eq!(
                format!("{:?}", parts(&written)),
                format!("{:?}", parts(&plain)),
                "{}",
                path.display()
            );
            count += 1;
        }
    }
    assert!(count > 40, "{count} files");
}

#[test]
fn without_the_table_a_text_is_no_number() {
    check(&ARM_TOML.replace("[0, 0, 1]", "[0, 0, \"1\"]"), "\"1\"", "not a finite number");
    check(&ARM_TOML.replace("pitch = 0.01", "pitch = \"0.01\""), "\"0.01\"", "is a string");
    let with = format!("{}\n[parameters]\n", ARM_TOML.replace("[0, 0, 1]", "[0, 0, \"1\"]"));
    assert!(read_toml(&with).is_ok());
}

#[test]
fn definitions_that_are_wrong_are_pointed_at() {
    let add = |line: &str| ARM.replace("[parameters]", &format!("[parameters]\n{line}"));
    check(&add("link-a = 1"), "link-a", "cannot be named 'link-a'");
    check(&add("\"2d\" = 1"), "\"2d\"", "cannot be named '2d'");
    check(&add("sin = 1"), "sin", "has a meaning in expressions");
    check(&add("pi = 3"), "pi", "has a meaning in expressions");
    check(&add("x = true"), "true", "is no number");
    check(&add("x = [1]"), "[1]", "is no number");
    check(&add("x = nan"), "nan", "is no number");
    check(&add("x = inf"), "inf", "is not finite");
    check(&add("x = {}"), "{}", "a parameter has no value");
    check(&add("x = { value = 1, uper = 2 }"), "uper", "nearest: upper");
    check(&add("x = { value = 3, upper = 2 }"), "3", "x = 3, and its range is -inf to 2");
    check(&add("x = { value = 3, lower = 4, upper = 2 }"), "4", "the range of 'x' is empty");
    check(&add("x = { value = 3, unit = 1 }"), "1", "a text in quotes");
    check(&add("x = 'y'\ny = 'x'"), "x", "defined by one another: x -> y -> x");
    check(&add("w = 'x'\nx = '2 * y'\ny = 'z'\nz = 'y + 1'"), "y", "y -> z -> y");
    check(&add("x = 'x + 1'"), "x", "x -> x");
    check(
        &add("x = { value = '2 * upper', upper = 'upper' }"),
        "'2 * upper'",
        "x = 1, and its range",
    );
    check("parameters = 3", "3", "parameters is no table");
    check(&ARM.replace("[\"upper\", 0]", "[\"uper\", 0]"), "uper", "nearest: upper");
    check(&ARM.replace("\"-range\"", "\"-rnge\""), "rnge", "nearest: range");
    check(&ARM.replace("\"-range\"", "\"1 / 0\""), "1 / 0", "is infinite");
}

#[test]
fn a_long_chain_of_parameters_is_evaluated() {
    let mut lines = String::from("p0 = 1\n");
    for i in 1..20_000 {
        lines += &format!("p{i} = 'p{} + 1'\n", i - 1);
    }
    let m = read_toml(&ARM.replace("[parameters]", &format!("[parameters]\n{lines}"))).unwrap();
    assert_eq!(m.parameters()[19_999].value, 20_000.0);
}

#[test]
fn values_that_are_wrong_are_refused() {
    let refused = |values: &[(&str, f64)]| with(ARM, values).unwrap_err().to_string();
    assert!(refused(&[("uper", 1.0)]).starts_with("no parameter named 'uper'; nearest: upper"));
    let range = refused(&[("upper", 1.5)]);
    assert!(range.contains("upper = 1.5") && range.contains("its range is 0.1 to 1"), "{range}");
    assert!(refused(&[("upper", 0.2), ("upper", 0.3)]).contains("it is given twice"));
    assert!(refused(&[("upper", f64::NAN)]).contains("is not finite"));
    assert!(refused(&[("lower", 1e121)]).contains("out of range"));
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/arm.urdf");
    for model in [urdf.to_str().unwrap(), "panda"] {
        let error = cylindroid::load_with_parameters(model, &[("x", 1.0)]).unwrap_err();
        assert!(error.to_string().contains("has no parameters"), "{error}");
    }
    let error = ParametricModel::read(urdf.to_str().unwrap(), &[]).unwrap_err();
    assert!(error.to_string().contains("only mechanism files"), "{error}");
}

#[test]
fn a_parametric_model_is_the_file_with_other_values() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/five_bar_parameters.toml");
    let path = path.to_str().unwrap();
    let model = ParametricModel::read(path, &[("width", 0.4)]).unwrap();
    let names: Vec<&str> = model.parameters().iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["crank", "rod", "width", "height"]);
    assert_eq!(model.nominal().parameters()[2].value, 0.4);
    for crank in [0.2, 0.7] {
        let own = model.with(&[("crank", crank)]).unwrap();
        let values = [("crank", crank), ("width", 0.4)];
        let loaded = cylindroid::load_with_parameters(path, &values).unwrap();
        assert_eq!(own.joints(), loaded.joints());
        assert_eq!(own.parameters(), loaded.parameters());
    }
    let wide = model.with(&[("width", 0.8)]).unwrap();
    assert_eq!(wide.parameters()[2].value, 0.8);
    let ur5e = ParametricModel::read("ur5e", &[]).unwrap();
    assert!(ur5e.parameters().is_empty() && ur5e.nominal().n() == 6);
}

#[test]
fn robots_take_values_of_their_parameters() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("arm.toml"), ARM).unwrap();
    let cell = |parameters: &str| {
        let text = format!(
            "dimension = 2\n[parameters]\nwidth = 0.3\n[[robot]]\nname = \"a\"\nmodel = \"arm.toml\"\n\
             parameters = {{ {parameters} }}\n"
        );
        let result = cylindroid::load_text(&text, &folder.path().join("cell.toml"));
        (text, result)
    };
    let m = cell("upper = \"2 * width\"").1.unwrap();
    let tip = frame(&m, &[0.0, 0.0], "a/reference").translation;
    assert!((tip - Vec3::new(1.08, 0.0, 0.0)).norm() < 1e-15, "{tip:?}");
    // The parameters of the file are those of the file.
    assert_eq!(m.parameters().len(), 1);
    for (values, says) in [("uper = 1", "nearest: upper"), ("upper = 3", "its range is 0.1 to 1")] {
        let (text, result) = cell(values);
        let Err(Error::File(error)) = result else { panic!("{result:?}") };
        assert!(error.message.contains(says), "{error}");
        assert!(text[error.span.clone()].starts_with('{'), "{}", &text[error.span.clone()]);
    }
}
