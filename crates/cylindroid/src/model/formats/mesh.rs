//! Finds mesh files: `package://`, `model://`, `file://` and plain paths.
//!
//! `package://NAME/rest` is resolved against, in this order: every parent folder of the URDF that
//! is called NAME or contains a folder NAME, the entries of `ROS_PACKAGE_PATH`, and the `share`
//! folders of the entries of `AMENT_PREFIX_PATH`.

use std::path::{Path, PathBuf};

/// Search paths of the packages of a model.
#[derive(Debug)]
pub(super) struct Packages {
    /// Folder of the model file.
    folder: PathBuf,
    /// Folders that are packages or contain them.
    roots: Vec<PathBuf>,
}

impl Packages {
    pub(super) fn of(model: &Path) -> Self {
        let path = std::path::absolute(model).unwrap_or_else(|_| model.to_owned());
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        let mut roots: Vec<PathBuf> = folder.ancestors().map(Path::to_owned).collect();
        if let Some(paths) = std::env::var_os("ROS_PACKAGE_PATH") {
            roots.extend(std::env::split_paths(&paths));
        }
        if let Some(paths) = std::env::var_os("AMENT_PREFIX_PATH") {
            roots.extend(std::env::split_paths(&paths).map(|p| p.join("share")));
        }
        Self { folder, roots }
    }

    /// The file of a mesh, if it exists.
    pub(super) fn find(&self, uri: &str) -> Option<PathBuf> {
        let uri = uri.trim();
        let package = uri.strip_prefix("package://").or_else(|| uri.strip_prefix("model://"));
        if let Some(rest) = package {
            let (name, rest) = rest.trim_start_matches('/').split_once('/')?;
            let rest = rest.trim_start_matches('/');
            return self.roots.iter().find_map(|root| {
                let own = root.file_name().is_some_and(|f| f == name);
                existing(own.then(|| root.join(rest)))
                    .or_else(|| existing(Some(root.join(name).join(rest))))
            });
        }
        let path = uri.strip_prefix("file://").unwrap_or(uri);
        existing((!path.is_empty()).then(|| self.folder.join(path)))
    }
}

fn existing(path: Option<PathBuf>) -> Option<PathBuf> {
    path.filter(|p| p.is_file())
}
