//! Screws that span a screw system.

use cylindroid::Twist;
use cylindroid::screws::{Screw, ScrewSystem};

/// The screws of the normal form if they span the system, otherwise those of a basis.
pub(crate) fn basis_screws(system: &ScrewSystem) -> Vec<Screw> {
    let form = system.normal_form();
    let generators = form.twists();
    let twists: Vec<Twist> = if form.order == system.order() && !generators.is_empty() {
        generators.into_iter().map(|t| system.canonical_pose().adjoint(t)).collect()
    } else {
        system.basis()
    };
    twists.into_iter().filter_map(Screw::of).collect()
}
