//! `[[elasticity]]` tables of mechanism files.

use cylindroid::Vec3;
use cylindroid::model::{ElasticKind, Mechanism};

use crate::{read_toml, refused};

pub(crate) const BARS: &str = "dimension = 2\nreference = \"b\"\n\
    [[joint]]\nname = \"q1\"\ntype = \"revolute\"\nbetween = [\"ground\", \"a\"]\norigin = [0, 0]\n\
    actuated = true\n\
    [[joint]]\nname = \"q2\"\ntype = \"revolute\"\nbetween = [\"a\", \"b\"]\norigin = [0, 2]\n\
    [[joint]]\nname = \"q3\"\ntype = \"revolute\"\nbetween = [\"b\", \"c\"]\norigin = [2, 2]\n\
    [[joint]]\nname = \"q4\"\ntype = \"revolute\"\nbetween = [\"c\", \"ground\"]\norigin = [2, 0]\n";

pub(crate) const PARTS: &str = "[[elasticity]]\njoint = \"q1\"\nstiffness = 500\ncompliance = [1e-6, 2e-6, 0]\n\
    [[elasticity]]\nlink = \"a\"\npoint = [0, 2]\n\
    compliance = [[1e-5, 0, -2e-5], [0, 1e-9, 0], [-2e-5, 0, 5e-5]]\n\
    [[elasticity]]\njoint = \"q4\"\ncompliance = [1e-7, 1e-7, 0]\n";

fn read(text: &str) -> Mechanism {
    read_toml(text).unwrap()
}

#[test]
fn joints_and_links_have_elasticity() {
    let m = read(&format!("{BARS}{PARTS}"));
    let elements = &m.elasticity().elements;
    let names: Vec<&str> = elements.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["q1", "q1", "a", "q4"]);
    assert_eq!(elements[0].kind, ElasticKind::Motion { stiffness: 500.0 });
    let ElasticKind::Joint(bearing) = &elements[1].kind else { panic!("{elements:?}") };
    assert_eq!(bearing.compliance.column(1), [0.0, 2e-6, 0.0]);
    let ElasticKind::Link(beam) = &elements[2].kind else { panic!("{elements:?}") };
    assert_eq!(beam.compliance.column(2), [-2e-5, 0.0, 5e-5]);
    let (link, pose) = beam.frame.as_ref().unwrap();
    // The frame of a is at q1.
    assert_eq!((link.as_str(), pose.translation), ("a", Vec3::Y * 2.0));
    // Of a joint: at its origin, fixed to the first of its links.
    let ElasticKind::Joint(bearing) = &elements[3].kind else { panic!("{elements:?}") };
    let (link, pose) = bearing.frame.as_ref().unwrap();
    assert_eq!((link.as_str(), pose.translation), ("c", -Vec3::Y * 2.0));
}

#[test]
fn wrong_elasticity_is_refused_at_its_place() {
    let all = format!("{BARS}{PARTS}");
    assert!(read(&all).elasticity().elements.len() == 4);
    for (from, to, message) in [
        ("joint = \"q1\"\nstiffness", "joint = \"q9\"\nstiffness", "q9"),
        ("link = \"a\"\npoint", "link = \"z\"\npoint", "no link named 'z'"),
        ("link = \"a\"\npoint", "link = \"ground\"\npoint", "root"),
        ("stiffness = 500", "stiffness = -5", "positive"),
        ("compliance = [1e-6, 2e-6, 0]", "compliance = [1e-6, 2e-6]", "3 rows"),
        ("[0, 1e-9, 0]", "[0, 1e-9]", "3 rows"),
        ("[0, 1e-9, 0]", "[0, 1e-9, 7]", "symmetric"),
        ("point = [0, 2]\n", "", "no point"),
        ("link = \"a\"\npoint", "link = \"a\"\njoint = \"q1\"\npoint", "of one joint"),
        ("compliance = [1e-7, 1e-7, 0]", "", "no compliance"),
        ("link = \"a\"\n", "link = \"a\"\nstiffness = 1\n", "only joints"),
    ] {
        let text = all.replace(from, to);
        assert_ne!(text, all, "{from}");
        let error = refused(&text, read_toml(&text));
        assert!(error.message.contains(message), "{to}: {}", error.message);
    }
}
