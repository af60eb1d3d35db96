//! Focus areas of lenses that are made from files, images, polygons or the city, read and written.

use std::{fmt::Write as _, path::PathBuf};

use glam::{DQuat, DVec2, DVec3};

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        node::Node,
        paths::{Options, PathProblem},
        write::{list, number, point, quoted, turned},
    },
    geom::shape::solid::prism,
    lens::{Focus, chosen::Choice},
};

/// What reading needs beside the fields.
pub(super) struct Reader<'r> {
    pub checker: &'r mut Checker,
    pub options: &'r Options,
    /// Set where `${VEDUTA_DATA}` is needed and not set.
    pub lacks_data: &'r mut bool,
}

impl Reader<'_> {
    /// The focus area of a table of this kind; `None` where something is wrong (and noted), or it is another kind.
    pub fn focus(&mut self, kind: &str, fields: &Fields, rotation: DQuat) -> Option<Focus> {
        let focus = match kind {
            "mesh" => Focus::Mesh {
                file: self.path(fields, "file", fields.node("file")?)?,
                at: fields.point("at").unwrap_or(DVec3::ZERO),
                rotation,
                scale: fields.number("scale").unwrap_or(1.0),
            },
            "sprite" => Focus::Sprite { file: self.path(fields, "file", fields.node("file")?)? },
            "mask" => self.mask(fields)?,
            "mask3d" => {
                let images = fields.node("images").and_then(Node::list)?;
                if images.is_empty() {
                    self.checker.note(&fields.place, "images", fields.line("images"), "must name at least one image");
                }
                let named = |i: usize| format!("images.{i}");
                let images: Option<Vec<PathBuf>> =
                    images.iter().enumerate().map(|(i, node)| self.path(fields, &named(i), node)).collect();
                Focus::Mask3d { images: images?, corner: fields.point("corner")?, size: fields.point("size")? }
            }
            "objects" => Focus::Objects(self.choice(fields)?),
            "thematic" => Focus::Thematic(self.choice(fields)?),
            _ => return None,
        };
        if let Some((key, message)) = focus.check() {
            self.checker.note(&fields.place, key, fields.line(key), message);
        }
        Some(focus)
    }

    fn path(&mut self, fields: &Fields, key: &str, node: &Node) -> Option<PathBuf> {
        let message = match self.options.resolve(node.text().unwrap_or_default()) {
            Ok(path) => return Some(path),
            Err(PathProblem::NoData) => {
                *self.lacks_data = true;
                format!("{} needs the environment variable VEDUTA_DATA, which is not set", node.quoted())
            }
            Err(PathProblem::Wrong(message)) => message,
        };
        self.checker.note(&fields.place, key, node.line, message);
        None
    }

    fn mask(&mut self, fields: &Fields) -> Option<Focus> {
        let (base, height) = (fields.number("base"), fields.number("height"));
        match (fields.given("image"), fields.given("points")) {
            (true, false) => {
                for key in ["corner", "size"].into_iter().filter(|key| !fields.given(key)) {
                    let message = "is missing: an image needs corner = [x, y] (its south-west corner) and size = [width, height] in metres";
                    self.checker.note(&fields.place, key, fields.place.line, message);
                }
                self.refuse(fields, &["holes"], "has a meaning only with points");
                let image = self.path(fields, "image", fields.node("image")?)?;
                Some(Focus::Mask {
                    image,
                    corner: plan(fields.node("corner")?)?,
                    size: plan(fields.node("size")?)?,
                    base: base?,
                    height: height?,
                })
            }
            (false, true) => {
                self.refuse(fields, &["corner", "size"], "has a meaning only with image");
                let rings = fields.node("holes").and_then(Node::list).unwrap_or_default();
                let points = ring(fields.node("points")?)?;
                let holes: Vec<_> = rings.iter().filter_map(ring).collect();
                let (base, height) = (base?, height?);
                let rings: Vec<_> = std::iter::once(&points).chain(&holes).cloned().collect();
                let origin = points.first().map_or(DVec3::ZERO, |p| p.round().extend(base));
                // Its height says nothing of the polygon.
                if let Err(error) = prism(&rings, base, height.max(1.0), origin) {
                    self.checker.note(&fields.place, "points", fields.line("points"), error.to_string());
                }
                Some(Focus::Prism { points, holes, base, height })
            }
            (both, _) => {
                let message = match both {
                    true => "is given together with points: a mask is one of them",
                    false => "is missing: give image = \"FILE\" or points = [[x, y], ...]",
                };
                self.checker.note(&fields.place, "image", fields.line("image"), message);
                None
            }
        }
    }

    fn refuse(&mut self, fields: &Fields, keys: &[&'static str], message: &str) {
        for key in keys.iter().filter(|key| fields.given(key)) {
            self.checker.note(&fields.place, key, fields.line(key), message);
        }
    }

    pub(super) fn choice(&mut self, fields: &Fields) -> Option<Choice> {
        let texts = |key| {
            let list = fields.node(key).and_then(Node::list)?;
            Some(list.iter().filter_map(|n| n.text().map(str::to_owned)).collect::<Vec<_>>())
        };
        let given: Vec<&str> = ["ids", "types", "attribute"].into_iter().filter(|key| fields.given(key)).collect();
        match given[..] {
            [] => {
                let message = "is missing: give ids = [\"ID\", ...], types = [\"TYPE\", ...] or attribute = \"NAME\"";
                self.checker.note(&fields.place, "ids", fields.place.line, message);
            }
            ["attribute"] => {}
            [_] => self.refuse(fields, &["values", "min", "max"], "has a meaning only with attribute"),
            [first, ..] => {
                let message = format!("is given together with {first}: objects are chosen by one of them");
                for other in &given[1..] {
                    self.checker.note(&fields.place, other, fields.line(other), message.clone());
                }
            }
        }
        for (key, what) in [("ids", "object"), ("types", "type"), ("values", "value")] {
            if fields.node(key).and_then(Node::list).is_some_and(<[Node]>::is_empty) {
                self.checker.note(&fields.place, key, fields.line(key), format!("must name at least one {what}"));
            }
        }
        if let (Some(min), Some(max)) = (fields.number("min"), fields.number("max"))
            && min > max
        {
            let message = format!("must be at least min, {min}, is {max}");
            self.checker.note(&fields.place, "max", fields.line("max"), message);
        }
        Some(Choice {
            ids: texts("ids").unwrap_or_default(),
            types: texts("types").unwrap_or_default(),
            attribute: fields.text("attribute").map(str::to_owned),
            values: texts("values"),
            min: fields.number("min"),
            max: fields.number("max"),
            except: fields.boolean("except").unwrap_or(false),
        })
    }
}

fn plan(node: &Node) -> Option<DVec2> {
    node.numbers::<2>().map(DVec2::from)
}

fn ring(node: &Node) -> Option<Vec<DVec2>> {
    node.list()?.iter().map(plan).collect()
}

/// A focus area as its table, where it is no plain shape.
pub(super) fn written(focus: &Focus, options: &Options) -> Option<String> {
    let path = |path: &PathBuf| quoted(&options.written(path));
    let flat = |p: &DVec2| list(p.to_array().map(number));
    let ring = |points: &Vec<DVec2>| list(points.iter().map(flat));
    let all = |parts: &[Focus]| list(parts.iter().map(|part| super::write::focus(part, options)));
    let standing = |base: f64, height: f64| format!("base = {}, height = {}", number(base), number(height));
    Some(match focus {
        Focus::Shape(_) => return None,
        Focus::Mesh { file, at, rotation, scale } => {
            let mut out = format!("{{ kind = \"mesh\", file = {}", path(file));
            if *at != DVec3::ZERO {
                let _ = write!(out, ", at = {}", point(*at));
            }
            out.push_str(&turned(*rotation));
            if *scale != 1.0 {
                let _ = write!(out, ", scale = {}", number(*scale));
            }
            out + " }"
        }
        Focus::Sprite { file } => format!("{{ kind = \"sprite\", file = {} }}", path(file)),
        Focus::Prism { points, holes, base, height } => {
            let mut out = format!("{{ kind = \"mask\", points = {}", ring(points));
            if !holes.is_empty() {
                let _ = write!(out, ", holes = {}", list(holes.iter().map(ring)));
            }
            format!("{out}, {} }}", standing(*base, *height))
        }
        Focus::Mask { image, corner, size, base, height } => {
            let (corner, size) = (flat(corner), flat(size));
            format!(
                "{{ kind = \"mask\", image = {}, corner = {corner}, size = {size}, {} }}",
                path(image),
                standing(*base, *height)
            )
        }
        Focus::Mask3d { images, corner, size } => format!(
            "{{ kind = \"mask3d\", images = {}, corner = {}, size = {} }}",
            list(images.iter().map(path)),
            point(*corner),
            point(*size)
        ),
        Focus::Objects(choice) => choice_written("objects", choice),
        Focus::Thematic(choice) => choice_written("thematic", choice),
        Focus::Combined { how, parts } => format!("{{ kind = \"{}\", shapes = {} }}", how.word(), all(parts)),
        // A lens writes them as keys of its own.
        Focus::Occluders(_) | Focus::Case { .. } => return None,
        Focus::Enclosed { parts, whole, types } => {
            let mut out = format!("{{ kind = \"enclosed\", shapes = {}", all(parts));
            if *whole {
                out.push_str(", whole = true");
            }
            if !types.is_empty() {
                let _ = write!(out, ", types = {}", texts(types));
            }
            out + " }"
        }
    })
}

fn texts(all: &[String]) -> String {
    list(all.iter().map(|t| quoted(t)))
}

/// A choice as its table, of a kind or (empty) of none.
pub(super) fn choice_written(kind: &str, choice: &Choice) -> String {
    let mut out = match kind {
        "" => String::new(),
        kind => format!(", kind = \"{kind}\""),
    };
    if !choice.ids.is_empty() {
        let _ = write!(out, ", ids = {}", texts(&choice.ids));
    }
    if !choice.types.is_empty() {
        let _ = write!(out, ", types = {}", texts(&choice.types));
    }
    if let Some(attribute) = &choice.attribute {
        let _ = write!(out, ", attribute = {}", quoted(attribute));
    }
    if let Some(values) = &choice.values {
        let _ = write!(out, ", values = {}", texts(values));
    }
    for (key, limit) in [("min", choice.min), ("max", choice.max)] {
        if let Some(limit) = limit {
            let _ = write!(out, ", {key} = {}", number(limit));
        }
    }
    if choice.except {
        out.push_str(", except = true");
    }
    format!("{{ {} }}", out.trim_start_matches(", "))
}
