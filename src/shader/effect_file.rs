//! Effect files (C4): WGSL with a header of TOML in `//!` lines.
//!
//! ```wgsl
//! //! name = "posterise"
//! //! kind = "post"
//! //! spec = "K3"
//! //! doc = "Few steps of lightness instead of many."
//! //!
//! //! [[parameter]]
//! //! name = "steps"
//! //! type = "number"
//! //! range = [2, 16]
//! //! default = 4
//! //! doc = "How many."
//!
//! fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
//!     return floor(color * p.steps) / p.steps;
//! }
//! ```
//!
//! `effect` gets the colour so far (linear light), the shown surface and its parameters, and returns the new colour.
//! Without parameters for WGSL it takes no `p`. The file may declare functions, constants, structs and aliases of its own:
//! every name it declares is qualified by the effect's, so that files never clash (H2).

use serde::Deserialize;
use toml::Spanned;

use crate::shader::{
    Module, Plan, Program, Scope, Step,
    effect::{
        DefaultValue, EffectDefinition, EffectKind, Fallback, MAX_RAMP, Mode, ParameterDefinition, ParameterKind,
        PerObject,
    },
    wgsl::{
        function::calls,
        rename::Renamed,
        token::{self, Declaration, Token, TokenKind, identifier},
    },
};

/// Lines of a user's file: more than any effect needs, few enough to compile in no time.
const MOST_LINES: usize = 2000;
/// Bytes of a user's file.
const MOST_BYTES: usize = 128 * 1024;
/// Rounds of one loop.
const MOST_ROUNDS: u32 = 1024;
/// Words and marks that `effect` may run through for one pixel, loops and calls multiplied out.
const MOST_STEPS: u64 = 1_000_000;
/// Pixels that a filter reaches to either side.
pub const MOST_REACH: u32 = 64;
/// Pixels that a line may be wide.
pub const MOST_LINE_WIDTH: f64 = 64.0;
/// Keys of a use of an effect that are no parameters.
pub const RESERVED: &[&str] = &["effect", "class", "blend", "weight"];
/// What every effect may use beside its own names.
const OUTER_NAMES: &[&str] = &["Parameters", "effect"];

/// What is wrong with an effect file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}:{line}:{column}: {message}")]
pub struct FileError {
    /// The file.
    pub path: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// What is wrong, and what was expected.
    pub message: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    name: Spanned<String>,
    kind: EffectKind,
    #[serde(default)]
    mode: Mode,
    spec: String,
    doc: String,
    objects: Option<PerObject>,
    #[serde(default)]
    lines: bool,
    #[serde(default, rename = "parameter")]
    parameters: Vec<ParameterHeader>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterHeader {
    name: Spanned<String>,
    r#type: Spanned<TypeName>,
    range: Option<Spanned<[f64; 2]>>,
    words: Option<Vec<String>>,
    default: Option<Spanned<DefaultValue>>,
    without: Option<String>,
    #[serde(default)]
    required: bool,
    #[serde(default)]
    unit: String,
    doc: String,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum TypeName {
    Boolean,
    Number,
    Text,
    Word,
    Color,
    Numbers,
    Texts,
    Shares,
    Colors,
}

/// Parameters that more than one effect has.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SharedParameters {
    #[serde(rename = "parameter")]
    parameters: Vec<ParameterHeader>,
}

/// Those by which effects choose objects ([`PerObject::Chosen`]).
const CHOICE: &str = include_str!("../../shaders/effect/choice.toml");

/// A file while it is read.
struct File<'a> {
    path: &'a str,
    text: &'a str,
}

impl File<'_> {
    fn error(&self, at: usize, message: impl Into<String>) -> FileError {
        let (line, column) = token::line_and_column(self.text, at);
        FileError { path: self.path.to_owned(), line, column, message: message.into() }
    }

    /// The TOML of the header, and where each of its lines begins: in itself and in the file.
    fn header(&self) -> (String, Vec<(usize, usize)>) {
        let (mut toml, mut starts, mut at) = (String::new(), Vec::new(), 0);
        for line in self.text.split_inclusive('\n') {
            let Some(rest) = line.strip_prefix("//!") else { break };
            let rest = rest.strip_prefix(' ').unwrap_or(rest);
            starts.push((toml.len(), at + line.len() - rest.len()));
            toml.push_str(rest);
            at += line.len();
        }
        (toml, starts)
    }
}

/// Where a place of the header stands in the file.
fn in_file(starts: &[(usize, usize)], at: usize) -> usize {
    let line = starts.partition_point(|&(toml, _)| toml <= at).saturating_sub(1);
    starts.get(line).map_or(0, |&(toml, file)| file + (at - toml))
}

/// Reads an effect file; that its WGSL is right is for [`checked`] to say.
pub fn read(path: &str, text: &str) -> Result<EffectDefinition, FileError> {
    read_with_names(path, text, false).map(|(effect, _)| effect)
}

fn read_with_names(path: &str, text: &str, is_users: bool) -> Result<(EffectDefinition, Renamed), FileError> {
    let file = File { path, text };
    let (toml, starts) = file.header();
    if toml.is_empty() {
        return Err(file.error(0, "expected a header: lines that begin with //! and hold name, kind, spec and doc"));
    }
    let header: Header = toml::from_str(&toml).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        file.error(in_file(&starts, at), error.message().to_owned())
    })?;
    let at = |span: std::ops::Range<usize>| in_file(&starts, span.start);
    if !is_effect_name(header.name.get_ref()) {
        let message = "expected a name of a-z, 0-9 and single -, a letter first, at most 40 of them";
        return Err(file.error(at(header.name.span()), message));
    }
    let mut effect = EffectDefinition {
        name: header.name.into_inner(),
        kind: header.kind,
        mode: header.mode,
        spec: header.spec,
        doc: header.doc,
        parameters: Vec::new(),
        objects: header.objects,
        lines: header.lines,
        is_users,
        reads_below: false,
        asks_most_layers: false,
        source: String::new(),
        parameters_end: 0,
    };
    for parameter in header.parameters {
        let (span, name) = (parameter.name.span(), parameter.name.get_ref().clone());
        if !is_parameter_name(&name) || effect.parameters.iter().any(|p| p.name == name) {
            let message = "expected a new name of a-z, 0-9 and _, a letter first; not effect, class, blend or weight";
            return Err(file.error(at(span), message));
        }
        effect
            .parameters
            .push(parameter.definition().map_err(|(place, message)| file.error(place.map_or(at(span), &at), message))?);
    }
    if effect.objects == Some(PerObject::Chosen) {
        let shared: SharedParameters =
            toml::from_str(CHOICE).map_err(|error| file.error(0, format!("choice.toml: {}", error.message())))?;
        for parameter in shared.parameters {
            effect.parameters.push(parameter.definition().map_err(|(_, message)| file.error(0, message))?);
        }
    }
    let reaches = |p: &ParameterDefinition| {
        p.name == "radius" && matches!(p.kind, ParameterKind::Number { max, .. } if max <= f64::from(MOST_REACH))
    };
    if effect.kind == EffectKind::Filter && !effect.parameters.first().is_some_and(reaches) {
        let message =
            format!("expected a first parameter \"radius\", a number of at most {MOST_REACH}: how far it reaches");
        return Err(file.error(0, message));
    }
    let has = |name: &str, fits: fn(&ParameterKind) -> bool| {
        effect.parameters.iter().any(|p| p.name == name && fits(&p.kind))
    };
    let has_lines = has("line_color", |kind| *kind == ParameterKind::Color)
        && has("line_width", |kind| matches!(kind, ParameterKind::Number { max, .. } if *max <= MOST_LINE_WIDTH))
        && matches!(effect.kind, EffectKind::Hide | EffectKind::Scene);
    if effect.lines && !has_lines {
        let message = format!(
            "lines = true is for kind = \"hide\" or \"scene\" with parameters \"line_color\", a color, and \"line_width\", a \
             number of at most {MOST_LINE_WIDTH}"
        );
        return Err(file.error(0, message));
    }
    let tokens = token::tokens(text);
    let declared = token::declarations(text, &tokens);
    if let Some(bad) = declared.iter().find(|d| matches!(d.keyword, "var" | "override")) {
        let message = format!("an effect keeps nothing between pixels: no {} at the top of a file", bad.keyword);
        return Err(file.error(bad.span.start, message));
    }
    let Some(main) = declared.iter().find(|d| (d.keyword, d.name) == ("fn", "effect")) else {
        return Err(file.error(text.len(), format!("expected `{}`", signature(&effect))));
    };
    let is_parameters = |t: &&Token| t.kind == TokenKind::Word && &text[t.span.clone()] == "Parameters";
    if effect.slots() == 0
        && !declared.iter().any(|d| d.name == "Parameters")
        && let Some(token) = tokens.iter().find(is_parameters)
    {
        let message = format!("the header gives no [[parameter]] for WGSL; expected `{}`", signature(&effect));
        return Err(file.error(token.span.start, message));
    }
    effect.reads_below = reads_first_argument(text, &tokens, main);
    effect.asks_most_layers = calls(text, "most_layers") && !declared.iter().any(|d| d.name == "most_layers");
    let renamed = qualified(&effect, text, &tokens, &declared);
    effect.source = parameters_source(&effect);
    effect.parameters_end = effect.source.len();
    effect.source.push_str(body_of(&renamed.text));
    Ok((effect, renamed))
}

/// A file's text after its header and the blank lines below it.
fn body_of(text: &str) -> &str {
    let header: usize = text.split_inclusive('\n').take_while(|line| line.starts_with("//!")).map(str::len).sum();
    text[header..].trim_start_matches(['\n', '\r'])
}

/// What `effect` must look like.
fn signature(effect: &EffectDefinition) -> String {
    let parameters = if effect.slots() > 0 { ", p: Parameters" } else { "" };
    let (name, type_name) = effect.kind.subject();
    match effect.kind {
        EffectKind::Hide => return format!("fn effect({name}: {type_name}{parameters}) -> bool"),
        EffectKind::Filter => return format!("fn effect({name}: {type_name}{parameters}) -> {type_name}"),
        _ => {}
    }
    format!("fn effect({name}: {type_name}, point: Point{parameters}) -> {type_name}")
}

/// Whether the function that begins there names its first argument again.
fn reads_first_argument(text: &str, tokens: &[Token], function: &Declaration) -> bool {
    let begin = tokens.partition_point(|t| t.span.start < function.span.end);
    let word = |t: &Token| &text[t.span.clone()];
    let Some(name) = tokens.get(begin + 1).map(word) else { return true };
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(begin + 2) {
        match word(token) {
            "{" => depth += 1,
            "}" if depth == 1 => return false,
            "}" => depth -= 1,
            w if w == name && tokens[i - 1].kind != TokenKind::Mark(b'.') => return true,
            _ => {}
        }
    }
    false
}

/// The file with the effect's name before every name it declares; `effect` itself takes the effect's name.
fn qualified(effect: &EffectDefinition, text: &str, tokens: &[Token], declared: &[Declaration]) -> Renamed {
    let prefix = effect.wgsl_name();
    let constants: Vec<String> = word_constants(effect).map(|(name, _)| name).collect();
    Renamed::new(text, tokens, |word| {
        let is_own = declared.iter().any(|d| d.name == word) || constants.iter().any(|c| c == word);
        match word {
            "effect" => Some(prefix.clone()),
            _ if is_own || OUTER_NAMES.contains(&word) => Some(effect.own(word)),
            _ => None,
        }
    })
}

/// `PARAMETER_WORD` and its number, of all parameters that take words.
fn word_constants(effect: &EffectDefinition) -> impl Iterator<Item = (String, usize)> {
    let of = |p: &ParameterDefinition| {
        let words = if let ParameterKind::Word(words) = &p.kind { words.clone() } else { Vec::new() };
        let parameter = p.name.to_uppercase();
        let name = move |word: &str| format!("{parameter}_{}", identifier(&word.to_uppercase()));
        words.into_iter().enumerate().map(move |(i, word)| (name(&word), i)).collect::<Vec<_>>()
    };
    effect.shader_parameters().flat_map(move |(p, ..)| of(p)).collect::<Vec<_>>().into_iter()
}

/// The struct of an effect's parameters, and the function that reads it.
fn parameters_source(effect: &EffectDefinition) -> String {
    let mut fields: Vec<(String, &str, usize)> =
        effect.shader_parameters().map(|(p, type_name, floats)| (p.name.clone(), type_name, floats)).collect();
    if effect.objects.is_some() {
        fields.push(("first".to_owned(), "u32", 1));
    }
    if fields.is_empty() {
        return String::new();
    }
    let type_name = effect.own("Parameters");
    let mut text = format!("struct {type_name} {{\n");
    for (name, type_name, _) in &fields {
        text.push_str(&format!("    {name}: {type_name},\n"));
    }
    text.push_str("}\n\n");
    for (name, number) in word_constants(effect) {
        text.push_str(&format!("const {} = {number}u;\n", effect.own(&name)));
    }
    text.push_str(&format!("fn {}(first: u32) -> {type_name} {{\n", effect.own("parameters")));
    for slot in 0..effect.slots() {
        text.push_str(&format!("    let s{slot} = parameters[first + {slot}u];\n"));
    }
    let mut next = 0;
    let mut float = || {
        next += 1;
        format!("s{}.{}", (next - 1) / 4, ["x", "y", "z", "w"][(next - 1) % 4])
    };
    let values: Vec<String> = fields
        .iter()
        .map(|(_, type_name, _)| match *type_name {
            "bool" => format!("{} != 0.0", float()),
            "u32" => format!("u32({})", float()),
            "vec3f" => format!("vec3f({}, {}, {})", float(), float(), float()),
            _ => float(),
        })
        .collect();
    text.push_str(&format!("    return {type_name}({});\n}}\n\n", values.join(", ")));
    text
}

impl ParameterHeader {
    /// What it defines, or what is wrong and where in the header.
    fn definition(self) -> Result<ParameterDefinition, (Option<std::ops::Range<usize>>, String)> {
        let span = Some(self.r#type.span());
        let wrong = |message: &str| Err((span.clone(), message.to_owned()));
        let type_name = *self.r#type.get_ref();
        if self.range.is_some() && type_name != TypeName::Number {
            return wrong("only numbers have a range");
        }
        let kind = match (type_name, self.words) {
            (TypeName::Word, Some(words)) if !words.is_empty() && words.iter().all(|w| is_effect_name(w)) => {
                ParameterKind::Word(words)
            }
            (TypeName::Word, _) => return wrong("expected words = [...], each of a-z, 0-9 and -"),
            (_, Some(_)) => return wrong("only type = \"word\" has words"),
            (TypeName::Boolean, None) => ParameterKind::Boolean,
            (TypeName::Text, None) => ParameterKind::Text,
            (TypeName::Color, None) => ParameterKind::Color,
            (TypeName::Numbers, None) => ParameterKind::Numbers,
            (TypeName::Texts, None) => ParameterKind::Texts,
            (TypeName::Shares, None) => ParameterKind::Shares,
            (TypeName::Colors, None) => ParameterKind::Colors,
            (TypeName::Number, None) => match self.range.map(Spanned::into_inner) {
                None => ParameterKind::Number { min: f64::MIN, max: f64::MAX },
                Some([min, max]) if min < max => ParameterKind::Number { min, max },
                Some(_) => return wrong("expected range = [LOW, HIGH] with LOW < HIGH"),
            },
        };
        let fallback = match (self.required, self.default, self.without) {
            (true, None, None) => Fallback::Required,
            (false, Some(value), None) => {
                let (place, value) = (value.span(), value.into_inner());
                if !takes(&kind, &value) {
                    return Err((Some(place), format!("the default must be {}", kind.describe())));
                }
                Fallback::Value(value)
            }
            (false, None, Some(words)) => Fallback::Words(words),
            _ => return wrong("expected one of default = VALUE, without = \"WHAT HOLDS THEN\" and required = true"),
        };
        Ok(ParameterDefinition { name: self.name.into_inner(), kind, fallback, unit: self.unit, doc: self.doc })
    }
}

/// Whether a parameter of this kind may have this default.
fn takes(kind: &ParameterKind, value: &DefaultValue) -> bool {
    match (kind, value) {
        (ParameterKind::Boolean, DefaultValue::Boolean(_)) | (ParameterKind::Text, DefaultValue::Text(_)) => true,
        (ParameterKind::Number { min, max }, DefaultValue::Number(n)) => (*min..=*max).contains(n),
        (ParameterKind::Word(words), DefaultValue::Text(text)) => words.contains(text),
        (ParameterKind::Color, DefaultValue::Text(text)) => is_color(text),
        (ParameterKind::Colors, DefaultValue::Texts(list)) => is_ramp(list.len()) && list.iter().all(|t| is_color(t)),
        (ParameterKind::Shares, DefaultValue::Numbers(list)) => {
            is_ramp(list.len()) && list.iter().all(|n| (0.0..=1.0).contains(n))
        }
        _ => false,
    }
}

fn is_ramp(count: usize) -> bool {
    (1..=MAX_RAMP).contains(&count)
}

fn is_color(text: &str) -> bool {
    text.len() == 7 && text.starts_with('#') && text[1..].bytes().all(|b| b.is_ascii_hexdigit())
}

fn is_effect_name(name: &str) -> bool {
    name.len() <= 40
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-')
        && !name.contains("--")
        && !name.ends_with('-')
}

fn is_parameter_name(name: &str) -> bool {
    name.len() <= 40
        && !RESERVED.contains(&name)
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

/// Reads a user's effect file and checks that it can do no harm: its size, that its loops end, and its WGSL.
pub fn checked(path: &str, text: &str) -> Result<EffectDefinition, FileError> {
    let file = File { path, text };
    if text.len() > MOST_BYTES || text.lines().count() > MOST_LINES {
        let message = format!("an effect file has at most {MOST_LINES} lines and {MOST_BYTES} bytes");
        return Err(file.error(0, message));
    }
    let (effect, renamed) = read_with_names(path, text, true)?;
    if effect.objects.is_some() || effect.parameters.iter().any(|p| p.kind.is_ramp()) {
        let message = "objects, and parameters of type shares and colors, are for effects of the program";
        return Err(file.error(0, message));
    }
    check_control_flow(&file)?;
    check_cost(&file)?;
    if effect.mode != Mode::Local || effect.kind == EffectKind::Air {
        let message = "mode, and kind = \"air\", are for handlers of the program; expected kind = hide, opacity, material, light, scene, post or filter";
        return Err(file.error(0, message));
    }
    let steps = vec![Step { effect: 0, scope: Scope::Everywhere, parameters: 0, blend: None }];
    let module = match effect.kind {
        EffectKind::Filter => Module::Filter(0),
        EffectKind::Hide => Module::Geometry(Some(Program::Specialised(Plan { steps, ..Plan::default() }))),
        EffectKind::Opacity => Module::Composite(Program::Specialised(Plan { steps, ..Plan::default() })),
        _ => Module::Shade(Program::Specialised(Plan { steps, ..Plan::default() })),
    };
    let source = module.source_with(std::slice::from_ref(&effect));
    let body = body_of(&renamed.text).trim_end();
    let Some(own) = source.find(effect.source.trim_end()) else { unreachable!("a module without its only effect") };
    let begin = own + effect.parameters_end;
    let before = renamed.text.len() - body_of(&renamed.text).len();
    let place = |at: Option<usize>| match at {
        Some(at) if (begin..=begin + body.len()).contains(&at) => renamed.original(at - begin + before),
        // Beside the file: where it is called. Its signature is not what the caller expects.
        _ => token::declarations(text, &token::tokens(text))
            .iter()
            .find(|d| d.name == "effect")
            .map_or(0, |d| d.span.start),
    };
    let prefix = effect.own("");
    // Names in a message are the author's. Beside the file is the call: then the signature is wrong, whatever the parser makes of it.
    let own = |at: Option<usize>, message: String| match at {
        Some(at) if (begin..=begin + body.len()).contains(&at) => message.replace(&prefix, ""),
        _ => format!("expected `{}`", signature(&effect)),
    };
    let parsed = wgpu::naga::front::wgsl::parse_str(&source).map_err(|error| {
        let at = error.labels().next().and_then(|(span, _)| span.to_range()).map(|range| range.start);
        file.error(place(at), own(at, error.message().to_owned()))
    })?;
    let capabilities =
        wgpu::naga::valid::Capabilities::default() | wgpu::naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    let mut validator = wgpu::naga::valid::Validator::new(wgpu::naga::valid::ValidationFlags::all(), capabilities);
    validator.validate(&parsed).map_err(|error| {
        let at = error.spans().next().and_then(|(span, _)| span.to_range()).map(|range| range.start);
        file.error(place(at), own(at, in_words(error.as_inner())))
    })?;
    Ok(effect)
}

/// What a validator's error says, without the numbers by which it knows things.
fn in_words(error: &dyn std::error::Error) -> String {
    let mut innermost = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    let message = innermost.to_string();
    if message.contains("expression None does not match") {
        return "not every way through the function returns a value".to_owned();
    }
    // `[7] (of type Vector { size: Tri, ... })` is a vec3f; other handles are left out.
    let mut text = String::new();
    let mut rest = message.as_str();
    while let Some((before, after)) = rest.split_once('[') {
        let (number, tail) = after.split_once(']').unwrap_or(("", after));
        text.push_str(before);
        if !number.bytes().all(|b| b.is_ascii_digit()) || number.is_empty() {
            text.push('[');
            rest = after;
            continue;
        }
        rest = tail.trim_start();
        if let Some((kind, tail)) = rest.strip_prefix("(of type ").and_then(|r| r.split_once("})")) {
            let size = [("Bi", "vec2"), ("Tri", "vec3"), ("Quad", "vec4")]
                .into_iter()
                .find(|(word, _)| kind.contains(&format!("size: {word},")));
            text.push_str(size.map_or("another type", |(_, name)| name));
            rest = tail.strip_prefix(')').unwrap_or(tail);
        }
    }
    text.push_str(rest);
    text
}

/// Refuses what may never end, or leave a hole: `loop`, `while`, `discard`, and `for` but for
/// `for (var i = NUMBER; i < NUMBER; i++)` whose body leaves `i` alone.
fn check_control_flow(file: &File) -> Result<(), FileError> {
    let tokens = token::tokens(file.text);
    let word = |i: usize| tokens.get(i).map_or("", |t: &Token| &file.text[t.span.clone()]);
    for (i, token) in tokens.iter().enumerate().filter(|(_, t)| t.kind == TokenKind::Word) {
        let error = |message: &str| Err(file.error(token.span.start, message));
        match word(i) {
            "loop" | "while" => {
                return error("it may never end; expected for (var i = 0; i < NUMBER; i++), or no loop");
            }
            "discard" => {
                return error(
                    "an effect cannot take the pixel away; kind = \"hide\" returns true where something is hidden",
                );
            }
            "for" if !is_bounded(&tokens, i, &word) => {
                let message = format!(
                    "expected for (var i = NUMBER; i < NUMBER; i++) of at most {MOST_ROUNDS} rounds, whose body \
                     leaves i alone"
                );
                return error(&message);
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether the `for` at token `i` counts a variable of its own from one number up to another.
fn is_bounded<'a>(tokens: &[Token], i: usize, word: &impl Fn(usize) -> &'a str) -> bool {
    let name = word(i + 3);
    let head = ["for", "(", "var", name, "=", word(i + 5), ";", name, "<", word(i + 9), ";", name, "+", "+", ")", "{"];
    let integer = |text: &str| text.trim_end_matches(['u', 'i']).parse::<u32>().ok();
    let (Some(from), Some(to)) = (integer(word(i + 5)), integer(word(i + 9))) else { return false };
    if !(0..head.len()).all(|k| word(i + k) == head[k]) || to.saturating_sub(from) > MOST_ROUNDS {
        return false;
    }
    // Up to the brace that closes the body, nobody assigns to the variable or takes its address.
    let mut depth = 1;
    for k in i + head.len()..tokens.len() {
        match word(k) {
            "{" => depth += 1,
            "}" => depth -= 1,
            w if w == name && word(k - 1) != "." => {
                let assigns = match (word(k + 1), word(k + 2)) {
                    ("=", next) => next != "=",
                    ("+", "+" | "=") | ("-", "-" | "=") | ("*" | "/" | "%" | "&" | "|" | "^", "=") => true,
                    ("<", "<") | (">", ">") => word(k + 3) == "=",
                    _ => false,
                };
                if assigns || word(k - 1) == "&" {
                    return false;
                }
            }
            _ => {}
        }
        if depth == 0 {
            return true;
        }
    }
    false
}

/// Refuses what ends, but not in anybody's lifetime: loops in loops, and functions that call the next one twice.
fn check_cost(file: &File) -> Result<(), FileError> {
    let tokens = token::tokens(file.text);
    let declared = token::declarations(file.text, &tokens);
    let mut costs = Costs { file, tokens: &tokens, declared: &declared, known: Vec::new() };
    for declaration in declared.iter().filter(|d| d.keyword == "fn") {
        if costs.of(declaration.name, 0).is_none_or(|cost| cost > MOST_STEPS) {
            let message = format!("this takes more than {MOST_STEPS} steps per pixel, or calls itself");
            return Err(file.error(declaration.span.start, message));
        }
    }
    Ok(())
}

/// What the functions of a file cost.
struct Costs<'a> {
    file: &'a File<'a>,
    tokens: &'a [Token],
    declared: &'a [Declaration<'a>],
    known: Vec<(&'a str, u64)>,
}

impl<'a> Costs<'a> {
    /// Steps of one call; `None` for one that calls itself.
    fn of(&mut self, name: &'a str, depth: usize) -> Option<u64> {
        if let Some((_, cost)) = self.known.iter().find(|(known, _)| *known == name) {
            return Some(*cost);
        }
        // Deeper than there are functions: one calls itself.
        if depth > self.declared.len() {
            return None;
        }
        let begin = self.declared.iter().find(|d| d.keyword == "fn" && d.name == name)?.span.end;
        let first = self.tokens.partition_point(|t| t.span.start < begin);
        let (mut cost, mut rounds) = (0_u64, Vec::new());
        let mut pending = None;
        for (i, token) in self.tokens.iter().enumerate().skip(first) {
            let text = self.file.text;
            let word = &text[token.span.clone()];
            let times = rounds.iter().copied().fold(1, u64::saturating_mul);
            cost = cost.saturating_add(times);
            match word {
                "for" => {
                    let number = |k: usize| self.tokens.get(i + k).map_or("0", |t| &text[t.span.clone()]);
                    let integer = |text: &str| text.trim_end_matches(['u', 'i']).parse::<u64>().unwrap_or(0);
                    pending = Some(integer(number(9)).saturating_sub(integer(number(5))));
                }
                "{" => rounds.push(pending.take().unwrap_or(1)),
                "}" => {
                    rounds.pop();
                    if rounds.is_empty() {
                        break;
                    }
                }
                _ => {
                    let callee = self.declared.iter().find(|d| d.keyword == "fn" && d.name == word);
                    if let (TokenKind::Word, Some(callee)) = (token.kind, callee) {
                        cost = cost.saturating_add(times.saturating_mul(self.of(callee.name, depth + 1)?));
                    }
                }
            }
        }
        self.known.push((name, cost));
        Some(cost)
    }
}

#[cfg(test)]
mod tests;
