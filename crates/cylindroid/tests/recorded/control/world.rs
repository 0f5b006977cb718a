//! Obstacles, walls and own tasks of servos of many tasks.

use cylindroid::collision::{CollisionModel, CollisionOptions};
use cylindroid::control::{CollisionAvoidance, CustomTask, HalfSpace};
use cylindroid::model::Geometry;
use cylindroid::{Matrix, Mechanism, Pose, Result, State, Vec3};

use super::tool_at;
use crate::robots::Random;

/// A curve of some coordinates: e = c_k - q_i sin(q_j), which no frame has.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) rows: usize,
    pub(super) level: f64,
}

impl CustomTask for Curve {
    fn rows(&self) -> usize {
        self.rows
    }

    fn evaluate(&mut self, state: &State, error: &mut [f64], jacobian: &mut Matrix) -> Result<()> {
        let q = state.q();
        jacobian.as_mut_slice().fill(0.0);
        for (k, e) in error.iter_mut().enumerate() {
            let (i, j) = (k % q.len(), (k + 1) % q.len());
            *e = self.level - q[i] * q[j].sin();
            jacobian[(k, i)] += q[j].sin();
            jacobian[(k, j)] += q[i] * q[j].cos();
        }
        Ok(())
    }

    fn boxed(&self) -> Box<dyn CustomTask> {
        Box::new(self.clone())
    }
}

fn geometry(size: f64, random: &mut Random<'_>) -> Geometry {
    match random.below(4) {
        0 => Geometry::Box { size: Vec3::new(size, 0.5 * size, 2.0 * size) },
        1 => Geometry::Capsule { radius: size, length: size },
        2 => Geometry::Cylinder { radius: size, length: size },
        _ => Geometry::Sphere { radius: size },
    }
}

/// Up to three obstacles about the tool.
pub(super) fn obstacles(
    robot: &Mechanism,
    q: &[f64],
    random: &mut Random<'_>,
) -> CollisionAvoidance {
    let options = CollisionOptions { samples: 20, ..CollisionOptions::default() };
    let mut model = CollisionModel::new(robot, &options).unwrap();
    let tool = tool_at(robot, q).translation;
    for i in 0..1 + random.below(3) {
        let geometry = geometry(random.within(0.03, 0.15), random);
        let any = random.pose(0.5);
        let pose = Pose { translation: tool + any.translation, ..any };
        model.add_obstacle(&format!("o{i}"), &geometry, pose).unwrap();
    }
    let gap = [0.0, random.within(0.0, 0.03)][random.below(2)];
    CollisionAvoidance { model, gap, margin: gap + random.power(-1.5, 0.7) }
}

/// Walls near the tool, which may be behind one of them.
pub(super) fn walls(robot: &Mechanism, q: &[f64], random: &mut Random<'_>) -> Vec<HalfSpace> {
    let tool = tool_at(robot, q).translation;
    let frames = robot.frames().len();
    let wall = |i: usize, random: &mut Random<'_>| {
        let frame = match random.below(4) {
            0 => robot.frame(&robot.frames()[random.below(frames)].name).unwrap(),
            _ => robot.tool(),
        };
        let normal = random.vec3(3.0);
        let off = robot.reach() * random.within(-0.01, 0.1);
        HalfSpace {
            name: format!("{i}"),
            end_effector: frame.into(),
            point: tool - normal * (off / normal.norm()),
            normal,
        }
    };
    (0..1 + random.below(3)).map(|i| wall(i, random)).collect()
}
