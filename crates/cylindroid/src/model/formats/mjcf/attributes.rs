//! Attributes of MJCF elements: those that are read, and the reasons for ignoring others.

pub(super) const FORMAT: &str = "MJCF";

/// The attributes that give an orientation; an element has at most one of them.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// The attributes of equality constraints that are read.
const EQUALITY: [&str; 14] = [
    "name", "class", "active", "body1", "body2", "anchor", "site1", "site2", "relpose", "joint1",
    "joint2", "polycoef", "tendon1", "tendon2",
];

/// The attributes that are read, by element; none of other elements.
pub(super) fn used(element: &str) -> Vec<&'static str> {
    let own: &[&str] = match element {
        "joint" | "freejoint" => &[
            "name",
            "class",
            "type",
            "group",
            "pos",
            "axis",
            "range",
            "limited",
            "ref",
            "armature",
            "actuatorfrcrange",
            "actuatorfrclimited",
        ],
        "body" | "frame" => &["name", "childclass"],
        "attach" => &["model", "body", "prefix"],
        "model" => &["name", "file"],
        "replicate" => &["count", "offset", "sep", "childclass"],
        "inertial" => &["mass", "diaginertia", "fullinertia"],
        "motor" => &[
            "name",
            "class",
            "joint",
            "jointinparent",
            "gear",
            "forcerange",
            "forcelimited",
            "ctrlrange",
            "ctrllimited",
        ],
        "general" | "position" | "velocity" | "intvelocity" | "damper" | "cylinder" | "muscle"
        | "dcmotor" | "adhesion" => {
            &["name", "class", "joint", "jointinparent", "gear", "forcerange", "forcelimited"]
        }
        "equality" => &EQUALITY,
        "geom" => &[
            "name",
            "class",
            "type",
            "size",
            "fromto",
            "rgba",
            "material",
            "mesh",
            "contype",
            "conaffinity",
            "group",
            "mass",
            "density",
        ],
        "site" => &["name", "class", "fromto"],
        "mesh" => &["name", "class", "file", "scale", "inertia"],
        "material" => &["name", "class", "rgba"],
        _ => &[],
    };
    let mut all = own.to_vec();
    if matches!(element, "body" | "frame" | "inertial" | "geom" | "site") {
        all.push("pos");
        all.extend(ORIENTATIONS);
    }
    if element == "replicate" {
        all.push("euler");
    }
    all
}

pub(super) fn why_unused(name: &str) -> &'static str {
    match name {
        "damping" | "frictionloss" | "stiffness" | "springref" | "springdamper" | "solreflimit"
        | "solimplimit" | "solreffriction" | "solimpfriction" | "gravcomp" => {
            "springs, friction and inertia do not enter the kinematics"
        }
        "friction" | "condim" | "solref" | "solimp" | "margin" | "gap" | "priority" | "solmix"
        | "contact" | "fluidshape" | "fluidcoef" => "contacts of the simulation are not used",
        "option" | "visual" | "statistic" | "sensor" | "custom" | "extension" | "plugin"
        | "user" => "settings of the simulator are not used",
        "rgba" | "material" | "type" | "size" | "group" => "it is not drawn",
        "ctrlrange" | "ctrllimited" | "kp" | "kv" | "dampratio" | "timeconst" | "gaintype"
        | "biastype" | "gainprm" | "biasprm" | "dyntype" | "dynprm" | "actdim" | "inheritrange"
        | "actlimited" | "actrange" | "lengthrange" | "delay" | "nsample" | "interp" => {
            "control of the simulation is not used"
        }
        "solreffix" | "torquescale" => "settings of the simulator are not used",
        "camera" | "light" | "texture" | "hfield" | "skin" => "it is not drawn",
        "tendon" | "deformable" | "flexcomp" | "composite" => {
            "it is not read; what it ties together is free here"
        }
        _ => "not known to this reader",
    }
}
