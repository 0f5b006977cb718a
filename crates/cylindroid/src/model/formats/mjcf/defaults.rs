//! Default classes of MJCF: the values of attributes missing in an element.
//!
//! Formula  own attribute, otherwise that of its `class` (or the nearest `childclass` above, or the
//!          outermost default), otherwise that of the enclosing class, outwards
//! Source   mujoco.readthedocs.io, Modeling, default settings
//! Checked  tests/formats/mjcf.rs::poses_*

use std::collections::BTreeMap;

use roxmltree::Node;

use super::attributes::used;
use super::files::Files;
use crate::error::{Error, Result};
use crate::model::formats::xml::Reader;
use crate::model::magnitude;

/// Default classes; the outermost is the first.
pub(super) struct Defaults<'d> {
    classes: Vec<Class<'d>>,
    /// The classes by name, of several with one name the first.
    index: BTreeMap<&'d str, usize>,
}

struct Class<'d> {
    name: &'d str,
    parent: Option<usize>,
    elements: Vec<Node<'d, 'd>>,
}

/// An element with its defaults.
#[derive(Clone)]
pub(super) struct Element<'d> {
    pub(super) node: Node<'d, 'd>,
    /// The elements searched for its attributes, nearest first.
    places: Vec<Node<'d, 'd>>,
}

impl<'d> Defaults<'d> {
    pub(super) fn read(files: &Files<'d>, reader: &mut Reader<'_>) -> Result<Self> {
        let main = Class { name: "main", parent: None, elements: Vec::new() };
        let mut defaults = Self { classes: vec![main], index: BTreeMap::new() };
        let root = files.children(files.main.root_element());
        let outermost = root.into_iter().filter(|n| n.has_tag_name("default"));
        // All outermost defaults are one class; each nested one is a class of its own.
        let mut stack: Vec<(Node<'d, 'd>, usize)> = outermost.map(|n| (n, 0)).collect();
        stack.reverse();
        while let Some((node, class)) = stack.pop() {
            reader.unread_attributes(node, &["class"]);
            if let (0, Some(name)) = (class, node.attribute("class")) {
                defaults.classes[0].name = name;
            }
            let mut nested = Vec::new();
            for child in files.children(node) {
                if child.has_tag_name("default") {
                    let name = reader.required(child, "class")?;
                    let parent = Some(class);
                    defaults.classes.push(Class { name, parent, elements: Vec::new() });
                    nested.push((child, defaults.classes.len() - 1));
                } else {
                    reader.unread_attributes(child, &used(child.tag_name().name()));
                    defaults.classes[class].elements.push(child);
                }
            }
            stack.extend(nested.into_iter().rev());
        }
        let names = defaults.classes.iter().enumerate().rev();
        defaults.index = names.map(|(i, class)| (class.name, i)).collect();
        Ok(defaults)
    }

    /// The index of a class.
    pub(super) fn class(
        &self,
        reader: &Reader<'_>,
        node: Node<'d, 'd>,
        attribute: &str,
    ) -> Result<Option<usize>> {
        let Some(name) = node.attribute(attribute) else { return Ok(None) };
        match self.index.get(name) {
            Some(&i) => Ok(Some(i)),
            None => {
                let known = self.classes.iter().map(|c| c.name);
                let unknown = Error::unknown("default class", name, known);
                Err(reader.refuse(node, attribute, unknown.to_string()))
            }
        }
    }

    /// An element with its defaults, given by elements of these names.
    pub(super) fn of(
        &self,
        reader: &Reader<'_>,
        node: Node<'d, 'd>,
        childclass: usize,
        names: &[&str],
    ) -> Result<Element<'d>> {
        let mut class = Some(self.class(reader, node, "class")?.unwrap_or(childclass));
        let mut places = vec![node];
        while let Some(i) = class {
            let here = self.classes[i].elements.iter().rev();
            places.extend(here.filter(|n| names.contains(&n.tag_name().name())));
            class = self.classes[i].parent;
        }
        Ok(Element { node, places })
    }
}

impl<'d> Element<'d> {
    /// The element alone, without defaults.
    pub(super) fn bare(node: Node<'d, 'd>) -> Self {
        Self { node, places: vec![node] }
    }

    /// The element that defines an attribute: itself, or a default.
    pub(super) fn source_element(&self, attribute: &str) -> Option<Node<'d, 'd>> {
        self.places.iter().find(|n| n.has_attribute(attribute)).copied()
    }

    /// The text of an attribute.
    pub(super) fn text(&self, attribute: &str) -> Option<&'d str> {
        self.source_element(attribute).and_then(|n| n.attribute(attribute)).map(str::trim)
    }

    /// An error at the value of an attribute.
    pub(super) fn refuse(&self, reader: &Reader<'_>, attribute: &str, message: String) -> Error {
        reader.refuse(self.source_element(attribute).unwrap_or(self.node), attribute, message)
    }

    /// The element that gives the numbers of an attribute: a blank one gives none.
    fn source_of_numbers(&self, attribute: &str) -> Option<Node<'d, 'd>> {
        let is_blank =
            |n: &Node<'_, '_>| n.attribute(attribute).is_none_or(|t| t.trim().is_empty());
        self.places.iter().find(|n| !is_blank(n)).copied()
    }

    /// Finite numbers, exactly as many as the attribute requires.
    pub(super) fn vector<const N: usize>(
        &self,
        reader: &Reader<'_>,
        attribute: &str,
    ) -> Result<Option<[f64; N]>> {
        self.source_of_numbers(attribute).map_or(Ok(None), |n| reader.vector::<N>(n, attribute))
    }

    /// A finite number.
    pub(super) fn number(&self, reader: &Reader<'_>, attribute: &str) -> Result<Option<f64>> {
        Ok(self.vector::<1>(reader, attribute)?.map(|[x]| x))
    }

    /// Finite numbers, `most` of them at most.
    pub(super) fn list(
        &self,
        reader: &Reader<'_>,
        attribute: &str,
        most: usize,
    ) -> Result<Option<Vec<f64>>> {
        let Some(node) = self.source_of_numbers(attribute) else { return Ok(None) };
        let list = reader.list(node, attribute)?;
        if let Some(count) = list.as_ref().map(Vec::len).filter(|count| *count > most) {
            let tag = node.tag_name().name();
            let message = format!("{attribute} of <{tag}> has {count} numbers, at most {most}");
            return Err(reader.refuse(node, attribute, message));
        }
        if let Some(fault) = list.as_ref().and_then(|list| magnitude::fault(list)) {
            let message = format!("{attribute} of <{}> {fault}", node.tag_name().name());
            return Err(reader.refuse(node, attribute, message));
        }
        Ok(list)
    }
}
