//! `grasp`: force closure of the contacts on an object, and its mobility without friction.

use std::io::Write;

use cylindroid::closure::{
    ContactProperties, FingerContact, GraspMetric, GraspQuality, WrenchSpace, grasp_contacts,
    grasp_mobility, grasp_quality,
};
use cylindroid::model::Mechanism;
use cylindroid::tolerance::LENGTHS;
use cylindroid::{Error, FrameId, Result};
use serde::Serialize;

use crate::args::GraspArgs;
use crate::commands::closed::immobilisation::{CurvatureJson, ImmobilisationJson};
use crate::commands::shared::{Style, configuration, load};
use crate::exit::Exit;
use crate::output::{self, Align, number};
use crate::values::components;

#[derive(Debug, Serialize)]
struct GraspJson<'a> {
    model: &'a str,
    /// Moments are about its origin, in world axes.
    frame: &'a str,
    q: &'a [f64],
    /// True if every wrench can be resisted.
    closed: bool,
    epsilon: BoundsJson,
    /// "l1": the normal forces sum to 1 N; "linf": each is at most the finger's strength.
    metric: &'static str,
    components: &'static [&'static str],
    /// Unit vector, moments over the length: the least resisted direction.
    weakest: &'a [f64],
    /// Characteristic length [m].
    length: f64,
    contacts: Vec<ContactJson<'a>>,
    /// Null where there are too many contacts for it.
    immobilisation: Option<ImmobilisationJson<'a>>,
    /// Why it is null.
    #[serde(skip_serializing_if = "Option::is_none")]
    not_analysed: Option<&'a str>,
}

#[derive(Debug, Serialize)]
struct BoundsJson {
    lower: f64,
    upper: f64,
}

#[derive(Debug, Serialize)]
struct ContactJson<'a> {
    name: &'a str,
    kind: &'static str,
    /// [m], world.
    point: [f64; 3],
    /// Into the object.
    normal: [f64; 3],
    mu: f64,
    /// [m]; null for hard fingers.
    torsion: Option<f64>,
    /// Largest normal force [N]; null where all share 1 N.
    strength: Option<f64>,
    curvature: CurvatureJson,
}

pub(crate) fn run(args: &GraspArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let mechanism = load(&args.configuration.model, &[])?;
    let q = configuration(&mechanism, &args.configuration)?;
    let object = match &args.frame {
        Some(name) => mechanism.frame(name)?,
        None => mechanism.reference(),
    };
    let state = mechanism.state(&q)?;
    let (places, fingers): (Vec<usize>, Vec<FingerContact>) =
        fingers(&mechanism, &state, object, args)?.into_iter().unzip();
    let mut space = WrenchSpace::about(&state, object, &fingers)?;
    if let Some(length) = args.length {
        Error::check_range("--length", length, &LENGTHS)?;
        space.length = length;
    }
    let metric = match args.strength {
        Some(_) => GraspMetric::LInf,
        None => GraspMetric::L1,
    };
    let quality = grasp_quality(&fingers, space, metric)?;
    // Force closure has no limit of contacts: its verdict stands without that of mobility.
    let mobility = match grasp_mobility(&fingers, space) {
        Err(Error::InvalidOption { option: "contacts", reason, .. }) => Err(reason),
        found => Ok(found?),
    };
    let contacts = places.iter().zip(&fingers).map(|(&i, finger)| {
        let contact = &mechanism.contacts()[i];
        ContactJson {
            name: &contact.name,
            kind: contact.kind.name(),
            point: finger.point.to_array(),
            normal: finger.normal.to_array(),
            mu: finger.friction.mu(),
            torsion: finger.friction.torsion(),
            strength: args.strength.is_some().then_some(finger.strength),
            curvature: CurvatureJson::of(finger),
        }
    });
    let report = GraspJson {
        model: mechanism.name(),
        frame: &mechanism.frame_of(object).name,
        q: &q,
        closed: quality.closed,
        epsilon: BoundsJson { lower: quality.epsilon.lower, upper: quality.epsilon.upper },
        metric: metric.name(),
        components: components(if space.planar { 3 } else { 6 }),
        weakest: &quality.weakest,
        length: space.length,
        contacts: contacts.collect(),
        immobilisation: mobility.as_ref().ok().map(ImmobilisationJson::of),
        not_analysed: mobility.as_ref().err().map(String::as_str),
    };
    match style {
        Style::Json => output::json(out, &report)?,
        Style::Table => print(out, &report, &quality)?,
    }
    Ok(Exit::answer(quality.closed))
}

/// The contacts on the object; an error where there are none.
fn fingers(
    mechanism: &Mechanism,
    state: &cylindroid::State,
    object: FrameId,
    args: &GraspArgs,
) -> Result<Vec<(usize, FingerContact)>> {
    let names: Vec<&str> = mechanism.contacts().iter().map(|c| c.name.as_str()).collect();
    let options = [&args.mu, &args.torsion, &args.strength];
    for given in options.into_iter().flatten() {
        given.check("contact", &names)?;
    }
    let found = grasp_contacts(state, object, |contact| {
        let of = |i: usize| options[i].as_ref().and_then(|given| given.of(&contact.name));
        ContactProperties { mu: of(0), torsion: of(1), strength: of(2).unwrap_or(1.0) }
    })?;
    let weak = |i: usize| {
        let name = &mechanism.contacts()[i].name;
        args.strength.as_ref().is_some_and(|given| given.of(name).is_none())
    };
    if let Some((i, _)) = found.iter().find(|(i, _)| weak(*i)) {
        return Err(Error::InvalidOption {
            option: "--strength",
            value: mechanism.contacts()[*i].name.clone(),
            reason: "no strength is given; give a number for all, or name=number for each"
                .to_owned(),
        });
    }
    if found.is_empty() {
        let link = &mechanism.links()[mechanism.frame_of(object).link].name;
        return Err(Error::InvalidOption {
            option: "--frame",
            value: mechanism.frame_of(object).name.clone(),
            reason: if names.is_empty() {
                format!("'{}' has no contacts; write [[contact]] tables", mechanism.name())
            } else {
                format!("no contact touches link '{link}'; name a frame of the object")
            },
        });
    }
    Ok(found)
}

fn print(
    out: &mut dyn Write,
    report: &GraspJson<'_>,
    quality: &GraspQuality,
) -> anyhow::Result<()> {
    let result = if report.closed {
        "closed: the fingers can resist every wrench with large enough forces".to_owned()
    } else {
        "open: wrenches along the weakest direction cannot be resisted".to_owned()
    };
    let metric = match report.metric {
        "linf" => "Q-infinity: each normal force at most the finger's strength",
        _ => "Q1: the normal forces sum to 1 N",
    };
    let epsilon = [quality.epsilon.lower, quality.epsilon.upper].map(number).join(" to ");
    let mut pairs = vec![
        ("model", report.model.to_owned()),
        ("object frame", report.frame.to_owned()),
        ("q [rad or m]", output::entries(report.q)),
        ("result", result),
        ("epsilon [N]", epsilon),
        ("metric", metric.to_owned()),
        ("length [m]", number(report.length)),
    ];
    if let Some(found) = &report.immobilisation {
        pairs.extend(found.pairs());
    }
    if let Some(reason) = report.not_analysed {
        pairs.push(("without friction", format!("not analysed: {reason}")));
    }
    output::pairs(out, pairs)?;
    writeln!(out)?;
    let mut columns = vec![("weakest direction", Align::Left)];
    columns.extend(report.components.iter().map(|c| (*c, Align::Right)));
    let cells = report.weakest.iter().map(|x| output::entries(&[*x]));
    let row = std::iter::once("moments over the length".to_owned()).chain(cells).collect();
    output::table(out, &columns, [row])?;
    writeln!(out)?;
    if let Some(found) = &report.immobilisation {
        found.print(out, report.components)?;
    }
    let columns = [
        ("contact", Align::Left),
        ("kind", Align::Left),
        ("point [m]", Align::Left),
        ("normal", Align::Left),
        ("mu", Align::Right),
        ("torsion [m]", Align::Right),
        ("strength [N]", Align::Right),
        ("finger [1/m]", Align::Right),
        ("object [1/m]", Align::Right),
    ];
    let given = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), number);
    let rows = report.contacts.iter().map(|c| {
        let [finger, object] = c.curvature.cells();
        vec![
            c.name.to_owned(),
            c.kind.to_owned(),
            output::entries(&c.point),
            output::entries(&c.normal),
            number(c.mu),
            given(c.torsion),
            given(c.strength),
            finger,
            object,
        ]
    });
    Ok(output::table(out, &columns, rows)?)
}
