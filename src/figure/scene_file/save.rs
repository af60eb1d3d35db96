//! Changes the text of a file that a person wrote: what has another value gets it, all else stays as it stands, comments, order and empty lines too.

use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, TableLike, Value};

use crate::figure::scene_file::{
    edit::FORMS,
    node::{Data, Node},
    text,
};

/// The text with the values of `now` where they are others than those of `was`, which it says now; `None` where it is no TOML.
/// With `is_strict` a table is written anew where a key that changes does not stand in it: something else may say the same.
pub fn changed(file: &str, was: &Node, now: &Node, is_strict: bool) -> Option<String> {
    let mode = Mode { is_strict };
    let mut document: DocumentMut = file.parse().ok()?;
    let root = document.as_table_mut();
    for (key, _) in entries(was).filter(|(key, _)| !now.has(key)) {
        root.remove(key);
    }
    for (key, after) in entries(now) {
        match (root.get_mut(key), was.entry(key)) {
            (_, Some(before)) if before == after => {}
            (Some(item), Some(before)) => {
                if !mode.within(item, before, after) {
                    *item = section(after)?;
                }
            }
            _ => drop(root.insert(key, section(after)?)),
        }
    }
    let made = document.to_string();
    Some(if file.contains("\r\n") { made.replace("\r\n", "\n").replace('\n', "\r\n") } else { made })
}

fn entries(table: &Node) -> impl Iterator<Item = (&str, &Node)> {
    let entries = match &table.data {
        Data::Table(entries) => &entries[..],
        _ => &[],
    };
    entries.iter().map(|(key, _, node)| (key.as_str(), node))
}

/// A key of the top of a file.
fn section(node: &Node) -> Option<Item> {
    match &node.data {
        Data::Table(_) => Some(Item::Table(headed(node)?)),
        Data::List(list) if !list.is_empty() && list.iter().all(Node::is_table) => {
            let tables: Option<ArrayOfTables> = list.iter().map(headed).collect();
            Some(Item::ArrayOfTables(tables?))
        }
        _ => Some(Item::Value(value(node)?)),
    }
}

/// A table with a head of its own.
fn headed(node: &Node) -> Option<Table> {
    let mut table = Table::new();
    for (key, node) in entries(node) {
        table.insert(key, Item::Value(value(node)?));
    }
    Some(table)
}

fn value(node: &Node) -> Option<Value> {
    text::value(&node.data).parse().ok()
}

/// How careful changes are made.
#[derive(Clone, Copy)]
struct Mode {
    is_strict: bool,
}

impl Mode {
    /// Changes what an item has; `false` where it says what `before` is in another way than expected.
    fn within(self, item: &mut Item, before: &Node, after: &Node) -> bool {
        match (item, &before.data, &after.data) {
            (Item::ArrayOfTables(all), Data::List(was), Data::List(now)) => self.tables(all, was, now),
            (Item::Value(own), ..) => self.within_value(own, before, after),
            (item, Data::Table(_), Data::Table(_)) => {
                item.as_table_like_mut().is_some_and(|table| self.within_table(table, before, after))
            }
            _ => false,
        }
    }

    fn within_table(self, table: &mut dyn TableLike, was: &Node, now: &Node) -> bool {
        for (key, _) in entries(was).filter(|(key, _)| !now.has(key)) {
            if table.remove(key).is_none() {
                // It is said by another key, or not at all.
                return false;
            }
        }
        for (key, after) in entries(now) {
            let before = was.entry(key);
            if before == Some(after) {
                continue;
            }
            let done = match (table.contains_key(key), before) {
                (true, Some(before)) => table.get_mut(key).is_some_and(|item| self.within(item, before, after)),
                (false, Some(before)) if key == "shape" && table.contains_key("shapes") => {
                    only(table.get_mut("shapes")).is_some_and(|one| self.within_value(one, before, after))
                }
                (false, Some(_)) if self.is_strict => return false,
                _ => insert(table, key, after),
            };
            if !done && !replace(table, key, after) {
                return false;
            }
        }
        true
    }

    fn within_value(self, own: &mut Value, before: &Node, after: &Node) -> bool {
        match (&mut *own, &before.data, &after.data) {
            (Value::InlineTable(table), Data::Table(_), Data::Table(_)) => {
                return self.within_table(table, before, after);
            }
            (Value::Array(list), Data::List(was), Data::List(now))
                if list.len() == was.len() && was.len() == now.len() =>
            {
                let mut each = was.iter().zip(now).enumerate().filter(|(_, (before, after))| before != after);
                return each.all(|(i, (before, after))| {
                    list.get_mut(i).is_some_and(|own| self.within_value(own, before, after))
                });
            }
            _ => {}
        }
        value(after).map(|value| put(own, value)).is_some()
    }

    /// Changes tables with heads: those that stay keep what stands in them.
    fn tables(self, all: &mut ArrayOfTables, was: &[Node], now: &[Node]) -> bool {
        let old: Vec<Table> = all.iter().cloned().collect();
        if old.len() != was.len() {
            return false;
        }
        let from = origins(was, now);
        let kept: Vec<usize> = from.iter().flatten().copied().collect();
        let is_reordered = !kept.is_sorted();
        let mut positions: Vec<Option<isize>> = kept.iter().map(|i| old[*i].position()).collect();
        positions.sort();
        let mut positions = positions.into_iter();
        all.clear();
        for (node, from) in now.iter().zip(from) {
            let table = match from {
                None => headed(node),
                Some(i) => {
                    let mut table = old[i].clone();
                    if was[i] != *node && !self.within_table(&mut table, &was[i], node) {
                        let Some(other) = headed(node) else { return false };
                        let (decor, position) = (table.decor().clone(), table.position());
                        table = other;
                        *table.decor_mut() = decor;
                        table.set_position(position);
                    }
                    let place = positions.next().flatten();
                    if is_reordered {
                        table.set_position(place);
                    }
                    Some(table)
                }
            };
            let Some(table) = table else { return false };
            all.push(table);
        }
        true
    }
}

/// The one element of a list.
fn only(item: Option<&mut Item>) -> Option<&mut Value> {
    let list = item?.as_array_mut()?;
    if list.len() == 1 { list.get_mut(0) } else { None }
}

/// Adds a key, in place of others that say the same.
fn insert(table: &mut dyn TableLike, key: &str, node: &Node) -> bool {
    for other in FORMS.into_iter().filter(|forms| forms.contains(&key)).flatten().filter(|other| **other != key) {
        table.remove(other);
    }
    let Some(mut value) = value(node) else { return false };
    // The space before a closing bracket stays there.
    if let Some((_, Item::Value(last))) = table.iter_mut().last()
        && let Some(space) = last.decor().suffix().and_then(|suffix| suffix.as_str()).map(str::to_owned)
        && !space.is_empty()
        && space.bytes().all(|b| b == b' ')
    {
        last.decor_mut().set_suffix("");
        value.decor_mut().set_suffix(space);
    }
    table.insert(key, Item::Value(value));
    true
}

/// Gives a key that is there another value as a whole.
fn replace(table: &mut dyn TableLike, key: &str, node: &Node) -> bool {
    match (table.get_mut(key), value(node)) {
        (Some(Item::Value(own)), Some(value)) => put(own, value),
        (Some(item), Some(value)) => *item = Item::Value(value),
        _ => return false,
    }
    true
}

/// Puts a value to the place of another; the comments around that stay.
fn put(own: &mut Value, mut value: Value) {
    value.decor_mut().clone_from(own.decor());
    *own = value;
}

/// Which table each of `now` was: by its name, else by its place where none came or went.
fn origins(was: &[Node], now: &[Node]) -> Vec<Option<usize>> {
    let name = |node: &Node| ["name", "lens"].iter().find_map(|key| node.entry(key)?.text().map(str::to_owned));
    let mut is_free = vec![true; was.len()];
    let mut take = |i: usize| std::mem::take(&mut is_free[i]).then_some(i);
    let mut from: Vec<Option<usize>> = Vec::new();
    for node in now {
        let own = name(node);
        let same = was.iter().position(|before| own.is_some() && name(before) == own);
        from.push(same.and_then(&mut take));
    }
    if was.len() == now.len() {
        for (i, from) in from.iter_mut().enumerate().filter(|(_, from)| from.is_none()) {
            *from = take(i);
        }
    }
    from
}

#[cfg(test)]
mod tests {
    use crate::figure::scene_file::{Options, edit::set, parse, to_edited};

    const FILE: &str = "# A town, looked at.\nveduta = 1\n\n\n[figure] # for the poster\nsize = [ 640, 480 ]\n\n# The light comes first, against all habits.\n[sun]\nazimuth_deg = 90 # east\n\n[[lens]]\nshape = { radius = 60, kind = \"sphere\", center = [0, 1, 2] } # the old town\nname = \"a\"\neffects = [\n  \"sepia\", # old\n  { effect = \"overlay\", opacity = 0.5, color = \"#ff0000\" },\n]\n\n# And the new one.\n[[lens]]\nname = \"b\"\n[lens.shape]\nkind = \"box\"\ncenter = [0, 0, 0]\nsize = [1, 2, 3] # metres\n";

    fn after(file: &str, assignments: &[&str]) -> String {
        let options = Options::for_command_line();
        let mut scene = parse(file, "s", &options).unwrap_or_else(|error| panic!("{error}"));
        for assignment in assignments {
            set(&scene.clone(), assignment).unwrap_or_else(|error| panic!("{error}")).redo(&mut scene);
        }
        let made = to_edited(file, &options, &scene, &options);
        assert_eq!(parse(&made, "made", &options).unwrap_or_else(|error| panic!("{error}\n{made}")), scene, "{made}");
        made
    }

    #[test]
    fn the_difference_is_what_was_changed() {
        assert_eq!(after(FILE, &[]), FILE);
        for (assignment, from, to) in [
            ("lens.a.shape.radius=61.5", "radius = 60", "radius = 61.5"),
            ("lens.b.shape.size=[1, 2, 4.5]", "size = [1, 2, 3]", "size = [1, 2, 4.5]"),
            ("sun.azimuth_deg=91", "azimuth_deg = 90 # east", "azimuth_deg = 91.0 # east"),
            ("figure.size=[640, 481]", "[ 640, 480 ]", "[ 640, 481 ]"),
            ("lens.a.effects.1.opacity=0.75", "opacity = 0.5", "opacity = 0.75"),
            ("lens.a.name=old", "name = \"a\"", "name = \"old\""),
            ("lens.a.enabled=false", "]\n\n# And", "]\nenabled = false\n\n# And"),
        ] {
            assert_eq!(after(FILE, &[assignment]), FILE.replacen(from, to, 1), "{assignment}");
        }
        let glass = "veduta = 1\n[[lens]]\nname = \"a\"\nkind = \"magnifier\"\nray = { radius = 0.2 }\n";
        let (from, to) = ("radius = 0.2 }", "radius = 0.2, border = 0.3 }");
        assert_eq!(after(glass, &["lens.a.ray.border=0.3"]), glass.replacen(from, to, 1));
        let windows = FILE.replace('\n', "\r\n");
        assert_eq!(after(&windows, &["sun.azimuth_deg=91"]), windows.replace("= 90", "= 91.0"));
    }

    #[test]
    fn what_comes_and_goes_leaves_the_rest() {
        let without = after(FILE, &["lens.a=unset"]);
        assert!(without.contains("# And the new one.\n[[lens]]\nname = \"b\"\n[lens.shape]"), "{without}");
        assert!(without.contains("# for the poster") && !without.contains("old town"), "{without}");
        let ball = "lens.2={ name = \"c\", shape = { kind = \"sphere\", center = [0, 0, 0], radius = 1 } }";
        let more = after(FILE, &[ball, "style.base=clay"]);
        assert!(more.starts_with(FILE.trim_end()) && more.contains("[[lens]]\nname = \"c\""), "{more}");
        let unlit = after(FILE, &["sun=unset"]);
        assert!(!unlit.contains("[sun]") && unlit.contains("# And the new one."), "{unlit}");
    }

    #[test]
    fn other_ways_of_saying_it_are_written_anew_where_they_change() {
        let file = "veduta = 1\n# Comment.\n[[lens]]\nname = \"a\"\nshapes = [{ kind = \"sphere\", center = [0, 0, 0], radius = 5 }] # one\neffects = [{ effect = \"lod\", lod = 1.2 }]\n";
        assert_eq!(after(file, &["lens.a.shape.radius=6"]), file.replace("radius = 5", "radius = 6.0"));
        let content = after(file, &["lens.a.content.lod=2"]);
        assert!(content.starts_with("veduta = 1\n# Comment.\n[[lens]]"), "{content}");
        let ball = "lens.a.shapes.1={ kind = \"sphere\", center = [9, 0, 0], radius = 1 }";
        assert!(after(file, &[ball]).contains("radius = 1"));
    }
}
