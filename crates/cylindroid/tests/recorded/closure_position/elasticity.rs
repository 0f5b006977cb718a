//! Stiffness of mechanisms with elastic drives, bearings and links.

use cylindroid::manipulability::{Deflection, Stiffness};
use cylindroid::model::{ElasticBody, ElasticElement, ElasticKind, Elasticity};
use cylindroid::{Matrix, Mechanism, Pose};

use super::{near_home, record_error, some_chain, vector, weighted};
use crate::record::{Record, check};
use crate::robots::Random;

/// Positive semidefinite, of any rank.
fn compliance(random: &mut Random<'_>, mechanism: &Mechanism) -> Matrix {
    let d = mechanism.dimension().components().len();
    let rank = if random.once_in(2) { d } else { random.below(d + 1) };
    let size = random.power(-2.0, 0.0);
    let root = Matrix::from_fn(d, rank, |_, _| size * random.within(-1.0, 1.0));
    &root * &root.transpose()
}

fn body(random: &mut Random<'_>, mechanism: &Mechanism) -> ElasticBody {
    let links = mechanism.links();
    let link = links[random.below(links.len())].name.clone();
    let frame = random.once_in(3).then(|| {
        let planar = mechanism.dimension().components().len() == 3;
        (link, if planar { Pose::IDENTITY } else { random.pose(0.5) })
    });
    ElasticBody { compliance: compliance(random, mechanism), frame }
}

fn elasticity(random: &mut Random<'_>, mechanism: &Mechanism) -> Elasticity {
    let mut elasticity = Elasticity::default();
    let mut add = |name: &str, kind| {
        elasticity.elements.push(ElasticElement { name: name.to_owned(), kind });
    };
    for joint in mechanism.joints() {
        if !joint.coordinates.is_empty() && joint.mimic.is_none() && random.once_in(2) {
            add(&joint.name, ElasticKind::Motion { stiffness: random.power(0.0, 2.0) });
        }
        if random.once_in(4) {
            add(&joint.name, ElasticKind::Joint(body(random, mechanism)));
        }
    }
    let loops = mechanism.loops().iter().map(|l| (&l.name, l.actuated));
    let contacts = mechanism.contacts().iter().map(|c| (&c.name, false));
    for (name, actuated) in loops.chain(contacts) {
        if actuated && random.once_in(2) {
            add(name, ElasticKind::Motion { stiffness: random.power(0.0, 2.0) });
        }
        if random.once_in(2) {
            add(name, ElasticKind::Joint(body(random, mechanism)));
        }
    }
    for link in mechanism.links().iter().skip(1) {
        if random.once_in(5) {
            add(&link.name, ElasticKind::Link(body(random, mechanism)));
        }
    }
    let coordinates = mechanism.coordinates();
    if random.once_in(5) {
        let name = &coordinates[random.below(coordinates.len())].name;
        add(name, ElasticKind::Motion { stiffness: 3.0 });
    }
    elasticity
}

fn record_deflection(record: &mut Record, found: &Deflection) {
    record.number(weighted(&found.twist));
    record.number(found.energy);
    for part in &found.parts {
        record.number(weighted(&part.deflection));
    }
    record.number(weighted(&found.unbalanced));
    record.number(weighted(&found.torques));
    for force in &found.forces {
        record.number(weighted(&force.wrench.to_array()));
    }
}

fn record_stiffness(random: &mut Random<'_>, record: &mut Record, found: &Stiffness) {
    record.word(&(found.free.cols(), found.rigid.cols(), found.undetermined));
    record.number(weighted(&found.point.to_array()));
    let wrench = vector(random, found.free.rows(), 2.0);
    for matrix in [&found.compliance, &found.stiffness] {
        record.number(matrix.as_ref().map_or(0.0, |m| weighted(m.as_slice())));
    }
    match found.deflection(&wrench) {
        Ok(found) => record_deflection(record, &found),
        Err(error) => record_error(record, &error),
    }
}

#[test]
fn elastic_chains() {
    check("position_elasticity", 100, |random, record| {
        let mechanism = some_chain(random);
        let elasticity = elasticity(random, &mechanism);
        let q = if random.once_in(2) {
            mechanism.home().to_vec()
        } else {
            near_home(random, &mechanism, -0.3)
        };
        let state = mechanism.state(&q).unwrap();
        let length = random.once_in(2).then(|| random.power(-1.0, 1.0));
        match Stiffness::of(&state, None, length, &elasticity) {
            Ok(found) => record_stiffness(random, record, &found),
            Err(error) => record_error(record, &error),
        }
    });
}
