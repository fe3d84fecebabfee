//! The command line: one file per subcommand, one table ([`CliCommand`]) that parsing, help,
//! completions and the manual are made from.

mod ages;
mod axes;
mod batch;
mod bench;
mod cache;
mod calibrate;
mod cite;
mod client;
mod complete;
mod completions;
mod crew;
mod derivation;
mod doctor;
mod export;
mod flags;
mod forest;
mod forest_page;
mod impostor;
mod knob;
mod lint;
mod list;
mod man;
mod optional;
mod outputs;
mod placing;
mod plot;
mod preview;
mod recipe;
mod scan;
mod scene;
mod schema;
mod sheet;
mod show;
mod size;
mod stats;
mod sweep;
mod timings;
mod verify;
mod walk;
mod workbench;

use std::cell::LazyCell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::builder::styling::{AnsiColor, Styles};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};
use linden::Monitor;
use linden::dress::grow_and_draw;
use linden::grow::{GrowError, Grown, grow};
use linden::knob::{Kind, Value};
use linden::preset::Preset;
use linden::season::Season;

use crate::cache::CacheSize;
use crate::config::dirs::Dirs;
use crate::config::settings::Settings;
use crate::progress::Progress;
use crate::source::{self, Source};
use crate::{exit, memory};

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default())
    .placeholder(AnsiColor::Yellow.on_default());

/// Grows trees from L-systems and space colonization and hands them to every 3D pipeline.
#[derive(Parser)]
#[command(name = "linden", version = linden::recipe::VERSION, styles = STYLES, max_term_width = 110)]
#[command(override_usage = "linden [OPTIONS] [COMMAND]")]
#[command(after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Option<CliCommand>,

    #[command(flatten)]
    terminal: workbench::TerminalArgs,

    /// The most memory that work may hold at once, like 4G; auto is half of what there is. Up to 32 MiB for
    /// the program itself come on top
    #[arg(long, value_name = "BYTES", global = true)]
    memory: Option<String>,

    /// A folder whose files documents may name; without, only what lies beside a document or below it
    #[arg(long, value_name = "DIR", global = true)]
    allow_path: Vec<PathBuf>,

    /// Draw all pictures anew, and keep none ('linden cache')
    #[arg(long, global = true)]
    no_cache: bool,
}

const EXAMPLES: &str = "\
SOURCE is a preset's id ('linden list'), or a file told by its content: a .toml preset, a grammar
(.txt, .l), a closed mesh (.obj, .ply: a crown envelope), points (.ply, .xyz, .csv,
.las, .laz, .e57, .pcd, .pts, .ptx: as from a scanner),
a recipe (.json), or anything that linden wrote, which carries its recipe. '-' is standard input
or output.

Without a command, linden opens the workbench.

Examples:
  linden
  linden open fir --set points=3000
  linden list
  linden preview fir
  linden export fir -o fir.glb -o fir.usda
  linden export left.obj right.obj -o both.glb
  linden forest fir:3 simple -o wood.glb --area 60 --scene
  linden export scan.xyz -o tree.glb --set step=0.05
  linden scan oak --positions 4 -o scan.ply --truth truth.csv
  linden recipe tree.glb
  linden verify tree.glb
  linden lint tree.glb --profile mobile --deny warnings
  linden cite tree.glb --format bibtex
  linden calibrate so-oak --against oaks.csv
  linden sweep abop-honda-a --define r1=0.6:0.9:0.1 --seeds 2 -o table.csv
  linden batch trees.toml --shard 0/4 --out trees
  linden doctor

Exit codes: 0 done, 1 failed, 2 wrong usage or a mistake in a document, 130 interrupted.";

#[derive(Subcommand)]
enum CliCommand {
    Open(workbench::Open),
    List(list::List),
    Show(show::Show),
    Stats(stats::Stats),
    Sweep(sweep::Sweep),
    Calibrate(calibrate::Calibrate),
    Batch(batch::Batch),
    Bench(bench::Bench),
    Preview(preview::Preview),
    Sheet(sheet::Sheet),
    Export(export::Export),
    Impostor(impostor::Impostor),
    Scan(scan::Scan),
    Recipe(recipe::Recipe),
    Verify(verify::Verify),
    Lint(lint::Lint),
    Cite(cite::Cite),
    Forest(forest::Forest),
    Doctor(doctor::Doctor),
    Cache(cache::Cache),
    Completions(completions::Completions),
    Man(man::Man),
    Schema(schema::Schema),
}

/// What grows: shared by all commands that take a SOURCE.
#[derive(Args)]
struct GrowArgs {
    /// A preset's id, a file, or - for standard input
    #[arg(value_name = "SOURCE", add = complete::sources())]
    source: PathBuf,

    /// Turn a knob ('linden show SOURCE' lists them, 'linden list --knobs KNOB' explains one); may be given
    /// several times
    #[arg(long = "set", short, value_name = "KNOB=VALUE", add = complete::settings())]
    settings: Vec<String>,

    /// Give a constant of the grammar ('#define') another value ('linden show SOURCE' lists them); may be given
    /// several times
    #[arg(long = "define", value_name = "NAME=VALUE", add = complete::constants())]
    defines: Vec<String>,

    /// Edit the wood, like 'remove stem/12' or 'bend stem/4 30 towards=0,-1,0' ('linden show SOURCE --axes' lists the
    /// axes); may be given several times, behind the edits of the source
    #[arg(long = "edit", value_name = "EDIT")]
    edits: Vec<String>,

    /// The plant at an age: a name that the source has for one ('linden show'), a share of its growth like 0.3, or years
    /// like 10y where it grows by them
    #[arg(long, value_name = "AGE")]
    age: Option<String>,

    /// The root of all random choices; the same as --set seed=N
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    seed: Option<u64>,
}

/// How much of it is shown: shared by the commands that make a surface of it.
#[derive(Args)]
struct Budget {
    /// Solve for so many triangles, within 5 %; the same as --set triangles=N
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    triangles: Option<u64>,
}

/// A whole number as knobs take it.
fn whole(text: &str) -> Result<u64, String> {
    match (Kind::Integer { min: 0, max: u64::MAX }).parse(text)? {
        Value::Integer(number) => Ok(number),
        _ => Err("expected a whole number".to_owned()),
    }
}

impl Budget {
    fn pair(&self) -> Option<(String, String)> {
        self.triangles.map(|n| ("triangles".to_owned(), n.to_string()))
    }
}

/// What is shown of a plant from near and far, and in the wind: shared by the commands that write it.
#[derive(Args)]
struct Looks {
    /// So many levels of detail, the same tree with fewer triangles each time, or a budget of triangles
    /// for each, like 50000,15000,4000; the same as --set lods=N or --set `lod_triangles=LIST`
    #[arg(long, value_name = "N|LIST", value_parser = lods_falling)]
    lods: Option<String>,

    /// Triangles of a level / triangles of the one before (the knob `lod_ratio`)
    #[arg(long, value_name = "X")]
    lod_ratio: Option<f64>,

    /// A last level of crossed planes with pictures of the tree, two or as many as said; the same as
    /// --set billboard=N
    #[arg(long, value_name = "PLANES", num_args = 0..=1, default_missing_value = "2")]
    billboard: Option<u32>,

    /// Wind: attributes at the vertices for shaders; with =sway a loop that viewers play too, with
    /// =bones that loop by joints; the same as --set wind=WORD
    #[arg(long, value_name = "WORD", num_args = 0..=1, default_missing_value = "attributes", add = complete::values_of("wind"))]
    wind: Option<String>,
}

impl Looks {
    /// The knobs that they are.
    fn pairs(&self) -> impl Iterator<Item = (String, String)> {
        let flags = [
            ("lod_ratio", self.lod_ratio.map(|x| x.to_string())),
            ("billboard", self.billboard.map(|n| n.to_string())),
            ("wind", self.wind.clone()),
        ];
        let flags = flags.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
        self.lods.as_deref().map(lods).into_iter().chain(flags)
    }
}

impl GrowArgs {
    /// The source with its knobs turned. Notes about it go to standard error.
    fn resolve(&self, progress: &Progress) -> anyhow::Result<Source> {
        self.resolve_with(&self.pairs()?, progress)
    }

    fn resolve_with(&self, pairs: &[(String, String)], progress: &Progress) -> anyhow::Result<Source> {
        self.resolve_in(pairs, &[], progress)
    }

    /// The same for what is shown in some seasons, if any are named, in place of the knob `season`.
    fn resolve_in(
        &self,
        pairs: &[(String, String)],
        seasons: &[Season],
        progress: &Progress,
    ) -> anyhow::Result<Source> {
        let source = self.read(pairs, progress)?;
        say_of(&source, pairs, seasons, progress);
        Ok(source)
    }

    /// The source of a string that is derived and not drawn: units say nothing of it.
    fn resolve_string(&self, progress: &Progress) -> anyhow::Result<Source> {
        let pairs = self.pairs()?;
        let source = self.read(&pairs, progress)?.without_units();
        say_of(&source, &pairs, &[], progress);
        Ok(source)
    }

    /// The source with its knobs turned, and no word about it.
    fn read(&self, pairs: &[(String, String)], progress: &Progress) -> anyhow::Result<Source> {
        let mut source = source::resolve(&self.source, pairs, progress)?;
        define(&mut source, &self.defines)?;
        if let Some(age) = &self.age {
            source = ages::at(&source, age, pairs)?;
        }
        for edit in &self.edits {
            source.recipe.preset.edit(edit).map_err(exit::usage)?;
        }
        Ok(source)
    }

    /// Refuses `--define` where there is no one grammar.
    fn without_defines(&self, instead: &str) -> anyhow::Result<()> {
        if self.defines.is_empty() {
            return Ok(());
        }
        Err(exit::usage(format!("--define is for one tree of a grammar; {instead}")))
    }

    /// Refuses `--age` where there is no one tree, or several ages.
    fn without_age(&self, instead: &str) -> anyhow::Result<()> {
        if self.age.is_none() {
            return Ok(());
        }
        Err(exit::usage(format!("--age is for one tree at one age; {instead}")))
    }

    /// Refuses `--edit` where there is no one tree.
    fn without_edits(&self, instead: &str) -> anyhow::Result<()> {
        if self.edits.is_empty() {
            return Ok(());
        }
        Err(exit::usage(format!("--edit is for one tree; {instead}")))
    }

    /// What `--set` and `--seed` say, as names and values, the seed last.
    fn pairs(&self) -> anyhow::Result<Vec<(String, String)>> {
        let mut pairs = pairs(&self.settings)?;
        pairs.extend(self.seed.map(seeded));
        Ok(pairs)
    }
}

/// Says what is to be known of a source, and of knobs that were turned and change nothing in any of the seasons.
fn say_of(source: &Source, pairs: &[(String, String)], seasons: &[Season], progress: &Progress) {
    notes(&source.notes, progress);
    let preset = &source.recipe.preset;
    let mut idle = idle(preset, pairs);
    for season in seasons {
        let mut preset = preset.clone();
        preset.dressing.foliage.season = season.season;
        let of_one = self::idle(&preset, pairs);
        idle.retain(|note| of_one.contains(note));
    }
    notes(&idle, progress);
}

/// What to say of knobs that were turned and change nothing.
fn idle(preset: &Preset, pairs: &[(String, String)]) -> Vec<String> {
    preset.idle_notes(pairs.iter().map(|(name, _)| name.as_str()))
}

/// What `--seed` says, as a knob's name and value.
fn seeded(seed: u64) -> (String, String) {
    ("seed".to_owned(), seed.to_string())
}

/// What `--lods` says, as a knob's name and value: a number of levels, or the triangles of each.
fn lods(text: &str) -> (String, String) {
    let name = if text.contains([',', ' ']) { "lod_triangles" } else { "lods" };
    (name.to_owned(), text.to_owned())
}

/// A list of triangles for `--lods` runs from the finest level to the coarsest. Whether it is one at all is the knob's business.
fn lods_falling(text: &str) -> Result<String, String> {
    let budgets: Vec<f64> = text.split([',', ' ']).filter_map(|number| number.trim().parse().ok()).collect();
    match budgets.windows(2).find(|two| two[1] >= two[0]) {
        Some(two) => Err(format!(
            "{} triangles follow {}; list the levels from the finest to the coarsest",
            two[1], two[0]
        )),
        None => Ok(text.to_owned()),
    }
}

/// Whether a name is that of an option of a format, `glb.instances`, and no knob, as `blossom.leaf_keep` is one.
fn is_of_format(name: &str) -> bool {
    name.contains('.') && !linden::preset::is_kind_knob(name)
}

/// `KNOB=VALUE` as names and values.
fn pairs(settings: &[String]) -> anyhow::Result<Vec<(String, String)>> {
    split_pairs(settings, "--set", "KNOB=VALUE, like --set points=500")
}

/// `NAME=VALUE` as names and values.
fn defines(settings: &[String]) -> anyhow::Result<Vec<(String, String)>> {
    split_pairs(settings, "--define", "NAME=VALUE, like --define r1=0.8")
}

fn split_pairs(settings: &[String], flag: &str, expected: &str) -> anyhow::Result<Vec<(String, String)>> {
    let mut pairs = Vec::new();
    for setting in settings {
        let Some((name, value)) = setting.split_once('=') else {
            let shown = linden::knob::printable(setting);
            return Err(exit::usage(format!("{flag} {shown}: expected {expected}")));
        };
        pairs.push((name.trim().to_owned(), value.trim().to_owned()));
    }
    Ok(pairs)
}

/// Gives constants of a source's grammar other values.
fn define(source: &mut Source, settings: &[String]) -> anyhow::Result<()> {
    for (name, value) in defines(settings)? {
        source.recipe.preset.define(&name, &value).map_err(exit::usage)?;
    }
    Ok(())
}

/// Grows a source; what the user should know goes to standard error.
fn grown(source: &Source, progress: &Progress) -> anyhow::Result<Grown> {
    grown_beside(source, progress, progress)
}

/// The same, with its pictures drawn meanwhile.
fn grown_and_drawn(source: &Source, progress: &Progress) -> anyhow::Result<Grown> {
    noted(grow_and_draw(&source.recipe, progress), source, progress)
}

/// The same beside what `holding` knows to be held.
fn grown_beside(source: &Source, holding: &dyn Monitor, progress: &Progress) -> anyhow::Result<Grown> {
    noted(grow(&source.recipe, holding), source, progress)
}

fn noted(grown: Result<Grown, GrowError>, source: &Source, progress: &Progress) -> anyhow::Result<Grown> {
    use anyhow::Context as _;
    let grown = grown.with_context(|| source.shown.clone())?;
    notes(&grown.notes, progress);
    notes(source.tree_note(&grown).as_slice(), progress);
    Ok(grown)
}

fn notes(notes: &[String], progress: &Progress) {
    for note in notes {
        progress.beside(|| exit::say(&format!("note: {note}")));
    }
}

/// The names of all commands.
fn command_names() -> Vec<String> {
    Cli::command().get_subcommands().map(|command| command.get_name().to_owned()).collect()
}

/// Writes a result to standard output.
fn print(text: &str) -> anyhow::Result<()> {
    print_bytes(text.as_bytes())
}

fn print_bytes(bytes: &[u8]) -> anyhow::Result<()> {
    use anyhow::Context as _;
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(exit::ReaderGone.into()),
        done => done.context("writing to standard output"),
    }
}

/// Writes a result to standard output as JSON.
fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// Where the command is left out and a source stands in its place, says which commands take it.
fn tell_what_takes_a_source(error: &mut clap::Error) {
    use clap::error::{ContextKind, ContextValue};
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand) else { return };
    let source = Path::new(typed);
    let is_preset = linden::preset::builtin(typed).is_ok() || linden::forest::builtin_forest(typed).is_ok();
    if !is_preset && !source.is_file() && !matches!(crate::source::user_preset(source), Ok(Some(_))) {
        return;
    }
    let typed = crate::paths::show(source);
    let tip = format!("'linden open {typed}' shows it in the workbench, 'linden preview {typed}' draws it");
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
}

/// Where a source stands behind a command that takes none, says which do.
fn tell_what_takes_a_source_here(error: &mut clap::Error, typed: &str) {
    use clap::error::{ContextKind, ContextValue};
    if source::ensure_there(Path::new(typed)).is_ok() {
        let typed = crate::paths::show(Path::new(typed));
        let tip = format!("'linden show {typed}' describes it, 'linden preview {typed}' draws it");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
}

/// Says what a flag that the command does not have is called here, or which commands have it.
fn tell_what_is_meant(error: &mut clap::Error) {
    use clap::error::{ContextKind, ContextValue};
    if error.kind() != ErrorKind::UnknownArgument {
        return;
    }
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else { return };
    if !typed.starts_with('-') {
        return tell_what_takes_a_source_here(error, &typed.clone());
    }
    let mut program = Cli::command();
    program.build();
    let mut words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let command = words.find(|word| program.find_subcommand(word).is_some());
    let meant = if typed.starts_with("--") {
        flags::Meant::by(typed, command.as_deref(), &program)
    } else {
        // All letters that were typed with it.
        let word = words.find(|word| word.starts_with(typed.as_str())).unwrap_or_else(|| typed.clone());
        flags::Meant::by_letters(&word, command.as_deref(), &program)
    };
    // No flag is a source: the way to pass it as one is no advice. And what clap finds alike often begins alike only.
    error.remove(ContextKind::Suggested);
    error.remove(ContextKind::SuggestedArg);
    error.insert(ContextKind::Usage, ContextValue::StyledStr(flags::usage(&mut program, command.as_deref())));
    match meant {
        flags::Meant::Flag(flag) => {
            error.insert(ContextKind::SuggestedArg, ContextValue::String(flag));
        }
        flags::Meant::Tips(tips) => {
            let tips = tips.into_iter().map(Into::into).collect();
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
        }
        flags::Meant::Nothing => {}
    }
}

/// Parses the command line, sources apart from options that would take them for their value.
fn parse() -> Result<Cli, clap::Error> {
    let typed: Vec<_> = std::env::args_os().collect();
    if !optional::are_among(&typed) {
        return Cli::try_parse_from(typed);
    }
    let mut program = Cli::command();
    program.build();
    let parse = |taking| Cli::try_parse_from(optional::apart(&program, typed.clone(), taking));
    parse(optional::Taking::Unlike).or_else(|error| match error.kind() {
        ErrorKind::MissingRequiredArgument => parse(optional::Taking::All).map_err(|_| error),
        _ => Err(error),
    })
}

/// Where a source is missing, says which option took a word that may have been meant for one.
fn tell_what_took_a_source(error: &mut clap::Error) {
    use clap::error::{ContextKind, ContextValue};
    if error.kind() != ErrorKind::MissingRequiredArgument {
        return;
    }
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else { return };
    if !missing.iter().any(|argument| argument.starts_with('<')) {
        return;
    }
    let arguments: Vec<_> = std::env::args_os().collect();
    let mut program = Cli::command();
    program.build();
    let Some((option, word)) = optional::taken(&program, &arguments) else { return };
    let tip = format!("'{word}' is taken for the value of {option}; write the source before {option}");
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
}

/// Parses the command line and does what it says.
pub fn run() -> ExitCode {
    crate::system::outlive_file_limits();
    completions::answer(Cli::command);
    let mut cli = match parse() {
        Ok(cli) => cli,
        Err(mut error) => {
            tell_what_takes_a_source(&mut error);
            tell_what_is_meant(&mut error);
            tell_what_took_a_source(&mut error);
            // Help and version go to standard output with 0, mistakes to standard error with 2.
            let code = u8::try_from(error.exit_code()).unwrap_or(2);
            let _ = error.print();
            return ExitCode::from(code);
        }
    };
    if let Err(error) = limits(&cli) {
        return exit::report(&error);
    }
    if let Some(command) = &mut cli.command
        && let Err(error) = command.take(&mut cli.terminal)
    {
        return exit::report(&error);
    }
    if let Err(problem) = crate::trust::allow(&cli.allow_path) {
        return exit::report(&exit::usage(problem));
    }
    let done = match cli.command {
        // The workbench hears signals in another way, and gives the terminal back first.
        None => cli.terminal.open(None, Vec::new()),
        Some(CliCommand::Open(open)) => open.run(),
        Some(command) => crate::signals::listen().map_err(anyhow::Error::from).and_then(|()| command.run()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => exit::report(&error),
    }
}

/// Limits memory, and opens the cache, by what flags, variables or `config.toml` say, whichever comes first.
fn limits(cli: &Cli) -> anyhow::Result<()> {
    let variable = |name: &str| std::env::var(name).ok().filter(|text| !text.is_empty());
    let dirs = Dirs::of_environment();
    // What is wrong in the file is said where it is shown: in the workbench, by the doctor.
    let settings = LazyCell::new(|| Settings::load(dirs.settings().as_deref()).0);
    let said = cli.memory.clone().map(|text| ("--memory", text));
    let limit = match said.or_else(|| variable(memory::VARIABLE).map(|text| (memory::VARIABLE, text))) {
        Some((name, text)) => {
            memory::parse(&text).map_err(|problem| exit::usage(format!("{name}: {problem}")))?
        }
        None => settings.memory_bytes,
    };
    memory::set_limit(limit);
    let size = match variable(crate::cache::VARIABLE) {
        _ if cli.no_cache => CacheSize::Off,
        Some(text) => CacheSize::parse(&text)
            .map_err(|problem| exit::usage(format!("{}: {problem}", crate::cache::VARIABLE)))?,
        None => settings.cache,
    };
    crate::cache::open(dirs.pictures(), size);
    Ok(())
}

impl CliCommand {
    /// Takes the flags of the workbench that stand before a command, as far as it has them.
    fn take(&mut self, before: &mut workbench::TerminalArgs) -> anyhow::Result<()> {
        match self {
            Self::Open(command) => command.terminal.fill(before),
            Self::Preview(command) => command.terminal.fill(&mut before.look),
            Self::Doctor(command) => command.look.fill(&mut before.look),
            _ => {}
        }
        match before.given() {
            None => Ok(()),
            Some((flag, commands)) => {
                Err(exit::usage(format!("{flag} has no effect here: it is for {commands}")))
            }
        }
    }

    fn run(self) -> anyhow::Result<()> {
        match self {
            Self::Open(command) => command.run(),
            Self::List(command) => command.run(),
            Self::Show(command) => command.run(),
            Self::Stats(command) => command.run(),
            Self::Sweep(command) => command.run(),
            Self::Calibrate(command) => command.run(),
            Self::Batch(command) => command.run(),
            Self::Bench(command) => command.run(),
            Self::Preview(command) => command.run(),
            Self::Sheet(command) => command.run(),
            Self::Export(command) => command.run(),
            Self::Impostor(command) => command.run(),
            Self::Scan(command) => command.run(),
            Self::Recipe(command) => command.run(),
            Self::Verify(command) => command.run(),
            Self::Lint(command) => command.run(),
            Self::Cite(command) => command.run(),
            Self::Forest(command) => command.run(),
            Self::Doctor(command) => command.run(),
            Self::Cache(command) => command.run(),
            Self::Completions(command) => command.run(),
            Self::Man(command) => command.run(Cli::command()),
            Self::Schema(command) => command.run(),
        }
    }
}
