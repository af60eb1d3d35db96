//! The one table of scene-file keys: it drives the checks, the messages, `docs/scene.md` and the JSON schema.

use crate::{
    figure::scene_file::{
        animation::{self, ANIMATION},
        best_view::LOOK,
        content::CONTENT,
        deformation::{CONTROL, CONTROL_WORDS},
        overlay::{CALL_OUT, FRAME, LAYOUT, LINE, OVERLAY},
        sprite::{SPRITE, SPRITE_CAMERA},
        test_keys::CHOICE,
        trajectory::{TIME, TRAJECTORY},
    },
    lens::{Rendering, ramp},
    scene::{Transparency, transparency::MOST_PEELED},
    shader::effect::ParameterKind,
};

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A whole number within the closed range.
    Integer {
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
    },
    /// A finite number within the closed range.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// `true` or `false`.
    Boolean,
    /// Text that is not empty.
    Text,
    /// Texts that are not empty.
    Texts,
    /// One of `now`; those of `later` are known but not available yet.
    Word {
        /// Words of this version.
        now: &'static [&'static str],
        /// Words of later ones.
        later: &'static [&'static str],
    },
    /// `[x, y, z]`, each within ± [`FAR_M`].
    Point,
    /// `[x, y, z]`, each 0 to [`FAR_M`].
    Lengths,
    /// `[x, y, z]`, each within ± [`FAR_M`], of which one is not 0.
    Direction,
    /// `[yaw, pitch, roll]` in degrees, each within ±360.
    Angles,
    /// At least so many points.
    Points(usize),
    /// `[x, y]`, each within ± [`FAR_M`].
    PlanPoint,
    /// `[x, y]`, each 0 to [`FAR_M`].
    PlanLengths,
    /// `[x, y]`, each 0 to 1: shares of a picture's width and height.
    PicturePlace,
    /// At least so many points `[x, y]`.
    PlanPoints(usize),
    /// Lists of at least three points `[x, y]`.
    Rings,
    /// At least so many planes `[x, y, z, d]`.
    Planes(usize),
    /// At least so many seconds, each 0 or more and later than the one before.
    Times(usize),
    /// `"#rrggbb"` or `[r, g, b]`.
    Color,
    /// `"sky"` or a colour.
    Background,
    /// A level of detail, `"2"` or `"1.3"`.
    Lod,
    /// `[width, height]` in pixels.
    Size,
    /// A table.
    Table(&'static Table),
    /// Tables, `[[key]]`.
    Tables(&'static Table),
    /// One shape: a table of [`super::shape_keys::SHAPES`].
    Shape,
    /// Shapes.
    Shapes,
    /// Names of effects, or tables `{ effect = NAME, ... }`.
    Effects,
    /// A number, or a list of numbers, or of such lists.
    Numbers,
    /// A text, or texts.
    Names,
    /// Shares, 0 to 1, at equal steps of a ramp.
    Shares,
    /// Colours `"#rrggbb"` at equal steps of a ramp.
    Colors,
    /// A detection test: a table of [`super::test_keys::TESTS`].
    Test,
    /// An eye of its own: a table of [`super::best_view::VIEWS`].
    View,
    /// Detection tests.
    Tests,
    /// Steps of a deformation: tables of [`super::deformation::STEPS`].
    Steps,
    /// A word of [`crate::lens::rendering::ROWS`], or effects.
    Rendering,
    /// One of the first words, or a table that says more.
    WordOrTable(&'static [&'static str], &'static Table),
}

/// Farthest a coordinate may lie from the origin, metres; beyond it f64 is coarser than a micrometre.
pub const FAR_M: f64 = 1e9;

/// One key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What holds without it; empty: it must be given.
    pub default: &'static str,
    /// Unit, or empty.
    pub unit: &'static str,
    /// What it means.
    pub doc: &'static str,
    /// A good value, as TOML.
    pub example: &'static str,
}

/// A table of keys.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Its name as messages and docs give it.
    pub name: &'static str,
    /// What it is for.
    pub doc: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

pub(in crate::figure) const fn key(
    name: &'static str,
    kind: Kind,
    default: &'static str,
    unit: &'static str,
    doc: &'static str,
    example: &'static str,
) -> Key {
    Key { name, kind, default, unit, doc, example }
}

/// The whole file.
pub const ROOT: Table = Table {
    name: "",
    doc: "The top of the file.",
    keys: &[
        key("veduta", Kind::Integer { min: 1, max: 1 }, "", "", "Version of the format.", "1"),
        key(
            "city",
            Kind::Table(&CITY),
            "no city",
            "",
            "Which city, and how much of it.",
            "{ files = [\"a.city.json\"] }",
        ),
        key(
            "camera",
            Kind::Table(&CAMERA),
            "a good first view",
            "",
            "The eye.",
            "{ eye = [0, -90, 60], target = [0, 0, 5] }",
        ),
        key("sun", Kind::Table(&SUN), "from the south-west", "", "Light.", "{ azimuth_deg = 215.0 }"),
        key("time", Kind::Table(&TIME), "the beginning", "", "Which moment is shown.", "{ at_s = 12.5 }"),
        key("style", Kind::Table(&STYLE), "natural", "", "How the context looks.", "{ base = \"clay\" }"),
        key(
            "trajectory",
            Kind::Tables(&TRAJECTORY),
            "none",
            "",
            "Ways that points of interest move along.",
            "[{ name = \"tram\", points = [[0, 0, 2], [80, 0, 2]], speed_m_s = 8.0 }]",
        ),
        key("poi", Kind::Tables(&POI), "none", "", "Points of interest.", "[{ name = \"hall\", object = \"ID\" }]"),
        key("lens", Kind::Tables(&LENS), "none", "", "Lenses, bottom to top: the last is the top lens.", "[]"),
        key(
            "overlay",
            Kind::Tables(&OVERLAY),
            "one for each best-view lens",
            "",
            "How pictures of best-view lenses stand over the main one.",
            "[{ lens = \"cathedral\", size = [320, 200] }]",
        ),
        key("layout", Kind::Table(&LAYOUT), "around the border", "", "Where overlays stand.", "{ along = \"right\" }"),
        key(
            "figure",
            Kind::Table(&FIGURE),
            "1280x720, 1 sample",
            "",
            "How a picture is made.",
            "{ size = [1920, 1080] }",
        ),
        key(
            "animation",
            Kind::Table(&ANIMATION),
            "none",
            "",
            "What changes from frame to frame.",
            "{ frames = 120, change = [] }",
        ),
    ],
};

/// `[city]`.
pub const CITY: Table = Table {
    name: "city",
    doc: "Which city to load, and how much of it to show.",
    keys: &[
        key(
            "files",
            Kind::Texts,
            "none",
            "",
            "City files or folders, relative to the scene file; several make one city. `${VEDUTA_DATA}` stands for the folder that variable names, `builtin:square`, `builtin:town` and `builtin:rooms` for the built-in cities.",
            "[\"city.city.json\"]",
        ),
        key("lod", Kind::Lod, "the finest there is", "", "Shows no level of detail finer than this.", "\"1.3\""),
        key("ground", Kind::Boolean, "true", "", "Puts a plain ground under a city without terrain.", "false"),
    ],
};

/// `[camera]`.
pub const CAMERA: Table = Table {
    name: "camera",
    doc: "The eye, in model coordinates (x east, y north, z up).",
    keys: &[
        key("eye", Kind::Point, "", "m", "Where the eye is.", "[78500.0, 457800.0, 150.0]"),
        key("target", Kind::Point, "", "m", "What it looks at: any point but `eye`.", "[78600.0, 458000.0, 10.0]"),
        key(
            "up",
            Kind::Direction,
            "[0, 0, 1]",
            "",
            "What is up in the picture. Where it is parallel to the view, north takes its place, and east where that is parallel too.",
            "[0, 0, 1]",
        ),
        key(
            "projection",
            Kind::Word { now: &["perspective", "orthographic"], later: &[] },
            "\"perspective\"",
            "",
            "Whether far things look smaller.",
            "\"orthographic\"",
        ),
        key("fov_deg", Kind::Number { min: 0.01, max: 179.0 }, "45.0", "degrees", "Vertical field of view.", "60.0"),
        key(
            "height_m",
            Kind::Number { min: 0.001, max: 1e7 },
            "what `fov_deg` shows at the target",
            "m",
            "Height of an orthographic picture.",
            "250.0",
        ),
        key(
            "near_m",
            Kind::Number { min: 1e-4, max: 1e6 },
            "a 512th of the way to the target, 0.125 to 1",
            "m",
            "What is nearer along the view axis is not drawn.",
            "0.5",
        ),
    ],
};

/// `[sun]`.
pub const SUN: Table = Table {
    name: "sun",
    doc: "Where the light comes from.",
    keys: &[
        key(
            "azimuth_deg",
            Kind::Number { min: -360.0, max: 360.0 },
            "215.0",
            "degrees",
            "Clockwise from north.",
            "135.0",
        ),
        key("elevation_deg", Kind::Number { min: -90.0, max: 90.0 }, "48.0", "degrees", "Above the horizon.", "30.0"),
        key("shadows", Kind::Boolean, "true", "", "Whether it casts shadows.", "false"),
    ],
};

/// `[style]`.
pub const STYLE: Table = Table {
    name: "style",
    doc: "How everything looks that no lens changes.",
    keys: &[
        key(
            "base",
            Kind::Word { now: &["natural", "clay"], later: &[] },
            "\"natural\"",
            "",
            "The colours surfaces start from: the file's materials and textures, or one clay.",
            "\"clay\"",
        ),
        key("effects", Kind::Effects, "none", "", "Effects on the context, in order; see Effects.", "[\"greyscale\"]"),
        key(
            "background",
            Kind::Background,
            "\"sky\"",
            "",
            "What is behind the city: a quiet sky, or one colour.",
            "\"#ffffff\"",
        ),
        key(
            "technique",
            Kind::Word { now: &["accumulate", "branches", "regions", "three-pass"], later: &[] },
            "\"accumulate\"",
            "",
            "How lenses are evaluated: effects one after the other where their lens is (`accumulate`), or as the literature has it, for comparison; the picture is the same, see Techniques.",
            "\"regions\"",
        ),
        key(
            "transparency",
            Kind::WordOrTable(&Transparency::WORDS, &TRANSPARENCY),
            "\"exact\"",
            "",
            "How translucent layers are laid one over the other: a method, or a method and how far it goes; see Transparency.",
            "{ method = \"k-buffer\", layers = 8 }",
        ),
        key(
            "chord_px",
            Kind::Number { min: 0.02, max: 100.0 },
            "0.25",
            "pixels",
            "How far edges that a deformation bends may be from where they should be: what is moved is split until they are nearer.",
            "1.0",
        ),
    ],
};

/// `transparency` of `[style]`.
pub const TRANSPARENCY: Table = Table {
    name: "transparency",
    doc: "A method of laying translucent layers one over the other, and how far it goes; see Transparency.",
    keys: &[
        key(
            "method",
            Kind::Word { now: &Transparency::WORDS, later: &[] },
            "",
            "",
            "The method: all layers, exactly (`exact`), or one of the literature.",
            "\"k-buffer\"",
        ),
        key(
            "layers",
            Kind::Integer { min: 0, max: MOST_PEELED as i64 },
            "of `peel` 0, of `k-buffer` 8",
            "",
            "How many layers of a pixel, from the eye: of `peel` all that are shown, 0 = until nothing is left; of `k-buffer` those that are exact, 4, 8 or 16.",
            "16",
        ),
    ],
};

/// `[[poi]]`.
pub const POI: Table = Table {
    name: "poi",
    doc: "A point of interest: a city object or a place; exactly one of `object`, `at` and `trajectory`.",
    keys: &[
        key("name", Kind::Text, "`poi-N`, N its place in the file", "", "Its name, unique.", "\"hall\""),
        key("object", Kind::Text, "none", "", "Id of a city object.", "\"NL.IMBAG.Pand.0503100000031316\""),
        key("at", Kind::Point, "none", "m", "A point.", "[10.0, 20.0, 3.0]"),
        key("trajectory", Kind::Text, "none", "", "Name of a `[[trajectory]]`: it moves along it.", "\"tram 1\""),
    ],
};

/// `[[lens]]`.
pub const LENS: Table = Table {
    name: "lens",
    doc: "A lens: where it acts (`shape`, or `shapes` for several) and what it does (`effects`); a lens with an overlay has a `view`, an `image` or a `text` instead.",
    keys: &[
        key("name", Kind::Text, "`lens-N`, N its place in the file", "", "Its name, unique.", "\"old town\""),
        key(
            "kind",
            Kind::Word {
                now: &[
                    "color",
                    "content",
                    "occlusion",
                    "deformation",
                    "annotation",
                    "best-view",
                    "map-view",
                    "worldlet",
                    "see-through",
                    "portal",
                ],
                later: &["time", "magnifier", "feature", "sampling", "fisheye"],
            },
            "\"color\"",
            "",
            "What kind of lens it is: `color` restyles what is in it, `content` shows something else in it, `occlusion` draws the city objects that hide a point of interest so that it can be seen, see Occlusion lenses, `deformation` moves what is in it, see Deformation lenses. The others have an overlay in place of a shape, see Best-view lenses: `annotation` an image or a text, `best-view` the city from an eye of its own, `map-view` a map, `worldlet` a small model, `see-through` and `portal` another place.",
            "\"color\"",
        ),
        key(
            "enabled",
            Kind::Boolean,
            "true",
            "",
            "`false`: it keeps its place and its bit in the lens mask, and does nothing.",
            "false",
        ),
        key(
            "color",
            Kind::Color,
            "a colour of its own by its place",
            "",
            "Its own colour: its outline, its line in a legend.",
            "\"#0072b2\"",
        ),
        key(
            "placement",
            Kind::Word { now: &["scene", "camera"], later: &[] },
            "\"scene\"",
            "",
            "What its shapes are fixed to: the `scene`, or the `camera`, with which they move and in whose view alone they act; see Placement.",
            "\"camera\"",
        ),
        key(
            "attached_to",
            Kind::Table(&ATTACHED_TO),
            "nothing: model coordinates",
            "",
            "A city object or a point of interest, whose middle the coordinates of its shapes are counted from.",
            "{ poi = \"hall\" }",
        ),
        key(
            "shape",
            Kind::Shape,
            "",
            "",
            "Its focus area; see Shapes. Or `shapes`. An occlusion lens needs none; with one it acts on what of its occluders is in it.",
            "{ kind = \"sphere\", center = [0, 0, 0], radius = 60.0 }",
        ),
        key(
            "shapes",
            Kind::Shapes,
            "none",
            "",
            "Several focus areas: it acts inside any of them.",
            "[{ kind = \"sphere\", center = [0, 0, 0], radius = 60.0 }]",
        ),
        key(
            "effects",
            Kind::Effects,
            "none",
            "",
            "What it does, in order: names, or tables with parameters; see Effects. At most one scene style.",
            "[\"sepia\"]",
        ),
        key(
            "poi",
            Kind::Names,
            "none",
            "",
            "The name of a `[[poi]]`, or several. Of an occlusion lens: what shall be seen; it never hides itself. Of a lens with an overlay: what the overlay is tied to by context lines; a view is of the first of them.",
            "\"hall\"",
        ),
        key(
            "view",
            Kind::View,
            "by its kind",
            "",
            "The eye that the overlay of a best-view lens, a map or another view is seen from; see Views.",
            "{ kind = \"best\", normal = [0, -1, 0.5] }",
        ),
        key(
            "image",
            Kind::Text,
            "none",
            "",
            "Of an annotation: the image that it shows, PNG or JPEG.",
            "\"photo.png\"",
        ),
        key(
            "text",
            Kind::Text,
            "none",
            "",
            "Of an annotation: the text that it shows; `\\n` begins a line.",
            "\"Town hall\\n1893\"",
        ),
        key(
            "lenses",
            Kind::Texts,
            "all that act in every view",
            "",
            "The lenses that act in its view, by name; those that have overlays stand in its overlay as overlays. An empty list: none.",
            "[\"old town\"]",
        ),
        key(
            "look",
            Kind::Table(&LOOK),
            "as the scene",
            "",
            "How its view looks, in place of the `[style]` of the scene.",
            "{ base = \"clay\" }",
        ),
        key(
            "test",
            Kind::Test,
            "{ kind = \"exact\" }",
            "",
            "Of an occlusion lens: when a city object hides something; see Detection tests.",
            "{ kind = \"exact\", coverage = 0.05 }",
        ),
        key(
            "force",
            Kind::Table(&CHOICE),
            "none",
            "",
            "Of an occlusion lens: city objects that hide something whatever the test says; never those of `poi`.",
            "{ attribute = \"measuredHeight\", min = 60.0 }",
        ),
        key(
            "forbid",
            Kind::Table(&CHOICE),
            "none",
            "",
            "Of an occlusion lens: city objects that stay as they are whatever the test and `force` say.",
            "{ ids = [\"town-hall\"] }",
        ),
        key(
            "margin",
            Kind::Number { min: 0.0, max: 1000.0 },
            "1.0",
            "metres",
            "Of an occlusion lens, in animations: how far an occluder must leave the test before it ceases to be one; 0: at once. See Animations.",
            "5.0",
        ),
        key(
            "fade",
            Kind::Number { min: 0.0, max: 60.0 },
            "0.3",
            "seconds",
            "Of an occlusion lens, in animations: how long what becomes an occluder, or ceases to be one, takes to change; 0: at once.",
            "0.5",
        ),
        key(
            "render",
            Kind::Rendering,
            "\"discard\"",
            "",
            "Of an occlusion lens: how occluders are drawn, by a word, a word with parameters, or by cases; see Renderings. Or a list of effects, as `effects` takes them. `effects` come after.",
            "{ as = \"x-ray\", exponent = 0.8 }",
        ),
        key(
            "poi_effects",
            Kind::Effects,
            "none",
            "",
            "Of an occlusion lens: effects on the points of interest that are city objects, parts included, after all else.",
            "[{ effect = \"overlay\", color = \"#e08a3c\", opacity = 0.4 }]",
        ),
        key(
            "deform",
            Kind::Steps,
            "must be given for a deformation lens",
            "",
            "Of a deformation lens: what it does with space, one step after the other; see Deformation lenses.",
            "[{ kind = \"twist\", angle_deg = 90.0 }, { kind = \"taper\", factor = 0.5 }]",
        ),
        key(
            "control",
            Kind::WordOrTable(CONTROL_WORDS, &CONTROL),
            "\"smooth\"; over a cylinder or a sphere \"bump\"",
            "",
            "Of a deformation lens: how strong it is over the base of its focus area; along the border it is 0.",
            "{ profile = \"smooth\", border = 0.1 }",
        ),
        key(
            "strength",
            Kind::Number { min: 0.0, max: 1.0 },
            "1.0",
            "",
            "Of a deformation lens: how much of it; ways, angles and factors are that much of what is given.",
            "0.5",
        ),
        key(
            "content",
            Kind::Table(&CONTENT),
            "what is below",
            "",
            "What it shows in itself in place of what is below it; a lens of any kind may have some, a `content` lens must.",
            "{ lod = \"1.2\" }",
        ),
        key(
            "clip",
            Kind::Word { now: &["order", "merge", "discard"], later: &[] },
            "\"order\"",
            "",
            "Where its content shows, what becomes of what is below, the context and contents of lower lenses: by `order` it is clipped; with `merge` it stays and the content is added; with `discard` nothing shows, neither, where a lower lens shows another content.",
            "\"merge\"",
        ),
        key(
            "space",
            Kind::Word { now: &["displayed", "rest"], later: &[] },
            "\"displayed\"",
            "",
            "Which position of a surface counts where a deformation moves it: that at which it is shown, or with `rest` that of the city as it is. Then the lens goes with the houses: its body is moved as they are, to a thousandth of its size. Changed heights of objects (`heights`, `lower`) do not move it.",
            "\"rest\"",
        ),
        key(
            "body",
            Kind::Word { now: &["outline", "shell", "halo", "none"], later: &[] },
            "\"outline\"; of an occlusion lens \"none\"",
            "",
            "How the lens body itself is drawn, in its colour: a line around it, tinted glass, a glow around it. Thematic and occlusion lenses show a line for all, and so do flat ones and those tested by a sprite for `halo`.",
            "\"none\"",
        ),
        key(
            "sprite",
            Kind::Table(&SPRITE),
            "none: from its shapes",
            "",
            "Has the lens tested by a volumetric depth sprite of it.",
            "{ resolution = 512 }",
        ),
        key(
            "border",
            Kind::Table(&BORDER),
            "none: it ends at once",
            "",
            "Has what the lens does end gradually.",
            "{ width = 20.0 }",
        ),
        key(
            "shadows",
            Kind::Boolean,
            "false",
            "",
            "Whether what the lens takes away, sees through or replaces still casts the shadow that it has without the lens. Otherwise shadows are those of what is there: an erased or translucent building casts none, one that is flattened or shown as something else that of its new form.",
            "true",
        ),
        key(
            "section",
            Kind::Color,
            "none: what is cut is hollow",
            "",
            "The colour of sections: where the lens takes part of a closed body away, or shows part of one, its surface closes what is left. See Sections.",
            "\"#9c4a3c\"",
        ),
    ],
};

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
    keys: &[
        key(
            "width",
            Kind::Number { min: 0.0, max: 100_000.0 },
            "",
            "metres or pixels",
            "From where all of it is seen to where nothing is; 0 ends at once.",
            "20.0",
        ),
        key(
            "unit",
            Kind::Word { now: &["m", "px", "ray"], later: &[] },
            "\"m\"",
            "",
            "Of the width: metres, or pixels at the distance of what is shown. `ray`: metres along the ray, and nothing fades: all of what the lens does is seen where what is shown lies within half the width of where its ray first enters or last leaves the volume, before or behind it, and nowhere else. So a lens acts on a skin, where it meets the city. Tested by a sprite, half the width should be no less than a step of its format.",
            "\"px\"",
        ),
        key(
            "discrete",
            Kind::Word { now: &["threshold", "dither"], later: &[] },
            "\"threshold\"",
            "",
            "How what cannot be had by halves ends, like the eraser: at the surface of the volume, or pixel by pixel; with 16 samples and more that is smooth.",
            "\"dither\"",
        ),
    ],
};

/// Text in points.
pub const TEXT_PT: Kind = Kind::Number { min: 1.0, max: 400.0 };
/// Dots per inch.
pub const DPI: Kind = Kind::Number { min: 10.0, max: 2400.0 };

/// `[figure]`.
pub const FIGURE: Table = Table {
    name: "figure",
    doc: "How a picture is made of the scene.",
    keys: &[
        key("size", Kind::Size, "[1280, 720]", "pixels", "Width and height, each 1 to 16384.", "[1920, 1080]"),
        key(
            "samples",
            Kind::Integer { min: 1, max: 1024 },
            "1",
            "per pixel",
            "Samples that are averaged: 1 is fast, 16 is smooth.",
            "16",
        ),
        key(
            "legend",
            Kind::Word { now: &["none", "auto", "top-left", "top-right", "bottom-left", "bottom-right"], later: &[] },
            "\"none\"",
            "",
            "Where the legends of thematic colours stand; `auto` chooses the corner.",
            "\"auto\"",
        ),
        key("title", Kind::Text, "none", "", "A title, drawn at the top left.", "\"How old the town is\""),
        key(
            "caption",
            Kind::Text,
            "none",
            "",
            "A caption, drawn at the bottom left; `\\n` begins a new line.",
            "\"Years from the land register, 2023.\"",
        ),
        key(
            "text_px",
            Kind::Number { min: 6.0, max: 400.0 },
            "by the size of the picture: 13 at 1280x720",
            "pixels",
            "Size of the text of legends and captions.",
            "16.0",
        ),
        key(
            "text_pt",
            TEXT_PT,
            "by the size of the picture",
            "points",
            "The same in points, 1/72 inch, in place of `text_px`: N points at `dpi` D are N·D/72 pixels, which are 6 to 400.",
            "9.0",
        ),
        key(
            "dpi",
            DPI,
            "96 for points; the file says none",
            "dots per inch",
            "Resolution of the picture on paper: what `text_pt` is measured by, and what the PNG says (pHYs).",
            "300.0",
        ),
    ],
};

/// Classes of an effect's use.
pub const CLASSES: &[&str] = &["inside", "front", "behind", "rest"];

impl Kind {
    /// What it takes, as people read it.
    pub fn describe(&self) -> String {
        match self {
            Self::Integer { min, max } if min == max => format!("{min}"),
            Self::Integer { min, max } => format!("a whole number {min} to {max}"),
            Self::Number { min, max } if *min == f64::MIN && *max == f64::MAX => "a finite number".into(),
            Self::Number { min, max } if *min <= -FAR_M && *max >= FAR_M => format!("a number from {min:e} to {max:e}"),
            Self::Number { min, max } if *max >= FAR_M => format!("a number ≥ {min}"),
            Self::Number { min, max } => format!("a number {min} to {max}"),
            Self::Boolean => "true or false".into(),
            Self::Text => "a text that is not empty".into(),
            Self::Texts => "a list of texts that are not empty".into(),
            Self::Word { now, .. } => now.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(" or "),
            Self::Point => format!("[x, y, z], three numbers from {:e} to {FAR_M:e}", -FAR_M),
            Self::Lengths => format!("[x, y, z], three numbers from 0 to {FAR_M:e}"),
            Self::Direction => format!("{}, not all 0", Self::Point.describe()),
            Self::Angles => "[yaw, pitch, roll], three numbers -360 to 360".into(),
            Self::Points(least) => format!("a list of at least {least} points [x, y, z]"),
            Self::PlanPoint => format!("[x, y], two numbers from {:e} to {FAR_M:e}", -FAR_M),
            Self::PicturePlace => "[x, y], two numbers 0 to 1".into(),
            Self::PlanLengths => format!("[width, height], two numbers from 0 to {FAR_M:e}"),
            Self::PlanPoints(least) => format!("a list of at least {least} points [x, y]"),
            Self::Rings => "a list of rings, each a list of at least 3 points [x, y]".into(),
            Self::Planes(least) => format!("a list of at least {least} planes [x, y, z, d]"),
            Self::Times(least) => {
                format!("a list of at least {least} times, 0 or more, each later than the one before")
            }
            Self::Color => "a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Background => "\"sky\" or a colour: \"#rrggbb\" or [r, g, b] of 0 to 1".into(),
            Self::Lod => "a level of detail like \"2\" or \"1.3\"".into(),
            Self::Size => "[width, height], two whole numbers 1 to 16384".into(),
            Self::Table(_) => "a table".into(),
            Self::Tables(_) => "a list of tables".into(),
            Self::Shape => "a table { kind = ..., ... }".into(),
            Self::Shapes => "a list of at least one shape".into(),
            Self::Numbers => "a number, or a list of numbers".into(),
            Self::Effects => "a list of effects: names or tables { effect = NAME, ... }".into(),
            Self::Names => "a text that is not empty, or a list of at least one such text".into(),
            Self::View => "a table { kind = ..., ... }".into(),
            Self::Test => "a table { kind = ..., ... }, { any = [...] }, { all = [...] } or { not = ... }".into(),
            Self::Shares => ParameterKind::Shares.describe(),
            Self::Colors => ParameterKind::Colors.describe(),
            Self::Tests => "a list of at least one test".into(),
            Self::Steps => "a list of at least one step { kind = ..., ... }".into(),
            Self::Rendering => {
                let words: Vec<String> = Rendering::words().map(|word| format!("\"{word}\"")).collect();
                format!(
                    "{}, a table {{ as = ..., ... }}, a list of such cases, or a list of effects",
                    words.join(" or ")
                )
            }
            Self::WordOrTable(words, table) => {
                let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                let keys: Vec<String> = names(table).map(|name| format!("{name} = ...")).collect();
                format!("{}, or a table {{ {} }}", words.join(" or "), keys.join(", "))
            }
        }
    }
}

/// All tables of the file with the way to them, for the docs and for tests.
pub const TABLES: &[(&str, &Table)] = &[
    ("top level", &ROOT),
    ("[city]", &CITY),
    ("[camera]", &CAMERA),
    ("[sun]", &SUN),
    ("[time]", &TIME),
    ("[style]", &STYLE),
    ("transparency of [style]", &TRANSPARENCY),
    ("[[trajectory]]", &TRAJECTORY),
    ("[[poi]]", &POI),
    ("[[lens]]", &LENS),
    ("attached_to of a lens", &ATTACHED_TO),
    ("content of a lens", &CONTENT),
    ("sprite of a lens", &SPRITE),
    ("camera of a sprite", &SPRITE_CAMERA),
    ("border of a lens", &BORDER),
    ("force and forbid of a lens", &CHOICE),
    ("look of a lens", &LOOK),
    ("control of a lens", &CONTROL),
    ("[[overlay]]", &OVERLAY),
    ("frame of an overlay", &FRAME),
    ("line of an overlay", &LINE),
    ("call_out of an overlay", &CALL_OUT),
    ("[layout]", &LAYOUT),
    ("[figure]", &FIGURE),
    animation::TABLES[0],
    animation::TABLES[1],
    animation::TABLES[2],
    animation::TABLES[3],
];

/// The names of a table's keys.
pub fn names(table: &Table) -> impl Iterator<Item = &'static str> + use<> {
    table.keys.iter().map(|k| k.name)
}

/// Ramp names, for the docs.
pub const RAMPS: &[&str] = ramp::NAMES;
