//! Assemblies and their modes: steps, errors, coordinates at limits, what random restarts find.

use cylindroid::Mechanism;
use cylindroid::closure::{
    Assembly, AssemblyModes, ModeOptions, assemble, assembly_modes, recover_passive,
};

use super::{
    near_home, record_closure_error, record_error, some_chain, some_of, weighted, whole_joints,
};
use crate::record::{Record, check};
use crate::robots::{Random, of_catalogue};

fn record_assembly(record: &mut Record, found: &Assembly) {
    record.word(&(found.closed, &found.at_limit));
    record.number(weighted(&found.q));
    if !found.closed {
        record_closure_error(record, found.closure_error);
    }
    // The last of them are of rounding.
    record.word(&(found.steps / 4));
    record.word(&found.steps);
}

#[test]
fn assemblies() {
    check("position_assemblies", 150, |random, record| {
        let mechanism = some_chain(random);
        let guess = near_home(random, &mechanism, 0.5);
        let prescribed = if random.once_in(2) {
            Vec::new()
        } else {
            let some = some_of(random, mechanism.n(), 5);
            whole_joints(random, &mechanism, some)
        };
        match assemble(&mechanism, &guess, &prescribed) {
            Ok(found) => record_assembly(record, &found),
            Err(error) => record_error(record, &error),
        }
    });
}

/// Guesses within rounding of an assembly, and beyond limits.
#[test]
fn assemblies_from_assemblies() {
    check("position_assemblies_again", 60, |random, record| {
        let mechanism = some_chain(random);
        let mut guess = mechanism.home().to_vec();
        if random.once_in(2) {
            let size = random.power(-14.0, -8.0);
            let at = random.below(guess.len());
            guess[at] += size * mechanism.reach();
        }
        match assemble(&mechanism, &guess, &[]) {
            Ok(found) => record_assembly(record, &found),
            Err(error) => record_error(record, &error),
        }
    });
}

#[test]
fn passive_coordinates() {
    check("position_passive_coordinates", 60, |random, record| {
        let mechanism = some_chain(random);
        let guess = near_home(random, &mechanism, 0.0);
        match recover_passive(&mechanism, &guess) {
            Ok(found) => record_assembly(record, &found),
            Err(error) => record_error(record, &error),
        }
    });
}

fn record_modes(record: &mut Record, found: &AssemblyModes) {
    record.word(&(found.starts, found.closed, found.modes.len(), found.self_motion_dof()));
    record.number(found.unseen_probability());
    record.number(weighted(&found.first.q));
    for mode in found.modes.iter().take(5) {
        record.word(&(mode.found, mode.self_motion_dof));
        record.number(mode.distance);
        record.number(weighted(&mode.assembly.q));
        record.word(&mode.assembly.at_limit);
    }
    record.word(&(found.first.steps / 4));
    record.word(&found.first.steps);
}

fn modes_of(random: &mut Random<'_>, record: &mut Record, mechanism: &Mechanism, starts: usize) {
    let guess = if random.once_in(2) {
        mechanism.home().to_vec()
    } else {
        near_home(random, mechanism, 0.5)
    };
    let prescribed: Vec<usize> = match random.below(3) {
        0 => Vec::new(),
        1 => mechanism.actuated().collect(),
        _ => {
            let some = some_of(random, mechanism.n(), 4);
            whole_joints(random, mechanism, some)
        }
    };
    let options = ModeOptions { starts: random.below(starts), seed: random.below(1000) as u64 };
    match assembly_modes(mechanism, &guess, &prescribed, options) {
        Ok(found) => record_modes(record, &found),
        Err(error) => record_error(record, &error),
    }
}

#[test]
fn modes_of_random_chains() {
    check("position_modes_random", 60, |random, record| {
        let mechanism = super::mechanisms::closed_chain(random);
        modes_of(random, record, &mechanism, 8);
    });
}

/// Chains whose axes are parallel or coincide, with balls, which restarts turn about axes of their own.
#[test]
fn modes_of_aligned_chains() {
    check("position_modes_aligned", 50, |random, record| {
        let mechanism = super::mechanisms::aligned_chain(random);
        modes_of(random, record, &mechanism, 8);
    });
}

#[test]
fn modes_of_the_catalogue() {
    check("position_modes_catalogue", 20, |random, record| {
        let mechanism = of_catalogue(random, true);
        modes_of(random, record, &mechanism, 8);
    });
}
