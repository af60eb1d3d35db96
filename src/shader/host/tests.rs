use glam::{DMat3, DVec3};
use proptest::prelude::*;

use crate::{
    geom::deform::Operator,
    shader::{
        effect_file::checked,
        host::{HostProgram, Value},
    },
};

fn file(kind: &str, header: &str, body: &str) -> String {
    format!("//! name = \"mine\"\n//! kind = \"{kind}\"\n//! spec = \"mine\"\n//! doc = \"Mine.\"\n{header}\n{body}")
}

fn deformation(body: &str) -> Result<crate::shader::EffectDefinition, String> {
    checked("mine.wgsl", &file("deform", "//! reach = 1000", body)).map_err(|error| error.to_string())
}

/// The derivative by differences.
fn differences(f: &dyn Fn(DVec3) -> DVec3, at: DVec3) -> DMat3 {
    const H: f64 = 1e-6;
    let column = |axis: DVec3| (f(at + H * axis) - f(at - H * axis)) / (2.0 * H);
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

#[test]
fn derivatives_are_those_of_differences() {
    // Each of the functions that have a derivative, where it has one.
    let bodies = [
        "return vec3f(sin(place.x), cos(place.y), tan(0.2 * place.z));",
        "return vec3f(exp(0.1 * place.x), log(place.y), sqrt(place.z)) * inverseSqrt(place.x);",
        "return normalize(place) * length(place.xy) + cross(place, vec3f(1.0, 2.0, 3.0));",
        "return reflect(place, normalize(vec3f(1.0, 0.5, place.z)));",
        "return mix(place, place.zxy, 0.1 * place.y) + smoothstep(vec3f(0.0), vec3f(9.0), place);",
        "return vec3f(atan2(place.y, place.x), pow(place.x, place.y), atan(place.z)) + fract(place.yzx);",
        "return vec3f(clamp(place.x, 0.5, 7.0), min(place.y, place.z), max(place.x, place.z)) * abs(place - 4.0);",
        "return mat3x3f(place, place.yzx, vec3f(1.0)) * place + place * mat3x3f(place, place, place.zzz);",
        "return vec3f(sinh(0.1 * place.x), cosh(0.1 * place.y), tanh(0.1 * place.z)) / (1.0 + dot(place, place));",
        "return vec3f(asin(0.1 * place.x), acos(0.1 * place.y), exp2(0.1 * place.z)) + log2(place) + fma(place, place, place);",
        "return vec3f(determinant(mat2x2f(place.xy, place.yz)), distance(place, vec3f(9.0)), radians(degrees(place.x) * place.y));",
        "var sum = vec3f(0.0); for (var i = 0; i < 4; i++) { if i == 2 { continue; } sum += sin(place * (1.0 + f32(i))); } return sum;",
        "var a = array<f32, 3>(place.x, place.y, place.z); a[1] *= a[2]; var v = place; v.y = a[1]; v[2] += v.x; return v;",
        "switch i32(place.x) { case 1, 2: { return place * place; } default: { return select(place, -place, place > vec3f(2.0)); } }",
    ];
    for body in bodies {
        let text = format!("fn effect(place: vec3f, size: vec3f) -> vec3f {{ {body} }}");
        let program = deformation(&text).unwrap_or_else(|error| panic!("{body}: {error}")).host.expect("it runs");
        for at in [DVec3::new(1.3, 2.7, 3.1), DVec3::new(5.2, 0.8, 2.3)] {
            let value = |p: DVec3| program.vector(p, DVec3::ONE, &[]).expect("a vector").0;
            let (_, slope) = program.vector(at, DVec3::ONE, &[]).expect("a vector");
            let expected = differences(&value, at);
            // Of differences over 1e-6 with values to some hundreds.
            let apart = (slope - expected).to_cols_array().iter().fold(0.0_f64, |most, d| most.max(d.abs()));
            let size = expected.to_cols_array().iter().fold(1.0_f64, |most, d| most.max(d.abs()));
            assert!(apart < 1e-6 * size, "{body}\n{slope:?}\n{expected:?}");
        }
    }
}

#[test]
fn what_the_host_does_not_run_is_told_with_its_place() {
    let text = "fn effect(place: vec3f, size: vec3f) -> vec3f {\n    return vec3f(unpack2x16float(7u), 0.0);\n}";
    let error = deformation(text).expect_err("it is not run");
    assert!(error.starts_with("mine.wgsl:7:18: unpack2x16float is not run on the host"), "{error}");
    let text = "fn f(p: ptr<function, f32>) -> f32 { return *p; }\n\
                fn effect(place: vec3f, size: vec3f) -> vec3f { var a = 1.0; return vec3f(f(&a)); }";
    let error = deformation(text).expect_err("a pointer");
    assert!(error.contains("pointers are not run on the host; expected arithmetic"), "{error}");
    let text = "fn effect(place: vec3f, size: vec3f) -> vec3f {\n    workgroupBarrier();\n    return place;\n}";
    let error = deformation(text).expect_err("there are no others to wait for");
    assert!(error.starts_with("mine.wgsl:7:5: this is not run on the host"), "{error}");
    let text = "fn effect(place: vec3f, size: vec3f) -> f32 {\n    return 1.0;\n}";
    let error = deformation(text).expect_err("it gives another type");
    assert_eq!(error, "mine.wgsl:6:4: expected `fn effect(place: vec3f, size: vec3f) -> vec3f`");
    let header = file("deform", "", "fn effect(place: vec3f, size: vec3f) -> vec3f { return place; }");
    let error = checked("mine.wgsl", &header).expect_err("how far?").to_string();
    assert_eq!(
        error,
        "mine.wgsl:1:1: expected reach = METRES, or the name of a parameter: how far a place is moved at most"
    );
    let header = file("post", "//! reach = 3", "fn effect(color: vec3f, point: Point) -> vec3f { return color; }");
    let error = checked("mine.wgsl", &header).expect_err("no use").to_string();
    assert_eq!(error, "mine.wgsl:5:13: reach is for kind = \"deform\"");
    let header =
        file("deform", "//! reach = \"far\"", "fn effect(place: vec3f, size: vec3f) -> vec3f { return place; }");
    let error = checked("mine.wgsl", &header).expect_err("no such parameter").to_string();
    assert_eq!(error, "mine.wgsl:5:13: reach must be metres or the name of a number among the parameters");
}

#[test]
fn a_region_gives_a_number_and_its_gradient() {
    let text = file(
        "region",
        "//! [[parameter]]\n//! name = \"round\"\n//! type = \"number\"\n//! default = 0.5\n//! doc = \"How round.\"",
        "fn effect(place: vec3f, size: vec3f, p: Parameters) -> f32 {\n    return length(place) - 0.5 * size.x - p.round;\n}",
    );
    let program = checked("mine.wgsl", &text).expect("it is right").host.expect("it runs");
    let (value, slope) = program.number(DVec3::new(3.0, 4.0, 0.0), DVec3::splat(4.0), &[0.5]).expect("a number");
    assert_eq!(value, 2.5);
    assert!((slope - DVec3::new(0.6, 0.8, 0.0)).length() < 1e-15);
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    /// The steps of the program as the GPU has them are those of the host, which are written twice.
    #[test]
    fn steps_of_the_program_are_what_their_twins_are(
        at in prop::array::uniform3(-20.0..20.0f64),
        own in prop::array::uniform4(0.1..3.0f64),
        low in -30.0..0.0f64,
    ) {
        let [a, b, c, d] = own;
        let z = [low, low + 10.0 * a];
        let operators = [
            (Operator::Translate(DVec3::new(a, b, c)), vec![a, b, c]),
            (
                Operator::Scale { factors: DVec3::new(a, b, c), about: DVec3::splat(d) },
                vec![a - 1.0, b - 1.0, c - 1.0, d, d, d],
            ),
            (Operator::Shear { slope: glam::DVec2::new(a, b), base: c }, vec![a, b, c]),
            (Operator::Taper { z, factors: [b, c] }, vec![z[0], z[1], b, c]),
            (Operator::Twist { z, angles: [b, c] }, vec![z[0], z[1], b, c]),
            (
                Operator::Bend { curvature: 0.01 * a, y: z, about: d, base: b },
                vec![0.01 * a, z[0], z[1], d, b],
            ),
        ];
        let library = include_str!("../../../shaders/lib/deform.wgsl");
        for (operator, numbers) in operators {
            let own = crate::shader::handlers().iter().find(|h| h.name == operator.handler()).expect("its handler");
            // With what steps call, and nothing that is bound.
            let begin = library.find("// Adapters need not know a sine").expect("the sine");
            let functions = &library[begin..library.find("// How strong a lens is").expect("the control")];
            let jets = &library[library.find("// Changes of a place").expect("jets")..];
            let jets = &jets[..jets.find("// A way as a user's").expect("what follows")];
            let mut definition = own.clone();
            definition.source = format!("{functions}\n{jets}\n{}", own.source);
            let program = HostProgram::new(&definition).expect("it runs");
            // As the GPU has them, in f32.
            let numbers: Vec<f32> = numbers.iter().map(|n| *n as f32).collect();
            let Some(Value::Many(jet)) = program.step(DVec3::from(at), &numbers) else { panic!("a jet") };
            let [x, y, z] = jet[0].reals::<3>().expect("a way");
            let way = DVec3::new(x.value, y.value, z.value);
            let expected = operator.value(DVec3::from(at)) - DVec3::from(at);
            // Parameters in f32, and the sine of the GPU, are good to 2⁻²³ of numbers up to some hundreds.
            prop_assert!((way - expected).length() < 1e-4 * (1.0 + expected.length()), "{operator:?}: {way} {expected}");
            // Its derivative by its own formula, and as the numbers carry it.
            let Value::Many(columns) = &jet[1] else { panic!("columns") };
            for (i, column) in columns.iter().enumerate() {
                let column = column.reals::<3>().expect("a column");
                for (number, carried) in column.iter().zip([x, y, z]) {
                    prop_assert!((number.value - carried.slope[i]).abs() < 1e-5 * (1.0 + carried.slope[i].abs()), "{operator:?}");
                }
            }
        }
    }
}

/// `of_sky` of the pass, as the host runs it: its numbers are the place and the size of an effect.
fn light_of_a_slice() -> std::sync::Arc<HostProgram> {
    let file = include_str!("../../../shaders/pass/ambient-occlusion.wgsl");
    let functions =
        file.split("// Where angles from").nth(1).and_then(|rest| rest.split("// The cosine of the").next());
    let constants = "const PI: f32 = 3.14159265;\nconst HALF_PI: f32 = 1.57079633;\n//";
    let effect = "fn effect(place: vec3f, size: vec3f) -> vec3f {\n    \
        return vec3f(of_sky(place.x, place.y, place.z, size.x), 0.0, 0.0);\n}\n";
    let text = format!("{constants}{}\n{effect}", functions.expect("the functions"));
    deformation(&text).expect("they run").host.expect("on the host")
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    /// Between any two angles, with the sky anywhere: the closed form of the light of a slice against sums.
    #[test]
    fn the_light_of_a_slice_is_the_sum_over_its_angles(
        n in -1.57..1.57_f64, zenith in -3.13..3.13_f64, ends in [-1.57..1.57_f64, -1.57..1.57_f64]
    ) {
        const STEPS: i32 = 4_000;
        let (low, high) = (n + ends[0].min(ends[1]), n + ends[0].max(ends[1]));
        let width = (high - low) / f64::from(STEPS);
        let of = |i: i32| {
            let angle = low + width * (f64::from(i) + 0.5);
            let is_sky = (angle - zenith).cos() > 0.0;
            if is_sky { (angle - n).cos().max(0.0) * angle.sin().abs() * width } else { 0.0 }
        };
        let wanted: f64 = (0..STEPS).map(of).sum();
        let is = light_of_a_slice().vector(DVec3::new(low, high, n), DVec3::splat(zenith), &[]).expect("a number").0.x;
        // The step at the sky's border may lie half in it.
        prop_assert!((is - wanted).abs() < 1e-3, "{is}, {wanted}");
    }
}
