//! The counts of the reference mechanisms, in any frame, unit and basis, wherever contacts are drawn.

use cylindroid::closure::{Mobility, MotionSpace, internal_forces, structural_forces};

use super::case::{Anew, Case, Problem, cases, described_anew};

#[track_caller]
fn check(case: &Case, problem: &Problem) {
    let constraint = &problem.constraint;
    let m = Mobility::of(constraint);
    let kinds = &m.coordinate_kinds;
    let got = [
        ("actuated", constraint.actuated()),
        ("passive", constraint.passive()),
        ("d", constraint.object()),
        ("t", constraint.rows()),
        ("dof", m.dof.dimension()),
        ("redundancy", m.redundancy.dimension()),
        ("coordinate", m.coordinate.dimension()),
        ("indeterminacy", m.indeterminacy.dimension()),
        ("ind_passive", m.idle.dimension()),
        ("ind_object", m.uncontrollable_object_motions.dimension()),
        ("ind_mixed", m.mixed.dimension()),
        ("coord_ap", kinds.passive.dimension()),
        ("coord_au", kinds.object.dimension()),
        ("coord_apu", kinds.both.dimension()),
        ("coord_overlap", kinds.overlap),
        ("ker_G", internal_forces(constraint).dimension()),
        ("ker_JT", structural_forces(constraint).dimension()),
        ("hyperstatic", m.hyperstatic.dimension()),
        ("rel_dim", m.relation.relation),
        ("rel_coordinate", m.relation.coordinate),
        ("rel_redundancy", m.relation.redundancy),
        ("rel_indeterminacy", m.relation.indeterminacy),
        ("act_internal", m.relation.internal),
        ("zero_torque_wrenches", m.relation.zero_torque),
    ];
    for (name, count) in got {
        assert_eq!(count, case.dims(name), "{name} of {}", case.name);
    }
    assert_eq!(m.internal.dimension(), m.relation.internal, "{}", case.name);
    assert_eq!(m.zero_torque.dimension(), m.relation.zero_torque, "{}", case.name);
    assert_eq!(
        m.gruebler_kutzbach + m.hyperstatic.dimension() as i64,
        m.dof.dimension() as i64,
        "{}",
        case.name
    );
    assert!(m.ambiguous_ranks.is_empty(), "{}: {}", case.name, m.ambiguous_ranks[0]);

    let relation = MotionSpace::of(constraint).relation();
    let task = problem.task.as_ref().map_or(relation.clone(), |t| relation.task(t).unwrap());
    let counts = task.dimensions();
    for (name, count) in [
        ("coordinate", counts.coordinate),
        ("redundancy", counts.redundancy),
        ("indeterminacy", counts.indeterminacy),
        ("act_internal", counts.internal),
        ("zero_torque", counts.zero_torque),
    ] {
        assert_eq!(count, case.relation_dims(name), "{name} of the task of {}", case.name);
    }
}

#[test]
fn counts_are_exact() {
    cases().iter().for_each(|case| check(case, &case.problem()));
}

#[test]
fn counts_do_not_depend_on_the_frame() {
    described_anew(Anew::Frame, 71, check);
}

#[test]
fn counts_do_not_depend_on_unit_or_length() {
    described_anew(Anew::Unit, 0, check);
}

#[test]
fn counts_do_not_depend_on_where_a_contact_is_drawn() {
    described_anew(Anew::Drawing, 72, check);
}

#[test]
fn counts_do_not_depend_on_bases() {
    described_anew(Anew::Basis, 73, check);
}

#[test]
fn counts_do_not_depend_on_anything() {
    described_anew(Anew::Everything, 74, check);
}
