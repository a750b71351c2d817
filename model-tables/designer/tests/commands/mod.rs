//! The commands of the documents, and cargo's aliases and packages that they name.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use toml::de::DeTable;

/// The folder of the workspace.
pub(crate) fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("the package lies in the workspace")
}

/// A document's path in the workspace, and its text.
pub(crate) struct Document {
    pub(crate) path: String,
    pub(crate) text: String,
}

/// Every document but those of what has been.
pub(crate) fn documents() -> Vec<Document> {
    let mut paths = vec![];
    walk(workspace(), ".md", &mut paths);
    paths.sort();
    paths
        .into_iter()
        .map(|path| Document {
            text: fs::read_to_string(&path).expect("it was found"),
            path: path
                .strip_prefix(workspace())
                .expect("it was found there")
                .display()
                .to_string(),
        })
        .collect()
}

/// What a document shows, in its order.
pub(crate) enum Shown {
    /// A fenced block that is a file: its name and its text.
    File(String, String),
    /// A command of a fenced block of `sh`.
    Command(Command),
    /// A command in a sentence.
    Mention(Command),
}

/// A command line.
#[derive(Clone)]
pub(crate) struct Command {
    /// As it stands, with single spaces.
    pub(crate) line: String,
    /// Variables set for it.
    pub(crate) variables: Vec<(String, String)>,
    /// The program and its arguments.
    pub(crate) words: Vec<String>,
}

/// Programs whose name begins a command.
const PROGRAMS: [&str; 7] = [
    "cargo", "cat", "designer", "probe-rs", "python3", "rustup", "stty",
];

impl Command {
    /// The command in a line, if it is one; a comment behind it is left out.
    fn of(line: &str) -> Option<Self> {
        let line = line.split(" #").next()?;
        assert!(
            !line.contains(['"', '\'', '|', ';', '&', '>']),
            "for a shell: {line}"
        );
        let mut words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let line = words.join(" ");
        let assigned = words
            .iter()
            .take_while(|word| word.contains('=') && word.starts_with(|c: char| c.is_ascii_uppercase()))
            .count();
        let variables = words
            .drain(..assigned)
            .filter_map(|word| {
                word.split_once('=')
                    .map(|(name, value)| (name.into(), value.into()))
            })
            .collect();
        // One word alone names a program and is no command.
        let command = words.len() > 1 && PROGRAMS.contains(&words[0].as_str());
        command.then_some(Self {
            line,
            variables,
            words,
        })
    }
}

impl Document {
    /// Files and commands.
    pub(crate) fn shown(&self) -> Vec<Shown> {
        let mut shown = vec![];
        let (mut lines, mut prose) = (self.text.lines(), String::new());
        while let Some(line) = lines.next() {
            let Some(info) = line.trim_start().strip_prefix("```") else {
                prose.push_str(line);
                prose.push('\n');
                continue;
            };
            mentions(&std::mem::take(&mut prose), &mut shown);
            let indent = line.len() - line.trim_start().len();
            let text: Vec<&str> = lines
                .by_ref()
                .take_while(|line| line.trim() != "```")
                .map(|line| line.get(indent..).unwrap_or_default())
                .collect();
            match info.split_once(' ') {
                Some((_, name)) => shown.push(Shown::File(name.to_owned(), text.join("\n") + "\n")),
                None if info == "sh" => {
                    for line in text {
                        let command = Command::of(line);
                        let command = command.unwrap_or_else(|| panic!("{}: what is `{line}`?", self.path));
                        shown.push(Shown::Command(command));
                    }
                }
                None => {}
            }
        }
        mentions(&prose, &mut shown);
        shown
    }
}

fn mentions(prose: &str, shown: &mut Vec<Shown>) {
    let code = prose.split('`').skip(1).step_by(2);
    // The names of the tool's subcommands are no commands.
    let begins = |code: &&str| {
        !code.starts_with("designer") && code.split_whitespace().any(|word| PROGRAMS.contains(&word))
    };
    shown.extend(code.filter(begins).filter_map(Command::of).map(Shown::Mention));
}

/// The arguments of `cargo` with the alias put in, as `.cargo/config.toml` has it.
pub(crate) fn resolved(arguments: &[String]) -> Vec<String> {
    let text = fs::read_to_string(workspace().join(".cargo/config.toml")).expect("it is there");
    let config = DeTable::parse(&text).expect("cargo reads it");
    let aliases = config.get_ref()["alias"].get_ref();
    let (name, rest) = arguments.split_first().expect("a subcommand");
    let alias = aliases
        .as_table()
        .expect("a section")
        .iter()
        .find(|(alias, _)| alias.get_ref() == name);
    let Some((_, alias)) = alias else {
        return arguments.to_vec();
    };
    let mut words: Vec<String> = match (alias.get_ref().as_str(), alias.get_ref().as_array()) {
        (Some(words), _) => words.split_whitespace().map(str::to_owned).collect(),
        (_, Some(words)) => words
            .iter()
            .map(|word| word.get_ref().as_str().expect("a word").to_owned())
            .collect(),
        _ => panic!("what is the alias {name}?"),
    };
    words.extend_from_slice(rest);
    words
}

/// The arguments before `--`, and those after it.
pub(crate) fn split(arguments: &[String]) -> (&[String], &[String]) {
    match arguments.iter().position(|argument| argument == "--") {
        Some(at) => (&arguments[..at], &arguments[at + 1..]),
        None => (arguments, &[]),
    }
}

/// The value of an option.
pub(crate) fn value<'a>(arguments: &'a [String], option: &str) -> Option<&'a str> {
    let at = arguments.iter().position(|argument| argument == option)?;
    arguments.get(at + 1).map(String::as_str)
}

/// What cargo knows of a package of the workspace.
struct Package {
    name: String,
    /// Kind, name and source of every target.
    targets: Vec<(String, String, PathBuf)>,
    /// Every source of its library.
    modules: Vec<PathBuf>,
    features: BTreeSet<String>,
}

/// Every file below a folder whose name ends so.
fn walk(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        let past = ["target", "findings", "CHANGELOG.md"].contains(&&*name);
        if past || name.starts_with('.') || path.is_symlink() {
            continue;
        }
        if path.is_dir() {
            walk(&path, ending, found);
        } else if name.ends_with(ending) {
            found.push(path);
        }
    }
}

fn packages() -> Vec<Package> {
    let output = process::Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(workspace())
        .output()
        .expect("cargo");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("cargo's JSON");
    let text = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    let list = |value: &serde_json::Value| value.as_array().expect("a list").clone();
    list(&metadata["packages"])
        .iter()
        .map(|package| Package {
            name: text(&package["name"]),
            targets: list(&package["targets"])
                .iter()
                .map(|target| {
                    (
                        text(&target["kind"][0]),
                        text(&target["name"]),
                        text(&target["src_path"]).into(),
                    )
                })
                .collect(),
            modules: {
                let manifest = PathBuf::from(text(&package["manifest_path"]));
                let mut modules = vec![];
                walk(&manifest.with_file_name("src"), ".rs", &mut modules);
                modules
            },
            features: package["features"]
                .as_object()
                .expect("features")
                .keys()
                .cloned()
                .collect(),
        })
        .collect()
}

/// Asserts that packages, targets, features, profiles and tests of cargo's arguments exist.
///
/// # Panics
/// If one does not, or this does not know an option.
pub(crate) fn assert_names_exist(line: &str, arguments: &[String]) {
    let (arguments, tests) = split(arguments);
    let (subcommand, options) = arguments.split_first().expect("a subcommand");
    assert!(
        ["run", "test", "bench", "build"].contains(&subcommand.as_str()),
        "{line}: what is `cargo {subcommand}`?"
    );
    let all = packages();
    let named = value(options, "--package").or_else(|| value(options, "-p"));
    let packages: Vec<&Package> = all
        .iter()
        .filter(|package| named.is_none_or(|named| package.name == named))
        .collect();
    assert!(!packages.is_empty(), "{line}: no package {named:?}");
    let targets = |kind: &str, name: &str| -> Vec<&PathBuf> {
        packages
            .iter()
            .flat_map(|package| &package.targets)
            .filter(|target| target.0 == kind && target.1 == name)
            .map(|target| &target.2)
            .collect()
    };
    let (mut words, mut sources) = (options.iter(), vec![]);
    while let Some(word) = words.next() {
        let mut value = || words.next().expect("its value").as_str();
        match word.as_str() {
            "-p" | "--package" | "--target" | "--config" => {
                value();
            }
            "--test" | "--bin" | "--bench" | "--example" => {
                let name = value();
                let found = targets(&word[2..], name);
                assert!(!found.is_empty(), "{line}: no {} `{name}`", &word[2..]);
                sources.extend(found);
            }
            "--features" => {
                for feature in value().split(',') {
                    let known = packages.iter().any(|package| package.features.contains(feature));
                    assert!(known, "{line}: no feature `{feature}`");
                }
            }
            "--profile" => {
                let section = format!("[profile.{}]", value());
                let manifest = fs::read_to_string(workspace().join("Cargo.toml")).expect("it is there");
                assert!(manifest.contains(&section), "{line}: no {section}");
            }
            "--lib" => sources.extend(packages.iter().flat_map(|package| &package.modules)),
            "--release"
            | "--quiet"
            | "-vv"
            | "--workspace"
            | "--ignore-rust-version"
            | "--no-default-features" => {}
            name => {
                assert!(
                    subcommand == "test" && !name.starts_with('-'),
                    "{line}: what is `{name}`?"
                );
                // A test, or a module of them with its path.
                let last = name.rsplit("::").next().unwrap_or(name);
                let has = |source: &&PathBuf| fs::read_to_string(source).expect("a source").contains(last);
                assert!(sources.iter().any(has), "{line}: no test `{name}`");
            }
        }
    }
    if subcommand != "run" {
        assert!(
            tests
                .iter()
                .all(|option| ["--nocapture", "--ignored", "--include-ignored"].contains(&option.as_str())),
            "{line}: {tests:?}"
        );
    }
}

/// Asserts that the image of cargo's arguments is for one chip: what embassy refuses otherwise.
///
/// # Panics
/// If it is for none or several.
pub(crate) fn assert_one_chip(line: &str, arguments: &[String]) {
    let (arguments, _) = split(arguments);
    let mut tree = process::Command::new(env!("CARGO"));
    tree.args([
        "tree",
        "--locked",
        "--edges",
        "features",
        "--invert",
        "embassy-stm32",
    ])
    .current_dir(workspace());
    for option in ["--target", "--package", "--features"] {
        if let Some(value) = value(arguments, option) {
            tree.args([option, value]);
        }
    }
    if arguments
        .iter()
        .any(|argument| argument == "--no-default-features")
    {
        tree.arg("--no-default-features");
    }
    let output = tree.output().expect("cargo");
    let text = String::from_utf8_lossy(&output.stdout);
    let chips: BTreeSet<&str> = text
        .split("embassy-stm32 feature \"stm32")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        // `stm32-hrtim` is a timer of some chips.
        .filter(|chip| !chip.starts_with('-'))
        .collect();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(chips.len(), 1, "{line}: {chips:?}\n{stderr}");
}
