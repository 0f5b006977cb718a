//! The reference mechanisms, and their constraint matrices from joints and contacts.

use cylindroid::Matrix;
use cylindroid::closure::{Constraint, ConstraintBlocks, Unit, Units};
use cylindroid::spatial::{Pose, Rotation, Vec3};
use serde_json::Value;

use crate::support::Random;

/// A mechanism in one pose, with what is known about it.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) value: Value,
    planar: bool,
    joints: Vec<Joint>,
    contacts: Vec<Contact>,
    objects: Vec<Vec3>,
    reference: usize,
    pub(crate) wu: Matrix,
    pub(crate) wq: Matrix,
    pub(crate) task: Option<Matrix>,
    pub(crate) length: f64,
}

#[derive(Clone)]
struct Joint {
    prismatic: bool,
    origin: Vec3,
    axis: Vec3,
    parent: Option<usize>,
    actuated: bool,
}

#[derive(Clone)]
struct Contact {
    kind: String,
    point: Vec3,
    /// x, y, z in space; tangent, normal, out of plane in the plane.
    axes: [Vec3; 3],
    a: Body,
    b: usize,
}

#[derive(Clone, Copy)]
enum Body {
    Ground,
    Limb(usize),
    Object(usize),
}

const Z: Vec3 = Vec3::new(0.0, 0.0, 1.0);

pub(crate) fn cases() -> Vec<Case> {
    let text = include_str!("../../data/closed_chains.json");
    let all: Value = serde_json::from_str(text).unwrap();
    let cases: Vec<Case> = all["cases"].as_array().unwrap().iter().map(Case::read).collect();
    assert_eq!(cases.len(), 31);
    cases
}

pub(crate) fn case(name: &str) -> Case {
    cases().into_iter().find(|c| c.name == name).unwrap()
}

/// How a mechanism may be described anew and stay what it is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Anew {
    /// In other frames, metrics moved along.
    Frame,
    /// In other units of length, metrics moved along, and with other characteristic lengths.
    Unit,
    /// With contacts drawn elsewhere on their links.
    Drawing,
    /// With other combinations of the rows, other coordinates of joints and object.
    Basis,
    /// All at once.
    Everything,
}

/// Checks all reference mechanisms, described anew.
pub(crate) fn described_anew(how: Anew, seed: u64, check: impl Fn(&Case, &Problem)) {
    let mut random = Random(seed);
    let check_case = |case: &Case| check(case, &case.problem());
    for case in cases() {
        match how {
            Anew::Frame => {
                for _ in 0..3 {
                    check_case(&case.moved(case.random_frame(&mut random), 1.0));
                }
            }
            Anew::Unit => {
                for factor in [1e3, 1e-3] {
                    check_case(&case.moved(Pose::IDENTITY, factor));
                }
                for length in [0.1, 5.0] {
                    check_case(&Case { length, ..case.clone() });
                }
            }
            Anew::Drawing => {
                for _ in 0..3 {
                    check_case(&case.redrawn(&mut random));
                }
            }
            Anew::Basis => {
                for _ in 0..3 {
                    check(&case, &case.problem().rebased(&mut random));
                }
            }
            Anew::Everything => {
                for _ in 0..5 {
                    let factor = 10_f64.powf(random.within(-3.0, 3.0));
                    let drawn = case.redrawn(&mut random);
                    let moved = drawn.moved(case.random_frame(&mut random), factor);
                    check_case(&moved);
                    check(&moved, &moved.problem().rebased(&mut random));
                }
            }
        }
    }
}

fn vec3(v: &Value) -> Vec3 {
    let x: Vec<f64> = numbers(v);
    Vec3::new(x[0], x[1], x.get(2).copied().unwrap_or(0.0))
}

pub(crate) fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn matrix(v: &Value) -> Matrix {
    let rows: Vec<Vec<f64>> = v.as_array().unwrap().iter().map(numbers).collect();
    Matrix::from_rows(&rows).unwrap()
}

fn index(v: &Value) -> usize {
    v.as_u64().unwrap() as usize
}

impl Case {
    fn read(value: &Value) -> Self {
        let planar = value["dim"] == 2;
        let joints = value["joints"].as_array().unwrap().iter().map(|j| Joint {
            prismatic: j["kind"] == "P",
            origin: vec3(&j["o"]),
            axis: if j["z"].is_null() { Z } else { vec3(&j["z"]) },
            parent: usize::try_from(j["parent"].as_i64().unwrap()).ok(),
            actuated: j["actuated"].as_bool().unwrap(),
        });
        let contacts = value["contacts"].as_array().unwrap().iter().map(|c| {
            let mut axes = [Vec3::X, Vec3::new(0.0, 1.0, 0.0), Z];
            if !c["frame"].is_null() {
                let frame = matrix(&c["frame"]);
                for (j, axis) in axes.iter_mut().enumerate().take(frame.cols()) {
                    let row = |i: usize| if i < frame.rows() { frame[(i, j)] } else { 0.0 };
                    *axis = Vec3::new(row(0), row(1), row(2));
                }
            }
            let body = &c["a"];
            Contact {
                kind: c["kind"].as_str().unwrap().to_owned(),
                point: vec3(&c["point"]),
                axes,
                a: match body[0].as_str().unwrap() {
                    "limb" => Body::Limb(index(&body[1])),
                    "obj" => Body::Object(index(&body[1])),
                    _ => Body::Ground,
                },
                b: index(&c["b"]),
            }
        });
        Self {
            name: value["name"].as_str().unwrap().to_owned(),
            planar,
            joints: joints.collect(),
            contacts: contacts.collect(),
            objects: value["objects"].as_array().unwrap().iter().map(vec3).collect(),
            reference: index(&value["reference_object"]),
            wu: matrix(&value["weights"]["Wu"]),
            wq: matrix(&value["weights"]["Wq"]),
            task: (!value["task"].is_null()).then(|| matrix(&value["task"])),
            length: 1.0,
            value: value.clone(),
        }
    }

    pub(crate) fn dims(&self, name: &str) -> usize {
        index(&self.value["dims"][name])
    }

    pub(crate) fn relation_dims(&self, name: &str) -> usize {
        index(&self.value["relation_dims"][name])
    }

    /// Seen from another frame, drawn with another unit of length: `factor` new ones are one old.
    /// Metrics, task and characteristic length move along.
    pub(crate) fn moved(&self, pose: Pose, factor: f64) -> Self {
        let mut moved = self.clone();
        let point = |p: Vec3| (pose.rotation * p + pose.translation) * factor;
        for joint in &mut moved.joints {
            joint.origin = point(joint.origin);
            joint.axis = pose.rotation * joint.axis;
        }
        for contact in &mut moved.contacts {
            contact.point = point(contact.point);
            contact.axes = contact.axes.map(|a| pose.rotation * a);
        }
        moved.objects.iter_mut().for_each(|o| *o = point(*o));
        moved.length *= factor;
        // u' = A u with A = blockdiag(factor R, R), so W' = A^-T W A^-1 and T' = T A^-1.
        let r = pose.rotation.matrix().to_rows();
        let components = self.components();
        let inverse = Matrix::from_fn(components.len(), components.len(), |i, j| {
            let (i, j) = (components[i], components[j]);
            let turn = if i / 3 == j / 3 { r[j % 3][i % 3] } else { 0.0 };
            if j < 3 { turn / factor } else { turn }
        });
        match &mut moved.task {
            Some(task) => *task = &*task * &inverse,
            None => moved.wu = &(&inverse.transpose() * &self.wu) * &inverse,
        }
        let actuated: Vec<f64> = self
            .joints
            .iter()
            .filter(|j| j.actuated)
            .map(|j| if j.prismatic { 1.0 / factor } else { 1.0 })
            .collect();
        let scale = Matrix::diagonal(&actuated);
        moved.wq = &(&scale * &self.wq) * &scale;
        moved
    }

    /// Those of a twist that a body has.
    fn components(&self) -> &'static [usize] {
        if self.planar { &[0, 1, 5] } else { &[0, 1, 2, 3, 4, 5] }
    }

    /// Number of objects.
    pub(crate) fn objects(&self) -> usize {
        self.objects.len()
    }

    /// With the axis of joint `j` through another point.
    pub(crate) fn with_joint_at(&self, j: usize, origin: Vec3) -> Self {
        let mut moved = self.clone();
        moved.joints[j].origin = origin;
        moved
    }

    /// With these joints actuated and no others.
    pub(crate) fn actuated_by(&self, actuated: &[usize]) -> Self {
        let mut chosen = self.clone();
        for (j, joint) in chosen.joints.iter_mut().enumerate() {
            joint.actuated = actuated.contains(&j);
        }
        chosen.wq = Matrix::identity(actuated.len());
        chosen
    }

    pub(crate) fn random_frame(&self, random: &mut Random) -> Pose {
        if self.planar {
            Pose {
                rotation: Rotation::exp(Z * random.within(-3.0, 3.0)),
                translation: Vec3::new(random.within(-2.0, 2.0), random.within(-2.0, 2.0), 0.0),
            }
        } else {
            random.pose()
        }
    }

    /// Contacts drawn elsewhere on the rigid links they join, as far as that is the same contact: one
    /// that constrains everything anywhere in any frame, a hard finger at its point in any frame, a hinge
    /// along and about its axis, a point without friction along its normal, a soft finger about it.
    pub(crate) fn redrawn(&self, random: &mut Random) -> Self {
        let mut redrawn = self.clone();
        for contact in &mut redrawn.contacts {
            let way = self.random_frame(random);
            let [_, normal, z] = contact.axes;
            let along = random.within(-0.4, 0.4);
            let turn = Rotation::about(z, random.within(-3.0, 3.0)).unwrap();
            let (shift, turn) = match (contact.kind.as_str(), self.planar) {
                ("complete", _) => (way.translation * 0.2, way.rotation),
                ("point_frictionless", true) => (normal * along, Rotation::IDENTITY),
                ("point_frictionless" | "revolute", false) => (z * along, turn),
                ("hard_finger", false) => (Vec3::ZERO, way.rotation),
                // In the plane these three hold the point.
                ("hard_finger" | "soft_finger" | "revolute", true) => (Vec3::ZERO, way.rotation),
                ("soft_finger", false) => (Vec3::ZERO, turn),
                (other, _) => panic!("no contact '{other}'"),
            };
            contact.point += shift;
            contact.axes = contact.axes.map(|a| turn * a);
        }
        redrawn
    }

    /// Joints that move the body, nearest to the ground last.
    fn ancestors(&self, body: Body) -> Vec<usize> {
        let Body::Limb(last) = body else { return Vec::new() };
        std::iter::successors(Some(last), |&j| self.joints[j].parent).collect()
    }

    /// Its matrices with its metrics and task.
    pub(crate) fn problem(&self) -> Problem {
        Problem {
            constraint: self.constraint(),
            wu: self.wu.clone(),
            wq: self.wq.clone(),
            task: self.task.clone(),
        }
    }

    pub(crate) fn constraint(&self) -> Constraint {
        let components = self.components();
        let d = components.len();
        let (mut joint_rows, mut object_rows, mut units) = (Vec::new(), Vec::new(), Vec::new());
        for contact in &self.contacts {
            let (forces, moments) = selectors(contact, self.planar);
            let rows = forces
                .into_iter()
                .map(|f| (f, Vec3::ZERO, Unit::Length))
                .chain(moments.into_iter().map(|m| (Vec3::ZERO, m, Unit::Angle)));
            for (f, m, unit) in rows {
                let mut joints = vec![0.0; self.joints.len()];
                for j in self.ancestors(contact.a) {
                    let Joint { axis, origin, prismatic, .. } = self.joints[j];
                    joints[j] = if prismatic {
                        f.dot(axis)
                    } else {
                        f.dot(axis.cross(contact.point - origin)) + m.dot(axis)
                    };
                }
                let mut objects = vec![0.0; d * self.objects.len()];
                let mut add = |k: usize, sign: f64| {
                    let turn = (contact.point - self.objects[k]).cross(f) + m;
                    let row = [f.x, f.y, f.z, turn.x, turn.y, turn.z];
                    for (i, &c) in components.iter().enumerate() {
                        objects[k * d + i] += sign * row[c];
                    }
                };
                if let Body::Object(k) = contact.a {
                    add(k, 1.0);
                }
                add(contact.b, -1.0);
                joint_rows.push(joints);
                object_rows.push(objects);
                units.push(unit);
            }
        }
        let t = units.len();
        let joint = |j: usize| {
            let column = Matrix::from_fn(t, 1, |i, _| joint_rows[i][j]);
            (column, if self.joints[j].prismatic { Unit::Length } else { Unit::Angle })
        };
        let object = |k: usize| Matrix::from_fn(t, d, |i, j| object_rows[i][k * d + j]);
        let object_units: Vec<Unit> =
            components.iter().map(|&c| if c < 3 { Unit::Length } else { Unit::Angle }).collect();
        let side = |actuated: bool| {
            let (columns, units): (Vec<Matrix>, Vec<Unit>) = (0..self.joints.len())
                .filter(|&j| self.joints[j].actuated == actuated)
                .map(joint)
                .unzip();
            (Matrix::hstack(t, &columns.iter().collect::<Vec<_>>()), units)
        };
        let (actuated, actuated_units) = side(true);
        let (mut passive, mut passive_units) = side(false);
        for k in (0..self.objects.len()).filter(|&k| k != self.reference) {
            passive = Matrix::hstack(t, &[&passive, &object(k)]);
            passive_units.extend(&object_units);
        }
        let grasp = object(self.reference).transpose();
        let grasp = Matrix::from_fn(d, t, |i, j| -grasp[(i, j)]);
        Constraint::new(ConstraintBlocks { actuated, passive, grasp })
            .unwrap()
            .with_length(
                &Units {
                    rows: units,
                    actuated: actuated_units,
                    passive: passive_units,
                    object: object_units,
                },
                self.length,
            )
            .unwrap()
    }
}

/// A constraint with the metrics and the task that belong to its coordinates.
pub(crate) struct Problem {
    pub(crate) constraint: Constraint,
    pub(crate) wu: Matrix,
    pub(crate) wq: Matrix,
    pub(crate) task: Option<Matrix>,
}

impl Problem {
    /// Other combinations of the rows, other coordinates of actuated joints, passive joints and
    /// object; metrics and task go along.
    pub(crate) fn rebased(&self, random: &mut Random) -> Self {
        let mut regular = |n: usize| {
            let noise = random.matrix(n, n);
            Matrix::from_fn(n, n, |i, j| 0.2 * noise[(i, j)] + f64::from(u8::from(i == j)))
        };
        let (c, blocks) = (&self.constraint, self.constraint.blocks());
        let (rows, passive) = (regular(c.rows()), regular(c.passive()));
        let (actuated, object) = (regular(c.actuated()), regular(c.object()));
        let within = |w: &Matrix, basis: &Matrix| &(&basis.transpose() * w) * basis;
        let constraint = Constraint::new(ConstraintBlocks {
            actuated: &(&rows * &blocks.actuated) * &actuated,
            passive: &(&rows * &blocks.passive) * &passive,
            grasp: &(&object.transpose() * &blocks.grasp) * &rows.transpose(),
        })
        .unwrap();
        Self {
            constraint,
            wu: if self.task.is_some() { self.wu.clone() } else { within(&self.wu, &object) },
            wq: within(&self.wq, &actuated),
            task: self.task.as_ref().map(|t| t * &object),
        }
    }
}

/// Directions of forces and of moments that a contact transmits.
fn selectors(contact: &Contact, planar: bool) -> (Vec<Vec3>, Vec<Vec3>) {
    let [x, y, z] = contact.axes;
    let kind = contact.kind.as_str();
    if planar {
        let (tangent, normal) = (x, y);
        return match kind {
            "point_frictionless" => (vec![normal], vec![]),
            "hard_finger" | "soft_finger" | "revolute" => (vec![tangent, normal], vec![]),
            "complete" => (vec![tangent, normal], vec![Z]),
            _ => panic!("no planar contact '{kind}'"),
        };
    }
    match kind {
        "point_frictionless" => (vec![z], vec![]),
        "hard_finger" => (vec![x, y, z], vec![]),
        "soft_finger" => (vec![x, y, z], vec![z]),
        "revolute" => (vec![x, y, z], vec![x, y]),
        "complete" => (vec![x, y, z], vec![x, y, z]),
        _ => panic!("no spatial contact '{kind}'"),
    }
}
