//! Moving bodies that MuJoCo refuses, though kinematics needs no more: those without mass or inertia,
//! and those with too many joints.
//!
//! Valid    a body has mass if itself or a body fixed to it has mass and inertia
//! Why so   files that are made for kinematics alone have no masses; the report says what keeps them
//!          from a simulation
//! Source   MuJoCo 4.0, checks of the compiler (mjMINVAL)
//! Checked  tests/formats/mjcf_strict.rs::moving_*

use std::collections::BTreeSet;

use roxmltree::Node;

use super::Mjcf;
use crate::model::{Inertial, JointKind};

/// Masses and moments of inertia of MuJoCo are larger than this (mjMINVAL).
const LEAST: f64 = 1e-15;

/// Degrees of freedom of a body relative to its parent at most.
const MOST_DOF: usize = 6;

impl<'d> Mjcf<'d> {
    /// Remembers a body with its joints, which are the last ones, and notes too many of them.
    pub(super) fn note_motions_of(&mut self, node: Node<'d, 'd>, body: &str, joints: usize) {
        if joints == 0 {
            return;
        }
        self.moving.push((node, body.to_owned()));
        let own = &self.joints[self.joints.len() - joints..];
        let turns = |kind| {
            matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Spherical)
        };
        let ball = own.iter().position(|j| j.kind == JointKind::Spherical);
        let after = ball.map_or(&[][..], |ball| &own[ball + 1..]);
        let what = if own.iter().map(|j| j.kind.dof()).sum::<usize>() > MOST_DOF {
            "more than 6 degrees of freedom of a body"
        } else if after.iter().any(|j| turns(j.kind)) {
            "a rotation after a ball joint"
        } else {
            return;
        };
        self.reader.note(node, what, "it is read; MuJoCo refuses it", body);
    }

    /// Notes the moving bodies without mass or inertia.
    pub(super) fn note_massless(&mut self) {
        if self.compiler.bounds_masses {
            return;
        }
        let weighed = self.links.iter().filter(|l| l.inertial.as_ref().is_some_and(is_weighed));
        let mut weighed: BTreeSet<&str> = weighed.map(|l| l.name.as_str()).collect();
        weighed.extend(self.of_unread_mass.iter().map(String::as_str));
        // Children come after their parents.
        for joint in self.joints.iter().rev().filter(|j| j.kind == JointKind::Fixed) {
            if weighed.contains(joint.child.as_str()) {
                weighed.insert(&joint.parent);
            }
        }
        for (node, body) in self.moving.iter().filter(|(_, body)| !weighed.contains(body.as_str()))
        {
            let why = "kinematics needs none; MuJoCo refuses the file";
            self.reader.note(*node, "moving body without mass or inertia", why, body);
        }
    }
}

/// True for a body that MuJoCo can move.
fn is_weighed(inertial: &Inertial) -> bool {
    let rows = inertial.inertia.to_rows();
    inertial.mass > LEAST && (0..3).all(|i| rows[i][i] > LEAST)
}
