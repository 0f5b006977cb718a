//! The blocks of equations 3 to 5: their zeros, their number and their span.

use cylindroid::Matrix;
use cylindroid::closure::{Mobility, Subspace, internal_forces};
use cylindroid::linalg::{ColumnSpace, Threshold};

use super::case::cases;

/// The largest entry of a basis in some rows.
fn largest(space: &Subspace, rows: std::ops::Range<usize>) -> f64 {
    space.basis.rows_between(rows.start, rows.end).max_abs()
}

/// In all reference mechanisms: the blocks have the zeros of the paper, their columns solve the
/// constraint, and together they span all motions.
#[test]
fn blocks_partition_the_motions() {
    for case in cases() {
        let constraint = case.constraint();
        let m = Mobility::of(&constraint);
        let (a, p, d) = (constraint.actuated(), constraint.passive(), constraint.object());
        let (joints, passive, object) = (0..a, a..a + p, a + p..a + p + d);
        let zeros = [
            ("redundancy", vec![passive.clone(), object.clone()]),
            ("idle", vec![joints.clone(), object.clone()]),
            ("mixed", vec![joints.clone()]),
            ("uncontrollable", vec![joints, passive.clone()]),
            ("coordinate_passive", vec![object]),
            ("coordinate_both", vec![]),
            ("coordinate_object", vec![passive]),
        ];
        let matrix = constraint.matrix();
        let mut all = Vec::new();
        for (block, (name, rows)) in m.blocks().iter().zip(zeros) {
            assert_eq!(block.name, name);
            for rows in rows {
                let found = largest(block.motions, rows.clone());
                assert!(found < 1e-11, "{name} of {} in {rows:?}: {found:e}", case.name);
            }
            let left = (&matrix * &block.motions.basis).max_abs();
            assert!(left < 1e-10, "{name} of {}: {left:e}", case.name);
            all.push(&block.motions.basis);
        }
        let count: usize = m.blocks().iter().map(|b| b.motions.dimension()).sum();
        let dof = m.dof.dimension();
        assert_eq!(count, dof + m.coordinate_kinds.overlap, "{}", case.name);
        let together = Matrix::hstack(a + p + d, &all);
        let rank = ColumnSpace::of(&together, Threshold::Relative(1e-9)).rank();
        assert_eq!(rank, dof, "{}", case.name);
        let left = (&constraint.blocks().grasp * &internal_forces(&constraint).basis).max_abs();
        assert!(left < 1e-10, "ker G of {}: {left:e}", case.name);
    }
}
