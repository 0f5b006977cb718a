//! The default tool: the frame that a file means by its name, otherwise the end of the longest
//! chain.
//!
//! Names    the words of a name (`left/gripper_site`, `handTcp`, `tool0`) are compared with groups of
//!          words, best first (`GROUPS`). Names that also contain a word for a sensor, a finger or a
//!          marker do not count, nor do frames moved by fewer than half of the moving joints of the
//!          longest chain (three quarters for feet): objects in the scene, mounts
//! Beyond   nor do frames in the middle of a chain, beyond whose body a joint moves (`flange1`, tool
//!          changers), other than a finger: a joint or link with a word for one, one of several
//!          branches that are shorter than the chain before them, or the rest of a loop
//! Among    frames of one group: fewest other words, most moving joints, sites before links, most
//!          joints, fewest words, the last in the file
//! Loops    joints that close one do not count
//! Chain    without such a name: the branch with the most moving joints at every fork, until its rest
//!          is shorter than the chain before it (fingers of a hand), then the last link fixed there
//!          that is no sensor. Floating bases count as moving joints if nothing else moves
//! Why so   files name no tool, and the last link is a finger, an IMU or a pelvis in half of the 313
//!          files with joints of the corpus (`cargo xtask corpus`)
//! Checked  tests/formats/tool.rs

use std::collections::{BTreeMap, BTreeSet};

use super::joint::JointKind;
use super::joint_spec::JointSpec;
use super::loop_joint::LoopJointSpec;
use super::mechanism::{Frame, Mechanism};
use super::natural_order::Natural;
use super::tool_choice::ToolChoice;
use super::tree_order::TreeOrder;

/// Words of frames that are meant, best first.
const GROUPS: [&[&str]; 8] = [
    &["tcp"],
    GRIPS,
    &["tool"],
    &["ee", "eef", "effector", "endeffector"],
    &["gripper"],
    &["hand", "palm"],
    &["flange", "attachment"],
    FEET,
];
const GRIPS: &[&str] = &["grasp", "grasping", "grip", "gripsite", "pinch", "pinchsite"];
const FEET: &[&str] = &["foot", "toe"];

/// Words that add nothing to one of them.
const NEUTRAL: [&str; 8] = ["base", "body", "center", "end", "frame", "link", "point", "site"];

/// Words of sensors and markers.
const SENSORS: [&str; 23] = [
    "accelerometer",
    "cam",
    "camera",
    "collision",
    "depth",
    "eye",
    "force",
    "ft",
    "goal",
    "gyro",
    "imu",
    "inertia",
    "inertial",
    "laser",
    "led",
    "lidar",
    "marker",
    "optical",
    "range",
    "sensor",
    "target",
    "torque",
    "touch",
];

/// Words of the parts of hands that move.
const FINGERS: [&str; 9] =
    ["finger", "fingers", "fingertip", "jaw", "knuckle", "mover", "pad", "pinky", "thumb"];

/// Words of joints that move a whole gripper.
const ROTATIONS: [&str; 7] = ["pitch", "roll", "rotate", "rotation", "turn", "wrist", "yaw"];

/// Words of other parts of hands, and of markers that show axes.
const PARTS: [&str; 11] =
    ["handle", "index", "little", "middle", "motor", "ring", "safety", "virtual", "x", "y", "z"];

/// The default tool: a frame, and why.
pub(super) struct DefaultTool<'a> {
    pub(super) order: &'a TreeOrder,
    pub(super) joints: &'a [JointSpec],
    pub(super) loops: &'a [LoopJointSpec],
    /// Links that are halves of others: what closes a loop does not lengthen a chain.
    pub(super) halves: &'a BTreeSet<String>,
    pub(super) links: &'a BTreeMap<String, usize>,
    /// Links first, then named frames.
    pub(super) frames: &'a [Frame],
    /// Of frames that are alike the last one counts, in the order given or by name.
    pub(super) by_name: bool,
}

/// Joints above and below the links.
struct Depths {
    /// True for the joints that count as moving.
    moves: Vec<bool>,
    /// The joints that leave a link: index and child.
    children: Vec<Vec<(usize, usize)>>,
    /// Moving joints, and all joints, between root and link.
    above: Vec<(usize, usize)>,
    /// Moving joints of the longest chain below a link, and the rank of its end.
    below: Vec<(usize, usize)>,
    /// The first link of the rigid body of a link.
    bodies: Vec<usize>,
    /// The moving joints that leave the body of its first link: index and child.
    beyond: Vec<Vec<(usize, usize)>>,
}

impl DefaultTool<'_> {
    /// The index of the frame.
    pub(super) fn choose(&self) -> (usize, ToolChoice) {
        let ranks = self.ranks();
        let depths = self.depths(&ranks);
        let loops = Loops::of(self);
        let mut ends = vec![None; self.links.len()];
        let longest = depths.above.iter().map(|d| d.0).max().unwrap_or(0);
        let whole = |frame: &Frame| !self.halves.contains(&self.frames[frame.link].name);
        let all = self.frames.iter().enumerate().filter(|(_, frame)| whole(frame));
        let named = all.filter_map(|(i, frame)| {
            let meaning = Meaning::of(&frame.name)?;
            let (moving, all) = depths.above[frame.link];
            let enough = if meaning.word == FEET[0] || meaning.word == FEET[1] {
                4 * moving >= 3 * longest
            } else {
                2 * moving >= longest
            };
            if moving == 0 || !enough {
                return None;
            }
            let body = depths.bodies[frame.link];
            let is_last = || self.ends_a_chain(body, &depths, &loops);
            if !*ends[body].get_or_insert_with(is_last) {
                return None;
            }
            let few = usize::MAX;
            let Meaning { group, others, words, word } = meaning;
            let site = i >= self.links.len();
            let key = (few - group, few - others, moving, site, all, few - words, ranks[i]);
            Some((key, i, word))
        });
        match named.max_by_key(|(key, ..)| *key) {
            Some((_, frame, word)) => (frame, ToolChoice::Word(word)),
            None => self.end_of_chain(&depths, &ranks),
        }
    }

    /// Places of the frames in the order that decides between frames that are alike.
    fn ranks(&self) -> Vec<usize> {
        let mut ranks: Vec<usize> = (0..self.frames.len()).collect();
        if self.by_name {
            let mut sorted = ranks.clone();
            sorted.sort_by_key(|&i| Natural(&self.frames[i].name));
            sorted.iter().enumerate().for_each(|(rank, &i)| ranks[i] = rank);
        }
        ranks
    }

    fn depths(&self, ranks: &[usize]) -> Depths {
        let moving = |joint: &JointSpec| joint.kind.dof() > 0 && joint.kind != JointKind::Free;
        let moves: Vec<bool> = if self.joints.iter().any(moving) {
            self.joints.iter().map(moving).collect()
        } else {
            self.joints.iter().map(|j| j.kind.dof() > 0).collect()
        };
        let n = self.links.len();
        let mut depths = Depths {
            moves,
            children: vec![Vec::new(); n],
            above: vec![(0, 0); n],
            below: (0..n).map(|l| (0, ranks[l])).collect(),
            bodies: (0..n).collect(),
            beyond: vec![Vec::new(); n],
        };
        for j in self.joints_of_chains() {
            let (parent, child) = self.ends(j);
            depths.children[parent].push((j, child));
            let body = depths.bodies[parent];
            if depths.moves[j] {
                depths.beyond[body].push((j, child));
            } else if self.joints[j].kind.dof() == 0 {
                depths.bodies[child] = body;
            }
            let (moving, all) = depths.above[parent];
            depths.above[child] = (moving + usize::from(depths.moves[j]), all + 1);
        }
        for j in self.joints_of_chains().rev() {
            let (parent, child) = self.ends(j);
            let (moving, end) = depths.below[child];
            let through = (moving + usize::from(depths.moves[j]), end);
            if through.0 > 0 {
                depths.below[parent] = depths.below[parent].max(through);
            }
        }
        depths
    }

    /// The joints of the tree without those of halves, parents first.
    fn joints_of_chains(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        let all = self.order.joints.iter().copied();
        all.filter(|&j| !self.halves.contains(&self.joints[j].child))
    }

    /// Parent and child of a joint.
    fn ends(&self, j: usize) -> (usize, usize) {
        let joint = &self.joints[j];
        (self.links[&joint.parent], self.links[&joint.child])
    }

    /// False if a joint moves beyond the body of this first link that belongs neither to a gripper nor to
    /// a loop through the body.
    fn ends_a_chain(&self, body: usize, depths: &Depths, loops: &Loops) -> bool {
        let beyond = &depths.beyond[body];
        beyond.iter().all(|&(j, child)| {
            let length = 1 + depths.below[child].0;
            let in_a_hand = beyond.len() > 1 && length < depths.above[body].0;
            in_a_hand || loops.pass(body, child) || self.is_finger(j, length)
        })
    }

    /// True if the names of a joint and its link are those of a finger, or of the toes of a foot, or
    /// if the joint is the last one and drives a gripper instead of rotating it.
    fn is_finger(&self, joint: usize, length: usize) -> bool {
        let JointSpec { name, child, .. } = &self.joints[joint];
        let part = |w: String| FINGERS.contains(&w.as_str()) || FEET.contains(&w.as_str());
        let grips = |w: String| w == "gripper" || GRIPS.contains(&w.as_str());
        let rotates = |w: String| ROTATIONS.contains(&w.as_str());
        words(name).chain(words(child)).any(part)
            || (length == 1 && words(name).any(grips) && !words(name).any(rotates))
    }

    fn end_of_chain(&self, depths: &Depths, ranks: &[usize]) -> (usize, ToolChoice) {
        let length = |&(j, child): &(usize, usize)| {
            let (moving, end) = depths.below[child];
            (moving + usize::from(depths.moves[j]), end)
        };
        let (mut link, mut moved, mut only) = (self.order.root, 0, true);
        loop {
            let branches = || depths.children[link].iter().filter(|b| length(b).0 > 0);
            let Some(&next) = branches().max_by_key(|b| length(b)) else { break };
            if branches().nth(1).is_some() {
                if length(&next).0 < moved {
                    break;
                }
                only = false;
            }
            moved += usize::from(depths.moves[next.0]);
            link = next.1;
        }
        loop {
            let fixed = depths.children[link]
                .iter()
                .enumerate()
                .filter(|(_, b)| length(b).0 == 0 && self.joints[b.0].kind != JointKind::Free);
            let fixed = fixed.filter(|(_, (_, child))| {
                let name = &self.frames[*child].name;
                !words(name).any(|w| SENSORS.contains(&w.as_str()))
            });
            let rank = |place: usize, l: usize| if self.by_name { ranks[l] } else { place };
            let last = fixed.max_by_key(|(place, (_, child))| rank(*place, *child));
            let Some((_, &(_, child))) = last else { break };
            link = child;
        }
        let choice = if only { ToolChoice::OnlyChain } else { ToolChoice::LongestChain };
        (link, choice(moved))
    }
}

/// The loops of a closed chain.
struct Loops {
    /// First and last place in the depth-first order of the links below a link, itself included.
    places: Vec<(usize, usize)>,
    /// First and last place of the links that loop joints connect with them.
    partners: Vec<(usize, usize)>,
}

impl Loops {
    fn of(tool: &DefaultTool<'_>) -> Self {
        let n = tool.links.len();
        let mut loops = Self { places: vec![(0, 0); n], partners: vec![(usize::MAX, 0); n] };
        for (place, &j) in tool.order.joints.iter().enumerate() {
            loops.places[tool.ends(j).1] = (place + 1, place + 1);
        }
        for joint in tool.loops {
            // A loop joint on an unknown link is refused elsewhere.
            let (Some(&a), Some(&b)) = (tool.links.get(&joint.a), tool.links.get(&joint.b)) else {
                continue;
            };
            for (link, other) in [(a, b), (b, a)] {
                let (first, last) = loops.partners[link];
                let place = loops.places[other].0;
                loops.partners[link] = (first.min(place), last.max(place));
            }
        }
        for &j in tool.order.joints.iter().rev() {
            let (parent, child) = tool.ends(j);
            for range in [&mut loops.places, &mut loops.partners] {
                let (first, last) = range[child];
                range[parent] = (range[parent].0.min(first), range[parent].1.max(last));
            }
        }
        loops
    }

    /// True if a loop goes through a body and this branch that leaves it.
    fn pass(&self, body: usize, branch: usize) -> bool {
        let (first, last) = self.partners[branch];
        first < self.places[body].0 || last > self.places[body].1
    }
}

/// What the name of a frame says.
struct Meaning {
    /// Index of the group of its best word.
    group: usize,
    word: &'static str,
    /// Number of words that belong to no group and are not neutral.
    others: usize,
    words: usize,
}

impl Meaning {
    fn of(name: &str) -> Option<Self> {
        let mut best: Option<(usize, &'static str)> = None;
        let (mut others, mut count) = (0, 0);
        for word in words(name) {
            let word = word.as_str();
            if [&SENSORS[..], &FINGERS, &PARTS].iter().any(|words| words.contains(&word)) {
                return None;
            }
            let group = GROUPS
                .iter()
                .enumerate()
                .find_map(|(group, of)| of.iter().find(|w| **w == word).map(|w| (group, *w)));
            count += 1;
            match group {
                Some(found) => {
                    best = Some(best.map_or(found, |b| if b.0 <= found.0 { b } else { found }))
                }
                None => others += usize::from(!NEUTRAL.contains(&word)),
            }
        }
        best.map(|(group, word)| Self { group, word, others, words: count })
    }
}

/// The words of a name in lower case: runs of letters, divided before a capital that follows a small
/// letter.
fn words(name: &str) -> impl Iterator<Item = String> + '_ {
    name.split(|c: char| !c.is_alphabetic()).flat_map(|run| {
        let mut words = vec![String::new()];
        let mut small = false;
        for c in run.chars() {
            if small && c.is_uppercase() {
                words.push(String::new());
            }
            small = c.is_lowercase();
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        words.into_iter().filter(|w| !w.is_empty())
    })
}

impl Mechanism {
    /// The reason why [`Mechanism::tool`] is the default frame.
    ///
    /// ```
    /// use cylindroid::model::ToolChoice;
    ///
    /// let panda = cylindroid::load("panda")?;
    /// assert_eq!(panda.tool_choice(), ToolChoice::Named);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    #[must_use]
    pub fn tool_choice(&self) -> ToolChoice {
        self.data.tool_choice
    }
}
