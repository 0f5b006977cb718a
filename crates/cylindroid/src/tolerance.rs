//! Tolerances: every threshold of the library, named, with its unit and derivation.
//!
//! Users see them as defaults of options. Code never compares with a literal number.
//!
//! Checked  tests/it/ (by the tests of the code that uses them)

use std::ops::RangeInclusive;

/// Below this angle (rad) the coefficients of exp, log and their derivatives use Taylor series.
///
/// The series keep seven terms, so their truncation error at the switch is below 1e-17 relative.
/// Above it the worst closed form, `(1 - t^2/2 - cos t) / t^4`, loses `eps / t^4 = 4e-15`, and
/// multiplies a product of size `t^2 |v|`: at most 1e-15 |v| in the result.
pub const SMALL_ANGLE: f64 = 0.5;

/// Where the square of the tangent of half the angle is below this, the logarithm of a rotation
/// uses six terms of a series for the arc tangent, for speed alone: the seventh is below 1e-19.
pub const SMALL_TANGENT: f64 = 1e-3;

/// Largest entry of `R^T R - 1` of a rotation given as numbers, which files print with six digits.
pub const ORTHONORMAL: f64 = 1e-5;

/// Position limits farther apart than this [rad or m] stand for none where configurations are drawn
/// within them: files write 1e5 or 1e6 for a wheel or a mobile base.
pub const WIDEST_RANGE: f64 = 1e3;

/// Numbers of models, configurations, velocities and poses are at most this in magnitude: their
/// squares and the products with one another are finite, so that finite input gives finite results.
pub const MAX_MAGNITUDE: f64 = 1e120;

/// Lengths of a mechanism below this (m) are roundings: a hundredth of an atom's diameter. A mechanism
/// of shorter lengths alone is refused: beside one radian or one metre per second they would be lost.
pub const MIN_LENGTH: f64 = 1e-12;

/// What a characteristic length can be (m).
pub const LENGTHS: RangeInclusive<f64> = MIN_LENGTH..=MAX_MAGNITUDE;

/// A characteristic length is within this factor of that of the mechanism [-]: beyond it, ranks of the
/// constraints of mechanisms become those of roundings.
pub const LENGTH_RATIO: f64 = 1e5;

/// Longest length (m) of a mechanism that has none but what sums and sines of metres leave.
pub const ROUNDED_LENGTHS: [f64; 2] = [f64::EPSILON / 64.0, 1e-15];

/// A vector shorter than this [-] has no direction (axes in files are near unit length).
pub const ZERO_AXIS: f64 = 1e-9;

/// Rank at machine precision: singular values below `MACHINE_RANK * max(rows, cols) * s_1` are
/// zero up to rounding. The factor 8 covers the error of forming the matrix itself.
pub const MACHINE_RANK: f64 = 8.0 * f64::EPSILON;

/// One-sided Jacobi stops when every pair of columns is orthogonal to this times their norms.
pub const JACOBI_ORTHOGONAL: f64 = 4.0 * f64::EPSILON;

/// Default relative threshold of the truncated inverse: `s_i <= eps * s_1` is cut [-].
pub const TRUNCATION: f64 = 1e-3;

/// Default damping [unit of the singular values, after scaling by the characteristic length].
pub const DAMPING: f64 = 0.02;

/// Default onset of variable damping, relative to the largest singular value [-].
pub const DAMPING_ONSET: f64 = 0.05;

/// An analytical Jacobian does not exist when the sine that its rate map divides by is below this
/// [-]: angle rates would be a million times the angular velocity.
pub const ANGLE_SINGULAR: f64 = 1e-6;

/// Gimbal lock is assumed where the two entries that distinguish the first and the last angle are
/// below this [-]: a few roundings of entries of size 1.
pub const GIMBAL_LOCK: f64 = 8.0 * f64::EPSILON;

/// Default position tolerance of a Cartesian move (m).
pub const POSITION: f64 = 1e-6;

/// Default orientation tolerance of a Cartesian move (rad).
pub const ORIENTATION: f64 = 1e-6;

/// Default ramp: acceleration limit of the joints of a servo that have none in the model [rad/s^2, or
/// lengths of the mechanism/s^2], so that the first step from rest commands no jump. Published limits
/// of arms are 5 to 20 rad/s^2.
pub const DEFAULT_RAMP: f64 = 20.0;

/// Fraction of 1 plus the sizes of position and limit that is kept free at a position limit,
/// against rounding in the caller's `q + dt * velocity` [-].
pub const LIMIT_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A joint nearer to its limit than this [rad, or lengths of the mechanism] is reported as being at it.
pub const AT_LIMIT: f64 = 1e-6;

/// A joint velocity this near to its bound, relative to the bound, has reached it: scaling a motion
/// to a bound leaves a rounding [-].
pub const LIMIT_MET: f64 = 1e-12;

/// A rotation nearer to a half turn than this (rad) is about the axis whose first non-zero
/// component is positive, so that rounding does not choose the direction.
pub const HALF_TURN: f64 = 1e-9;

/// Positions are known to this fraction of the largest of them [-]: roundings of the joints before.
pub const POSITION_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Axes that pass a common point within this fraction of the extent of their joints meet there, so
/// that their distances yield no length [-].
pub const COMMON_POINT: f64 = 1e-3;

/// Three points define no circle when the height of their triangle is below this times its longest
/// side [-]: a radius beyond 1e5 such sides.
pub const COLLINEAR: f64 = 1e-6;

/// Rank of a task Jacobian at generic configurations, relative to the largest singular value: far
/// below any regular configuration, far above rounding [-].
pub const GENERIC_RANK: f64 = 1e-9;

/// Directions whose normal matrix is this small relative to the largest are those along nearly
/// parallel axes (within 1e-3 rad): the point nearest to the axes is undetermined along them [-].
pub const NEARLY_PARALLEL: f64 = 1e-6;

/// The centre of a screw system has converged when a step is below this fraction of the
/// characteristic length [-]: margins then depend on the frame to a similar fraction.
pub const CENTER_FOUND: f64 = 1e-9;

/// A screw system is the same from all points along a direction in which it changes by less than
/// the root of this, relative to the others [-]: rounding, and what is far below [`FAR_AXIS`].
pub const FREE_TRANSLATION: f64 = 1e-10;

/// The centre of a screw system is put nearest to the origin, where it is free, from less than this
/// many lengths away [-]: moments then keep thirteen digits.
pub const FAR_ORIGIN: f64 = 10.0;

/// The centre of a screw system, where it is free, may lie this many lengths away in another frame
/// of which the origin is within a hundred lengths of the axes [-].
pub const CENTER_FREEDOM: f64 = 200.0;

/// Twists of which a unit has an angular part below this do not determine the centre of a screw
/// system: their pitch, or their distance from the others, is a hundred thousand lengths [-].
pub const FAR_AXIS: f64 = 1e-5;

/// Coordinates of a canonical origin whose weight is below this are undetermined [-].
pub const ORIGIN_DETERMINED: f64 = 1e-13;

/// Parallel lines nearer than this times the size of their points coincide up to rounding [-].
pub const COINCIDENT: f64 = 16.0 * f64::EPSILON;

/// Minimum threshold for the rank of a screw system: singular values of unit twists [-].
pub const SCREW_RANK: f64 = 1e-12;

/// Minimum threshold for the quantities that decide a class: ratios of lengths to the
/// characteristic length, sines of angles [-].
pub const SCREW_CLASS: f64 = 1e-8;

/// Rank of a stiffness or inertia matrix, relative to its largest eigenvalue at its centre and
/// length: a few thousand roundings of its entries [-].
pub const STIFFNESS_RANK: f64 = 1e-12;

/// Noise of the twists, at the centre, raises the threshold of the rank to this multiple of its
/// size [-]. This factor and the next were found by experiment over all classes in random frames.
pub const NOISE_RANK: f64 = 30.0;

/// Noise of the twists, at the centre and times [`NOISE_CONDITION`], raises the threshold of the
/// class to this multiple of its size [-].
pub const NOISE_CLASS: f64 = 100.0;

/// Noise of twists reaches their span times their conditioning; up to this one, thresholds cover
/// it, and twists that are conditioned worse are flagged [-].
pub const NOISE_CONDITION: f64 = 5.0;

/// A zero perturbed by noise stays below this fraction of the threshold that the noise raises [-]:
/// in 6e5 random systems the largest was 0.31.
pub const NOISE_OF_ZERO: f64 = 0.5;

/// A verdict is flagged when a quantity lies within this factor of its threshold [-].
pub const AMBIGUOUS: f64 = 1e3;

/// A projector that enlarges motions by more than this is not used by a servo unless requested [-]:
/// the realised error would be a thousand times the error to be closed.
pub const MAX_PROJECTION_NORM: f64 = 1e3;

/// Rank of the equilibrated constraint matrix of a closed chain, relative to its largest singular
/// value: geometry given to ten digits leaves less than this where a rank is lost, and no regular
/// configuration of the reference set falls below 1e-3 [-].
pub const CLOSURE_RANK: f64 = 1e-9;

/// Rank of a block of an orthonormal basis of motions, absolute: the columns have length one, so a
/// block of rounding errors has size 1e-15 [-].
pub const CLOSURE_BLOCK: f64 = 1e-9;

/// Smallest weight of a joint by inertia, over the largest: a joint through the centres of point
/// masses moves none, and would take all of a motion [-].
pub const LEAST_INERTIA: f64 = 1e-6;

/// Principal compliances of an elastic part below this times its largest are rigid directions: the
/// rounding of a matrix that is zero there [-].
pub const RIGID: f64 = 1e-13;

/// A kernel is accurate to this times the conditioning of its matrix (largest over smallest kept
/// singular value): smaller entries of its blocks are not significant [-].
pub const KERNEL_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A share of a motion of length one above this [-] is certain without a separate decomposition:
/// `sqrt(1 - s^2)` is accurate to 1e-13 from here on.
pub const CLEAR_SHARE: f64 = 1e-2;

/// Pairs of motion and of force, computed separately, agree to this in debug builds: each comes
/// from a basis that is accurate to 1e-7 at the worst conditioning considered [-].
pub const DUALITY: f64 = 1e-6;

/// Metrics of motions whose factors have a larger diagonal ratio than this exhaust double
/// precision: their duality is not checked [-].
pub const MAX_METRIC_CONDITION: f64 = 1.0 / f64::EPSILON;

/// Nor is that of directions whose ratios of output to input differ by more than this factor [-]: the
/// smaller ones are then uncertain by [`DUALITY`].
pub const MAX_EFFICIENCY_SPREAD: f64 = DUALITY / (64.0 * f64::EPSILON);

/// A direction whose component along another is below this, relative to both, is orthogonal to it
/// in the search for vertices of boxes: above the rounding of products of fourteen numbers, far
/// below the difference between two vertices [-].
pub const LINEAR_PROGRAM: f64 = 1e-12;

/// Vertices of polytopes nearer to a facet than this times the size of the body lie on it: above
/// the rounding of their images, far below the resolution of a plot [-].
pub const HULL: f64 = 1e-9;

/// Maximum number of facets of a hull: a polytope in three dimensions with ten thousand vertices,
/// and a second of computation.
pub const MAX_FACETS: usize = 20_000;

/// Maximum number of simplices in the search for the weakest direction of a grasp: ten seconds of
/// computation, which five soft fingers in a ring may need.
pub const MAX_SIMPLICES: usize = 10_000_000;

/// Final distance of the bounds of a grasp's quality, over the largest difference of its wrenches [-].
pub const GRASP_QUALITY: f64 = 1e-3;

/// An eigenvalue of an admittance, divided by the roots of its diagonal, may be this much below
/// zero [-]: the rounding of a map that was moved between frames.
pub const PASSIVE: f64 = 1e-9;

/// Loops whose closure error is less than this times the characteristic length, and less than this
/// in angle (rad), are closed: far above rounding, far below manufacturing tolerances [-].
pub const CLOSED: f64 = 1e-10;

/// Directions in which a constraint is weaker than this, relative to its strongest, are excluded
/// from loop closure: near a singular configuration the largest step would be there [-].
pub const CORRECTION_RANK: f64 = 1e-6;

/// A motion with less than this share in the actuated joints (of a motion of length one in units
/// scaled by the characteristic length) is no longer controlled by them: passive joints move a
/// hundred times as fast as the actuators and multiply their errors and clearances as much [-].
pub const MIN_ACTUATED_SHARE: f64 = 1e-2;

/// Loops whose closure error is less than this times the characteristic length, and less than this
/// in angle (rad), are closed by a servo as it moves, for measured configurations: others by assembly.
pub const NEARLY_CLOSED: f64 = 1e-2;

/// Joint velocities clamped at bounds that follow from each other, or contradict each other, by
/// this [-]: above the rounding of the motions that the loops permit.
pub const CLAMPED_ROWS: f64 = 1e-9;

/// A motion of length one (scaled) that moves the task by less than this does not move it [-].
pub const UNACTUATED: f64 = 1e-9;

/// What rounding leaves open of loops that were closed by Newton's method: rows of lengths over the
/// reach and of angles, of a hundred roundings and some [-].
pub const LOOP_ROUNDING: f64 = 1e-13;

/// Unit of the distance between a configuration and its neighbours, in scaled coordinates [rad, or
/// characteristic lengths].
pub const FINITE_STEP: f64 = 1e-2;

/// Distance to which a branch of closed configurations is tracked [rad, or characteristic lengths]:
/// a resistance of eighth order then shows as 4e-3, far above rounding.
pub const TRACKED: f64 = 0.5;

/// A motion that was tracked less far than this does not prove to be finite [rad, or characteristic
/// lengths]: a resistance of eighth order would be 2e-10 there.
pub const TRACKED_AT_LEAST: f64 = 1.0 / 16.0;

/// A residual this many times its rounding is no rounding [-].
pub const CLEARLY_OPEN: f64 = 1e3;

/// Fraction of the distance to a branch point below which a singular value of a configuration on a
/// branch counts as zero [-]: where branches cross, a value that vanishes there grows in proportion
/// to the distance.
pub const BRANCH_RANK: f64 = 1e-3;

/// Two branches whose tangents differ by an angle whose sine is below this are one [-]; tangents
/// are right to 1e-6.
pub const SAME_BRANCH: f64 = 1e-3;

/// Steps that can be followed span a direction if they spread along it by more than this [-].
pub const BRANCH_SPREAD: f64 = 0.1;

/// A branch whose tangent rotates by more than the angle of this cosine on its way to the
/// configuration is not followed further [-].
pub const BRANCH_TURN: f64 = 0.9;

/// Motions whose part outside all branches is below this belong to them [-].
pub const WITHIN_BRANCHES: f64 = 1e-3;

/// Accuracy of the limit of generic spaces, taken from nearby configurations [-].
pub const GENERIC_LIMIT: f64 = 1e-6;

/// A joint whose share in motions of length one is below this is at rest [-], for their generic limit.
pub const JOINT_AT_REST: f64 = 1e-5;

/// Position error at which inverse kinematics counts a target as reached, by default (m): what
/// others call exact, a tenth of what arms repeat.
pub const IK_POSITION: f64 = 1e-6;

/// The same of the orientation (rad).
pub const IK_ORIENTATION: f64 = 1e-6;

/// Axes that are parallel within this angle (rad), or meet within this distance over the
/// characteristic length, count as such for formulas of inverse kinematics: files print 1.5708,
/// which is 4e-6 off, and two Newton steps make 1e-10 of it and then rounding.
pub const ALIGNED_AXES: f64 = 1e-5;

/// Axes that cross at an angle whose sine is below this have no point where they meet that formulas
/// could rest on [-]: a hundred times the departures of [`ALIGNED_AXES`] would remain.
pub const OBLIQUE_AXES: f64 = 1e-2;

/// Axes that depart from their structure by no more than this have it to rounding [rad,
/// characteristic lengths]: bases a hundred such lengths from the origin leave less.
pub const ANALYTIC_EXACT: f64 = 1e-12;

/// A turn is not determined where the arm that it would be read from is shorter than this, in
/// reaches or as a sine [-]: angles at a double root are right to the root of rounding, 2e-8, times
/// ratios of lengths.
pub const FREE_TURN: f64 = 1e-7;

/// A condition on a rotation angle that is violated by less than this fraction of the square of its
/// largest value may be one that rounding, or the deviations of [`ALIGNED_AXES`], keep from being
/// satisfied [-].
pub const NEARLY_SATISFIED: f64 = 1e-4;

/// Where a polynomial has an extremum of this size, relative to the sum of its terms, it may have a
/// double root [-]; forward kinematics decides.
pub const TANGENT_ROOT: f64 = 1e-9;

/// An answer of formulas with errors below this needs no Newton step [rad, characteristic lengths].
pub const ANALYTIC_REFINED: f64 = 1e-12;

/// One with larger errors than this is none [rad, characteristic lengths].
pub const ANALYTIC_CONFIRMED: f64 = 1e-10;

/// Answers of formulas whose angles differ by less than this, whole turns apart, are one (rad): far
/// above rounding at a double root, 2e-8 times ratios of lengths.
pub const ANALYTIC_SAME: f64 = 1e-6;

/// An angle that is outside a limit by less than this is put on it (rad), and forward kinematics
/// decides whether that is still an answer.
pub const ANALYTIC_AT_LIMIT: f64 = 1e-7;

/// Efficiencies that differ by less than this, relative to each other, count as equal where a
/// derivative is requested: closer ones rotate their directions by rounding alone [-].
pub const REPEATED: f64 = 1e-7;

/// Step in scaled coordinates (rad) at which matrices of constraints are compared for their
/// derivative: the fourth-order error of four of them and the rounding of their entries are then
/// similar, about 1e-12.
pub const MATRIX_STEP: f64 = 1e-3;

/// Two assemblies whose joints differ by less than this, in lengths over the characteristic length
/// and in angle, are one: far above the rounding at the end of a search, 1e-8 at a double root, far
/// below the difference of two assemblies [-].
pub const SAME_ASSEMBLY: f64 = 1e-6;

/// Normal forces below this fraction of their sum are zero, and wrenches of this size (scaled) are
/// balanced [-]: ten times the geometry given to ten digits of [`CLOSURE_RANK`].
pub const EQUILIBRIUM: f64 = 1e-8;

/// Curvatures of two bodies whose sum is this small, relative to their sizes, are those of
/// conforming bodies, which touch along a line or face [-].
pub const CONFORMING: f64 = 1e-9;

/// Second-order terms of loops and of contact gaps at or below it count as zero (scaled) [-]:
/// differences of loops closed to rounding yield them to 1e-8.
pub const SECOND_ORDER: f64 = 1e-6;

/// Eigenvalues of scaled second-order forms this close are equal [-]; also the least difference of
/// length at which one of several directions counts as the longest.
pub const EQUAL_CURVATURES: f64 = 1e-6;

/// A sum of unit motions below it has no direction [-].
pub const CANCELLED: f64 = 1e-9;

/// The largest share of its largest entry by which a matrix and its transpose may differ for it to
/// be symmetric [-]: matrices typed with ten digits pass.
pub const SYMMETRIC: f64 = 1e-9;

/// Largest distance between the signatures of two isolated assemblies that count as one if they
/// move to first order: a search comes only that near to a contact of high order [-].
pub const SAME_SHAKY: f64 = 0.05;

/// Smallest ratio of the singular values kept at which an assembly from a restart has a clear rank
/// [-]: at a singular configuration assemblies are accurate to the root of rounding.
pub const CLEAR_SAMPLE: f64 = 1e-5;

/// Links that a trial step by 0.05 moves by less than this have come back to where they were, in
/// lengths over the characteristic length and in angle [-]: the assembly is a double root, and no
/// motion leaves it.
pub const TRIAL_MOVED: f64 = 1e-3;

/// Default least distance to a singularity on a way through closed configurations: smallest over
/// largest singular value of the rates of the loops [-].
pub const PATH_SINGULAR: f64 = 1e-3;

/// Smallest distance to a singularity that may be requested [-]: closer to a fold, the last steps
/// are shorter than [`SHARE_FOUND`].
pub const LEAST_PATH_SINGULAR: f64 = 1e-5;

/// Distance to a singularity of type I at which the way of a platform ends [-]: at a boundary of its
/// workspace the square of it is the distance left, in characteristic lengths.
pub const PLATFORM_SINGULAR: f64 = 1e-4;

/// Residual of loops and of what vanishes on a singularity locus, at its points [-]: 100 roundings.
pub const LOCUS_MET: f64 = 1e-12;

/// Relative singular value of the equations of a locus [-] below which its points have a neighbour in
/// a further direction: above the error of their second derivatives.
pub const SURFACE_RANK: f64 = 1e-7;

/// Step in scaled coordinates (rad) of the second derivatives of loops, which only direct Newton's
/// method: their error is then 1e-10.
pub const LOCUS_STEP: f64 = 1e-5;

/// A coordinate whose share of a singular motion of length one is below this is at rest [-].
pub const LOCUS_AT_REST: f64 = 1e-6;

/// What falls to zero with the distance d to a singularity is below its root there, what does not
/// is above it; the root of distances below the square of this is that of rounding [-].
pub const VANISHING: f64 = 1e-6;

/// Corrections of a step below this are rounding, whatever the step [-].
pub const CORRECTION_ROUNDING: f64 = 1e-9;

/// Residual of a motion of the prescribed coordinates that the free ones cannot follow, relative to
/// the motion [-]: far above rounding at the worst conditioning on a path.
pub const CONTRADICTION: f64 = 1e-6;

/// Where a way through closed configurations ends is found to this share of it [-]: a fold is
/// then a distance of about its root away, 1e-6, or nearer.
pub const SHARE_FOUND: f64 = 1e-12;

/// Rates that differ by less than this, relative to their size, are the same: above the rounding of
/// two inverses of one Jacobian, far below what a reference point a millimetre away changes [-].
pub const SAME_RATES: f64 = 1e-9;

/// A new simplex that improves an index by less than this share of it ends its refinement [-]: a
/// thousand roundings, since an index has the error of its singular values.
pub const OPTIMUM_IMPROVED: f64 = 1e-12;

/// A parameter of an optimal design nearer than this to an end of its range, as a share of the range,
/// is tried there [-]: where an index is flat, its roundings hide the root of them.
pub const OPTIMUM_AT_END: f64 = 1e-6;

/// The axes of a closing universal joint line up where the sine of their angle is below this [-]:
/// what it holds is then for the analysis of one configuration to say.
pub const CROSSED_AXES: f64 = 1e-6;

/// Smallest singular value of the loops at a crossing of branches that interpolation found, over the
/// largest: interpolation is accurate to ten digits [-].
pub const CROSSED: f64 = 1e-9;

/// A distance to a singularity above this is clear without a rank decision: a hundred thousand
/// times [`CLOSURE_RANK`] and [`CLOSURE_BLOCK`], and far above the effect of rounding at that
/// distance, 1e-11 [-].
pub const CLEAR_DISTANCE: f64 = 1e-4;

/// A share of a motion below this is zero, without a rank decision: a thousandth of
/// [`CLOSURE_BLOCK`], and above rounding [-].
pub const NEGLIGIBLE_SHARE: f64 = 1e-12;

/// Two segments are parallel where the squared sine of their angle is below this [-]: along a common
/// part of length l the distance then changes by less than 1e-12 l.
pub const PARALLEL_SEGMENTS: f64 = 1e-24;

/// Points nearer than this (m) have no direction from one to the other: rounding of coordinates of
/// some metres; the normal is then taken from the shapes.
pub const ZERO_SEPARATION: f64 = 1e-14;

/// Bodies whose cores are no larger than this together (m) count as points in the search for their
/// distance: the reciprocal of a smaller size, times a distance, squared, is not finite.
pub const NO_EXTENT: f64 = 1e-30;

/// A point beyond a convex hull by less than this times its size is on it [-].
pub const HULL_ROUNDING: f64 = 1e-12;

/// Share by which the radius of a fitted capsule exceeds the smallest circle's, for rounding [-].
pub const CAPSULE_ENLARGED: f64 = 1e-12;

/// Default distance above which a pair of shapes counts as one that never touches (m).
pub const NEVER_NEAR: f64 = 0.02;

/// Upper less lower bound of the distance of two convex cores at which the search ends, relative to
/// the sum of their radii [-]: some hundred roundings.
pub const GJK_GAP: f64 = 1e-13;

/// The same for the depth of cores that overlap [-]: curved ones come near it with a hundred facets.
pub const DEPTH_GAP: f64 = 1e-8;
