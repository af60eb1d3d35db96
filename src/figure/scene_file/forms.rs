//! Forms that values have in scene files, both ways.

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::{
    city::{Materials, lifetime::Undated, load::Up},
    figure::scene_file::node::{Data, Node},
    lens::{
        BorderUnit, Class, Discrete, LensBody, Parameter,
        best_view::MapMode,
        color::{parse_hex, to_hex},
        ramp::{MAX_CATEGORIES, category},
        ray::{FisheyeProjection, RayMethod, RayOutline},
        sprite::{Format, Mapping},
    },
    scene::{
        Background, BaseStyle, PiecePlace, StyleLook, Technique,
        animation::Numbers,
        overlay::{Along, BuiltInFrame, LineEnd, LineKind, Outside, Sizes},
        volume::{VolumeLight, VolumeMode},
    },
    shader::Clip,
    view::path::Speed,
    visibility::Reference,
};

/// How a `V` stands in files.
pub trait Form<V> {
    /// As files have it; `None`: there is nothing to say.
    fn data(value: &V) -> Option<Data>;
    /// Takes over what is right.
    fn take(node: &Node, into: &mut V);
}

impl<F, V: Default> Form<Option<V>> for F
where
    F: Form<V>,
{
    fn data(value: &Option<V>) -> Option<Data> {
        value.as_ref().and_then(F::data)
    }

    fn take(node: &Node, into: &mut Option<V>) {
        F::take(node, into.get_or_insert_default());
    }
}

/// As it is.
pub struct Same;

/// A form by two functions.
macro_rules! form {
    ($form:ty, $value:ty, $data:expr, $read:expr) => {
        impl Form<$value> for $form {
            fn data(value: &$value) -> Option<Data> {
                let data: fn(&$value) -> Data = $data;
                Some(data(value))
            }

            fn take(node: &Node, into: &mut $value) {
                let read: fn(&Node) -> Option<$value> = $read;
                if let Some(value) = read(node) {
                    *into = value;
                }
            }
        }
    };
}

form!(Same, f64, |n| (*n).into(), Node::number);
form!(Same, bool, |is| (*is).into(), |node| match node.data {
    Data::Boolean(is) => Some(is),
    _ => None,
});
form!(Same, u32, |n| (*n).into(), |node| match node.data {
    Data::Integer(n) => u32::try_from(n).ok(),
    _ => None,
});
form!(Same, String, |text| text.into(), |node| node.text().map(str::to_owned));
form!(Same, Vec<String>, |texts| Data::list(texts), |node| Some(node.texts()));
form!(Same, DVec3, |p| (*p).into(), |node| node.numbers::<3>().map(DVec3::from));
form!(Same, DVec2, |p| (*p).into(), |node| node.numbers::<2>().map(DVec2::from));
form!(Same, [f64; 2], |pair| (*pair).into(), Node::numbers::<2>);
form!(Same, [u32; 2], |pair| Data::list(*pair), |node| node.numbers::<2>().map(|pair| pair.map(|n| n as u32)));
form!(Same, Vec<f64>, |all| Data::list(all.iter().copied()), |node| Some(
    node.list()?.iter().filter_map(Node::number).collect()
));
form!(Same, Vec<DVec3>, |all| Data::list(all.iter().copied()), |node| Some(
    node.list()?.iter().filter_map(|p| p.numbers::<3>().map(DVec3::from)).collect()
));
form!(Same, Vec<DVec2>, |all| Data::list(all.iter().copied()), |node| Some(
    node.list()?.iter().filter_map(|p| p.numbers::<2>().map(DVec2::from)).collect()
));
form!(Same, Vec<Vec<DVec2>>, |all| Data::list(all.iter().map(|ring| Data::list(ring.iter().copied()))), |node| Some(
    node.list()?.iter().filter_map(ring).collect()
));
form!(Same, Vec<[f64; 4]>, |all| Data::list(all.iter().copied()), |node| Some(
    node.list()?.iter().filter_map(Node::numbers::<4>).collect()
));
form!(Same, Numbers, numbers_data, numbers);

fn ring(node: &Node) -> Option<Vec<DVec2>> {
    node.list()?.iter().map(|p| p.numbers::<2>().map(DVec2::from)).collect()
}

fn numbers_data(numbers: &Numbers) -> Data {
    match numbers {
        Numbers::One(number) => (*number).into(),
        Numbers::List(list) => Data::list(list.iter().map(numbers_data)),
    }
}

/// The numbers of a value; `None` where it has others.
pub fn numbers(node: &Node) -> Option<Numbers> {
    match &node.data {
        Data::Integer(_) | Data::Number(_) => node.number().filter(|n| n.is_finite()).map(Numbers::One),
        Data::List(all) if !all.is_empty() => all.iter().map(numbers).collect::<Option<_>>().map(Numbers::List),
        _ => None,
    }
}

/// An angle in degrees, radians in memory.
pub struct Degrees;

form!(Degrees, f64, |radians| degrees(*radians).into(), |node| node.number().map(f64::to_radians));

/// A list of names, or the one alone.
pub struct Names;

form!(
    Names,
    Vec<String>,
    |names| match &names[..] {
        [one] => one.into(),
        all => Data::list(all),
    },
    |node| Some(node.names())
);

/// A direction, of length 1 in memory.
pub struct Axis;

form!(Axis, DVec3, |axis| (*axis).into(), |node| unit(node.numbers::<3>()?.into()));

/// A unit vector; one that is one stays as it is, to the bit: written and read again it must not drift.
fn unit(v: DVec3) -> Option<DVec3> {
    if (v.length_squared() - 1.0).abs() < 1e-15 { Some(v) } else { v.try_normalize() }
}

/// Yaw, pitch and roll in degrees.
pub struct Turn;

form!(Turn, DQuat, |turn| angles(*turn).into(), |node| node.numbers::<3>().map(rotation));

/// A colour: `"#rrggbb"`, or numbers where that is not exact.
pub struct Color;

form!(Color, [f32; 3], |c| color_data(*c), color);

fn color_data(c: [f32; 3]) -> Data {
    let hex = to_hex(c);
    if parse_hex(&hex) == Some(c) { Data::Text(hex) } else { Data::list(c.map(shortest)) }
}

/// The number with the fewest digits that is rounded to this one.
fn shortest(n: f32) -> f64 {
    format!("{n:?}").parse().unwrap_or_else(|_| n.into())
}

/// The colour a value means, sRGB.
pub fn color(node: &Node) -> Option<[f32; 3]> {
    match &node.data {
        Data::Text(text) => parse_hex(text),
        _ => node.numbers::<3>().filter(|c| c.iter().all(|c| (0.0..=1.0).contains(c))).map(|c| c.map(|c| c as f32)),
    }
}

/// Behind the city: `"sky"` or a colour.
pub struct Behind;

impl Form<Background> for Behind {
    fn data(value: &Background) -> Option<Data> {
        match value {
            Background::Sky => None,
            Background::Color(c) => Some(color_data(*c)),
        }
    }

    fn take(node: &Node, into: &mut Background) {
        *into = color(node).map_or(Background::Sky, Background::Color);
    }
}

/// The colour of a lens that names none, by its place.
pub fn lens_color(index: usize) -> [f32; 3] {
    category(index % MAX_CATEGORIES)
}

/// One of some words.
pub struct Word;

/// What stands for itself by a word.
pub trait Worded: Copy + 'static {
    /// Its word.
    fn word(&self) -> &'static str;
    /// What a word stands for.
    fn of_word(word: &str) -> Option<Self>;
}

impl<V: Worded> Form<V> for Word {
    fn data(value: &V) -> Option<Data> {
        Some(value.word().into())
    }

    fn take(node: &Node, into: &mut V) {
        if let Some(value) = node.text().and_then(V::of_word) {
            *into = value;
        }
    }
}

/// Words of types, by a list of pairs.
macro_rules! words {
    ($($type:ty: $words:expr;)+) => {
        $(impl Worded for $type {
            fn word(&self) -> &'static str {
                $words.iter().find(|(_, value)| value == self).map_or("", |(word, _)| word)
            }

            fn of_word(word: &str) -> Option<Self> {
                $words.iter().find(|(own, _)| *own == word).map(|(_, value)| *value)
            }
        })+
    };
}

words! {
    StyleLook: Self::WORDS;
    BaseStyle: [("natural", Self::Natural), ("clay", Self::Clay)];
    LensBody: Self::WORDS;
    Class: [("inside", Self::Inside), ("front", Self::Front), ("behind", Self::Behind), ("rest", Self::Rest)];
    BorderUnit: [("m", Self::Metres), ("px", Self::Pixels), ("ray", Self::Ray)];
    Discrete: [("threshold", Self::Threshold), ("dither", Self::Dither)];
    RayOutline: [("circle", Self::Circle), ("square", Self::Square)];
    RayMethod: [("rays", Self::Rays), ("image", Self::Image), ("vertices", Self::Vertices)];
    FisheyeProjection: [("angular", Self::Angular), ("hemispherical", Self::Hemispherical)];
    Format: Self::WORDS;
    Mapping: Self::WORDS;
    MapMode: Self::WORDS;
    Along: Self::WORDS;
    Up: Self::WORDS;
    Materials: Self::WORDS;
    Undated: Self::WORDS;
    Sizes: Self::WORDS;
    BuiltInFrame: Self::WORDS;
    LineKind: Self::WORDS;
    LineEnd: Self::WORDS;
    Outside: Self::WORDS;
    Reference: Self::WORDS;
    VolumeMode: Self::WORDS;
    VolumeLight: Self::WORDS;
    Speed: [("keys", Self::Keys), ("constant", Self::Constant)];
    Clip: Self::ALL.map(|clip| (clip.word(), clip));
}

impl Worded for Technique {
    fn word(&self) -> &'static str {
        Self::word(*self)
    }

    fn of_word(word: &str) -> Option<Self> {
        Self::of_word(word)
    }
}

form!(Same, PiecePlace, place_data, |node| match node.text() {
    Some(word) => PiecePlace::of_word(word),
    None => node.numbers::<2>().map(PiecePlace::At),
});

fn place_data(place: &PiecePlace) -> Data {
    match place {
        PiecePlace::At(at) => (*at).into(),
        place => place.word().unwrap_or("auto").into(),
    }
}

/// The value of a parameter of an effect; `None` where it is of no kind that one has.
pub fn parameter(node: &Node) -> Option<Parameter> {
    match &node.data {
        Data::Boolean(b) => Some(Parameter::Boolean(*b)),
        Data::Integer(_) | Data::Number(_) => node.number().map(Parameter::Number),
        Data::Text(t) => Some(Parameter::Text(t.clone())),
        Data::List(list) => {
            let numbers: Vec<f64> = list.iter().filter_map(Node::number).collect();
            let texts: Vec<String> = list.iter().filter_map(|n| n.text().map(str::to_owned)).collect();
            match list.len() {
                n if n == numbers.len() => Some(Parameter::Numbers(numbers)),
                n if n == texts.len() => Some(Parameter::Texts(texts)),
                _ => None,
            }
        }
        Data::Table(_) | Data::Date(_) => None,
    }
}

/// The value of a parameter, as files have it.
pub fn parameter_data(value: &Parameter) -> Data {
    match value {
        Parameter::Boolean(is) => (*is).into(),
        Parameter::Number(number) => (*number).into(),
        Parameter::Text(text) => text.into(),
        Parameter::Numbers(numbers) => Data::list(numbers.iter().copied()),
        Parameter::Texts(texts) => Data::list(texts),
    }
}

/// The rotation of a box: yaw counter-clockwise from above, pitch lifts its x end, roll about its own x; degrees.
pub fn rotation([yaw, pitch, roll]: [f64; 3]) -> DQuat {
    DQuat::from_rotation_z(yaw.to_radians())
        * DQuat::from_rotation_y(-pitch.to_radians())
        * DQuat::from_rotation_x(roll.to_radians())
}

/// The degrees with the fewest decimals that read back as the same radians; else the nearest there are.
pub fn degrees(radians: f64) -> f64 {
    let exact = radians.to_degrees();
    rounded(exact).find(|d| d.to_radians() == radians).unwrap_or(exact)
}

/// `n` with 0, 1, ... 13 decimals.
fn rounded(n: f64) -> impl Iterator<Item = f64> {
    (0..=13).filter_map(move |digits| format!("{n:.digits$}").parse().ok()).map(|d: f64| d + 0.0)
}

/// Yaw, pitch and roll of a rotation, degrees: the inverse of [`rotation`], with as few decimals as it takes.
pub fn angles(turn: DQuat) -> [f64; 3] {
    let m = DMat3::from_quat(turn.normalize());
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    // Looking straight up or down, yaw and roll turn about one axis: all of it is called yaw.
    let upright = x.x.hypot(x.y) < 1e-9;
    let yaw = if upright { (-y.x).atan2(y.y) } else { x.y.atan2(x.x) };
    let pitch = x.z.atan2(x.x.hypot(x.y));
    let roll = if upright { 0.0 } else { y.z.atan2(z.z) };
    // Half a turn is written as 180, whichever sign its rounding has.
    let half = |a: f64| if a < 1e-9 - 180.0 { a + 360.0 } else { a };
    let exact = [yaw, pitch, roll].map(f64::to_degrees).map(half);
    let same = |a: &[f64; 3]| {
        let q = rotation(*a);
        q == turn || -q == turn
    };
    let near =
        |a: &[f64; 3]| rotation(*a).dot(turn).abs() > 1.0 - 1e-15 && (0..3).all(|i| (a[i] - exact[i]).abs() < 1e-9);
    let candidates = || (0..=13).map(|n: usize| exact.map(|a| rounded(a).nth(n).unwrap_or(a)));
    candidates().find(same).or_else(|| candidates().find(near)).unwrap_or(exact)
}
