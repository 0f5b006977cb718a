//! The public functions of the library: of its public modules, and the methods of their types.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result};
use syn::{Attribute, ImplItem, Item, ItemMod, Type, UseTree, Visibility};

/// A public function, or a method of a public type.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Function {
    /// The public module: `screws`, `model::catalogue`.
    module: String,
    /// The type whose method it is.
    pub(crate) of: Option<String>,
    pub(crate) name: String,
}

impl Function {
    /// `screws::ScrewSystem::order`.
    pub(crate) fn path(&self) -> String {
        let of = self.of.as_ref().map_or_else(String::new, |of| format!("{of}::"));
        format!("{}::{of}{}", self.module, self.name)
    }
}

/// The public names of a module: those it defines, and those it takes from its private modules.
#[derive(Debug)]
struct PublicModule {
    path: String,
    names: BTreeSet<String>,
}

/// A function or method as a file defines it.
#[derive(Debug)]
struct Definition {
    /// The modules of the file from the root.
    modules: Vec<String>,
    of: Option<String>,
    name: String,
}

/// All of them, sorted. A name that two public modules have belongs to the one below which it is
/// defined.
///
/// # Errors
/// Files that are missing or cannot be parsed.
pub(crate) fn public_functions(source: &Path) -> Result<Vec<Function>> {
    let mut walk = Walk::default();
    let root = parse(&source.join("lib.rs"))?;
    walk.module(&root.items, source, &[], true)?;
    let mut found = BTreeSet::new();
    for Definition { modules, of, name } in &walk.definitions {
        let public = of.as_ref().unwrap_or(name);
        let place = modules.join("::");
        let inside =
            |m: &&PublicModule| place == m.path || place.starts_with(&format!("{}::", m.path));
        let having = || walk.public.iter().filter(|m| m.names.contains(public));
        // Methods may be defined in other modules than their type.
        let home = having()
            .filter(inside)
            .max_by_key(|m| m.path.len())
            .or_else(|| of.as_ref().and_then(|_| having().next()));
        if let Some(home) = home {
            let module = home.path.clone();
            found.insert(Function { module, of: of.clone(), name: name.clone() });
        }
    }
    Ok(found.into_iter().collect())
}

#[derive(Debug, Default)]
struct Walk {
    public: Vec<PublicModule>,
    definitions: Vec<Definition>,
}

impl Walk {
    /// Reads a module; `folder` is where its submodules lie.
    fn module(
        &mut self,
        items: &[Item],
        folder: &Path,
        modules: &[String],
        public: bool,
    ) -> Result<()> {
        let mut names = BTreeSet::new();
        for item in items {
            match item {
                Item::Mod(item) if !is_test(&item.attrs) => {
                    let public = public && is_public(&item.vis);
                    self.submodule(item, folder, modules, public)?;
                }
                Item::Use(item) if is_public(&item.vis) => used(&item.tree, &mut names),
                Item::Struct(item) if is_public(&item.vis) => {
                    names.insert(item.ident.to_string());
                }
                Item::Enum(item) if is_public(&item.vis) => {
                    names.insert(item.ident.to_string());
                }
                Item::Fn(item) if is_public(&item.vis) && !is_test(&item.attrs) => {
                    names.insert(item.sig.ident.to_string());
                    self.define(modules, None, item.sig.ident.to_string());
                }
                Item::Impl(item) if item.trait_.is_none() => {
                    let Type::Path(path) = &*item.self_ty else { continue };
                    let of = path.path.segments.last().map(|s| s.ident.to_string());
                    for member in &item.items {
                        let ImplItem::Fn(method) = member else { continue };
                        if is_public(&method.vis) {
                            self.define(modules, of.clone(), method.sig.ident.to_string());
                        }
                    }
                }
                _ => {}
            }
        }
        if public && !modules.is_empty() {
            self.public.push(PublicModule { path: modules.join("::"), names });
        }
        Ok(())
    }

    fn submodule(
        &mut self,
        item: &ItemMod,
        folder: &Path,
        modules: &[String],
        public: bool,
    ) -> Result<()> {
        let name = item.ident.to_string();
        let (inside, below) = (folder.join(&name), [modules, std::slice::from_ref(&name)].concat());
        if let Some((_, items)) = &item.content {
            return self.module(items, &inside, &below, public);
        }
        let file = folder.join(format!("{name}.rs"));
        let file = if file.is_file() { file } else { inside.join("mod.rs") };
        self.module(&parse(&file)?.items, &inside, &below, public)
    }

    fn define(&mut self, modules: &[String], of: Option<String>, name: String) {
        self.definitions.push(Definition { modules: modules.to_vec(), of, name });
    }
}

/// The names that a `use` declaration brings in.
fn used(tree: &UseTree, names: &mut BTreeSet<String>) {
    match tree {
        UseTree::Path(path) => used(&path.tree, names),
        UseTree::Group(group) => group.items.iter().for_each(|tree| used(tree, names)),
        UseTree::Name(name) => {
            names.insert(name.ident.to_string());
        }
        UseTree::Rename(rename) => {
            names.insert(rename.rename.to_string());
        }
        UseTree::Glob(_) => {}
    }
}

fn parse(file: &Path) -> Result<syn::File> {
    let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
    syn::parse_file(&text).with_context(|| file.display().to_string())
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// `#[cfg(test)]`, `#[cfg(doctest)]`, `#[cfg(fuzzing)]`.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return false };
        attribute.path().is_ident("cfg")
            && ["test", "doctest", "fuzzing"].contains(&list.tokens.to_string().as_str())
    })
}
