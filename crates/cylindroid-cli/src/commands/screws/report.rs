//! Output of `screws`: tables and the JSON object.

use std::io::Write;

use cylindroid::Wrench;
use cylindroid::inverse::PointDirection;
use cylindroid::screws::{Involution, ScrewSystem};
use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use super::basis_screws::basis_screws;
use super::find::Found;
use super::hyperbolic::{AskedJson, AtPitchJson};
use super::involution::{clean, involution};
use super::tables;
use super::twists::Twists;
use crate::commands::closed::ClosureErrorJson;
use crate::commands::shared::Style;
use crate::output::{self, Align, PoseJson, ScrewJson, number};

#[derive(Debug, Serialize)]
struct ScrewsJson<'a> {
    /// The robot, or the file of twists.
    model: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    q: Option<&'a [f64]>,
    /// Names of the twists: the joints that move the frame, or numbers from 1.
    names: &'a [String],
    /// In a closed chain, whose twists are a basis of the motions that the loops permit.
    #[serde(skip_serializing_if = "Option::is_none")]
    closure_error: Option<ClosureErrorJson>,
    /// Linear part first, at the origin of the world (or of the file's frame).
    twists: Vec<[f64; 6]>,
    /// Each twist as a screw; null for a zero twist.
    screws: Vec<Option<ScrewJson>>,
    rank: usize,
    /// Smallest singular value kept over the largest dropped; null if none was dropped.
    gap: f64,
    /// Singular values of unit twists up to this value count as zero.
    threshold: f64,
    /// Of the system, of its reciprocal for rank 4 and 5.
    gibson_hunt: &'static str,
    meaning: &'static str,
    principal_pitches: Vec<f64>,
    principal_screws: Vec<ScrewJson>,
    normal_form: NormalFormJson,
    canonical_pose: PoseJson,
    residual: f64,
    margins: Vec<MarginJson>,
    ambiguous: bool,
    length: f64,
    center: [f64; 3],
    /// Screws that span the reciprocal system.
    reciprocal: Vec<ScrewJson>,
    /// False if no pitch has a hyperbolic inverse.
    invertible: bool,
    choice: ChoiceJson,
    /// At the pitches of --h: existence, matrices, h-reciprocal systems, velocities.
    inverses: Vec<AtPitchJson>,
    /// With --twist.
    #[serde(skip_serializing_if = "Option::is_none")]
    twist: Option<AskedJson>,
    involution: Option<InvolutionJson>,
    /// With --point.
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<PointJson>,
}

#[derive(Debug, Serialize)]
struct PointJson {
    /// The smallest joint velocities that move the point at 1 m/s; null if there are none.
    along: Option<Vec<f64>>,
    /// Joint velocities that leave it at rest, orthonormal.
    still: Vec<Vec<f64>>,
}

#[derive(Debug, Serialize)]
struct NormalFormJson {
    /// Of the system that the form describes.
    order: usize,
    /// [m/rad]
    pitches: Vec<f64>,
    slope: Option<f64>,
}

#[derive(Debug, Serialize)]
struct MarginJson {
    quantity: &'static str,
    value: f64,
    threshold: f64,
}

#[derive(Debug, Serialize)]
struct ChoiceJson {
    /// [m/rad]; null if no finite pitch is proposed.
    pitch: Option<f64>,
    /// True if the limit for h to infinity is proposed.
    at_infinity: bool,
    norm: f64,
    /// null if there is no limit.
    norm_at_infinity: f64,
    /// False if the norm decreases as |h| grows beyond this pitch.
    attained: bool,
}

#[derive(Debug, Serialize)]
struct InvolutionJson {
    /// Number of twists of zero pitch.
    lines: usize,
    in_involution: bool,
    independent: bool,
    null_twist: Option<[f64; 6]>,
    /// Force first.
    wrench: Option<[f64; 6]>,
    transversals: TransversalsJson,
}

#[derive(Debug, Serialize)]
struct TransversalsJson {
    infinitely_many: bool,
    double: bool,
    lines: Vec<LineJson>,
    at_infinity: Vec<[f64; 3]>,
}

#[derive(Debug, Serialize)]
struct LineJson {
    point: [f64; 3],
    direction: [f64; 3],
}

pub(super) fn write(found: &Found, style: Style, out: &mut dyn Write) -> anyhow::Result<()> {
    match style {
        Style::Json => output::json(out, &describe(found)),
        Style::Table => print(out, found),
    }
}

/// The JSON object.
pub(super) fn raw(found: &Found) -> anyhow::Result<Box<RawValue>> {
    Ok(to_raw_value(&describe(found))?)
}

fn describe(found: &Found) -> ScrewsJson<'_> {
    let (twists, system) = (&found.twists, &found.system);
    let (form, choice) = (system.normal_form(), system.choose_pitch());
    let robot = twists.robot.as_ref();
    ScrewsJson {
        model: robot.map_or(&twists.file, |(r, ..)| r.name()),
        frame: robot.map(|(_, frame, _)| frame.as_str()),
        q: robot.map(|(.., q)| q.as_slice()),
        names: &twists.names,
        closure_error: twists.closure_error.map(Into::into),
        twists: twists.twists.iter().map(|t| t.to_array()).collect(),
        screws: found.screws.iter().map(|s| s.as_ref().map(Into::into)).collect(),
        rank: system.order(),
        gap: system.rank().gap,
        threshold: system.rank().threshold,
        gibson_hunt: system.class().name(),
        meaning: system.normal_form().meaning(),
        principal_pitches: system.principal_pitches(),
        principal_screws: system.principal_screws().iter().map(Into::into).collect(),
        normal_form: NormalFormJson {
            order: form.order,
            pitches: form.pitches.clone(),
            slope: form.slope,
        },
        canonical_pose: system.canonical_pose().into(),
        residual: system.residual(),
        margins: system
            .margins()
            .iter()
            .map(|m| MarginJson { quantity: m.quantity, value: m.value, threshold: m.threshold })
            .collect(),
        ambiguous: system.is_ambiguous(),
        length: system.length(),
        center: system.center().to_array(),
        reciprocal: basis_screws(&system.reciprocal()).iter().map(Into::into).collect(),
        invertible: choice.pitch.is_some(),
        choice: ChoiceJson {
            pitch: choice.pitch.filter(|h| h.is_finite()),
            at_infinity: choice.pitch == Some(f64::INFINITY),
            norm: choice.norm,
            norm_at_infinity: choice.norm_at_infinity,
            attained: choice.attained,
        },
        inverses: found.pitches.iter().map(|at| at.json(found.asked.is_some())).collect(),
        twist: found.asked.as_ref().map(Into::into),
        involution: found.involution.as_ref().map(involution_json),
        point: found
            .point
            .as_ref()
            .map(|p| PointJson { along: p.along.clone(), still: output::columns(&p.still) }),
    }
}

fn involution_json(i: &Involution) -> InvolutionJson {
    let t = &i.transversals;
    InvolutionJson {
        lines: i.lines,
        in_involution: i.in_involution,
        independent: i.independent,
        null_twist: i.null_twists.first().map(|z| z.to_array()),
        wrench: i.wrench.map(Wrench::to_array),
        transversals: TransversalsJson {
            infinitely_many: t.infinitely_many,
            double: t.double,
            lines: t
                .lines
                .iter()
                .map(|l| LineJson { point: l.point.to_array(), direction: l.direction.to_array() })
                .collect(),
            at_infinity: t.at_infinity.iter().map(|d| d.to_array()).collect(),
        },
    }
}

fn print(out: &mut dyn Write, found: &Found) -> anyhow::Result<()> {
    let (twists, system) = (&found.twists, &found.system);
    let robot = twists.robot.as_ref();
    let pose = system.canonical_pose();
    let frame = output::pose_cells(pose);
    let form = system.normal_form();
    output::pairs(
        out,
        [
            ("model", robot.map_or(twists.file.as_str(), |(r, ..)| r.name()).to_owned()),
            ("frame", robot.map_or_else(String::new, |(_, frame, _)| frame.clone())),
            ("q [rad or m]", robot.map_or_else(String::new, |(.., q)| output::entries(q))),
            ("loops are open by", open(twists)),
            ("order", order(system, twists.twists.len())),
            ("class", class(system)),
            ("pitches of the class [m/rad]", output::entries(&form.pitches)),
            ("slope of the class", form.slope.map_or_else(String::new, number)),
            ("principal pitches [m/rad]", principal(system)),
            ("canonical frame", canonical(system, &frame)),
            ("verdict", verdict(system)),
            ("hyperbolic inverse", inverse(system)),
            ("axes in involution", found.involution.as_ref().map_or_else(String::new, involution)),
        ],
    )?;
    writeln!(out)?;
    match robot {
        Some((_, frame, _)) if twists.is_of_loops() => {
            writeln!(
                out,
                "Motions of {frame} that the loops permit: a basis, as screws of the world"
            )?;
        }
        _ => writeln!(out, "Twists as screws, in {}", frame_of(found))?,
    }
    let named =
        twists.names.iter().map(String::as_str).zip(found.screws.iter().map(Option::as_ref));
    tables::screws(out, "twist", named)?;
    let principal = system.principal_screws();
    if !principal.is_empty() {
        writeln!(out)?;
        writeln!(out, "Principal screws")?;
        tables::numbered(out, principal)?;
    }
    let reciprocal = basis_screws(&system.reciprocal());
    if !matches!(reciprocal.len(), 0 | 6) {
        writeln!(out)?;
        writeln!(out, "Reciprocal system: forces along these screws do no work")?;
        tables::numbered(out, &reciprocal)?;
    }
    if let Some(p) = &found.point {
        writeln!(out)?;
        point(out, &twists.names, p)?;
    }
    if !found.pitches.is_empty() {
        writeln!(out)?;
        tables::existence(out, &found.pitches)?;
        tables::singular_values(out, &found.pitches)?;
    }
    for at in &found.pitches {
        tables::matrices(out, &twists.names, at)?;
    }
    let Some(asked) = &found.asked else { return Ok(()) };
    tables::velocities(out, &twists.names, asked, &found.pitches, twists.is_of_loops())
}

fn frame_of(found: &Found) -> &'static str {
    if found.twists.robot.is_some() { "the world frame" } else { "the frame of the file" }
}

/// Nothing if they are closed.
fn open(twists: &Twists) -> String {
    match twists.closure_error {
        Some(error) if !error.is_closed(twists.length) => {
            format!("{} m, {} rad: run assemble", number(error.distance), number(error.angle))
        }
        _ => String::new(),
    }
}

fn order(system: &ScrewSystem, count: usize) -> String {
    let gap = system.rank().gap;
    let gap = if gap.is_infinite() {
        "nothing dropped".to_owned()
    } else {
        format!("gap {}", number(gap))
    };
    let s = if count == 1 { "" } else { "s" };
    format!("{} of {count} twist{s} ({gap})", system.order())
}

fn class(system: &ScrewSystem) -> String {
    let (class, order) = (system.class(), system.order());
    let of = if matches!(order, 4 | 5) { "reciprocal to " } else { "" };
    format!("{class}: {of}{}", system.normal_form().meaning())
}

fn principal(system: &ScrewSystem) -> String {
    let pitches = system.principal_pitches();
    if pitches.is_empty() { "none".to_owned() } else { output::entries(&pitches) }
}

fn canonical(system: &ScrewSystem, cells: &[String]) -> String {
    if matches!(system.order(), 0 | 6) {
        return String::new();
    }
    format!(
        "origin {} m; roll, pitch, yaw {} rad; residual of the normal form {}",
        cells[..3].join(", "),
        cells[3..].join(", "),
        number(system.residual())
    )
}

fn verdict(system: &ScrewSystem) -> String {
    let scale = format!(
        "at length {} m and center {} m",
        number(system.length()),
        output::entries(&system.center().to_array().map(clean))
    );
    if !system.is_ambiguous() {
        return format!("clear, {scale}");
    }
    let near = system
        .margins()
        .iter()
        .filter(|m| m.value > 0.0)
        .min_by(|a, b| {
            let distance = |m: &cylindroid::screws::Margin| (m.value / m.threshold).ln().abs();
            distance(a).total_cmp(&distance(b))
        })
        .map(|m| {
            format!(": {} is {}, zero up to {}", m.quantity, number(m.value), number(m.threshold))
        })
        .unwrap_or_default();
    format!("ambiguous, {scale}{near}")
}

fn inverse(system: &ScrewSystem) -> String {
    let choice = system.choose_pitch();
    match system.order() {
        0 => return "exists for every h and is zero".to_owned(),
        6 => return "exists for every h and equals the pseudoinverse".to_owned(),
        _ => {}
    }
    let Some(pitch) = choice.pitch else {
        let reason = system.existence(system.length()).reason;
        return reason.map_or_else(|| "none found".to_owned(), |r| format!("never: {r}"));
    };
    let but = match system.principal_pitches()[..] {
        [] => "for every finite h".to_owned(),
        ref pitches => format!("for every h except {} m/rad", output::entries(pitches)),
    };
    if !choice.attained {
        return format!(
            "exists {but}; the projector norm decreases as |h| grows (|P| = {} at h = {} m/rad), \
             and the limit at infinity does not exist",
            number(choice.norm),
            number(pitch)
        );
    }
    let h = if pitch.is_infinite() {
        "infinity".to_owned()
    } else {
        format!("{} m/rad", number(pitch))
    };
    let limit = if choice.norm_at_infinity.is_infinite() || pitch.is_infinite() {
        String::new()
    } else {
        format!(", {} at infinity", number(choice.norm_at_infinity))
    };
    format!(
        "exists {but}; smallest projector norm at h = {h} (|P| = {}{limit})",
        number(choice.norm)
    )
}

/// Joint velocities: every motion along the direction is the first row times a speed plus the rest.
fn point(out: &mut dyn Write, names: &[String], p: &PointDirection) -> anyhow::Result<()> {
    let mut columns = vec![("joint velocities [rad/s or m/s]", Align::Left)];
    columns.extend(names.iter().map(|name| (name.as_str(), Align::Right)));
    let cells = |what: &str, rates: &[f64]| {
        let cells = rates.iter().map(|x| output::entries(&[*x]));
        [what.to_owned()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let mut rows = Vec::new();
    match &p.along {
        Some(rates) => rows.push(cells("point moves at 1 m/s", rates)),
        None => writeln!(out, "No joint velocities move the point along this direction.")?,
    }
    rows.extend(output::columns(&p.still).iter().map(|rates| cells("point at rest", rates)));
    Ok(output::table(out, &columns, rows)?)
}
