//! Expressions: read, written, held to a naive reader, and wrong.

use std::cmp::Ordering;

use proptest::prelude::*;

use super::*;
use crate::{
    city::{CityModel, Value, test_city::add_building},
    time::Interval,
};

/// What a row of the tests has of a name.
#[derive(Clone, Debug, PartialEq)]
enum Cell {
    Null,
    Truth(bool),
    Number(f64),
    Text(String),
}

const NAMES: [&str; 5] = ["height", "function", "Built", "odd name, with (signs)", "or"];

fn cell() -> impl Strategy<Value = Cell> {
    prop_oneof![
        Just(Cell::Null),
        any::<bool>().prop_map(Cell::Truth),
        (-20_i32..20).prop_map(|n| Cell::Number(f64::from(n) / 4.0)),
        (-20_i32..20).prop_map(|n| Cell::Text(n.to_string())),
        (1890_i32..1910, 1_u32..13, 1_u32..29).prop_map(|(y, m, d)| Cell::Text(format!("{y}-{m:02}-{d:02}"))),
        prop::sample::select(vec!["church", "School", "a \"b\"", "", "true", "and", "ä b"])
            .prop_map(|t| Cell::Text(t.to_owned())),
    ]
}

fn literal() -> impl Strategy<Value = Literal> {
    prop_oneof![
        (-20_i32..20).prop_map(|n| Literal::Number(f64::from(n) / 4.0)),
        (1890_i32..1910).prop_map(|y| Literal::Number(f64::from(y))),
        prop::sample::select(vec!["CHURCH", "chool", "a \"b\"", "\\", "true", "3", "and", "ä b"])
            .prop_map(|t| Literal::Text(t.to_owned())),
        (1890_i32..1910, 1_u32..13).prop_map(|(y, m)| {
            let text = format!("{y}-{m:02}");
            let date = Interval::parse(&text).expect("a month");
            Literal::Date(text, date)
        }),
    ]
}

fn name() -> impl Strategy<Value = Name> {
    prop::sample::select(&NAMES[..]).prop_map(|text| Name { text: text.to_owned(), column: 0 })
}

fn expression() -> impl Strategy<Value = Expression> {
    let relations = vec![
        Relation::Equal,
        Relation::Other,
        Relation::Less,
        Relation::AtMost,
        Relation::More,
        Relation::AtLeast,
        Relation::Contains,
    ];
    let leaf = prop_oneof![
        name().prop_map(Expression::Has),
        (name(), prop::sample::select(relations), literal()).prop_map(|(n, r, l)| Expression::Is(n, r, l)),
        (name(), literal(), prop::option::of(literal())).prop_map(|(n, l, h)| Expression::Between(n, Some(l), h)),
        (name(), literal()).prop_map(|(n, h)| Expression::Between(n, None, Some(h))),
        (name(), prop::collection::vec(literal(), 1..4)).prop_map(|(n, all)| Expression::OneOf(n, all)),
    ];
    leaf.prop_recursive(4, 24, 3, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 2..4).prop_map(Expression::Any),
            prop::collection::vec(inner.clone(), 2..4).prop_map(Expression::All),
            inner.prop_map(|one| Expression::Not(Box::new(one))),
        ]
    })
}

/// The same without columns.
fn bare(expression: Expression) -> Expression {
    let named = |name: Name| Name { column: 0, ..name };
    match expression {
        Expression::Any(all) => Expression::Any(all.into_iter().map(bare).collect()),
        Expression::All(all) => Expression::All(all.into_iter().map(bare).collect()),
        Expression::Not(one) => Expression::Not(Box::new(bare(*one))),
        Expression::Has(name) => Expression::Has(named(name)),
        Expression::Is(name, relation, literal) => Expression::Is(named(name), relation, literal),
        Expression::Between(name, low, high) => Expression::Between(named(name), low, high),
        Expression::OneOf(name, all) => Expression::OneOf(named(name), all),
    }
}

/// A city of one object a row.
fn city(rows: &[Vec<Cell>]) -> CityModel {
    let mut model = CityModel::default();
    let names = NAMES.map(|name| model.strings.intern(name));
    for (i, row) in rows.iter().enumerate() {
        let value = |cell: &Cell, model: &mut CityModel| match cell {
            Cell::Null => Value::Null,
            Cell::Truth(truth) => Value::Boolean(*truth),
            Cell::Number(n) if n.fract() == 0.0 => Value::Integer(*n as i64),
            Cell::Number(n) => Value::Number(*n),
            Cell::Text(text) => Value::String(model.strings.intern(text)),
        };
        let values: Vec<Value> = row.iter().map(|cell| value(cell, &mut model)).collect();
        add_building(&mut model, format!("house-{i}"), names.into_iter().zip(values));
    }
    model
}

/// Year, month and day of a text that is a day.
fn day(text: &str) -> Option<(i32, u32, u32)> {
    let mut parts = text.split('-');
    let (y, m, d) = (parts.next()?, parts.next()?, parts.next()?);
    (y.len() == 4 && parts.next().is_none()).then_some((y.parse().ok()?, m.parse().ok()?, d.parse().ok()?))
}

/// The order by the rules as people would put them, each written out.
fn naive_order(cell: &Cell, literal: &Literal) -> Option<Ordering> {
    let text = |cell: &Cell| match cell {
        Cell::Truth(truth) => truth.to_string(),
        Cell::Text(text) => text.clone(),
        Cell::Null | Cell::Number(_) => unreachable!("asked of texts"),
    };
    match (cell, literal) {
        (Cell::Null, _) => None,
        (Cell::Number(a), Literal::Number(b)) => a.partial_cmp(b),
        (Cell::Number(a), Literal::Text(b)) => a.partial_cmp(&b.parse::<f64>().ok()?),
        // Whole numbers are years, those of the tests before all dates.
        (Cell::Number(a), Literal::Date(..)) => (a.fract() == 0.0).then_some(Ordering::Less),
        (Cell::Text(a), Literal::Number(b)) => match (a.parse::<f64>(), day(a)) {
            (Ok(a), _) => a.partial_cmp(b),
            (_, Some((year, ..))) => f64::from(year).partial_cmp(b),
            _ => None,
        },
        (Cell::Text(a), Literal::Date(b, _)) => {
            let (y, m) = b.split_once('-')?;
            match (day(a), a.parse::<i32>()) {
                (Some(own), _) => Some((own.0, own.1).cmp(&(y.parse().ok()?, m.parse().ok()?))),
                (_, Ok(_)) => Some(Ordering::Less),
                _ => None,
            }
        }
        (Cell::Truth(_), Literal::Number(_) | Literal::Date(..)) => None,
        (_, Literal::Text(b)) => Some(text(cell).to_lowercase().cmp(&b.to_lowercase())),
    }
}

fn naive(expression: &Expression, row: &[Cell]) -> bool {
    let of = |name: &Name| &row[NAMES.iter().position(|own| *own == name.text).expect("a name")];
    let is = |cell: &Cell, relation: Relation, literal: &Literal| {
        let written = match cell {
            Cell::Null => return false,
            Cell::Truth(truth) => truth.to_string(),
            Cell::Number(n) => n.to_string(),
            Cell::Text(text) => text.clone(),
        };
        let wanted = match literal {
            Literal::Number(n) => n.to_string(),
            Literal::Text(text) | Literal::Date(text, _) => text.clone(),
        };
        let order = naive_order(cell, literal);
        match relation {
            Relation::Contains => written.to_lowercase().contains(&wanted.to_lowercase()),
            Relation::Equal => order == Some(Ordering::Equal),
            Relation::Other => order.is_some() && order != Some(Ordering::Equal),
            Relation::Less => order == Some(Ordering::Less),
            Relation::More => order == Some(Ordering::Greater),
            Relation::AtMost => order == Some(Ordering::Less) || order == Some(Ordering::Equal),
            Relation::AtLeast => order == Some(Ordering::Greater) || order == Some(Ordering::Equal),
        }
    };
    match expression {
        Expression::Any(all) => all.iter().filter(|one| naive(one, row)).count() > 0,
        Expression::All(all) => all.iter().filter(|one| !naive(one, row)).count() == 0,
        Expression::Not(one) => !naive(one, row),
        Expression::Has(name) => !matches!(of(name), Cell::Null | Cell::Truth(false)),
        Expression::Is(name, relation, literal) => is(of(name), *relation, literal),
        Expression::Between(name, low, high) => {
            *of(name) != Cell::Null
                && low.iter().all(|low| is(of(name), Relation::AtLeast, low))
                && high.iter().all(|high| is(of(name), Relation::AtMost, high))
        }
        Expression::OneOf(name, all) => all.iter().any(|one| is(of(name), Relation::Equal, one)),
    }
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn what_is_written_is_read_again(own in expression()) {
        let text = own.to_string();
        let read = parse(&text);
        prop_assert_eq!(read.map(bare), Ok(own), "{}", text);
    }

    #[test]
    fn objects_are_those_of_a_naive_reader(
        own in expression(),
        rows in prop::collection::vec(prop::collection::vec(cell(), NAMES.len()), 1..20),
    ) {
        let model = city(&rows);
        let found = Bound::new(&model, &own).objects();
        let expected: Vec<bool> = rows.iter().map(|row| naive(&own, row)).collect();
        prop_assert_eq!(found, expected, "{} of {:?}", own, rows);
    }

    /// Any text is an expression, or wrong at one of its columns or just behind it.
    #[test]
    fn any_text_has_an_answer(text in "\\PC{0,60}") {
        if let Err(error) = parse(&text) {
            prop_assert!((1..=text.chars().count() + 1).contains(&error.column), "{text:?}: {error}");
        }
    }

    /// The same of what was an expression until a character went, came or changed.
    #[test]
    fn damaged_expressions_have_an_answer(own in expression(), at in any::<prop::sample::Index>(), c in "[ ()<>=!.,\"`a-z0-9\\\\-]{0,2}") {
        let mut all: Vec<char> = own.to_string().chars().collect();
        let at = at.index(all.len());
        all.splice(at..=at, c.chars());
        let text: String = all.into_iter().collect();
        match parse(&text) {
            Ok(other) => prop_assert_eq!(parse(&other.to_string()).map(bare), Ok(bare(other)), "{}", text),
            Err(error) => prop_assert!((1..=text.chars().count() + 1).contains(&error.column), "{text:?}: {error}"),
        }
    }
}

#[test]
fn what_is_wrong_is_told_at_its_column() {
    for (text, column, part) in [
        ("", 1, "a name is missing here"),
        ("height >", 9, "a value is missing here"),
        ("height > and x", 10, "a value is missing before \"and\""),
        ("height > 3 x < 4", 12, "\"and\" or \"or\" is missing"),
        ("(height > 3", 12, "\")\" is missing"),
        ("height in 3", 12, "\"..\" is missing"),
        ("height in ..", 13, "a range has one end"),
        ("height in (3 4)", 14, "\",\" or \")\" is missing"),
        ("\"height\" > 3", 1, "not a text"),
        ("height > `x`", 10, "not a name"),
        ("function = \"school", 12, "has no end"),
        ("ä & b", 3, "says nothing here"),
        ("or = 3", 1, "`backquotes`"),
        ("not", 4, "a name is missing"),
    ] {
        let error = parse(text).expect_err(text);
        assert_eq!(error.column, column, "{text}: {error}");
        assert!(error.message.contains(part), "{text}: {error}");
    }
    let deep = format!("{}height{}", "(".repeat(100), ")".repeat(100));
    assert!(parse(&deep).expect_err("too deep").message.contains("in each other"));
    assert!(parse(&"a or ".repeat(5000)).expect_err("too long").message.contains("20000 characters"));
}

#[test]
fn expressions_mean_what_people_would_say() {
    let text = |text: &str| Cell::Text(text.to_owned());
    let rows = [
        vec![Cell::Number(30.0), text("Church"), text("1880-05-03"), Cell::Null, Cell::Null],
        vec![Cell::Number(12.5), text("school"), text("1899-12-31"), Cell::Truth(true), Cell::Null],
        vec![Cell::Null, text("School house"), text("1900-01-01"), Cell::Truth(false), Cell::Null],
        vec![text("7"), Cell::Null, Cell::Number(1950.0), Cell::Null, Cell::Number(1.0)],
    ];
    let mut model = city(&rows);
    // A part of the first house, without attributes.
    add_building(&mut model, "part".into(), []);
    let part = model.strings.intern("BuildingPart");
    (model.objects[4].kind, model.objects[4].parents) = (part, vec![0]);
    for (text, expected) in [
        ("height > 25 and built < 1900", vec![0, 4]),
        ("HEIGHT >= 7 and HEIGHT<=12.5", vec![1, 3]),
        ("height in 7..12.5", vec![1, 3]),
        ("height in ..8", vec![3]),
        ("height in 12.5 ..", vec![0, 1, 4]),
        ("not height > 25", vec![1, 2, 3]),
        ("height != 30", vec![1, 3]),
        ("function = CHURCH or function = school", vec![0, 1, 4]),
        ("function in (church, \"school house\")", vec![0, 2, 4]),
        ("function contains school", vec![1, 2]),
        ("built = 1899", vec![1]),
        ("built < 1899-12", vec![0, 4]),
        ("built in 1880-05..1899-12-31", vec![0, 1, 4]),
        ("built > 1899-12-31", vec![2, 3]),
        ("`odd name, with (signs)`", vec![1]),
        ("`or` = 1", vec![3]),
        ("type = Building and not (id contains house-1 or id = house-2)", vec![0, 3]),
        ("type = buildingpart", vec![4]),
        ("geometry.height > 0", vec![]),
        ("nowhere = 3", vec![]),
        ("not nowhere", vec![0, 1, 2, 3, 4]),
    ] {
        let expression = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let bound = Bound::new(&model, &expression);
        let found: Vec<usize> = bound.objects().iter().enumerate().filter_map(|(i, is)| is.then_some(i)).collect();
        assert_eq!(found, expected, "{text}");
        let unknown: Vec<&str> = bound.unknown().iter().map(|name| name.text.as_str()).collect();
        assert_eq!(unknown, if text.contains("nowhere") { vec!["nowhere"] } else { vec![] }, "{text}");
    }
}
