//! What a program draws beside the robot: frames, lines and points.

use std::collections::BTreeMap;

use cylindroid::{Error, Pose, Result};
use serde::Serialize;

use super::json::{PoseJson, text};

/// Maximum number of drawings of a session, and of their points.
const MOST_DRAWINGS: usize = 500;
const MOST_POINTS: usize = 100_000;
/// Longest name, in characters.
const LONGEST_NAME: usize = 60;

/// Something that a program draws beside the robot, in the world frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// What is drawn.
    pub shape: DrawnShape,
    /// Colour and opacity, from 0 to 1; `None`: those of the page.
    pub rgba: Option<[f64; 4]>,
}

/// The shape of a [`Drawing`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DrawnShape {
    /// Three axes of this length (m; `None`: one that suits the robot).
    Frame {
        /// `world_from_frame`.
        pose: Pose,
        /// Length of the axes (m).
        size: Option<f64>,
    },
    /// A line through these points (m).
    Line(Vec<[f64; 3]>),
    /// Separate points (m).
    Points(Vec<[f64; 3]>),
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "drawings")]
pub(super) struct DrawingsJson<'a> {
    drawings: Vec<DrawingJson<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "Drawing"))]
struct DrawingJson<'a> {
    name: &'a str,
    #[serde(flatten)]
    shape: ShapeJson<'a>,
    rgba: Option<[f64; 4]>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "DrawnShape"))]
#[serde(tag = "kind", rename_all = "snake_case")]
enum ShapeJson<'a> {
    Frame { pose: PoseJson, size: Option<f64> },
    Line { points: &'a [[f64; 3]] },
    Points { points: &'a [[f64; 3]] },
}

/// The drawings of a session by their names.
#[derive(Debug, Default)]
pub(super) struct Drawings(BTreeMap<String, Drawing>);

impl Drawings {
    /// Adds a drawing, or replaces the one of this name.
    pub(super) fn put(&mut self, name: &str, drawing: Drawing) -> Result<()> {
        if name.trim().is_empty() || name.chars().count() > LONGEST_NAME {
            let reason = format!("give a name of 1 to {LONGEST_NAME} characters");
            return Err(invalid("name", name, reason));
        }
        drawing.check()?;
        let others = self.0.iter().filter(|(other, _)| *other != name);
        let (count, points) =
            others.fold((1, drawing.points()), |(n, all), (_, d)| (n + 1, all + d.points()));
        if count > MOST_DRAWINGS {
            let reason = format!("a view has at most {MOST_DRAWINGS} drawings; remove one first");
            return Err(invalid("name", name, reason));
        }
        if points > MOST_POINTS {
            let reason = format!("the drawings of a view have at most {MOST_POINTS} points in all");
            return Err(invalid("points", &points.to_string(), reason));
        }
        self.0.insert(name.to_owned(), drawing);
        Ok(())
    }

    /// False if there is none of this name.
    pub(super) fn remove(&mut self, name: &str) -> bool {
        self.0.remove(name).is_some()
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// The message `drawings`.
    pub(super) fn text(&self) -> String {
        let all = self.0.iter().map(|(name, drawing)| DrawingJson {
            name,
            shape: match &drawing.shape {
                DrawnShape::Frame { pose, size } => {
                    ShapeJson::Frame { pose: (*pose).into(), size: *size }
                }
                DrawnShape::Line(points) => ShapeJson::Line { points },
                DrawnShape::Points(points) => ShapeJson::Points { points },
            },
            rgba: drawing.rgba,
        });
        text(&DrawingsJson { drawings: all.collect() })
    }
}

impl Drawing {
    fn points(&self) -> usize {
        match &self.shape {
            DrawnShape::Frame { .. } => 1,
            DrawnShape::Line(points) | DrawnShape::Points(points) => points.len(),
        }
    }

    fn check(&self) -> Result<()> {
        match &self.shape {
            DrawnShape::Frame { size: Some(size), .. } => Error::check_positive("size", *size)?,
            DrawnShape::Frame { size: None, .. } => {}
            DrawnShape::Line(points) | DrawnShape::Points(points) => {
                Error::check_finite("points", points.as_flattened())?;
            }
        }
        let is_share = |x: &f64| (0.0..=1.0).contains(x);
        if let Some(rgba) = self.rgba.filter(|rgba| !rgba.iter().all(is_share)) {
            let reason = "give red, green, blue and opacity from 0 to 1".to_owned();
            return Err(invalid("rgba", &format!("{rgba:?}"), reason));
        }
        Ok(())
    }
}

fn invalid(option: &'static str, value: &str, reason: String) -> Error {
    Error::InvalidOption { option, value: value.to_owned(), reason }
}
