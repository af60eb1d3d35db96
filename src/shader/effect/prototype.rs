//! The table of prototypes (Trapp §3.7): what handlers do, when they run and what their functions look like. Parsing of effect files, messages
//! and the table in `docs/effects.md` come from it.

use serde::{Deserialize, Deserializer, de::Error as _};

/// The prototype handlers (Trapp §3.7), in the order of their execution: what an effect's `kind` says. Several
/// handlers of one prototype run in lens order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EffectKind {
    /// Says where the content of a lens is put.
    Transform,
    /// Moves places of the city: a step of a deformation.
    Deform,
    /// Says what is seen at a place of a lens that bends rays.
    Ray,
    /// Says how far a place is from a region: a shape of a lens.
    Region,
    /// Says which moment shows in a lens, of the one that shows below it: a time operator.
    Epoch,
    /// Takes parts of the city away, before anything is seen of them.
    Hide,
    /// Says how much of a surface stands between the eye and what is behind it; from 1, lens by lens.
    Opacity,
    /// Changes what surfaces are made of, before light falls on them.
    Material,
    /// Changes the light that falls on them.
    Light,
    /// Gives surfaces their colour; at most one per lens, and nothing behind the city has it.
    Scene,
    /// Acts between the surface and the eye.
    Air,
    /// Changes the colour of the lit picture.
    Post,
    /// The same, by what is beside it: the kernel of a separable filter. Runs among the post styles.
    Filter,
}

/// When a handler runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Always.
    Global,
    /// Where a lens, or the context, has it: effects.
    Local,
    /// Where no other handler of its prototype set the result.
    Optional,
    /// Never.
    Ignore,
}

/// A stage of a frame, in the order of execution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Lenses, once each, before anything is drawn; on the host.
    Lens,
    /// Vertices, where meshes are refined and moved (`shader::deforming`): each deformation finds the place in its frame, its handlers
    /// move it one after the other, and the control and the normal follow.
    Vertex,
    /// Pixels, before anything is seen along their rays.
    Pixel,
    /// Places, to tell which lenses they are in.
    Place,
    /// Fragments of the city, before visibility: by each fragment's own depth.
    Visibility,
    /// The shown surface, before it has a colour.
    Surface,
    /// The colour of the surface or of the sky. Its handlers take turns in lens order; what is between the surface and the eye comes
    /// with the standard style.
    Color,
}

/// A row of the table of prototypes. Handlers run in the order of the stages, within a stage in the order of the rows, but for styles,
/// which are one list.
#[derive(Clone, Copy, Debug)]
pub struct Prototype {
    /// The prototype.
    pub kind: EffectKind,
    /// Its word in the header of an effect file.
    pub word: &'static str,
    /// Its name as people read it.
    pub name: &'static str,
    /// The stage at which its handlers run.
    pub stage: Stage,
    /// The mode of a handler without one in its header.
    pub default_mode: Mode,
    /// The first argument in WGSL: name and type.
    pub subject: (&'static str, &'static str),
    /// The second argument in WGSL, if there is one: name and type.
    pub context: Option<(&'static str, &'static str)>,
    /// The type that is given back.
    pub result: &'static str,
    /// Whether its handlers take turns in lens order on the colour.
    pub is_style: bool,
    /// Whether its handlers have a say in how a line looks: materials and light have none, nor has what is beside it.
    pub touches_lines: bool,
    /// What asks for its handlers by name.
    pub asked_by: AskedBy,
    /// The array of `vec4f` that parameters are read from.
    pub parameters: &'static str,
    /// When it runs, as the docs say it.
    pub when: &'static str,
}

/// What asks for the handlers of a prototype.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AskedBy {
    /// `effects` of a lens or of the context.
    Effects,
    /// The `kind` of a step of `deform`.
    Steps,
    /// The `kind` of a shape.
    Shapes,
    /// `transform` of a content.
    Contents,
    /// `bend` of a lens' `ray`.
    Rays,
    /// The `op` of a step of `time`.
    Times,
    /// The program alone; users have none of their own.
    Program,
}

impl AskedBy {
    /// Where in a scene file that is.
    pub fn place(self) -> &'static str {
        match self {
            Self::Effects => "effects",
            Self::Steps => "a step of deform",
            Self::Shapes => "shape",
            Self::Contents => "transform of a content",
            Self::Rays => "bend of a lens' ray",
            Self::Times => "a step of time",
            Self::Program => "nothing",
        }
    }
}

/// The shown surface.
const POINT: Option<(&str, &str)> = Some(("point", "Point"));
/// The extent of the lens along its axes, metres.
const SIZE: Option<(&str, &str)> = Some(("size", "vec3f"));
/// Parameters of effects.
const PARAMETERS: &str = "parameters";
/// Those of ray handlers, beside the knots of other lenses that bend rays.
const RAY_NUMBERS: &str = "ray_lenses.knots";

/// All prototypes, in the order of their execution.
pub const PROTOTYPES: [Prototype; 13] = [
    Prototype {
        kind: EffectKind::Transform,
        word: "transform",
        name: "transform",
        stage: Stage::Lens,
        default_mode: Mode::Local,
        subject: ("place", "vec3f"),
        context: SIZE,
        result: "vec3f",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Contents,
        parameters: PARAMETERS,
        when: "once for each lens: where a place of its content is put; turns, moves and scales, the same along all axes",
    },
    Prototype {
        kind: EffectKind::Deform,
        word: "deform",
        name: "deformation",
        stage: Stage::Vertex,
        default_mode: Mode::Local,
        subject: ("place", "vec3f"),
        context: SIZE,
        result: "vec3f",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Steps,
        parameters: "numbers",
        when: "for every vertex in the lens, and for as many between them as it takes: how far a place is moved, metres",
    },
    Prototype {
        kind: EffectKind::Ray,
        word: "ray",
        name: "ray",
        stage: Stage::Pixel,
        default_mode: Mode::Local,
        subject: ("place", "vec2f"),
        context: SIZE,
        result: "vec3f",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Rays,
        parameters: RAY_NUMBERS,
        when: "for every pixel in the lens: what is seen at its place: `(x, y, 1)` is another place of the picture, `(x, y, z)` any direction",
    },
    Prototype {
        kind: EffectKind::Region,
        word: "region",
        name: "region test",
        stage: Stage::Place,
        default_mode: Mode::Local,
        subject: ("place", "vec3f"),
        context: SIZE,
        result: "f32",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Shapes,
        parameters: "planes",
        when: "for every place that is asked: how far it is from the border, metres, negative inside; never more than it is",
    },
    Prototype {
        kind: EffectKind::Epoch,
        word: "epoch",
        name: "time operator",
        stage: Stage::Place,
        default_mode: Mode::Local,
        subject: ("moment", "Moment"),
        context: None,
        result: "Moment",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Times,
        parameters: "object_values",
        when: "for every place in the lens: the moment that shows there, of the one that shows below",
    },
    Prototype {
        kind: EffectKind::Hide,
        word: "hide",
        name: "hiding",
        stage: Stage::Visibility,
        default_mode: Mode::Local,
        subject: ("fragment", "Fragment"),
        context: None,
        result: "bool",
        is_style: false,
        touches_lines: true,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "before anything is seen: true where the city is taken away",
    },
    Prototype {
        kind: EffectKind::Opacity,
        word: "opacity",
        name: "opacity rule",
        stage: Stage::Visibility,
        default_mode: Mode::Local,
        subject: ("opacity", "f32"),
        context: POINT,
        result: "f32",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "for every translucent layer: 0 is clear, 1 opaque; first 1, then what the rule before said",
    },
    Prototype {
        kind: EffectKind::Material,
        word: "material",
        name: "material",
        stage: Stage::Surface,
        default_mode: Mode::Local,
        subject: ("material", "Material"),
        context: POINT,
        result: "Material",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "before light: `base` (colour), `emission`, `specular`, `shininess`",
    },
    Prototype {
        kind: EffectKind::Light,
        word: "light",
        name: "light",
        stage: Stage::Surface,
        default_mode: Mode::Local,
        subject: ("arriving", "vec3f"),
        context: POINT,
        result: "vec3f",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "the light on a white surface",
    },
    Prototype {
        kind: EffectKind::Scene,
        word: "scene",
        name: "scene style",
        stage: Stage::Color,
        default_mode: Mode::Local,
        subject: ("color", "vec3f"),
        context: POINT,
        result: "vec3f",
        is_style: true,
        touches_lines: true,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "how surfaces are drawn; not called for the sky",
    },
    Prototype {
        kind: EffectKind::Air,
        word: "air",
        name: "air",
        stage: Stage::Color,
        default_mode: Mode::Global,
        subject: ("color", "vec3f"),
        context: POINT,
        result: "vec3f",
        is_style: false,
        touches_lines: false,
        asked_by: AskedBy::Program,
        parameters: PARAMETERS,
        when: "after the standard scene style",
    },
    Prototype {
        kind: EffectKind::Post,
        word: "post",
        name: "post style",
        stage: Stage::Color,
        default_mode: Mode::Local,
        subject: ("color", "vec3f"),
        context: POINT,
        result: "vec3f",
        is_style: true,
        touches_lines: true,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "for every pixel, after it",
    },
    Prototype {
        kind: EffectKind::Filter,
        word: "filter",
        name: "filter",
        stage: Stage::Color,
        default_mode: Mode::Local,
        subject: ("offset", "f32"),
        context: None,
        result: "f32",
        is_style: true,
        touches_lines: false,
        asked_by: AskedBy::Effects,
        parameters: PARAMETERS,
        when: "the kernel of a blur or the like: a weight for each distance in pixels; its first parameter is `radius`, at most 64",
    },
];

/// The words of all prototypes, in their order.
const WORDS: [&str; PROTOTYPES.len()] = {
    let mut words = [""; PROTOTYPES.len()];
    let mut i = 0;
    while i < words.len() {
        words[i] = PROTOTYPES[i].word;
        i += 1;
    }
    words
};

impl Prototype {
    /// Whether users can drop in a handler.
    pub fn is_for_users(&self) -> bool {
        self.asked_by != AskedBy::Program
    }

    /// The declaration of a handler's function; `last` is its last parameter: nothing, or one with `, ` before it.
    pub fn signature(&self, last: &str) -> String {
        let (name, type_name) = self.subject;
        let context = self.context.map_or_else(String::new, |(name, type_name)| format!(", {name}: {type_name}"));
        format!("effect({name}: {type_name}{context}{last}) -> {}", self.result)
    }

    /// The words of the prototypes of which users can drop in handlers, as a sentence lists them.
    pub fn words_for_users() -> String {
        let words: Vec<&str> = PROTOTYPES.iter().filter(|row| row.is_for_users()).map(|row| row.word).collect();
        let (last, others) = words.split_last().expect("there are some");
        format!("{} or {last}", others.join(", "))
    }

    /// The kinds of the others, as a header says them.
    pub fn words_not_for_users() -> String {
        let of = |row: &Prototype| format!("kind = \"{}\"", row.word);
        PROTOTYPES.iter().filter(|row| !row.is_for_users()).map(of).collect::<Vec<_>>().join(", ")
    }
}

impl EffectKind {
    /// All, in the order of their execution.
    pub const ALL: [Self; PROTOTYPES.len()] = {
        let mut all = [Self::Transform; PROTOTYPES.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = PROTOTYPES[i].kind;
            i += 1;
        }
        all
    };

    /// Its row of the table.
    pub fn prototype(self) -> &'static Prototype {
        &PROTOTYPES[self as usize]
    }

    /// As people read it.
    pub fn name(self) -> &'static str {
        self.prototype().name
    }

    /// The first argument of its handlers, which all but hiding ones give back changed: name and type in WGSL.
    pub fn subject(self) -> (&'static str, &'static str) {
        self.prototype().subject
    }

    /// Whether its handlers take turns in lens order on the colour.
    pub fn is_style(self) -> bool {
        self.prototype().is_style
    }

    /// Whether its handlers have a say in how a line looks.
    pub fn touches_lines(self) -> bool {
        self.prototype().touches_lines
    }

    /// Whether its handlers decide what the geometry pass shows, by each fragment's own depth.
    pub fn decides_visibility(self) -> bool {
        self.prototype().stage == Stage::Visibility
    }

    /// Whether its handlers run before the surface has a colour.
    pub fn is_before_color(self) -> bool {
        self.prototype().stage == Stage::Surface
    }
}

impl<'de> Deserialize<'de> for EffectKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        let row = PROTOTYPES.iter().find(|row| row.word == word);
        row.map(|row| row.kind).ok_or_else(|| D::Error::unknown_variant(&word, &WORDS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_in_the_order_of_execution() {
        for (i, row) in PROTOTYPES.iter().enumerate() {
            assert_eq!((row.kind as usize, row.kind.prototype().word), (i, row.word));
        }
        assert!(PROTOTYPES.is_sorted_by_key(|row| row.stage));
        assert!(PROTOTYPES.iter().all(|row| !row.is_style || row.stage == Stage::Color));
    }

    #[test]
    fn the_docs_have_the_table() {
        let page = include_str!("../../../docs/effects.md");
        let rows = PROTOTYPES.iter().filter(|row| row.is_for_users());
        let row = |row: &Prototype| format!("  | `\"{}\"` | `{}` | {} |\n", row.word, row.signature(""), row.when);
        let table =
            format!("  | kind | function | when |\n  | --- | --- | --- |\n{}\n", rows.map(row).collect::<String>());
        assert!(page.contains(&table), "docs/effects.md lacks\n{table}");
    }
}
