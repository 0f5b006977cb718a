//! Public functions of the module.

use super::prelude::*;

calls! {
    inverse::Domain::contains;
    inverse::Domain::describe;
    inverse::HyperbolicSvd::polar;
    inverse::HyperbolicSvd::values;
    inverse::InverseBatch::inverses;
    inverse::InverseBatch::new;
    inverse::Method::check;
    inverse::Method::inverse;
    inverse::Method::named;
    inverse::Parameter::check;
    inverse::PolarKind::description;
    inverse::PolarKind::name;
    inverse::damped;
    inverse::hyperbolic;
    inverse::hyperbolic_into;
    inverse::hyperbolic_svd;
    inverse::hyperbolic_with;
    inverse::oblique;
    inverse::point_direction;
    inverse::selectively_damped;
    inverse::truncated;
    inverse::weighted;
}
