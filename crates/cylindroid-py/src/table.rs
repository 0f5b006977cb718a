//! How reports look: names and values, as text and in notebooks.

/// A title and rows of names and values.
#[derive(Debug)]
pub(crate) struct Table {
    title: String,
    rows: Vec<(String, String)>,
}

impl Table {
    pub(crate) fn new(title: &str) -> Self {
        Self { title: title.to_owned(), rows: Vec::new() }
    }

    pub(crate) fn row(&mut self, name: &str, value: impl Into<String>) {
        self.rows.push((name.to_owned(), value.into()));
    }

    /// For `repr` and `print`.
    pub(crate) fn text(&self) -> String {
        let width = self.rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        let mut text = self.title.clone();
        for (name, value) in &self.rows {
            let pad = " ".repeat(width - name.chars().count());
            text.push_str(&format!("\n  {name}{pad}  {value}"));
        }
        text
    }

    /// For notebooks.
    pub(crate) fn html(&self) -> String {
        let mut html = format!("<table><caption>{}</caption>", escaped(&self.title));
        for (name, value) in &self.rows {
            html.push_str(&format!(
                "<tr><th style=\"text-align:left\">{}</th><td style=\"text-align:left\">{}</td></tr>",
                escaped(name),
                escaped(value)
            ));
        }
        html.push_str("</table>");
        html
    }
}

/// The methods of Python that show what a class's `table` holds.
macro_rules! shown {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            fn __repr__(&self) -> String {
                self.table().text()
            }

            fn _repr_html_(&self) -> String {
                self.table().html()
            }
        }
    };
}
pub(crate) use shown;

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('\n', "<br>")
}

/// Six digits at most.
pub(crate) fn number(x: f64) -> String {
    if x != 0.0 && x.is_finite() && !(1e-4..1e6).contains(&x.abs()) {
        return format!("{x:.3e}");
    }
    let text = format!("{:.5}", if x.abs() < 5e-6 { 0.0 } else { x });
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Several, in brackets.
pub(crate) fn list(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|x| number(*x)).collect();
    format!("[{}]", all.join(", "))
}

/// Names, or "none".
pub(crate) fn names<S: AsRef<str>>(names: &[S]) -> String {
    let all: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    if all.is_empty() { "none".to_owned() } else { all.join(", ") }
}
