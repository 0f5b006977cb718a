//! The messages as types of the page, in `viewer/src/messages.ts`: the file is what the structs are.

use std::collections::BTreeMap;
use std::path::Path;

use cylindroid::Vec3;
use cylindroid::model::JointKind;
use ts_rs::{Config, TS, TypeVisitor};

use super::compare::CompareJson;
use super::drawings::DrawingsJson;
use super::elsewhere::StatesJson;
use super::messages::{Complaint, Request};
use super::names::{Overlay, REPORTS};
use super::overlays::Shown;
use super::posture::PostureJson;
use super::refusal::Refusal;
use super::reports::ReportJson;
use super::scene::{Scene, ShapeJson};
use super::server::ModelsJson;
use super::shared_session::AboutJson;
use super::snapshot::StateJson;
use super::watch::ModelJson;

const HEAD: &str = "\
/* Made of the structs of the server by a test of crates/cylindroid-cli: see CONTRIBUTING.md. */
";

/// All kinds of joints.
const JOINTS: [JointKind; 10] = [
    JointKind::Revolute,
    JointKind::Continuous,
    JointKind::Prismatic,
    JointKind::Helical { pitch: 0.0 },
    JointKind::Cylindrical,
    JointKind::Universal { second: Vec3::ZERO },
    JointKind::Spherical,
    JointKind::Planar,
    JointKind::Free,
    JointKind::Fixed,
];

/// Names and declarations.
#[derive(Default)]
struct Types(BTreeMap<String, String>);

impl Types {
    /// A type of a name of its own, whose fields name others.
    fn add<T: TS + 'static + ?Sized>(&mut self, name: &str) {
        let docs = T::docs().map_or_else(String::new, |docs| comment(&docs) + "\n");
        let text = format!("{docs}export type {name} ={};\n", broken(&T::inline(&config())));
        match self.0.insert(name.to_owned(), text.clone()) {
            None => T::visit_dependencies(self),
            Some(before) => assert_eq!(before, text, "two types are {name}"),
        }
    }

    fn union(&mut self, name: &str, of: impl IntoIterator<Item = String>) {
        let of: Vec<String> = of.into_iter().collect();
        let text = format!("export type {name} = {};\n", of.join(" | "));
        assert!(self.0.insert(name.to_owned(), text).is_none(), "two types are {name}");
    }
}

impl TypeVisitor for Types {
    fn visit<T: TS + 'static + ?Sized>(&mut self) {
        // Others are those of the language.
        if T::output_path().is_some() {
            self.add::<T>(&T::ident(&config()));
        }
    }
}

fn config() -> Config {
    Config::new().with_large_int("number")
}

/// Longest object on one line.
const SHORT: usize = 100;

/// A declaration after its equals sign: with a line for each variant, and for each field where the
/// fields are many.
fn broken(text: &str) -> String {
    let text = text.replace(", }", " }");
    let in_lines = |variants: &str| variants.replace(" | {", "\n  | {");
    match text.split_once(" & (") {
        Some((fields, variants)) => format!(" {} & (\n  {}", object(fields), in_lines(variants)),
        None if text.contains("} | {") => format!("\n  | {}", in_lines(&text)),
        None => format!(" {}", object(&text)),
    }
}

/// The fields of an object between braces, with their comments; of others the same text.
fn object(text: &str) -> String {
    let fields = text.strip_prefix("{ ").and_then(|text| text.strip_suffix(" }"));
    let Some(fields) = fields.filter(|_| text.len() > SHORT || text.contains("/**")) else {
        return text.to_owned();
    };
    let mut lines = "{\n  ".to_owned();
    let mut depth = 0_usize;
    let mut rest = fields;
    while let Some(first) = rest.chars().next() {
        if let Some((words, after)) = rest.strip_prefix('\n').and_then(|r| r.split_once("*/")) {
            lines.push_str(&format!("{}\n  ", comment(words)));
            rest = after.trim_start();
            continue;
        }
        match first {
            '{' | '[' | '(' | '<' => depth += 1,
            '}' | ']' | ')' | '>' => depth -= 1,
            _ => {}
        }
        rest = &rest[first.len_utf8()..];
        if (first, depth) == (',', 0) {
            lines.push_str(",\n  ");
            rest = rest.trim_start_matches(' ');
        } else {
            lines.push(first);
        }
    }
    lines + ",\n}"
}

/// A comment on one line.
fn comment(text: &str) -> String {
    let words = text.lines().map(|line| line.trim_matches([' ', '*', '/']));
    let words: Vec<&str> = words.filter(|words| !words.is_empty()).collect();
    format!("/** {} */", words.join(" "))
}

/// The data of an overlay.
const fn data(overlay: Overlay) -> &'static str {
    match overlay {
        Overlay::Velocity
        | Overlay::AngularVelocity
        | Overlay::ActiveForce
        | Overlay::PassiveForce => "Ellipsoid",
        Overlay::JointAxes => "JointAxes",
        Overlay::PrincipalScrews => "PrincipalScrews",
        Overlay::Reciprocal => "Reciprocal",
        Overlay::Cylindroid => "Cylindroid",
        Overlay::LostDirection => "LostDirection",
    }
}

fn messages() -> String {
    let mut types = Types::default();
    let quoted = |name: &str| format!("\"{name}\"");
    types.union("JointKind", JOINTS.map(|kind| quoted(kind.name())));
    types.union("ReportName", REPORTS.map(quoted));
    types.union("OverlayName", Overlay::ALL.map(|overlay| quoted(overlay.name())));
    let fields = Overlay::ALL.map(|o| format!("\n  \"{}\": {} | Empty,", o.name(), data(o)));
    types.union("OverlayData", [format!("{{{}\n}}", fields.concat())]);
    Shown::visit_dependencies(&mut types);
    types.add::<ShapeJson<'static>>("Shape");
    types.add::<PostureJson<'static>>("Posture");
    types.add::<Scene<'static>>("Scene");
    types.add::<StateJson<'static>>("State");
    types.add::<CompareJson<'static>>("Comparison");
    types.add::<ReportJson<'static>>("Report");
    types.add::<StatesJson<'static>>("Postures");
    types.add::<Complaint>("Failure");
    types.add::<AboutJson<'static>>("About");
    types.add::<DrawingsJson<'static>>("Drawings");
    types.add::<ModelJson>("ModelNews");
    types.add::<ModelsJson<'static>>("Models");
    types.add::<Refusal>("Refusal");
    types.add::<Request>("ToServer");
    let types: String = types.0.into_values().collect();
    format!("{HEAD}\n{types}")
}

#[test]
fn types_of_the_page_are_those_of_the_messages() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../viewer/src/messages.ts");
    let text = messages();
    if std::env::var_os("CYLINDROID_BLESS").is_some() {
        std::fs::write(&file, &text).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        written == text,
        "viewer/src/messages.ts is not what the structs are; write it: CYLINDROID_BLESS=1 cargo \
         test -p cylindroid-cli --lib typescript"
    );
}
