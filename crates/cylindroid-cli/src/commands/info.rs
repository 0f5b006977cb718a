//! `info`: what a model is.

use std::io::{self, Write};

use cylindroid::Mechanism;
use cylindroid::ik::Analytic;
use cylindroid::model::formats::srdf;
use cylindroid::model::{Ignored, Joint, Parameter};
use serde::Serialize;

use crate::args::InfoArgs;
use crate::commands::shared::{Style, limited, load};
use crate::exit::Exit;
use crate::output::{self, Align, MimicJson};

#[derive(Debug, Serialize)]
pub(crate) struct InfoJson<'a> {
    name: &'a str,
    n: usize,
    joint_names: Vec<&'a str>,
    coordinates: Vec<CoordinateJson<'a>>,
    joints: Vec<JointJson<'a>>,
    loops: Vec<LoopJson<'a>>,
    contacts: Vec<ContactJson<'a>>,
    dimension: usize,
    reference: ReferenceJson<'a>,
    links: Vec<&'a str>,
    frames: Vec<FrameJson<'a>>,
    tool: &'a str,
    tool_choice: String,
    home: &'a [f64],
    reach: f64,
    parameters: Vec<ParameterJson<'a>>,
    inverse_kinematics: AnalyticJson,
    report: ReportJson<'a>,
}

#[derive(Debug, Serialize)]
struct CoordinateJson<'a> {
    name: &'a str,
    joint: &'a str,
    kind: &'static str,
    unit: &'static str,
    lower: f64,
    upper: f64,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
    effort: f64,
    actuated: bool,
    home: f64,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    name: &'a str,
    kind: &'static str,
    parent: &'a str,
    child: &'a str,
    axis: [f64; 3],
    reversed: bool,
    actuated: bool,
    mimic: Option<MimicJson<'a>>,
}

/// A joint that closes a loop.
#[derive(Debug, Serialize)]
struct LoopJson<'a> {
    name: &'a str,
    kind: &'static str,
    a: &'a str,
    b: &'a str,
    axis: [f64; 3],
    actuated: bool,
}

#[derive(Debug, Serialize)]
struct ContactJson<'a> {
    name: &'a str,
    kind: &'static str,
    a: &'a str,
    b: &'a str,
    friction: Option<f64>,
}

#[derive(Debug, Serialize)]
struct ReferenceJson<'a> {
    frame: &'a str,
    link: &'a str,
}

#[derive(Debug, Serialize)]
struct FrameJson<'a> {
    name: &'a str,
    link: &'a str,
}

#[derive(Debug, Serialize)]
struct ParameterJson<'a> {
    name: &'a str,
    value: f64,
    lower: f64,
    upper: f64,
    unit: &'a str,
    description: &'a str,
    expression: &'a str,
}

impl<'a> From<&'a Parameter> for ParameterJson<'a> {
    fn from(own: &'a Parameter) -> Self {
        Self {
            name: &own.name,
            value: own.value,
            lower: own.lower,
            upper: own.upper,
            unit: &own.unit,
            description: &own.description,
            expression: &own.expression,
        }
    }
}

/// Of the tool frame by formulas, or why not.
#[derive(Debug, Serialize)]
struct AnalyticJson {
    structure: Option<String>,
    reason: Option<String>,
}

#[derive(Debug, Serialize)]
struct ReportJson<'a> {
    format: &'a str,
    source: &'a str,
    ignored: Vec<IgnoredJson<'a>>,
    /// Of the SRDF, if one is named.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ignored_of_srdf: Vec<IgnoredJson<'a>>,
}

#[derive(Debug, Serialize)]
struct IgnoredJson<'a> {
    line: usize,
    what: &'a str,
    why: &'a str,
}

impl<'a> From<&'a Ignored> for IgnoredJson<'a> {
    fn from(i: &'a Ignored) -> Self {
        Self { line: i.line, what: &i.what, why: &i.why }
    }
}

pub(crate) fn run(args: &InfoArgs, style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let robot = limited(load(&args.model, &[])?, &args.limits)?;
    let srdf = args.model.srdf.as_deref().map(srdf::load).transpose()?.unwrap_or_default();
    let mut info = describe(&robot);
    info.report.ignored_of_srdf = srdf.report.ignored.iter().map(IgnoredJson::from).collect();
    match style {
        Style::Json => output::json(out, &info)?,
        Style::Table => print(out, &robot, &info)?,
    }
    Ok(Exit::SUCCESS)
}

/// What a mechanism is.
pub(crate) fn describe(robot: &Mechanism) -> InfoJson<'_> {
    let link = |i: usize| robot.links()[i].name.as_str();
    let coordinates = robot.coordinates().iter().zip(robot.home()).map(|(c, &home)| {
        let joint = &robot.joints()[c.joint];
        CoordinateJson {
            name: &c.name,
            joint: &joint.name,
            kind: joint.kind.name(),
            unit: c.kind.unit(),
            lower: c.limits.lower,
            upper: c.limits.upper,
            velocity: c.limits.velocity,
            acceleration: c.limits.acceleration,
            jerk: c.limits.jerk,
            effort: c.limits.effort,
            actuated: c.actuated,
            home,
        }
    });
    let joints = robot.joints().iter().map(|j| JointJson {
        name: &j.name,
        kind: j.kind.name(),
        parent: link(j.parent),
        child: link(j.child),
        axis: j.axis.to_array(),
        reversed: j.reversed,
        actuated: j.actuated,
        mimic: j.mimic.as_ref().map(MimicJson::from),
    });
    let loops = robot.loops().iter().map(|l| LoopJson {
        name: &l.name,
        kind: l.kind.name(),
        a: link(l.a),
        b: link(l.b),
        axis: l.axis.to_array(),
        actuated: l.actuated,
    });
    let contacts = robot.contacts().iter().map(|c| ContactJson {
        name: &c.name,
        kind: c.kind.name(),
        a: link(c.a),
        b: link(c.b),
        friction: c.friction,
    });
    let reference = robot.frame_of(robot.reference());
    let (structure, reason) = match Analytic::of(robot, robot.tool()) {
        Ok(analytic) => (Some(analytic.geometry().to_string()), None),
        Err(reason) => (None, Some(reason.to_string())),
    };
    InfoJson {
        name: robot.name(),
        n: robot.n(),
        joint_names: output::joint_names(robot),
        coordinates: coordinates.collect(),
        joints: joints.collect(),
        loops: loops.collect(),
        contacts: contacts.collect(),
        dimension: robot.dimension().number(),
        reference: ReferenceJson { frame: &reference.name, link: link(reference.link) },
        links: robot.links().iter().map(|l| l.name.as_str()).collect(),
        frames: robot
            .frames()
            .iter()
            .map(|f| FrameJson { name: &f.name, link: link(f.link) })
            .collect(),
        tool: &robot.frame_of(robot.tool()).name,
        tool_choice: robot.tool_choice().to_string(),
        home: robot.home(),
        reach: robot.reach(),
        parameters: robot.parameters().iter().map(ParameterJson::from).collect(),
        inverse_kinematics: AnalyticJson { structure, reason },
        report: ReportJson {
            format: robot.report().format,
            source: &robot.report().source,
            ignored: robot.report().ignored.iter().map(IgnoredJson::from).collect(),
            ignored_of_srdf: Vec::new(),
        },
    }
}

/// The acceleration limit that a servo takes in place of those of the model.
fn default_ramp(robot: &Mechanism) -> String {
    let ramp = cylindroid::tolerance::DEFAULT_RAMP;
    let slides = robot.coordinates().iter().any(|c| c.kind.is_length());
    let of_slides = match slides {
        true => format!(", {} m/s^2 of slides", output::number(ramp * robot.reach())),
        false => String::new(),
    };
    format!("default ramp of {ramp} rad/s^2{of_slides} (--limits, --acceleration)")
}

fn print(out: &mut dyn Write, robot: &Mechanism, info: &InfoJson<'_>) -> anyhow::Result<()> {
    // Link frames have the names of the links, which the tree shows.
    let named: Vec<String> = info
        .frames
        .iter()
        .filter(|f| f.name != f.link)
        .map(|f| format!("{} (on {})", f.name, f.link))
        .collect();
    let reference = match (robot.is_closed(), info.reference.frame == info.reference.link) {
        (false, _) => String::new(),
        (true, true) => info.reference.frame.to_owned(),
        (true, false) => format!("{} (on {})", info.reference.frame, info.reference.link),
    };
    let unlimited = |c: &CoordinateJson<'_>| c.acceleration.is_infinite();
    let accelerations = match info.report.format {
        _ if info.n == 0 || !info.coordinates.iter().all(unlimited) => String::new(),
        "catalogue" => format!("no limits published; {}", default_ramp(robot)),
        _ => format!("no limits in the model; {}", default_ramp(robot)),
    };
    let count = |n: usize| if n == 0 { String::new() } else { n.to_string() };
    output::pairs(
        out,
        [
            ("model", info.name.to_owned()),
            ("dimension", if info.dimension == 2 { "2".to_owned() } else { String::new() }),
            ("coordinates", info.n.to_string()),
            ("loops", count(info.loops.len())),
            ("contacts", count(info.contacts.len())),
            ("reference", reference),
            ("tool frame", format!("{} ({})", info.tool, info.tool_choice)),
            ("named frames", named.join(", ")),
            ("reach [m]", output::number(info.reach)),
            ("accelerations", accelerations),
            ("formulas for ik", info.inverse_kinematics.structure.clone().unwrap_or_default()),
            ("format", info.report.format.to_owned()),
            ("source", info.report.source.to_owned()),
        ],
    )?;
    writeln!(out)?;
    print_tree(out, robot)?;
    print_closings(out, info)?;
    if info.n > 0 {
        writeln!(out)?;
        print_coordinates(out, info, robot)?;
    }
    print_parameters(out, &info.parameters)?;
    print_ignored(out, "ignored by the loader", &info.report.ignored)?;
    print_ignored(out, "ignored of the SRDF", &info.report.ignored_of_srdf)
}

fn print_ignored(
    out: &mut dyn Write,
    title: &str,
    ignored: &[IgnoredJson<'_>],
) -> anyhow::Result<()> {
    if ignored.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n{title}")?;
    let columns = [("line", Align::Right), ("what", Align::Left), ("why", Align::Left)];
    let rows = ignored.iter().map(|i| {
        let line = if i.line == 0 { "-".to_owned() } else { i.line.to_string() };
        vec![line, i.what.to_owned(), i.why.to_owned()]
    });
    output::table(out, &columns, rows)?;
    Ok(())
}

fn print_parameters(out: &mut dyn Write, parameters: &[ParameterJson<'_>]) -> io::Result<()> {
    if parameters.is_empty() {
        return Ok(());
    }
    let columns = [
        ("parameter", Align::Left),
        ("value", Align::Right),
        ("unit", Align::Left),
        ("lower", Align::Right),
        ("upper", Align::Right),
        ("expression", Align::Left),
        ("description", Align::Left),
    ];
    let rows = parameters.iter().map(|p| {
        vec![
            p.name.to_owned(),
            output::number(p.value),
            p.unit.to_owned(),
            output::number(p.lower),
            output::number(p.upper),
            p.expression.to_owned(),
            p.description.to_owned(),
        ]
    });
    writeln!(out)?;
    output::table(out, &columns, rows)
}

fn print_coordinates(
    out: &mut dyn Write,
    info: &InfoJson<'_>,
    robot: &Mechanism,
) -> io::Result<()> {
    let mut columns = vec![
        ("coordinate", Align::Left),
        ("kind", Align::Left),
        ("unit", Align::Left),
        ("lower", Align::Right),
        ("upper", Align::Right),
        ("velocity [unit/s]", Align::Right),
        ("acceleration [unit/s^2]", Align::Right),
        ("effort", Align::Right),
        ("home", Align::Right),
    ];
    // Few models limit the jerk.
    const JERK: usize = 7;
    let limits_jerks = info.coordinates.iter().any(|c| c.jerk.is_finite());
    if limits_jerks {
        columns.insert(JERK, ("jerk [unit/s^3]", Align::Right));
    }
    let rows = info.coordinates.iter().zip(robot.coordinates()).map(|(c, coordinate)| {
        let unit = match coordinate.kind.is_length() {
            _ if c.effort.is_infinite() => "",
            true => " N",
            false => " N m",
        };
        let effort = format!("{}{unit}", output::number(c.effort));
        let mut row = vec![
            c.name.to_owned(),
            c.kind.to_owned(),
            c.unit.to_owned(),
            output::number(c.lower),
            output::number(c.upper),
            output::number(c.velocity),
            output::number(c.acceleration),
            effort,
            output::number(c.home),
        ];
        if limits_jerks {
            row.insert(JERK, output::number(c.jerk));
        }
        row
    });
    output::table(out, &columns, rows)
}

/// The joints that close loops, and the contacts.
fn print_closings(out: &mut dyn Write, info: &InfoJson<'_>) -> io::Result<()> {
    let columns = |what| {
        [(what, Align::Left), ("kind", Align::Left), ("between", Align::Left), ("", Align::Left)]
    };
    if !info.loops.is_empty() {
        writeln!(out)?;
        let actuated =
            |l: &LoopJson<'_>| if l.actuated { "actuated" } else { "passive" }.to_owned();
        let rows = info.loops.iter().map(|l| {
            vec![l.name.to_owned(), l.kind.to_owned(), format!("{}, {}", l.a, l.b), actuated(l)]
        });
        output::table(out, &columns("closing joint"), rows)?;
    }
    if !info.contacts.is_empty() {
        writeln!(out)?;
        let rows = info.contacts.iter().map(|c| {
            let friction = c.friction.map_or_else(String::new, |mu| format!("friction {mu}"));
            vec![c.name.to_owned(), c.kind.to_owned(), format!("{}, {}", c.a, c.b), friction]
        });
        output::table(out, &columns("contact"), rows)?;
    }
    Ok(())
}

/// Characters before a link of the tree; links farther from the root are not indented further.
const WIDEST_PREFIX: usize = 150;

/// The links as a tree, each with the joint that carries it. The stack holds joints still to be
/// drawn with the prefix of their line, so that depth is bounded by memory alone.
fn print_tree(out: &mut dyn Write, robot: &Mechanism) -> io::Result<()> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); robot.links().len()];
    let mut is_child = vec![false; robot.links().len()];
    for (i, joint) in robot.joints().iter().enumerate() {
        children[joint.parent].push(i);
        is_child[joint.child] = true;
    }
    for (root, link) in robot.links().iter().enumerate().filter(|(i, _)| !is_child[*i]) {
        writeln!(out, "{}", link.name)?;
        let mut stack: Vec<(usize, String, bool)> = Vec::new();
        push_children(&mut stack, &children[root], "");
        while let Some((i, prefix, is_last)) = stack.pop() {
            let joint = &robot.joints()[i];
            let branch = if is_last { "└─ " } else { "├─ " };
            let child = &robot.links()[joint.child].name;
            writeln!(out, "{prefix}{branch}{child}   {}", joint_text(joint))?;
            // The lines of a chain of 100 000 links would have 15 GB.
            let below = if prefix.chars().count() >= WIDEST_PREFIX {
                prefix
            } else {
                format!("{prefix}{}", if is_last { "   " } else { "│  " })
            };
            push_children(&mut stack, &children[joint.child], &below);
        }
    }
    Ok(())
}

fn push_children(stack: &mut Vec<(usize, String, bool)>, joints: &[usize], prefix: &str) {
    for (place, &joint) in joints.iter().enumerate().rev() {
        stack.push((joint, prefix.to_owned(), place + 1 == joints.len()));
    }
}

fn joint_text(joint: &Joint) -> String {
    let mut text = format!("{} {}", joint.kind.name(), joint.name);
    if let Some(mimic) = &joint.mimic {
        text.push_str(&format!(
            ", follows {} times {} plus {}",
            mimic.joint,
            output::number(mimic.multiplier),
            output::number(mimic.offset)
        ));
    }
    if joint.reversed {
        text.push_str(", reversed");
    }
    if !joint.actuated && joint.kind.dof() > 0 {
        text.push_str(", passive");
    }
    text
}
