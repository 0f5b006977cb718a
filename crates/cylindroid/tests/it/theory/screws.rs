//! Errata S1 to S21 of docs/theory/screws.md: Donelan & Selig, hyperbolic pseudoinverses. Twists
//! are written angular first here, as in the paper.

use cylindroid::Matrix;
use cylindroid::inverse::{self, HyperbolicDamping, HyperbolicOptions, point_direction};
use cylindroid::linalg::Svd;
use cylindroid::screws::{
    Class, Line, Screw, ScrewOptions, ScrewSystem, gram, gram_determinant, involution, transversals,
};
use cylindroid::spatial::{Twist, Vec3, Wrench};

use super::paper_order::{columns, lines, rank, system, twist};
use crate::support::{Random, assert_close, assert_matrix};

/// The three lines of example 1, and the twist of example 4.
const EXAMPLE_1: [[f64; 6]; 3] = [
    [1.0, 0.0, 0.0, 0.0, -1.0, 0.5],
    [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, -2.0, 1.0, 0.0],
];
const EXAMPLE_4: [f64; 6] = [0.0, 0.6, 0.8, 1.0, -0.8, 0.6];

/// S1: two sets of four independent lines in involution without infinitely many transversals.
#[test]
fn erratum_four_lines_in_involution() {
    let one = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0, 0.0, -2.0, 2.0],
    ];
    let none = [
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 1.0, -1.0, 0.0, 1.0],
        [1.0, 0.0, -1.0, -1.0, 0.0, -1.0],
    ];
    for set in [one, none] {
        assert_eq!(rank(&columns(&set)), 4);
        assert!(gram_determinant(&columns(&set), 0.0).unwrap().abs() < 1e-14);
    }
    let found = involution(&lines(&one), &ScrewOptions::default()).unwrap();
    assert!(found.in_involution && found.independent);
    assert_eq!(found.system.reciprocal().class(), Class::IA);
    let mut pitches = found.system.reciprocal().principal_pitches();
    pitches.sort_by(f64::total_cmp);
    assert_close("pitches", &pitches, &[-0.4, 0.0], 1e-12);
    let common = found.transversals;
    assert!(common.double && !common.infinitely_many && common.lines.len() == 1);
    assert!(common.lines[0].direction.cross(Vec3::X).norm() < 1e-7);

    let found = involution(&lines(&none), &ScrewOptions::default()).unwrap();
    assert!(found.in_involution && found.independent);
    assert_eq!(found.system.reciprocal().class(), Class::IIB);
    let across = found.system.reciprocal();
    assert_close("pitch", &across.normal_form().pitches, &[1.0], 1e-12);
    assert!(found.transversals.lines.is_empty() && !found.transversals.infinitely_many);
}

/// Four independent lines in the system reciprocal to screws along x and y of these pitches, if
/// there are any.
fn lines_across(h: [f64; 2], random: &mut Random) -> Vec<Line> {
    let [a, b] = h;
    // (w; v) is reciprocal to (e1; a e1) and (e2; b e2): v = (-a w1, -b w2, v3), v3 w3 chosen so
    // that the pitch is zero.
    (0..4)
        .map(|_| {
            let w = Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), 1.0);
            let v3 = a * w.x * w.x + b * w.y * w.y;
            Screw::of(twist([w.x, w.y, w.z, -a * w.x, -b * w.y, v3])).unwrap().axis
        })
        .collect()
}

/// S1b: reciprocal to IA two transversals, none or a double one, by the signs of the pitches.
#[test]
fn erratum_count_of_transversals() {
    let mut random = Random(91);
    for (pitches, count) in [([1.0, -2.0], 2), ([1.0, 2.0], 0), ([1.0, 0.0], 1)] {
        let four = lines_across(pitches, &mut random);
        let twists: Vec<Twist> = four.iter().map(Line::twist).collect();
        let system = ScrewSystem::of(&twists, &ScrewOptions::default()).unwrap();
        assert_eq!((system.order(), system.class()), (4, Class::IA));
        let common = transversals(&four, &ScrewOptions::default()).unwrap();
        assert_eq!((common.lines.len(), common.double), (count, count == 1), "{pitches:?}");
    }
    // Reciprocal to (1,0,0; 0,0,0) and (0,0,0; 1,1,0), class IB: lines that meet the x axis, with
    // w1 + w2 = 0.
    let four = [
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 1.0, 0.0],
        [1.0, -1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, -1.0, 0.0, 0.0, 0.0, 1.0],
    ];
    assert_eq!(system(&four).class(), Class::IB);
    let common = transversals(&lines(&four), &ScrewOptions::default()).unwrap();
    assert_eq!((common.lines.len(), common.double), (1, false));
}

/// S2: five independent lines parallel to a plane are in involution; their transversal is at
/// infinity.
#[test]
fn erratum_five_lines_parallel_to_a_plane() {
    let five = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 1.0, 0.0, -1.0, 0.0, 0.0],
    ];
    let found = involution(&lines(&five), &ScrewOptions::default()).unwrap();
    assert!(found.in_involution && found.independent);
    assert_eq!(found.system.class(), Class::Inf);
    assert!(found.transversals.lines.is_empty());
    assert!(found.transversals.at_infinity[0].cross(Vec3::Z).norm() < 1e-12);
}

/// S3: the null twist of three lines is a translation, the wrench that loads no joint a couple.
#[test]
fn erratum_null_twist_may_be_a_translation() {
    let three = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, -1.0, 0.0, 0.0],
    ];
    let found = involution(&lines(&three), &ScrewOptions::default()).unwrap();
    assert!(found.in_involution && found.independent);
    assert_eq!(found.system.class(), Class::IB3);
    assert!(found.null_screw.unwrap().is_translation());
    let wrench = found.wrench.unwrap();
    assert_eq!(wrench.force, Vec3::ZERO);
    assert!(wrench.moment.cross(Vec3::Z).norm() < 1e-12 && wrench.moment.norm() > 0.1);
    for s in three {
        assert!(twist(s).power(wrench).abs() < 1e-12);
    }
}

/// S4: a system in the tangent space at a point outside itself has a pseudoinverse.
#[test]
fn erratum_point_of_tangency_in_the_system() {
    let (s, z) = ([1.0, 0.0, 0.0, 1.0, 0.0, 0.0], twist([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]));
    assert_eq!(z.klein(z), 0.0);
    assert_eq!(twist(s).klein(z), 0.0);
    assert_eq!(twist(s).klein(twist(s)), 1.0);
    assert!(inverse::hyperbolic(&columns(&[s]), 0.0).unwrap().exists);
}

/// S5: eleven types have no pseudoinverse for any pitch, five of them of order 3; IID is one.
#[test]
fn erratum_eleven_types_without_inverse() {
    let (p, q) = (0.5, -0.3);
    let screw = |i: usize, pitch: f64| {
        let mut s = [0.0; 6];
        (s[i], s[i + 3]) = (1.0, pitch);
        s
    };
    let slide = |v: [f64; 3]| [0.0, 0.0, 0.0, v[0], v[1], v[2]];
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(slide);
    let low: [(Class, Vec<[f64; 6]>); 8] = [
        (Class::Inf, vec![x]),
        (Class::IIB, vec![screw(0, p), y]),
        (Class::IIC, vec![x, y]),
        (Class::IB3, vec![screw(0, p), screw(1, q), z]),
        (Class::IC, vec![screw(0, 0.0), y, slide([1.0, 0.0, p])]),
        (Class::IIB, vec![screw(0, p), screw(1, p), z]),
        (Class::IIC, vec![screw(0, p), y, z]),
        (Class::IID, vec![x, y, z]),
    ];
    let mut never = 0;
    for (class, basis) in low {
        let below = system(&basis);
        assert_eq!((below.order(), below.class()), (basis.len(), class));
        let dual = below.reciprocal();
        let both = if below.order() < 3 { vec![below, dual] } else { vec![below] };
        for found in both {
            never += 1;
            let j = Matrix::from_fn(6, found.order(), |r, c| found.basis()[c].to_array()[r]);
            for h in [-2.0, -0.5, 0.0, 0.3, 0.5, 1.7] {
                assert!(!inverse::hyperbolic(&j, h).unwrap().exists, "{class} {h}");
                assert!(gram_determinant(&j, h).unwrap().abs() < 1e-14, "{class} {h}");
            }
        }
    }
    assert_eq!(never, 11);
    assert_eq!(gram(&columns(&[x, y, z]), 0.7).unwrap().max_abs(), 0.0);
}

/// S6: the basis printed beside 2-IIB is not reciprocal to it and has pseudoinverses.
#[test]
fn erratum_reciprocal_of_2_iib() {
    let p = 0.5;
    let two = system(&[[1.0, 0.0, 0.0, p, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]]);
    let (wrong, right) = ([0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(twist(wrong).klein(twist([0.0, 0.0, 0.0, 0.0, 1.0, 0.0])), 0.5);
    let four = |second| {
        [
            [1.0, 0.0, 0.0, -p, 0.0, 0.0],
            second,
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ]
    };
    for h in [-1.0, 0.3, 2.0] {
        // Over 2 Q_h: 16 times that over Q_h.
        let printed = gram_determinant(&columns(&four(wrong)), h).unwrap();
        assert!((16.0 * printed + 4.0 * h * (h + p)).abs() < 1e-13);
        assert!(inverse::hyperbolic(&columns(&four(wrong)), h).unwrap().exists);
        assert!(!inverse::hyperbolic(&columns(&four(right)), h).unwrap().exists);
    }
    for t in four(right) {
        assert!(two.reciprocal().contains(twist(t)));
    }
    assert!(!two.reciprocal().contains(twist(wrong)));
}

/// The twists that move the point x along q: rotations about x, and the translation along q.
fn directions_of(x: Vec3, q: Vec3) -> [Twist; 4] {
    let about = |e: Vec3| Twist { linear: x.cross(e), angular: e };
    [about(Vec3::X), about(Vec3::Y), about(Vec3::Z), Twist { linear: q, angular: Vec3::ZERO }]
}

/// S7: one joint motion moves the point along the direction; the image of all twists that do so
/// under a pseudoinverse is the whole joint space.
#[test]
fn erratum_joint_velocities_of_a_point() {
    let j = columns(&EXAMPLE_1);
    let found = point_direction(&j, Vec3::X, Vec3::X).unwrap();
    assert_eq!(found.still.cols(), 0);
    assert_close("joint velocities", &found.along.unwrap(), &[0.0, 1.0, -0.5], 1e-14);
    let s = directions_of(Vec3::X, Vec3::X);
    let s = Matrix::from_fn(6, 4, |r, c| s[c].to_array()[r]);
    assert_eq!(rank(&(&inverse::hyperbolic(&j, 1.0).unwrap().matrix * &s)), 3);
}

/// S8: those twists are no subalgebra; their class is IIA with pitch zero.
#[test]
fn erratum_twists_of_a_point_are_no_subalgebra() {
    let s = directions_of(Vec3::ZERO, Vec3::X);
    let four = ScrewSystem::of(&s, &ScrewOptions::default()).unwrap();
    let bracket = s[1].bracket(s[3]);
    assert_eq!(bracket, twist([0.0, 0.0, 0.0, 0.0, 0.0, -1.0]));
    assert!(!four.contains(bracket));
    assert_eq!((four.order(), four.class()), (4, Class::IIA));
    assert!(four.principal_pitches().iter().all(|h| h.abs() < 1e-14));
}

/// S9: all entries of the pseudoinverse of example 1, and that the third law fails as printed.
#[test]
fn erratum_entry_of_example_1() {
    let j = columns(&EXAMPLE_1);
    for h in [0.3, -0.7, 2.0, 11.0] {
        let square = 16.0 * h * h + 16.0 * h;
        // Columns in the order of the paper.
        let right = [
            [1.0, -0.5, 0.0, 0.0, 0.0, 0.0],
            [3.0 / 16.0 / h, -(square + 3.0) / 32.0 / h, 1.0, 0.5, 0.0, -3.0 / 8.0 / h],
            [1.0 / 16.0 / h, (square - 1.0) / 32.0 / h, 0.0, -0.5, 0.0, -1.0 / 8.0 / h],
        ];
        let linear_first = |rows: [[f64; 6]; 3]| Matrix::from_fn(3, 6, |r, c| rows[r][(c + 3) % 6]);
        let found = inverse::hyperbolic(&j, h).unwrap().matrix;
        assert_matrix("J+h", &found, &linear_first(right), 1e-12);
        let mut printed = right;
        printed[2][1] = (square + 3.0) / 32.0 / h;
        let printed = linear_first(printed);
        assert_matrix("(hP1) cannot tell", &(&(&j * &printed) * &j), &j, 1e-13);
        let law = |inverse: &Matrix| {
            let p = &j * inverse;
            let lowered = Matrix::from_fn(6, 6, |r, c| {
                let column: [f64; 6] = p.column(c).try_into().unwrap();
                Twist::from_array(column).lowered(h).to_array()[r]
            });
            lowered.max_difference(&lowered.transpose())
        };
        assert!(law(&found) < 1e-12 && law(&printed) > 0.05, "{h}");
    }
}

/// S10 and S21: determinant and error are an eighth and half of the printed ones, which belong to
/// twice the form; the twist of example 4 gives the printed joint velocities.
#[test]
fn erratum_factor_of_the_form() {
    let j = columns(&EXAMPLE_1);
    let s = twist(EXAMPLE_4);
    let root = 3.0 * 21.0_f64.sqrt();
    for h in [0.3, -0.7, 2.0, (root - 8.0) / 20.0, -(root + 8.0) / 20.0] {
        assert!((gram_determinant(&j, h).unwrap() - h).abs() < 1e-13);
        let v = inverse::hyperbolic(&j, h).unwrap().matrix.mul_vec(&s.to_array());
        let expected =
            [-48.0 * h, -48.0 * h * h + 160.0 * h - 45.0, 48.0 * h * h - 32.0 * h - 15.0]
                .map(|x| x / (160.0 * h));
        assert_close("v", &v, &expected, 1e-12);
        let moved: [f64; 6] = j.mul_vec(&v).try_into().unwrap();
        let rest = s - Twist::from_array(moved);
        let phi = -9.0 * (80.0 * h * h + 64.0 * h - 25.0) / (1600.0 * h);
        assert!((rest.pitch_form(rest, h) - phi).abs() < 1e-12);
    }
}

/// S11: the inverse form carries a factor of two.
#[test]
fn erratum_inverse_form() {
    let s = twist([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let wrench = s.lowered(0.0);
    assert_eq!(wrench, Wrench { force: Vec3::Z * 0.5, moment: Vec3::Z * 0.5 });
    assert_eq!(wrench.raised(0.0), s);
    let h = 0.7;
    // Printed: (w; v) = (f; m + 2 h f) for the wrench with moment m and force f.
    let lowered = s.lowered(h);
    let printed =
        Twist { linear: lowered.moment + lowered.force * (2.0 * h), angular: lowered.force };
    assert!((printed * 2.0 - s).linear.norm() < 1e-15);
    assert!((lowered.raised(h) - s).linear.norm() < 1e-15);
}

/// S12: the form of infinite pitch is a quarter of the Killing form.
#[test]
fn erratum_quarter_of_the_killing_form() {
    let s = twist([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    // The trace of the bracket applied twice.
    let trace: f64 = (0..6)
        .map(|i| {
            let unit = Twist::from_array(std::array::from_fn(|k| f64::from(u8::from(k == i))));
            s.bracket(s.bracket(unit)).to_array()[i]
        })
        .sum();
    assert_eq!(trace, -4.0);
    assert_eq!(s.killing(s), trace);
    assert_eq!(s.pitch_form(s, f64::INFINITY), 0.25 * trace);
}

/// S13: a 3-system with infinitely many lines that span only two dimensions.
#[test]
fn erratum_lines_that_do_not_span() {
    let s = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
    ];
    // The Klein form is diag(0, 0, 1): its zeros are the combinations of the first two.
    let expected = Matrix::diagonal(&[0.0, 0.0, 1.0]);
    assert_eq!(gram(&columns(&s), 0.0).unwrap(), expected);
    let mut pencil = Vec::new();
    for i in 0..5 {
        let (sin, cos) = f64::from(i).sin_cos();
        pencil.push([cos, sin, 0.0, 0.0, 0.0, 0.0]);
    }
    let spanned = ScrewSystem::of(
        &lines(&pencil).iter().map(Line::twist).collect::<Vec<_>>(),
        &ScrewOptions::default(),
    );
    assert_eq!((spanned.unwrap().order(), system(&s).order()), (2, 3));
}

/// S14: forces along two crossing lines do not balance, but load no joint on them; for six lines
/// the determinant is that of the matrix, squared.
#[test]
fn erratum_forces_that_do_no_work() {
    let two = [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]];
    let found = involution(&lines(&two), &ScrewOptions::default()).unwrap();
    assert!(found.in_involution && found.independent);
    for along in two {
        // A force along the line (w; v) is the wrench with the force w and the moment v.
        let s = twist(along);
        let force = Wrench { force: s.angular, moment: s.linear };
        assert!(two.iter().all(|t| twist(*t).power(force) == 0.0));
    }
    let mut random = Random(92);
    for _ in 0..20 {
        let six: Vec<Twist> = (0..6)
            .map(|_| Line::through(random.vec3(1.0), random.vec3(1.0)).unwrap().twist())
            .collect();
        let j = Matrix::from_fn(6, 6, |r, c| six[c].to_array()[r]);
        let product: f64 = Svd::of(&j).values().product();
        let determinant = gram_determinant(&j, 0.0).unwrap();
        assert!((determinant + product * product / 64.0).abs() < 1e-14);
    }
}

/// S15: with a positive damping that is the negative of an eigenvalue there is no inverse, and the
/// damped form is no projector.
#[test]
fn erratum_positive_damping_may_be_singular() {
    let damped = |j: &Matrix, lambda: f64| {
        let damping = HyperbolicDamping::Gram { lambda };
        let options = HyperbolicOptions { damping, ..HyperbolicOptions::default() };
        inverse::hyperbolic_with(j, 1.0, &options).unwrap()
    };
    assert!(!damped(&columns(&[[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]), 1.0).exists);
    let j = columns(&EXAMPLE_1);
    for lambda in [1.239_190_518_700_43, 2.138_216_698_703_48] {
        let mut g = gram(&j, 1.0).unwrap();
        (0..3).for_each(|i| g[(i, i)] += lambda);
        assert!(Svd::of(&g).value(2) < 1e-13);
        // The digits are those of the page; nearer to the eigenvalue it is said not to exist.
        let found = damped(&j, lambda);
        assert!(!found.exists || found.matrix.max_abs() > 1e8);
    }
    let p = &j * &damped(&j, 0.5).matrix;
    assert!((&p * &p).max_difference(&p) > 0.1);
}

/// S16: the error of two screws of opposite pitch is a saddle.
#[test]
fn erratum_stationary_point_is_a_saddle() {
    let j = columns(&[[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, -1.0, 0.0]]);
    let phi = |x: [f64; 2]| {
        let moved: [f64; 6] = j.mul_vec(&x).try_into().unwrap();
        Twist::from_array(moved).klein(Twist::from_array(moved))
    };
    assert_eq!((phi([1.0, 0.0]), phi([0.0, 1.0]), phi([2.0, 1.0])), (1.0, -1.0, 3.0));
    assert!(inverse::hyperbolic(&j, 0.0).unwrap().exists);
}

/// S17: a 4-system of class IA contains a translation.
#[test]
fn erratum_type_a_of_order_four_has_translations() {
    let four = system(&[
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ]);
    assert_eq!((four.order(), four.class()), (4, Class::IA));
    assert!(four.contains(twist([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])));
    for s in [[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, -1.0, 0.0]] {
        assert!(four.reciprocal().contains(twist(s)));
    }
    assert!(four.existence(0.3).exists);
}

/// S18: the system reciprocal to a screw of pitch 2 fails at -2 and not at 2; the h-reciprocal one
/// adds 2 h to the pitch of the reciprocal one.
#[test]
fn erratum_sign_of_the_reciprocal_pitch() {
    let one = system(&[[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]]);
    let five = one.reciprocal();
    assert!(!five.existence(-2.0).exists && five.existence(2.0).exists);
    for h in [-1.0, 0.25, 3.0] {
        let z = twist([1.0, 0.0, 0.0, 2.0 + 2.0 * h, 0.0, 0.0]);
        assert!(five.h_reciprocal(h).contains(z), "{h}");
    }
}

/// S19: seven joints on one screw: the pseudoinverse depends on the pitch and is not that of Moore
/// and Penrose.
#[test]
fn erratum_seven_joints_of_rank_one() {
    let s = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let j = columns(&[s; 7]);
    let plain = inverse::truncated(&j, 1e-12).unwrap().matrix;
    let row: Vec<f64> = twist(s).to_array().map(|x| x / 14.0).to_vec();
    assert_close("Moore-Penrose", plain.transpose().column(0), &row, 1e-15);
    for h in [0.0, 0.5, -2.0] {
        let found = inverse::hyperbolic(&j, h).unwrap().matrix.transpose();
        let row = twist([1.0 - 2.0 * h, 0.0, 0.0, 1.0, 0.0, 0.0]).to_array();
        let row: Vec<f64> = row.map(|x| x / (14.0 * (1.0 - h))).to_vec();
        (0..7).for_each(|i| assert_close("J+h", found.column(i), &row, 1e-14));
        // Both take the screw itself to the same joint velocities.
        let moved = found.transpose().mul_vec(&twist(s).to_array());
        assert_close("joint velocities", &moved, &[1.0 / 7.0; 7], 1e-14);
    }
}

/// S20: the basis reciprocal to 3-IC.
#[test]
fn erratum_reciprocal_of_3_ic() {
    let p = 0.4;
    let three = system(&[
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0, p],
    ]);
    assert_eq!(three.class(), Class::IC);
    let basis = [
        [-p, 0.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ];
    assert!(basis.iter().all(|s| three.reciprocal().contains(twist(*s))));
    assert_eq!(system(&basis).class(), Class::IC);
}
