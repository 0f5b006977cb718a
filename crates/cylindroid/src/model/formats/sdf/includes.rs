//! The models that an SDF file includes: `<include>` with `model://NAME`, a path or a folder.
//!
//! Formula  a relative path is looked up in the folder of the including file; `model://NAME` in its
//!          folders upwards, then in GZ_SIM_RESOURCE_PATH, SDF_PATH and GAZEBO_MODEL_PATH. In a
//!          folder, `model.config` names the file, otherwise it is `model.sdf`
//! Valid    files of this computer; what is not found is noted and missing
//! Source   sdformat.org, specification of include; gazebosim.org, model.config
//! Checked  tests/formats/sdf.rs::includes_*

use std::path::{Path, PathBuf};

use roxmltree::Node;

use crate::model::formats::span::Source;
use crate::model::formats::{text_file, xml};

pub(super) const FORMAT: &str = "SDF";

const PATHS: [&str; 4] =
    ["GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH", "GAZEBO_MODEL_PATH"];

/// The file that an `<include>` names; `None` if there is no such file.
pub(super) fn find(source: &Source<'_>, include: Node<'_, '_>) -> Option<PathBuf> {
    let uri = include.children().find(|c| c.has_tag_name("uri"))?;
    of_uri(source.path, uri.text()?.trim())
}

/// The SDF file of a URI.
fn of_uri(from: &Path, uri: &str) -> Option<PathBuf> {
    let from = std::path::absolute(from).ok()?;
    let folder = from.parent()?;
    let roots: Vec<PathBuf> = match uri.strip_prefix("model://") {
        Some(_) => {
            let paths = PATHS.iter().filter_map(std::env::var_os);
            let others = paths.flat_map(|p| std::env::split_paths(&p).collect::<Vec<_>>());
            folder.ancestors().map(Path::to_owned).chain(others).collect()
        }
        None => vec![folder.to_owned()],
    };
    let rest = uri.strip_prefix("model://").or_else(|| uri.strip_prefix("file://")).unwrap_or(uri);
    if rest.is_empty() {
        return None;
    }
    roots.iter().find_map(|root| {
        let path = root.join(rest);
        if path.is_file() {
            return Some(path);
        }
        path.is_dir().then(|| in_folder(&path)).filter(|file| file.is_file())
    })
}

/// The file that `model.config` names last, for the newest version, otherwise `model.sdf`.
fn in_folder(folder: &Path) -> PathBuf {
    let config = text_file::read(&folder.join("model.config")).ok();
    let named = config.and_then(|config| {
        let (path, text) = (folder.join("model.config"), config.text);
        let source = Source { format: FORMAT, path: &path, text: &text };
        let document = xml::document(&source).ok()?;
        let mut files = document.descendants().filter(|n| n.has_tag_name("sdf"));
        files.next_back()?.text().map(|t| t.trim().to_owned())
    });
    folder.join(named.unwrap_or_else(|| "model.sdf".to_owned()))
}
