//! `<attach>` of MJCF: a body of another model with all that it carries, or another model whole.
//!
//! Formula  names are prefix + name + the suffix of enclosing copies; the body keeps its pose, now
//!          in the frame of `<attach>`
//! Why so   the other model is read by itself, with its own settings and default classes. Its
//!          constraints, actuators and excluded contacts come along if all their bodies do, as in
//!          MuJoCo; its key frames do not
//! Fails    more than [`MOST_MODELS`] models, or [`DEEPEST_MODEL`] of them inside one another; more than
//!          [`MOST_SHAPES`] attached shapes
//! Source   mujoco.readthedocs.io, XML reference, attach, asset/model
//! Checked  tests/formats/mjcf_copies.rs::attached_*

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use roxmltree::Node;

use super::Mjcf;
use super::attributes::used;
use super::copies::{Kind, Placed};
use super::files;
use super::part::{ByLink, Nesting, Part, Subtree, report_of_parts};
use crate::error::{Error, Result, shown};
use crate::model::formats::text_file;
use crate::model::{Collision, JointKind, Link, LoadReport, LoopJointSpec, Visual};
use crate::spatial::{Pose, Rotation, Vec3};

const MOST_MODELS: usize = 100;
const DEEPEST_MODEL: usize = 10;
/// Shapes that all `<attach>` of a model bring.
const MOST_SHAPES: usize = 200_000;

impl<'d> Mjcf<'d> {
    /// Reads the models that this one may attach.
    pub(super) fn parts(&mut self, nesting: Nesting<'_>) -> Result<()> {
        for node in self.files.section("asset").into_iter().filter(|n| n.has_tag_name("model")) {
            self.reader.unread_attributes(node, &used("model"));
            let file = self.reader.required(node, "file")?.trim();
            let refuse = |message: String| Err(self.reader.refuse(node, "file", message));
            nesting.models.set(nesting.models.get() + 1);
            if nesting.models.get() > MOST_MODELS || nesting.depth >= DEEPEST_MODEL {
                return refuse(format!(
                    "models attach more than {MOST_MODELS} models, or {DEEPEST_MODEL} inside one \
                     another"
                ));
            }
            let path = files::beside(self.reader.source.path, self.reader.path_of(node), file);
            let text = match text_file::read(&path) {
                Ok(file) => {
                    if let Some((line, what, why)) = file.note() {
                        let what = format!("{what} in {}, line {line}", shown(&path));
                        self.reader.note(node, what, why, "");
                    }
                    file.text
                }
                Err(Error::Io { path, message, .. }) => {
                    return refuse(format!("cannot read {}: {message}", shown(&path)));
                }
                Err(error) => return Err(error),
            };
            if let Err(message) = nesting.together.count_text(&text) {
                return Err(self.reader.refuse(node, "file", message));
            }
            let inner = Nesting { depth: nesting.depth + 1, ..nesting };
            let part = super::with_model(&text, &path, inner, |it, _| Ok(it.into_part()))?;
            let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned());
            let name = node.attribute("name").map(|n| n.trim().to_owned()).or(stem);
            self.attachable.insert(name.unwrap_or_default(), Rc::new(part));
        }
        Ok(())
    }

    fn into_part(mut self) -> Part {
        if self.files.section("actuator").is_empty() && !self.has_attached_actuators {
            // All joints are actuated only if the model that attaches this one has no actuator.
            self.joints.iter_mut().for_each(|j| j.actuated = false);
        }
        let mut starts: BTreeMap<String, Vec<Vec<f64>>> = BTreeMap::new();
        for (joint, q) in self.starts {
            starts.entry(joint).or_default().push(q);
        }
        let mut report = LoadReport::default();
        self.reader.report(&self.files.roots(), &mut report);
        report_of_parts(&self.attachable, &mut report);
        Part {
            by_link: ByLink::of(
                &self.links,
                &self.sites,
                &self.disabled_collisions,
                &self.loops,
                &self.first_joint,
            ),
            links: self.links,
            joints: self.joints,
            loops: self.loops,
            sums: self.sums,
            disabled_collisions: self.disabled_collisions,
            sites: self.sites,
            starts,
            world: self.world,
            first_joint: self.first_joint,
            path: self.reader.source.path.to_owned(),
            report,
        }
    }

    /// The part that an `<attach>` brings, its subtree, and the prefix of its names.
    fn part_of(&self, node: Node<'d, 'd>) -> Result<(Rc<Part>, Subtree, &'d str)> {
        let model = self.reader.required(node, "model")?.trim();
        let Some(part) = self.attachable.get(model) else {
            let unknown = Error::unknown("model", model, self.attachable.keys());
            return Err(self.reader.refuse(node, "model", unknown.to_string()));
        };
        let body = node.attribute("body").map(str::trim).filter(|b| !b.is_empty());
        let Some(tree) = part.subtree(body) else {
            let known = part.first_joint.keys();
            let unknown = Error::unknown("body", body.unwrap_or(""), known);
            return Err(self.reader.refuse(node, "body", unknown.to_string()));
        };
        Ok((Rc::clone(part), tree, node.attribute("prefix").map_or("", str::trim)))
    }

    /// The names that an `<attach>` brings, without the suffix of a copy.
    pub(super) fn attached_names(&self, node: Node<'d, 'd>) -> Result<Vec<(Kind, String)>> {
        let (part, tree, prefix) = self.part_of(node)?;
        let joints = part.joints[tree.joints.clone()].iter().map(|j| (Kind::Joint, &j.name));
        let sites = tree.sites(&part).into_iter().map(|i| (Kind::Site, &part.sites[i].0));
        let all = tree.links.iter().map(|l| (Kind::Body, l)).chain(joints).chain(sites);
        Ok(all.map(|(kind, name)| (kind, format!("{prefix}{name}"))).collect())
    }

    /// Attaches a part to a link.
    pub(super) fn attach(&mut self, placed: &Placed<'d>, parent: &str) -> Result<()> {
        let (node, place) = (placed.node, placed.place);
        self.reader.unread_attributes(node, &used("attach"));
        let (part, tree, prefix) = self.part_of(node)?;
        let name = |own: &str| format!("{prefix}{own}{}", placed.suffix);
        self.reader.check_links(node, self.links.len() + tree.links.len())?;
        self.attached_shapes += tree.shapes(&part);
        if self.attached_shapes > MOST_SHAPES {
            let message = format!("the attached models have more than {MOST_SHAPES} shapes");
            return Err(self.reader.refuse(node, "model", message));
        }
        let joints = &part.joints[tree.joints.clone()];
        let own_joints: BTreeSet<&str> = joints.iter().map(|j| j.name.as_str()).collect();
        let first = self.joints.len();
        for (i, joint) in tree.joints.clone().zip(&part.joints[tree.joints.clone()]) {
            let mut own = joint.clone();
            own.name = name(&joint.name);
            (own.parent, own.child) = (name(&joint.parent), name(&joint.child));
            let is_new = self.given_joints.insert(own.name.clone());
            if !(is_new && self.given_bodies.insert(own.child.clone())) {
                let (a, b) = (&own.name, &own.child);
                let message = format!("there is a joint '{a}' or a body '{b}' already");
                return Err(self.reader.refuse(node, "prefix", message));
            }
            let is_free = own.kind == JointKind::Free;
            if tree.is_first(i, joint) {
                parent.clone_into(&mut own.parent);
                if is_free && parent != "world" {
                    let message =
                        format!("'{}' is a free joint, and '{parent}' not the world", own.name);
                    return Err(self.reader.refuse(node, "body", message));
                }
                if !is_free {
                    own.parent_from_joint = place * own.parent_from_joint;
                }
            }
            let mut others = part.sums.get(&joint.name).cloned().unwrap_or_default();
            let mut is_led = false;
            for mimic in own.mimic.iter_mut().chain(&mut others) {
                is_led |= !own_joints.contains(mimic.joint.as_str());
                mimic.joint = name(&mimic.joint);
            }
            if is_led {
                own.mimic = None;
                self.note_left_out(node);
            } else if !others.is_empty() {
                self.sums.insert(own.name.clone(), others);
            }
            self.has_attached_actuators |= own.actuated;
            for q in part.starts.get(&joint.name).into_iter().flatten() {
                let q = if is_free { moved(place, q) } else { q.clone() };
                self.starts.push((own.name.clone(), q));
            }
            self.joints.push(own);
        }
        for (index, body) in part.by_link.bodies.range(tree.joints.clone()) {
            self.first_joint.insert(name(body), first + index - tree.joints.start);
        }
        let at = |part: &Part, link: &str| part.world.get(link).copied().unwrap_or_default();
        let here = self.world.get(parent).copied().unwrap_or_default();
        let world_from_base = here * place * at(&part, &tree.base).inverse();
        for link in part.by_link.links.at(&tree.links).into_iter().map(|i| &part.links[i]) {
            let mut own = Link { name: name(&link.name), ..link.clone() };
            rename(&mut own.visuals, &mut own.collisions, &name);
            self.world.insert(own.name.clone(), world_from_base * at(&part, &link.name));
            self.links.push(own);
        }
        if tree.is_whole {
            self.attach_shapes(&part.links[0], parent, place, &name);
            let shapes = &part.links[0];
            if parent != "world" && !(shapes.visuals.is_empty() && shapes.collisions.is_empty()) {
                let why = "they are shapes of the body here, without mass";
                self.reader.note(node, "geoms of an attached world", why, parent);
            }
        }
        for (site, link, pose) in tree.sites(&part).into_iter().map(|i| &part.sites[i]) {
            if tree.links.contains(link) {
                self.sites.push((name(site), name(link), *pose));
            } else if tree.is_whole {
                self.sites.push((name(site), parent.to_owned(), place * *pose));
            }
        }
        let pairs = part.by_link.pairs.at(&tree.links);
        for pair in pairs.into_iter().map(|i| &part.disabled_collisions[i]) {
            if pair.iter().all(|link| tree.links.contains(link)) {
                self.disabled_collisions.push([name(&pair[0]), name(&pair[1])]);
            }
        }
        for joint in part.by_link.loops.at(&tree.links).into_iter().map(|i| &part.loops[i]) {
            let ends = [(&joint.a, joint.link_a_from_joint), (&joint.b, joint.link_b_from_joint)];
            let ends = ends.map(|(link, pose)| match tree.links.contains(link) {
                true => Some((name(link), pose)),
                false if tree.is_whole => Some((parent.to_owned(), place * pose)),
                false => (link == "world").then(|| (link.clone(), world_from_base * pose)),
            });
            let [Some((a, on_a)), Some((b, on_b))] = ends else {
                self.note_left_out(node);
                continue;
            };
            self.loops.push(LoopJointSpec {
                name: name(&joint.name),
                a,
                b,
                link_a_from_joint: on_a,
                link_b_from_joint: on_b,
                ..joint.clone()
            });
        }
        Ok(())
    }

    fn note_left_out(&mut self, node: Node<'d, 'd>) {
        let why = "it ties a body that is attached to one that is not; MuJoCo leaves it out";
        let model = node.attribute("model").unwrap_or("");
        self.reader.note(node, "<equality> of an attached model", why, model);
    }

    /// The shapes of an attached world.
    fn attach_shapes(
        &mut self,
        world: &Link,
        parent: &str,
        place: Pose,
        name: &impl Fn(&str) -> String,
    ) {
        let index = self.link_index.get(parent).copied().unwrap_or(0);
        let Some(link) = self.links.get_mut(index) else { return };
        let (mut visuals, mut collisions) = (world.visuals.clone(), world.collisions.clone());
        rename(&mut visuals, &mut collisions, name);
        for pose in visuals
            .iter_mut()
            .map(|v| &mut v.link_from_shape)
            .chain(collisions.iter_mut().map(|c| &mut c.link_from_shape))
        {
            *pose = place * *pose;
        }
        link.visuals.extend(visuals);
        link.collisions.extend(collisions);
    }
}

fn rename(visuals: &mut [Visual], collisions: &mut [Collision], name: &impl Fn(&str) -> String) {
    let names = visuals.iter_mut().map(|v| &mut v.name);
    for own in names.chain(collisions.iter_mut().map(|c| &mut c.name)).filter(|n| !n.is_empty()) {
        *own = name(own);
    }
}

/// The coordinates of a free body whose world is placed in another one.
fn moved(place: Pose, q: &[f64]) -> Vec<f64> {
    let [x, y, z, a, b, c] = *q else { return q.to_vec() };
    let rotation = Rotation::exp(Vec3::new(a, b, c));
    let pose = place * Pose { rotation, translation: Vec3::new(x, y, z) };
    [pose.translation.to_array(), pose.rotation.log().to_array()].concat()
}
