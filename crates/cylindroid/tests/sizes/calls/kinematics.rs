//! Public functions of the module.

use super::prelude::*;

calls! {
    kinematics::Chain::coordinates;
    kinematics::Chain::hessian_into = |c: &'static Chain, r: ReferenceFrame| { let mut out = vec![Matrix::zeros(6, c.n()); c.n()]; c.hessian_into(r, &mut out); out };
    kinematics::Chain::jacobian_into = |c: &'static Chain, r: ReferenceFrame| { let mut out = Matrix::zeros(6, c.n()); c.jacobian_into(r, &mut out); out };
    kinematics::Chain::n;
    kinematics::Chain::new = |m: &'static Mechanism, of: EndEffector| Chain::new(m, of);
    kinematics::Chain::pose;
    kinematics::Chain::q;
    kinematics::Chain::set = |c: &'static mut Chain, q: &'static [f64]| (q.len() >= c.q().len()).then(|| c.set(q));
    kinematics::KinematicsBatch::jacobians;
    kinematics::KinematicsBatch::jacobians_into;
    kinematics::KinematicsBatch::n;
    kinematics::KinematicsBatch::new = |m: &'static Mechanism, of: EndEffector| KinematicsBatch::new(m, of);
    kinematics::KinematicsBatch::poses;
    kinematics::KinematicsBatch::poses_and_jacobians_into;
    kinematics::KinematicsBatch::poses_into;
    kinematics::MassMatrix::center_of_mass;
    kinematics::MassMatrix::evaluate;
    kinematics::MassMatrix::new;
    kinematics::ReferenceFrame::name;
    kinematics::State::analytical_jacobian = |s: &'static State, of: EndEffector, rates: OrientationRates| s.analytical_jacobian(of, rates);
    kinematics::State::contact_points;
    kinematics::State::hessian = |s: &'static State, of: EndEffector, r: ReferenceFrame| s.hessian(of, r);
    kinematics::State::jacobian = |s: &'static State, of: EndEffector, r: ReferenceFrame| s.jacobian(of, r);
    kinematics::State::jacobian_dot = |s: &'static State, rates: &'static [f64], of: EndEffector, r: ReferenceFrame| s.jacobian_dot(rates, of, r);
    kinematics::State::jacobian_into = |s: &'static State, of: EndEffector, r: ReferenceFrame| { let mut out = Matrix::zeros(6, s.mechanism().n()); s.jacobian_into(of, r, &mut out).map(|()| out) };
    kinematics::State::joint_axes;
    kinematics::State::joint_screws;
    kinematics::State::joint_twists_into = |s: &'static State| { let mut out = Matrix::zeros(6, s.mechanism().n()); s.joint_twists_into(&mut out).map(|()| out) };
    kinematics::State::loop_joint_axes;
    kinematics::State::loop_screws;
    kinematics::State::mass_matrix;
    kinematics::State::mechanism;
    kinematics::State::pose = |s: &'static State, of: EndEffector| s.pose(of);
    kinematics::State::q;
    kinematics::State::relative_jacobian = |s: &'static State, of: EndEffector, base: EndEffector| s.relative_jacobian(of, base);
    kinematics::State::set;
    kinematics::State::twist = |s: &'static State, rates: &'static [f64], of: EndEffector, r: ReferenceFrame| s.twist(rates, of, r);
    kinematics::velocity_conversion;
    model::Mechanism::check_masses;
    model::Mechanism::massless_bodies;
    model::Mechanism::state;
}
