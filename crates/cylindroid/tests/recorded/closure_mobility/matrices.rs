//! Constraints of random matrices: motions, forces, blocks and counts.

use cylindroid::Matrix;
use cylindroid::closure::{
    Constraint, ConstraintBlocks, Mobility, MobilityCounts, MotionSpace, Relation, RelationBases,
    RelationDimensions, RowSelection, Singularities, Subspace, Unit, Units, internal_forces,
    joint_torques, structural_forces,
};

use super::digest::{Digests, entries, span, sum};
use crate::record::{Record, check};
use crate::robots::Random;

/// A product of small integer matrices, of rank `rank` at most, times a number.
fn integers(random: &mut Random<'_>, rows: usize, cols: usize, rank: usize) -> Matrix {
    let scale = random.within(0.5, 2.0);
    let mut draw = |r, c| Matrix::from_fn(r, c, |_, _| random.below(7) as f64 - 3.0);
    let product = &draw(rows, rank) * &draw(rank, cols);
    Matrix::from_fn(rows, cols, |i, j| scale * product[(i, j)])
}

fn plain(random: &mut Random<'_>, rows: usize, cols: usize) -> Matrix {
    Matrix::from_fn(rows, cols, |_, _| random.within(-1.0, 1.0))
}

/// Regular, of low rank, nearly so, zero, or with columns of very different lengths.
fn block(random: &mut Random<'_>, rows: usize, cols: usize) -> Matrix {
    let rank = 1 + random.below(3);
    match random.below(9) {
        0 | 1 => integers(random, rows, cols, rank),
        2 => &plain(random, rows, rank) * &plain(random, rank, cols),
        3 => Matrix::zeros(rows, cols),
        4 => {
            let (near, far) = (plain(random, rows, 1), plain(random, rows, cols));
            let share = random.power(-11.0, -1.0);
            Matrix::from_fn(rows, cols, |i, j| near[(i, 0)] + share * far[(i, j)])
        }
        5 => {
            let sizes: Vec<f64> = (0..cols).map(|_| random.power(-4.0, 1.0)).collect();
            let all = plain(random, rows, cols);
            Matrix::from_fn(rows, cols, |i, j| sizes[j] * all[(i, j)])
        }
        _ => plain(random, rows, cols),
    }
}

fn units(random: &mut Random<'_>, count: usize) -> Vec<Unit> {
    (0..count).map(|_| if random.once_in(3) { Unit::Length } else { Unit::Angle }).collect()
}

/// Units of all rows and columns, and a characteristic length.
fn scaled(random: &mut Random<'_>, constraint: Constraint) -> Constraint {
    if random.once_in(4) {
        return constraint;
    }
    let units = Units {
        rows: units(random, constraint.rows()),
        actuated: units(random, constraint.actuated()),
        passive: units(random, constraint.passive()),
        object: units(random, constraint.object()),
    };
    let length = random.power(-1.0, 1.0);
    constraint.with_length(&units, length).unwrap()
}

fn constraint(random: &mut Random<'_>) -> Constraint {
    let (t, a) = (random.below(9), random.below(6));
    let (p, d) = (random.below(7), random.below(7));
    let grasp =
        if random.once_in(3) && t > 0 { integers(random, d, t, 6) } else { block(random, d, t) };
    let blocks =
        ConstraintBlocks { actuated: block(random, t, a), passive: block(random, t, p), grasp };
    let constraint = Constraint::new(blocks).unwrap();
    scaled(random, constraint)
}

/// Joints on either side of an object, as of mechanisms: passive joints and object may compensate
/// each other.
fn coupled(random: &mut Random<'_>) -> Constraint {
    let (a, p, d) = (1 + random.below(4), random.below(5), 1 + random.below(4));
    let t = (a + p + d).saturating_sub(1 + random.below(4)).max(1);
    // Columns of one kind that those of another span.
    let base = plain(random, t, t.min(3));
    let mut draw = |cols: usize| match random.below(4) {
        0 => &base * &plain(random, base.cols(), cols),
        1 => integers(random, t, cols, 2),
        2 => Matrix::from_fn(t, cols, |i, j| if i == j { 1.0 } else { 0.0 }),
        _ => plain(random, t, cols),
    };
    let (actuated, passive, grasp) = (draw(a), draw(p), draw(d).transpose());
    let constraint = Constraint::new(ConstraintBlocks { actuated, passive, grasp }).unwrap();
    scaled(random, constraint)
}

fn spaces(m: &Mobility) -> [&Subspace; 13] {
    let kinds = &m.coordinate_kinds;
    [
        &m.dof,
        &m.redundancy,
        &m.indeterminacy,
        &m.coordinate,
        &kinds.passive,
        &kinds.object,
        &kinds.both,
        &m.idle,
        &m.uncontrollable_object_motions,
        &m.mixed,
        &m.internal,
        &m.zero_torque,
        &m.hyperstatic,
    ]
}

fn dimensions(record: &mut Record, r: RelationDimensions) {
    let motions = [r.relation, r.coordinate, r.redundancy, r.indeterminacy];
    record.counts(&[&motions[..], &[r.internal, r.zero_torque]].concat());
}

fn mobility(record: &mut Record, m: &Mobility) {
    let all = spaces(m);
    record.counts(&all.map(Subspace::dimension));
    dimensions(record, m.relation);
    record.word(&(m.gruebler_kutzbach, m.coordinate_kinds.overlap));
    record.counts(&m.blocks().map(|b| b.motions.dimension()));
    let flag = |x: bool| char::from(b'0' + u8::from(x));
    let joints = m.joints.iter().flat_map(|j| [j.moves, j.free_of_actuators, j.idle].map(flag));
    record.text(joints.collect::<String>());
    for warning in &m.ambiguous_ranks {
        record.text(warning.count);
    }
    record.number(sum(m.joints.iter().map(|j| j.share)));
    record.numbers(&[sum(all.map(|s| span(&s.basis)))]);
    record.number(sum(m.blocks().map(|b| span(&b.motions.basis))));
    let kept = all.map(|s| if s.cut.kept.is_finite() { s.cut.kept } else { 2.0 });
    let ranks = all.map(|s| s.cut.rank.rank as f64);
    record.numbers(&[sum(kept), sum(ranks)]);
    record.number(sum(all.map(|s| entries(&s.basis))));
}

#[test]
fn mobility_of_matrices() {
    check("mobility_of_matrices", 85, |random, record| {
        let c = constraint(random);
        mobility(record, &Mobility::of(&c));
        let (internal, structural) = (internal_forces(&c), structural_forces(&c));
        record.counts(&[internal.dimension(), structural.dimension()]);
        record.number(sum([span(&internal.basis), span(&structural.basis)]));
        record.cut(internal.cut);
        record.cut(structural.cut);
    });
}

#[test]
fn mobility_of_coupled_matrices() {
    check("mobility_of_coupled_matrices", 70, |random, record| {
        mobility(record, &Mobility::of(&coupled(random)));
    });
}

/// Few rows and many columns, which are compressed from some number on.
fn long(random: &mut Random<'_>) -> Constraint {
    let wide = |random: &mut Random<'_>| match random.below(4) {
        0 => random.below(4),
        1 => 64 + random.below(3),
        _ => 66 + random.below(8),
    };
    let (t, a) = (if random.once_in(8) { 33 } else { 2 + random.below(5) }, wide(random));
    let (p, d) = (wide(random), 1 + random.below(t.min(3)));
    let rank = 1 + random.below(t.min(4));
    let low = random.once_in(2);
    let mut draw = |rows: usize, cols: usize| {
        if low {
            &plain(random, rows, rank) * &plain(random, rank, cols)
        } else {
            plain(random, rows, cols)
        }
    };
    let (actuated, passive, grasp) = (draw(t, a), draw(t, p), draw(d, t));
    let constraint = Constraint::new(ConstraintBlocks { actuated, passive, grasp }).unwrap();
    scaled(random, constraint)
}

#[test]
fn mobility_of_long_chains() {
    check("mobility_of_long_chains", 24, |random, record| {
        let m = Mobility::of(&long(random));
        let all = spaces(&m);
        record.counts(&all.map(Subspace::dimension));
        dimensions(record, m.relation);
        record.word(&m.gruebler_kutzbach);
        record.number(sum(m.joints.iter().map(|j| j.share)));
        let count = |of: fn(&cylindroid::closure::JointMobility) -> bool| {
            m.joints.iter().filter(|j| of(j)).count()
        };
        record.counts(&[count(|j| j.moves), count(|j| j.free_of_actuators), count(|j| j.idle)]);
        for space in all {
            record.number(span(&space.basis));
        }
        record.number(sum(all.map(|s| entries(&s.basis))));
    });
}

fn selection(bits: usize) -> RowSelection {
    RowSelection { actuated: bits & 1 > 0, passive: bits & 2 > 0, object: bits & 4 > 0 }
}

#[test]
fn motion_spaces() {
    check("mobility_motion_spaces", 50, |random, record| {
        let c = if random.once_in(2) { constraint(random) } else { coupled(random) };
        let threshold = random.power(-11.0, -0.3);
        let motions = MotionSpace::with_threshold(&c, threshold);
        record.counts(&[motions.dof(), motions.hyperstatic(), motions.actuated()]);
        record.counts(&[motions.passive(), motions.object()]);
        record.word(&motions.gruebler_kutzbach());
        record.cut(motions.cut());
        record.size(motions.regularity());
        record.size(motions.tolerance());
        let vanishing: Vec<Matrix> = (0..8).map(|b| motions.vanishing_on(selection(b))).collect();
        record.counts(&vanishing.iter().map(Matrix::cols).collect::<Vec<_>>());
        record.number(sum(vanishing.iter().map(span)));
        let counts = MobilityCounts::of(&motions, &motions.relation());
        record.counts(&[counts.rank, counts.idle, counts.redundancy]);
        singularities(random, record, &motions, counts);
        record.number(entries(&motions.basis()));
        record.number(sum(vanishing.iter().map(entries)));
    });
}

/// Against counts that are a little different.
fn singularities(
    random: &mut Random<'_>,
    record: &mut Record,
    motions: &MotionSpace,
    now: MobilityCounts,
) {
    let mut less = |x: usize| x.saturating_sub(usize::from(random.once_in(3)));
    let generic = MobilityCounts {
        rank: now.rank,
        idle: less(now.idle),
        redundancy: less(now.redundancy),
        indeterminacy: less(now.indeterminacy),
        zero_torque: less(now.zero_torque),
    };
    let generic = MobilityCounts { rank: now.rank + random.below(3) / 2, ..generic };
    record.word(&generic.generic(now).idle);
    let found = Singularities::of(motions, &motions.relation(), &generic);
    for kind in &found.kinds {
        record.text(kind.name());
        record.text(kind);
    }
    let d = found.distances;
    for distance in [d.type_i, d.type_ii, d.configuration_space, d.passive] {
        record.number(if distance.is_finite() { distance } else { 3.0 });
    }
    record.counts(&[found.blocked.cols(), found.gained.cols()]);
    record.number(sum([span(&found.blocked), span(&found.gained)]));
}

/// Sums that no choice of bases changes.
fn bases(record: &mut Record, bases: &RelationBases) {
    let RelationBases { zero, infinite, joint, object } = bases;
    record.number(sum([zero, infinite, joint, object].map(span)));
    record.number(entries(&(joint * &object.transpose())));
    record.number(span(&bases.basis()));
}

fn relation(record: &mut Record, relation: &Relation) {
    dimensions(record, relation.dimensions());
    record.number(sum(relation.finite_pairs().iter().flat_map(|p| [p.0, p.1])));
    for cut in relation.cuts() {
        record.cut(cut);
    }
    let all = [relation.motions(), relation.forces()];
    all.iter().for_each(|of| bases(record, of));
}

/// The bases themselves.
fn columns(record: &mut Record, relation: &Relation) {
    let [a, b] = [relation.motions(), relation.forces()].map(|of| of.basis());
    record.numbers(&[entries(&a), entries(&b)]);
}

#[test]
fn relations() {
    check("mobility_relations", 60, |random, record| {
        let c = if random.once_in(2) { constraint(random) } else { coupled(random) };
        let whole = MotionSpace::of(&c).relation();
        relation(record, &whole);
        let wrench: Vec<f64> = (0..c.object()).map(|_| random.within(-1.0, 1.0)).collect();
        let found = joint_torques(&whole, &wrench, None).unwrap();
        let parts = [found.torques, found.structural, found.unbalanced];
        record.numbers(&parts.map(sum));
        columns(record, &whole);
    });
}

#[test]
fn tasks_and_sections() {
    check("mobility_tasks_and_sections", 60, |random, record| {
        let c = if random.once_in(2) { constraint(random) } else { coupled(random) };
        let whole = MotionSpace::of(&c).relation();
        let (m, d) = (1 + random.below(4), whole.object() + random.below(9) / 8);
        let mut map = block(random, m, d);
        if random.once_in(2) {
            let size = random.power(-5.0, 5.0);
            map =
                Matrix::from_fn(m, d, |i, j| if i == 0 { size * map[(i, j)] } else { map[(i, j)] });
        }
        match whole.task(&map) {
            Ok(task) => relation(record, &task),
            Err(error) => record.text(error),
        }
        let chosen: Vec<usize> = (0..random.below(4)).map(|_| random.below(d + 1)).collect();
        match whole.section(&chosen) {
            Ok(section) => relation(record, &section),
            Err(error) => record.text(error),
        }
    });
}
