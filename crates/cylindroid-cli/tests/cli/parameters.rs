//! `--parameter` of every command with a model.

use serde_json::Value;

use crate::documents::commands;
use crate::{json, numbers, refused, text};

const FIVE_BAR: &str = "../cylindroid/tests/data/five_bar_parameters.toml";

fn parameter<'a>(info: &'a Value, name: &str) -> &'a Value {
    info["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap()
}

#[test]
fn values_replace_those_of_the_file() {
    let info = json(&["info", FIVE_BAR, "--parameter", "crank=0.4", "--parameter=width=0"], 0);
    assert_eq!(parameter(&info, "crank")["value"], 0.4);
    assert_eq!(parameter(&info, "rod")["value"], 0.6);
    let height = parameter(&info, "height");
    assert_eq!((&height["value"], &height["lower"]), (&Value::from(1.0), &Value::Null));
    assert_eq!(height["expression"], "crank + sqrt(rod^2 - (width / 2)^2)");
    let at = json(&["fk", FIVE_BAR, "--parameter", "crank=0.4", "--parameter", "width=0"], 0);
    assert_eq!(numbers(&at["pose"]["position"]), [0.0, 1.0, 0.0]);
    let table = text(&["info", FIVE_BAR]);
    assert!(table.contains("both cranks") && table.contains("crank + sqrt"), "{table}");
    assert_eq!(json(&["info", "panda"], 0)["parameters"], Value::Array(Vec::new()));
}

#[test]
fn every_command_with_a_model_takes_them() {
    for command in commands() {
        let help = text(&[&command, "--help"]);
        assert_eq!(
            help.contains("--parameter <NAME=VALUE>"),
            help.contains("<MODEL>"),
            "{command}"
        );
    }
}

/// A value that no design would have.
#[test]
fn a_parameter_varies_or_has_a_value() {
    for varied in [
        &["optimise", FIVE_BAR, "--vary", "crank=0.3:0.8", "--minimise", "anisotropy"][..],
        &["sweep", FIVE_BAR, "--over", "crank=0.4:0.7:3"],
        &["sweep", FIVE_BAR, "--vary", "crank=0.4:0.7", "--designs", "3"],
    ] {
        let message =
            refused(&[varied, &["--parameter", "rod=0.7", "--parameter", "crank=0.5"]].concat());
        assert!(message.contains("--parameter = crank") && message.contains("--vary"), "{message}");
    }
}

#[test]
fn wrong_values_are_refused() {
    let with = |value: &str| refused(&["mobility", FIVE_BAR, "--parameter", value]);
    assert!(with("cranck=0.4").contains("nearest: crank"));
    let range = with("crank=1.5");
    assert!(range.contains("--parameter = crank = 1.5") && range.contains("0.2 to 1"), "{range}");
    assert!(with("crank").contains("a name, = and a number"));
    assert!(with("crank=x").contains("'x' is not a number"));
    let short = with("rod=0.25");
    assert!(short.contains("sqrt(rod^2") && short.contains("five_bar_parameters.toml"), "{short}");
    let panda = refused(&["fk", "panda", "--parameter", "crank=0.4"]);
    assert!(panda.contains("has no parameters"), "{panda}");
    let twists = refused(&["screws", "../../docs/three-lines.csv", "--parameter", "a=1"]);
    assert!(twists.contains("a file of twists has no parameters"), "{twists}");
}
