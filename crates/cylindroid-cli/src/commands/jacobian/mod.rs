//! `jacobian`: the Jacobian of a frame, its singular values, rank, time derivative and inverse.

mod inverse;

use std::io::Write;

use cylindroid::kinematics::OrientationRates;
use cylindroid::linalg::{Metric, Rank, Svd};
use cylindroid::{Error, Matrix, ReferenceFrame};
use serde::Serialize;

use self::inverse::InverseJson;
use crate::args::{Angles, JacobianArgs, ReferenceName};
use crate::commands::shared::{Style, configuration, end_effector, load};
use crate::exit::Exit;
use crate::output;

#[derive(Debug, Serialize)]
struct JacobianJson<'a> {
    model: &'a str,
    frame: &'a str,
    /// Point and axes of the twist; those of an analytical Jacobian are the frame's origin and
    /// the world's axes, `relative` has the frame's origin and the axes of `relative_to`.
    reference: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_to: Option<&'a str>,
    q: &'a [f64],
    joint_names: Vec<&'a str>,
    outside_limits: Vec<&'a str>,
    /// Six rows, linear first.
    matrix: Vec<Vec<f64>>,
    /// Of the matrix with its linear rows divided by `length`, largest first.
    singular_values: Vec<f64>,
    /// At machine precision.
    rank: usize,
    /// Last singular value counted over the first one not counted; null where nothing was left
    /// out but exact zeros.
    gap: f64,
    /// Characteristic length of the linear rows [m].
    length: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    analytical: Option<AnalyticalJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint_velocities: Option<Vec<f64>>,
    /// d matrix / dt at these joint velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    derivative: Option<Vec<Vec<f64>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inverse: Option<InverseJson>,
}

#[derive(Debug, Serialize)]
struct AnalyticalJson {
    angles: &'static str,
    /// Of the map from the rates of the angles to the angular velocity.
    determinant: f64,
    /// False where the angles are singular (gimbal lock).
    exists: bool,
}

pub(crate) fn run(args: &JacobianArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = load(&args.configuration.model, &[])?;
    let degrees = args.configuration.degrees;
    let state = robot.state(&configuration(&robot, &args.configuration)?)?;
    let end_effector = end_effector(&robot, &args.frame)?;
    let reference = match args.reference {
        ReferenceName::Local => ReferenceFrame::Local,
        ReferenceName::World => ReferenceFrame::World,
        ReferenceName::LocalWorldAligned => ReferenceFrame::LocalWorldAligned,
    };

    let (matrix, analytical) = match (args.analytical, &args.relative_to) {
        (None, None) => (state.jacobian(end_effector, reference)?, None),
        (None, Some(base)) => (state.relative_jacobian(end_effector, robot.frame(base)?)?, None),
        (Some(angles), _) => {
            let (kind, angles) = orientation_rates(angles);
            let of = state.analytical_jacobian(end_effector, kind)?;
            let report = AnalyticalJson { angles, determinant: of.determinant, exists: of.exists };
            (of.matrix, Some(report))
        }
    };
    let joint_velocities =
        args.velocities.as_ref().map(|r| r.velocities(&robot, degrees)).transpose()?;
    let derivative = joint_velocities
        .as_ref()
        .map(|r| state.jacobian_dot(r, end_effector, reference))
        .transpose()?;
    let length = args.length.unwrap_or(robot.reach());
    Error::check_positive("--length", length)?;
    let found = inverse::find(args, &state, end_effector, (reference, &matrix), length)?;
    let (singular_values, rank) = scaled_singular_values(&matrix, length)?;

    let report = JacobianJson {
        model: robot.name(),
        frame: &robot.frame_of(end_effector.frame).name,
        reference: args.relative_to.as_ref().map_or(reference.name(), |_| "relative"),
        relative_to: args.relative_to.as_deref(),
        q: state.q(),
        joint_names: output::joint_names(&robot),
        outside_limits: output::outside_limits(&robot, state.q()),
        matrix: matrix.to_rows(),
        singular_values,
        rank: rank.rank,
        gap: rank.gap,
        length,
        analytical,
        joint_velocities,
        derivative: derivative.map(|d| d.to_rows()),
        inverse: found,
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report)?,
    }
    Ok(Exit::answer(report.inverse.as_ref().is_none_or(|inverse| inverse.exists)))
}

fn orientation_rates(angles: Angles) -> (OrientationRates, &'static str) {
    match angles {
        Angles::Rpy => (OrientationRates::Rpy, "rpy"),
        Angles::Zyz => (OrientationRates::Zyz, "zyz"),
        Angles::Xyz => (OrientationRates::Xyz, "xyz"),
        Angles::RotationVector => (OrientationRates::RotationVector, "rotation-vector"),
    }
}

/// Singular values and rank with the linear rows divided by `length`.
fn scaled_singular_values(jacobian: &Matrix, length: f64) -> cylindroid::Result<(Vec<f64>, Rank)> {
    let linear = length.powi(-2);
    let metric = Metric::diagonal("length", &[linear, linear, linear, 1.0, 1.0, 1.0])?;
    let mut scaled = jacobian.clone();
    metric.whiten_rows(&mut scaled);
    let svd = Svd::of(&scaled);
    Ok((svd.values().collect(), svd.machine_rank()))
}

fn print(out: &mut dyn Write, report: &JacobianJson<'_>) -> anyhow::Result<()> {
    let mut rows = ["vx [m/s]", "vy [m/s]", "vz [m/s]", "wx [rad/s]", "wy [rad/s]", "wz [rad/s]"];
    let mut note = output::outside_note(&report.outside_limits);
    if let Some(analytical) = &report.analytical {
        let angles = match analytical.angles {
            "rpy" => ["roll rate", "pitch rate", "yaw rate"],
            "zyz" | "xyz" => ["alpha rate", "beta rate", "gamma rate"],
            _ => ["r_x rate", "r_y rate", "r_z rate"],
        };
        rows[3..].copy_from_slice(&angles);
        if !analytical.exists {
            "the angles are singular here (gimbal lock): the last three rows hold least-squares \
             rates"
                .clone_into(&mut note);
        }
    }
    output::pairs(
        out,
        [
            ("model", report.model.to_owned()),
            ("q [rad or m]", output::entries(report.q)),
            ("frame", report.frame.to_owned()),
            ("reference", reference_text(report)),
            ("note", note),
        ],
    )?;
    writeln!(out)?;
    output::matrix(out, &rows, &report.joint_names, &report.matrix)?;
    if let Some(derivative) = &report.derivative {
        writeln!(
            out,
            "\ntime derivative at the joint velocities {}",
            output::list(report.joint_velocities.as_deref().unwrap_or(&[]))
        )?;
        output::matrix(
            out,
            &rows.map(|r| r.split(' ').next().unwrap_or(r)),
            &report.joint_names,
            derivative,
        )?;
    }
    writeln!(out)?;
    output::pairs(
        out,
        [
            ("singular values", output::list(&report.singular_values)),
            ("rank", rank_text(report)),
            (
                "length [m]",
                format!(
                    "{}, divides the linear rows for the singular values",
                    output::number(report.length)
                ),
            ),
        ],
    )?;
    let Some(found) = &report.inverse else { return Ok(()) };
    inverse::print(out, found, &report.joint_names, &rows)
}

fn reference_text(report: &JacobianJson<'_>) -> String {
    report.relative_to.map_or(report.reference.to_owned(), |base| {
        format!("relative to '{base}', in its axes, at the frame's origin")
    })
}

fn rank_text(report: &JacobianJson<'_>) -> String {
    if report.gap.is_infinite() {
        return report.rank.to_string();
    }
    format!("{} (gap to the next singular value {})", report.rank, output::number(report.gap))
}
