//! Tables of `screws`: screws, and the matrices at each pitch.

use std::io::Write;

use cylindroid::Matrix;
use cylindroid::screws::{ErrorFormZeros, Screw};

use super::hyperbolic::{Asked, AtPitch, Velocities};
use super::involution::clean;
use crate::output::{self, Align, number};

const TWIST: [&str; 6] = ["vx", "vy", "vz", "wx", "wy", "wz"];
const WRENCH: [&str; 6] = ["fx", "fy", "fz", "mx", "my", "mz"];

pub(super) fn screws<'a>(
    out: &mut dyn Write,
    name: &str,
    rows: impl Iterator<Item = (&'a str, Option<&'a Screw>)>,
) -> anyhow::Result<()> {
    let columns = [
        (name, Align::Left),
        ("pitch [m/rad]", Align::Right),
        ("x [m]", Align::Right),
        ("y [m]", Align::Right),
        ("z [m]", Align::Right),
        ("direction", Align::Left),
    ];
    let rows = rows.map(|(name, screw)| {
        let Some(s) = screw else {
            let blank = ["-"; 4].map(str::to_owned);
            return [vec![name.to_owned()], blank.to_vec(), vec!["zero".to_owned()]].concat();
        };
        let point = if s.is_translation() {
            ["-"; 3].map(str::to_owned).to_vec()
        } else {
            s.axis.point.to_array().map(|x| number(clean(x))).to_vec()
        };
        let pitch = if s.is_translation() { "slides".to_owned() } else { number(clean(s.pitch)) };
        let direction = output::entries(&s.axis.direction.to_array());
        [vec![name.to_owned(), pitch], point, vec![direction]].concat()
    });
    Ok(output::table(out, &columns, rows)?)
}

/// Numbered screws.
pub(super) fn numbered(out: &mut dyn Write, all: &[Screw]) -> anyhow::Result<()> {
    let names: Vec<String> = (1..=all.len()).map(|i| i.to_string()).collect();
    screws(out, "", names.iter().map(String::as_str).zip(all.iter().map(Some)))
}

/// A row for each pitch: existence and Gram determinant.
pub(super) fn existence(out: &mut dyn Write, pitches: &[AtPitch]) -> anyhow::Result<()> {
    let columns = [
        ("h [m/rad]", Align::Right),
        ("inverse", Align::Left),
        ("margin", Align::Right),
        ("|P_h|", Align::Right),
        ("det(J^T Q_h J)", Align::Right),
        ("why", Align::Left),
    ];
    let rows = pitches.iter().map(|at| {
        vec![
            pitch(at.h),
            if at.existence.exists { "exists" } else { "none" }.to_owned(),
            number(at.existence.margin),
            number(at.norm),
            output::entries(&[at.determinant]),
            at.existence.reason.map(|r| r.to_string()).unwrap_or_default(),
        ]
    });
    Ok(output::table(out, &columns, rows)?)
}

/// A row for each finite pitch: signed squares of the hyperbolic singular values.
pub(super) fn singular_values(out: &mut dyn Write, pitches: &[AtPitch]) -> anyhow::Result<()> {
    let columns = [
        ("h [m/rad]", Align::Right),
        ("signed squares", Align::Left),
        ("signature", Align::Left),
        ("polar decomposition", Align::Left),
    ];
    let finite = || pitches.iter().filter_map(|at| Some((at.h, at.svd.as_ref()?)));
    if finite().next().is_none() {
        return Ok(());
    }
    writeln!(out, "\nHyperbolic singular values of the twists")?;
    let rows = finite().map(|(h, svd)| {
        vec![
            pitch(h),
            output::entries(&svd.squares),
            svd.signature.to_string(),
            svd.verdict.description().to_owned(),
        ]
    });
    Ok(output::table(out, &columns, rows)?)
}

/// The matrices and the h-reciprocal system of one pitch.
pub(super) fn matrices(out: &mut dyn Write, names: &[String], at: &AtPitch) -> anyhow::Result<()> {
    let h =
        if at.h.is_infinite() { "infinity".to_owned() } else { format!("{} m/rad", pitch(at.h)) };
    let mut table = |title: &str, rows: &[&str], columns: &[&str], m: &Matrix| {
        writeln!(out, "\n{title} at h = {h}")?;
        output::matrix(out, rows, columns, &m.to_rows())
    };
    if let Some(m) = &at.matrices {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        if !names.is_empty() {
            table("Hyperbolic pseudoinverse J^{+h}", &names, &TWIST, &m.inverse)?;
        }
        table("Projector of twists P_h", &TWIST, &TWIST, &m.projector)?;
        table("Projector of wrenches P*_h", &WRENCH, &WRENCH, &m.constraint)?;
    }
    if !matches!(at.reciprocal.len(), 0 | 6) {
        let discarded =
            if at.matrices.is_some() { ": twists that the inverse discards" } else { "" };
        writeln!(out, "\nh-reciprocal system at h = {h}{discarded}")?;
        numbered(out, &at.reciprocal)?;
    }
    Ok(())
}

/// Joint velocities and error form for the twist.
pub(super) fn velocities(
    out: &mut dyn Write,
    names: &[String],
    asked: &Asked,
    pitches: &[AtPitch],
    of_loops: bool,
) -> anyhow::Result<()> {
    writeln!(out)?;
    let zeros = match &asked.zeros {
        ErrorFormZeros::At(zeros) if zeros.is_empty() => "at no h".to_owned(),
        ErrorFormZeros::At(zeros) => format!("at h = {} m/rad", output::entries(zeros)),
        ErrorFormZeros::Everywhere => "at every h at which the inverse exists".to_owned(),
        ErrorFormZeros::Undefined => "not defined: there is no inverse for any h".to_owned(),
    };
    output::pairs(
        out,
        [("twist", output::entries(&asked.twist.to_array())), ("error form Phi_h vanishes", zeros)],
    )?;
    let found = || pitches.iter().filter_map(|at| Some((at.h, at.velocities.as_ref()?)));
    if found().next().is_none() {
        return Ok(());
    }
    let what = if of_loops { "Amplitudes of the motions above" } else { "Joint velocities" };
    if !names.is_empty() {
        writeln!(out, "\n{what} for the twist")?;
        rows(out, names.iter().map(String::as_str), found(), |v| &v.joint_velocities)?;
    }
    writeln!(out, "\nTwist that they produce, P_h s, and error form")?;
    let realised = |v: &Velocities| [&v.realised.to_array()[..], &[v.error_form]].concat();
    rows(out, TWIST.into_iter().chain(["Phi_h"]), found(), realised)
}

/// A row of numbers for each pitch.
fn rows<'a, R: AsRef<[f64]> + 'a>(
    out: &mut dyn Write,
    names: impl Iterator<Item = &'a str>,
    found: impl Iterator<Item = (f64, &'a Velocities)>,
    numbers: impl Fn(&'a Velocities) -> R,
) -> anyhow::Result<()> {
    let mut columns = vec![("h [m/rad]", Align::Right)];
    columns.extend(names.map(|name| (name, Align::Right)));
    let rows = found.map(|(h, v)| {
        let cells = numbers(v).as_ref().iter().map(|x| output::entries(&[*x])).collect::<Vec<_>>();
        [vec![pitch(h)], cells].concat()
    });
    Ok(output::table(out, &columns, rows)?)
}

fn pitch(h: f64) -> String {
    if h.is_infinite() { "infinity".to_owned() } else { number(h) }
}
