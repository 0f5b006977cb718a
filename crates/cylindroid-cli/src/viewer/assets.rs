//! Files served: the page embedded in the binary, and meshes in the folders of the model.
//!
//! Mesh files refer to textures by relative paths, so whole folders must be accessible. Only meshes
//! and images are served, and nothing outside the folders that is reached through a link or `..`.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use cylindroid::Mechanism;
use cylindroid::model::Geometry;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

// `Page`, whose folder build.rs knows.
include!(concat!(env!("OUT_DIR"), "/page.rs"));

/// True if the page is in the binary.
pub(crate) fn page_is_built() -> bool {
    Page::get("index.html").is_some()
}

/// Extensions of meshes, and of the files that meshes refer to.
const MESHES: [&str; 3] = ["stl", "dae", "obj"];
const COMPANIONS: [&str; 10] =
    ["mtl", "png", "jpg", "jpeg", "gif", "bmp", "tga", "tif", "tiff", "webp"];

const PATH: &AsciiSet =
    &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_').remove(b'~');

/// The folders of the model with links resolved, and the URLs of its meshes.
#[derive(Debug, Default)]
pub(super) struct Folders {
    open: Vec<PathBuf>,
    /// The folder of all URLs: empty, or a slash and the token.
    root: String,
    /// URLs of meshes that are newer than this contain the time of their change, so that a page
    /// that has the old mesh asks for the new one.
    since: Option<SystemTime>,
}

/// A mesh as the page gets it.
#[derive(Debug, PartialEq)]
pub(super) struct Served {
    pub(super) url: Option<String>,
    /// `stl`, `dae` or `obj`.
    pub(super) format: Option<&'static str>,
    /// Why it has no URL.
    pub(super) problem: Option<String>,
}

impl Folders {
    /// Of the model in this file (a catalogue model has none), and further folders that the user
    /// allows.
    pub(super) fn of(
        mechanism: &Mechanism,
        model: &str,
        more: &[PathBuf],
    ) -> cylindroid::Result<Self> {
        let mut open = BTreeSet::new();
        if mechanism.report().format != "catalogue"
            && let Ok(file) = Path::new(model).canonicalize()
            && let Some(folder) = file.parent()
        {
            let package = folder.ancestors().find(|f| f.join("package.xml").is_file());
            open.insert(package.unwrap_or(folder).to_owned());
        }
        for (uri, path) in meshes(mechanism) {
            open.extend(path.and_then(|path| package(uri, path)));
        }
        for folder in more {
            let found = folder.canonicalize().map_err(|error| cylindroid::Error::Io {
                path: folder.clone(),
                action: "read",
                message: error.to_string(),
            })?;
            open.insert(found);
        }
        // The root of the file system is never served.
        open.retain(|folder| folder.parent().is_some());
        Ok(Self { open: open.into_iter().collect(), ..Self::default() })
    }

    /// The same, with URLs below `/<token>`.
    pub(super) fn behind(self, token: &str) -> Self {
        Self { root: format!("/{token}"), ..self }
    }

    /// The same, with URLs below a folder of those of a server.
    pub(super) fn below(self, of_server: &Self, folder: &str) -> Self {
        Self { root: format!("{}/{folder}", of_server.root), ..self }
    }

    /// The same, for pages that may have meshes of before this time.
    pub(super) fn since(self, time: SystemTime) -> Self {
        Self { since: Some(time), ..self }
    }

    /// URL and format of a mesh, or the reason why it is not served.
    pub(super) fn served(&self, uri: &str, path: Option<&Path>) -> Served {
        let refused = |problem: String| Served { url: None, format: None, problem: Some(problem) };
        let Some(path) = path else {
            return refused(format!("The file of mesh '{uri}' was not found."));
        };
        let Some(format) = MESHES.into_iter().find(|m| extension(path).as_deref() == Some(m))
        else {
            let kinds = MESHES.join(", ");
            return refused(format!(
                "Mesh '{uri}' has an unsupported format (supported: {kinds})."
            ));
        };
        let found = path.canonicalize().ok().and_then(|file| {
            self.open.iter().enumerate().find_map(|(i, folder)| {
                let inside = file.strip_prefix(folder).ok()?.to_str()?;
                let inside = inside.replace(std::path::MAIN_SEPARATOR, "/");
                let (root, version) = (&self.root, self.version(&file));
                Some(format!("{root}/mesh/{i}/{}{version}", utf8_percent_encode(&inside, PATH)))
            })
        });
        match found {
            Some(url) => Served { url: Some(url), format: Some(format), problem: None },
            None => refused(format!(
                "Mesh '{uri}' lies outside of the model's own folders; open its folder with \
                 --meshes."
            )),
        }
    }

    /// The query of a mesh that has changed; empty for others.
    fn version(&self, file: &Path) -> String {
        let changed = fs::metadata(file).and_then(|data| data.modified()).ok();
        let changed = changed.filter(|time| self.since.is_some_and(|since| *time > since));
        let time = changed.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        time.map_or_else(String::new, |time| format!("?changed={}", time.as_millis()))
    }

    /// The file at `/mesh/<folder>/<path>`, if it may be served. `path` is decoded.
    pub(super) fn file(&self, folder: usize, path: &str) -> Option<PathBuf> {
        let folder = self.open.get(folder)?;
        let relative = Path::new(path);
        // Hidden files and folders are nobody's meshes.
        let is_plain = |c: Component<'_>| match c {
            Component::Normal(name) => !name.as_encoded_bytes().starts_with(b"."),
            _ => false,
        };
        let plain = relative.components().all(is_plain);
        if !plain || path.contains(['\\', '\0']) || !is_given_out(relative) {
            return None;
        }
        let file = folder.join(relative).canonicalize().ok()?;
        // The target of a link must also have an allowed extension.
        (file.starts_with(folder) && file.is_file() && is_given_out(&file)).then_some(file)
    }
}

fn is_given_out(path: &Path) -> bool {
    extension(path)
        .is_some_and(|e| MESHES.contains(&e.as_str()) || COMPANIONS.contains(&e.as_str()))
}

fn extension(path: &Path) -> Option<String> {
    path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase)
}

/// The names of all meshes, of visual and of collision shapes, and the files that were found.
fn meshes(mechanism: &Mechanism) -> impl Iterator<Item = (&str, Option<&Path>)> {
    let shapes = mechanism.links().iter().flat_map(|link| {
        let collisions = link.collisions.iter().map(|shape| &shape.geometry);
        link.visuals.iter().map(|shape| &shape.geometry).chain(collisions)
    });
    shapes.filter_map(|geometry| match geometry {
        Geometry::Mesh { uri, path, .. } => Some((uri.as_str(), path.as_deref())),
        _ => None,
    })
}

/// The files of all meshes that were found.
pub(super) fn mesh_files(mechanism: &Mechanism) -> impl Iterator<Item = &Path> {
    meshes(mechanism).filter_map(|(_, path)| path)
}

/// The folder of the package that `package://NAME/rest` was found in.
fn package(uri: &str, path: &Path) -> Option<PathBuf> {
    let uri = uri.trim();
    let rest = uri.strip_prefix("package://").or_else(|| uri.strip_prefix("model://"))?;
    let rest = rest.trim_start_matches('/').split_once('/')?.1.trim_start_matches('/');
    let rest = Path::new(rest);
    if !rest.components().all(|c| matches!(c, Component::Normal(_))) {
        return None;
    }
    let depth = rest.components().count();
    path.ancestors().nth(depth)?.canonicalize().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_meshes_and_images_inside() {
        let all = tempfile::tempdir().unwrap();
        let folder = all.path().join("robot");
        fs::create_dir_all(folder.join("meshes")).unwrap();
        fs::create_dir_all(folder.join(".git")).unwrap();
        for name in [
            "robot/meshes/a b.stl",
            "robot/meshes/t.PNG",
            "robot/key.pem",
            "out.stl",
            "robot/.git/a.png",
            "robot/meshes/.hidden.png",
        ] {
            fs::write(all.path().join(name), name).unwrap();
        }
        let folder = folder.canonicalize().unwrap();
        let open = Folders { open: vec![folder.clone()], ..Folders::default() };
        assert!(open.file(0, "meshes/a b.stl").is_some() && open.file(0, "meshes/t.PNG").is_some());
        for path in [
            "../out.stl",
            "meshes/../../out.stl",
            "/etc/passwd",
            "key.pem",
            "meshes",
            "",
            "./meshes/a b.stl",
            "meshes/none.stl",
            ".git/a.png",
            "meshes/.hidden.png",
            "meshes\\..\\..\\out.stl",
            "meshes/a b.stl\0",
        ] {
            assert_eq!(open.file(0, path), None, "{path:?}");
        }
        assert_eq!(open.file(1, "meshes/a b.stl"), None);
        #[cfg(unix)]
        {
            use std::os::unix::fs::symlink;
            symlink(all.path().join("out.stl"), folder.join("link.stl")).unwrap();
            symlink(folder.join("key.pem"), folder.join("key.stl")).unwrap();
            symlink(all.path(), folder.join("up")).unwrap();
            symlink(folder.join("meshes/a b.stl"), folder.join("inside.stl")).unwrap();
            assert_eq!(open.file(0, "link.stl"), None);
            assert_eq!(open.file(0, "key.stl"), None);
            assert_eq!(open.file(0, "up/out.stl"), None);
            assert!(open.file(0, "inside.stl").is_some());
        }
        let served = open.served("a", Some(&folder.join("meshes/a b.stl")));
        assert_eq!(served.url.as_deref(), Some("/mesh/0/meshes/a%20b.stl"));
        assert!(open.served("b", Some(&all.path().join("out.stl"))).problem.is_some());
        assert!(open.served("c", None).url.is_none());
        assert!(open.served("d", Some(&folder.join("key.pem"))).url.is_none());
        let later = open.since(UNIX_EPOCH);
        let url = later.served("a", Some(&folder.join("meshes/a b.stl"))).url.unwrap();
        assert!(url.starts_with("/mesh/0/meshes/a%20b.stl?changed="), "{url}");
        let now = later.since(SystemTime::now() + std::time::Duration::from_secs(60));
        assert!(!now.served("a", Some(&folder.join("meshes/a b.stl"))).url.unwrap().contains('?'));
    }

    /// The package of a mesh that only collision shapes have.
    #[test]
    fn packages_of_collision_meshes_are_open() {
        let all = tempfile::tempdir().unwrap();
        for folder in ["robot", "bodies/meshes"] {
            fs::create_dir_all(all.path().join(folder)).unwrap();
        }
        fs::write(all.path().join("bodies/package.xml"), "<package/>").unwrap();
        fs::write(all.path().join("bodies/meshes/a.stl"), "").unwrap();
        let model = all.path().join("robot/robot.urdf");
        let text = r#"<robot name="r"><link name="base"><collision><geometry>
            <mesh filename="package://bodies/meshes/a.stl"/></geometry></collision></link>
            <link name="tool"/><joint name="j" type="continuous"><parent link="base"/>
            <child link="tool"/><axis xyz="0 0 1"/></joint></robot>"#;
        fs::write(&model, text).unwrap();
        let model = model.to_str().unwrap();
        let robot = cylindroid::load(model).unwrap();
        let folders = Folders::of(&robot, model, &[]).unwrap();
        let Geometry::Mesh { uri, path, .. } = &robot.links()[0].collisions[0].geometry else {
            panic!("{robot:?}");
        };
        let served = folders.served(uri, path.as_deref());
        assert_eq!(served.problem, None);
        assert!(served.url.unwrap().ends_with("/meshes/a.stl"));
    }

    #[test]
    fn packages_are_found_from_their_names() {
        let all = tempfile::tempdir().unwrap();
        let file = all.path().join("arm/meshes/visual/hand.dae");
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, "").unwrap();
        let arm = all.path().join("arm").canonicalize().unwrap();
        assert_eq!(package("package://arm/meshes/visual/hand.dae", &file), Some(arm.clone()));
        assert_eq!(package("package://arm//meshes/visual/hand.dae", &file), Some(arm));
        assert_eq!(package("package://arm/x/../meshes/visual/hand.dae", &file), None);
        assert_eq!(package("meshes/visual/hand.dae", &file), None);
    }
}
