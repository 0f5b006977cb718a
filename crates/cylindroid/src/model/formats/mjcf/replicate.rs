//! `<replicate>` of MJCF: copies of what it contains, each displaced from the one before.
//!
//! Formula  rotation(i) = Rot(i euler), translation(i) = translation(i - 1) + rotation(i - 1) offset,
//!          i = 0 ... count - 1, translation(0) = 0; a copy's names end in sep and i, with as many
//!          digits as count has; a replicate inside another one appends its suffix first
//! Why so   what refers to a copied name (actuators, equality constraints, tendons, excluded
//!          contacts) is copied with it; an equality constraint between a copy and what is not
//!          copied with it is left out, as MuJoCo does
//! Fails    a count that is no integer, more than [`MOST_COPIES`] copied elements
//! Source   mujoco.readthedocs.io, XML reference, replicate
//! Checked  tests/formats/mjcf_copies.rs::copies_*

use std::rc::Rc;

use roxmltree::Node;

use super::Mjcf;
use super::attributes::used;
use super::copies::{Kind, Placed};
use super::defaults::Element;
use super::unique_name::Names;
use crate::error::Result;
use crate::spatial::{Pose, Vec3};

/// Elements that all `<replicate>` of a model write together.
const MOST_COPIES: usize = 100_000;

impl<'d> Mjcf<'d> {
    /// Names that are made up for bodies and joints without one are none that another has, nor a
    /// copy of another.
    pub(super) fn reserve_names(&mut self) -> Result<()> {
        let roots = self.files.children(self.files.main.root_element());
        let one: Rc<[Rc<str>]> = Rc::new(["".into()]);
        let worlds = roots.into_iter().filter(|n| n.has_tag_name("worldbody"));
        let mut stack: Vec<_> = worlds.map(|n| (n, Rc::clone(&one))).collect();
        let mut written = 0;
        while let Some((node, suffixes)) = stack.pop() {
            let kind = match node.tag_name().name() {
                "body" => Some(Kind::Body),
                "joint" | "freejoint" => Some(Kind::Joint),
                "site" => Some(Kind::Site),
                _ => None,
            };
            if !Rc::ptr_eq(&suffixes, &one) {
                written += suffixes.len();
            }
            let mut below = suffixes;
            if node.has_tag_name("attach") {
                for (kind, name) in self.attached_names(node)? {
                    written += below.len();
                    self.reserve(kind, &name, &below);
                }
            }
            if let (Some(kind), Some(name)) = (kind, node.attribute("name").map(str::trim)) {
                self.reserve(kind, name, &below);
            }
            if node.has_tag_name("replicate") {
                let count = self.count_of(node)?;
                written = written.max(count.saturating_mul(below.len()));
                if written <= MOST_COPIES {
                    let own = self.suffixes_of(node, count);
                    let all = below.iter();
                    let all =
                        all.flat_map(|s| own.iter().map(move |own| format!("{own}{s}").into()));
                    below = all.collect();
                }
            }
            if written > MOST_COPIES {
                let message = format!("the copies exceed {MOST_COPIES} elements");
                return Err(self.reader.refuse(node, "count", message));
            }
            stack.extend(self.files.children(node).into_iter().map(|n| (n, Rc::clone(&below))));
        }
        Ok(())
    }

    /// Reserves the names of the copies of an element.
    fn reserve(&mut self, kind: Kind, name: &str, suffixes: &Rc<[Rc<str>]>) {
        let taken = match kind {
            Kind::Body => &mut self.link_names,
            Kind::Joint => &mut self.joint_names,
            Kind::Site => &mut Names::default(),
        };
        for suffix in suffixes.iter() {
            taken.insert(&format!("{name}{suffix}"));
        }
        if suffixes.iter().all(|s| !s.is_empty()) {
            self.copies.suffixes.insert((kind, name.to_owned()), Rc::clone(suffixes));
        }
    }

    fn count_of(&self, replicate: Node<'d, 'd>) -> Result<usize> {
        let text = self.reader.required(replicate, "count")?.trim();
        let count: i64 = text.parse().map_err(|_| {
            let message = format!("count of <replicate> is '{text}', not an integer");
            self.reader.refuse(replicate, "count", message)
        })?;
        Ok(usize::try_from(count).unwrap_or(0))
    }

    fn suffixes_of(&self, replicate: Node<'d, 'd>, count: usize) -> Vec<String> {
        let digits = count.to_string().len();
        let sep = replicate.attribute("sep").unwrap_or("");
        (0..count).map(|i| format!("{sep}{i:0digits$}")).collect()
    }

    /// The copies of a `<replicate>`: the pose, class and suffix of the contents of each.
    pub(super) fn replicas(&mut self, of: &Placed<'d>) -> Result<Vec<Placed<'d>>> {
        let node = of.node;
        self.reader.unread_attributes(node, &used("replicate"));
        let element = Element::bare(node);
        let offset = element.vector::<3>(&self.reader, "offset")?;
        let offset = offset.map_or(Vec3::ZERO, Vec3::from_array);
        let euler = element.vector::<3>(&self.reader, "euler")?.unwrap_or_default();
        let class = self.defaults.class(&self.reader, node, "childclass")?.unwrap_or(of.class);
        let joint = self
            .files
            .children(node)
            .into_iter()
            .find(|n| n.has_tag_name("joint") || n.has_tag_name("freejoint"));
        if let Some(joint) = joint {
            let message = "a joint is no direct child of <replicate>";
            return Err(self.reader.refuse(joint, "name", message));
        }
        let mut translation = Vec3::ZERO;
        let count = self.count_of(node)?;
        let suffixes = self.suffixes_of(node, count).into_iter();
        let copies = suffixes.enumerate().map(|(i, own)| {
            let rotation = self.compiler.euler(euler.map(|angle| angle * i as f64));
            let place = of.place * Pose { rotation, translation };
            translation += rotation * offset;
            let suffix = format!("{own}{}", of.suffix).into();
            Placed { node, place, class, suffix }
        });
        Ok(copies.collect())
    }

    /// The suffixes of the copies of a constraint, an actuator or an excluded contact; none with a
    /// note if it ties a copy to what is not copied with it.
    pub(super) fn copies_of(&mut self, node: Node<'d, 'd>) -> Vec<Rc<str>> {
        let by_tendon = node.attribute("tendon1").and_then(|t| self.couplings.tendon(t.trim()));
        let strict =
            by_tendon.is_none() && matches!(node.tag_name().name(), "connect" | "weld" | "joint");
        let mut names = Vec::new();
        let of_tendon = by_tendon.map(|t| self.files.children(t)).unwrap_or_default();
        for node in of_tendon.into_iter().chain([node]) {
            for (kind, attributes) in [
                (Kind::Body, ["body1", "body2"]),
                (Kind::Joint, ["joint1", "joint2"]),
                (Kind::Joint, ["joint", "jointinparent"]),
                (Kind::Site, ["site1", "site2"]),
            ] {
                let given = attributes.into_iter().filter_map(|a| node.attribute(a));
                names.extend(given.map(|name| (kind, name.trim())));
            }
        }
        let Some(copies) = self.copies.of(&names, strict) else {
            let what = format!("<{}> in <equality>", node.tag_name().name());
            let why = "it ties a copy to what is not copied with it; MuJoCo leaves it out";
            self.reader.unread_attributes(node, &used("equality"));
            self.reader.note(node, what, why, node.attribute("name").unwrap_or(""));
            return Vec::new();
        };
        copies
    }
}
