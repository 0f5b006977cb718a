//! Screws that span a screw system.

use cylindroid::screws::{Screw, ScrewSystem};
use cylindroid::{Twist, Vec3};

/// The screws of the normal form if they span the system, otherwise those of a basis.
pub(crate) fn basis_screws(system: &ScrewSystem) -> Vec<Screw> {
    let form = system.normal_form();
    let generators = form.twists();
    let twists: Vec<Twist> = if form.order == system.order() && !generators.is_empty() {
        generators.into_iter().map(|t| system.canonical_pose().adjoint(t)).collect()
    } else {
        system.basis()
    };
    twists.into_iter().filter_map(|twist| screw(system, twist)).collect()
}

/// The screw of a twist of the system; a translation (or couple) where the rotation is below the
/// accuracy of the system.
fn screw(system: &ScrewSystem, twist: Twist) -> Option<Screw> {
    let linear = twist.linear + twist.angular.cross(system.center());
    if twist.angular.norm() * system.length() <= system.tolerance() * linear.norm() {
        return Screw::of(Twist { linear, angular: Vec3::ZERO });
    }
    Screw::of(twist)
}

#[cfg(test)]
mod tests {
    use cylindroid::Rotation;
    use cylindroid::screws::ScrewOptions;

    use super::*;

    /// Slides and parallel axes have couples among their reciprocal screws, in any frame.
    #[test]
    fn couples_have_infinite_pitch() {
        let slide = |v: Vec3| Twist { linear: v, angular: Vec3::ZERO };
        let axis = |p: Vec3, w: Vec3| Twist { linear: p.cross(w), angular: w };
        let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
        let systems = [
            (vec![slide(x), slide(y), slide(z)], 3),
            (vec![axis(x, z), axis(y, z), axis(-x, z)], 2),
            (vec![axis(x, z), axis(y, z), axis(-x, z), slide(z)], 2),
            (vec![axis(z, x), axis(x, z), slide(y)], 1),
        ];
        for (round, (twists, least)) in (0..40).flat_map(|r| systems.iter().map(move |s| (r, s))) {
            let turn = f64::from(round);
            let rotation = Rotation::exp(Vec3::new(0.3 + turn, 0.7 * turn, -0.2));
            let pose =
                cylindroid::Pose { rotation, translation: Vec3::new(turn, -0.3, 1.1 * turn) };
            let moved: Vec<Twist> = twists.iter().map(|t| pose.adjoint(*t)).collect();
            let system = ScrewSystem::of(&moved, &ScrewOptions::default()).unwrap();
            let screws = basis_screws(&system.reciprocal());
            let couples = screws.iter().filter(|s| s.is_translation()).count();
            assert!(couples >= *least, "{screws:?}");
            let far = screws.iter().find(|s| !s.is_translation() && s.pitch.abs() > 1e6);
            assert!(far.is_none(), "{far:?}");
        }
    }
}
