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

/// Lengths that are all below the least one are refused in every format; a rounding is not.
#[test]
fn mechanisms_without_a_size_are_refused() {
    let urdf = "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='continuous'>\
                <origin xyz='# 0 0'/><parent link='a'/><child link='b'/></joint>@</robot>";
    let of_urdf = "<link name='c'/><joint name='k' type='fixed'><origin xyz='0 0 0.1'/>\
                   <parent link='b'/><child link='c'/></joint>";
    let sdf = "<sdf version='1.9'><model name='r'><link name='a'/><link name='b'/>@\
               <joint name='j' type='revolute'><pose relative_to='a'># 0 0 0 0 0</pose>\
               <parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>";
    let of_sdf = "<frame name='f' attached_to='b'><pose>0 0 0.1 0 0 0</pose></frame>";
    let mjcf = "<mujoco model='r'><worldbody><body name='b' pos='# 0 0'><joint name='j'/>@</body>\
                </worldbody></mujoco>";
    let of_mjcf = "<site name='s' pos='0 0 0.1'/>";
    let toml = "name = 'r'\n[[joint]]\nname = 'j'\ntype = 'revolute'\nbetween = ['ground', 'b']\n\
                origin = [#, 0, 0]\naxis = [0, 0, 1]\n@";
    let of_toml = "[[frame]]\nname = 'f'\nlink = 'b'\nxyz = [0, 0, 0.1]\n";
    type Reader = fn(&str) -> Result<Mechanism>;
    let all: [(&str, &str, Reader); 4] = [
        (urdf, of_urdf, read_urdf),
        (sdf, of_sdf, read_sdf),
        (mjcf, of_mjcf, read_mjcf),
        (toml, of_toml, read_toml),
    ];
    for (text, more, read) in all {
        for (length, accepted) in [("1e-9", true), ("0", true), ("1e-13", false), ("1e-30", false)]
        {
            let tiny = text.replace('#', length);
            match read(&tiny.replace('@', "")) {
                Ok(_) => assert!(accepted, "{tiny}"),
                Err(error) => {
                    let told = format!("longest length is {length} m");
                    let message = error.to_string();
                    assert!(!accepted && message.contains(&told), "{tiny}: {message}");
                }
            }
            let with_others = read(&tiny.replace('@', more));
            assert!(with_others.is_ok(), "{tiny}: {}", with_others.unwrap_err());
        }
    }
}
