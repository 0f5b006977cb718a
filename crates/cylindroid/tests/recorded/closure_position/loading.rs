//! Files whose loops are closed by frames, at the given start, by restarts, or not at all.

use cylindroid::{Mechanism, ParametricModel, Result};

use super::{record_error, weighted};
use crate::record::{Record, check};
use crate::robots::Random;

/// Legs of two or three joints from the ground, and a closure of their ends.
fn text(random: &mut Random<'_>, planar: bool) -> String {
    let mut text = String::from("name = \"legs\"\n");
    if planar {
        text += "dimension = 2\n";
    }
    text += "[parameters]\nlength = { value = 0.7, lower = 0.05, upper = 3.0, unit = \"m\" }\n";
    let joints = 2 + usize::from(random.once_in(4));
    for (leg, base) in [("a", -0.5), ("b", 0.5)] {
        for i in 0..joints {
            let parent = if i == 0 { "ground".to_owned() } else { format!("{leg}{}", i - 1) };
            let x = base + 0.2 * i as f64 * random.within(-1.0, 1.0);
            let y = 0.4 * i as f64;
            let limits = ["", "limits = { lower = -0.6, upper = 0.4 }\n"][random.below(2)];
            let (z, axis) = if planar {
                (String::new(), String::new())
            } else {
                let [x, y, z] = random.vec3(1.0).to_array();
                (", 0".to_owned(), format!("axis = [{x:?}, {y:?}, {z:?}]\n"))
            };
            text += &format!(
                "[[joint]]\nname = \"{leg}{i}\"\ntype = \"revolute\"\nbetween = [\"{parent}\", \
                 \"{leg}{i}\"]\norigin = [{x:?}, {y:?}{z}]\n{axis}{limits}"
            );
        }
        let last = joints - 1;
        let z = random.within(-0.1, 0.1);
        text += &format!("[[frame]]\nname = \"{leg}tip\"\nlink = \"{leg}{last}\"\n");
        text += &if planar {
            "xyz = [\"length\", 0.1, 0]\n".to_owned()
        } else {
            format!("xyz = [\"length\", 0.1, {z:?}]\n")
        };
    }
    let kind = ["point", "axis", "pose"][random.below(3)];
    let axis = if kind == "axis" && !planar { "axis = [0.2, 0.5, 1]\n" } else { "" };
    text += "[[closure]]\nname = \"tie\"\nbetween = [\"atip\", \"btip\"]\n";
    text += &format!("type = \"{kind}\"\n{axis}");
    text
}

fn record_home(record: &mut Record, found: &Result<Mechanism>) {
    match found {
        Ok(mechanism) => {
            record.word(&(mechanism.n(), mechanism.loops().len()));
            record.number(weighted(mechanism.home()));
            record.number(mechanism.reach());
        }
        Err(error) => record_error(record, error),
    }
}

#[test]
fn files_with_closures() {
    check("position_files", 8, |random, record| {
        let planar = random.once_in(2);
        let text = text(random, planar);
        record_home(record, &cylindroid::load_text(&text, "legs.toml".as_ref()));
        let given = random.within(0.1, 1.5);
        let model = ParametricModel::of_text(&text, "legs.toml".as_ref(), &[("length", given)]);
        let model = match model {
            Ok(model) => model,
            Err(error) => return record_error(record, &error),
        };
        record_home(record, &Ok(model.nominal().clone()));
        record.number(model.parameters()[0].value);
        for value in [random.within(0.2, 1.0), 0.01] {
            record_home(record, &model.with(&[("length", value)]));
        }
        record_home(record, &model.with(&[]));
    });
}
