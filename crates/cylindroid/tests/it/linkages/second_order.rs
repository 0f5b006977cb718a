//! Second-order rigidity of shaky linkages.

use cylindroid::closure::{FiniteMobility, SecondOrder, SecondOrderRigidity};
use cylindroid::{Mechanism, catalogue};

use super::{names, parsed, text};

fn at_home(m: &Mechanism) -> FiniteMobility {
    FiniteMobility::of(&m.state(m.home()).unwrap(), None).unwrap()
}

fn second_order(text: &str, name: &str) -> Option<SecondOrder> {
    at_home(&parsed(text, name)).second_order
}

#[test]
fn shaky_linkages() {
    use SecondOrderRigidity::{Flexible, PrestressStable};
    for (name, rigidity) in [
        ("cascade0", PrestressStable),
        ("k33_conic", PrestressStable),
        // Rigid, but the loops open with the fifth and eighth power.
        ("watt_slider_0.500", Flexible),
        ("cascade2", Flexible),
        // All three legs stretched: each resists being stretched further.
        ("rrr_IIM_all_stretched_concurrent", PrestressStable),
        // Branches are motions of all orders.
        ("kinematotropic_meet", Flexible),
        ("sarrus_folded", Flexible),
        ("kite_ext", Flexible),
        ("upu_snu", Flexible),
        ("six_parallel", Flexible),
    ] {
        let found = second_order(&text(name), name).unwrap();
        assert_eq!(found.rigidity, rigidity, "{name}: {found:?}");
        assert_eq!(found.motion.cols(), usize::from(rigidity == Flexible), "{name}");
    }
}

/// Where first order decides, there is nothing to say; what is prestress stable is rigid.
#[test]
fn second_order_agrees_with_the_finite_motion() {
    for name in names() {
        let found = at_home(&parsed(&text(&name), &name));
        let shaky = found.finite.is_some_and(|f| f < found.infinitesimal);
        assert_eq!(found.second_order.is_some(), shaky, "{name}");
        let Some(second) = &found.second_order else { continue };
        if !found.branches.is_empty() {
            assert_eq!(second.rigidity, SecondOrderRigidity::Flexible, "{name}");
        }
        // Loops that open with a higher power than the second do not resist to second order.
        if found.infinitesimal == 1 && found.contact_order.is_some_and(|p| p > 2) {
            assert_eq!((second.rigidity, second.forms), (SecondOrderRigidity::Flexible, 0));
        }
    }
    for name in ["five-bar", "stewart", "panda"] {
        assert!(at_home(&catalogue::load(name).unwrap()).second_order.is_none(), "{name}");
    }
}

/// A straight chain of `links` unit links between two pins, in the plane or in space.
fn stretched(links: usize, spherical: bool) -> String {
    let mut file = "name = \"chain\"\nreference = \"b1\"\n".to_owned();
    if !spherical {
        file += "dimension = 2\n";
    }
    for i in 0..=links {
        let link = |i: usize| match i {
            0 => "ground".to_owned(),
            i if i > links => "ground".to_owned(),
            i => format!("b{i}"),
        };
        let kind = if spherical { "spherical" } else { "revolute" };
        file += &format!(
            "\n[[joint]]\nname = \"j{i}\"\ntype = \"{kind}\"\nbetween = [\"{}\", \"{}\"]\n",
            link(i),
            link(i + 1)
        );
        file += &format!("origin = [{i}.0, 0.0{}]\n", if spherical { ", 0.0" } else { "" });
    }
    file
}

/// Tension stabilises every lateral motion of a taut chain; in space its links still spin.
#[test]
fn taut_chains_are_prestress_stable() {
    for links in 2..=5 {
        let text = stretched(links, false);
        let found = at_home(&parsed(&text, "chain"));
        assert_eq!((found.infinitesimal, found.finite), (links - 1, Some(0)), "{found:?}");
        let second = found.second_order.unwrap();
        assert_eq!((second.rigidity, second.forms), (SecondOrderRigidity::PrestressStable, 1));
    }
    let spinning = second_order(&stretched(2, true), "chain").unwrap();
    assert_eq!(spinning.rigidity, SecondOrderRigidity::Flexible);
}
