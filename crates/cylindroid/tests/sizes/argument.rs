//! Arguments of plain types: numbers, texts, slices, options.

use std::fmt::Debug;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::{Path, PathBuf};

use cylindroid::collision::NearPair;
use cylindroid::control::JointSample;
use cylindroid::model::Geometry;
use cylindroid::{Matrix, Pose};

use crate::world::World;

/// Something that is drawn from the world; none if it has no such value.
pub(crate) trait Argument: Debug + Sized + 'static {
    fn draw(world: &mut World) -> Option<Self>;
}

macro_rules! plain {
    ($($type:ty: $values:expr;)*) => {
        $(impl Argument for $type {
            fn draw(world: &mut World) -> Option<Self> {
                Some(world.of(&$values))
            }
        })*
    };
}
plain! {
    f64: [0.0, 1.0, -1.0, 0.5];
    usize: [0, 1, 1, 2];
    u64: [0, 1];
    u32: [0, 1];
    i64: [0, 1];
    bool: [false, true];
    &'static str: ["", "j", "a", "b", "q1", "p0", "c", "tcp", "x", "revolute", "size", "five-bar"];
    String: ["", "j", "a", "size"].map(str::to_owned);
    NonZeroUsize: [NonZeroUsize::MIN];
    Range<u64>: [0..0, 0..1, 1..1, 0..2];
    [f64; 3]: [[0.0; 3], [1.0; 3]];
    [f64; 6]: [[0.0; 6], [1.0; 6]];
    [[f64; 3]; 3]: [[[0.0; 3]; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
    [[f64; 4]; 4]: [[[0.0; 4]; 4], Pose::IDENTITY.to_matrix()];
    [[f64; 6]; 6]: [[[0.0; 6]; 6]];
    &'static [usize]: [&[][..], &[0], &[1], &[0, 1]];
    &'static [&'static str]: [&[][..], &["j"], &["q1"], &["a"], &["none"]];
    &'static [&'static [f64]]: [&[][..], &[&[]], &[&[1.0]], &[&[1.0], &[]]];
    &'static [(&'static str, f64)]: [&[][..], &[("size", 1.0)], &[("none", 0.0)]];
    &'static [(usize, f64)]: [&[][..], &[(0, 0.0)], &[(1, 0.0)]];
    &'static [bool]: [&[][..], &[true], &[false]];
}

impl Argument for &'static [f64] {
    fn draw(world: &mut World) -> Option<Self> {
        Some(Vec::draw(world)?.leak())
    }
}

impl Argument for &'static mut [f64] {
    fn draw(world: &mut World) -> Option<Self> {
        Some(Vec::draw(world)?.leak())
    }
}

/// None, one, and as many as the mechanisms of the seeds have coordinates.
impl Argument for Vec<f64> {
    fn draw(world: &mut World) -> Option<Self> {
        let size = world.of(&[0, 1, 1, 2, 3, 5, 6, 7]);
        Some(vec![world.of(&[0.0, 0.0, 1.0]); size])
    }
}

impl Argument for &'static Path {
    fn draw(world: &mut World) -> Option<Self> {
        world.one::<PathBuf>().map(PathBuf::as_path)
    }
}

impl<A: Argument> Argument for Option<A> {
    fn draw(world: &mut World) -> Option<Self> {
        if world.below(2) == 0 { Some(None) } else { Some(A::draw(world)) }
    }
}

impl Argument for (&'static Geometry, Pose) {
    fn draw(world: &mut World) -> Option<Self> {
        Some((world.one()?, *world.one()?))
    }
}

impl Argument for &'static mut [Matrix] {
    fn draw(world: &mut World) -> Option<Self> {
        let matrix: Matrix = world.one::<Matrix>()?.clone();
        Some(vec![matrix; world.below(3)].leak())
    }
}

impl Argument for &'static mut Vec<NearPair> {
    fn draw(world: &mut World) -> Option<Self> {
        Some(Box::leak(Box::new(
            (0..world.below(2)).map(|_| NearPair::draw(world)).collect::<Option<_>>()?,
        )))
    }
}

impl Argument for JointSample<'static> {
    fn draw(world: &mut World) -> Option<Self> {
        let [positions, velocities] = [(); 2].map(|()| <&mut [f64]>::draw(world));
        Some(Self { positions: positions?, velocities: velocities? })
    }
}

impl Argument for &'static [Option<cylindroid::sweep::Part>] {
    fn draw(world: &mut World) -> Option<Self> {
        Some((0..world.below(3)).map(|_| Option::draw(world)).collect::<Option<Vec<_>>>()?.leak())
    }
}
