//! SVG with coordinates in hundredths of a pixel: plotters rounds coordinates to whole numbers, and
//! a curve through whole pixels has steps.
//!
//! Strokes, radii and fonts are given in pixels as usual. Positions and lengths in the drawing are
//! in hundredths: callers convert pixels with [`px`] and [`at`].

use plotters::prelude::*;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind, FontFamily,
    FontStyle, FontTransform, text_anchor,
};

/// Units per pixel.
const PX: i32 = 100;

/// A length in units.
pub(crate) const fn px(pixels: u32) -> u32 {
    pixels * PX.unsigned_abs()
}

/// A position in units.
pub(crate) const fn at(x: i32, y: i32) -> (i32, i32) {
    (x * PX, y * PX)
}

type Result<E> = std::result::Result<(), DrawingErrorKind<E>>;

/// The backend.
pub(crate) struct Fine<'a>(SVGBackend<'a>);

impl<'a> Fine<'a> {
    /// A drawing of this size in units; [`in_pixels`] finishes its text.
    pub(crate) fn new(svg: &'a mut String, size: (u32, u32)) -> Self {
        Self(SVGBackend::with_string(svg, size))
    }
}

/// The text of a drawing with its size in pixels, its coordinates as they are.
pub(crate) fn in_pixels(svg: &str) -> String {
    let size = |name: &str| {
        let quoted = svg.split_once(&format!("{name}=\""))?.1.split_once('"')?.0;
        Some((quoted, quoted.parse::<u32>().ok()? / px(1)))
    };
    let (Some((width, w)), Some((height, h))) = (size("width"), size("height")) else {
        return svg.to_owned();
    };
    let fine = format!("width=\"{width}\" height=\"{height}\"");
    svg.replacen(&fine, &format!("width=\"{w}\" height=\"{h}\""), 1)
}

/// A style with a stroke of so many units.
struct Stroke {
    color: BackendColor,
    width: u32,
}

impl Stroke {
    fn of(style: &impl BackendStyle) -> Self {
        Self { color: style.color(), width: px(style.stroke_width()) }
    }
}

impl BackendStyle for Stroke {
    fn color(&self) -> BackendColor {
        self.color
    }

    fn stroke_width(&self) -> u32 {
        self.width
    }
}

/// A text with its size in units.
struct Words<'a, S>(&'a S);

impl<S: BackendTextStyle> BackendTextStyle for Words<'_, S> {
    type FontError = S::FontError;

    fn color(&self) -> BackendColor {
        self.0.color()
    }

    fn size(&self) -> f64 {
        self.0.size() * f64::from(PX)
    }

    fn transform(&self) -> FontTransform {
        self.0.transform()
    }

    fn style(&self) -> FontStyle {
        self.0.style()
    }

    fn anchor(&self) -> text_anchor::Pos {
        self.0.anchor()
    }

    fn family(&self) -> FontFamily<'_> {
        self.0.family()
    }

    fn layout_box(
        &self,
        text: &str,
    ) -> std::result::Result<((i32, i32), (i32, i32)), Self::FontError> {
        let ((left, top), (right, bottom)) = self.0.layout_box(text)?;
        Ok(((left * PX, top * PX), (right * PX, bottom * PX)))
    }

    fn draw<E, F: FnMut(i32, i32, BackendColor) -> std::result::Result<(), E>>(
        &self,
        text: &str,
        at: BackendCoord,
        draw: F,
    ) -> std::result::Result<std::result::Result<(), E>, Self::FontError> {
        self.0.draw(text, at, draw)
    }
}

impl<'a> DrawingBackend for Fine<'a> {
    type ErrorType = <SVGBackend<'a> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<Self::ErrorType> {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Result<Self::ErrorType> {
        self.0.present()
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Result<Self::ErrorType> {
        self.0.draw_rect(at, (at.0 + PX, at.1 + PX), &Stroke { color, width: 0 }, true)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Result<Self::ErrorType> {
        self.0.draw_line(from, to, &Stroke::of(style))
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        bottom_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Result<Self::ErrorType> {
        if fill {
            return self.0.draw_rect(upper_left, bottom_right, &Stroke::of(style), true);
        }
        // The outline of a rectangle would be one unit wide, whatever its style.
        let ((left, top), (right, bottom)) = (upper_left, bottom_right);
        let outline = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        self.0.draw_path(outline, &Stroke::of(style))
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Result<Self::ErrorType> {
        self.0.draw_path(path, &Stroke::of(style))
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Result<Self::ErrorType> {
        self.0.draw_circle(center, px(radius), &Stroke::of(style), fill)
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Result<Self::ErrorType> {
        self.0.fill_polygon(corners, &Stroke::of(style))
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        at: BackendCoord,
    ) -> Result<Self::ErrorType> {
        self.0.draw_text(text, &Words(style), at)
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> std::result::Result<(u32, u32), DrawingErrorKind<Self::ErrorType>> {
        self.0.estimate_text_size(text, &Words(style))
    }
}
