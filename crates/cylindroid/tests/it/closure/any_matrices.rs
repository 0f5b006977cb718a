//! Any finite matrices: no panic, counts that add up, forces that do no work.

use cylindroid::Matrix;
use cylindroid::closure::{
    Constraint, ConstraintBlocks, Mobility, MobilityCounts, MotionSpace, Singularities, StaticLoad,
    contact_forces, joint_torques,
};
use cylindroid::manipulability::{Manipulability, Metrics};

use crate::support::Random;

fn any(random: &mut Random, m: usize, n: usize) -> Matrix {
    let kind = random.next_u64() % 8;
    let rank = 1 + (random.next_u64() % 3) as usize;
    let plain = random.matrix(m, n);
    match kind {
        0 => random.integer_product(m, n, rank),
        1 => Matrix::zeros(m, n),
        2 => &random.matrix(m, rank) * &random.matrix(rank, n),
        // Entries of very different size.
        3 => Matrix::from_fn(m, n, |i, j| {
            plain[(i, j)] * 10.0_f64.powi((random.next_u64() % 40) as i32 - 20)
        }),
        4 => Matrix::from_fn(m, n, |i, j| plain[(i, j)] * 1e-200),
        5 => Matrix::from_fn(m, n, |i, j| plain[(i, j)] * 1e200),
        // Nearly dependent.
        6 => {
            let base = random.matrix(m, 1);
            Matrix::from_fn(m, n, |i, j| base[(i, 0)] + 1e-9 * plain[(i, j)])
        }
        _ => plain,
    }
}

#[test]
fn any_matrices_have_an_answer() {
    let mut random = Random(77);
    for round in 0..4000 {
        let size = |random: &mut Random, n: u64| (random.next_u64() % n) as usize;
        let (t, a) = (size(&mut random, 8), size(&mut random, 6));
        let (p, d) = (size(&mut random, 6), size(&mut random, 7));
        let blocks = ConstraintBlocks {
            actuated: any(&mut random, t, a),
            passive: any(&mut random, t, p),
            grasp: any(&mut random, d, t),
        };
        let constraint = Constraint::new(blocks).unwrap();
        let motions = MotionSpace::of(&constraint);
        let relation = motions.relation();
        let m = Mobility::from_parts(&constraint, &motions, &relation);
        let r = m.relation;
        assert_eq!(r.coordinate + r.redundancy + r.internal, a, "{round}");
        assert_eq!(r.coordinate + r.indeterminacy + r.zero_torque, d, "{round}");
        assert_eq!(
            m.dof.dimension() as i64,
            m.gruebler_kutzbach + m.hyperstatic.dimension() as i64
        );
        let work = &relation.forces().basis().transpose() * &relation.motions().basis();
        assert!(work.max_abs() < 1e-12, "{round}: {work:?}");
        let all = Manipulability::of(&relation, &Metrics::UNIT).unwrap();
        assert_eq!(all.kinematic.finite.len(), r.coordinate, "{round}");
        assert!(all.kinematic.values().iter().all(|e| *e > 0.0 && e.is_finite()), "{round}");
        let wrench = random.vector(d);
        let torques = joint_torques(&relation, &wrench, None).unwrap();
        assert!(torques.torques.iter().all(|t| t.is_finite()), "{round}");
        let load = StaticLoad { torques: &torques.torques, wrench: &wrench };
        contact_forces(&constraint, &motions, load, None).unwrap();
        let counts = MobilityCounts::of(&motions, &relation);
        assert_eq!((counts.rank, counts.zero_torque), (t - motions.hyperstatic(), r.zero_torque));
        let found = Singularities::of(&motions, &relation, &counts);
        assert!(found.is_regular(), "{round}");
        // Not at a singularity of its own, so at some distance from all.
        let d = found.distances;
        for distance in [d.type_i, d.type_ii, d.configuration_space, d.passive] {
            assert!(distance > 0.0 && (distance <= 1.0 + 1e-12 || distance.is_infinite()), "{d:?}");
        }
    }
}
