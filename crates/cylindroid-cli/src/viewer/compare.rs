//! Compares two inverses of one twist, at the tool and at another reference point.

use cylindroid::control::{InverseChoice, TaskProjection, VelocitiesAtPoint};
use cylindroid::inverse::HyperbolicDamping;
use cylindroid::{Error, Method, Twist, Vec3};
use serde::Serialize;
use serde_json::Value;

use super::inverse_parameters::{damping, hyperbolic};
use super::json::text;
use super::messages::{Compare, Complaint};
use super::session::Session;

/// The default twist, if the servo requests none [m/s].
const DEFAULT_TWIST: Twist = Twist { linear: Vec3::new(0.1, 0.0, 0.0), angular: Vec3::ZERO };

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename = "compare")]
pub(super) struct CompareJson<'a> {
    #[cfg_attr(test, ts(type = "string | number | null"))]
    reply_to: Option<&'a Value>,
    twist: [f64; 6],
    tool_point: [f64; 3],
    point: [f64; 3],
    names: Vec<&'a str>,
    results: Vec<ResultJson<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "ComparedMethod"))]
struct ResultJson<'a> {
    method: &'a str,
    h: Option<f64>,
    exists: bool,
    reason: Option<String>,
    joint_velocities: Option<Vec<f64>>,
    joint_velocities_at_point: Option<Vec<f64>>,
    difference: Option<f64>,
    invariant: bool,
    achieved: Option<[f64; 6]>,
    achieved_at_point: Option<[f64; 6]>,
}

/// The answer to `compare`.
pub(super) fn compare(
    session: &Session,
    requested: &Compare,
    id: Option<&Value>,
) -> Result<String, Complaint> {
    let at = |place: &'static str| move |error: Error| Complaint::of(place, &error);
    let (options, state) = (session.options(), session.state());
    let tool = state.pose(options.end_effector).map_err(at("compare"))?;
    let asked = match requested.twist {
        Some(twist) => Twist::from_array(twist),
        None => {
            let error = tool.error_to(session.target());
            let (k, most) = (options.gain, options.tolerance);
            let there =
                error.linear.norm() <= most.position && error.angular.norm() <= most.orientation;
            let asked =
                Twist { linear: error.linear * k.position, angular: error.angular * k.orientation };
            if there { DEFAULT_TWIST } else { asked }
        }
    };
    let point = Vec3::from_array(requested.point);
    let mut results = Vec::new();
    let mut coordinates = Vec::new();
    for name in &requested.methods {
        let h = match (hyperbolic().any(|i| i.name == name), requested.h) {
            (false, _) => None,
            (true, Some(h)) => Some(h),
            (true, None) => Some(session.best_pitch().map_err(at("compare.h"))?),
        };
        let choice = InverseChoice {
            method: if h.is_some() { Method::default() } else { plain(name)? },
            projection: h.map_or(TaskProjection::Orthogonal, |h| projection(name, h)),
            length: options.length,
        };
        let found = choice
            .at_two_points(state, options.end_effector, asked, point)
            .map_err(at("compare"))?;
        let VelocitiesAtPoint { joint_velocities, achieved, reason } = found.at_tool;
        let reason = reason.or(found.at_point.reason);
        let six = |t: Option<Twist>| t.map(Twist::to_array);
        results.push(ResultJson {
            method: name,
            h,
            exists: reason.is_none(),
            reason: reason.map(|r| r.to_string()),
            joint_velocities,
            joint_velocities_at_point: found.at_point.joint_velocities,
            difference: found.difference,
            invariant: found.invariant,
            achieved: six(achieved),
            achieved_at_point: six(found.at_point.achieved),
        });
        coordinates = found.coordinates;
    }
    let name = |c: &usize| session.mechanism().coordinates()[*c].name.as_str();
    Ok(text(&CompareJson {
        reply_to: id,
        twist: asked.to_array(),
        tool_point: tool.translation.to_array(),
        point: requested.point,
        names: coordinates.iter().map(name).collect(),
        results,
    }))
}

fn plain(name: &str) -> Result<Method, Complaint> {
    Method::named(name).map_err(|_| {
        let all = Method::ALL.iter().map(Method::name).chain(hyperbolic().map(|i| i.name));
        Complaint::of("compare.methods", &Error::unknown("inverse", name, all))
    })
}

fn projection(name: &str, h: f64) -> TaskProjection {
    let number = |of: &str| damping(name).get(of).copied();
    match (number("mu"), number("lambda")) {
        (Some(mu), _) => {
            TaskProjection::DampedHyperbolic { h, damping: HyperbolicDamping::Invariant { mu } }
        }
        (_, Some(lambda)) => {
            TaskProjection::DampedHyperbolic { h, damping: HyperbolicDamping::Gram { lambda } }
        }
        _ => TaskProjection::Hyperbolic { h },
    }
}
