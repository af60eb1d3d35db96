//! Time operators of lenses on the host: which moment shows in a lens (Tiesel §4.2).
//!
//! The operators of a lens act one after the other on the moment that shows below it; lenses act bottom to top. No moment at all, as in a
//! scene that gives none, stays none until something sets one.

use std::sync::Arc;

use crate::{
    lens::{definition::Lens, effect_use::Parameter, handled::Handled, nearest::did_you_mean},
    shader::{
        effect::{
            AskedBy, DefaultValue, EffectDefinition, Fallback, ParameterDefinition, ParameterKind, number_asked_by,
        },
        host::HostProgram,
    },
    time::{Interval, Moment, Span, Unit},
};

/// A time operator, ready to act.
#[derive(Clone, Debug, PartialEq)]
pub struct Operator {
    /// Index into [`crate::shader::handlers`].
    pub handler: u32,
    /// Its parameters as shaders read them.
    pub words: Vec<u32>,
    exact: Exact,
}

/// What it does, in the calendar of [`crate::time`].
#[derive(Clone, Debug, PartialEq)]
enum Exact {
    Set(Moment),
    Shift(Span),
    Ceil(Unit, Span),
    Floor(Unit, Span),
    TimeOfDay(i64),
    /// And whether what is there at some of them is there whole.
    Together(Vec<Instant>, bool),
    Ghost(Ghosts),
    Own(Arc<HostProgram>),
}

/// One of several moments that show together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Which.
    pub at: InstantOf,
    /// How much it counts; those of a set count 1 together.
    pub weight: f64,
}

/// What an instant is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InstantOf {
    /// This moment; `None`: the one at which all is there.
    Moment(Option<Moment>),
    /// So much later than what is shown below.
    Later(Span),
}

impl Instant {
    /// The moment where another is shown below.
    pub fn moment(&self, below: Option<Moment>) -> Option<Moment> {
        match self.at {
            InstantOf::Moment(at) => at,
            InstantOf::Later(by) => below.map(|below| below.shifted(by)),
        }
    }

    /// As shaders read it (`lib/instants.wgsl`).
    pub fn words(&self) -> [u32; 4] {
        match self.at {
            InstantOf::Moment(at) => {
                let [hour, micro] = at.map_or(Moment::TIMELESS, Moment::words);
                [0, hour, micro, 0]
            }
            InstantOf::Later(by) => {
                let [months, hours, micro] = by.words();
                [1, months, hours, micro]
            }
        }
    }
}

/// What shows by halves beside a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghosts {
    /// How long what is gone fades.
    pub past: Span,
    /// How long before it comes what will be there is drawn in outline.
    pub future: Span,
}

impl Ghosts {
    /// Nothing does.
    pub const NONE: Self = Self { past: Span::NONE, future: Span::NONE };
}

impl Operator {
    /// The operator that a step asks for, at a second of the scene.
    ///
    /// # Errors
    /// There is none of its name, or a parameter does not fit: what would be right.
    pub fn new(step: &Handled, clock_s: f64) -> Result<Self, String> {
        let definition = step.definition(AskedBy::Times)?;
        if definition.host.is_none() && definition.name == LOOP {
            return Loop::new(step, definition).map(|own| Self::set(own.at(clock_s)));
        }
        let number = number_asked_by(AskedBy::Times, &definition.name);
        let words: Result<Vec<Vec<u32>>, String> =
            definition.shader_parameters().map(|(parameter, ..)| words_of(step, parameter)).collect();
        let exact = match &definition.host {
            Some(own) => Exact::Own(own.clone()),
            None => Exact::of(step, definition)?,
        };
        Ok(Self { handler: number.unwrap_or_default(), words: words?.concat(), exact })
    }

    /// The one that sets a moment.
    fn set(moment: Moment) -> Self {
        let handler = number_asked_by(AskedBy::Times, SET).unwrap_or_default();
        Self { handler, words: moment.words().to_vec(), exact: Exact::Set(moment) }
    }

    /// The moments that it makes of another, each with how much it counts: together 1.
    pub fn moments(&self, at: Option<Moment>) -> Vec<(Option<Moment>, f64)> {
        match &self.exact {
            Exact::Together(instants, _) => instants.iter().map(|own| (own.moment(at), own.weight)).collect(),
            _ => vec![(self.apply(at), 1.0)],
        }
    }

    /// The moments of a set; of those that make one moment, none.
    pub fn instants(&self) -> &[Instant] {
        match &self.exact {
            Exact::Together(instants, _) => instants,
            _ => &[],
        }
    }

    /// Whether what is there at some of its moments is there whole.
    pub fn shows_any(&self) -> bool {
        matches!(self.exact, Exact::Together(_, true))
    }

    /// What shows by halves beside the moment, where it says that.
    pub fn ghosts(&self) -> Option<Ghosts> {
        if let Exact::Ghost(ghosts) = self.exact { Some(ghosts) } else { None }
    }

    /// The moment that it makes of another; of several the first.
    pub fn apply(&self, at: Option<Moment>) -> Option<Moment> {
        match &self.exact {
            Exact::Set(moment) => Some(*moment),
            Exact::Own(program) => {
                let moment = at.map_or(Moment::TIMELESS, Moment::words);
                sound(program.moment(moment, &self.words).unwrap_or(moment))
            }
            Exact::Shift(by) => at.map(|at| at.shifted(*by)),
            Exact::Ceil(unit, by) => at.map(|at| at.shifted(*by).ceiled(*unit)),
            Exact::Floor(unit, by) => at.map(|at| at.shifted(*by).floored(*unit)),
            Exact::TimeOfDay(micros) => at.map(|at| at.at_time_of_day(*micros)),
            Exact::Together(instants, _) => instants.first().and_then(|first| first.moment(at)),
            Exact::Ghost(_) => at,
        }
    }

    /// The first and the last moment that it may make of moments from one to another; `None`: of none it makes none.
    pub fn range(&self, of: Option<[Moment; 2]>) -> Option<[Moment; 2]> {
        match &self.exact {
            Exact::Set(moment) => Some([*moment; 2]),
            Exact::Together(instants, _) => {
                let ends = of.map_or([None; 2], |of| of.map(Some));
                let all = ends.into_iter().flat_map(|below| instants.iter().filter_map(move |own| own.moment(below)));
                let all: Vec<Moment> = all.collect();
                all.iter().min().zip(all.iter().max()).map(|(first, last)| [*first, *last])
            }
            // Of what users do nothing is known.
            Exact::Own(_) => Some([Moment::FIRST, Moment::LAST]),
            // None of the others puts an earlier moment behind a later one.
            _ => {
                let [first, last] = of?;
                self.apply(Some(first)).zip(self.apply(Some(last))).map(|(first, last)| [first, last])
            }
        }
    }

    /// Whether it makes the same moment of all.
    pub fn is_absolute(&self) -> bool {
        matches!(self.exact, Exact::Set(_))
    }
}

const SET: &str = "set";
pub(super) const SHIFT: &str = "shift";
const LOOP: &str = "loop";
const AGGREGATE: &str = "aggregate";
const GHOST: &str = "ghost";
/// The operator that shows what another lens shows, and its parameters: that lens' name, and the delay.
pub(super) const LINK: &str = "link";
pub(super) const LINKED: &str = "to";
pub(super) const DELAY: &str = "by";

/// A moment that comes again and again: `from + (clock − start) · rate mod (until − from)`.
struct Loop {
    from: Moment,
    /// Microseconds, > 0.
    long: i64,
    /// Microseconds that go by in a second, > 0.
    per_second: i64,
    /// Microseconds of the scene's clock.
    start: i64,
}

impl Loop {
    fn new(step: &Handled, definition: &EffectDefinition) -> Result<Self, String> {
        let parameter = |name: &str| definition.parameters.iter().find(|p| p.name == name);
        let text = |name: &str| {
            parameter(name).and_then(|parameter| text_of(step, parameter)).ok_or_else(|| format!("{name} is missing"))
        };
        let moment = |name: &str| {
            let text = text(name)?;
            Interval::parse(&text)?.begin.ok_or_else(|| format!("\"{text}\" has no beginning"))
        };
        let (from, until) = (moment("begin")?, moment("end")?);
        let per_second = Span::parse(&text("per_second")?)?.mean_micros();
        if until <= from {
            return Err(format!("end must be later than begin = {}, is {}", from.written(), until.written()));
        }
        if per_second <= 0 {
            return Err("per_second must be more than none".to_owned());
        }
        let start_s = match step.parameters.get("start_s") {
            Some(Parameter::Number(start)) => *start,
            _ => 0.0,
        };
        Ok(Self { from, long: until - from, per_second, start: micros_of(start_s) })
    }

    fn at(&self, clock_s: f64) -> Moment {
        let gone = i128::from(micros_of(clock_s)) - i128::from(self.start);
        let since = (gone * i128::from(self.per_second)).div_euclid(1_000_000).rem_euclid(self.long.into());
        self.from.shifted(Span::of_micros(since as i64))
    }
}

/// Seconds of a scene's clock as whole microseconds.
fn micros_of(seconds: f64) -> i64 {
    (seconds * 1e6).round() as i64
}

/// The moment that some steps, one after the other, make of another, at a second of the scene.
///
/// # Errors
/// A step that is none: which, and what would be right.
pub fn moment_after(steps: &[Handled], at: Option<Moment>, clock_s: f64) -> Result<Option<Moment>, String> {
    steps.iter().try_fold(at, |at, step| {
        let operator =
            Operator::new(step, clock_s).map_err(|message| format!("time, \"{}\": {message}", step.handler))?;
        Ok(operator.apply(at))
    })
}

/// Steps with those of other lenses in place of links to these, and the delay of each link behind them.
///
/// # Errors
/// A link to no lens, or one that leads back to itself.
pub fn linked(steps: &[Handled], lenses: &[Lens]) -> Result<Vec<Handled>, String> {
    let mut way = Vec::new();
    linked_on(steps, lenses, &mut way)
}

/// The same on the way through some lenses.
fn linked_on<'a>(steps: &[Handled], lenses: &'a [Lens], way: &mut Vec<&'a str>) -> Result<Vec<Handled>, String> {
    let mut all = Vec::with_capacity(steps.len());
    for step in steps {
        if step.handler != LINK {
            all.push(step.clone());
            continue;
        }
        let Some(Parameter::Text(to)) = step.parameters.get(LINKED) else { return Err("to is missing".to_owned()) };
        let other = lenses.iter().find(|lens| lens.name == *to).ok_or_else(|| {
            let hint = did_you_mean(to, lenses.iter().map(|lens| lens.name.as_str()));
            format!("to: there is no lens \"{to}\"{hint}")
        })?;
        if way.contains(&other.name.as_str()) {
            return Err(format!(
                "to: the links of \"{to}\" lead back to it; one lens of them has to have a time of its own"
            ));
        }
        way.push(&other.name);
        all.extend(linked_on(&other.time, lenses, way)?);
        way.pop();
        all.extend(delayed(step));
    }
    Ok(all)
}

/// The delay of a link as a step of its own; `None`: there is none.
pub(super) fn delayed(link: &Handled) -> Option<Handled> {
    let by = link.parameters.get(DELAY)?;
    let is_none = matches!(by, Parameter::Text(by) if Span::parse(by).is_ok_and(Span::is_none));
    let parameters = [(DELAY.to_owned(), by.clone())].into();
    (!is_none).then(|| Handled { handler: SHIFT.to_owned(), parameters })
}

/// Whether a step makes one moment of one, with nothing beside it that is there by halves.
pub fn makes_one_moment(step: &Handled) -> bool {
    !matches!(step.handler.as_str(), AGGREGATE | GHOST)
}

/// The step that sets a moment.
pub fn set_to(moment: Moment) -> Handled {
    let at = ("at".to_owned(), Parameter::Text(moment.written()));
    Handled { handler: SET.to_owned(), parameters: [at].into() }
}

/// What shaders make of two words (`lib/moment.wgsl`).
fn sound([hour, micro]: [u32; 2]) -> Option<Moment> {
    const MOST_MICROS: u32 = 3_599_999_999;
    if hour == Moment::TIMELESS[0] {
        return None;
    }
    let clamped = Moment::of_words([hour, micro.min(MOST_MICROS)]);
    Some(clamped.unwrap_or(if hour.cast_signed() < 0 { Moment::FIRST } else { Moment::LAST }))
}

impl Exact {
    /// What an operator of the program does.
    fn of(step: &Handled, definition: &EffectDefinition) -> Result<Self, String> {
        let text = |name: &str| {
            let parameter = definition.parameters.iter().find(|p| p.name == name);
            parameter.and_then(|parameter| text_of(step, parameter)).ok_or_else(|| format!("{name} is missing"))
        };
        let span = |name: &str| text(name).and_then(|text| Span::parse(&text));
        let unit = || span("unit").and_then(Unit::of);
        let length = |name: &str| match span(name)? {
            by if by.is_back() => Err(format!("{name} must not be less than none")),
            by => Ok(by),
        };
        Ok(match definition.name.as_str() {
            SET => {
                let at = text("at")?;
                Self::Set(Interval::parse(&at)?.begin.ok_or_else(|| format!("\"{at}\" has no beginning"))?)
            }
            // Of a link its delay: the operators of the other lens stand before it ([`linked`]).
            SHIFT | LINK => Self::Shift(span("by")?),
            "ceil" => Self::Ceil(unit()?, span("by")?),
            "floor" => Self::Floor(unit()?, span("by")?),
            AGGREGATE => {
                let shows_any = step.parameters.get("show") == Some(&Parameter::Text("any".to_owned()));
                Self::Together(instants_of(step)?, shows_any)
            }
            GHOST => Self::Ghost(Ghosts { past: length("past")?, future: length("future")? }),
            "time-of-day" => Self::TimeOfDay(Span::of_clock(&text("time")?)?.micros()),
            other => return Err(format!("\"{other}\" does not run on the host")),
        })
    }
}

/// The moments of a step that shows several, and how much each counts of all.
fn instants_of(step: &Handled) -> Result<Vec<Instant>, String> {
    let Some(Parameter::Texts(texts)) = step.parameters.get("at") else { return Err("at is missing".to_owned()) };
    let weights = match step.parameters.get("weights") {
        Some(Parameter::Numbers(weights)) => weights.clone(),
        _ => vec![1.0; texts.len()],
    };
    if weights.len() != texts.len() {
        return Err(format!("weights must be {}, one for each of at, are {}", texts.len(), weights.len()));
    }
    let total: f64 = weights.iter().sum();
    let one = |(text, weight): (&String, f64)| -> Result<Instant, String> {
        let at = match Span::parse(text) {
            Ok(by) => InstantOf::Later(by),
            Err(_) => match Interval::parse(text)?.begin {
                None => return Err(format!("\"{text}\" has no beginning")),
                begin => InstantOf::Moment(begin),
            },
        };
        Ok(Instant { at, weight: weight / total })
    };
    texts.iter().zip(weights).map(one).collect()
}

/// The text of a parameter: as given, or its default.
fn text_of(step: &Handled, parameter: &ParameterDefinition) -> Option<String> {
    match (step.parameters.get(&parameter.name), &parameter.fallback) {
        (Some(Parameter::Text(text)), _) => Some(text.clone()),
        (None, Fallback::Value(DefaultValue::Text(text))) => Some(text.clone()),
        _ => None,
    }
}

/// A parameter as shaders read it.
fn words_of(step: &Handled, parameter: &ParameterDefinition) -> Result<Vec<u32>, String> {
    if parameter.kind == ParameterKind::Instants {
        // Where they lie is told where all operators are known.
        return Ok(vec![0, instants_of(step)?.len() as u32, 1]);
    }
    if !parameter.kind.is_time() {
        return Ok(step.floats_of(parameter).into_iter().map(f32::to_bits).collect());
    }
    let text = text_of(step, parameter).ok_or_else(|| format!("{} is missing", parameter.name))?;
    parameter.kind.words_of_time(&text)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::{
        shader::effect::asked_for,
        time::{DAY, HOUR, MINUTE, SECOND},
    };

    fn moments() -> impl Strategy<Value = Moment> {
        let any = Moment::FIRST.micros()..=Moment::LAST.micros();
        let near = |at: Moment| (-400 * DAY..=400 * DAY).prop_map(move |by| at.shifted(Span::of_micros(by)));
        let micros = prop_oneof![
            4 => any.clone(),
            2 => any.clone().prop_map(|micros| micros - micros.rem_euclid(HOUR)),
            2 => any.prop_map(|micros| micros - micros.rem_euclid(DAY)),
            2 => -40 * DAY..=40 * DAY,
        ];
        let micros = micros.prop_map(|micros| Moment::from_micros(micros).unwrap_or(Moment::FIRST));
        prop_oneof![10 => micros, 1 => near(Moment::FIRST), 1 => near(Moment::LAST)]
    }

    fn spans() -> impl Strategy<Value = String> {
        let amount = prop_oneof![Just(0_i64), 1..=9i64, 1..=4000i64];
        let unit = prop::sample::select(&["year", "month", "week", "day", "hour", "min", "s", "ms", "us"][..]);
        (any::<bool>(), prop::collection::vec((amount, unit), 1..4)).prop_map(|(is_back, parts)| {
            let sign = if is_back { "-" } else { "" };
            let parts: Vec<String> = parts.into_iter().map(|(amount, unit)| format!("{amount} {unit}")).collect();
            format!("{sign}{}", parts.join(" "))
        })
    }

    fn units() -> impl Strategy<Value = String> {
        let months = (1..=1500i32).prop_map(|months| Span::of_months(months).to_string());
        // Whatever goes into an hour, so many times.
        let bases =
            prop::sample::select(&[1, 1000, 40_000, SECOND, 25 * SECOND, MINUTE, 6 * MINUTE, 30 * MINUTE, HOUR][..]);
        let odd = (bases, 1..=9000i64).prop_map(|(base, count)| Span::of_micros(base * count).to_string());
        let even = prop::sample::select(&[1, SECOND, MINUTE, 90 * MINUTE, HOUR, 7 * HOUR, DAY, 7 * DAY, 3 * DAY][..]);
        prop_oneof![months, odd, even.prop_map(|micros| Span::of_micros(micros).to_string())]
    }

    fn steps() -> impl Strategy<Value = Handled> {
        let of = |op: &str, parameters: Vec<(&str, String)>| Handled {
            handler: op.to_owned(),
            parameters: parameters
                .into_iter()
                .map(|(k, text)| (k.to_owned(), Parameter::Text(text)))
                .collect::<BTreeMap<_, _>>(),
        };
        prop_oneof![
            moments().prop_map(move |at| of("set", vec![("at", at.written())])),
            spans().prop_map(move |by| of("shift", vec![("by", by)])),
            (units(), spans()).prop_map(move |(unit, by)| of("ceil", vec![("unit", unit), ("by", by)])),
            (units(), spans()).prop_map(move |(unit, by)| of("floor", vec![("unit", unit), ("by", by)])),
            (0..DAY).prop_map(move |time| {
                let at = Moment::from_micros(time).expect("a moment").clock(crate::time::Granularity::Micro);
                of("time-of-day", vec![("time", at)])
            }),
        ]
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Shaders count in other numbers, and come to the same moments.
        #[test]
        fn the_calendar_of_shaders_is_that_of_the_host(step in steps(), at in prop::option::weighted(0.9, moments())) {
            let operator = Operator::new(&step, 0.0).expect("an operator");
            let definition = &crate::shader::handlers()[operator.handler as usize];
            let program = HostProgram::new(definition).expect("a program");
            let words = program.moment(at.map_or(Moment::TIMELESS, Moment::words), &operator.words).expect("a moment");
            let expected = operator.apply(at).map_or(Moment::TIMELESS, Moment::words);
            prop_assert_eq!(words, expected, "{:?} of {:?}", step, at);
        }

        /// What is told of where moments go holds of all of them.
        #[test]
        fn ranges_hold_what_is_in_them(step in steps(), mut moments in prop::collection::vec(moments(), 3)) {
            moments.sort_unstable();
            let operator = Operator::new(&step, 0.0).expect("an operator");
            let [low, high] = operator.range(Some([moments[0], moments[2]])).expect("a range");
            let made = operator.apply(Some(moments[1])).expect("a moment");
            prop_assert!(low <= made && made <= high, "{} is not in {} to {}", made.written(), low.written(), high.written());
        }
    }

    #[test]
    fn days_that_a_month_does_not_have_are_its_last_in_shaders_too() {
        let step = |by: &str| Handled {
            handler: "shift".to_owned(),
            parameters: [("by".to_owned(), Parameter::Text(by.to_owned()))].into(),
        };
        for by in ["1 month", "-1 month", "13 months", "-1 year", "4 years"] {
            let operator = Operator::new(&step(by), 0.0).expect("an operator");
            let definition = &crate::shader::handlers()[operator.handler as usize];
            let program = HostProgram::new(definition).expect("a program");
            for at in
                ["2023-12-31", "2024-01-31", "2024-02-29", "2024-03-31", "2000-10-31", "1900-01-30", "-0004-02-29"]
            {
                let at = Interval::parse(at).expect("a day").begin.expect("a beginning");
                let words = program.moment(at.words(), &operator.words).expect("a moment");
                let expected = operator.apply(Some(at)).expect("a moment");
                assert_eq!(words, expected.words(), "{} and {by}: {}", at.written(), expected.written());
            }
        }
    }

    #[test]
    fn all_operators_of_the_program_run_on_the_host() {
        let names: Vec<&str> = asked_for(AskedBy::Times).filter(|h| !h.is_users).map(|h| h.name.as_str()).collect();
        assert_eq!(names, [SET, "shift", "ceil", "floor", "time-of-day", LOOP, AGGREGATE, GHOST, LINK]);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let wrong = |op: &str, parameters: &[(&str, &str)]| {
            let parameters = parameters.iter().map(|(k, v)| ((*k).to_owned(), Parameter::Text((*v).to_owned())));
            Operator::new(&Handled { handler: op.to_owned(), parameters: parameters.collect() }, 0.0).expect_err(op)
        };
        assert!(wrong("sett", &[]).contains("did you mean \"set\""));
        assert_eq!(wrong("set", &[]), "at is missing");
        assert!(wrong("set", &[("at", "../1890")]).contains("no beginning"));
        assert!(wrong("floor", &[("unit", "-1 year")]).contains("is no unit"));
        assert!(wrong("time-of-day", &[("time", "24:00")]).contains("no time of day"));
        assert_eq!(wrong("aggregate", &[]), "at is missing");
        let several = |at: &[&str], weights: Option<&[f64]>| {
            let at = ("at".to_owned(), Parameter::Texts(at.iter().map(|text| (*text).to_owned()).collect()));
            let weights = weights.map(|weights| ("weights".to_owned(), Parameter::Numbers(weights.to_vec())));
            let parameters = std::iter::once(at).chain(weights).collect();
            Operator::new(&Handled { handler: "aggregate".into(), parameters }, 0.0)
        };
        let wrong_of = |at: &[&str], weights: &[f64]| several(at, Some(weights)).expect_err("several");
        assert_eq!(wrong_of(&["1650", "1750"], &[1.0]), "weights must be 2, one for each of at, are 1");
        assert!(wrong_of(&["../1650"], &[1.0]).contains("no beginning"));
        assert!(wrong_of(&["when"], &[1.0]).contains("\"when\""));
        assert!(wrong("ghost", &[("past", "-1 year")]).contains("less than none"));
        let made = several(&["1650", "-10 years"], Some(&[1.0, 3.0])).expect("two moments");
        let [year, early] = [1650, 1890].map(Moment::of_year);
        assert_eq!(made.moments(Moment::of_year(1900)), [(year, 0.25), (early, 0.75)]);
        assert_eq!(made.range(Moment::of_year(1900).map(|at| [at; 2])), year.zip(early).map(|(a, b)| [a, b]));
        assert!(wrong("loop", &[("begin", "1900"), ("end", "1900")]).contains("later than begin"));
        assert!(wrong("loop", &[("begin", "1900"), ("end", "1901"), ("per_second", "0 s")]).contains("more than none"));
    }
}
