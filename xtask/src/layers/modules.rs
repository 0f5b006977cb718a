//! The modules of a Rust crate as its files declare them: items, `use` declarations, and every
//! path that the code mentions. Documentation, tests in the files and visibilities are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use proc_macro2::{Span, TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, Ident, Item, Meta, UseTree, Visibility};

use super::source::text_of;

/// A module: a file, or a part of one in braces.
#[derive(Debug, Default)]
pub(super) struct Module {
    /// Index of its file.
    pub(super) file: usize,
    pub(super) parent: Option<usize>,
    pub(super) children: BTreeMap<String, usize>,
    /// Names of what is defined here.
    pub(super) items: BTreeSet<String>,
    pub(super) uses: Vec<Use>,
    pub(super) mentions: Vec<Mention>,
}

/// One name of a `use` declaration.
#[derive(Debug)]
pub(super) struct Use {
    pub(super) path: Vec<String>,
    /// The name that it brings in; `None` for a glob.
    pub(super) name: Option<String>,
    /// Others may import the name from here.
    pub(super) visible: bool,
    pub(super) line: usize,
}

/// A path in the code.
#[derive(Debug)]
pub(super) struct Mention {
    pub(super) path: Vec<String>,
    pub(super) line: usize,
}

/// A crate. The first module is its root.
#[derive(Debug, Default)]
pub(super) struct Crate {
    pub(super) files: Vec<PathBuf>,
    pub(super) modules: Vec<Module>,
}

impl Crate {
    /// Reads a crate from its root file.
    ///
    /// # Errors
    /// Files that are missing or that `syn` cannot parse.
    pub(super) fn read(root: &Path) -> Result<Self> {
        let mut read = Self::default();
        read.add_file(root, root.with_file_name(""), None)?;
        Ok(read)
    }

    /// Adds the module of a file; `folder` is where its submodules lie.
    fn add_file(&mut self, file: &Path, folder: PathBuf, parent: Option<usize>) -> Result<usize> {
        let parsed =
            syn::parse_file(&text_of(file)?).with_context(|| file.display().to_string())?;
        self.files.push(file.to_owned());
        let module = self.add(Module { file: self.files.len() - 1, parent, ..Module::default() });
        let mut reader = Reader { read: self, module, folder, fault: None };
        reader.visit_file(&parsed);
        reader.fault.map_or(Ok(module), Err)
    }

    fn add(&mut self, module: Module) -> usize {
        self.modules.push(module);
        self.modules.len() - 1
    }
}

/// Fills one module, and those below it.
struct Reader<'a> {
    read: &'a mut Crate,
    module: usize,
    folder: PathBuf,
    fault: Option<anyhow::Error>,
}

impl Reader<'_> {
    fn here(&mut self) -> &mut Module {
        &mut self.read.modules[self.module]
    }

    fn mention(&mut self, path: Vec<String>, span: Span) {
        let line = span.start().line;
        self.here().mentions.push(Mention { path, line });
    }

    /// A submodule: in braces, or in a file of its own.
    fn submodule(&mut self, item: &syn::ItemMod) -> Result<usize> {
        let name = item.ident.to_string();
        let folder = self.folder.join(&name);
        if let Some((_, items)) = &item.content {
            let file = self.here().file;
            let parent = Some(self.module);
            let module = self.read.add(Module { file, parent, ..Module::default() });
            let mut reader = Reader { read: self.read, module, folder, fault: None };
            for item in items {
                reader.visit_item(item);
            }
            return reader.fault.map_or(Ok(module), Err);
        }
        let files = [self.folder.join(format!("{name}.rs")), folder.join("mod.rs")];
        let Some(file) = files.iter().find(|file| file.is_file()) else {
            bail!("module '{name}': neither {} nor {}", files[0].display(), files[1].display());
        };
        self.read.add_file(file, folder, Some(self.module))
    }

    fn import(&mut self, tree: &UseTree, before: &[String], visible: bool) {
        let mut path = before.to_vec();
        let (ident, name) = match tree {
            UseTree::Path(inner) => {
                path.push(inner.ident.to_string());
                return self.import(&inner.tree, &path, visible);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.import(tree, before, visible));
            }
            UseTree::Glob(glob) => {
                let line = glob.star_token.spans[0].start().line;
                return self.here().uses.push(Use { path, name: None, visible, line });
            }
            UseTree::Name(name) => (&name.ident, &name.ident),
            UseTree::Rename(rename) => (&rename.ident, &rename.rename),
        };
        let line = ident.span().start().line;
        if ident != "self" {
            path.push(ident.to_string());
        }
        let name = if name == "self" { path.last().cloned() } else { Some(name.to_string()) };
        self.here().uses.push(Use { path, name, visible, line });
    }

    /// The paths in tokens that `syn` does not parse: arguments of macros and attributes.
    fn scan(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut span = Span::call_site();
        let mut colons = 0;
        let mut after_dot = false;
        for token in tokens {
            match &token {
                TokenTree::Ident(ident) => {
                    if colons != 2 || path.is_empty() {
                        self.scanned(&mut path, span);
                        span = ident.span();
                    }
                    if !after_dot {
                        path.push(ident.to_string());
                    }
                    colons = 0;
                    after_dot = false;
                    continue;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => {
                    colons += 1;
                    continue;
                }
                TokenTree::Punct(punct) => after_dot = punct.as_char() == '.',
                TokenTree::Group(group) => {
                    self.scanned(&mut path, span);
                    self.scan(group.stream());
                    after_dot = false;
                }
                TokenTree::Literal(literal) => {
                    // `#[serde(with = "super::module")]`
                    let text = literal.to_string();
                    let quoted = text.trim_matches('"');
                    if quoted.len() + 2 == text.len()
                        && quoted.contains("::")
                        && let Ok(quoted) = syn::parse_str::<syn::Path>(quoted)
                    {
                        self.mention(names(&quoted), literal.span());
                    }
                    after_dot = false;
                }
            }
            self.scanned(&mut path, span);
            colons = 0;
        }
        self.scanned(&mut path, span);
    }

    fn scanned(&mut self, path: &mut Vec<String>, span: Span) {
        if !path.is_empty() {
            let path = std::mem::take(path);
            self.mention(path, span);
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let (attributes, name) = parts(item);
        if attributes.iter().any(is_test) {
            return;
        }
        if let (Some(name), false) = (name, matches!(item, Item::Mod(_))) {
            self.here().items.insert(name.to_string());
        }
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        match self.submodule(item) {
            Ok(child) => {
                self.here().children.insert(item.ident.to_string(), child);
            }
            Err(fault) => self.fault = self.fault.take().or(Some(fault)),
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if item.leading_colon.is_none() {
            self.import(&item.tree, &[], !matches!(item.vis, Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if let (None, Some(first)) = (path.leading_colon, path.segments.first()) {
            self.mention(names(path), first.ident.span());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.visit_path(&call.path);
        self.scan(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let Meta::List(list) = &attribute.meta {
            self.scan(list.tokens.clone());
        }
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

fn names(path: &syn::Path) -> Vec<String> {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}

/// `#[test]`, `#[cfg(test)]`, `#[cfg(all(test, ...))]`, `#[cfg(fuzzing)]`.
fn is_test(attribute: &Attribute) -> bool {
    let Meta::List(list) = &attribute.meta else {
        return attribute.path().is_ident("test");
    };
    attribute.path().is_ident("cfg")
        && list
            .tokens
            .to_string()
            .split(|c: char| !c.is_alphanumeric())
            .any(|word| ["test", "fuzzing"].contains(&word))
        && !list.tokens.to_string().contains("not")
}

/// Attributes and name of an item.
fn parts(item: &Item) -> (&[Attribute], Option<&Ident>) {
    match item {
        Item::Const(item) => (&item.attrs, Some(&item.ident)),
        Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        Item::Mod(item) => (&item.attrs, Some(&item.ident)),
        Item::Static(item) => (&item.attrs, Some(&item.ident)),
        Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        Item::TraitAlias(item) => (&item.attrs, Some(&item.ident)),
        Item::Type(item) => (&item.attrs, Some(&item.ident)),
        Item::Union(item) => (&item.attrs, Some(&item.ident)),
        Item::Impl(item) => (&item.attrs, None),
        Item::Use(item) => (&item.attrs, None),
        _ => (&[], None),
    }
}
