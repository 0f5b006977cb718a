//! The recipe of a sweep: all that its numbers depend on, as JSON, and the difference of two.
//!
//! Why so   a folder is resumed with the numbers that it already has, so every cause of another
//!          number is in the recipe: the version, the mechanism (by a checksum of its parts), the
//!          configurations, quantities and their options, and the processor's arithmetic. Threads are
//!          no cause
//! Checked  tests/sweep/folder.rs::another_recipe_is_refused, tests/it/simd.rs::forms_agree

use std::fmt::{self, Display, Write as _};

use serde_json::{Value, json};

use super::axis::Axis;
use super::checksum::Checksum;
use super::designs::{DesignSpace, Designs, ParameterRange};
use super::evaluate::Evaluator;
use super::options::SweepOptions;
use super::own_columns::OwnColumn;
use super::quantity::Quantity;
use super::source::Source;
use crate::model::Mechanism;
use crate::scalar::arithmetic;

/// A JSON object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recipe(pub(super) Value);

impl Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Display::fmt(&self.0, f)
    }
}

impl Recipe {
    pub(super) fn of(
        mechanism: &Mechanism,
        options: &SweepOptions,
        rows: u64,
        evaluator: &Evaluator,
    ) -> Self {
        let names = mechanism.coordinates().iter().map(|c| c.name.as_str());
        let frame = &mechanism.frame_of(evaluator.end_effector.frame).name;
        let quantities = options.quantities.iter().map(|q| q.name());
        let mut recipe = Self(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "arithmetic": arithmetic(),
            "model": mechanism.name(),
            "model_checksum": checksum_of(mechanism),
            "coordinates": names.collect::<Vec<_>>(),
            "configurations": source(&options.source),
            "rows": rows,
            "part_rows": options.part_rows,
            "quantities": quantities.collect::<Vec<_>>(),
            "frame": frame,
            "frame_from_tool": evaluator.end_effector.frame_from_tool.to_matrix(),
            "task": evaluator.task,
            "metric": options.metric.name(),
            "length": evaluator.length,
        }));
        if let Some(base) = options.relative_to {
            recipe.0["relative_to"] = json!(mechanism.frame_of(base).name);
        }
        if options.quantities.contains(&Quantity::Payload) {
            recipe.0["direction"] = json!(options.direction.to_array());
        }
        if let Some(clearances) = &evaluator.clearances {
            let model = &clearances.model;
            let shapes = format!("{:?} {:?}", model.bodies(), model.pairs());
            recipe.0["collision"] = json!({
                "obstacles": model.obstacles().collect::<Vec<_>>(),
                "checksum": Checksum::of(shapes.as_bytes()),
            });
        }
        if !options.columns.is_empty() {
            let own = |c: &OwnColumn| json!({"name": c.name, "unit": c.unit, "version": c.version});
            recipe.0["own_columns"] = options.columns.iter().map(own).collect();
        }
        recipe
    }

    /// The recipe with designs; a length that was not chosen is that of each design.
    pub(super) fn with_designs(
        mut self,
        designs: &Designs,
        rows: u64,
        length: Option<f64>,
    ) -> Self {
        let model = &designs.model;
        let parameters = model.parameters().iter().map(|p| (p.name.clone(), p.value.into()));
        let space = match &designs.space {
            DesignSpace::Grid(axes) => json!({"over": axes.iter().map(axis).collect::<Vec<_>>()}),
            DesignSpace::Samples { ranges, count, seed } => {
                let range =
                    |r: &ParameterRange| json!({"name": r.name, "from": r.from, "to": r.to});
                let ranges = ranges.iter().map(range).collect::<Vec<_>>();
                json!({"vary": ranges, "count": count, "seed": seed})
            }
        };
        self.0["designs"] = json!({
            "file_checksum": Checksum::of(model.text().as_bytes()),
            "parameters": parameters.collect::<serde_json::Map<String, Value>>(),
            "space": space,
        });
        self.0["rows"] = rows.into();
        self.0["length"] = length.into();
        self
    }

    /// The first entry in which a recipe differs from this one, with both values.
    pub(super) fn difference(&self, other: &Value) -> Option<String> {
        difference("", &self.0, other)
    }
}

fn difference(path: &str, own: &Value, other: &Value) -> Option<String> {
    if own == other {
        return None;
    }
    if let (Value::Object(a), Value::Object(b)) = (own, other) {
        let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
        for key in keys {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let of = |map: &serde_json::Map<String, Value>| map.get(key).cloned();
            let (a, b) = (of(a).unwrap_or_default(), of(b).unwrap_or_default());
            if let Some(found) = difference(&path, &a, &b) {
                return Some(found);
            }
        }
    }
    Some(format!("{path} is {other} there and {own} now"))
}

fn axis(axis: &Axis) -> Value {
    json!({"name": axis.name, "from": axis.from, "to": axis.to, "count": axis.count})
}

fn source(source: &Source) -> Value {
    match source {
        Source::Samples { count, seed } => json!({"samples": count, "seed": seed}),
        Source::Home => json!("home"),
        Source::Grid { axes, rest } => {
            json!({"over": axes.iter().map(axis).collect::<Vec<_>>(), "q": rest})
        }
        Source::Voxels(grid) => json!({
            "reach": grid.axes.iter().map(axis).collect::<Vec<_>>(),
            "world_from_grid": grid.world_from_grid.to_matrix(),
            "directions": grid.directions,
            "rolls": grid.rolls,
        }),
        Source::Poses { targets, task } => {
            let numbers = targets.iter().flat_map(|pose| pose.to_matrix().into_iter().flatten());
            json!({
                "poses_checksum": checksum_of_numbers(numbers),
                "components": task.components,
                "axes": task.axes.name(),
            })
        }
        Source::Configurations(q) => json!({"checksum": checksum_of_numbers(q.iter().copied())}),
    }
}

fn checksum_of_numbers(numbers: impl Iterator<Item = f64>) -> String {
    let mut checksum = Checksum::new();
    numbers.for_each(|x| checksum.update(&x.to_le_bytes()));
    checksum.finish()
}

/// Of joints, loops, contacts and frames with all their numbers.
fn checksum_of(mechanism: &Mechanism) -> String {
    let mut checksum = Checksum::new();
    let m = mechanism;
    // Writing into a hash cannot fail.
    let _ = write!(
        checksum,
        "{:?} {:?} {:?} {:?} {:?} {:?}",
        m.joints(),
        m.loops(),
        m.contacts(),
        m.coordinates(),
        m.frames(),
        m.home()
    );
    checksum.finish()
}
