//! Own columns: computed like others, told apart by their version, refused with their rows.

use std::sync::Arc;

use cylindroid::Result;
use cylindroid::sweep::{
    ColumnFunction, DesignSpace, OwnColumn, Quantity, Source, Sweep, SweepOptions, WriteOptions,
};

fn column(name: &str, version: &str, function: ColumnFunction) -> OwnColumn {
    OwnColumn {
        name: name.to_owned(),
        unit: "rad".to_owned(),
        version: version.to_owned(),
        function,
    }
}

/// The sum of the coordinates.
fn sum(version: &str) -> OwnColumn {
    column("sum", version, Arc::new(|q: &[f64]| Ok(q.chunks(5).map(|q| q.iter().sum()).collect())))
}

fn sweep(columns: Vec<OwnColumn>) -> Result<Sweep> {
    let options = SweepOptions {
        source: Source::Samples { count: 1000, seed: 1 },
        quantities: vec![Quantity::Pose],
        columns,
        part_rows: 77,
        ..Default::default()
    };
    Sweep::new(&cylindroid::load("youbot")?, options)
}

#[test]
fn columns_follow_the_quantities_in_every_part() {
    let robot = cylindroid::load("youbot").unwrap();
    let last = Arc::new(|q: &[f64]| Ok(q.chunks(5).map(|q| q[4]).collect()));
    let sweep = sweep(vec![sum("1"), column("last", "", last)]).unwrap();
    let names: Vec<&str> = sweep.columns().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names[names.len() - 3..], ["qz", "sum", "last"]);
    let found = sweep.collect(None, |_| true).unwrap().unwrap();
    for (q, (own, last)) in crate::configurations(&robot, &found)
        .iter()
        .zip(found.numbers("sum").unwrap().iter().zip(found.numbers("last").unwrap()))
    {
        assert_eq!(*own, q.iter().sum::<f64>());
        assert_eq!(*last, q[4]);
    }
    let statistics = sweep.statistics(None, |_| true).unwrap().unwrap();
    assert_eq!(statistics.last().unwrap().0.name, "last");
}

/// Name, unit and version are a part of the recipe, as long as there are columns.
#[test]
fn a_folder_of_other_columns_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    let write = |columns: Vec<OwnColumn>, resume| {
        let options = WriteOptions { threads: None, resume };
        sweep(columns).unwrap().write(&own, &options, |_| true)
    };
    write(vec![sum("1")], false).unwrap();
    assert_eq!(write(vec![sum("1")], true).unwrap().computed, 0);
    let renamed = OwnColumn { name: "total".to_owned(), ..sum("1") };
    let in_degrees = OwnColumn { unit: "deg".to_owned(), ..sum("1") };
    for others in [vec![], vec![sum("2")], vec![renamed], vec![in_degrees]] {
        let error = write(others, true).unwrap_err().to_string();
        assert!(error.contains("own_columns is"), "{error}");
    }
    assert!(!sweep(vec![]).unwrap().recipe().contains("own_columns"));
}

#[test]
fn errors_name_the_column_and_the_rows() {
    let of = |function: ColumnFunction| {
        let found = sweep(vec![column("mine", "1", function)]).unwrap().table(100..150);
        found.unwrap_err().to_string()
    };
    let error = of(Arc::new(|_: &[f64]| Ok(vec![0.0; 3])));
    assert!(error.contains("mine") && error.contains("rows 100 to 149: 3 values"), "{error}");
    let error = of(Arc::new(|_: &[f64]| Err("no mass".to_owned())));
    assert!(error.contains("mine") && error.contains("rows 100 to 149: "), "{error}");
    assert!(error.contains("no mass"), "{error}");
}

#[test]
fn names_are_taken_once() {
    let refused = |names: &[&str]| {
        let columns = names.iter().map(|n| OwnColumn { name: (*n).to_owned(), ..sum("") });
        sweep(columns.collect()).unwrap_err().to_string()
    };
    for names in [&["x"][..], &["index"], &["arm_joint_1"], &["a", "a"], &["", "a"]] {
        let error = refused(names);
        assert!(error.contains("columns") && error.contains(" name"), "{error}");
    }
}

#[test]
fn designs_have_no_own_columns() {
    let options =
        SweepOptions { source: Source::Home, columns: vec![sum("")], ..Default::default() };
    let space = DesignSpace::Grid(Vec::new());
    let error = Sweep::of_designs(&crate::designs::five_bar(), space, options).unwrap_err();
    assert!(error.to_string().contains("not designs"), "{error}");
}
