//! What is drawn of velocity and force in two components, and the scales of the drawing.

use cylindroid::State;
use cylindroid::closure::ClosedChain;
use cylindroid::manipulability::{Ellipsoid, EllipsoidView, Polytope};
use plotters::style::RGBColor;

/// Size of the shapes over that of the mechanism.
const SHARE: f64 = 0.36;

/// What is drawn.
pub(crate) struct Drawing<'a> {
    pub(crate) state: &'a State,
    pub(crate) chain: &'a ClosedChain,
    /// Names of the components of twist and wrench, or of the task.
    pub(crate) components: &'a [String],
    /// True if they are those of a task.
    pub(crate) task: bool,
    pub(crate) metric: &'a str,
    pub(crate) view: EllipsoidView,
    pub(crate) planes: &'a [PlaneShapes],
}

impl Drawing<'_> {
    /// The axis of the world of a component that is linear.
    pub(super) fn world_axis(&self, component: usize) -> Option<usize> {
        ["x", "y", "z"].iter().position(|axis| self.components[component] == *axis)
    }

    /// True if all planes are planes of the world, so that the mechanism is drawn in them.
    pub(super) fn in_world(&self) -> bool {
        let mut all = self.planes.iter().flat_map(|plane| plane.components);
        all.all(|c| self.world_axis(c).is_some())
    }

    /// The components that no plane shows together with the two of one: free or zero.
    pub(super) fn others(&self, plane: &PlaneShapes) -> Vec<&str> {
        let others = (0..self.components.len()).filter(|c| !plane.components.contains(c));
        others.map(|c| self.components[c].as_str()).collect()
    }
}

/// The shapes in two components.
#[derive(Debug, Clone)]
pub(crate) struct PlaneShapes {
    pub(crate) components: [usize; 2],
    pub(crate) velocity: Shape,
    pub(crate) exerted: Shape,
    pub(crate) resisted: Shape,
    /// Within the limits of the actuators, where these are known.
    pub(crate) velocities: Option<Region>,
    pub(crate) forces: Option<Region>,
}

/// An ellipse: semi-axes, longest first, and directions without end.
#[derive(Debug, Clone)]
pub(crate) struct Shape {
    pub(crate) axes: Vec<[f64; 2]>,
    pub(crate) endless: Vec<[f64; 2]>,
}

impl From<&Ellipsoid> for Shape {
    fn from(e: &Ellipsoid) -> Self {
        // A semi-axis may point either way; the rim starts at the same end whatever the rounding.
        let forwards = |[x, y]: [f64; 2]| if x + 0.4 * y < 0.0 { [-x, -y] } else { [x, y] };
        let columns = |m: &cylindroid::Matrix| {
            (0..m.cols()).map(|j| forwards([m[(0, j)], m[(1, j)]])).collect()
        };
        Self { axes: columns(&e.semi_axes), endless: columns(&e.unbounded) }
    }
}

impl Shape {
    pub(crate) fn sizes(&self) -> impl Iterator<Item = f64> + '_ {
        self.axes.iter().map(|a| a[0].hypot(a[1]))
    }

    /// The largest value of each component.
    pub(super) fn reach(&self) -> [f64; 2] {
        [0, 1].map(|i| self.axes.iter().map(|a| a[i] * a[i]).sum::<f64>().sqrt())
    }

    fn size(&self) -> f64 {
        self.sizes().fold(0.0, f64::max)
    }

    /// True if both are the same set of points, up to rounding.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let square = |s: &Self, list: fn(&Self) -> &Vec<[f64; 2]>| {
            [(0, 0), (0, 1), (1, 1)].map(|(i, j)| list(s).iter().map(|a| a[i] * a[j]).sum::<f64>())
        };
        let near = |list: fn(&Self) -> &Vec<[f64; 2]>| {
            let (a, b) = (square(self, list), square(other, list));
            let size = a.iter().chain(&b).fold(0.0, |m: f64, x| m.max(x.abs()));
            a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-9 * size)
        };
        near(|s| &s.axes) && near(|s| &s.endless)
    }
}

/// A polygon, and directions without end.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    pub(crate) corners: Vec<[f64; 2]>,
    pub(crate) endless: Vec<[f64; 2]>,
}

impl From<&Polytope> for Region {
    fn from(p: &Polytope) -> Self {
        let unit = |[x, y]: [f64; 2]| [x / x.hypot(y), y / x.hypot(y)];
        let unbounded = &p.unbounded;
        Self {
            corners: p.hull.polygon().iter().map(|v| [v[0], v[1]]).collect(),
            endless: (0..unbounded.cols())
                .map(|j| unit([unbounded[(0, j)], unbounded[(1, j)]]))
                .collect(),
        }
    }
}

/// Motion or force, in all planes.
pub(super) struct Block<'a> {
    pub(super) title: &'static str,
    pub(super) force: bool,
    pub(super) colour: RGBColor,
    pub(super) drawing: &'a Drawing<'a>,
}

/// How much of a quantity one unit of the axes is: for ellipses, and for polygons; `None` for those
/// of no size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales {
    pub(super) ellipse: Option<f64>,
    pub(super) polygon: Option<f64>,
}

impl Block<'_> {
    pub(super) fn shape<'a>(&self, plane: &'a PlaneShapes) -> &'a Shape {
        if self.force { &plane.exerted } else { &plane.velocity }
    }

    /// What the structure helps to resist, if it carries something.
    pub(super) fn resisted<'a>(&self, plane: &'a PlaneShapes) -> Option<&'a Shape> {
        (self.force && self.is_supported()).then_some(&plane.resisted)
    }

    /// True if more is resisted than is exerted in one of the planes.
    pub(super) fn is_supported(&self) -> bool {
        self.drawing.planes.iter().any(|p| !p.exerted.is_like(&p.resisted))
    }

    pub(super) fn region<'a>(&self, plane: &'a PlaneShapes) -> Option<&'a Region> {
        if self.force { plane.forces.as_ref() } else { plane.velocities.as_ref() }
    }

    /// The unit of a component.
    pub(super) fn unit(&self, component: usize) -> &'static str {
        let name = self.drawing.components[component].as_str();
        match (name, self.force) {
            ("x" | "y" | "z", false) => "m/s",
            ("x" | "y" | "z", true) => "N",
            ("rx" | "ry" | "rz", false) => "rad/s",
            ("rx" | "ry" | "rz", true) => "N m",
            _ => "",
        }
    }

    /// Round numbers that give the shapes their share; one for both where they fit together. Axes
    /// of the quantity itself have scale one for the ellipses.
    pub(super) fn scales(&self, size: f64) -> Scales {
        let planes = self.drawing.planes;
        let shapes = planes.iter().flat_map(|p| {
            [Some(self.shape(p)), self.resisted(p)].into_iter().flatten().map(Shape::size)
        });
        let ellipse = shapes.fold(0.0, f64::max);
        let corners = planes.iter().filter_map(|p| self.region(p)).flat_map(|r| &r.corners);
        let polygon = corners.map(|c| c[0].hypot(c[1])).fold(0.0, f64::max);
        let own = |most: f64, of: f64| (most > 0.0).then(|| round_up(of));
        let together = ellipse.min(polygon) > 0.4 * ellipse.max(polygon);
        if !self.drawing.in_world() {
            let of = if together || ellipse == 0.0 { 1.0 } else { polygon / ellipse };
            return Scales { ellipse: (ellipse > 0.0).then_some(1.0), polygon: own(polygon, of) };
        }
        let of = |most: f64| most / (SHARE * size);
        if together {
            let both = ellipse.max(polygon);
            return Scales { ellipse: own(both, of(both)), polygon: own(both, of(both)) };
        }
        Scales { ellipse: own(ellipse, of(ellipse)), polygon: own(polygon, of(polygon)) }
    }
}

/// The next number with one digit, or 1.5 times a power of ten.
fn round_up(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    let steps = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0];
    steps.map(|m| m * power).into_iter().find(|r| *r >= x).unwrap_or(10.0 * power)
}
