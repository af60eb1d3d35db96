use super::*;
use crate::shader::effect::EffectKind;

const HEADER: &str = "//! name = \"mine\"\n//! kind = \"post\"\n//! spec = \"K3\"\n//! doc = \"Does it.\"\n";
const PARAMETER: &str = "//!\n//! [[parameter]]\n//! name = \"mode\"\n//! type = \"word\"\n//! words = [\"soft\", \"very-hard\"]\n\
                         //! default = \"soft\"\n//! doc = \"How.\"\n";

fn failure(text: &str) -> String {
    match checked("my.wgsl", text) {
        Ok(effect) => panic!("it passed: {}", effect.source),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_file_becomes_an_effect() {
    let body = "const TINT = vec3f(1.0, 0.5, 0.0);\n\
                fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {\n    \
                if p.mode == MODE_VERY_HARD { return TINT; }\n    return mix(color, TINT, 0.5);\n}\n";
    let effect = checked("my.wgsl", &format!("{HEADER}{PARAMETER}{body}")).unwrap();
    assert_eq!((effect.name.as_str(), effect.kind, effect.slots()), ("mine", EffectKind::Post, 1));
    assert!(effect.source.contains("fn user_mine(color: vec3f, point: Point, p: user_mine__Parameters) -> vec3f"));
    assert!(effect.source.contains("user_mine__MODE_VERY_HARD = 1u"));
    assert!(effect.source.contains("mix(color, user_mine__TINT"));
    let bare = "fn effect(color: vec3f, point: Point) -> vec3f { return 1.0 - color; }";
    assert_eq!(checked("my.wgsl", &format!("{HEADER}{bare}")).unwrap().slots(), 0);
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let good = "fn effect(color: vec3f, point: Point) -> vec3f { return color; }\n";
    for (text, expected) in [
        (String::new(), "my.wgsl:1:1: expected a header"),
        (
            format!("//! name = \"Mine\"\n//! kind = \"post\"\n//! spec = \"\"\n//! doc = \"\"\n{good}"),
            "my.wgsl:1:12: expected a name",
        ),
        (
            HEADER.replace("post", "past"),
            "my.wgsl:2:12: unknown variant `past`, expected one of `transform`, `deform`, `ray`, `region`, `epoch`, `hide`, `opacity`, `material`, `light`, `scene`, `air`, `post`, `filter`",
        ),
        (
            format!("{}{good}", HEADER.replace("post", "air")),
            "my.wgsl:1:1: mode (but of deformations), derivative, and kind = \"air\", are for handlers of the program; expected kind = transform, deform, ray, region, epoch, hide, opacity, material, light, \
             scene, post or filter",
        ),
        (HEADER.replace("spec", "spek"), "my.wgsl:3:5: unknown field `spek`"),
        (HEADER.to_owned(), "my.wgsl:5:1: expected `fn effect(color: vec3f, point: Point) -> vec3f`"),
        (
            format!("{HEADER}{PARAMETER}").replace("= \"soft\"", "= \"hart\""),
            "my.wgsl:10:15: the default must be one of soft, very-hard",
        ),
        (format!("{HEADER}{good}var<private> n: u32;"), "my.wgsl:6:14: an effect keeps nothing"),
        (
            format!("{HEADER}fn effect(color: vec3f, point: Point) -> vec3f {{\n    return colour;\n}}"),
            "my.wgsl:6:12: no definition in scope",
        ),
        (
            format!("{HEADER}fn effect(color: vec3f, point: Point) -> vec3f {{\n    return colour;\n}}\n\n\n\n\n"),
            "my.wgsl:6:12: no definition in scope",
        ),
        (
            format!("{HEADER}fn effect(color: vec3f) -> vec3f {{ return color; }}"),
            "my.wgsl:5:4: expected `fn effect(color: vec3f, point: Point) -> vec3f`",
        ),
        (
            format!("{HEADER}fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {{ return color; }}"),
            "my.wgsl:5:42: the header gives no [[parameter]] for WGSL; expected `fn effect(color: vec3f, point: Point) -> \
             vec3f`",
        ),
        (
            format!(
                "{HEADER}fn effect(color: vec3f, point: Point) -> vec3f {{\n    return vec3f(1.0, 2.0) + color;\n}}"
            ),
            "my.wgsl:6:",
        ),
        (
            format!("{HEADER}fn effect(color: vec3f, point: Point) -> vec3f {{\n    loop {{ }}\n}}"),
            "my.wgsl:6:5: it may never end",
        ),
        (format!("{HEADER}{good}fn f() {{ for (var i = 0; i < 9; i++) {{ i = 0; }} }}"), "my.wgsl:6:10: expected for"),
        (format!("{HEADER}{good}fn f() {{ for (var i = 0; i >= 0; i++) {{ }} }}"), "my.wgsl:6:10: expected for"),
        (format!("{HEADER}{good}fn f() {{ discard; }}"), "my.wgsl:6:10: an effect cannot take the pixel away"),
        (format!("{HEADER}{good}fn f() {{ f(); }}"), "my.wgsl:6:4: this takes more"),
        (format!("{HEADER}{}{good}", "//\n".repeat(1_000_000)), "my.wgsl:1:1: an effect file has at most"),
    ] {
        let found = failure(&text);
        assert!(found.starts_with(expected), "{found}\nis not\n{expected}");
    }
}

#[test]
fn every_kind_that_users_write_is_taken() {
    let header = |kind: &str| HEADER.replace("post", kind);
    let radius = "//!\n//! [[parameter]]\n//! name = \"radius\"\n//! type = \"number\"\n//! range = [1, 9]\n//! default = 3\n\
                  //! doc = \"How far.\"\n";
    for (kind, text) in [
        (
            "hide",
            "fn effect(fragment: Fragment) -> bool { return fragment.height > 6.0 && fragment.part != PART_TERRAIN; }",
        ),
        ("material", "fn effect(material: Material, point: Point) -> Material { return material; }"),
        ("light", "fn effect(arriving: vec3f, point: Point) -> vec3f { return arriving * 0.5; }"),
        ("scene", "fn effect(color: vec3f, point: Point) -> vec3f { return point.base; }"),
        ("post", "fn effect(color: vec3f, point: Point) -> vec3f { return color.bgr; }"),
    ] {
        assert_eq!(
            checked("my.wgsl", &format!("{}{text}", header(kind))).map(|e| e.name),
            Ok("mine".to_owned()),
            "{kind}"
        );
        let without = text.replacen("fn effect(", "fn effect(more: f32, ", 1);
        assert!(
            failure(&format!("{}{without}", header(kind))).starts_with("my.wgsl:5:4: expected `fn effect("),
            "{kind}"
        );
    }
    let ray = "fn effect(place: vec2f, size: vec3f, p: Parameters) -> vec3f { return vec3f(place, 1.0); }";
    let vectors = |count: usize| {
        let one = |i| {
            format!(
                "//!\n//! [[parameter]]\n//! name = \"v{i}\"\n//! type = \"vector\"\n//! default = [1, 2, 3]\n//! doc = \"\"\n"
            )
        };
        format!("{}{}{ray}", header("ray"), (0..count).map(one).collect::<String>())
    };
    assert!(checked("my.wgsl", &vectors(170)).is_ok());
    assert!(failure(&vectors(171)).contains("a ray handler has at most 512 numbers"));
    let flat = format!("{}fn effect(place: vec2f) -> vec2f {{ return place; }}", header("ray"));
    assert!(failure(&flat).starts_with("my.wgsl:5:4: expected `fn effect(place: vec2f, size: vec3f) -> vec3f`"));
    let kernel = "fn effect(offset: f32, p: Parameters) -> f32 { return exp(-offset * offset / p.radius); }";
    assert!(checked("my.wgsl", &format!("{}{radius}{kernel}", header("filter"))).is_ok());
    let lines = radius.replace("radius", "line_width");
    let color = "//!\n//! [[parameter]]\n//! name = \"line_color\"\n//! type = \"color\"\n//! default = \"#102030\"\n//! doc = \"Which.\"\n";
    let drawing = header("scene").replace("//! spec", "//! lines = true\n//! spec");
    let body = "fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f { return vec3f(0.9); }";
    assert!(checked("my.wgsl", &format!("{drawing}{lines}{color}{body}")).is_ok_and(|e| e.lines));
    assert!(failure(&format!("{drawing}{color}{body}")).contains("\"line_width\""));
}

#[test]
fn what_would_take_for_ever_is_refused() {
    let nested =
        "for (var i = 0; i < 1000; i++) { for (var j = 0; j < 1000; j++) { for (var k = 0; k < 1000; k++) { } } }";
    let effect = "fn effect(color: vec3f, point: Point) -> vec3f { return color; }\n";
    assert!(failure(&format!("{HEADER}{effect}fn f() {{ {nested} }}")).contains("steps per pixel"));
    let mut chain = String::from("fn f0(x: f32) -> f32 { return x; }\n");
    for i in 1..60 {
        chain += &format!("fn f{i}(x: f32) -> f32 {{ return f{0}(x) + f{0}(x); }}\n", i - 1);
    }
    assert!(failure(&format!("{HEADER}{chain}{effect}")).contains("steps per pixel"));
    let fine = "fn f() -> f32 { var s = 0.0; for (var i = 0; i < 64; i++) { s += f32(i); } return s; }\n";
    assert!(checked("my.wgsl", &format!("{HEADER}{fine}{effect}")).is_ok());
}

#[test]
fn what_a_validator_says_is_put_into_words() {
    let effect = |body: &str| format!("{HEADER}fn effect(color: vec3f, point: Point) -> vec3f {{\n    {body}\n}}\n");
    let without = effect("if color.x > 0.5 { return color; }");
    assert!(
        failure(&without).ends_with(": not every way through the function returns a value"),
        "{}",
        failure(&without)
    );
    let mixed = effect("let two = color.xy;\n    return color + two;");
    let said = failure(&mixed);
    assert!(said.contains("vec3") && said.contains("vec2") && !said.contains('['), "{said}");
}

#[test]
fn names_that_clash_with_ours_do_no_harm() {
    let text = format!(
        "{HEADER}fn luminance(c: vec3f) -> f32 {{ return c.g; }}\nconst mine_x = 2.0;\n\
         fn effect(color: vec3f, point: Point) -> vec3f {{ let depth = point.depth; return vec3f(luminance(color) * mine_x + depth); }}"
    );
    assert!(checked("my.wgsl", &text).is_ok());
}

#[test]
fn names_that_effects_are_given_are_told_and_their_types_refused() {
    let file = |own: &str| {
        format!(
            "//! name = \"mine\"\n//! kind = \"post\"\n//! spec = \"mine\"\n//! doc = \"Mine.\"\n\n{own}\n\nfn effect(color: vec3f, point: Point) -> vec3f {{\n    return color;\n}}\n"
        )
    };
    let told = |own: &str| redefined("a.wgsl", &file(own)).iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(told("const MINE = 3.0;\nfn own_light(c: vec3f) -> f32 { return 0.5; }"), [""; 0]);
    let given = "is what effects are given, too; in this file it is the effect's own";
    assert_eq!(
        told("const FAR_AWAY = 3.0;\nfn luminance(c: vec3f) -> f32 { return 0.5; }"),
        [format!("a.wgsl:6:7: `FAR_AWAY` {given}"), format!("a.wgsl:7:4: `luminance` {given}")]
    );
    checked("a.wgsl", &file("const FAR_AWAY = 3.0;")).expect("a name of its own");
    for own in ["struct Point { a: f32 }", "alias Point = f32;"] {
        let error = checked("a.wgsl", &file(own)).expect_err("the type is given").to_string();
        assert!(error.starts_with("a.wgsl:6:") && error.contains("`Point` is what effects are called with"), "{error}");
    }
}
