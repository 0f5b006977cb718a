//! The crate `dynibo`: kinematics of a link, by one call for the pose and one for the Jacobian.

use std::hint::black_box;

use peers::{BLOCK, Result, serve, single, write};

fn main() -> Result<()> {
    serve(
        |robot| {
            let made = dynibo::Robot::from_urdf(&robot.urdf)?;
            let tip = made.link_id("tip0")?;
            Ok((made, tip, vec![0.0; 6 * robot.n()]))
        },
        |command, robot, (arm, tip, j)| match command.task {
            "check" => {
                let mut out = Vec::new();
                for i in 0..BLOCK {
                    let pose = arm.forward_kinematics(robot.configuration(i), *tip)?;
                    arm.jacobian(robot.configuration(i), *tip, j)?;
                    let r = pose.rotation.to_rotation_matrix();
                    out.extend(r.matrix().transpose().iter());
                    out.extend(pose.translation.vector.iter());
                    // Columns, turns first.
                    for row in [3, 4, 5, 0, 1, 2] {
                        out.extend((0..robot.n()).map(|c| j[6 * c + row]));
                    }
                }
                write(command.path, &out)
            }
            "single" => Ok(single(robot, command.number(0)?, |q| {
                let _ = black_box(arm.forward_kinematics(q, *tip));
                let _ = black_box(arm.jacobian(q, *tip, j));
            })),
            other => Err(format!("no task {other}").into()),
        },
    )
}
