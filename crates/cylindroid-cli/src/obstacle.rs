//! Obstacles as arguments: `ball=sphere:0.1@0.5,0,0.4`.

use std::path::PathBuf;
use std::str::FromStr;

use cylindroid::model::Geometry;
use cylindroid::spatial::Rpy;
use cylindroid::{Pose, Vec3};

use crate::values::List;

/// An obstacle, its name, shape and pose in the world.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ObstacleArg {
    pub(crate) name: String,
    pub(crate) shape: Geometry,
    pub(crate) world_from_shape: Pose,
}

impl FromStr for ObstacleArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let help = "write NAME=SHAPE@X,Y,Z, for example ball=sphere:0.1@0.5,0,0.4";
        let (name, rest) = text.split_once('=').ok_or(help)?;
        let (shape, pose) = rest.rsplit_once('@').ok_or(help)?;
        if name.trim().is_empty() {
            return Err(help.to_owned());
        }
        Ok(Self {
            name: name.trim().to_owned(),
            shape: geometry(shape)?,
            world_from_shape: at(pose)?,
        })
    }
}

fn geometry(text: &str) -> Result<Geometry, String> {
    let (kind, sizes) = text.split_once(':').unwrap_or((text, ""));
    if kind == "mesh" {
        let scale = Vec3::new(1.0, 1.0, 1.0);
        return Ok(Geometry::Mesh {
            uri: sizes.to_owned(),
            path: Some(PathBuf::from(sizes)),
            scale,
        });
    }
    let List(sizes) = if sizes.is_empty() { List(Vec::new()) } else { sizes.parse()? };
    let vector = |x: &f64, y: &f64, z: &f64| Vec3::new(*x, *y, *z);
    Ok(match (kind, sizes.as_slice()) {
        ("sphere", [radius]) => Geometry::Sphere { radius: *radius },
        ("capsule", [radius, length]) => Geometry::Capsule { radius: *radius, length: *length },
        ("cylinder", [radius, length]) => Geometry::Cylinder { radius: *radius, length: *length },
        ("box", [x, y, z]) => Geometry::Box { size: vector(x, y, z) },
        ("ellipsoid", [x, y, z]) => Geometry::Ellipsoid { radii: vector(x, y, z) },
        ("half_space", []) => Geometry::HalfSpace,
        _ => {
            return Err(format!(
                "'{text}' is no shape: sphere:RADIUS, capsule:RADIUS,LENGTH, \
                 cylinder:RADIUS,LENGTH, box:X,Y,Z, ellipsoid:X,Y,Z, half_space or mesh:FILE"
            ));
        }
    })
}

fn at(text: &str) -> Result<Pose, String> {
    let List(numbers) = text.parse()?;
    let (translation, [roll, pitch, yaw]) = match numbers[..] {
        [x, y, z] => (Vec3::new(x, y, z), [0.0; 3]),
        [x, y, z, roll, pitch, yaw] => (Vec3::new(x, y, z), [roll, pitch, yaw]),
        _ => {
            let given = numbers.len();
            return Err(format!("{given} numbers given for the pose, three or six expected"));
        }
    };
    Ok(Pose { rotation: Rpy { roll, pitch, yaw }.rotation(), translation })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obstacles_have_name_shape_and_pose() {
        let ball: ObstacleArg = "ball=sphere:0.1@0.5,0,-0.4".parse().unwrap();
        assert_eq!((ball.name.as_str(), ball.shape), ("ball", Geometry::Sphere { radius: 0.1 }));
        assert_eq!(ball.world_from_shape, Pose::from_translation(Vec3::new(0.5, 0.0, -0.4)));
        let table: ObstacleArg = "a table=box:1,2,0.1@0,0,0,0,0,1.5".parse().unwrap();
        assert_eq!(table.shape, Geometry::Box { size: Vec3::new(1.0, 2.0, 0.1) });
        assert!((table.world_from_shape.rotation.log() - Vec3::Z * 1.5).norm() < 1e-15);
        let mesh: ObstacleArg = "m=mesh:a@b.stl@0,0,0".parse().unwrap();
        assert!(matches!(mesh.shape, Geometry::Mesh { uri, .. } if uri == "a@b.stl"));
        assert!("floor=half_space@0,0,0".parse::<ObstacleArg>().is_ok());
        for (broken, word) in [
            ("ball", "NAME"),
            ("=sphere:1@0,0,0", "NAME"),
            ("b=sphere:1", "NAME"),
            ("b=sphere:1,2@0,0,0", "RADIUS"),
            ("b=sphere:x@0,0,0", "number"),
            ("b=sphere:1@0,0", "2 numbers"),
        ] {
            let error = broken.parse::<ObstacleArg>().unwrap_err();
            assert!(error.contains(word), "{broken}: {error}");
        }
    }
}
