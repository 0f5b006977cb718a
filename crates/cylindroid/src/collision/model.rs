//! Distances of the links of a mechanism, to one another and to obstacles.
//!
//! Formula  all pairs whose bounding balls are nearer than the margin are evaluated;
//!          d distance / dt = normal . (velocity of b at point_b - velocity of a at point_a)
//! Shapes   a gradient row has n entries
//! Units    m, m/rad
//! Frame    world
//! Valid    the gradient is that of the distance wherever closest points and normal are unique
//! Why so   pairs of convex shapes, not of links: a link of two parts can be near with both, and the
//!          gradient of either is continuous where that of the smaller distance jumps. No memory is
//!          allocated once the output and the scratch memory of penetrations have their size
//! Checked  tests/collision/laws.rs, tests/collision/gradient.rs, tests/allocation/main.rs

use super::body::{self, Body};
use super::convex::{Convex, Core};
use super::gradient::{gradient_and_moving_into, gradient_into};
use super::options::CollisionOptions;
use super::pairs;
use super::sampling::drop_constant;
use super::scene::{NearPair, Pair, Scene};
use super::way::{levers_into, way};
use crate::error::{Error, Result};
use crate::kinematics::State;
use crate::model::{Geometry, Ignored, Mechanism};
use crate::spatial::Pose;

/// The shapes of a mechanism and of obstacles, and the pairs of them that are watched.
#[doc(alias = "self-collision")]
#[derive(Debug, Clone)]
pub struct CollisionModel {
    mechanism: Mechanism,
    scene: Scene,
    /// Number of bodies of links, which come before those of obstacles.
    links: usize,
    ignored: Vec<Ignored>,
    /// Of the obstacles: from the pose that the user gives to that of the core.
    shape_from_body: Vec<Pose>,
    /// Number of changes of the obstacles so far.
    revision: u64,
}

impl CollisionModel {
    /// The collision shapes of all links, without obstacles.
    ///
    /// Pairs on one rigid body, on bodies that a joint connects (other than a free one) or that are
    /// in contact, and pairs of [`CollisionOptions::disabled`] are not watched, nor those that
    /// always or never touch ([`CollisionOptions::samples`]).
    ///
    /// ```
    /// use cylindroid::collision::{CollisionModel, CollisionOptions};
    /// use cylindroid::model::Geometry;
    /// use cylindroid::{Pose, Vec3};
    ///
    /// let robot = cylindroid::load("panda")?;
    /// let mut model = CollisionModel::new(&robot, &CollisionOptions::default())?;
    /// let ball = Geometry::Sphere { radius: 0.1 };
    /// model.add_obstacle("ball", &ball, Pose::from_translation(Vec3::new(0.5, 0.0, 0.6)))?;
    ///
    /// let state = robot.state(robot.home())?;
    /// let mut near = Vec::new();
    /// model.near(&state, 0.3, &mut near)?;
    /// for pair in &near {
    ///     let [a, b] = model.names(pair.pair);
    ///     println!("{a} is {} m from {b}", pair.distance);
    /// }
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::InvalidOption`] for a margin that is not finite, and for more than four million pairs of
    /// shapes that could collide.
    pub fn new(mechanism: &Mechanism, options: &CollisionOptions) -> Result<Self> {
        let (mut scene, mut ignored) = (Scene::default(), Vec::new());
        for (index, link) in mechanism.links().iter().enumerate() {
            let frame = &mechanism.frames()[index];
            for shape in &link.collisions {
                match body::convex(&shape.geometry, options.meshes) {
                    Ok((convex, shape_from_body)) => scene.add(Body {
                        name: link.name.clone(),
                        shape: shape.name.clone(),
                        link: Some(index),
                        slot: frame.slot,
                        slot_from_body: frame.slot_from_frame
                            * shape.link_from_shape
                            * shape_from_body,
                        convex,
                        category: shape.category,
                        mask: shape.mask,
                    }),
                    Err(why) => ignored.push(Ignored {
                        line: 0,
                        what: format!("collision shape of '{}'", link.name),
                        why,
                    }),
                }
            }
        }
        scene.pairs = pairs::candidates(mechanism, &scene.bodies, &options.disabled, &mut ignored)?;
        drop_constant(mechanism, &mut scene, options)?;
        Ok(Self {
            mechanism: mechanism.clone(),
            links: scene.bodies.len(),
            scene,
            ignored,
            shape_from_body: Vec::new(),
            revision: 0,
        })
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// The shapes: those of links in the order of the links, then the obstacles.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.scene.bodies
    }

    /// The pairs that are watched: those of links, then those with obstacles. Indices are valid
    /// until an obstacle is added or removed.
    #[must_use]
    pub fn pairs(&self) -> &[Pair] {
        &self.scene.pairs
    }

    /// The names of the links or obstacles of a pair.
    ///
    /// # Panics
    /// If there is no such pair.
    #[must_use]
    pub fn names(&self, pair: usize) -> [&str; 2] {
        let Pair { a, b } = self.scene.pairs[pair];
        [&self.scene.bodies[a].name, &self.scene.bodies[b].name]
    }

    /// The collision shapes that could not be made, with the reason: their links have none there; and
    /// disabled pairs of links that do not exist.
    #[must_use]
    pub fn ignored(&self) -> &[Ignored] {
        &self.ignored
    }

    /// The names of the obstacles.
    pub fn obstacles(&self) -> impl Iterator<Item = &str> {
        self.scene.bodies[self.links..].iter().map(|b| b.name.as_str())
    }

    /// Adds an obstacle, which is watched against all links that can move.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] for a name that another obstacle has, or for a shape that cannot be
    /// made; [`Error::NotFinite`] for its pose.
    pub fn add_obstacle(
        &mut self,
        name: &str,
        shape: &Geometry,
        world_from_shape: Pose,
    ) -> Result<()> {
        check_pose(&world_from_shape)?;
        if self.obstacles().any(|n| n == name) {
            let reason = "there is one of this name; remove it first, or move it".to_owned();
            return Err(body::refused("obstacle", name, reason));
        }
        let (convex, shape_from_body) = body::convex(shape, Default::default())
            .map_err(|reason| body::refused("obstacle", name, reason))?;
        pairs::check_count(self.scene.pairs.len() + self.links, self.scene.bodies.len() + 1)?;
        let is_half_space = |convex: &Convex| matches!(convex.core, Core::HalfSpace);
        let b = self.scene.bodies.len();
        for (a, body) in self.scene.bodies[..self.links].iter().enumerate() {
            let both = is_half_space(&convex) && is_half_space(&body.convex);
            if body.slot > 0 && !both {
                self.scene.pairs.push(Pair { a, b });
            }
        }
        let obstacle = Body {
            name: name.to_owned(),
            shape: String::new(),
            link: None,
            slot: 0,
            slot_from_body: world_from_shape * shape_from_body,
            convex,
            category: u32::MAX,
            mask: u32::MAX,
        };
        self.shape_from_body.push(shape_from_body);
        self.revision += 1;
        self.scene.add(obstacle);
        Ok(())
    }

    /// Moves an obstacle, without allocation.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::NotFinite`] for the pose.
    pub fn move_obstacle(&mut self, name: &str, world_from_shape: Pose) -> Result<()> {
        check_pose(&world_from_shape)?;
        let index = self.obstacle(name)?;
        let pose = world_from_shape * self.shape_from_body[index - self.links];
        self.scene.bodies[index].slot_from_body = pose;
        self.revision += 1;
        Ok(())
    }

    /// Removes an obstacle.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn remove_obstacle(&mut self, name: &str) -> Result<()> {
        let index = self.obstacle(name)?;
        self.scene.remove(index);
        self.shape_from_body.remove(index - self.links);
        self.revision += 1;
        Ok(())
    }

    fn obstacle(&self, name: &str) -> Result<usize> {
        let place = self.obstacles().position(|n| n == name);
        place
            .map(|i| i + self.links)
            .ok_or_else(|| Error::unknown("obstacle", name, self.obstacles()))
    }

    /// True for its own mechanism, or one that differs from it in limits and drives only.
    pub(crate) fn fits(&self, mechanism: &Mechanism) -> bool {
        let own = &self.mechanism;
        own.check_frame(mechanism.tool()).is_ok() && own.nodes().len() == mechanism.nodes().len()
    }

    /// The pairs nearer than `margin` (m) at a configuration, into `out`, in the order of
    /// [`CollisionModel::pairs`]. An infinite margin evaluates all pairs.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] for a state of another mechanism or a margin that is not a number.
    pub fn near(&mut self, state: &State, margin: f64, out: &mut Vec<NearPair>) -> Result<()> {
        out.clear();
        let (own, other) = (&self.mechanism, state.mechanism());
        if !self.fits(other) {
            let reason = format!("the shapes are those of '{}'", own.name());
            return Err(body::refused("state", other.name(), reason));
        }
        if margin.is_nan() {
            return Err(body::refused("margin", "NaN", "give a distance in metres".to_owned()));
        }
        self.scene.place(state);
        for pair in 0..self.scene.pairs.len() {
            if self.scene.gap_between_bounds(pair) <= margin
                && let Some(near) = self.scene.evaluate(pair)
                && near.distance <= margin
            {
                out.push(near);
            }
        }
        Ok(())
    }

    /// The gradient of the distance of a near pair over all coordinates, into `row` (n entries): the
    /// rate of the distance is its product with the joint velocities. Without allocation.
    ///
    /// # Panics
    /// If `row` has other than n entries, or the state is of another mechanism or the pair of another
    /// model.
    pub fn gradient_into(&self, state: &State, near: &NearPair, row: &mut [f64]) {
        assert_eq!(row.len(), self.mechanism.n(), "entries of the gradient");
        gradient_into(state, near, row);
    }

    /// The same, and true for the coordinates that move the bodies relative to one another.
    pub(crate) fn gradient_and_moving_into(
        &self,
        state: &State,
        near: &NearPair,
        row: &mut [f64],
        moving: &mut [bool],
    ) {
        gradient_and_moving_into(state, near, row, moving);
    }

    /// Number of changes of the obstacles so far.
    pub(crate) const fn revision(&self) -> u64 {
        self.revision
    }

    /// Moves all bodies to a configuration, for [`CollisionModel::distance_of`].
    pub(crate) fn place(&mut self, state: &State) {
        self.scene.place(state);
    }

    /// The distance of a pair at the configuration of the last call (m); NaN where it is beyond what
    /// numbers can represent.
    pub(crate) fn distance_of(&mut self, pair: usize) -> f64 {
        self.scene.evaluate(pair).map_or(f64::NAN, |near| near.distance)
    }

    /// The smallest distance at a configuration (m), of pairs with an obstacle or of the others: infinite
    /// if there are none, NaN where one is beyond what numbers can represent. The state is of this
    /// mechanism.
    #[cfg(feature = "sweep")]
    pub(crate) fn clearance(&mut self, state: &State, to_obstacles: bool) -> f64 {
        self.scene.place(state);
        let mut smallest = f64::INFINITY;
        for pair in 0..self.scene.pairs.len() {
            if (self.scene.pairs[pair].b >= self.links) != to_obstacles {
                continue;
            }
            let gap = self.scene.gap_between_bounds(pair);
            if gap > smallest && gap.is_finite() {
                continue;
            }
            match self.scene.evaluate(pair) {
                Some(near) if near.distance.is_nan() => return f64::NAN,
                Some(near) => smallest = smallest.min(near.distance),
                None => return f64::NAN,
            }
        }
        smallest
    }

    /// The shapes of the links of another design of its mechanism, of which the same pairs are watched.
    #[cfg(feature = "sweep")]
    pub(crate) fn of_design(&self, design: &Mechanism) -> Result<Self> {
        let options = CollisionOptions { samples: 0, ..CollisionOptions::default() };
        let mut own = Self::new(design, &options)?;
        if own.scene.bodies.len() == self.scene.bodies.len() {
            own.scene.pairs.clone_from(&self.scene.pairs);
        }
        Ok(own)
    }

    /// A bound of the way of a body for small changes of the coordinates (m).
    pub(crate) fn way(&self, state: &State, body: usize, change: &[f64]) -> f64 {
        way(state, &self.scene.bodies[body], change)
    }

    /// The levers of the coordinates in the motion of the bodies of a pair relative to one another,
    /// into `row` (n entries).
    pub(crate) fn levers_into(&self, state: &State, pair: usize, row: &mut [f64]) {
        levers_into(state, &self.scene.bodies, self.scene.pairs[pair], row);
    }

    /// The gradient of the distance of a near pair over all coordinates.
    ///
    /// ```
    /// use cylindroid::collision::{CollisionModel, CollisionOptions};
    /// use cylindroid::model::{Collision, Geometry, Link};
    /// use cylindroid::{Pose, Vec3};
    ///
    /// let mut builder = cylindroid::Mechanism::builder("slide");
    /// let ball = Geometry::Sphere { radius: 0.1 };
    /// let shape = Collision { geometry: ball.clone(), ..Collision::default() };
    /// builder.link(Link { collisions: vec![shape], ..Link::named("cart") });
    /// let kind = cylindroid::model::JointKind::Prismatic;
    /// builder.joint(cylindroid::model::JointSpec::new("x", kind, "rail", "cart"));
    /// let slide = builder.build()?; // along z
    /// let mut model = CollisionModel::new(&slide, &CollisionOptions::default())?;
    /// model.add_obstacle("stop", &ball, Pose::from_translation(Vec3::Z))?;
    /// let (state, mut near) = (slide.state(&[0.3])?, Vec::new());
    /// model.near(&state, 1.0, &mut near)?;
    /// assert!((near[0].distance - 0.5).abs() < 1e-15);
    /// assert_eq!(model.gradient(&state, &near[0]), [-1.0]);
    /// # Ok::<(), cylindroid::Error>(())
    /// ```
    ///
    /// # Panics
    /// If the state is of another mechanism, or the pair of another model.
    #[must_use]
    pub fn gradient(&self, state: &State, near: &NearPair) -> Vec<f64> {
        let mut row = vec![0.0; self.mechanism.n()];
        gradient_into(state, near, &mut row);
        row
    }
}

fn check_pose(pose: &Pose) -> Result<()> {
    Error::check_finite("pose of the obstacle", pose.to_matrix().as_flattened())
}
