//! Imports among the files of a Rust crate: every `use` and every path in the code, followed
//! through re-exports to the file that defines the name. `mod x;` is no import, nor is a re-export
//! of what a file's own submodules define.
//!
//! A method is found by its type, so a call of a method that another file adds to an imported type
//! is not seen.

use std::path::Path;

use anyhow::Result;

use super::graph::Import;
use super::modules::{Crate, Module};
use super::source::{below, text_of};

/// The imports of a crate. File names are relative to `root`.
///
/// # Errors
/// Files that are missing or cannot be parsed.
pub(super) fn imports(root: &Path, crate_root: &Path) -> Result<Vec<Import>> {
    let read = Crate::read(&root.join(crate_root))?;
    let mut found = Vec::new();
    for (place, module) in read.modules.iter().enumerate() {
        let text = text_of(&read.files[module.file])?;
        let line_of = |line: usize| text.lines().nth(line - 1).unwrap_or_default().to_owned();
        let uses = module.uses.iter().filter_map(|import| {
            let target = resolve(&read, place, &import.path, true, &mut Vec::new())?;
            let passed_on = import.visible && is_below(&read, target.module, place);
            (import.name.is_some() && !passed_on).then_some((target, import.line))
        });
        let mentions = module.mentions.iter().filter_map(|mention| {
            Some((resolve(&read, place, &mention.path, true, &mut Vec::new())?, mention.line))
        });
        for (target, line) in uses.chain(mentions) {
            let file = read.modules[target.module].file;
            if target.is_item && file != module.file {
                found.push(Import {
                    from: below(root, &read.files[module.file]),
                    to: below(root, &read.files[file]),
                    line,
                    text: line_of(line),
                });
            }
        }
    }
    Ok(found)
}

/// Where a path leads.
#[derive(Clone, Copy)]
struct Target {
    /// The module that was found, or that defines the item.
    module: usize,
    is_item: bool,
}

type Asked = Vec<(usize, String, bool)>;

/// Follows a path; `None` where it leads out of the crate. Where a module and an item have the same
/// name, `wants_item` decides.
fn resolve(
    read: &Crate,
    place: usize,
    path: &[String],
    wants_item: bool,
    asked: &mut Asked,
) -> Option<Target> {
    let mut target = Target { module: place, is_item: false };
    for (depth, name) in path.iter().enumerate() {
        let module: &Module = &read.modules[target.module];
        target.module = match name.as_str() {
            "crate" if depth == 0 => 0,
            "self" if depth == 0 => place,
            "super" => module.parent?,
            _ => {
                let wants_item = wants_item && depth + 1 == path.len();
                match lookup(read, target.module, name, wants_item, asked) {
                    Some(found) => target = found,
                    // What a macro defines there.
                    None if depth > 0 => target.is_item = true,
                    None => return None,
                }
                if target.is_item {
                    return Some(target);
                }
                continue;
            }
        };
    }
    Some(target)
}

/// Finds a name in a module.
fn lookup(
    read: &Crate,
    place: usize,
    name: &str,
    wants_item: bool,
    asked: &mut Asked,
) -> Option<Target> {
    let question = (place, name.to_owned(), wants_item);
    if asked.contains(&question) {
        return None;
    }
    asked.push(question);
    let module = &read.modules[place];
    let child = module.children.get(name).map(|&module| Target { module, is_item: false });
    if !wants_item && child.is_some() {
        return child;
    }
    if module.items.contains(name) {
        return Some(Target { module: place, is_item: true });
    }
    let mut imported = None;
    for import in module.uses.iter().filter(|import| import.name.as_deref() == Some(name)) {
        match resolve(read, place, &import.path, wants_item, asked) {
            Some(found) if found.is_item == wants_item => return Some(found),
            found => imported = imported.or(found),
        }
    }
    let globs = module.uses.iter().filter(|import| import.name.is_none());
    for glob in globs {
        let source = resolve(read, place, &glob.path, false, asked);
        let Some(source) = source.filter(|t| !t.is_item && t.module != place) else { continue };
        match lookup(read, source.module, name, wants_item, asked) {
            Some(found) if found.is_item == wants_item => return Some(found),
            found => imported = imported.or(found),
        }
    }
    child.or(imported)
}

fn is_below(read: &Crate, module: usize, ancestor: usize) -> bool {
    std::iter::successors(Some(module), |&m| read.modules[m].parent).any(|m| m == ancestor)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::super::graph::circles;
    use super::imports;

    /// Writes files, reads the crate at `lib.rs`: `from -> to` for each import, sorted.
    fn read(files: &[(&str, &str)]) -> (Vec<String>, usize) {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let found = imports(root.path(), Path::new("lib.rs")).unwrap();
        let mut told: Vec<String> = found
            .iter()
            .map(|i| format!("{}:{} -> {}: {}", i.from, i.line, i.to, i.text.trim()))
            .collect();
        told.sort();
        told.dedup();
        (told, circles(&found).len())
    }

    #[test]
    fn a_circle_of_siblings_is_found() {
        let (told, circles) = read(&[
            ("lib.rs", "mod a;\nmod b;\n"),
            ("a.rs", "use super::b::B;\npub(crate) struct A(B);\n"),
            ("b.rs", "pub(crate) struct B;\nimpl B {\n fn f(_: &crate::a::A) {}\n}\n"),
        ]);
        assert_eq!(
            told,
            ["a.rs:1 -> b.rs: use super::b::B;", "a.rs:2 -> b.rs: pub(crate) struct A(B);"]
                .into_iter()
                .chain(["b.rs:3 -> a.rs: fn f(_: &crate::a::A) {}"])
                .collect::<Vec<_>>()
        );
        assert_eq!(circles, 1);
    }

    #[test]
    fn re_exports_lead_to_the_file_that_defines() {
        let (told, circles) = read(&[
            ("lib.rs", "pub mod room;\npub use room::{One, two as second};\n"),
            ("room/mod.rs", "mod one;\nmod two;\npub use self::one::One;\npub use two::*;\n"),
            ("room/one.rs", "use super::two;\npub struct One;\npub fn f() { two() }\n"),
            ("room/two.rs", "pub fn two() {}\npub fn three() { crate::second() }\n"),
        ]);
        assert_eq!(
            told,
            [
                "room/one.rs:1 -> room/two.rs: use super::two;",
                "room/one.rs:3 -> room/two.rs: pub fn f() { two() }"
            ]
        );
        assert_eq!(circles, 0);
    }

    #[test]
    fn a_child_that_uses_what_its_parent_defines_and_calls_is_a_circle() {
        let (told, circles) = read(&[
            ("lib.rs", "mod room;\n"),
            ("room/mod.rs", "mod child;\npub(crate) struct X;\nfn f() { child::g(X) }\n"),
            ("room/child.rs", "use super::X;\npub(super) fn g(_: X) {}\n"),
        ]);
        assert_eq!(told[0], "room/child.rs:1 -> room/mod.rs: use super::X;");
        assert_eq!(circles, 1);
    }

    #[test]
    fn macros_and_attributes_are_read_but_not_documentation_nor_tests() {
        let (told, _) = read(&[
            ("lib.rs", "mod a;\nmod b;\nmod c;\n"),
            (
                "a.rs",
                "//! [`super::c::C`]\n/// `super::c::C`\npub fn f() {\n  println!(\"{}\", \
                 super::b::g(1.0));\n}\n#[cfg(test)]\nmod tests { use super::super::c::C; }\n",
            ),
            (
                "b.rs",
                "pub fn g(x: f64) -> f64 { x }\n#[derive(D)]\n#[serde(with = \"super::c::h\")]\nstruct S;\n",
            ),
            ("c.rs", "pub struct C;\npub fn h() {}\n"),
        ]);
        assert_eq!(
            told,
            [
                "a.rs:4 -> b.rs: println!(\"{}\", super::b::g(1.0));",
                "b.rs:3 -> c.rs: #[serde(with = \"super::c::h\")]"
            ]
        );
    }

    #[test]
    fn names_from_elsewhere_and_local_modules_are_no_imports() {
        let (told, _) = read(&[
            ("lib.rs", "mod a;\nmod std_like;\n"),
            (
                "a.rs",
                "use std::fmt;\nuse clap::{self, Parser};\nmod inner { use super::k; fn f() { k() } }\n\
                 fn k() {}\npub(crate) fn x(_: fmt::Error) { inner::f(); clap::y() }\n",
            ),
            ("std_like.rs", "use super::a::{self};\nfn f() { a::x() }\n"),
        ]);
        assert_eq!(told, ["std_like.rs:2 -> a.rs: fn f() { a::x() }"]);
    }
}
