//! Places in the source that can be mutated, and a sample of them.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use proc_macro2::Span;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, Lit, UnOp};

use super::mutant::Mutant;

/// The mutants of the files below a folder of `source`; files that are compiled for tests alone are
/// left out.
pub(super) fn find(source: &Path, folder: &str, found: &mut Vec<Mutant>) -> Result<()> {
    let mut of_tests = Vec::new();
    find_below(source, folder, found, &mut of_tests)?;
    found.retain(|mutant| !of_tests.contains(&source.join(&mutant.file)));
    Ok(())
}

fn find_below(
    source: &Path,
    folder: &str,
    found: &mut Vec<Mutant>,
    of_tests: &mut Vec<PathBuf>,
) -> Result<()> {
    let mut entries: Vec<_> =
        fs::read_dir(source.join(folder))?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    entries.sort();
    for path in entries {
        let name = path.strip_prefix(source)?.to_string_lossy().into_owned();
        if path.is_dir() {
            find_below(source, &name, found, of_tests)?;
        } else if name.ends_with(".rs") {
            let text = fs::read_to_string(&path)?;
            let file = syn::parse_file(&text).with_context(|| name.clone())?;
            let own = if name.ends_with("mod.rs") { path.parent() } else { None };
            let below = own.map_or_else(|| path.with_extension(""), Path::to_owned);
            of_tests.extend(file.items.iter().filter_map(|item| match item {
                syn::Item::Mod(item) if item.content.is_none() && is_test(&item.attrs) => {
                    Some(below.join(format!("{}.rs", item.ident)))
                }
                _ => None,
            }));
            let mut visitor = Visitor { name: &name, text: &text, found };
            visitor.visit_file(&file);
        }
    }
    Ok(())
}

/// The mutants of these lines, FILE:LINE.
pub(super) fn at(mut all: Vec<Mutant>, lines: &[&str]) -> Result<Vec<Mutant>> {
    let is_at = |mutant: &Mutant, line: &str| format!("{}:{}", mutant.file, mutant.line) == line;
    if let Some(line) = lines.iter().find(|line| !all.iter().any(|m| is_at(m, line))) {
        bail!("--at {line}: no mutants there; a line is FILE:LINE, the file below src");
    }
    all.retain(|mutant| lines.iter().any(|line| is_at(mutant, line)));
    Ok(all)
}

/// `sample` of the mutants, of which none contains another.
pub(super) fn drawn(mut all: Vec<Mutant>, sample: usize, seed: u64) -> Vec<Mutant> {
    let mut state = seed;
    let mut chosen: Vec<Mutant> = Vec::new();
    while chosen.len() < sample && !all.is_empty() {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let mutant = all.swap_remove(((z ^ (z >> 31)) % all.len() as u64) as usize);
        // Errors of the compiler are told apart by their lines.
        if !chosen.iter().any(|m| m.file == mutant.file && m.line == mutant.line) {
            chosen.push(mutant);
        }
    }
    chosen.sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
    chosen
}

struct Visitor<'a> {
    name: &'a str,
    text: &'a str,
    found: &'a mut Vec<Mutant>,
}

impl Visitor<'_> {
    /// The whole expression, and the part of it that becomes `new`.
    fn add(&mut self, whole: Span, part: Span, new: &str) {
        if whole.start().line != whole.end().line {
            return;
        }
        let (range, part) = (whole.byte_range(), part.byte_range());
        let old = self.text[range.clone()].to_owned();
        let mut changed = old.clone();
        changed.replace_range(part.start - range.start..part.end - range.start, new);
        let (file, line) = (self.name.to_owned(), whole.start().line);
        let text = self.text.lines().nth(line - 1).unwrap_or_default().trim().to_owned();
        self.found.push(Mutant { file, line, text, range, old, new: changed });
    }
}

/// `#[test]`, `#[cfg(test)]`, `#[cfg(any(test, fuzzing))]`.
fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| {
        let condition = match &a.meta {
            syn::Meta::List(list) if a.path().is_ident("cfg") => list.tokens.to_string(),
            _ => String::new(),
        };
        let with_others = ["any (test", "all (test"];
        a.path().is_ident("test")
            || condition == "test"
            || with_others.iter().any(|start| condition.starts_with(start))
    })
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    // Constants cannot ask which mutant is chosen.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if item.sig.constness.is_none() && !is_test(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if item.sig.constness.is_none() && !is_test(&item.attrs) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_expr_binary(&mut self, e: &'ast syn::ExprBinary) {
        let new = match e.op {
            BinOp::Add(_) => "-",
            BinOp::Sub(_) => "+",
            BinOp::Mul(_) => "/",
            BinOp::Div(_) => "*",
            BinOp::Lt(_) | BinOp::Le(_) => ">",
            BinOp::Gt(_) | BinOp::Ge(_) => "<",
            BinOp::Eq(_) => "!=",
            BinOp::Ne(_) => "==",
            BinOp::And(_) => "||",
            BinOp::Or(_) => "&&",
            _ => "",
        };
        // A condition with `let` is no value.
        let has_let = |side: &Expr| self.text[side.span().byte_range()].contains("let ");
        if !new.is_empty() && !has_let(&e.left) && !has_let(&e.right) {
            self.add(e.span(), e.op.span(), new);
        }
        visit::visit_expr_binary(self, e);
    }

    fn visit_expr_unary(&mut self, e: &'ast syn::ExprUnary) {
        if matches!(e.op, UnOp::Neg(_) | UnOp::Not(_)) {
            self.add(e.span(), e.op.span(), "");
        }
        visit::visit_expr_unary(self, e);
    }

    fn visit_expr_lit(&mut self, e: &'ast syn::ExprLit) {
        if let Lit::Float(number) = &e.lit
            && let Ok(x) = number.base10_parse::<f64>()
        {
            let new = if x == 0.0 { "1.0".to_owned() } else { format!("{:?}", 1.5 * x) };
            self.add(e.span(), number.span(), &new);
        }
    }

    fn visit_expr_method_call(&mut self, e: &'ast syn::ExprMethodCall) {
        let new = match e.method.to_string().as_str() {
            "sin" => "cos",
            "cos" => "sin",
            "min" => "max",
            "max" => "min",
            "abs" => "neg",
            "transpose" => "clone",
            "any" => "all",
            "all" => "any",
            _ => "",
        };
        if new == "neg" {
            let receiver = e.receiver.span().byte_range();
            let kept = self.text[receiver].to_owned();
            self.add(e.span(), e.span(), &kept);
        } else if !new.is_empty() {
            self.add(e.span(), e.method.span(), new);
        }
        visit::visit_expr_method_call(self, e);
    }
}

#[cfg(test)]
mod tests {
    use super::{at, find};

    #[test]
    fn code_of_tests_has_no_mutants() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        let sum = "fn f(x: f64, y: f64) -> f64 { x + y }";
        let tests = "#[cfg(any(test, fuzzing))]\nmod referee;\n#[cfg(test)]\nmod tests;";
        let own = format!("#[cfg(test)]\nmod inside {{ {sum} }}");
        write("a/b.rs", &format!("{sum}\n{tests}\n{own}"));
        write("a/b/referee.rs", sum);
        write("a/b/tests.rs", sum);
        write("a/b/c.rs", sum);
        let mut found = Vec::new();
        find(folder.path(), "a", &mut found).unwrap();
        let places: Vec<&str> = found.iter().map(|m| m.file.as_str()).collect();
        assert_eq!(places, ["a/b/c.rs", "a/b.rs"]);
    }

    #[test]
    fn lines_are_named_by_file_and_number() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("a")).unwrap();
        let text = "fn f(x: f64) -> f64 {\n    x + 1.0\n}\nfn g(x: f64) -> f64 {\n    -x\n}\n";
        std::fs::write(folder.path().join("a/b.rs"), text).unwrap();
        let mut found = Vec::new();
        find(folder.path(), "a", &mut found).unwrap();
        let of_f = at(found.clone(), &["a/b.rs:2"]).unwrap();
        assert_eq!(of_f.iter().map(|m| &m.new[..]).collect::<Vec<_>>(), ["x - 1.0", "1.5"]);
        assert_eq!(at(found.clone(), &["a/b.rs:5", "a/b.rs:2"]).unwrap().len(), 3);
        let error = at(found, &["a/b.rs:2", "a/b.rs:3"]).unwrap_err().to_string();
        assert!(error.starts_with("--at a/b.rs:3: no mutants there"), "{error}");
    }
}
