//! Shapes of lenses in scene files, read.

use std::path::PathBuf;

use glam::{DVec2, DVec3};

use crate::{
    figure::scene_file::{
        check::{Fields, Place},
        choice::{self, refuse},
        handled, keys,
        node::{Data, Node},
        reader::Reader,
        shape_keys::{OWN, SHAPES, kind_of},
    },
    geom::{Shape, shape::FlatFigure, shape::solid::prism},
    lens::{Region, nearest::did_you_mean},
    shader::effect::{AskedBy, asked_for},
};

/// A shape of its table; `None` where something is wrong (and noted).
pub fn read(reader: &mut Reader, node: &Node, place: &Place) -> Option<Region> {
    let Data::Table(entries) = &node.data else {
        reader.checker.note(
            place,
            "",
            node.line,
            format!("must be a table {{ kind = ..., ... }}, is {}", node.quoted()),
        );
        return None;
    };
    let kind = entries.iter().find(|(k, ..)| k == "kind").map(|(.., n)| n);
    let own = || asked_for(AskedBy::Shapes).map(|handler| handler.name.as_str());
    let names = || SHAPES.iter().map(|own| own.name).chain(own());
    let all = names().collect::<Vec<_>>().join(", ");
    let Some(own) = kind.and_then(Node::text).and_then(kind_of) else {
        if let Some(region) = own_region(reader, node, entries, place) {
            return region;
        }
        let (line, message) = match kind {
            None => (node.line, format!("is missing: one of {all}")),
            Some(n) => {
                let hint = did_you_mean(n.text().unwrap_or_default(), names());
                (n.line, format!("must be one of {all}, is {}{hint}", n.quoted()))
            }
        };
        reader.checker.note(place, "kind", line, message);
        return None;
    };
    let fields = reader.checker.fields(node, &own.table, &[], place.clone());
    let region = match (own.default)() {
        blank @ (Region::Combined { .. } | Region::Enclosed { .. }) => return parts(reader, &fields, blank),
        Region::Prism { .. } => mask(reader, &fields)?,
        Region::Objects(_) => Region::Objects(choice::read(reader, &fields)),
        Region::Thematic(_) => Region::Thematic(choice::read(reader, &fields)),
        Region::Shape(Shape::Flat { .. }) => {
            one_figure(reader, &fields);
            with_figure(&fields, own.read(&fields, reader)?)?
        }
        _ => {
            let region = own.read(&fields, reader)?;
            with_files(reader, &fields, region)?
        }
    };
    check(reader, &fields, &region);
    Some(region)
}

/// The region test of a user's; `None`: there is none of that name.
fn own_region(
    reader: &mut Reader,
    node: &Node,
    entries: &[(String, u32, Node)],
    place: &Place,
) -> Option<Option<Region>> {
    let others: Vec<&str> = std::iter::once("kind").chain(keys::names(&OWN.table)).collect();
    let used = handled::read_beside(reader, node, place, AskedBy::Shapes, &others)?;
    let of_box = entries.iter().filter(|(key, ..)| key != "kind" && others.contains(&key.as_str())).cloned();
    let of_box = Node { data: Data::Table(of_box.collect()), line: node.line };
    let fields = reader.checker.fields(&of_box, &OWN.table, &[], place.clone());
    let read = OWN.read(&fields, reader);
    Some(read.map(|region| match region {
        Region::Own { center, size, rotation, .. } => Region::Own { used, center, size, rotation },
        other => other,
    }))
}

/// Notes what the shape itself finds wrong with it.
fn check(reader: &mut Reader, fields: &Fields, region: &Region) {
    if let Region::Shape(shape) = region {
        if let Err(error) = shape.check() {
            let key = ["points", "planes"].into_iter().find(|key| fields.given(key)).unwrap_or("");
            reader.checker.note(&fields.place, key, fields.place.line, error.to_string());
        }
    } else if let Some((key, message)) = region.check() {
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
}

/// The same with the files that it is made of.
fn with_files(reader: &mut Reader, fields: &Fields, region: Region) -> Option<Region> {
    Some(match region {
        Region::Mesh { at, rotation, scale, .. } => {
            Region::Mesh { file: reader.file(fields, "file")?, at, rotation, scale }
        }
        Region::Sprite { .. } => Region::Sprite { file: reader.file(fields, "file")? },
        Region::Mask3d { corner, size, .. } => {
            let nodes = fields.node("images").and_then(Node::list)?;
            if nodes.is_empty() {
                reader.checker.note(&fields.place, "images", fields.line("images"), "must name at least one image");
            }
            let path = |(i, node)| reader.path(fields, &format!("images.{i}"), node);
            let images: Vec<Option<PathBuf>> = nodes.iter().enumerate().map(path).collect();
            Region::Mask3d { images: images.into_iter().collect::<Option<_>>()?, corner, size }
        }
        other => other,
    })
}

/// Notes a flat lens that has no figure, or several.
fn one_figure(reader: &mut Reader, fields: &Fields) {
    let given: Vec<&str> = ["radius", "size", "points"].into_iter().filter(|key| fields.given(key)).collect();
    let message = match given[..] {
        [_] => return,
        [] => "is missing: a flat lens has a radius, a size = [width, height] or points".to_owned(),
        [first, ..] => format!("is given together with {first}: a flat lens has one figure"),
    };
    reader.checker.note(&fields.place, given.last().unwrap_or(&"radius"), fields.place.line, message);
}

/// A flat lens with its figure.
fn with_figure(fields: &Fields, flat: Region) -> Option<Region> {
    let Region::Shape(Shape::Flat { center, rotation, .. }) = flat else { return Some(flat) };
    let figure = if let Some(radius) = fields.number("radius") {
        FlatFigure::Disc { radius }
    } else if let Some(size) = fields.node("size").and_then(plan) {
        FlatFigure::Rectangle { size }
    } else {
        FlatFigure::Polygon { points: ring(fields.node("points")?)? }
    };
    Some(Shape::Flat { center, rotation, figure }.into())
}

/// What a combination or an enclosure is made of.
fn parts(reader: &mut Reader, fields: &Fields, blank: Region) -> Option<Region> {
    let nodes = fields.node("shapes").and_then(Node::list)?;
    let part = |(i, node): (usize, &Node)| read(reader, node, &fields.place.within(&format!("shapes.{i}"), node.line));
    let parts: Vec<Region> = nodes.iter().enumerate().filter_map(part).collect();
    let whole = fields.boolean("whole").unwrap_or(false);
    let types = fields.node("types").and_then(Node::list).unwrap_or_default();
    if fields.given("types") && types.is_empty() {
        reader.checker.note(&fields.place, "types", fields.line("types"), "must name at least one type");
    }
    let types = types.iter().filter_map(|n| n.text().map(str::to_owned)).collect();
    (parts.len() == nodes.len()).then_some(match blank {
        Region::Combined { how, .. } => Region::Combined { how, parts },
        _ => Region::Enclosed { parts, whole, types },
    })
}

/// What stands over a polygon, or over the light pixels of an image.
fn mask(reader: &mut Reader, fields: &Fields) -> Option<Region> {
    let (base, height) = (fields.number("base"), fields.number("height"));
    match (fields.given("image"), fields.given("points")) {
        (true, false) => {
            for key in ["corner", "size"].into_iter().filter(|key| !fields.given(key)) {
                let message = "is missing: an image needs corner = [x, y] (its south-west corner) and size = [width, height] in metres";
                reader.checker.note(&fields.place, key, fields.place.line, message);
            }
            refuse(reader, fields, &["holes"], "has a meaning only with points");
            let image = reader.file(fields, "image")?;
            Some(Region::Mask {
                image,
                corner: plan(fields.node("corner")?)?,
                size: plan(fields.node("size")?)?,
                base: base?,
                height: height?,
            })
        }
        (false, true) => {
            refuse(reader, fields, &["corner", "size"], "has a meaning only with image");
            let rings = fields.node("holes").and_then(Node::list).unwrap_or_default();
            let points = ring(fields.node("points")?)?;
            let holes: Vec<_> = rings.iter().filter_map(ring).collect();
            let (base, height) = (base?, height?);
            let rings: Vec<_> = std::iter::once(&points).chain(&holes).cloned().collect();
            let origin = points.first().map_or(DVec3::ZERO, |p| p.round().extend(base));
            // Its height says nothing of the polygon.
            if let Err(error) = prism(&rings, base, height.max(1.0), origin) {
                reader.checker.note(&fields.place, "points", fields.line("points"), error.to_string());
            }
            Some(Region::Prism { points, holes, base, height })
        }
        (both, _) => {
            let message = match both {
                true => "is given together with points: a mask is one of them",
                false => "is missing: give image = \"FILE\" or points = [[x, y], ...]",
            };
            reader.checker.note(&fields.place, "image", fields.line("image"), message);
            None
        }
    }
}

fn plan(node: &Node) -> Option<DVec2> {
    node.numbers::<2>().map(DVec2::from)
}

fn ring(node: &Node) -> Option<Vec<DVec2>> {
    node.list()?.iter().map(plan).collect()
}
