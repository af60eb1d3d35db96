//! How houses were built in which years: forms, storeys, roofs.

use crate::city::synth::{
    full::{
        blocks::Kind,
        frame::{Frame, STEP, steps},
        history::Era,
        house::{Form, Function, House},
    },
    house::Shape,
    random::Random,
};

/// What is built in a time: forms with weights, storeys from and to, their height, and how steep roofs are, hundredths.
struct Style {
    forms: &'static [(i64, Form)],
    storeys: [i64; 2],
    storey: i64,
    pitch: i64,
}

const GABLE: Form = Form::Plain(Shape::Gable);
const FLAT: Form = Form::Plain(Shape::Flat);
const HIP: Form = Form::Plain(Shape::Hip);
const SHED: Form = Form::Plain(Shape::Shed);
const MANSARD: Form = Form::Plain(Shape::Mansard);

fn style_of(year: i64) -> Style {
    match year {
        ..=1699 => {
            Style { forms: &[(60, Form::Gablet), (34, GABLE), (6, HIP)], storeys: [2, 3], storey: 2_700, pitch: 105 }
        }
        1700..=1849 => Style {
            forms: &[(50, GABLE), (28, MANSARD), (14, Form::Gablet), (8, HIP)],
            storeys: [3, 4],
            storey: 3_000,
            pitch: 85,
        },
        1850..=1914 => Style {
            forms: &[(46, MANSARD), (38, GABLE), (10, FLAT), (6, HIP)],
            storeys: [4, 5],
            storey: 3_400,
            pitch: 75,
        },
        1915..=1945 => {
            Style { forms: &[(66, GABLE), (18, HIP), (16, FLAT)], storeys: [3, 4], storey: 3_000, pitch: 80 }
        }
        1946..=1979 => {
            Style { forms: &[(48, FLAT), (40, GABLE), (12, SHED)], storeys: [3, 5], storey: 2_800, pitch: 45 }
        }
        _ => Style { forms: &[(58, FLAT), (22, GABLE), (20, SHED)], storeys: [4, 6], storey: 3_000, pitch: 40 },
    }
}

/// The rise of a roof over a house, and its setback in steps.
fn roof(form: Form, [width, depth]: [i64; 2], pitch: i64, random: &mut Random) -> (i64, i64) {
    let rise = |run: i64| (run * STEP * pitch / 100).min(7_000) / 100 * 100;
    let narrow = width.min(depth);
    match form {
        Form::Gablet => (rise(width / 2).max(1_500), 0),
        HIP => (rise(depth / 2).max(1_500), (narrow / 2 - 1).min(depth / 2).max(1)),
        GABLE => (rise(depth / 2).max(1_500), 0),
        SHED => (rise(depth).clamp(1_000, 2_400), 0),
        MANSARD => (random.range(28, 36) * 100, steps(1_500).min(narrow / 3)),
        _ => (0, 0),
    }
}

/// A house wall to wall with its neighbours.
pub fn town_house(frame: Frame, size: [i64; 2], kind: Kind, era: &Era, years: &[i64], random: &mut Random) -> House {
    let [width, depth] = size;
    let year = years[years.len() - 1];
    let style = style_of(year);
    let form = match random.pick(style.forms) {
        // Wide ones have their ridge along the street; narrow ones have no hips.
        Form::Gablet if width > steps(9_500) => GABLE,
        HIP if width <= depth => GABLE,
        MANSARD if width < steps(5_500) => GABLE,
        form => form,
    };
    let [least, most] = style.storeys;
    let (least, most) = if era.out < 0 { (least.min(3), most.min(4)) } else { (least, most) };
    let storeys = random.range(least, most);
    let plinth = random.range(2, 9) * 100;
    let (rise, inset) = roof(form, size, style.pitch + random.range(-8, 8), random);
    let function = match kind {
        Kind::Close | Kind::OldTown => {
            random.pick(&[(62, Function::Residential), (36, Function::Commercial), (2, Function::Public)])
        }
        _ => random.pick(&[(72, Function::Residential), (18, Function::Commercial), (10, Function::Office)]),
    };
    House {
        form,
        width,
        depth,
        eaves: storeys * style.storey + plinth,
        rise,
        inset,
        storey: style.storey,
        function,
        party: [true; 2],
        ..House::at(frame)
    }
}

/// The pattern of a row of houses; its frame is given later.
pub fn terrace(years: &[i64], size: [i64; 2], random: &mut Random) -> House {
    let style = style_of(years[years.len() - 1]);
    let form = random.pick(&[(54, GABLE), (30, FLAT), (16, SHED)]);
    let storeys = random.pick(&[(6, 2), (4, 3)]);
    let (rise, inset) = roof(form, size, style.pitch.min(80), random);
    let nowhere = Frame { origin: [0, 0], u: [0, 0], v: [0, 0] };
    House {
        form,
        width: size[0],
        depth: size[1],
        eaves: storeys * style.storey.min(3_000) + 300,
        rise,
        inset,
        storey: style.storey.min(3_000),
        party: [true; 2],
        ..House::at(nowhere)
    }
}

/// A house in a garden.
pub fn villa(frame: Frame, size: [i64; 2], years: &[i64], random: &mut Random) -> House {
    let style = style_of(years[years.len() - 1].max(1830));
    let form = match random.pick(&[
        (24, GABLE),
        (22, HIP),
        (12, FLAT),
        (10, SHED),
        (12, Form::Plain(Shape::Corner)),
        (10, Form::Pyramid),
        (10, Form::Gablet),
    ]) {
        HIP if size[0] <= size[1] => Form::Pyramid,
        form => form,
    };
    let storeys = random.range(1, 2);
    let (mut rise, mut inset) = roof(form, size, style.pitch.min(85), random);
    match form {
        Form::Plain(Shape::Corner) => {
            inset = (size[0].min(size[1]) * 55 / 100) / 2 * 2;
            rise = inset / 2 * STEP * 3 / 4;
        }
        Form::Pyramid => rise = size[0].min(size[1]) * STEP * 35 / 100,
        _ => {}
    }
    House {
        form,
        width: size[0],
        depth: size[1],
        eaves: storeys * 3_000 + random.range(2, 8) * 100,
        rise,
        inset,
        ..House::at(frame)
    }
}

/// A shed or back house in a yard.
pub fn shed(frame: Frame, [width, depth]: [i64; 2], random: &mut Random) -> House {
    let form = random.pick(&[(40, SHED), (35, GABLE), (25, FLAT)]);
    let is_house = random.chance(30);
    House {
        form,
        width,
        depth,
        eaves: if is_house { 5_400 } else { 2_600 } + random.range(0, 4) * 100,
        rise: match form {
            SHED => 1_000,
            GABLE => depth * STEP / 3,
            _ => 0,
        },
        storey: 2_600,
        function: if is_house { Function::Residential } else { Function::Outbuilding },
        ..House::at(frame)
    }
}
