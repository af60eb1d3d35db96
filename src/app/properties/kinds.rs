//! Tables that are one of several kinds, and what stays of one that becomes another.

use toml::{Table as TomlTable, Value};

use crate::{
    app::properties::values::{number_of, value_of},
    figure::scene_file::{
        keys::{Key, Table},
        shape_keys::SHAPES,
    },
};

/// The table of a kind.
pub fn of_kind(tables: &'static [Table], kind: &str) -> Option<&'static Table> {
    tables.iter().find(|table| table.name == kind)
}

/// A table of another kind: what both have stays, sizes stay about as they were, what else the other needs is as in its example.
pub fn of_other_kind(keys: &Table, given: &TomlTable) -> Value {
    let mut made = TomlTable::new();
    let half = half_extent(given);
    let before = given.get("kind").and_then(Value::as_str).and_then(|kind| of_kind(SHAPES, kind));
    // A size of two numbers is no size of three.
    let is_same_kind = |key: &Key| {
        let own = before.and_then(|table| table.keys.iter().find(|own| own.name == key.name));
        own.is_none_or(|own| std::mem::discriminant(&own.kind) == std::mem::discriminant(&key.kind))
    };
    let size = |name: &str| {
        let [x, y, z] = half?;
        let of = |numbers: &[f64]| Some(Value::Array(numbers.iter().map(|n| Value::Float(*n)).collect()));
        match (keys.name, name) {
            (_, "radius") => Some(Value::Float(x.max(y))),
            ("frustum", "top_radius") => Some(Value::Float(0.5 * x.max(y))),
            (_, "radii") => of(&[x, y, z]),
            ("box", "size") => of(&[2.0 * x, 2.0 * y, 2.0 * z]),
            ("cylinder" | "cone" | "frustum", "height") => Some(Value::Float(2.0 * z)),
            _ => None,
        }
    };
    for key in keys.keys {
        let value = match key.name {
            "kind" => Some(Value::String(keys.name.to_owned())),
            name => {
                let same = given.get(name).filter(|_| is_same_kind(key)).cloned();
                same.or_else(|| size(name)).or_else(|| key.default.is_empty().then(|| value_of(key.example)).flatten())
            }
        };
        if let Some(value) = value {
            made.insert(key.name.to_owned(), value);
        }
    }
    Value::Table(made)
}

/// Half of how large a shape is along its own axes, metres, where its kind says that.
fn half_extent(given: &TomlTable) -> Option<[f64; 3]> {
    let number = |key: &str| given.get(key).filter(|v| v.is_float() || v.is_integer()).map(number_of);
    let three = |key: &str| {
        let list = given.get(key)?.as_array()?;
        <[f64; 3]>::try_from(list.iter().map(number_of).collect::<Vec<_>>()).ok()
    };
    match given.get("kind").and_then(Value::as_str)? {
        "box" => three("size").map(|size| size.map(|side| 0.5 * side)),
        "ellipsoid" => three("radii"),
        "sphere" => number("radius").map(|r| [r; 3]),
        "cylinder" | "cone" | "frustum" => Some([number("radius")?, number("radius")?, 0.5 * number("height")?]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_kind_of_shape_keeps_what_both_have() {
        let sphere: TomlTable = "kind = \"sphere\"\ncenter = [1, 2, 3]\nradius = 9.5".parse().unwrap();
        for table in SHAPES {
            let made = of_other_kind(table, &sphere);
            assert_eq!(made["kind"].as_str(), Some(table.name));
            if table.keys.iter().any(|key| key.name == "center") {
                assert_eq!(made["center"], sphere["center"], "{}", table.name);
            }
            let number = |key: &str| made.get(key).map(number_of);
            match table.name {
                "cylinder" => assert_eq!([number("radius"), number("height")], [Some(9.5), Some(19.0)]),
                "box" => assert_eq!(made["size"].to_string(), "[19.0, 19.0, 19.0]"),
                "ellipsoid" => assert_eq!(made["radii"].to_string(), "[9.5, 9.5, 9.5]"),
                _ => {}
            }
            // What must be given is there.
            for key in table.keys.iter().filter(|key| key.default.is_empty()) {
                assert!(made.get(key.name).is_some(), "{}: {}", table.name, key.name);
            }
        }
        let crate_like: TomlTable = "kind = \"box\"\ncenter = [1, 2, 3]\nsize = [8, 6, 20]".parse().unwrap();
        let of = |kind: &str| of_other_kind(of_kind(SHAPES, kind).unwrap(), &crate_like);
        assert_eq!(of("ellipsoid")["radii"].to_string(), "[4.0, 3.0, 10.0]");
        assert_eq!(number_of(&of("sphere")["radius"]), 4.0);
        assert!(of("flat").get("size").is_none(), "a rectangle has two sides");
    }
}
