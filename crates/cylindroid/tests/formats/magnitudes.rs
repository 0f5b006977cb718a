//! Numbers out of range are refused in every format, with their place.

use cylindroid::{Error, Mechanism, Result};

use crate::mjcf::read_mjcf;
use crate::sdf::read_sdf;
use crate::{ARM_TOML, ARM_URDF, pointed_at, read_toml, read_urdf, refused};

fn check(text: &str, old: &str, new: &str, read: fn(&str) -> Result<Mechanism>) {
    for (size, accepted) in [("1e119", true), ("1e121", false), ("1.7e308", false)] {
        assert!(text.contains(old), "{old}");
        let text = text.replacen(old, &new.replace('#', size), 1);
        match read(&text) {
            Ok(_) => assert!(accepted, "{new} with {size}"),
            Err(Error::Model { message, .. }) if accepted => panic!("{new}: {message}"),
            result => {
                let error = refused(&text, result);
                assert!(!accepted, "{new} with {size}: {error}");
                assert!(error.message.contains("out of range"), "{error}");
                assert!(error.message.contains("1e120"), "{error}");
                assert!(pointed_at(&text, &error).contains(size), "{error}");
            }
        }
    }
}

#[test]
fn numbers_out_of_range_are_refused_with_their_place() {
    check(ARM_URDF, "xyz=\"0 0 0.1\"", "xyz=\"0 0 #\"", read_urdf);
    check(ARM_URDF, "<mass value=\"2\"/>", "<mass value=\"#\"/>", read_urdf);
    check(ARM_TOML, "upper = 3.0", "upper = #", read_toml);
    check(ARM_TOML, "velocity = 2", "velocity = #", read_toml);
    check(ARM_TOML, "origin = [0.0, 0.0, 0.3]", "origin = [0.0, #, 0.3]", read_toml);
    check(ARM_TOML, "pitch = 0.01", "pitch = #", read_toml);
    let sdf = "<sdf version='1.9'><model name='m'><link name='a'/><link name='b'/>\
               <joint name='j' type='prismatic'><pose>0 0 1 0 0 0</pose><parent>a</parent>\
               <child>b</child><axis><xyz>1 0 0</xyz></axis></joint></model></sdf>";
    check(sdf, "<pose>0 0 1 0 0 0", "<pose>0 0 # 0 0 0", read_sdf);
    let mjcf = "<mujoco><worldbody><body name='b' pos='0 0 1'><joint name='j' type='slide'/>\
                <geom size='1'/></body></worldbody></mujoco>";
    check(mjcf, "pos='0 0 1'", "pos='0 0 #'", read_mjcf);
}

/// In SDF a limit of 1e16 or more stands for none.
#[test]
fn large_limits_of_sdf_are_none() {
    let text = "<sdf version='1.9'><model name='m'><link name='a'/><link name='b'/>\
                <joint name='j' type='revolute'><parent>a</parent><child>b</child><axis>\
                <xyz>0 0 1</xyz><limit><lower>-1.79769e+308</lower><upper>1.79769e+308</upper>\
                </limit></axis></joint></model></sdf>";
    let limits = read_sdf(text).unwrap().coordinates()[0].limits;
    assert_eq!((limits.lower, limits.upper), (f64::NEG_INFINITY, f64::INFINITY));
}
