//! The columns of a drawing: of rows that are there, of a folder, or computed again.

use std::path::Path;

use cylindroid::Result;
use cylindroid::sweep::{Sweep, Table, parquet_columns};

use crate::plot::sweep::Picture;

/// Blocks of rows that are computed again for a drawing.
const BLOCKS: u64 = 64;

/// The columns that the picture needs.
pub(super) fn columns(
    sweep: &Sweep,
    picture: &Picture,
    table: Option<&Table>,
    folder: Option<&Path>,
) -> Result<Vec<Vec<f64>>> {
    let names = picture.columns();
    if let Some(table) = table {
        return Ok(of_table(table, &names));
    }
    match folder {
        Some(folder) if picture.is_of_all() => of_folder(sweep, &names, folder),
        _ => of_some(sweep, &names, picture.rows),
    }
}

/// Of `rows` rows, in blocks from everywhere: of samples each block is as evenly spread as all.
fn of_some(sweep: &Sweep, names: &[&str], rows: u64) -> Result<Vec<Vec<f64>>> {
    let all = sweep.rows();
    let blocks = if rows < all { BLOCKS } else { 1 };
    let mut columns = vec![Vec::new(); names.len()];
    for block in 0..blocks {
        let start = block * (all / blocks);
        let own = of_table(&sweep.table(start..start + rows / blocks)?, names);
        columns.iter_mut().zip(own).for_each(|(column, own)| column.extend(own));
    }
    Ok(columns)
}

fn of_table(table: &Table, names: &[&str]) -> Vec<Vec<f64>> {
    let column = |name: &&str| table.column(name)?.to_numbers(0..table.rows());
    names.iter().map(|name| column(name).unwrap_or_default()).collect()
}

fn of_folder(sweep: &Sweep, names: &[&str], folder: &Path) -> Result<Vec<Vec<f64>>> {
    let mut columns = vec![Vec::new(); names.len()];
    for part in 0..sweep.parts() {
        let rows = parquet_columns(&folder.join(Sweep::part_name(part)), names)?;
        for (i, column) in columns.iter_mut().enumerate() {
            column.extend(rows.iter().skip(i).step_by(names.len()));
        }
    }
    Ok(columns)
}
