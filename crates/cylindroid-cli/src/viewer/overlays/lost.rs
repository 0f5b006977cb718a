//! The direction of motion lost at a singularity, or about to be lost near one.

use cylindroid::model::Dimension;
use cylindroid::screws::Screw;
use cylindroid::tolerance::DAMPING_ONSET;
use serde::Serialize;

use super::super::measures::Measures;
use super::super::session::Session;
use crate::commands::closed::singularity::motion_in_words;
use crate::output::{ScrewJson, number};

/// Length of the drawing [reach of the mechanism].
const SHARE: f64 = 0.3;

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LostDirection"))]
pub(in super::super) struct LostJson {
    ratio: f64,
    lost: bool,
    linear: [f64; 3],
    angular: [f64; 3],
    screw: ScrewJson,
    sentence: String,
}

/// The direction, or a sentence why there is none.
pub(super) fn lost(
    session: &Session,
    measures: Option<&Measures>,
) -> std::result::Result<LostJson, String> {
    let Some(Measures { condition, .. }) = measures else {
        let why = session.fault().map(ToString::to_string);
        return Err(why.unwrap_or_else(|| "There is no servo.".to_owned()));
    };
    let ratio = condition.singular_ratio;
    let Some(weakest) = condition.weakest else {
        return Err("No motion of the tool is possible here.".to_owned());
    };
    if ratio > DAMPING_ONSET {
        return Err(format!(
            "No direction is almost lost: the smallest singular value is {} of the largest.",
            number(ratio)
        ));
    }
    let (mechanism, state) = (session.mechanism(), session.state());
    let tool =
        state.pose(session.options().end_effector).map_err(|error| error.to_string())?.translation;
    let Some(screw) = Screw::of(weakest.at_point(-tool)) else {
        return Err("No motion of the tool is possible here.".to_owned());
    };
    let lost = condition.inverse.rank < condition.inverse.singular_values.len();
    let planar = mechanism.dimension() == Dimension::Planar;
    let words = motion_in_words(&screw, planar);
    let state = if lost { "is lost here" } else { "is almost lost" };
    let reach = mechanism.reach();
    Ok(LostJson {
        ratio,
        lost,
        linear: (weakest.linear * SHARE).to_array(),
        angular: (weakest.angular * (SHARE * reach)).to_array(),
        screw: (&screw).into(),
        sentence: format!(
            "The motion of the tool {words} {state}: its singular value is {} of the largest.",
            number(ratio)
        ),
    })
}
