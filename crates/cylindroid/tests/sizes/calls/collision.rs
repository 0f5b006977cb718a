//! Public functions of the module.

use super::prelude::*;

calls! {
    collision::CollisionModel::add_obstacle;
    collision::CollisionModel::bodies;
    collision::CollisionModel::gradient = |c: &'static CollisionModel, s: &'static State, near: &'static NearPair| { same(c, s, near).then(|| c.gradient(s, near)) };
    collision::CollisionModel::gradient_into = |c: &'static CollisionModel, s: &'static State, near: &'static NearPair| { let mut row = vec![0.0; s.mechanism().n()]; same(c, s, near).then(|| c.gradient_into(s, near, &mut row)); row };
    collision::CollisionModel::ignored;
    collision::CollisionModel::mechanism;
    collision::CollisionModel::move_obstacle;
    collision::CollisionModel::names = |c: &'static CollisionModel, pair: usize| (pair < c.pairs().len()).then(|| c.names(pair));
    collision::CollisionModel::near;
    collision::CollisionModel::new;
    collision::CollisionModel::obstacles = |c: &'static CollisionModel| c.obstacles().collect::<Vec<_>>();
    collision::CollisionModel::pairs;
    collision::CollisionModel::remove_obstacle;
    collision::MeshShape::name;
    collision::Separation::reversed;
    collision::distance;
}
