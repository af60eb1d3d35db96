//! Tables of the shapes that are given by a few fields: their rows come from the files of the forms ([`crate::geom::shape::form::given`]).

use std::marker::PhantomData;

use crate::{
    figure::scene_file::{
        forms::{Axis, Form, Same, Turn},
        keys::{FAR_M, Key, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        row::{Given as Taken, Row, Variant, keys},
    },
    geom::shape::{
        OfVolume, Shape, Volume,
        form::{
            given::{Field, Given, MOST_FIELDS, Quantity, Value},
            given_forms,
        },
    },
    lens::Region,
};

macro_rules! variants {
    ($($form:ty;)*) => {
        /// All of them, in the order of the docs.
        pub const GIVEN: &[Variant<Region>] = &[$(Rows::<$form>::VARIANT),*];
    };
}
given_forms!(variants);

/// These and others behind them.
pub const fn with<const N: usize>(others: &[Variant<Region>]) -> [Variant<Region>; N] {
    let mut all = [GIVEN[0]; N];
    let mut i = 0;
    while i < N {
        all[i] = if i < GIVEN.len() { GIVEN[i] } else { others[i - GIVEN.len()] };
        i += 1;
    }
    all
}

/// A form's body among shapes.
trait Shaped: Given + OfVolume + Into<Volume> {}

impl<T: Given + OfVolume + Into<Volume>> Shaped for T {}

/// The rows of a form.
struct Rows<T>(PhantomData<T>);

/// The row that says which shape it is, and one for each field.
const MOST_ROWS: usize = MOST_FIELDS + 1;

impl<T: Shaped> Rows<T> {
    /// The rest repeats the first.
    const ALL: [Row<Region>; MOST_ROWS] = [
        kind::<T>(),
        row::<T, 0>(),
        row::<T, 1>(),
        row::<T, 2>(),
        row::<T, 3>(),
        row::<T, 4>(),
        row::<T, 5>(),
        row::<T, 6>(),
    ];
    const ALL_KEYS: [Key; MOST_ROWS] = keys(&Self::ALL);
    const ROWS: &'static [Row<Region>] = Self::ALL.split_at(T::FIELDS.len() + 1).0;
    const KEYS: &'static [Key] = Self::ALL_KEYS.split_at(T::FIELDS.len() + 1).0;
    const VARIANT: Variant<Region> = Variant {
        table: Table { name: T::NAME, doc: T::DOC, keys: Self::KEYS },
        rows: Self::ROWS,
        default: || Region::Shape(Shape::of_given(T::DEFAULT.into())),
        is: |region| own::<T>(region).is_some(),
    };
}

const fn kind<T: Given>() -> Row<Region> {
    Row::joint(key("kind", Kind::Text, "", "", "Which shape.", T::QUOTED), |_, _| Some(Data::Text(T::NAME.to_owned())))
        .always()
}

/// The row of a field; of one that is not there, as of the shape's kind.
const fn row<T: Shaped, const I: usize>() -> Row<Region> {
    if I < T::FIELDS.len() { Row::new(key_of(&T::FIELDS[I]), get::<T, I>, set::<T, I>) } else { kind::<T>() }
}

const fn key_of<T>(field: &Field<T>) -> Key {
    let (kind, unit) = match field.quantity {
        Quantity::Place => (Kind::Point, "m"),
        Quantity::Length => (Kind::Number { min: 0.0, max: FAR_M }, "m"),
        Quantity::Lengths => (Kind::Lengths, "m"),
        Quantity::Direction => (Kind::Direction, ""),
        Quantity::Turn => (Kind::Angles, "degrees"),
    };
    key(field.name, kind, field.default, unit, field.doc, field.example)
}

/// The shape's own numbers, if it is of this form.
fn own<T: Shaped>(region: &Region) -> Option<T> {
    let Region::Shape(shape) = region else { return None };
    T::of_volume(&shape.given()?).cloned()
}

fn get<T: Shaped, const I: usize>(region: &Region, _: &Options) -> Option<Data> {
    let field = &T::FIELDS[I];
    match (field.at)(&mut own::<T>(region)?) {
        Value::Number(number) => Same::data(number),
        Value::Vector(way) if field.quantity == Quantity::Direction => Axis::data(way),
        Value::Vector(vector) => Same::data(vector),
        Value::Turn(turn) => Turn::data(turn),
    }
}

fn set<T: Shaped, const I: usize>(region: &mut Region, given: &mut Taken) {
    let Some(mut own) = own::<T>(region) else { return };
    let (field, node): (_, &Node) = (&T::FIELDS[I], given.node);
    match (field.at)(&mut own) {
        Value::Number(number) => Same::take(node, number),
        Value::Vector(way) if field.quantity == Quantity::Direction => Axis::take(node, way),
        Value::Vector(vector) => Same::take(node, vector),
        Value::Turn(turn) => Turn::take(node, turn),
    }
    *region = Region::Shape(Shape::of_given(own.into()));
}
