//! The real window, on a display that nobody sees, with a real mouse and real keys.
//!
//! It needs `Xvfb` and `xdotool` (`./dev test` installs them); without them it reads *ignored*.

#![expect(clippy::print_stderr, reason = "whoever runs the tests is told why one does not run")]

use std::{
    fs,
    io::{Read, Write as _},
    path::{Path, PathBuf},
    process::{Child, Command, ExitCode, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use libtest_mimic::{Arguments, Failed, Trial};

const PATIENCE: Duration = Duration::from_secs(300);
/// Longer than the window needs to take a key, where it opens within three of these; else a third of what it takes to open.
const SHORTEST_BEAT: Duration = Duration::from_millis(250);
/// A key that showed nothing after so many beats was not heard.
const UNHEARD: u32 = 30;
/// How often something is tried that a busy machine may miss.
const TRIES: usize = 3;

fn main() -> ExitCode {
    let mut arguments = Arguments::from_args();
    // One pair of hands.
    arguments.test_threads = Some(1);
    let missing = ["Xvfb", "xdotool"].into_iter().find(|tool| !is_there(tool));
    if let Some(tool) = missing {
        eprintln!("ignored: {tool} is not there");
    }
    let all: [(&str, Hands); 6] = [
        ("a_figure_is_made_by_mouse_and_keys", figure),
        ("edits_come_back_after_a_kill", killed),
        ("whoever_closes_is_asked_about_edits", asked),
        ("a_window_closes_while_it_loads", closed_while_loading),
        ("what_a_scene_names_and_is_not_there_is_told", not_there),
        ("time_is_set_linked_and_gone_through", through_time),
    ];
    let trials = all.map(|(name, trial)| Trial::test(name, trial).with_ignored_flag(missing.is_some()));
    libtest_mimic::run(&arguments, trials.into()).exit_code()
}

/// What is done with a window.
type Hands = fn() -> Result<(), Failed>;

fn is_there(tool: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(tool).is_file())
}

/// A process that ends with its test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display, and the window on it.
struct Desk {
    display: String,
    window: String,
    /// How long hands wait between two things they do.
    beat: Duration,
    app: Process,
    _server: Process,
}

impl Desk {
    fn open(folder: &Path, arguments: &[&str]) -> Result<Self, Failed> {
        let mut server = Command::new("Xvfb")
            // `-r`: a key that is let go late, on a busy machine, is not typed twice.
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-r"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        // It says its number once it listens.
        let mut number = Vec::new();
        let mut out = server.stdout.take().ok_or("no output")?;
        let mut byte = [0];
        while out.read(&mut byte)? == 1 && byte[0] != b'\n' {
            number.push(byte[0]);
        }
        let server = Process(server);
        let display = format!(":{}", String::from_utf8(number)?);
        let app = Command::new(env!("CARGO_BIN_EXE_veduta"))
            .args(arguments)
            .current_dir(folder)
            .env("DISPLAY", &display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder)
            .env("XDG_CONFIG_HOME", folder.join("config"))
            .stderr(fs::File::create(folder.join("log.txt"))?)
            .spawn()?;
        let beat = SHORTEST_BEAT;
        let mut desk = Self { display, window: String::new(), beat, app: Process(app), _server: server };
        let started = Instant::now();
        while desk.window.is_empty() {
            if started.elapsed() > PATIENCE {
                return Err(format!("no window: {}", fs::read_to_string(folder.join("log.txt"))?).into());
            }
            sleep(desk.beat);
            let found = desk.told(&["search", "--name", "Veduta"])?;
            desk.window = found.lines().last().unwrap_or("").to_owned();
        }
        desk.beat = SHORTEST_BEAT.max(started.elapsed() / 3);
        desk.does(&["windowfocus", &desk.window.clone()])?;
        Ok(desk)
    }

    fn told(&self, words: &[&str]) -> Result<String, Failed> {
        let output = Command::new("xdotool").args(words).env("DISPLAY", &self.display).output()?;
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    }

    fn does(&self, words: &[&str]) -> Result<(), Failed> {
        self.told(words)?;
        sleep(self.beat);
        Ok(())
    }

    fn title(&self) -> Result<String, Failed> {
        self.told(&["getwindowname", &self.window])
    }

    fn has_title(&self, wanted: &str, patience: Duration) -> Result<bool, Failed> {
        let started = Instant::now();
        while self.title()? != wanted {
            if started.elapsed() > patience {
                return Ok(false);
            }
            sleep(Duration::from_millis(50));
        }
        Ok(true)
    }

    fn until_title(&self, wanted: &str) -> Result<(), Failed> {
        match self.has_title(wanted, PATIENCE)? {
            true => Ok(()),
            false => Err(format!("the title is \"{}\", not \"{wanted}\"", self.title()?).into()),
        }
    }

    /// Presses a key until the window says by its title that it heard it.
    fn key(&self, key: &str, title: &str) -> Result<(), Failed> {
        for _ in 0..TRIES {
            self.does(&["windowfocus", &self.window])?;
            self.does(&["key", key])?;
            if self.has_title(title, UNHEARD * self.beat)? {
                return Ok(());
            }
        }
        self.until_title(title)
    }

    /// Writes a file's name into the dialog that a key opens, and waits until it is closed.
    fn names(&self, (key, title): (&str, &str), name: &str) -> Result<(), Failed> {
        let title = format!("{title} — Veduta");
        self.key(key, &title)?;
        self.does(&["key", "ctrl+a"])?;
        self.does(&["type", "--delay", "20", name])?;
        self.does(&["key", "Return"])?;
        let started = Instant::now();
        while self.title()? == title {
            if started.elapsed() > PATIENCE {
                return Err(format!("\"{title}\" stays open").into());
            }
            sleep(Duration::from_millis(50));
        }
        Ok(())
    }

    fn drags(&self, from: [i32; 2], by: [i32; 2]) -> Result<(), Failed> {
        let [x, y] = from.map(|c| c.to_string());
        self.does(&["mousemove", &x, &y])?;
        self.does(&["mousedown", "1"])?;
        for step in 1..=6 {
            let [x, y] = [0, 1].map(|i| (from[i] + by[i] * step / 6).to_string());
            self.does(&["mousemove", &x, &y])?;
        }
        self.does(&["mouseup", "1"])
    }

    /// Asks the program to quit until it hears it, and waits until it has ended as it should: a window that is not there yet hears no key.
    fn quits(&mut self) -> Result<(), Failed> {
        for _ in 0..TRIES {
            self.does(&["windowfocus", &self.window])?;
            self.does(&["key", "ctrl+q"])?;
            let started = Instant::now();
            while started.elapsed() < UNHEARD * self.beat {
                if self.app.0.try_wait()?.is_some() {
                    return self.ends();
                }
                sleep(Duration::from_millis(50));
            }
        }
        self.ends()
    }

    /// Waits until the program has ended as it should.
    fn ends(&mut self) -> Result<(), Failed> {
        let started = Instant::now();
        loop {
            match self.app.0.try_wait()? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(format!("it ended with {status}").into()),
                None if started.elapsed() > PATIENCE => return Err("it did not end".into()),
                None => sleep(self.beat),
            }
        }
    }

    fn clicks(&self, at: [i32; 2]) -> Result<(), Failed> {
        let [x, y] = at.map(|c| c.to_string());
        self.does(&["mousemove", &x, &y])?;
        self.does(&["click", "1"])
    }
}

fn until_there(file: &Path) -> Result<(), Failed> {
    let started = Instant::now();
    while !file.exists() {
        if started.elapsed() > PATIENCE {
            return Err(format!("{} is not written", file.display()).into());
        }
        sleep(Duration::from_millis(50));
    }
    Ok(())
}

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Where the pointer is while a lens is put there: then its handle is.
const MIDDLE: [i32; 2] = [660, 400];
/// The effect of the chosen lens, in the panel on the left; and another one, in the list that it opens.
const EFFECT: [i32; 2] = [70, 315];
const OTHER: [i32; 2] = [55, 398];

fn figure() -> Result<(), Failed> {
    let folder = Folder(std::env::temp_dir().join(format!("veduta-window-{}", std::process::id())));
    let at = |name: &str| folder.0.join(name);
    fs::create_dir_all(&folder.0)?;
    let city = Path::new(env!("CARGO_MANIFEST_DIR")).join("citydata/square.city.json");
    fs::copy(city, at("town.city.json"))?;
    let mut desk = Desk::open(&folder.0, &[])?;
    desk.until_title("builtin:old-town — Veduta")?;

    let open = ("ctrl+o", "Open city files, a scene or effects");
    desk.names(open, "town.city.json")?;
    desk.until_title("town.city.json — Veduta")?;
    sleep(9 * desk.beat);

    let saved = |name: &str| -> Result<toml::Table, Failed> {
        let file = at(name);
        desk.names(("ctrl+shift+s", "Save the scene"), name)?;
        until_there(&file)?;
        Ok(fs::read_to_string(file)?.parse()?)
    };
    let lens = |scene: &toml::Table| scene["lens"][0].clone();
    let [x, y] = MIDDLE.map(|c| c.to_string());
    desk.does(&["mousemove", &x, &y])?;
    sleep(desk.beat);
    desk.key("l", "• town.city.json — Veduta")?;
    let added = lens(&saved("added.toml")?);
    if added["shape"]["kind"].as_str() != Some("sphere") {
        return Err(format!("{added} is no sphere").into());
    }
    desk.drags(MIDDLE, [120, 30])?;
    sleep(desk.beat);
    let moved = lens(&saved("moved.toml")?);
    let [before, after] = [&added, &moved].map(|lens| lens["shape"]["center"].clone());
    if before == after || before[2] != after[2] || added["shape"]["radius"] != moved["shape"]["radius"] {
        return Err(format!("dragged from {before} to {after}").into());
    }
    let mut changed = moved.clone();
    for n in 0..TRIES {
        desk.clicks(EFFECT)?;
        desk.clicks(OTHER)?;
        sleep(desk.beat);
        changed = lens(&saved(&format!("changed-{n}.toml"))?);
        if changed["effects"] != moved["effects"] {
            break;
        }
    }
    if changed["effects"] == moved["effects"] {
        return Err(format!("{} is the effect still", changed["effects"]).into());
    }
    desk.does(&["mousemove", "660", "700"])?;
    desk.does(&["key", "ctrl+z"])?;
    if lens(&saved("undone.toml")?) != moved {
        return Err("undone is not as it was".into());
    }
    desk.does(&["key", "ctrl+shift+z"])?;
    if lens(&saved("again.toml")?) != changed {
        return Err("done again is not as it was".into());
    }
    desk.names(open, "moved.toml")?;
    desk.until_title("moved.toml — Veduta")?;
    sleep(6 * desk.beat);
    desk.names(("ctrl+e", "Export the figure"), "figure.png")?;
    until_there(&at("figure.png"))?;
    let rendered = Command::new(env!("CARGO_BIN_EXE_veduta"))
        .args(["render", "-q", "moved.toml", "-o", "by-command.png"])
        .current_dir(&folder.0)
        .status()?;
    let [figure, by_command] = [fs::read(at("figure.png"))?, fs::read(at("by-command.png"))?];
    if !rendered.success() || figure != by_command {
        return Err("the figure is not that of the command line".into());
    }
    let remembered = fs::read_to_string(at("config/veduta/recent.txt"))?;
    if remembered.lines().next() != at("moved.toml").to_str() {
        return Err(format!("remembered is {remembered}").into());
    }
    desk.quits()
}

/// A folder of a test with a scene, `mine.toml`, of the built-in city, and where edits are kept.
fn with_a_scene(name: &str) -> Result<(Folder, PathBuf), Failed> {
    let folder = Folder(std::env::temp_dir().join(format!("veduta-window-{name}-{}", std::process::id())));
    fs::create_dir_all(&folder.0)?;
    fs::write(folder.0.join("mine.toml"), MINE)?;
    let unsaved = folder.0.join("config/veduta/unsaved");
    Ok((folder, unsaved))
}

const MINE: &str = "veduta = 1\n\n[city]\nfiles = [\"builtin:square\"]\n";
/// What is asked when edits would be lost, and when some come back: the title of the window meanwhile.
const LOSE: &str = "The scene has edits that are not saved — Veduta";
const COME_BACK: &str = "Edits that were not saved are still there — Veduta";

/// A window on that scene, with a lens that is not saved.
fn with_an_edit(folder: &Folder) -> Result<Desk, Failed> {
    let desk = Desk::open(&folder.0, &["mine.toml"])?;
    desk.until_title("mine.toml — Veduta")?;
    let [x, y] = MIDDLE.map(|c| c.to_string());
    desk.does(&["mousemove", &x, &y])?;
    desk.key("l", "• mine.toml — Veduta")?;
    Ok(desk)
}

fn scene(folder: &Folder) -> Result<String, Failed> {
    Ok(fs::read_to_string(folder.0.join("mine.toml"))?)
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
}

/// Once edits are kept, the window is killed; the next one offers them, and has them.
fn killed() -> Result<(), Failed> {
    let (folder, unsaved) = with_a_scene("killed")?;
    let desk = with_an_edit(&folder)?;
    let is_kept = || files_in(&unsaved).iter().any(|file| file.extension().is_some_and(|ending| ending == "toml"));
    let started = Instant::now();
    while !is_kept() {
        if started.elapsed() > PATIENCE {
            return Err("the edits are not kept".into());
        }
        sleep(desk.beat);
    }
    // SIGKILL.
    drop(desk);
    let mut desk = Desk::open(&folder.0, &[])?;
    desk.until_title(COME_BACK)?;
    desk.key("Return", "• mine.toml — Veduta")?;
    if scene(&folder)? != MINE {
        return Err("the scene was written before it was saved".into());
    }
    desk.key("ctrl+s", "mine.toml — Veduta")?;
    if !scene(&folder)?.contains("[[lens]]") {
        return Err(format!("the lens did not come back: {}", scene(&folder)?).into());
    }
    desk.quits()?;
    match &files_in(&unsaved)[..] {
        [] => Ok(()),
        left => Err(format!("left behind: {left:?}").into()),
    }
}

/// A window with edits stays open until it is said what becomes of them.
fn asked() -> Result<(), Failed> {
    let (folder, unsaved) = with_a_scene("asked")?;
    let mut desk = with_an_edit(&folder)?;
    desk.key("ctrl+q", LOSE)?;
    desk.key("Escape", "• mine.toml — Veduta")?;
    desk.key("ctrl+q", LOSE)?;
    desk.does(&["key", "Tab"])?;
    desk.does(&["key", "Return"])?;
    desk.ends()?;
    if scene(&folder)? != MINE || !files_in(&unsaved).is_empty() {
        return Err(format!("lost edits are kept: {}, {:?}", scene(&folder)?, files_in(&unsaved)).into());
    }
    drop(desk);
    let mut desk = with_an_edit(&folder)?;
    desk.key("ctrl+q", LOSE)?;
    desk.does(&["key", "Return"])?;
    desk.ends()?;
    match scene(&folder)?.contains("[[lens]]") {
        true => Ok(()),
        false => Err("the edits are not saved".into()),
    }
}

/// A city that is never read to its end does not hold the window.
fn closed_while_loading() -> Result<(), Failed> {
    let (folder, _) = with_a_scene("loading")?;
    let city = folder.0.join("endless.city.json");
    if !Command::new("mkfifo").arg(&city).status()?.success() {
        return Err("no pipe can be made".into());
    }
    // Who writes into it says little, and does not end.
    let mut writer = fs::File::options().read(true).write(true).open(&city)?;
    writer.write_all(b"{\"type\": \"CityJSON\", ")?;
    let mut desk = Desk::open(&folder.0, &["endless.city.json"])?;
    desk.until_title("Untitled — Veduta")?;
    sleep(desk.beat);
    desk.quits()
}

/// An object and an attribute of another city: one is a lens that holds nothing, the other no picture at all.
fn not_there() -> Result<(), Failed> {
    let (folder, _) = with_a_scene("not-there")?;
    let lens = "[[lens]]\nname = \"l\"\nkind = \"color\"\n";
    for (rest, message) in [
        (
            "shape = { kind = \"thematic\", ids = [\"curch\"] }\neffects = [\"sepia\"]\n",
            "[lens.0] shape.ids.0: chooses nothing: the city has no object \"curch\"; did you mean \"church\"?",
        ),
        (
            "effects = [{ effect = \"thematic\", attribute = \"heigth\" }]\nshape = { kind = \"sphere\", center = [0, 0, 0], radius = 20 }\n",
            "Cannot be drawn: no object has the attribute \"heigth\"; did you mean \"height\"?",
        ),
    ] {
        fs::write(folder.0.join("mine.toml"), format!("{MINE}{lens}{rest}"))?;
        let mut desk = Desk::open(&folder.0, &["mine.toml"])?;
        let started = Instant::now();
        let told = || fs::read_to_string(folder.0.join("log.txt")).unwrap_or_default();
        while !told().contains(message) {
            if started.elapsed() > PATIENCE {
                return Err(format!("it is not told: {}", told()).into());
            }
            sleep(desk.beat);
        }
        desk.quits()?;
    }
    Ok(())
}

/// The moment of the first time lens, in the panel on the left; of the second one the button that links it, what it offers first, and the delay.
const AT: [i32; 2] = [115, 396];
const LINK: [i32; 2] = [146, 458];
const FIRST: [i32; 2] = [146, 485];
const DELAY: [i32; 2] = [115, 458];
/// On the timeline.
const EARLY: [i32; 2] = [700, 748];

/// A time lens shows 1650, another one what is ten years later; the timeline is dragged, and that is taken back.
fn through_time() -> Result<(), Failed> {
    let (folder, _) = with_a_scene("time")?;
    let changed = "• mine.toml — Veduta";
    fs::write(folder.0.join("mine.toml"), MINE.replace("square", "old-town"))?;
    let mut desk = Desk::open(&folder.0, &["mine.toml"])?;
    desk.until_title("mine.toml — Veduta")?;
    sleep(9 * desk.beat);
    let saved = || -> Result<toml::Table, Failed> {
        if desk.title()? == changed {
            desk.key("ctrl+s", "mine.toml — Veduta")?;
        }
        Ok(scene(&folder)?.parse()?)
    };
    let adds = |at: [i32; 2]| -> Result<(), Failed> {
        let [x, y] = at.map(|c| c.to_string());
        desk.does(&["mousemove", &x, &y])?;
        sleep(desk.beat);
        desk.key("y", changed)?;
        saved().map(|_| ())
    };
    // Until the file says so: a busy machine may miss some of it.
    let until = |does: &dyn Fn() -> Result<(), Failed>, step: &str| -> Result<(), Failed> {
        for _ in 0..TRIES {
            does()?;
            sleep(2 * desk.beat);
            saved()?;
            if scene(&folder)?.contains(step) {
                return Ok(());
            }
        }
        Err(format!("there is no {step} in {}", scene(&folder)?).into())
    };
    let types = |at: [i32; 2], text: &str| -> Result<(), Failed> {
        desk.clicks(at)?;
        desk.does(&["key", "ctrl+a"])?;
        desk.does(&["type", "--delay", "20", text])?;
        desk.does(&["key", "Return"])
    };
    adds(MIDDLE)?;
    until(&|| types(AT, "1650"), "at = \"1650\"")?;
    adds([MIDDLE[0], MIDDLE[1] + 100])?;
    until(
        &|| {
            desk.clicks(LINK)?;
            desk.clicks(FIRST)
        },
        "to = \"time\"",
    )?;
    until(&|| types(DELAY, "10 years"), "by = \"10 years\"")?;
    let before = saved()?;
    until(&|| desk.drags(EARLY, [60, 0]), "[time]")?;
    desk.does(&["mousemove", "660", "600"])?;
    desk.key("ctrl+z", changed)?;
    if saved()? != before {
        return Err("the way through time is not taken back".into());
    }
    desk.quits()
}
