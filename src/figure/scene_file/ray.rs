//! `ray` of a lens in scene files: its keys, read and written.

use glam::DVec2;

use crate::{
    figure::scene_file::{
        check::{Fields, Place},
        choice::{self, CHOICE},
        forms::{Degrees, Form, Same, Word},
        handled,
        keys::{FAR_M, Kind, Table, key},
        node::Data,
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    lens::{
        LensKind,
        ray::{Bend, Feature, Fisheye, FisheyeProjection, MOST_POINTS, RayLens, RayMethod, Sampling, SamplingRate},
    },
    shader::effect::AskedBy,
};

/// `ray` of a lens.
pub const RAY: Table = Table {
    name: "ray",
    doc: "Of a lens that bends rays: where it is in the picture, and what it does; see Lenses that bend rays.",
    keys: keys_of!(RAY_ROWS),
};

/// The row of what only some kinds have.
macro_rules! bend {
    ($key:expr, $form:ty, $pattern:pat => $place:expr) => {
        Row::<RayLens>::new(
            $key,
            |lens, _| match &lens.bend {
                $pattern => <$form as Form<_>>::data(&$place),
                _ => None,
            },
            |lens, given| {
                if let $pattern = &mut lens.bend {
                    <$form as Form<_>>::take(given.node, &mut $place);
                }
            },
        )
    };
}

const RAY_ROWS: &[Row<RayLens>] = &[
    field!(
        key(
            "center",
            Kind::PicturePlace,
            "[0.5, 0.5]",
            "",
            "Its middle: shares of the picture's width and height, from the left and from above. A feature lens stands where its feature is seen.",
            "[0.4, 0.6]"
        ),
        Same,
        |lens: RayLens| lens.center
    ),
    field!(
        key(
            "radius",
            Kind::Number { min: 0.001, max: 4.0 },
            "0.25; of a fisheye 0.5; of a feature lens 0.1",
            "picture heights",
            "From its middle to its rim; of a feature lens how wide the band around its core is.",
            "0.3",
        ),
        Same,
        |lens: RayLens| lens.radius
    ),
    field!(
        key(
            "outline",
            Kind::Word { now: &["circle", "square"], later: &[] },
            "\"circle\"",
            "",
            "Its outline in the picture; the edges of a square are along those of the picture.",
            "\"square\"",
        ),
        Word,
        |lens: RayLens| lens.outline
    ),
    Row::<RayLens>::new(
        key(
            "mask",
            Kind::Text,
            "none",
            "",
            "Of a magnifier: an image whose light pixels are its outline, in place of `outline`. Its middle is that of the lens, and its longer side twice `radius`.",
            "\"leaf.png\"",
        ),
        |lens, options| lens.mask.as_ref().map(|file| Data::Text(options.written(file))),
        |lens, given| lens.mask = given.file(),
    ),
    Row::<RayLens>::new(
        key(
            "magnification",
            Kind::Number { min: 0.1, max: 1000.0 },
            "2.5",
            "",
            "Of a magnifier, and of a feature lens: how many times as large its core shows what lies at `at` and beyond; below 1 it makes smaller. Of a sampling-rate lens: how densely it samples its middle, where its rim has 1.",
            "4.0",
        ),
        |lens, _| match &lens.bend {
            Bend::Sample(Sampling { rate: SamplingRate::Cubic(middle) }) => Some((*middle).into()),
            other => other.magnify().map(|magnify| magnify.magnification.into()),
        },
        |lens, given| match &mut lens.bend {
            Bend::Sample(Sampling { rate: SamplingRate::Cubic(number) }) => Same::take(given.node, number),
            other => {
                other.magnify_mut().into_iter().for_each(|magnify| Same::take(given.node, &mut magnify.magnification))
            }
        },
    ),
    Row::<RayLens>::new(
        key(
            "distance",
            Kind::Number { min: 0.001, max: FAR_M },
            "half of the way to what its middle shows",
            "metres",
            "Of a magnifier, and of a feature lens: from the eye to its plane, along the view axis. What is nearer stays as it is.",
            "40.0",
        ),
        |lens, _| lens.bend.magnify().and_then(|magnify| Same::data(&magnify.distance)),
        |lens, given| {
            lens.bend.magnify_mut().into_iter().for_each(|magnify| Same::take(given.node, &mut magnify.distance))
        },
    ),
    Row::<RayLens>::new(
        key(
            "at",
            Kind::Number { min: 0.001, max: FAR_M },
            "from its plane to what its middle shows",
            "metres",
            "Of a magnifier, and of a feature lens: from its plane, along the view axis, to where things are as much larger as `magnification` says; what is beyond is as much larger.",
            "60.0",
        ),
        |lens, _| lens.bend.magnify().and_then(|magnify| Same::data(&magnify.at)),
        |lens, given| lens.bend.magnify_mut().into_iter().for_each(|magnify| Same::take(given.node, &mut magnify.at)),
    ),
    bend!(
        key(
            "border",
            Kind::Number { min: 0.0, max: 1.0 },
            "0.4",
            "",
            "Of a magnifier: how wide the band inside of its rim is, a share of the radius, in which what lies around its core is compressed, so that nothing is lost. 0: there is none, and the core hides it.",
            "0.25",
        ),
        Same,
        Bend::Magnify(magnify) => magnify.border
    ),
    Row::<RayLens>::new(
        key(
            "of",
            Kind::Table(&CHOICE),
            "must be given for a feature lens",
            "",
            "Of a feature lens: the city objects that it magnifies. Its core is where rays to its focal point meet them, in whatever shape; rays find back over `radius` around it.",
            "{ ids = [\"town-hall\"] }",
        ),
        |lens, options| match &lens.bend {
            Bend::Feature(Feature { of, .. }) => Some(choice::written(of, options)),
            _ => None,
        },
        |lens, given| {
            if let Bend::Feature(Feature { of, .. }) = &mut lens.bend {
                let own = given.table(&CHOICE);
                *of = choice::read(given.reader, &own);
            }
        },
    ),
    bend!(
        key(
            "rate",
            Kind::PlanPoints(2),
            "from `magnification` smoothly to 1",
            "",
            "Of a sampling-rate lens: points `[share of the radius, rate]` of how densely it samples, straight in between: the first at 0, the last at 1.",
            "[[0.0, 4.0], [0.5, 3.0], [1.0, 1.0]]",
        ),
        Rate,
        Bend::Sample(sampling) => sampling.rate
    ),
    bend!(
        key(
            "angle_deg",
            Kind::Number { min: 1.0, max: 360.0 },
            "180",
            "degrees",
            "Of a fisheye: the angle from rim to rim; of a hemispherical one 180 at most.",
            "220.0",
        ),
        Degrees,
        Bend::Fisheye(fisheye) => fisheye.angle
    ),
    bend!(
        key(
            "projection",
            Kind::Word { now: &["angular", "hemispherical"], later: &[] },
            "\"angular\"",
            "",
            "Of a fisheye: how angles from its axis lie in it: by themselves, or by their sines, as a half ball looks.",
            "\"hemispherical\"",
        ),
        Word,
        Bend::Fisheye(fisheye) => fisheye.projection
    ),
    Row::<RayLens>::new(
        key(
            "bend",
            Kind::Handler,
            "must be given for a lens of kind = \"ray\"",
            "",
            "Of a lens of kind `ray`: a ray handler of your own, which says what is seen at each place of the lens, and its parameters; see Effects of your own (effects.md).",
            "{ kind = \"swirl\" }",
        ),
        |lens, _| match &lens.bend {
            Bend::Own(used) => Some(handled::written(used)),
            _ => None,
        },
        |lens, given| {
            if let Bend::Own(used) = &mut lens.bend {
                let place = given.fields.place.within(given.key, given.node.line);
                if let Some(found) = handled::required(given.reader, given.node, &place, AskedBy::Rays) {
                    *used = found;
                }
            }
        },
    ),
    field!(
        key(
            "method",
            Kind::Word { now: &["rays", "image", "vertices"], later: &[] },
            "\"rays\"",
            "",
            "How what it shows is found: by exact `rays` through the triangles; or by a look into an `image` of what the eye sees without it, which needs no hierarchy over the city, and where what is hidden is missing; or by moving the `vertices` of the city's triangles, cut into smaller ones, to where it shows them.",
            "\"image\"",
        ),
        Word,
        |lens: RayLens| lens.method
    ),
    field!(
        key(
            "fineness",
            Kind::Number { min: 0.1, max: 8.0 },
            "1",
            "",
            "Of a `method` other than rays, how finely: texels of the image to a pixel, along an axis, where the lens magnifies most; or how many times shorter the sides of triangles are than 12 pixels.",
            "2.0",
        ),
        Same,
        |lens: RayLens| lens.fineness
    ),
    Row::<RayLens>::new(
        key(
            "only",
            Kind::Table(&CHOICE),
            "all of the city",
            "",
            "The city objects that it acts on; the others are seen as without it. Not of a feature lens, and only by `rays`.",
            "{ types = [\"Building\"] }",
        ),
        |lens, options| lens.only.as_ref().map(|only| choice::written(only, options)),
        |lens, given| {
            let own = given.table(&CHOICE);
            lens.only = Some(choice::read(given.reader, &own));
        },
    ),
    field!(
        key(
            "grid",
            Kind::Boolean,
            "false",
            "",
            "Whether a grid that is square without it is drawn over what it shows.",
            "true"
        ),
        Same,
        |lens: RayLens| lens.grid
    ),
];

/// A drawn rate.
struct Rate;

impl Form<SamplingRate> for Rate {
    fn data(rate: &SamplingRate) -> Option<Data> {
        match rate {
            SamplingRate::Cubic(_) => None,
            SamplingRate::Points(points) => Some(Data::list(points.iter().copied())),
        }
    }

    fn take(node: &crate::figure::scene_file::node::Node, into: &mut SamplingRate) {
        let points: Option<Vec<DVec2>> =
            node.list().map(|all| all.iter().filter_map(|p| p.numbers::<2>().map(DVec2::from)).collect());
        if let Some(points) = points.filter(|points| rate_problem(points).is_none()) {
            *into = SamplingRate::Points(points);
        }
    }
}

/// The least rate of a drawn one.
const LEAST_RATE: f64 = 0.01;

/// What is wrong with a drawn rate.
fn rate_problem(points: &[DVec2]) -> Option<String> {
    let ascends = points.windows(2).all(|pair| pair[0].x < pair[1].x);
    let [first, last] = [points.first()?.x, points.last()?.x];
    if points.len() > MOST_POINTS {
        return Some(format!("has {} points; {MOST_POINTS} at most would be right", points.len()));
    }
    if !(ascends && first == 0.0 && last == 1.0) {
        return Some("must go from 0 to 1, ascending, in the first number of its points".to_owned());
    }
    let low = points.iter().find(|p| !(LEAST_RATE..=1000.0).contains(&p.y))?;
    Some(format!("has a rate of {}; {LEAST_RATE} to 1000 would be right", low.y))
}

/// The keys that only some kinds have, and the words of these.
const OF_KINDS: [(&str, &[&str]); 13] = [
    ("bend", &["ray"]),
    ("mask", &["magnifier"]),
    ("magnification", &["magnifier", "feature", "sampling"]),
    ("distance", &["magnifier", "feature"]),
    ("at", &["magnifier", "feature"]),
    ("of", &["feature"]),
    ("only", &["magnifier", "sampling", "fisheye", "ray"]),
    ("center", &["magnifier", "sampling", "fisheye", "ray"]),
    ("outline", &["magnifier", "sampling", "fisheye", "ray"]),
    ("border", &["magnifier"]),
    ("rate", &["sampling"]),
    ("angle_deg", &["fisheye"]),
    ("projection", &["fisheye"]),
];

/// The keys of a lens that one that bends rays does not have: where it is, `ray` says.
const NOT_GIVEN: [&str; 6] = ["shape", "shapes", "placement", "attached_to", "above_ground", "space"];

/// What a lens that bends rays does; what is wrong is noted.
pub fn read(reader: &mut Reader, fields: &Fields, kind: &LensKind) -> Option<RayLens> {
    let Some(ray) = kind.ray() else {
        if fields.given("ray") {
            let message = "has a meaning only for a lens of kind = \"magnifier\", \"feature\", \"sampling\", \"fisheye\" or \"ray\"";
            reader.checker.note(&fields.place, "ray", fields.line("ray"), message);
        }
        return None;
    };
    for key in NOT_GIVEN.into_iter().filter(|key| fields.given(key)) {
        let message = format!("has no meaning for a lens of kind = \"{}\": ray says where it is", kind.word());
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
    let mut ray = ray.clone();
    let needed = match kind {
        LensKind::Feature(_) => {
            Some(("of", "is missing: what the lens magnifies. For example of = { ids = [\"ID\"] }"))
        }
        LensKind::Ray(_) => {
            Some(("bend", "is missing: a ray handler of your own. For example bend = { kind = \"NAME\" }"))
        }
        _ => None,
    };
    let must = |reader: &mut Reader, place: &Place, line, given: &dyn Fn(&str) -> bool| {
        if let Some((key, message)) = needed.filter(|(key, _)| !given(key)) {
            reader.checker.note(place, key, line, message);
        }
    };
    let Some(node) = fields.node("ray") else {
        must(reader, &fields.place.within("ray", fields.place.line), fields.place.line, &|_| false);
        return Some(ray);
    };
    let own = reader.checker.fields(node, &RAY, &[], fields.place.within("ray", node.line));
    row::read(RAY_ROWS, &own, reader, &mut ray);
    must(reader, &own.place, node.line, &|key| own.given(key));
    if matches!(kind, LensKind::Ray(_)) && ray.method == RayMethod::Vertices {
        let message = "does not go with a handler of your own: where it shows corners, it does not say";
        reader.checker.note(&own.place, "method", own.line("method"), message);
    }
    for (key, kinds) in OF_KINDS.into_iter().filter(|(key, kinds)| own.given(key) && !kinds.contains(&kind.word())) {
        let all = kinds.iter().map(|kind| format!("\"{kind}\"")).collect::<Vec<_>>().join(" or ");
        let message = format!("has a meaning only for a lens of kind = {all}");
        reader.checker.note(&own.place, key, own.line(key), message);
    }
    if own.given("only") && ray.method != RayMethod::Rays {
        let message = "goes with method = \"rays\" alone: others do not tell objects apart";
        reader.checker.note(&own.place, "only", own.line("only"), message);
    }
    if own.given("mask") && own.given("outline") {
        let message = "is given together with outline: a lens has one of them";
        reader.checker.note(&own.place, "mask", own.line("mask"), message);
    }
    if (own.given("mask") || own.given("of")) && fields.given("effects") {
        let message = "has no meaning for a lens that bends rays in an outline of its own: another lens may have some";
        reader.checker.note(&fields.place, "effects", fields.line("effects"), message);
    }
    if let Some(points) = own.node("rate").and_then(|node| node.list()) {
        let points: Vec<DVec2> = points.iter().filter_map(|p| p.numbers::<2>().map(DVec2::from)).collect();
        if let Some(message) = rate_problem(&points) {
            reader.checker.note(&own.place, "rate", own.line("rate"), message);
        }
        if own.given("magnification") {
            let message = "is given together with magnification: a rate is one of them";
            reader.checker.note(&own.place, "rate", own.line("rate"), message);
        }
    }
    if let Bend::Fisheye(Fisheye { angle, projection }) = &ray.bend
        && *projection == FisheyeProjection::Hemispherical
        && *angle > std::f64::consts::PI + 1e-9
    {
        let message = "must be 180 at most where projection is \"hemispherical\": a half ball shows no more";
        reader.checker.note(&own.place, "angle_deg", own.line("angle_deg"), message);
    }
    Some(ray)
}

/// The table of a lens' rays.
pub fn written(ray: &RayLens, kind: &LensKind, options: &Options) -> Option<Data> {
    let default = LensKind::of_word(kind.word())?;
    Some(row::written(RAY_ROWS, ray, default.ray()?, options))
}
