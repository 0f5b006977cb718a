//! The targets: what is done with the bytes of one input.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use cylindroid::{Mechanism, catalogue};
use tempfile::TempDir;

use crate::{rounds, use_of_files};

/// Files that inputs may name.
const BESIDE: [(&str, &[u8]); 3] = [
    ("mesh.obj", include_bytes!("../../crates/cylindroid/tests/data/l_prism.obj")),
    ("mesh.stl", include_bytes!("../../crates/cylindroid/tests/data/tetrahedron.stl")),
    ("part.xml", include_bytes!("../../crates/cylindroid/tests/data/hand.xml")),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A model: loaded and used.
    Model,
    Semantics,
    Mesh,
    Numbers,
    Tasks,
    Messages,
    Solver,
    Servo,
}

/// A target.
#[derive(Debug)]
pub(crate) struct Target {
    kind: Kind,
    /// Of the file that is read.
    extension: &'static str,
}

static TARGETS: [(&str, Target); 15] = [
    ("urdf", Target { kind: Kind::Model, extension: "urdf" }),
    ("mjcf", Target { kind: Kind::Model, extension: "xml" }),
    ("sdf", Target { kind: Kind::Model, extension: "sdf" }),
    ("mechanism", Target { kind: Kind::Model, extension: "toml" }),
    ("srdf", Target { kind: Kind::Semantics, extension: "srdf" }),
    ("obj", Target { kind: Kind::Mesh, extension: "obj" }),
    ("stl", Target { kind: Kind::Mesh, extension: "stl" }),
    ("dae", Target { kind: Kind::Mesh, extension: "dae" }),
    ("csv", Target { kind: Kind::Numbers, extension: "csv" }),
    ("json", Target { kind: Kind::Numbers, extension: "json" }),
    ("parquet", Target { kind: Kind::Numbers, extension: "parquet" }),
    ("tasks", Target { kind: Kind::Tasks, extension: "toml" }),
    ("messages", Target { kind: Kind::Messages, extension: "" }),
    ("solver", Target { kind: Kind::Solver, extension: "" }),
    ("servo", Target { kind: Kind::Servo, extension: "" }),
];

/// The memory of all runs.
struct World {
    folder: TempDir,
    panda: Mechanism,
}

impl World {
    fn get() -> &'static Self {
        static WORLD: OnceLock<World> = OnceLock::new();
        WORLD.get_or_init(|| {
            let folder = TempDir::new().expect("a temporary folder");
            for (name, bytes) in BESIDE {
                fs::write(folder.path().join(name), bytes).expect("a file beside the input");
            }
            Self { folder, panda: catalogue::load("panda").expect("a robot of the catalogue") }
        })
    }
}

impl Target {
    /// The one that `CYLINDROID_FUZZ_TARGET` names.
    pub(crate) fn of_environment() -> &'static Self {
        static CHOSEN: OnceLock<&Target> = OnceLock::new();
        CHOSEN.get_or_init(|| {
            let name = std::env::var("CYLINDROID_FUZZ_TARGET").unwrap_or_default();
            let found = TARGETS.iter().find(|(known, _)| *known == name);
            &found.unwrap_or_else(|| panic!("CYLINDROID_FUZZ_TARGET={name:?} is no target")).1
        })
    }

    pub(crate) fn is_text(&self) -> bool {
        !matches!(self.kind, Kind::Solver | Kind::Servo)
    }

    pub(crate) fn run(&self, data: &[u8]) {
        match self.kind {
            Kind::Model => self.read(data, |path| _ = use_of_files::model(path)),
            Kind::Semantics => {
                let panda = &World::get().panda;
                self.read(data, |path| _ = use_of_files::semantics(path, panda));
            }
            Kind::Mesh => self.read(data, |path| _ = use_of_files::mesh(path)),
            Kind::Numbers => self.read(data, cylindroid_cli::fuzzing::numbers),
            Kind::Tasks => self.read(data, cylindroid_cli::fuzzing::tasks),
            Kind::Messages => cylindroid_cli::fuzzing::messages(data),
            Kind::Solver => cylindroid::fuzzing::solver(data),
            Kind::Servo => rounds::check(data),
        }
    }

    /// Gives the bytes as a file.
    fn read(&self, data: &[u8], read: impl Fn(&Path)) {
        let path = World::get().folder.path().join("fed").with_extension(self.extension);
        fs::write(&path, data).expect("a temporary file");
        read(&path);
    }
}
