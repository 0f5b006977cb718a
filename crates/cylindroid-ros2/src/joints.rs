//! The measured configuration: joint states matched by name, with the age of each position.

use cylindroid::Mechanism;

use crate::messages::JointState;

/// The last position of every coordinate, and when it came.
#[derive(Debug, Clone)]
pub struct MeasuredJoints {
    robot: Mechanism,
    q: Vec<f64>,
    /// Seconds on the clock of the node.
    received: Vec<Option<f64>>,
    /// The coordinates without which nothing is commanded.
    required: Vec<usize>,
}

impl MeasuredJoints {
    /// Of a robot whose `required` coordinates must be known; the others are at home until they are.
    #[must_use]
    pub fn new(robot: &Mechanism, required: &[usize]) -> Self {
        Self {
            robot: robot.clone(),
            q: robot.home().to_vec(),
            received: vec![None; robot.n()],
            required: required.to_vec(),
        }
    }

    /// Takes the positions of a message; joints of others are ignored.
    ///
    /// # Errors
    /// A message with fewer positions than names, or a position that is no number or none of a
    /// robot: nothing of it is taken.
    pub fn update(&mut self, message: &JointState, now: f64) -> Result<(), String> {
        let (names, positions) = (&message.name, &message.position);
        if positions.is_empty() {
            return Ok(()); // of velocities or efforts alone
        }
        if positions.len() != names.len() {
            let [given, wanted] = [positions.len(), names.len()];
            return Err(format!("a joint state has {given} positions for {wanted} names"));
        }
        let coordinates = self.robot.coordinates();
        let place = |name: &String| coordinates.iter().position(|c| c.name == *name);
        let own: Vec<(usize, f64)> = names
            .iter()
            .zip(positions)
            .filter_map(|(name, x)| place(name).map(|i| (i, *x)))
            .collect();
        let mut q = self.q.clone();
        own.iter().for_each(|&(i, x)| q[i] = x);
        self.robot.check_q("joint state", &q).map_err(|error| error.to_string())?;
        self.q = q;
        own.iter().for_each(|&(i, _)| self.received[i] = Some(now));
        Ok(())
    }

    /// The configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Required joints whose position never came.
    pub fn missing(&self) -> impl Iterator<Item = &str> {
        let is_missing = |i: &&usize| self.received[**i].is_none();
        self.required.iter().filter(is_missing).map(|&i| self.name(i))
    }

    /// The joint whose position is the oldest of those required, and its age (s); nothing while one
    /// is missing.
    #[must_use]
    pub fn oldest(&self, now: f64) -> Option<(&str, f64)> {
        let mut oldest: Option<(usize, f64)> = None;
        for &i in &self.required {
            let age = now - self.received[i]?;
            if oldest.is_none_or(|(_, least)| age > least) {
                oldest = Some((i, age));
            }
        }
        oldest.map(|(i, age)| (self.name(i), age))
    }

    fn name(&self, i: usize) -> &str {
        &self.robot.coordinates()[i].name
    }
}
