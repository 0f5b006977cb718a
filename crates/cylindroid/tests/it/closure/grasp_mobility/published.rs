//! Grasps whose mobility is published or known in closed form.

use cylindroid::closure::{FingerContact, Immobilisation, grasp_mobility};
use cylindroid::model::SurfaceCurvature;
use cylindroid::spatial::Vec3;

use super::bodies::{Surface, Touch};
use super::{PLANE, POINT, SPACE, around, assert_escapes, assert_found, in_plane, mobility};

/// An equilateral triangle, any triangle, a square and a rectangle at the feet of a common centre;
/// d'' = -(h + a) w^2 for an edge at distance h and a finger of radius a (Rimon & Burdick 1998,
/// part II; Czyzowicz, Stojmenovic & Urrutia 1999).
#[test]
fn polygons_at_the_feet_of_a_centre() {
    let any = [20.0, 150.0, 250.0];
    for (degrees, edges) in
        [(&[30.0, 150.0, 270.0][..], 1), (&any[..], 1), (&[0.0, 90.0, 180.0, 270.0][..], 2)]
    {
        for radius in [0.0, 0.2] {
            for scale in [1.0, 1e-3] {
                let points = in_plane(degrees, scale);
                let touches = around(&points, Surface::Ball(radius * scale), Surface::Flat);
                let found = mobility(&touches, PLANE);
                assert_found(&found, Immobilisation::SecondOrder, (1, 0));
                assert_eq!(found.equilibria.cols(), edges);
                // One turn about the centre, of speed one at the largest distance of the contacts
                // from their own centre.
                let turn = found.free_motions.column(0);
                let expected = -(1.0 + radius) * scale * turn[2] * turn[2];
                assert!((found.curvatures[0] - expected).abs() < 1e-12 / scale, "{found:?}");
            }
        }
    }
    let rectangle = [Vec3::X * 2.0, Vec3::Y, Vec3::X * -2.0, Vec3::Y * -1.0];
    let found = mobility(&around(&rectangle, POINT, Surface::Flat), PLANE);
    assert_found(&found, Immobilisation::SecondOrder, (1, 0));
}

/// Four points between parallel edges that are not opposite: form closure.
#[test]
fn form_closure() {
    let at = |x: f64, y: f64, n: Vec3| Touch {
        point: Vec3::new(x, y, 0.0),
        normal: n,
        finger: POINT,
        object: Surface::Flat,
    };
    let y = Vec3::Y;
    let touches = [
        at(1.0, 0.3, -Vec3::X),
        at(-1.0, -0.3, Vec3::X),
        at(0.3, 1.0, -y),
        at(-0.3, -1.0, y),
        at(0.3, -1.0, y),
    ];
    assert_found(&mobility(&touches, PLANE), Immobilisation::FirstOrder, (0, 0));
    // Four suffice, if the moments of both pairs are opposite; otherwise the object turns away.
    let turning = |s: f64| {
        let pairs = [touches[0], touches[1], at(s, 1.0, -y), at(-s, -1.0, y)];
        mobility(&pairs, PLANE)
    };
    assert_found(&turning(0.3), Immobilisation::FirstOrder, (0, 0));
    let free = turning(-0.3);
    assert_eq!(free.immobilisation, Immobilisation::Mobile);
    assert_eq!((free.first_order_mobility, free.second_order_mobility), (3, None));
}

/// A regular tetrahedron at the centres of its faces (four fingers), a cube (six).
#[test]
fn polyhedra_at_the_centres_of_faces() {
    let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let tetrahedron = [
        corner(1.0, 1.0, 1.0),
        corner(1.0, -1.0, -1.0),
        corner(-1.0, 1.0, -1.0),
        corner(-1.0, -1.0, 1.0),
    ];
    let found = mobility(&around(&tetrahedron, POINT, Surface::Flat), SPACE);
    assert_found(&found, Immobilisation::SecondOrder, (3, 0));
    // The mean over the faces of -h |n x w|^2 is -2/3 h |w|^2, with |w| = 1 / h.
    let h = 3_f64.sqrt();
    assert!(found.curvatures.iter().all(|c| (c + 2.0 / (3.0 * h)).abs() < 1e-12), "{found:?}");
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let cube: Vec<Vec3> = axes.iter().flat_map(|&a| [a, -a]).collect();
    let found = mobility(&around(&cube, POINT, Surface::Flat), SPACE);
    assert_found(&found, Immobilisation::SecondOrder, (3, 0));
    assert_eq!(found.equilibria.cols(), 3);
    // A ball turns between any number of fingers.
    let found = mobility(&around(&cube, POINT, Surface::Ball(1.0)), SPACE);
    assert_found(&found, Immobilisation::HigherOrder, (3, 3));
    // Three points on its equator do not even keep it from falling.
    let three = around(&in_plane(&[0.0, 120.0, 240.0], 1.0), POINT, Surface::Ball(1.0));
    let found = mobility(&three, SPACE);
    assert_found(&found, Immobilisation::Mobile, (4, 4));
}

/// A disc always turns, an ellipse escapes from two fingers, and slides between parallel edges are
/// of higher order.
#[test]
fn grasps_that_do_not_immobilise() {
    for radius in [0.0, 0.4] {
        for degrees in [&[10.0, 130.0, 260.0][..], &[0.0, 90.0, 180.0, 270.0][..]] {
            let disc = around(&in_plane(degrees, 1.0), Surface::Ball(radius), Surface::Ball(1.0));
            let found = mobility(&disc, PLANE);
            assert_found(&found, Immobilisation::HigherOrder, (1, 1));
        }
    }
    // Half axes 2 and 1: curvature b / a^2 at the ends of the small axis, a / b^2 at the others.
    let small = around(&[Vec3::Y, -Vec3::Y], POINT, Surface::Ball(4.0));
    assert_found(&mobility(&small, PLANE), Immobilisation::Mobile, (2, 1));
    let large = around(&[Vec3::X * 2.0, Vec3::X * -2.0], POINT, Surface::Ball(0.5));
    assert_found(&mobility(&large, PLANE), Immobilisation::Mobile, (2, 2));
    let slab = around(&[Vec3::Y, -Vec3::Y], POINT, Surface::Flat);
    assert_found(&mobility(&slab, PLANE), Immobilisation::HigherOrder, (2, 1));
    // No equilibrium.
    for count in 0..3 {
        let side = around(&in_plane(&[60.0, 120.0][..count.min(2)], 1.0), POINT, Surface::Flat);
        let found = mobility(&side, PLANE);
        assert_eq!(found.immobilisation, Immobilisation::Mobile);
        assert_eq!((found.first_order_mobility, found.second_order_mobility), (3, None));
        assert!(found.escape.is_some());
    }
}

/// Two points on an object 2 h apart: immobile with two hollows, and with a hollow of radius r
/// opposite a bulge of radius R > r + 2 h.
#[test]
fn two_fingers_on_a_concave_object() {
    let pair = |first: f64, second: f64| {
        let mut touches = around(&[Vec3::Y * 0.5, Vec3::Y * -0.5], POINT, Surface::Ball(first));
        touches[1].object = Surface::Ball(second);
        mobility(&touches, PLANE)
    };
    assert_found(&pair(-2.0, -0.3), Immobilisation::SecondOrder, (2, 0));
    assert_found(&pair(-1.0, 2.01), Immobilisation::SecondOrder, (2, 0));
    assert_found(&pair(-1.0, 1.99), Immobilisation::Mobile, (2, 1));
    assert_found(&pair(2.0, 2.0), Immobilisation::Mobile, (2, 1));
}

/// Another finger decides which way the object may go: the cone of free motions is a half-line.
#[test]
fn fingers_that_press_in_no_equilibrium() {
    let mut touches = around(&[Vec3::Y, -Vec3::Y], POINT, Surface::Ball(-3.0));
    touches[1].object = Surface::Ball(1.0);
    assert_eq!(mobility(&touches, PLANE).immobilisation, Immobilisation::Mobile);
    // Its own gap does not count to second order.
    touches.push(Touch {
        point: Vec3::X,
        normal: -Vec3::X,
        finger: POINT,
        object: Surface::Ball(0.1),
    });
    let found = mobility(&touches, PLANE);
    assert_eq!(found.immobilisation, Immobilisation::Mobile);
    assert_eq!(found.forces[2], 0.0);
    assert_escapes(&touches, &found, PLANE);
    let held = around(&in_plane(&[30.0, 150.0, 270.0], 1.0), POINT, Surface::Flat);
    let more = [held, vec![touches[2]]].concat();
    assert_found(&mobility(&more, PLANE), Immobilisation::SecondOrder, (1, 0));
}

/// Six sharp fingers on the axes, around a body whose principal curvatures lie across: the best
/// combination of the three equilibria vanishes on two motions, and yet each motion is blocked by
/// one of them. Not proved immobile, and nothing else is claimed.
#[test]
fn no_motion_is_claimed_to_keep_the_gaps_closed() {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let outward: Vec<Vec3> = axes.iter().flat_map(|&a| [a, -a]).collect();
    let mut contacts: Vec<FingerContact> =
        around(&outward, POINT, Surface::Ball(1.0)).iter().map(Touch::contact).collect();
    for (i, contact) in contacts.iter_mut().enumerate() {
        let (j, k) = (axes[(i / 2 + 1) % 3], axes[(i / 2 + 2) % 3]);
        contact.curvature.object =
            SurfaceCurvature { principal: [1.2, 0.4], direction: (j + k) * 0.5_f64.sqrt() };
    }
    let found = grasp_mobility(&contacts, SPACE).unwrap();
    assert_eq!(found.immobilisation, Immobilisation::NotProved, "{found:?}");
    assert_eq!(found.first_order_mobility, 3);
}
