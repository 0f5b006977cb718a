//! Geometry of six-axis arms with a closed-form inverse kinematics.
//!
//! Method   the six axes as lines, at zero: three that intersect in a point (the last, or the
//!          first) or three neighbours that are parallel (2 to 4, or 3 to 5), and additionally two
//!          that are parallel or intersect, which decouples the two remaining equations. A property
//!          of the last axes carries over to the first in the chain read from the tool: axes and
//!          lengths change sign, angles do not
//! Units    m; deviations are in reaches and rad
//! Valid    axes that deviate from the pattern by less than `ALIGNED_AXES`, which Newton's method
//!          corrects
//! Source   Pieper 1968; Elias & Wen 2025 (IK-Geo), section on decompositions; Ostermeier, Kuelz &
//!          Althoff 2025 (EAIK): patterns read from the axes
//! Checked  tests/it/analytic/

use std::fmt;

use super::subproblems::Order;
use crate::screws::Line;
use crate::spatial::{Rotation, Vec3};
use crate::tolerance::{ALIGNED_AXES, OBLIQUE_AXES};

/// The geometry of an arm with a closed-form inverse kinematics. Its text names the axes, counted
/// from 1 at the ground without locked joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArmGeometry {
    pub(super) three: Three,
    /// True if the pattern is that of the chain read from the tool.
    pub(super) reversed: bool,
    pub(super) two: Two,
}

/// Three of six axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Three {
    /// 4, 5 and 6 intersect.
    Meet,
    /// 2, 3 and 4 are parallel.
    Parallel,
}

/// Two more, the first of the pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Two {
    Parallel(usize),
    Meet(usize),
    None,
}

impl ArmGeometry {
    /// True if two more axes decouple the two equations of the three.
    pub(in crate::ik) fn splits(&self) -> bool {
        self.two != Two::None
    }
}

impl fmt::Display for ArmGeometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pair = |first: usize| {
            if self.reversed { (6 - first, 7 - first) } else { (first, first + 1) }
        };
        f.write_str(match (self.three, self.reversed) {
            (Three::Meet, false) => "spherical wrist",
            (Three::Meet, true) => "spherical shoulder",
            (Three::Parallel, false) => "parallel axes 2, 3 and 4",
            (Three::Parallel, true) => "parallel axes 3, 4 and 5",
        })?;
        match self.two {
            Two::Parallel(first) => {
                let (a, b) = pair(first);
                write!(f, ", parallel axes {a} and {b}")
            }
            Two::Meet(first) => {
                let (a, b) = pair(first);
                write!(f, ", axes {a} and {b} meet")
            }
            Two::None => Ok(()),
        }
    }
}

/// The axes of six revolute joints at zero, and the origin of the tool.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    pub(super) lines: [Line; 6],
    pub(super) tool: Vec3,
}

/// Parameters of the closed form, in the order in which the chain is read: axis i has direction
/// `h[i]` and passes through `o[i]`.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArmParameters {
    pub(super) h: [Vec3; 6],
    /// From the base to the first axis, from axis to axis, to the tool.
    pub(super) p: [Vec3; 7],
    /// The point of the axis next to the tool from which the tool is seen: the last, or the first if
    /// the chain is read from the tool.
    end: Vec3,
    /// -1 for axes whose angle has the opposite sign in the closed form.
    pub(super) sign: [f64; 6],
    /// A unit vector perpendicular to the last axis.
    pub(super) side: Vec3,
    /// A unit vector perpendicular to the second axis.
    pub(super) level: Vec3,
    pub(super) reach: f64,
    pub(super) order: Order,
}

impl Axes {
    fn reversed(&self) -> [Line; 6] {
        let [a, b, c, d, e, f] = self.lines;
        [f, e, d, c, b, a].map(|line| Line { direction: -line.direction, ..line })
    }

    fn read(&self, reversed: bool) -> [Line; 6] {
        if reversed { self.reversed() } else { self.lines }
    }

    /// The geometry of these axes, `None` if there is no closed form; a decoupled one is preferred.
    /// Also the deviation of the axes from it (rad, or reaches).
    pub(super) fn structure(&self, reach: f64) -> Option<(ArmGeometry, f64)> {
        let mut found: Option<(ArmGeometry, f64)> = None;
        for three in [Three::Meet, Three::Parallel] {
            for reversed in [false, true] {
                let lines = self.read(reversed);
                let Some(departure) = three.departure(&lines, reach) else { continue };
                let (two, more) = match three {
                    Three::Meet => [Two::Parallel(2), Two::Parallel(1), Two::Meet(2), Two::Meet(1)]
                        .into_iter()
                        .find_map(|two| Some((two, two.departure(&lines, reach)?)))
                        .unwrap_or((Two::None, 0.0)),
                    Three::Parallel => Two::Meet(5)
                        .departure(&lines, reach)
                        .map_or((Two::None, 0.0), |more| (Two::Meet(5), more)),
                };
                let better = match found {
                    None => true,
                    Some((before, _)) => before.two == Two::None && two != Two::None,
                };
                if better {
                    found = Some((ArmGeometry { three, reversed, two }, departure.max(more)));
                }
            }
        }
        found
    }

    /// The parameters of the closed form.
    pub(super) fn geometry(&self, structure: ArmGeometry, reach: f64) -> ArmParameters {
        let lines = self.read(structure.reversed);
        let mut h = lines.map(|line| line.direction);
        let mut sign = [1.0; 6];
        let between = |i: usize| {
            let normal = lines[i].common_normal(&lines[i + 1]);
            (normal.from + normal.to) * 0.5
        };
        let mut o = lines.map(|line| line.point);
        let normal = lines[0].common_normal(&lines[1]);
        (o[0], o[1]) = (normal.from, normal.to);
        match structure.two {
            Two::Meet(1) => o[0..2].fill(between(0)),
            Two::Meet(2) => {
                o[1..3].fill(between(1));
                o[0] = lines[0].nearest(o[1]);
            }
            Two::Meet(_) => o[4..6].fill(between(4)),
            _ => {}
        }
        if structure.two != Two::Meet(2) {
            o[2] = lines[2].nearest(o[1]);
        }
        match structure.three {
            Three::Meet => o[3..6].fill(meeting(&lines)),
            Three::Parallel => {
                o[3] = lines[3].nearest(o[2]);
                if structure.two == Two::None {
                    let normal = lines[4].common_normal(&lines[5]);
                    (o[4], o[5]) = (normal.from, normal.to);
                }
                for i in [2, 3] {
                    sign[i] = if h[i].dot(h[1]) < 0.0 { -1.0 } else { 1.0 };
                    h[i] = h[1];
                }
            }
        }
        let step = |i: usize| match i {
            0 => o[0],
            6 => -o[5],
            _ => o[i] - o[i - 1],
        };
        let mut parameters = ArmParameters {
            h,
            p: [0, 1, 2, 3, 4, 5, 6].map(step),
            end: if structure.reversed { o[0] } else { o[5] },
            sign,
            side: perpendicular(h[5]),
            level: perpendicular(h[1]),
            reach,
            order: match (structure.three, structure.two) {
                (_, Two::None) => Order::Together,
                (Three::Parallel, _) | (Three::Meet, Two::Parallel(2)) => Order::FirstX(0),
                (Three::Meet, Two::Parallel(_)) => Order::FirstY(0),
                (Three::Meet, Two::Meet(2)) => Order::FirstX(1),
                (Three::Meet, Two::Meet(_)) => Order::FirstY(1),
            },
        };
        parameters.set_tool(self.tool, structure.reversed);
        parameters
    }
}

impl ArmParameters {
    /// Sets the origin of the tool at zero (m); the axes stay.
    pub(super) fn set_tool(&mut self, tool: Vec3, reversed: bool) {
        match reversed {
            false => self.p[6] = tool - self.end,
            true => self.p[0] = self.end - tool,
        }
    }
}

impl Three {
    /// The deviation of the axes from the pattern; `None` if too large.
    fn departure(self, lines: &[Line; 6], reach: f64) -> Option<f64> {
        let departure = match self {
            Self::Meet => {
                if sine(lines, 3) < OBLIQUE_AXES || sine(lines, 4) < OBLIQUE_AXES {
                    return None;
                }
                let point = meeting(lines);
                let far = |line: &Line| (line.nearest(point) - point).norm();
                lines[3..].iter().map(far).fold(0.0, f64::max) / reach
            }
            Self::Parallel => {
                // Axis 1 rotates axis 2, axis 4 rotates axis 5; 5 and 6 rotate the tool.
                if [0, 3, 4].iter().any(|i| sine(lines, *i) < OBLIQUE_AXES) {
                    return None;
                }
                sine(lines, 1).max(sine(lines, 2))
            }
        };
        (departure <= ALIGNED_AXES).then_some(departure)
    }
}

impl Two {
    fn departure(self, lines: &[Line; 6], reach: f64) -> Option<f64> {
        let departure = match self {
            Self::Parallel(first) => sine(lines, first - 1),
            Self::Meet(first) if sine(lines, first - 1) >= OBLIQUE_AXES => {
                lines[first - 1].common_normal(&lines[first]).distance / reach
            }
            _ => return None,
        };
        (departure <= ALIGNED_AXES).then_some(departure)
    }
}

/// Sine of the angle between an axis and the next.
fn sine(lines: &[Line; 6], i: usize) -> f64 {
    lines[i].direction.cross(lines[i + 1].direction).norm()
}

/// Intersection of the last three axes: from the two neighbours with the larger angle.
fn meeting(lines: &[Line; 6]) -> Vec3 {
    let i = if sine(lines, 3) > sine(lines, 4) { 3 } else { 4 };
    let normal = lines[i].common_normal(&lines[i + 1]);
    (normal.from + normal.to) * 0.5
}

/// A unit vector perpendicular to a unit vector.
fn perpendicular(n: Vec3) -> Vec3 {
    Rotation::z_to(n).map_or(Vec3::X, Rotation::x_axis)
}
