//! Attributes of MJCF elements: those that are read, and the reasons for ignoring others.

pub(super) const FORMAT: &str = "MJCF";

/// The attributes that give an orientation; an element has at most one of them.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// The attributes that are read, by element; other elements are not checked.
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
            "actuatorfrcrange",
        ],
        "body" => &["name", "childclass"],
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
        "site" => &["name", "class", "type", "size", "rgba", "material", "group"],
        "mesh" => &["name", "class", "file", "scale"],
        "material" => &["name", "class", "rgba"],
        _ => &[],
    };
    let mut all = own.to_vec();
    if matches!(element, "body" | "geom" | "site") {
        all.push("pos");
        all.extend(ORIENTATIONS);
    }
    all
}

pub(super) fn why_unused(name: &str) -> &'static str {
    match name {
        "damping" | "armature" | "frictionloss" | "stiffness" | "springref" | "springdamper"
        | "solreflimit" | "solimplimit" | "solreffriction" | "solimpfriction" | "gravcomp" => {
            "springs, friction and inertia do not enter the kinematics"
        }
        "friction" | "condim" | "solref" | "solimp" | "margin" | "gap" | "priority" | "solmix"
        | "contact" | "fluidshape" | "fluidcoef" => "contacts of the simulation are not used",
        "option" | "size" | "visual" | "statistic" | "sensor" | "custom" | "extension"
        | "plugin" | "actuatorfrclimited" | "user" => "settings of the simulator are not used",
        "camera" | "light" | "texture" | "hfield" | "skin" => "it is not drawn",
        "tendon" | "deformable" | "flexcomp" | "composite" => {
            "it is not read; what it ties together is free here"
        }
        "replicate" | "attach" => "it is not expanded: what it would bring is missing",
        _ => "not known to this reader",
    }
}
