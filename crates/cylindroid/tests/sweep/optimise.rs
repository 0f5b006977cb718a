//! Optimal designs: closed forms, trade-offs, and what changes nothing.

use std::f64::consts::{PI, SQRT_2};
use std::path::Path;

use cylindroid::ik::Task;
use cylindroid::sweep::{
    Axis, DesignObjective, DesignSpace, Optimisation, OptimisationOptions, Optimum, ParameterRange,
    Quantity, Sense, Source, Sweep, SweepOptions, Values,
};
use cylindroid::{Error, ParametricModel, Result};

use crate::designs::{ARM, axis, five_bar, orthoglide};

fn range(name: &str, from: f64, to: f64) -> ParameterRange {
    ParameterRange { name: name.to_owned(), from, to }
}

fn minimise(name: &str) -> DesignObjective {
    DesignObjective::named(name, Sense::Minimise).unwrap()
}

fn maximise(name: &str) -> DesignObjective {
    DesignObjective::named(name, Sense::Maximise).unwrap()
}

fn options(ranges: &[ParameterRange], objectives: &[DesignObjective]) -> OptimisationOptions {
    OptimisationOptions {
        ranges: ranges.to_vec(),
        objectives: objectives.to_vec(),
        ..OptimisationOptions::default()
    }
}

fn model(text: &str) -> ParametricModel {
    ParametricModel::of_text(text, Path::new("design.toml"), &[]).unwrap()
}

fn run(model: &ParametricModel, options: OptimisationOptions) -> Optimum {
    Optimisation::new(model, options).unwrap().run(None, |_| true).unwrap().unwrap()
}

/// Two bars in the plane, from a base.
fn two_bars(unit: f64, [x, y]: [f64; 2]) -> ParametricModel {
    model(&format!(
        "dimension = 2\nreference = 'hand'\nreference_point = ['{x} + a + b', {y}]\n\
         [parameters]\na = {unit}\nb = {half}\n\
         [[joint]]\nname = 'shoulder'\ntype = 'revolute'\nbetween = ['ground', 'arm']\n\
         origin = [{x}, {y}]\n\
         [[joint]]\nname = 'elbow'\ntype = 'revolute'\nbetween = ['arm', 'hand']\n\
         origin = ['{x} + a', {y}]\n",
        half = 0.5 * unit
    ))
}

/// With singular values s and t, s/t + t/s = (a/b + 2 b/a + 2 cos) / |sin| of the angle of the elbow:
/// for every angle, and so for every statistic, the best ratio a/b is the root of 2, and only 135
/// degrees are isotropic (Salisbury & Craig 1982).
#[test]
fn bars_of_an_arm_have_the_ratio_of_salisbury() {
    let best = |angle: f64| {
        let sum = (2.0 * SQRT_2 + 2.0 * angle.cos()) / angle.sin().abs();
        0.5 * (sum + (sum * sum - 4.0).max(0.0).sqrt())
    };
    let angles: Vec<f64> = (1..8).map(|i| f64::from(i) * PI / 8.0).collect();
    let conditions: Vec<f64> = angles.iter().map(|a| best(*a)).collect();
    let least = conditions.iter().copied().fold(f64::INFINITY, f64::min);
    let most = conditions.iter().copied().fold(0.0, f64::max);
    let mean = conditions.iter().sum::<f64>() / conditions.len() as f64;
    assert!((least - 1.0).abs() < 1e-7);
    let arm = two_bars(1.0, [0.0, 0.0]);
    for (statistic, expected) in [("smallest", least), ("mean", mean), ("largest", most)] {
        let own = minimise(&format!("condition:{statistic}"));
        let mut options = options(&[range("b", 0.1, 3.0)], &[own]);
        options.sweep.task = Some(Task::named("x,y", arm.nominal()).unwrap());
        options.sweep.source = Source::Grid {
            axes: vec![axis("elbow", PI / 8.0, 7.0 * PI / 8.0, 7)],
            rest: Vec::new(),
        };
        let found = run(&arm, options);
        let best = &found.designs[0];
        assert!((best.values[0] - 1.0 / SQRT_2).abs() < 1e-6, "{statistic}: {best:?}");
        assert!((best.indices[0] / expected - 1.0).abs() < 1e-7, "{statistic}: {best:?}");
        assert!(found.refinements.iter().all(|r| r.converged), "{found:?}");
    }
}

/// The efficiencies are cos^2(bend) over 3 cos^2(rod) and 1.5 sin^2(rod) with rod = cone + bend: their
/// smallest is largest, one, where the rods are perpendicular and lie along the slides (Wenger &
/// Chablat 2000).
#[test]
fn the_isotropic_orthoglide_is_found_from_random_starts() {
    let right = (1.0 / 3.0_f64.sqrt()).acos();
    let model = orthoglide();
    let ranges = [range("cone", 0.3, 1.4), range("bend", -0.4, 0.4)];
    for seed in 0..10 {
        let single = OptimisationOptions { designs: 1, starts: 1, seed, ..Default::default() };
        let objectives = vec![maximise("smallest")];
        let found =
            run(&model, OptimisationOptions { ranges: ranges.to_vec(), objectives, ..single });
        let start = &found.refinements[0].start;
        let best = &found.designs[0];
        let [cone, bend] = [best.values[0], best.values[1]];
        assert!(start != &best.values && best.refined, "{found:?}");
        assert!((best.indices[0] - 1.0).abs() < 1e-6, "{seed}: {best:?}");
        assert!((cone + bend - right).abs() < 1e-6 && bend.abs() < 1e-3, "{seed}: {best:?}");
    }
    let found = run(&model, options(&ranges[..1], &[minimise("anisotropy")]));
    let best = &found.designs[0];
    // The bend of the file is 0.1.
    assert!((best.values[0] + 0.1 - right).abs() < 1e-7, "{best:?}");
    assert!((best.indices[0] - 1.0).abs() < 1e-7, "{best:?}");
}

/// See `isotropic_five_bars_are_found`.
#[test]
fn isotropic_five_bars_are_optimal() {
    for (rod, base, y) in [(0.6, 0.3, 0.8), (0.5 * SQRT_2, 0.5, 1.1), (0.9, 0.2, 1.2)] {
        let half = rod / SQRT_2;
        let crank = (half - base).hypot(y - half);
        let fixed = [("rod", rod), ("base", base), ("point_y", y), ("crank", 1.05 * crank)];
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/designs.toml");
        let own = ParametricModel::read(path.to_str().unwrap(), &fixed).unwrap();
        let ranges = [range("crank", 0.8 * crank, 1.2 * crank), range("point_x", -0.1, 0.1)];
        let found = run(&own, options(&ranges, &[minimise("anisotropy")]));
        let best = &found.designs[0];
        assert!((best.indices[0] - 1.0).abs() < 1e-6, "{best:?}");
        assert!((best.values[0] - crank).abs() < 1e-6 && best.values[1].abs() < 1e-6, "{best:?}");
    }
}

/// A point of the plane at (x, y) of two parameters.
fn point(x: &str, y: &str) -> ParametricModel {
    model(&format!(
        "dimension = 2\nreference = 'hand'\nreference_point = ['{x}', '{y}']\n\
         [parameters]\ns = 0.5\nt = 0.5\n\
         [[joint]]\nname = 'slide'\ntype = 'prismatic'\nbetween = ['ground', 'hand']\n\
         axis = [1, 0]\n"
    ))
}

/// The trade-off of s^2 and (s - 1)^2 (Schaffer 1985) and one that is not convex, both spoilt by t.
#[test]
fn trade_offs_lie_on_known_fronts() {
    type Front = fn(f64, f64) -> f64;
    let convex: Front = |x, y| x.max(0.0).sqrt() + y.max(0.0).sqrt() - 1.0;
    let concave: Front = |x, y| y - (1.0 - x * x);
    let ranges = [range("s", -1.0, 2.0), range("t", 0.0, 1.0)];
    let narrow = [range("s", 0.0, 1.0), range("t", 0.0, 1.0)];
    for (x, y, ranges, front) in
        [("s^2 + t", "(s - 1)^2 + t", ranges, convex), ("s", "1 - s^2 + t", narrow, concave)]
    {
        let options =
            OptimisationOptions { starts: 8, ..options(&ranges, &[minimise("x"), minimise("y")]) };
        let found = run(&point(x, y), options);
        let refined: Vec<_> = found.designs.iter().filter(|d| d.refined).collect();
        assert!(refined.len() >= 8, "{found:?}");
        for design in &refined {
            let [x, y] = [design.indices[0], design.indices[1]];
            assert!(front(x, y).abs() < 1e-4, "{design:?}");
            assert!(design.values[1] < 1e-6, "{design:?}");
        }
        // Both ends, and designs between them.
        let (first, last) = (&found.designs[0], &found.designs[found.designs.len() - 1]);
        assert!(first.indices[0] < 1e-9 && last.indices[1] < 1e-9, "{found:?}");
        let between = refined.iter().filter(|d| (0.05..0.9).contains(&d.indices[0])).count();
        assert!(between >= 3, "{found:?}");
        // No one dominates another, in the order of the first objective.
        for pair in found.designs.windows(2) {
            let [a, b] = [&pair[0].indices, &pair[1].indices];
            assert!(a[0] < b[0] && a[1] > b[1], "{pair:?}");
        }
    }
}

#[test]
fn refined_trade_offs_dominate_their_starts() {
    let arm = two_bars(1.0, [0.0, 0.0]);
    let mut options = options(
        &[range("a", 0.2, 1.0), range("b", 0.2, 1.0)],
        &[minimise("condition:mean"), maximise("yoshikawa:mean"), minimise("x:largest")],
    );
    options.sweep.task = Some(Task::named("x,y", arm.nominal()).unwrap());
    options.sweep.source =
        Source::Grid { axes: vec![axis("elbow", 0.5, 2.5, 5)], rest: Vec::new() };
    let search = Optimisation::new(&arm, options.clone()).unwrap();
    let found = search.run(None, |_| true).unwrap().unwrap();
    let signed = |f: &[f64]| [f[0], -f[1], f[2]];
    assert_eq!(found.refinements.len(), 3 + options.starts);
    for (i, refinement) in found.refinements.iter().enumerate() {
        let start = signed(&search.evaluate(&refinement.start).unwrap());
        let end = signed(&search.evaluate(&refinement.values).unwrap());
        assert_eq!(end, signed(&refinement.indices));
        let better = |k: usize| end[k] <= start[k] + 1e-12 * start[k].abs();
        // The first three are of one objective each.
        assert!(if i < 3 { (0..3).any(better) } else { (0..3).all(better) }, "{refinement:?}");
    }
}

/// Units, place, order of parameters, objectives and the file, threads.
#[test]
fn designs_depend_on_neither_units_nor_order_nor_threads() {
    let search = |model: &ParametricModel, unit: f64, turned: bool, threads: usize| {
        let mut ranges = vec![range("a", 0.5 * unit, unit), range("b", 0.2 * unit, 2.0 * unit)];
        let mut objectives = vec![minimise("condition:mean"), maximise("limit_distance")];
        objectives[1] = minimise("condition:smallest");
        if turned {
            ranges.reverse();
            objectives.reverse();
        }
        let mut options = options(&ranges, &objectives);
        options.sweep.task = Some(Task::named("x,y", model.nominal()).unwrap());
        options.sweep.source =
            Source::Grid { axes: vec![axis("elbow", 0.5, 2.5, 4)], rest: Vec::new() };
        let search = Optimisation::new(model, options).unwrap();
        search.run(threads.try_into().ok(), |_| true).unwrap().unwrap()
    };
    let arm = two_bars(1.0, [0.0, 0.0]);
    let found = search(&arm, 1.0, false, 1);
    assert_eq!(found, search(&arm, 1.0, false, 4));
    let turned = search(&arm, 1.0, true, 2);
    assert_eq!(
        (found.evaluated, found.refinements.len()),
        (turned.evaluated, turned.refinements.len())
    );
    for (a, b) in found.refinements.iter().zip(&turned.refinements) {
        let reversed = |v: &[f64]| v.iter().rev().copied().collect::<Vec<_>>();
        assert_eq!((&a.values, &a.indices), (&reversed(&b.values), &reversed(&b.indices)));
    }
    // Both objectives have the same best ratio, so one design remains, whatever the unit and place.
    for (unit, place) in [(1.0, [0.0, 0.0]), (1000.0, [0.0, 0.0]), (1.0, [3.0, -2.0])] {
        let found = search(&two_bars(unit, place), unit, false, 2);
        for design in found.designs.iter().filter(|d| d.refined) {
            let ratio = design.values[0] / design.values[1];
            assert!((ratio - SQRT_2).abs() < 1e-5, "{unit}: {design:?}");
        }
    }
}

#[test]
fn indices_are_those_of_the_sweep() {
    let arm = model(ARM);
    let source = Source::Samples { count: 50, seed: 4 };
    let names =
        ["condition:mean", "condition:smallest", "yoshikawa:largest", "limit_distance:mean"];
    let objectives: Vec<_> = names.into_iter().map(minimise).chain([maximise("x")]).collect();
    let mut own = options(&[range("a", 0.3, 0.8)], &objectives);
    own.sweep.source = source.clone();
    let search = Optimisation::new(&arm, own).unwrap();
    for a in [0.3, 0.55, 0.8] {
        let found = search.evaluate(&[a]).unwrap();
        let quantities =
            [Quantity::Pose, Quantity::Condition, Quantity::Yoshikawa, Quantity::LimitDistance];
        let options = SweepOptions {
            source: source.clone(),
            quantities: quantities.to_vec(),
            ..Default::default()
        };
        let space = DesignSpace::Grid(vec![axis("a", a, a, 1)]);
        let table = Sweep::of_designs(&arm, space, options).unwrap().table(0..50).unwrap();
        let of = |name: &str| table.numbers(name).unwrap().to_vec();
        let mean = |v: Vec<f64>| v.iter().sum::<f64>() / 50.0;
        let least = |v: Vec<f64>| v.into_iter().fold(f64::INFINITY, f64::min);
        let most = |v: Vec<f64>| v.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let expected = [
            mean(of("condition")),
            least(of("condition")),
            most(of("yoshikawa")),
            mean(of("limit_distance")),
            least(of("x")),
        ];
        assert_eq!(found, expected);
    }
}

/// A grid of other parameters is a workspace: here the points of a five-bar.
#[test]
fn parameters_are_a_workspace() {
    let model = five_bar();
    let of = |workspace: Vec<Axis>| {
        let own = options(
            &[range("crank", 0.3, 0.8)],
            &[minimise("anisotropy"), minimise("type_ii:mean")],
        );
        Optimisation::new(&model, OptimisationOptions { workspace, ..own }).unwrap()
    };
    let grid = of(vec![axis("point_x", -0.1, 0.1, 3), axis("point_y", 0.7, 0.8, 2)]);
    let found = grid.evaluate(&[0.5]).unwrap();
    let mut all = Vec::new();
    for x in [-0.1, 0.0, 0.1] {
        for y in [0.7, 0.8] {
            let one = of(vec![axis("point_x", x, x, 1), axis("point_y", y, y, 1)]);
            all.push(one.evaluate(&[0.5]).unwrap());
        }
    }
    let most = all.iter().map(|f| f[0]).fold(0.0, f64::max);
    let mean = all.iter().map(|f| f[1]).sum::<f64>() / 6.0;
    assert!((found[0] - most).abs() < 1e-12 && (found[1] - mean).abs() < 1e-12);
    // A point out of reach.
    let far = of(vec![axis("point_y", 0.8, 1.9, 2)]).evaluate(&[0.5]).unwrap_err().to_string();
    assert!(far.contains("at point_y = 1.9"), "{far}");
}

#[test]
fn designs_without_an_index_are_told() {
    let arm = model(ARM);
    // reach = 1.8 a is at most 1.5: the best design lies there.
    let mut own = options(&[range("a", 0.2, 1.0)], &[maximise("x")]);
    own.sweep.source = Source::Configurations(vec![0.0, 0.0]);
    let found = run(&arm, own.clone());
    assert!((found.designs[0].values[0] - 1.5 / 1.8).abs() < 1e-9, "{found:?}");
    assert!(found.invalid > 0 && found.without_index == 0);
    assert!(found.reason.as_ref().unwrap().contains("reach"), "{found:?}");
    // None at all.
    own.ranges = vec![range("a", 0.9, 1.0)];
    let found = run(&arm, own.clone());
    assert!(found.designs.is_empty() && found.refinements.is_empty());
    assert_eq!((found.evaluated, found.invalid), (64, 64));
    // Two joints have no third pitch.
    own.ranges = vec![range("a", 0.2, 0.8)];
    own.objectives = vec![minimise("principal_pitch_3")];
    let found = run(&arm, own.clone());
    assert!(found.designs.is_empty() && found.without_index == 64);
    assert!(found.reason.unwrap().contains("principal_pitch_3 of configuration 0 is not finite"));
    // Configurations that are closed in the nominal design alone.
    let five_bar = five_bar();
    let nominal = five_bar.nominal();
    let mut guess = nominal.home().to_vec();
    guess[0] += 0.2;
    let closed = cylindroid::closure::assemble(nominal, &guess, &[]).unwrap();
    let mut own = options(&[range("rod", 0.5, 0.7)], &[minimise("anisotropy")]);
    own.sweep.source = Source::Configurations(closed.q);
    let search = Optimisation::new(&five_bar, own).unwrap();
    assert!(search.evaluate(&[0.6]).is_ok());
    let open = search.evaluate(&[0.65]).unwrap_err().to_string();
    assert!(open.contains("the loops of configuration 0 are open"), "{open}");
}

/// Counts of poses that are not reached and of samples without a configuration are not zeros of an
/// index: the design has none, unless the share of the others is an index too.
#[test]
fn rows_without_a_configuration_are_no_zeros() {
    let arm = model(ARM);
    let task = Task::named("x,y", arm.nominal()).unwrap();
    let numbers: Vec<f64> = [0.3, 0.6, 0.9, 1.2].iter().flat_map(|x| [*x, 0.0, 0.0]).collect();
    let of = |objectives: &[DesignObjective]| {
        let mut own = options(&[range("a", 0.2, 0.8)], objectives);
        own.sweep.source = Source::poses(&numbers, task).unwrap();
        Optimisation::new(&arm, own).unwrap()
    };
    // Reach 0.9 m, 1.8 a: three of four, by two joints that move freely there.
    let dof = DesignObjective::named("dof:mean", Sense::Maximise).unwrap();
    let refused = of(std::slice::from_ref(&dof)).evaluate(&[0.52]).unwrap_err().to_string();
    assert!(refused.contains("pose 3 is not reached; with reached:mean"), "{refused}");
    let reached = DesignObjective::named("reached:mean", Sense::Maximise).unwrap();
    assert_eq!(of(&[dof.clone(), reached.clone()]).evaluate(&[0.52]).unwrap(), [2.0, 0.75]);
    assert_eq!(of(&[dof, reached.clone()]).evaluate(&[0.7]).unwrap(), [2.0, 1.0]);
    assert_eq!(of(std::slice::from_ref(&reached)).evaluate(&[0.7]).unwrap(), [1.0]);
    let unknown = Error::unknown("index", "reached", ["closed"]).to_string();
    let own = options(&[range("a", 0.2, 0.8)], &[reached]);
    let refused = Optimisation::new(&arm, own).unwrap_err().to_string();
    assert!(refused.starts_with(unknown.split(';').next().unwrap()), "{refused}");

    let five_bar = five_bar();
    let source = Source::Samples { count: 64, seed: 3 };
    let of = |objectives: &[DesignObjective]| {
        let mut own = options(&[range("rod", 0.5, 0.7)], objectives);
        own.sweep.source = source.clone();
        Optimisation::new(&five_bar, own).unwrap()
    };
    let refused = of(&[maximise("type_ii")]).evaluate(&[0.6]).unwrap_err().to_string();
    assert!(refused.contains("no straight path of the drives reaches configuration"), "{refused}");
    let closed = DesignObjective::named("closed:mean", Sense::Maximise).unwrap();
    let dof = DesignObjective::named("dof:smallest", Sense::Maximise).unwrap();
    let found = of(&[closed, maximise("type_ii"), dof]).evaluate(&[0.6]).unwrap();
    let options = SweepOptions {
        source: source.clone(),
        quantities: vec![Quantity::Measures],
        ..SweepOptions::default()
    };
    let own = five_bar.with(&[("rod", 0.6)]).unwrap();
    let table = Sweep::new(&own, options).unwrap().table(0..64).unwrap();
    let smallest = table.numbers("type_ii").unwrap().iter().fold(f64::INFINITY, |a, b| a.min(*b));
    let Some(Values::Counts(closed)) = table.column("closed") else { panic!() };
    let share = closed.iter().sum::<u64>() as f64 / 64.0;
    assert!(share > 0.0 && share < 1.0);
    assert_eq!(found, [share, smallest, 2.0]);
}

#[test]
fn what_is_done_is_counted() {
    let mut seen = Vec::new();
    let own = options(&[range("rod", 0.5, 0.7)], &[minimise("anisotropy")]);
    let own = OptimisationOptions { starts: 2, evaluations: 50, ..own };
    let search = Optimisation::new(&five_bar(), own).unwrap();
    let found = search.run(None, |progress| {
        seen.push(*progress);
        true
    });
    let found = found.unwrap().unwrap();
    let last = seen.last().unwrap();
    assert!(last.unit == "designs" && last.at_most && last.rows == 64 + 2 * 50, "{last:?}");
    assert_eq!(last.done, found.evaluated);
    assert!(seen.windows(2).all(|pair| pair[0].done <= pair[1].done));
}

#[test]
fn searches_can_be_stopped() {
    let arm = two_bars(1.0, [0.0, 0.0]);
    let own = options(&[range("b", 0.1, 3.0)], &[maximise("x")]);
    let search = Optimisation::new(&arm, own).unwrap();
    assert!(search.run(None, |_| false).unwrap().is_none());
}

#[test]
fn wrong_options_are_refused() {
    let arm = model(ARM);
    let one = || options(&[range("a", 0.2, 0.8)], &[maximise("x")]);
    let of = |own: OptimisationOptions| -> Result<()> { Optimisation::new(&arm, own).map(|_| ()) };
    assert!(of(one()).is_ok());
    let refused = |change: &dyn Fn(&mut OptimisationOptions)| {
        let mut own = one();
        change(&mut own);
        of(own).unwrap_err().to_string()
    };
    let message = refused(&|o| o.objectives.clear());
    assert!(message.contains("name one index at least"), "{message}");
    let message = refused(&|o| o.objectives = vec![maximise("conditio")]);
    assert!(message.contains("no index named 'conditio'; nearest: condition"), "{message}");
    // Names of classes are no numbers, and coordinates are given.
    for index in ["gibson_hunt", "shoulder", "index"] {
        assert!(refused(&|o| o.objectives = vec![maximise(index)]).contains("no index named"));
    }
    let message = refused(&|o| o.objectives = vec![minimise("x:mean"), minimise("x:mean")]);
    assert!(message.contains("named twice"), "{message}");
    let message = refused(&|o| o.ranges[0].name = "aa".to_owned());
    assert!(message.contains("no parameter named 'aa'; nearest: a"), "{message}");
    assert!(refused(&|o| o.ranges.clear()).contains("one parameter at least"));
    assert!(refused(&|o| o.ranges[0].to = 2.0).contains("its range is 0.1 to 1"));
    assert!(refused(&|o| o.ranges[0].to = f64::NAN).contains("is not finite"));
    assert!(refused(&|o| o.ranges[0].to = 0.1).contains("smallest value comes first"));
    assert!(refused(&|o| o.designs = 0).contains("1 to 2^24"));
    assert!(refused(&|o| o.starts = 5000).contains("at most 4096"));
    assert!(refused(&|o| o.evaluations = u64::MAX).contains("at most 1e9"));
    let message = refused(&|o| o.workspace = vec![axis("a", 0.2, 0.3, 2)]);
    assert!(message.contains("not both"), "{message}");
    assert!(
        refused(&|o| o.workspace = vec![axis("b", 0.2, 0.3, 0)]).contains("one value at least")
    );
    let error = DesignObjective::named("x:median", Sense::Minimise).unwrap_err().to_string();
    assert!(error.contains("no statistic named 'median'"), "{error}");
    let search = Optimisation::new(&arm, one()).unwrap();
    assert!(search.evaluate(&[]).is_err() && search.evaluate(&[0.95]).is_err());
    // A closed chain has measures only.
    let own = options(&[range("crank", 0.4, 0.6)], &[minimise("condition")]);
    let error = Optimisation::new(&five_bar(), own).unwrap_err().to_string();
    assert!(error.contains("no index named 'condition'"), "{error}");
}
