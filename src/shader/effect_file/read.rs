//! Effect files read: a header and WGSL become an effect.

use crate::shader::{
    effect::{
        definition::{Amount, EffectDefinition, PerObject},
        parameter::{ParameterDefinition, ParameterKind},
        prototype::EffectKind,
    },
    effect_file::{
        error::{File, FileError, in_file},
        header::{CHOICE, Header, MOST_LINE_WIDTH, MOST_REACH, SharedParameters, is_effect_name, is_parameter_name},
        parameters::{parameters_source, word_constants},
    },
    wgsl::{
        function::calls,
        rename::Renamed,
        token::{self, Declaration, Token, TokenKind},
    },
};

/// Names that every effect may use beside its own.
const OUTER_NAMES: &[&str] = &["Parameters", "effect"];

/// Reads an effect file; that its WGSL is right is for [`crate::shader::effect_file::check::checked`] to say.
pub fn read(path: &str, text: &str) -> Result<EffectDefinition, FileError> {
    read_with_names(path, text, false).map(|(effect, _)| effect)
}

/// Reads an effect file, of a user or of the program, and says which names were changed.
pub(super) fn read_with_names(
    path: &str,
    text: &str,
    is_users: bool,
) -> Result<(EffectDefinition, Renamed), FileError> {
    let file = File { path, text };
    let mut effect = of_header(&file, is_users)?;
    check_kernel(&file, &effect)?;
    check_lines(&file, &effect)?;
    let tokens = token::tokens(text);
    let declared = token::declarations(text, &tokens);
    let main = main_function(&file, &effect, &tokens, &declared)?;
    effect.reads_below = reads_first_argument(text, &tokens, main);
    effect.asks_most_layers = calls(text, "most_layers") && !declared.iter().any(|d| d.name == "most_layers");
    let renamed = qualified(&effect, text, &tokens, &declared);
    effect.source = parameters_source(&effect);
    effect.parameters_end = effect.source.len();
    effect.source.push_str(body_of(&renamed.text));
    Ok((effect, renamed))
}

/// The effect as its header defines it, without its WGSL.
fn of_header(file: &File, is_users: bool) -> Result<EffectDefinition, FileError> {
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
        mode: header.mode.unwrap_or(header.kind.prototype().default_mode),
        spec: header.spec,
        doc: header.doc,
        parameters: Vec::new(),
        objects: header.objects,
        lines: header.lines,
        has_derivative: header.derivative,
        reach: Amount::Number(f64::INFINITY),
        detail: None,
        host: None,
        is_users,
        reads_below: false,
        asks_most_layers: false,
        source: String::new(),
        parameters_end: 0,
    };
    let amounts = [("reach", header.reach), ("detail", header.detail)];
    for parameter in header.parameters {
        let (span, name) = (parameter.name.span(), parameter.name.get_ref().clone());
        if !is_parameter_name(&name) || effect.parameters.iter().any(|p| p.name == name) {
            let message =
                "expected a new name of a-z, 0-9 and _, a letter first; not effect, class, blend, weight or op";
            return Err(file.error(at(span), message));
        }
        let place = at(span);
        let parameter = parameter.definition().map_err(|(own, message)| file.error(own.map_or(place, &at), message))?;
        if parameter.kind.is_time() && effect.kind != EffectKind::Epoch {
            let message = "types moment, span, unit and clock are for kind = \"epoch\"";
            return Err(file.error(place, message));
        }
        let is_of_set = matches!(parameter.kind, ParameterKind::Instants | ParameterKind::Weights);
        if is_of_set && (is_users || effect.kind != EffectKind::Epoch) {
            let message = "types instants and weights are for the program's own aggregate; moment, span, unit and clock would be right";
            return Err(file.error(place, message));
        }
        effect.parameters.push(parameter);
    }
    for (key, amount) in amounts {
        let Some(amount) = amount else { continue };
        let (place, amount) = (at(amount.span()), amount.into_inner());
        check_amount(&effect, key, &amount).map_err(|message| file.error(place, message))?;
        match key {
            "reach" => effect.reach = amount,
            _ => effect.detail = Some(amount),
        }
    }
    if is_users && effect.kind == EffectKind::Deform && effect.reach == Amount::Number(f64::INFINITY) {
        let message = "expected reach = METRES, or the name of a parameter: how far a place is moved at most";
        return Err(file.error(0, message));
    }
    if effect.objects == Some(PerObject::Chosen) {
        let shared: SharedParameters =
            toml::from_str(CHOICE).map_err(|error| file.error(0, format!("choice.toml: {}", error.message())))?;
        for parameter in shared.parameters {
            effect.parameters.push(parameter.definition().map_err(|(_, message)| file.error(0, message))?);
        }
    }
    Ok(effect)
}

/// Refuses a length of a header that is none, or that the prototype has no use for.
fn check_amount(effect: &EffectDefinition, key: &str, amount: &Amount) -> Result<(), String> {
    if effect.kind != EffectKind::Deform {
        return Err(format!("{key} is for kind = \"deform\""));
    }
    match amount {
        Amount::Number(number) if *number > 0.0 && number.is_finite() => Ok(()),
        Amount::Number(number) => Err(format!("{key} must be more than 0 m, is {number}")),
        Amount::Parameter(name) => {
            let is_number = |p: &&ParameterDefinition| matches!(p.kind, ParameterKind::Number { .. });
            let of_name = effect.parameters.iter().find(|p| p.name == *name).filter(is_number);
            of_name
                .map(|_| ())
                .ok_or_else(|| format!("{key} must be metres or the name of a number among the parameters"))
        }
    }
}

/// Refuses a filter that does not say how far it reaches.
fn check_kernel(file: &File, effect: &EffectDefinition) -> Result<(), FileError> {
    let reaches = |p: &ParameterDefinition| {
        p.name == "radius" && matches!(p.kind, ParameterKind::Number { max, .. } if max <= f64::from(MOST_REACH))
    };
    if effect.kind == EffectKind::Filter && !effect.parameters.first().is_some_and(reaches) {
        let message =
            format!("expected a first parameter \"radius\", a number of at most {MOST_REACH}: how far it reaches");
        return Err(file.error(0, message));
    }
    Ok(())
}

/// Refuses lines without a colour and a width, or of a prototype that draws none.
fn check_lines(file: &File, effect: &EffectDefinition) -> Result<(), FileError> {
    let has = |name: &str, fits: fn(&ParameterKind) -> bool| {
        effect.parameters.iter().any(|p| p.name == name && fits(&p.kind))
    };
    let has_lines = has("line_color", |kind| *kind == ParameterKind::Color)
        && has("line_width", |kind| matches!(kind, ParameterKind::Number { max, .. } if *max <= MOST_LINE_WIDTH))
        && matches!(effect.kind, EffectKind::Hide | EffectKind::Scene | EffectKind::Post);
    if effect.lines && !has_lines {
        let message = format!(
            "lines = true is for kind = \"hide\", \"scene\" or \"post\" with parameters \"line_color\", a color, and \"line_width\", a \
             number of at most {MOST_LINE_WIDTH}"
        );
        return Err(file.error(0, message));
    }
    Ok(())
}

/// The function `effect` of a file that declares nothing that an effect may not.
fn main_function<'a, 'b>(
    file: &File,
    effect: &EffectDefinition,
    tokens: &[Token],
    declared: &'b [Declaration<'a>],
) -> Result<&'b Declaration<'a>, FileError> {
    if let Some(bad) = declared.iter().find(|d| matches!(d.keyword, "var" | "override")) {
        let message = format!("an effect keeps nothing between pixels: no {} at the top of a file", bad.keyword);
        return Err(file.error(bad.span.start, message));
    }
    let Some(main) = declared.iter().find(|d| (d.keyword, d.name) == ("fn", "effect")) else {
        return Err(file.error(file.text.len(), format!("expected `{}`", signature(effect))));
    };
    let is_parameters = |t: &&Token| t.kind == TokenKind::Word && &file.text[t.span.clone()] == "Parameters";
    if effect.slots() == 0
        && !declared.iter().any(|d| d.name == "Parameters")
        && let Some(token) = tokens.iter().find(is_parameters)
    {
        let message = format!("the header gives no [[parameter]] for WGSL; expected `{}`", signature(effect));
        return Err(file.error(token.span.start, message));
    }
    Ok(main)
}

/// A file's text after its header and the blank lines below it.
pub(super) fn body_of(text: &str) -> &str {
    let header: usize = text.split_inclusive('\n').take_while(|line| line.starts_with("//!")).map(str::len).sum();
    text[header..].trim_start_matches(['\n', '\r'])
}

/// The declaration that `effect` must have.
pub(super) fn signature(effect: &EffectDefinition) -> String {
    let parameters = if effect.slots() > 0 { ", p: Parameters" } else { "" };
    format!("fn {}", effect.kind.prototype().signature(parameters))
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
