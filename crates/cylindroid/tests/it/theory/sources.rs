//! The table of docs/theory/sources.md: no row is missing, and every name in it exists. Tests are
//! checked with those of the chapters.

use std::fs;
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The rows that each source must have: its definitions, theorems, algorithms, examples, tables and
/// figures, read off the sources themselves.
const REQUIRED: [(&str, &str); 3] = [
    (
        "## Hyperbolic pseudoinverses",
        "theorem 1|theorem 2|theorem 3|corollary 4|theorem 5|table 1|table 2|table 3|figure 1|\
         figure 2|example 1|example 2|example 3|example 4|eq. 1|eq. 2|eq. 3|eq. 4|eq. 5|eq. 7|\
         eq. 8|eq. 9|eq. 10|eq. 11|eq. 12|eq. 13|eq. 14|eq. 15|eq. 16|eq. 21|eq. 23|eq. 26|\
         2.1 group|Q_inf|Q_0|index|planes|exponential|joints|kinematic mapping|screw system|laws P1-P4|\
         hP1-hP4|Gram matrix|types|principal pitches|one-systems|involution|two lines|three lines|\
         four lines|five lines|six lines|wrench Q_0 z|5.1|5.3|damped form|shared control|\
         hybrid control|Q_h^-1|P*_h|7 stiffness|7 values",
    ),
    (
        "## Manipulability of cooperating robots",
        "eq. 1|eq. 2|eq. 3|eq. 4|eq. 5|eq. 6|eq. 7|eq. 8|eq. 9|eq. 10|eq. 11|eq. 12|eq. 13|eq. 14|\
         eq. 15|eq. 16|eq. 17|eq. 18|eq. 19|eq. 20|footnote 1|footnote 2|footnote 3|footnote 4|\
         footnote 5|figure 1|figure 2|figure 3|table 1|table 2|case a|case b|case c|conclusion|\
         Stewart platform|several objects|hyperstatic|passive force|R_ak, R_pk|appendix A",
    ),
    (
        "## Cartesian control",
        "7.1|7.1 Jacobian|7.2.1 velocity|7.2.1 conversion|7.2.1 s(a)|7.2.2|7.2.3|7.2.4|7.3.1|\
         7.3.2 SVD|7.3.2 closeness|7.3.2 cut|7.3.2 program|7.4 problem|7.4 step 1|7.4 step 2|\
         7.4 step 3|7.4 step 4|7.4 step 5|7.4 step 6|7.4 step 7|7.5 null space|7.5 projector|\
         7.5 secondary",
    ),
];
/// Equations that stand in the row of the statement that they belong to.
const WITHIN: [(&str, &str); 3] =
    [("eq. 6", "theorem 1"), ("eqs. 17 to 20", "theorem 3"), ("eq. 22", "example 3")];

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The rows below a heading: cells without the bars.
fn rows<'a>(page: &'a str, heading: &str) -> Vec<Vec<&'a str>> {
    let start = page.find(heading).unwrap_or_else(|| panic!("no '{heading}'"));
    let section = &page[start + heading.len()..];
    let section = &section[..section.find("\n## ").unwrap_or(section.len())];
    let table =
        section.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| item"));
    table.map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect()).collect()
}

fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// The text of every file of a module.
fn sources(path: &Path) -> String {
    if !path.is_dir() {
        return fs::read_to_string(path).unwrap_or_default();
    }
    fs::read_dir(path).unwrap().map(|entry| sources(&entry.unwrap().path())).collect()
}

fn declares(text: &str, keywords: &[&str], name: &str) -> bool {
    keywords.iter().any(|keyword| {
        text.match_indices(&format!("{keyword}{name}")).any(|(at, found)| {
            let next = text[at + found.len()..].chars().next();
            !next.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })
    })
}

/// `module::item` or `module::Type::method`.
fn rust_item_exists(path: &str) -> bool {
    let parts: Vec<&str> = path.split("::").collect();
    let module = Path::new(ROOT).join("crates/cylindroid/src").join(parts[0]);
    let text = sources(&module);
    let items = ["pub fn ", "pub struct ", "pub enum ", "pub const fn "];
    match parts[..] {
        [_, item] => declares(&text, &items, item),
        [_, owner, method] => declares(&text, &items, owner) && declares(&text, &items, method),
        _ => false,
    }
}

/// `command --option ...`, as the page of the command line shows its help.
fn command_exists(command: &str, help: &str) -> bool {
    let mut words = command.split(' ');
    let heading = format!("\n## {}\n", words.next().unwrap());
    let Some(start) = help.find(&heading) else { return false };
    let section = &help[start + heading.len()..];
    let section = &section[..section.find("\n## ").unwrap_or(section.len())];
    words.all(|word| declares(section, &["      "], word))
}

/// `function`, `Class` or `Class.member`, in the stub.
fn python_name_exists(name: &str, stub: &str) -> bool {
    let Some((class, member)) = name.split_once('.') else {
        return declares(stub, &["\ndef ", "\nclass "], name);
    };
    let Some(start) = stub.find(&format!("\nclass {class}:")) else { return false };
    let body = &stub[start + 1..];
    let body = &body[..body.find("\nclass ").unwrap_or(body.len())];
    declares(body, &["    def "], member)
}

#[test]
fn no_row_is_missing() {
    let page = read("docs/theory/sources.md");
    for (heading, required) in REQUIRED {
        let found: Vec<&str> = rows(&page, heading).iter().map(|row| row[0]).collect();
        let required: Vec<&str> = required.split('|').collect();
        for item in &required {
            let count = found.iter().filter(|f| f == &item).count();
            assert_eq!(count, 1, "{heading}: {count} rows '{item}'");
        }
        let more: Vec<_> = found.iter().filter(|f| !required.contains(f)).collect();
        assert!(more.is_empty(), "{heading}: not required: {more:?}");
    }
    for (equation, item) in WITHIN {
        let all = rows(&page, REQUIRED[0].0);
        let row = all.iter().find(|row| row[0] == item).unwrap();
        assert!(row[1].contains(equation), "{item} does not name {equation}");
    }
}

#[test]
fn every_name_of_a_row_exists() {
    let (page, help) = (read("docs/theory/sources.md"), read("docs/command-line.md"));
    let stub = read("crates/cylindroid-py/python/cylindroid/_core.pyi");
    let mut faults = Vec::new();
    for row in REQUIRED.iter().flat_map(|(heading, _)| rows(&page, heading)) {
        assert_eq!(row.len(), 7, "{row:?}");
        let mut check = |what: &str, cell: &str, exists: &dyn Fn(&str) -> bool| {
            assert!(cell == "–" || quoted(cell).next().is_some(), "{}: {what} '{cell}'", row[0]);
            let wrong = quoted(cell).filter(|name| !exists(name));
            faults.extend(wrong.map(|name| format!("{}: no {what} '{name}'", row[0])));
        };
        check("Rust item", row[2], &rust_item_exists);
        check("command", row[3], &|c| command_exists(c, &help));
        check("Python name", row[4], &|n| python_name_exists(n, &stub));
        check("test", row[5], &|t| t.starts_with("tests/"));
        assert!(!row[6].is_empty(), "{} has no state", row[0]);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Examples, tables and figures have a section with a command or a call that prints.
#[test]
fn examples_tables_and_figures_are_worked() {
    let page = read("docs/theory/examples.md");
    let sources = [
        ("## Donelan and Selig", 0, &["example", "table", "figure"][..]),
        ("## Bicchi and Prattichizzo", 1, &["table", "figure"][..]),
    ];
    for (heading, source, kinds) in sources {
        let start = page.find(heading).unwrap();
        let section = &page[start + heading.len()..];
        let section = &section[..section.find("\n## ").unwrap_or(section.len())];
        let titles: Vec<String> = section
            .lines()
            .filter(|line| line.starts_with("### "))
            .map(|line| line.to_lowercase().replace("tables 1 and 2", "table 1, table 2"))
            .collect();
        for item in REQUIRED[source].1.split('|') {
            if kinds.iter().any(|kind| item.starts_with(kind)) {
                assert!(titles.iter().any(|t| t.contains(item)), "{heading}: no section {item}");
            }
        }
        for part in section.split("\n### ").skip(1) {
            let title = part.lines().next().unwrap();
            assert!(part.contains("\ncylindroid "), "{title}: no command");
            assert!(part.contains("```python"), "{title}: no call");
            assert!(part.contains("```text"), "{title}: no result");
        }
    }
}

#[test]
fn names_that_do_not_exist_are_told() {
    assert!(rust_item_exists("screws::gram") && rust_item_exists("spatial::Twist::bracket"));
    assert!(!rust_item_exists("screws::gra") && !rust_item_exists("screws::ScrewSystem::gone"));
    let help = read("docs/command-line.md");
    assert!(command_exists("screws --h", &help) && !command_exists("screws --gone", &help));
    assert!(!command_exists("gone", &help));
    let stub = read("crates/cylindroid-py/python/cylindroid/_core.pyi");
    assert!(python_name_exists("hyperbolic", &stub) && python_name_exists("Mobility.dof", &stub));
    assert!(!python_name_exists("hyper", &stub) && !python_name_exists("Mobility.gone", &stub));
}
