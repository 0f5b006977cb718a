//! Operation modes of linkages that are known for theirs.

use cylindroid::closure::{ClosedChain, ModeOptions, OperationModes, operation_modes};
use cylindroid::screws::Class;
use cylindroid::{Mechanism, catalogue};

use super::{parsed, text};

fn modes_of(m: &Mechanism) -> OperationModes {
    let options = ModeOptions { starts: 32, ..ModeOptions::default() };
    let found = operation_modes(m, m.home(), None, options).unwrap();
    assert_eq!(found.starts, 32);
    assert!(found.closed <= found.starts && found.undecided <= found.closed);
    for mode in &found.modes {
        // Every representative is closed, and its dimension no more than its first-order motions.
        let state = m.state(&mode.configuration).unwrap();
        let chain = ClosedChain::of(&state, None, None).unwrap();
        assert!(chain.closure_error.is_closed(m.reach()), "{}: {mode:?}", m.name());
        assert!(mode.dimension <= mode.dof && mode.found > 0, "{}: {mode:?}", m.name());
    }
    found
}

/// Dimension, idle and indeterminate motions, class, and whether the home lies on it.
type Seen = (usize, usize, usize, Class, bool);

fn seen(found: &OperationModes) -> Vec<Seen> {
    let of = |m: &cylindroid::closure::OperationMode| {
        (m.dimension, m.counts.idle, m.counts.indeterminacy, m.class, m.through)
    };
    found.modes.iter().map(of).collect()
}

#[test]
fn modes_that_meet_at_home() {
    for (name, modes, dof) in [
        // The slider moves, or rests while the folded links turn about it.
        ("kinematotropic_meet", [(2, 1, 0, Class::Zero, true), (1, 0, 0, Class::Inf, true)], 3),
        ("sarrus_folded", [(2, 1, 0, Class::Zero, true), (1, 0, 0, Class::Inf, true)], 3),
        // Folded, the kite turns about one of its joints: the crank and the coupler alone.
        ("kite_ext", [(1, 0, 0, Class::H, true), (1, 0, 1, Class::H, true)], 2),
    ] {
        let m = parsed(&text(name), name);
        let found = modes_of(&m);
        assert_eq!(seen(&found), modes, "{name}");
        assert_eq!(found.meetings.len(), 1, "{name}");
        let meeting = &found.meetings[0];
        let mut met = meeting.modes.clone();
        met.sort_unstable();
        assert_eq!((met, meeting.dof), (vec![0, 1], dof), "{name}");
        assert_eq!(meeting.configuration, m.home(), "{name}");
        // More freedom than on either mode.
        assert!(found.modes.iter().all(|mode| meeting.dof > mode.dof), "{name}");
        assert!(found.modes.iter().all(|mode| meeting.counts.rank < mode.counts.rank), "{name}");
    }
}

#[test]
fn modes_elsewhere() {
    for (name, least) in [
        ("sarrus", &[(2, 1, 0, Class::Zero, false), (1, 0, 0, Class::Inf, true)][..]),
        ("kinematotropic_2dof", &[(2, 1, 0, Class::Zero, true), (1, 0, 0, Class::Inf, false)]),
        // The rhombus folds, and both halves turn on their own.
        ("peaucellier", &[(2, 0, 1, Class::IIB, false), (1, 0, 0, Class::H, true)]),
        // All legs with parallel planes: the actuators rest, the platform does not.
        ("upu_snu", &[(3, 0, 0, Class::IIB, true), (3, 0, 2, Class::IID, true)]),
        // Translations, planar and general motions.
        (
            "upu_tsai",
            &[
                (3, 0, 0, Class::IA1, false),
                (3, 0, 0, Class::IIC, false),
                (3, 0, 0, Class::IID, true),
            ],
        ),
        ("h4_par_0.1_0.3_0.3_0.1", &[(1, 0, 0, Class::Inf, true), (0, 0, 0, Class::Zero, false)]),
        // The platform turns, or rests while the legs turn.
        ("agile_eye_home", &[(3, 0, 0, Class::IIA, true), (3, 0, 0, Class::Zero, false)]),
    ] {
        let found = seen(&modes_of(&parsed(&text(name), name)));
        for mode in least {
            assert!(found.contains(mode), "{name}: {mode:?} of {found:?}");
        }
    }
}

#[test]
fn single_modes() {
    for (name, mode) in [
        ("bennett", (1, 0, 0, Class::H, true)),
        ("goldberg5r", (1, 0, 0, Class::H, true)),
        ("schatz", (1, 0, 0, Class::H, true)),
        ("fb_dead_crank", (1, 0, 0, Class::H, true)),
        ("rrr_RO_concurrent", (3, 0, 0, Class::IIC, true)),
        ("par3_generic", (1, 0, 0, Class::Inf, true)),
        ("arch_similar", (6, 0, 1, Class::Full, true)),
        ("griffis_duffy_a", (1, 0, 1, Class::H, true)),
        // Isolated, and all assemblies from restarts near it.
        ("cascade0", (0, 0, 0, Class::Inf, true)),
        ("cascade2", (0, 0, 0, Class::Inf, true)),
    ] {
        assert_eq!(seen(&modes_of(&parsed(&text(name), name))), [mode], "{name}");
    }
    // An arm, a parallel robot, and the elbows of a five-bar: one mode each.
    for (name, dimension) in [("ur5e", 6), ("stewart", 6), ("five-bar", 2), ("four-bar", 1)] {
        let found = modes_of(&catalogue::load(name).unwrap());
        let dimensions: Vec<usize> = found.modes.iter().map(|m| m.dimension).collect();
        assert_eq!((dimensions, found.closed), (vec![dimension], 32), "{name}");
        assert_eq!(found.modes[0].found, 32, "{name}");
        assert!(found.unseen_probability() == 0.0 && found.meetings.is_empty(), "{name}");
    }
}

/// Random restarts belong to the names of the coordinates.
#[test]
fn modes_do_not_depend_on_the_order_of_tables() {
    for name in ["kinematotropic_meet", "sarrus_folded", "kite_ext", "upu_tsai"] {
        let original = text(name);
        let mut table: toml::Table = original.parse().unwrap();
        table.get_mut("joint").and_then(toml::Value::as_array_mut).unwrap().reverse();
        let reversed = table.to_string();
        let [a, b] = [&original, &reversed].map(|t| modes_of(&parsed(t, name)));
        assert_eq!(seen(&a), seen(&b), "{name}");
    }
}

#[test]
fn starts_and_configurations_are_checked() {
    let m = catalogue::load("four-bar").unwrap();
    let none = ModeOptions { starts: 0, ..ModeOptions::default() };
    assert!(operation_modes(&m, m.home(), None, none).is_err());
    assert!(operation_modes(&m, &[0.0], None, ModeOptions::default()).is_err());
    // Open loops are closed first.
    let one = ModeOptions { starts: 1, ..ModeOptions::default() };
    let found = operation_modes(&m, &[0.3, 0.0, 0.0], None, one).unwrap();
    assert_eq!((found.closed, found.modes.len(), found.modes[0].through), (1, 1, true));
}
