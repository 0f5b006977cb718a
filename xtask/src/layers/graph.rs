//! Circles of files: strongly connected components of the graph of imports (Tarjan).

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};
use std::fmt;

/// One file uses another: the line that says so.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Import {
    pub(super) from: String,
    pub(super) to: String,
    /// Counted from 1.
    pub(super) line: usize,
    /// The line itself.
    pub(super) text: String,
}

/// Files each of which reaches every other one through imports.
#[derive(Debug)]
pub(super) struct Circle {
    pub(super) files: Vec<String>,
    /// All imports among these files, one for each pair.
    pub(super) imports: Vec<Import>,
    /// The shortest way round, one import for each step.
    pub(super) shortest: Vec<Import>,
}

impl Circle {
    /// The circle with all imports among its files, for those who dissolve it.
    pub(super) fn in_full(&self) -> String {
        self.told(&self.imports)
    }

    fn told(&self, imports: &[Import]) -> String {
        let mut text =
            format!("{} files import one another: {}", self.files.len(), self.files.join(", "));
        for import in imports {
            text.push_str(&format!(
                "\n    {}:{} -> {}: {}",
                import.from,
                import.line,
                import.to,
                import.text.trim()
            ));
        }
        text
    }
}

impl fmt::Display for Circle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(&self.shortest))
    }
}

/// All circles, in the order of their first files.
pub(super) fn circles(imports: &[Import]) -> Vec<Circle> {
    let mut names: Vec<&str> =
        imports.iter().flat_map(|i| [i.from.as_str(), i.to.as_str()]).collect();
    names.sort_unstable();
    names.dedup();
    let place = |name: &str| names.binary_search(&name).unwrap_or_default();
    // The first import of each pair, by line.
    let mut pairs: BTreeMap<(usize, usize), &Import> = BTreeMap::new();
    for import in imports.iter().filter(|i| i.from != i.to) {
        let pair = pairs.entry((place(&import.from), place(&import.to))).or_insert(import);
        if import.line < pair.line {
            *pair = import;
        }
    }
    let mut next = vec![Vec::new(); names.len()];
    for (from, to) in pairs.keys() {
        next[*from].push(*to);
    }
    let mut found: Vec<Circle> = components(&next)
        .into_iter()
        .filter(|component| component.len() > 1)
        .map(|component| Circle {
            files: component.iter().map(|&file| names[file].to_owned()).collect(),
            imports: pairs
                .iter()
                .filter(|((from, to), _)| component.contains(from) && component.contains(to))
                .map(|(_, import)| (*import).clone())
                .collect(),
            shortest: steps(&shortest(&next, &component), &pairs),
        })
        .collect();
    found.sort_by(|a, b| a.files.cmp(&b.files));
    found
}

fn steps(round: &[usize], pairs: &BTreeMap<(usize, usize), &Import>) -> Vec<Import> {
    let ends = round.iter().zip(round.iter().cycle().skip(1));
    ends.filter_map(|(&from, &to)| pairs.get(&(from, to))).map(|i| (*i).clone()).collect()
}

/// The shortest closed walk inside a component.
fn shortest(next: &[Vec<usize>], component: &[usize]) -> Vec<usize> {
    let rounds = component.iter().filter_map(|&start| {
        let mut before: BTreeMap<usize, usize> = BTreeMap::new();
        let mut waiting = VecDeque::from([start]);
        while let Some(file) = waiting.pop_front() {
            for &other in next[file].iter().filter(|other| component.contains(other)) {
                if other == start {
                    let mut round = vec![file];
                    while let Some(&earlier) = before.get(&round[round.len() - 1]) {
                        round.push(earlier);
                    }
                    round.reverse();
                    return Some(round);
                }
                if let Entry::Vacant(unseen) = before.entry(other) {
                    unseen.insert(file);
                    waiting.push_back(other);
                }
            }
        }
        None
    });
    rounds.min_by_key(Vec::len).unwrap_or_default()
}

/// Strongly connected components, each sorted.
fn components(next: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut search = Search {
        next,
        count: 0,
        index: vec![None; next.len()],
        lowest: vec![0; next.len()],
        stack: Vec::new(),
        found: Vec::new(),
    };
    for file in 0..next.len() {
        if search.index[file].is_none() {
            search.visit(file);
        }
    }
    search.found
}

/// Tarjan's search.
struct Search<'a> {
    next: &'a [Vec<usize>],
    count: usize,
    index: Vec<Option<usize>>,
    lowest: Vec<usize>,
    stack: Vec<usize>,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, file: usize) {
        let index = self.count;
        self.count += 1;
        self.index[file] = Some(index);
        self.lowest[file] = index;
        self.stack.push(file);
        for &other in &self.next[file] {
            match self.index[other] {
                None => {
                    self.visit(other);
                    self.lowest[file] = self.lowest[file].min(self.lowest[other]);
                }
                Some(earlier) if self.stack.contains(&other) => {
                    self.lowest[file] = self.lowest[file].min(earlier);
                }
                Some(_) => {}
            }
        }
        if self.lowest[file] == index {
            let start = self.stack.iter().position(|&f| f == file).unwrap_or_default();
            let mut component = self.stack.split_off(start);
            component.sort_unstable();
            self.found.push(component);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Import, circles};

    fn import(from: &str, to: &str, line: usize) -> Import {
        Import { from: from.into(), to: to.into(), line, text: format!("use {to};") }
    }

    #[test]
    fn a_line_is_no_circle() {
        let imports = [import("a", "b", 1), import("b", "c", 1), import("a", "c", 2)];
        assert!(circles(&imports).is_empty());
        assert!(circles(&[import("a", "a", 1)]).is_empty());
    }

    #[test]
    fn circles_are_told_with_the_shortest_way_round() {
        let imports = [
            import("a", "b", 7),
            import("a", "b", 3),
            import("b", "c", 1),
            import("c", "a", 1),
            import("c", "b", 2),
            import("c", "d", 3),
            import("x", "y", 1),
            import("y", "x", 1),
        ];
        let found = circles(&imports);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].files, ["a", "b", "c"]);
        assert_eq!(found[0].imports.len(), 4);
        assert_eq!(found[0].imports[0].line, 3);
        assert_eq!(
            found[0].to_string(),
            "3 files import one another: a, b, c\n    b:1 -> c: use c;\n    c:2 -> b: use b;"
        );
        assert_eq!(found[1].files, ["x", "y"]);
    }
}
