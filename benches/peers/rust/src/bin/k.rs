//! The crate `k`: kinematics of a serial chain.

use std::hint::black_box;

use peers::{BLOCK, Result, serve, single, write};

fn main() -> Result<()> {
    serve(
        |robot| {
            let chain = k::Chain::<f64>::from_urdf_file(&robot.urdf)?;
            let tip = chain.find_link("tip0").ok_or("no tip")?.clone();
            Ok(k::SerialChain::from_end(&tip))
        },
        |command, robot, chain| match command.task {
            "check" => {
                let mut out = Vec::new();
                for i in 0..BLOCK {
                    chain.set_joint_positions_unchecked(robot.configuration(i));
                    let j = k::jacobian(chain);
                    let pose = chain.end_transform();
                    let r = pose.rotation.to_rotation_matrix();
                    out.extend(r.matrix().transpose().iter());
                    out.extend(pose.translation.vector.iter());
                    out.extend(j.transpose().iter());
                }
                write(command.path, &out)
            }
            // Its Jacobian runs forward kinematics.
            "single" => Ok(single(robot, command.number(0)?, |q| {
                chain.set_joint_positions_unchecked(q);
                black_box(k::jacobian(chain));
            })),
            other => Err(format!("no task {other}").into()),
        },
    )
}
