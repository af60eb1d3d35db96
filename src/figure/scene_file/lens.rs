//! `[[lens]]` in scene files.

use crate::{
    figure::scene_file::{
        best_view::{self, LOOK},
        check::Fields,
        choice::CHOICE,
        content::{self, CONTENT},
        deformation::{self, CONTROL, CONTROL_WORDS},
        effects::{self, without_sights},
        epoch,
        forms::{Color, Same, Word, lens_color},
        keys::{Kind, Table, key},
        node::{Data, Node},
        occlusion,
        paths::Options,
        ray::{self, RAY},
        reader::Reader,
        region, rendering,
        row::{self, Row, field, keys_of},
        shape_keys,
        sprite::{self, SPRITE},
    },
    lens::{Border, BorderUnit, Discrete, Lens, LensKind, Placement, Region, best_view::Depiction},
    scene::above_ground::heights_of_lens,
};

/// `[[lens]]`.
pub const LENS: Table = Table {
    name: "lens",
    doc: "A lens: where it acts (`shape`, or `shapes` for several) and what it does (`effects`); a lens with an overlay has a `view`, an `image` or a `text` instead.",
    keys: keys_of!(LENS_ROWS),
};

const LENS_ROWS: &[Row<Lens>] = &[
    field!(
        key("name", Kind::Text, "`lens-N`, N its place in the file", "", "Its name, unique.", "\"old town\""),
        Same,
        |lens: Lens| lens.name
    )
    .always(),
    Row::<Lens>::joint(
        key(
            "kind",
            Kind::Word {
                now: LensKind::WORDS,
                later: &[],
            },
            "\"color\"",
            "",
            "What kind of lens it is: `color` restyles what is in it, `content` shows something else in it, `occlusion` draws the city objects that hide a point of interest so that it can be seen, see Occlusion lenses, `deformation` moves what is in it, see Deformation lenses, `time` shows another moment in it, see Time, `magnifier`, `feature`, `sampling` and `fisheye` bend the rays that come through them, and so does `ray`, by a handler of your own, see Lenses that bend rays. The others have an overlay in place of a shape, see Best-view lenses: `annotation` an image or a text, `best-view` the city from an eye of its own, `map-view` a map, `worldlet` a small model, `see-through` and `portal` another place.",
            "\"color\"",
        ),
        |lens, _| Some(lens.kind.word().into()),
    )
    .always(),
    field!(
        key("enabled", Kind::Boolean, "true", "", "`false`: it keeps its place and its bit in the lens mask, and does nothing.", "false",),
        Same,
        |lens: Lens| lens.enabled
    ),
    field!(
        key(
            "color",
            Kind::Color,
            "a colour of its own by its place",
            "",
            "Its own colour: its outline, its line in a legend.",
            "\"#0072b2\"",
        ),
        Color,
        |lens: Lens| lens.color
    ),
    Row::<Lens>::joint(
        key(
            "placement",
            Kind::Word { now: &["scene", "camera"], later: &[] },
            "\"scene\"",
            "",
            "What its shapes are fixed to: the `scene`, or the `camera`, with which they move and in whose view alone they act; see Placement.",
            "\"camera\"",
        ),
        |lens, _| (lens.placement == Placement::Camera).then(|| "camera".into()),
    ),
    Row::<Lens>::joint(
        key(
            "attached_to",
            Kind::Table(&ATTACHED_TO),
            "nothing: model coordinates",
            "",
            "A city object or a point of interest, whose middle the coordinates of its shapes are counted from.",
            "{ poi = \"hall\" }",
        ),
        |lens, _| match &lens.placement {
            Placement::Object(id) => Some(Data::table([("object", id.into())])),
            Placement::Poi(name) => Some(Data::table([("poi", name.into())])),
            Placement::World | Placement::AboveGround | Placement::Camera => None,
        },
    ),
    Row::<Lens>::joint(
        key(
            "above_ground",
            Kind::Boolean,
            "false",
            "",
            "Whether the heights of its shapes, and of the way of a `route`, are metres above the ground at each; see Heights above the ground.",
            "true",
        ),
        |lens, _| (lens.placement == Placement::AboveGround).then(|| true.into()),
    ),
    Row::<Lens>::joint(
        key(
            "shape",
            Kind::Shape,
            "",
            "",
            "Its focus area; see Shapes. Or `shapes`. An occlusion lens needs none; with one it acts on what of its occluders is in it.",
            "{ kind = \"sphere\", center = [0, 0, 0], radius = 60.0 }",
        ),
        |lens, options| match &shapes_of(lens)[..] {
            [one] => shape_keys::written(one, options),
            _ => None,
        },
    )
    .always()
    .after("fade"),
    Row::<Lens>::joint(
        key(
            "shapes",
            Kind::Shapes,
            "none",
            "",
            "Several focus areas: it acts inside any of them.",
            "[{ kind = \"sphere\", center = [0, 0, 0], radius = 60.0 }]",
        ),
        several,
    )
    .always()
    .after("shape"),
    Row::<Lens>::joint(
        key("effects", Kind::Effects, "none", "", "What it does, in order: names, or tables with parameters; see Effects. At most one scene style.", "[\"sepia\"]"),
        |lens, _| effects::listed(&lens.effects),
    )
    .after("poi_effects"),
    Row::<Lens>::joint(
        key(
            "time",
            Kind::Operators,
            "the moment that shows below",
            "",
            "Which moment shows in it, of the one that shows below it: time operators, one after the other; see Time. A lens of any kind may have some, a `time` lens must. Of a lens with an overlay, which moment its view shows.",
            "[{ op = \"set\", at = \"1650\" }]",
        ),
        |lens, _| epoch::written(&lens.time),
    ),
    Row::<Lens>::joint(
        key("poi", Kind::Names, "none", "", "The name of a `[[poi]]`, or several. Of an occlusion lens: what shall be seen; it never hides itself. Of a lens with an overlay: what the overlay is tied to by context lines; a view is of the first of them.", "\"hall\""),
        |lens, options| lens.best_view().and_then(best_view::pois).or_else(|| occluders(lens, "poi", options)),
    ),
    Row::<Lens>::joint(
        key(
            "view",
            Kind::View,
            "by its kind",
            "",
            "The eye that the overlay of a best-view lens, a map or another view is seen from; see Views.",
            "{ kind = \"best\", normal = [0, -1, 0.5] }",
        ),
        |lens, options| lens.best_view().and_then(|shown| best_view::view(&lens.kind, shown, options)),
    ),
    Row::<Lens>::joint(
        key("image", Kind::Text, "none", "", "Of an annotation: the image that it shows, PNG or JPEG.", "\"photo.png\""),
        |lens, options| match &lens.best_view()?.depiction {
            Depiction::Image(file) => Some(Data::Text(options.written(file))),
            _ => None,
        },
    ),
    Row::<Lens>::joint(
        key("text", Kind::Text, "none", "", "Of an annotation: the text that it shows; `\\n` begins a line.", "\"Town hall\\n1893\""),
        |lens, _| match &lens.best_view()?.depiction {
            Depiction::Text(text) => Some(text.into()),
            _ => None,
        },
    ),
    Row::<Lens>::joint(
        key(
            "lenses",
            Kind::Texts,
            "all that act in every view",
            "",
            "The lenses that act in its view, by name; those that have overlays stand in its overlay as overlays. An empty list: none.",
            "[\"old town\"]",
        ),
        |lens, _| Some(Data::list(lens.best_view()?.lenses.as_ref()?)),
    ),
    Row::<Lens>::joint(
        key(
            "look",
            Kind::Table(&LOOK),
            "as the scene",
            "",
            "How its view looks, in place of the `[style]` of the scene.",
            "{ base = \"clay\" }",
        ),
        |lens, options| lens.best_view().and_then(|shown| best_view::look(shown, options)),
    ),
    Row::<Lens>::joint(
        key(
            "test",
            Kind::Test,
            "{ kind = \"exact\" }",
            "",
            "Of an occlusion lens: when a city object hides something; see Detection tests.",
            "{ kind = \"exact\", coverage = 0.05 }",
        ),
        |lens, options| occluders(lens, "test", options),
    ),
    Row::<Lens>::joint(
        key(
            "force",
            Kind::Table(&CHOICE),
            "none",
            "",
            "Of an occlusion lens: city objects that hide something whatever the test says; never those of `poi`.",
            "{ attribute = \"measuredHeight\", min = 60.0 }",
        ),
        |lens, options| occluders(lens, "force", options),
    ),
    Row::<Lens>::joint(
        key(
            "forbid",
            Kind::Table(&CHOICE),
            "none",
            "",
            "Of an occlusion lens: city objects that stay as they are whatever the test and `force` say.",
            "{ ids = [\"town-hall\"] }",
        ),
        |lens, options| occluders(lens, "forbid", options),
    ),
    Row::<Lens>::joint(
        key(
            "margin",
            Kind::Number { min: 0.0, max: 1000.0 },
            "1.0",
            "metres",
            "Of an occlusion lens, in animations: how far an occluder must leave the test before it ceases to be one; 0: at once. See Animations.",
            "5.0",
        ),
        |lens, options| occluders(lens, "margin", options),
    ),
    Row::<Lens>::joint(
        key(
            "fade",
            Kind::Number { min: 0.0, max: 60.0 },
            "0.3",
            "seconds",
            "Of an occlusion lens, in animations: how long what becomes an occluder, or ceases to be one, takes to change; 0: at once.",
            "0.5",
        ),
        |lens, options| occluders(lens, "fade", options),
    ),
    Row::<Lens>::joint(
        key(
            "render",
            Kind::Rendering,
            "\"discard\"",
            "",
            "Of an occlusion lens: how occluders are drawn, by a word, a word with parameters, or by cases; see Renderings. Or a list of effects, as `effects` takes them. `effects` come after.",
            "{ as = \"x-ray\", exponent = 0.8 }",
        ),
        |lens, options| lens.rendering().map(|render| rendering::written(render, options)),
    ),
    Row::<Lens>::joint(
        key(
            "poi_effects",
            Kind::Effects,
            "none",
            "",
            "Of an occlusion lens: effects on the points of interest that are city objects, parts included, after all else.",
            "[{ effect = \"overlay\", color = \"#e08a3c\", opacity = 0.4 }]",
        ),
        |lens, _| effects::listed(&lens.rendering()?.poi_effects),
    ),
    Row::<Lens>::joint(
        key(
            "deform",
            Kind::Steps,
            "must be given for a deformation lens",
            "",
            "Of a deformation lens: what it does with space, one step after the other; see Deformation lenses.",
            "[{ kind = \"twist\", angle_deg = 90.0 }, { kind = \"taper\", factor = 0.5 }]",
        ),
        |lens, options| lens.deform().map(|deform| deformation::steps_data(deform, options)),
    )
    .after("look"),
    Row::<Lens>::joint(
        key(
            "control",
            Kind::WordOrTable(CONTROL_WORDS, &CONTROL),
            "\"smooth\"; over a cylinder or a sphere \"bump\"",
            "",
            "Of a deformation lens: how strong it is over the base of its focus area; along the border it is 0.",
            "{ profile = \"smooth\", border = 0.1 }",
        ),
        |lens, options| deformation::control_data(lens.deform()?, options),
    )
    .after("deform"),
    Row::<Lens>::joint(
        key("strength", Kind::Number { min: 0.0, max: 1.0 }, "1.0", "", "Of a deformation lens: how much of it; ways, angles and factors are that much of what is given.", "0.5"),
        |lens, _| {
            lens.deform().map(|deform| deform.strength).filter(|strength| *strength != 1.0).map(Data::from)
        },
    )
    .after("control"),
    Row::<Lens>::joint(
        key(
            "ray",
            Kind::Table(&RAY),
            "by its kind",
            "",
            "Of a lens that bends rays: where it is in the picture, and what it does; see Lenses that bend rays.",
            "{ center = [0.5, 0.5], radius = 0.3, magnification = 3.0 }",
        ),
        |lens, options| lens.ray().and_then(|own| ray::written(own, &lens.kind, options)),
    )
    .after("strength"),
    Row::<Lens>::joint(
        key(
            "content",
            Kind::Table(&CONTENT),
            "what is below",
            "",
            "What it shows in itself in place of what is below it; a lens of any kind may have some, a `content` lens must.",
            "{ lod = \"1.2\" }",
        ),
        |lens, options| lens.content().map(|content| content::written(content, options)),
    ),
    Row::<Lens>::joint(
        key(
            "clip",
            Kind::Word { now: &["order", "merge", "discard"], later: &[] },
            "\"order\"; \"merge\" where the content has `only`",
            "",
            "Where its content shows, what becomes of what is below, the context and contents of lower lenses: by `order` it is clipped; with `merge` it stays and the content is added; with `discard` nothing shows, neither, where a lower lens shows another content.",
            "\"merge\"",
        ),
        |lens, _| {
            lens.content()
                .filter(|content| content.clip != content.usual_clip())
                .map(|content| content.clip.word().into())
        },
    ),
    Row::<Lens>::new(
        key(
            "space",
            Kind::Word { now: &["displayed", "rest"], later: &[] },
            "\"displayed\"",
            "",
            "Which position of a surface counts where a deformation moves it: that at which it is shown, or with `rest` that of the city as it is. Then the lens goes with the houses: its body is moved as they are, to a thousandth of its size. Changed heights of objects (`heights`, `lower`) do not move it.",
            "\"rest\"",
        ),
        |lens, _| lens.at_rest.then(|| REST.into()),
        |lens, given| lens.at_rest = given.node.text() == Some(REST),
    )
    .after("shadows"),
    field!(
        key(
            "body",
            Kind::Word { now: &["outline", "shell", "halo", "none"], later: &[] },
            "\"outline\"; of an occlusion lens \"none\"",
            "",
            "How the lens body itself is drawn, in its colour: a line around it, 1.2 points wide and at most 8 pixels, tinted glass, a glow of 13.5 points around it. Thematic and occlusion lenses show a line for all, and so do flat ones and those tested by a sprite for `halo`.",
            "\"none\"",
        ),
        Word,
        |lens: Lens| lens.body
    ),
    Row::<Lens>::joint(
        key(
            "sprite",
            Kind::Table(&SPRITE),
            "none: from its shapes",
            "",
            "Has the lens tested by a volumetric depth sprite of it.",
            "{ resolution = 512 }",
        ),
        |lens, options| lens.sprite.as_ref().map(|sprite| sprite::written(sprite, options)),
    ),
    Row::<Lens>::new(
        key(
            "border",
            Kind::Table(&BORDER),
            "none: it ends at once",
            "",
            "Has what the lens does end gradually.",
            "{ width = 20.0 }",
        ),
        |lens, options| lens.border.as_ref().map(|border| row::written(BORDER_ROWS, border, &HARD, options)),
        |lens, given| {
            let own = given.table(&BORDER);
            let mut border = HARD;
            row::read(BORDER_ROWS, &own, given.reader, &mut border);
            lens.border = Some(border);
        },
    ),
    field!(
        key("shadows", Kind::Boolean, "false", "", "Whether what the lens takes away, sees through or replaces still casts the shadow that it has without the lens. Otherwise shadows are those of what is there: an erased or translucent building casts none, one that is flattened or shown as something else that of its new form.", "true",),
        Same,
        |lens: Lens| lens.keeps_shadows
    ),
    field!(
        key(
            "section",
            Kind::Color,
            "none: what is cut is hollow",
            "",
            "The colour of sections: where the lens takes part of a closed body away, or shows part of one, its surface closes what is left. See Sections.",
            "\"#9c4a3c\"",
        ),
        Color,
        |lens: Lens| lens.section
    ),
];

/// What counts a surface where the city has it at rest.
const REST: &str = "rest";
/// A border that ends at once.
const HARD: Border = Border { width: 0.0, unit: BorderUnit::Metres, discrete: Discrete::Threshold };

/// `attached_to` of a lens.
pub const ATTACHED_TO: Table = Table {
    name: "attached_to",
    doc: "What a lens is attached to: exactly one of `object` and `poi`. The coordinates of its shapes are counted from there, \
          along the model's axes: `center = [0, 0, 0]` is the middle of it.",
    keys: &[
        key(
            "object",
            Kind::Text,
            "none",
            "",
            "Id of a city object: the middle of the box (edges along x, y, z) around all of its geometry, of every level of detail, and that of its parts.",
            "\"NL.IMBAG.Pand.0503100000031316\"",
        ),
        key(
            "poi",
            Kind::Text,
            "none",
            "",
            "Name of a point of interest: its point, or the middle of its object, as above.",
            "\"hall\"",
        ),
    ],
};

/// `border` of a lens.
pub const BORDER: Table = Table {
    name: "border",
    doc: "Has what a lens does fade over its border, half of the width inside of the volume and half outside. Of what is `inside`, \
          the degree of interest w(d) = t²(3−2t), t = ½ − d/width clamped to 0..1, d the distance from the lens' surface, negative inside; \
          of what is in front, behind and the rest, 1 − w. Distances are exact to rounding but for combinations (where parts meet they are \
          the larger or smaller of theirs) and solids whose bodies cross. Flat lenses fade across their outline, not at their plane; thematic ones \
          have no border. Masks and statistics go by the volume itself.",
    keys: keys_of!(BORDER_ROWS),
};

const BORDER_ROWS: &[Row<Border>] = &[
    field!(
        key(
            "width",
            Kind::Number { min: 0.0, max: 100_000.0 },
            "",
            "metres or pixels",
            "From where all of it is seen to where nothing is; 0 ends at once.",
            "20.0",
        ),
        Same,
        |border: Border| border.width
    ),
    field!(
        key(
            "unit",
            Kind::Word { now: &["m", "px", "ray"], later: &[] },
            "\"m\"",
            "",
            "Of the width: metres, or pixels at the distance of what is shown. `ray`: metres along the ray, and nothing fades: all of what the lens does is seen where what is shown lies within half the width of where its ray first enters or last leaves the volume, before or behind it, and nowhere else. So a lens acts on a skin, where it meets the city. Tested by a sprite, half the width should be no less than a step of its format.",
            "\"px\"",
        ),
        Word,
        |border: Border| border.unit
    ),
    field!(
        key(
            "discrete",
            Kind::Word { now: &["threshold", "dither"], later: &[] },
            "\"threshold\"",
            "",
            "How what cannot be had by halves ends, like the eraser: at the surface of the volume, or pixel by pixel; with 16 samples and more that is smooth.",
            "\"dither\"",
        ),
        Word,
        |border: Border| border.discrete
    ),
];

/// The shapes that a lens has keys for.
fn shapes_of(lens: &Lens) -> Vec<&Region> {
    lens.shapes.iter().filter_map(Region::own_shape).collect()
}

/// `shapes`, where one is not all; a lens that needs one and has none says so.
fn several(lens: &Lens, options: &Options) -> Option<Data> {
    let shapes = shapes_of(lens);
    let needs_none =
        lens.occluders().is_some() || lens.kind.has_overlay() || lens.deform().is_some() || lens.ray().is_some();
    if shapes.len() == 1 || (shapes.is_empty() && needs_none) {
        return None;
    }
    Some(Data::list(shapes.iter().filter_map(|shape| shape_keys::written(shape, options))))
}

/// A key of whom an occlusion lens looks for.
fn occluders(lens: &Lens, key: &str, options: &Options) -> Option<Data> {
    occlusion::written(lens.shapes.first().and_then(Region::occluders)?, key, options)
}

/// The table of a lens at this place in the order.
pub fn written(index: usize, lens: &Lens, options: &Options) -> Data {
    // Bodies are those of its kind; of what is its kind's own nothing is left away.
    let plain = Lens { kind: LensKind::default(), ..Lens::plain("", lens.kind.clone(), lens_color(index)) };
    row::written(LENS_ROWS, lens, &plain, options)
}

/// A lens; what is wrong is noted.
pub fn read(reader: &mut Reader, fields: &Fields, index: usize) -> Lens {
    let kind = fields.text("kind").and_then(LensKind::of_word).unwrap_or_default();
    let mut lens = Lens::plain(format!("lens-{index}"), kind, lens_color(index));
    row::read(LENS_ROWS, fields, reader, &mut lens);
    lens.placement = placement(reader, fields);
    if let (Some(read), Some(own)) = (best_view::read(reader, fields, &lens.kind.clone()), lens.kind.best_view_mut()) {
        *own = read;
    }
    if let (Some(read), Some(own)) = (deformation::read(reader, fields, &lens.kind.clone()), lens.kind.deform_mut()) {
        *own = read;
    }
    if let (Some(read), Some(own)) = (ray::read(reader, fields, &lens.kind.clone()), lens.kind.ray_mut()) {
        *own = read;
    }
    let has_overlay = lens.kind.has_overlay();
    let is_occlusion = lens.rendering().is_some();
    let needs_shape = lens.deform().is_none_or(|deform| !deform.needs_no_area());
    let bends_rays = lens.ray().is_some();
    lens.shapes = shapes(reader, fields, needs_shape && !is_occlusion && !has_overlay && !bends_rays);
    let (effects, of_effects) = effects::effects(reader, fields, "effects", true);
    lens.effects = effects;
    if let Some(rendering) = lens.kind.rendering_mut() {
        *rendering = rendering::read(reader, fields, &lens.effects);
        lens.shapes = occluded(reader, fields, lens.shapes);
    } else {
        without_sights(reader, fields, "effects", &lens.effects);
        let own = occlusion::OWN.into_iter().filter(|key| !has_overlay || *key != "poi");
        for key in own.filter(|key| fields.given(key)) {
            let message = "has a meaning only for a lens of kind = \"occlusion\"";
            reader.checker.note(&fields.place, key, fields.line(key), message);
        }
    }
    let is_lost = lens.placement == Placement::AboveGround && !heights_of_lens(&mut lens, &mut |_, _| {});
    if is_lost && !has_overlay {
        let message = "has a meaning only for shapes with places of their own, and for a route";
        reader.checker.note(&fields.place, "above_ground", fields.line("above_ground"), message);
    }
    lens.kind.set_content(content::read(reader, fields, of_effects));
    lens.time = epoch::read(reader, fields, "time");
    if matches!(lens.kind, LensKind::Time(_)) && !fields.given("time") {
        let message =
            "is missing: which moment shows in the lens. For example time = [{ op = \"set\", at = \"1650\" }]";
        reader.checker.note(&fields.place, "time", fields.place.line, message);
    }
    let is_saved = |shape: &Region| matches!(shape, Region::Sprite { .. });
    let has_saved = lens.shapes.iter().any(|s| s.any(&is_saved));
    lens.sprite = sprite::read(reader, fields, has_saved && lens.shapes.iter().all(is_saved));
    if (lens.sprite.is_some() || has_saved) && lens.border.is_some_and(|border| border.unit != BorderUnit::Ray) {
        let message = match has_saved {
            true => "is given together with a shape of kind \"sprite\": what is tested by a depth sprite ends at once",
            false => {
                "is given together with sprite: what is tested by a depth sprite ends at once; leave out one of them"
            }
        };
        reader.checker.note(&fields.place, "border", fields.line("border"), message);
    }
    lens
}

/// The focus areas of an occlusion lens with these shapes.
fn occluded(reader: &mut Reader, fields: &Fields, shapes: Vec<Region>) -> Vec<Region> {
    let saved = shapes.iter().position(|shape| matches!(shape, Region::Sprite { .. }));
    if saved.is_some() {
        let key = if fields.given("shape") { "shape" } else { "shapes" };
        let message = "a depth sprite cannot be combined with occluders; a shape of another kind would be right";
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
    occlusion::areas(occlusion::read(reader, fields), shapes)
}

fn placement(reader: &mut Reader, fields: &Fields) -> Placement {
    let of_camera = fields.text("placement") == Some("camera");
    let above_ground = fields.boolean("above_ground") == Some(true);
    if above_ground && (of_camera || fields.given("attached_to")) {
        let with = if of_camera { "placement = \"camera\"" } else { "attached_to" };
        let message = format!(
            "is given together with {with}: heights are above the ground only where coordinates are the model's"
        );
        reader.checker.note(&fields.place, "above_ground", fields.line("above_ground"), message);
    }
    let Some(node) = fields.node("attached_to") else {
        return match (of_camera, above_ground) {
            (true, _) => Placement::Camera,
            (_, true) => Placement::AboveGround,
            _ => Placement::World,
        };
    };
    if of_camera {
        let message = "is given together with placement = \"camera\": a lens is fixed to one of them";
        reader.checker.note(&fields.place, "attached_to", node.line, message);
    }
    let place = fields.place.within("attached_to", node.line);
    let own = reader.checker.fields(node, &ATTACHED_TO, &[], place);
    match (own.text("object"), own.text("poi")) {
        (Some(id), None) if !own.given("poi") => return Placement::Object(id.to_owned()),
        (None, Some(name)) if !own.given("object") => return Placement::Poi(name.to_owned()),
        (None, None) if own.given("object") || own.given("poi") => {}
        (None, None) => {
            reader.checker.note(&own.place, "", node.line, "is empty: give object = \"ID\" or poi = \"NAME\"");
        }
        _ => {
            let message = "is given together with object: a lens is attached to one of them";
            reader.checker.note(&own.place, "poi", own.line("poi"), message);
        }
    }
    Placement::World
}

fn shapes(reader: &mut Reader, fields: &Fields, must: bool) -> Vec<Region> {
    match (fields.given("shape"), fields.given("shapes")) {
        (true, true) => {
            let message = "is given together with shape: put all of them into shapes";
            reader.checker.note(&fields.place, "shapes", fields.line("shapes"), message);
        }
        (false, false) if must => {
            let message = "is missing: a lens acts somewhere. For example shape = { kind = \"sphere\", center = [x, y, z], radius = 60.0 }";
            reader.checker.note(&fields.place, "shape", fields.place.line, message);
        }
        _ => {}
    }
    let one = fields.node("shape").map(|n| ("shape".to_owned(), n));
    let many = fields.node("shapes").and_then(Node::list).unwrap_or_default();
    let many = many.iter().enumerate().map(|(i, n)| (format!("shapes.{i}"), n));
    one.into_iter()
        .chain(many)
        .filter_map(|(key, node)| region::read(reader, node, &fields.place.within(&key, node.line)))
        .collect()
}
