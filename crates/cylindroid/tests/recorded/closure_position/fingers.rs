//! The contacts of mechanisms as fingers on an object.

use cylindroid::closure::{
    ContactProperties, FingerContact, Friction, WrenchSpace, grasp_contacts,
};
use cylindroid::model::{
    Contact, ContactCurvature, ContactKind, ContactSpec, Dimension, JointKind, JointSpec,
    SurfaceCurvature,
};
use cylindroid::spatial::Rotation;
use cylindroid::{Mechanism, Pose, Vec3};

use super::{near_home, record_error, weighted};
use crate::record::{Record, check};
use crate::robots::Random;

/// Fingers on slides about a free object, named first or second.
fn gripper(random: &mut Random<'_>) -> Mechanism {
    let planar = random.once_in(3);
    let mut builder = Mechanism::builder("gripper");
    if planar {
        builder.dimension(Dimension::Planar);
    }
    let float = if planar { JointKind::Planar } else { JointKind::Free };
    builder
        .joint(JointSpec { actuated: false, ..JointSpec::new("float", float, "base", "object") });
    let size = random.power(-2.0, 1.0);
    for i in 0..1 + random.below(4) {
        let turn = random.within(-3.0, 3.0);
        let out = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let name = format!("finger{i}");
        builder.joint(JointSpec {
            axis: out,
            ..JointSpec::new(&name, JointKind::Prismatic, "base", &name)
        });
        let tilt = if planar { Rotation::exp(Vec3::ZERO) } else { Rotation::exp(random.vec3(0.4)) };
        let flat = Rotation::about_z(turn) * Rotation::exp(Vec3::Y * -std::f64::consts::FRAC_PI_2);
        let at = Pose { rotation: tilt * flat, translation: out * size };
        let kinds = ContactKind::ALL;
        let kind = if random.once_in(9) { kinds[random.below(5)] } else { kinds[random.below(3)] };
        let first = random.once_in(3);
        let (a, b) = if first { ("object", &name[..]) } else { (&name[..], "object") };
        let is_point = kinds[..3].contains(&kind);
        let curvature = is_point.then(|| ContactCurvature {
            finger: SurfaceCurvature { principal: [3.0, 1.0], direction: random.vec3(1.0) },
            object: SurfaceCurvature::uniform(random.within(-0.5, 2.0)),
        });
        builder.contact(ContactSpec {
            link_a_from_contact: at,
            link_b_from_contact: at,
            friction: (!random.once_in(6)).then(|| random.within(0.1, 0.8)),
            curvature,
            ..ContactSpec::new(&format!("touch{i}"), kind, a, b)
        });
    }
    builder.frame("grip", "object", Pose::from_translation(Vec3::new(0.1, 0.2, 0.0) * size));
    builder.reference("object");
    builder.build().unwrap()
}

fn record_finger(record: &mut Record, place: usize, finger: &FingerContact) {
    record.word(&place);
    record.number(weighted(&finger.point.to_array()));
    record.number(weighted(&finger.normal.to_array()));
    let kind = match finger.friction {
        Friction::None => "none",
        Friction::Hard { .. } => "hard",
        _ => "soft",
    };
    record.word(&kind);
    record.numbers(&[finger.friction.mu(), finger.friction.torsion().unwrap_or(-1.0)]);
    for body in [finger.curvature.finger, finger.curvature.object] {
        record.numbers(&body.principal.map(|k| k.min(1e3)));
        record.number(weighted(&body.direction.to_array()));
    }
    record.number(finger.strength);
}

#[test]
fn fingers_of_grippers() {
    check("position_fingers", 36, |random, record| {
        let mechanism = gripper(random);
        let state = mechanism.state(&near_home(random, &mechanism, 0.0)).unwrap();
        let links = mechanism.frames();
        let name = if random.once_in(5) {
            links[random.below(links.len())].name.clone()
        } else {
            ["object", "grip"][random.below(2)].to_owned()
        };
        let frame = mechanism.frame(&name).unwrap();
        let mu = random.once_in(3).then(|| random.within(0.1, 0.9));
        let torsion = (!random.once_in(6)).then(|| random.within(0.0, 0.1));
        let properties = |contact: &Contact| ContactProperties {
            mu,
            torsion,
            strength: contact.name.len() as f64,
        };
        let found = match grasp_contacts(&state, frame, properties) {
            Ok(found) => found,
            Err(error) => return record_error(record, &error),
        };
        for (place, finger) in &found {
            record_finger(record, *place, finger);
        }
        let mut fingers: Vec<FingerContact> = found.into_iter().map(|(_, f)| f).collect();
        for _ in 0..2 {
            let space = WrenchSpace::about(&state, frame, &fingers).unwrap();
            record.number(space.length);
            record.number(weighted(&space.point.to_array()));
            record.word(&space.planar);
            // All at the origin.
            fingers.iter_mut().for_each(|f| f.point = space.point);
        }
    });
}
