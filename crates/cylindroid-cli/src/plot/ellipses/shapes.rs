//! The shapes of velocity and force, and their scales in the drawing.

use cylindroid::closure::ClosedChain;
use cylindroid::linalg::Interval;
use cylindroid::manipulability::{Metrics, Spectrum};
use cylindroid::{Matrix, State};
use plotters::style::RGBColor;

/// Size of the shapes over that of the mechanism.
const SHARE: f64 = 0.36;

/// What is drawn.
pub(crate) struct Drawing<'a> {
    pub(crate) state: &'a State,
    pub(crate) chain: &'a ClosedChain,
    /// Of the whole twist.
    pub(crate) metrics: &'a Metrics,
    pub(crate) metric: &'a str,
    pub(crate) velocity_limits: Option<Vec<Interval>>,
    pub(crate) torque_limits: Option<Vec<Interval>>,
}

/// A shape in a plane: semi-axes of an ellipse, and directions without end.
#[derive(Debug, Clone)]
pub(super) struct Ellipse {
    pub(super) axes: Vec<[f64; 2]>,
    pub(super) endless: Vec<[f64; 2]>,
}

impl Ellipse {
    pub(super) fn of(spectrum: &Spectrum) -> Self {
        let pairs = |m: &Matrix| -> Vec<[f64; 2]> {
            (0..m.cols()).map(|j| [m[(0, j)], m[(1, j)]]).collect()
        };
        // A semi-axis may point either way; the rim starts at the same end whatever the rounding.
        let forwards = |[x, y]: [f64; 2]| if x + 0.4 * y < 0.0 { [-x, -y] } else { [x, y] };
        let axes = pairs(&spectrum.semi_axes()).into_iter().map(forwards).collect();
        let unit = |d: [f64; 2]| {
            let size = d[0].hypot(d[1]);
            [d[0] / size, d[1] / size]
        };
        let endless = pairs(&spectrum.infinite).into_iter().map(unit).collect();
        Self { axes, endless }
    }

    pub(super) fn size(&self) -> f64 {
        self.axes.iter().map(|a| a[0].hypot(a[1])).fold(0.0, f64::max)
    }
}

/// What is shown of motion or of force in one plane.
#[derive(Debug, Clone)]
pub(super) struct View {
    pub(super) plane: [usize; 2],
    pub(super) ellipse: Ellipse,
    pub(super) polygon: Option<Vec<[f64; 2]>>,
}

/// Motion or force, in all planes.
pub(super) struct Block<'a> {
    pub(super) title: &'static str,
    pub(super) unit: &'static str,
    pub(super) force: bool,
    pub(super) colour: RGBColor,
    pub(super) views: Vec<View>,
    pub(super) drawing: &'a Drawing<'a>,
}

/// How much of a quantity one metre of the drawing is: for ellipses, and for polygons; `None` for
/// those of no size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales {
    pub(super) ellipse: Option<f64>,
    pub(super) polygon: Option<f64>,
}

impl Block<'_> {
    /// Round numbers that give the shapes their share; one for both where they fit together.
    pub(super) fn scales(&self, size: f64) -> Scales {
        let widest = |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0, f64::max);
        let ellipse = widest(&mut self.views.iter().map(|v| v.ellipse.size()));
        let corners = self.views.iter().flat_map(|v| v.polygon.iter().flatten());
        let polygon = widest(&mut corners.map(|c| c[0].hypot(c[1])));
        let of = |most: f64| round_up(most / (SHARE * size));
        let together = ellipse.max(polygon);
        let own = |most: f64| (most > 0.0).then(|| of(most));
        if ellipse.min(polygon) > 0.4 * together {
            return Scales { ellipse: own(together), polygon: own(together) };
        }
        Scales { ellipse: own(ellipse), polygon: own(polygon) }
    }
}

/// The next number with one digit, or 1.5 times a power of ten.
fn round_up(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    let steps = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0];
    steps.map(|m| m * power).into_iter().find(|r| *r >= x).unwrap_or(10.0 * power)
}
