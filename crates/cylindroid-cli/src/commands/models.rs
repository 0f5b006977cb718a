//! `models`: the catalogue.

use std::io::Write;

use cylindroid::catalogue;
use serde::Serialize;

use crate::commands::shared::Style;
use crate::exit::Exit;
use crate::output::{self, Align};

#[derive(Debug, Serialize)]
struct ModelsJson {
    models: Vec<ModelJson>,
}

#[derive(Debug, Serialize)]
struct ModelJson {
    name: &'static str,
    joints: usize,
    loops: usize,
    contacts: usize,
    description: String,
    source: String,
}

pub(crate) fn run(style: Style, out: &mut dyn Write) -> anyhow::Result<Exit> {
    let models: Vec<ModelJson> = catalogue::entries()
        .into_iter()
        .map(|e| ModelJson {
            name: e.name,
            joints: e.dof,
            loops: e.loops,
            contacts: e.contacts,
            description: e.description,
            source: e.source,
        })
        .collect();
    if style == Style::Json {
        output::json(out, &ModelsJson { models })?;
        return Ok(Exit::SUCCESS);
    }
    let columns = [
        ("name", Align::Left),
        ("joints", Align::Right),
        ("loops", Align::Right),
        ("contacts", Align::Right),
        ("description", Align::Left),
    ];
    let count = |n: usize| if n == 0 { "-".to_owned() } else { n.to_string() };
    let rows = models.iter().map(|m| {
        let counts = [count(m.joints), count(m.loops), count(m.contacts)];
        [vec![m.name.to_owned()], counts.to_vec(), vec![m.description.clone()]].concat()
    });
    output::table(out, &columns, rows)?;
    writeln!(out, "\nsources")?;
    output::pairs(out, models.into_iter().map(|m| (m.name, m.source)))?;
    Ok(Exit::SUCCESS)
}
