//! The firmware image: built by asking cargo, unmodified, and read for its symbols and sizes.

use crate::fingertip_design::workspace;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SymbolKind};
use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

/// What the part executes.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// Where the part's RAM begins and ends.
const RAM: std::ops::Range<u64> = 0x2000_0000..0x4000_0000;
/// The part's core-coupled memory is RAM too.
const CORE_COUPLED: std::ops::Range<u64> = 0x1000_0000..0x1001_0000;

/// A linked image.
#[derive(Clone, Debug)]
pub struct Image {
    path: PathBuf,
    elf: Vec<u8>,
    beside: Vec<(u64, Vec<u8>)>,
}

/// Why there is no image, or not what was looked for in it.
#[derive(Debug)]
pub enum ImageError {
    /// The Rust target is missing and could not be added.
    Target(String),
    /// The design's path is not UTF-8, and the build takes no other.
    DesignPath(PathBuf),
    /// cargo could not be started.
    Cargo(std::io::Error),
    /// cargo did not build it. It has printed why.
    Build {
        /// The binary asked for.
        binary: String,
    },
    /// cargo built no such binary.
    Missing {
        /// The binary asked for.
        binary: String,
    },
    /// The file cannot be read.
    Unreadable(PathBuf, std::io::Error),
    /// The file is not an image.
    Malformed(PathBuf, object::Error),
    /// Its debug information cannot be read.
    Debug(String),
    /// No function, or several, of this name.
    Symbol {
        /// The name looked for.
        name: String,
        /// How many there are.
        found: usize,
    },
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Target(why) => write!(
                f,
                "the Rust target {TARGET} is missing and cannot be added ({why}): `rustup target add {TARGET}`"
            ),
            Self::DesignPath(path) => write!(
                f,
                "{}: the path of a design must be UTF-8: rename the file or its folder",
                path.display()
            ),
            Self::Cargo(error) => write!(f, "cannot start cargo: {error}"),
            Self::Build { binary } => write!(f, "the image `{binary}` does not build, see above"),
            Self::Missing { binary } => write!(f, "cargo built no binary `{binary}`"),
            Self::Unreadable(path, error) => write!(f, "cannot read {}: {error}", path.display()),
            Self::Malformed(path, error) => write!(f, "{} is not an image: {error}", path.display()),
            Self::Debug(why) => write!(f, "the image's debug information cannot be read: {why}"),
            Self::Symbol { name, found } => {
                write!(f, "the image has {found} functions called `{name}`, not one")
            }
        }
    }
}

impl std::error::Error for ImageError {}

/// Bytes an image takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    /// Bytes of flash: code, constants and initial values.
    pub flash: u64,
    /// Bytes of RAM that hold statics; the stack comes on top.
    pub ram: u64,
}

impl Image {
    /// The firmware for the default board and `design` (a design file; without one, what the build itself
    /// takes by default).
    ///
    /// # Errors
    /// [`ImageError`] when the target is missing or cargo does not build it.
    pub fn firmware(design: Option<&Path>) -> Result<Self, ImageError> {
        Self::build_for("firmware", design, None)
    }

    /// The binary called `binary` of the package of probes. cargo's own progress goes to standard error.
    ///
    /// # Errors
    /// [`ImageError`] when the target is missing or cargo does not build it.
    pub fn build(binary: &str, design: Option<&Path>) -> Result<Self, ImageError> {
        Self::build_in("probes", binary, design, None)
    }

    /// The binary called `binary` of the firmware package, for the board of a feature; without one, the default board.
    ///
    /// # Errors
    /// [`ImageError`] when the target is missing or cargo does not build it.
    pub fn build_for(binary: &str, design: Option<&Path>, board: Option<&str>) -> Result<Self, ImageError> {
        Self::build_in("fingertip", binary, design, board)
    }

    fn build_in(
        package: &str,
        binary: &str,
        design: Option<&Path>,
        board: Option<&str>,
    ) -> Result<Self, ImageError> {
        /// From the build to the reading: images for different designs are the same file.
        static BUILDING: Mutex<()> = Mutex::new(());
        let _building = BUILDING.lock();
        add_target()?;
        let mut cargo = Command::new(cargo());
        cargo
            .current_dir(workspace())
            .args(["build", "--profile", "firmware", "--target", TARGET])
            .args(["--package", package, "--bin", binary])
            .arg("--message-format=json-render-diagnostics")
            .stdout(Stdio::piped());
        if let Some(design) = design {
            let design = design
                .to_str()
                .ok_or_else(|| ImageError::DesignPath(design.to_owned()))?;
            cargo.env("FINGERTIP_DESIGN", design);
        }
        if let Some(board) = board {
            cargo.args(["--no-default-features", "--features", board]);
        }
        let mut child = cargo.spawn().map_err(ImageError::Cargo)?;
        let mut messages = String::new();
        if let Some(stdout) = child.stdout.as_mut() {
            stdout.read_to_string(&mut messages).map_err(ImageError::Cargo)?;
        }
        if !child.wait().map_err(ImageError::Cargo)?.success() {
            return Err(ImageError::Build {
                binary: binary.to_owned(),
            });
        }
        let path = executable(&messages, binary).ok_or_else(|| ImageError::Missing {
            binary: binary.to_owned(),
        })?;
        Self::read(&path)
    }

    /// The image in a file.
    ///
    /// # Errors
    /// [`ImageError`] when it cannot be read or is no ELF file.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let elf = std::fs::read(path).map_err(|error| ImageError::Unreadable(path.to_owned(), error))?;
        let image = Self {
            path: path.to_owned(),
            elf,
            beside: vec![],
        };
        image.file()?;
        Ok(image)
    }

    /// Where it was read from. The file may have been built anew since; [`Image::bytes`] has not changed.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The ELF file.
    pub fn bytes(&self) -> &[u8] {
        &self.elf
    }

    /// The same with these bytes in flash beside it, from an address on.
    #[must_use]
    pub fn with_flash(mut self, address: u64, bytes: Vec<u8>) -> Self {
        self.beside.push((address, bytes));
        self
    }

    /// The same with other instructions from an address on; nothing if no section holds it.
    #[must_use]
    pub fn with_code(&self, address: u64, instructions: [u16; 2]) -> Option<Self> {
        let offset = self.file().ok()?.sections().find_map(|section| {
            let (start, size) = section.file_range()?;
            let within = address.checked_sub(section.address())?;
            (section.kind() == object::SectionKind::Text && within + 4 <= size).then_some(start + within)
        })?;
        let mut image = self.clone();
        let place = image
            .elf
            .get_mut(usize::try_from(offset).ok()?..)?
            .first_chunk_mut::<4>()?;
        let [first, second] = instructions.map(u16::to_le_bytes);
        *place = [first[0], first[1], second[0], second[1]];
        Some(image)
    }

    /// What lies in flash beside it: addresses and bytes.
    pub fn beside(&self) -> &[(u64, Vec<u8>)] {
        &self.beside
    }

    /// Bytes of flash that name folders of the machine that built it: where a panic lies, cargo gives the source file with the
    /// folder of its registry or of the workspace before it. They differ from one machine to the next.
    ///
    /// # Errors
    /// [`ImageError::Malformed`].
    pub fn folder_bytes(&self) -> Result<u64, ImageError> {
        let cargo = std::env::var_os("CARGO_HOME")
            .map(PathBuf::from)
            .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
        let registry = cargo.map(|home| home.join("registry").join("src"));
        let folders = [registry, workspace().canonicalize().ok()].map(|folder| {
            let folder = folder?.to_str()?.as_bytes().to_vec();
            Some([folder, std::path::MAIN_SEPARATOR_STR.as_bytes().to_vec()].concat())
        });
        let mut total = 0;
        for data in self.loaded()? {
            for (at, _) in data.iter().enumerate() {
                let found = folders
                    .iter()
                    .flatten()
                    .find(|folder| data[at..].starts_with(folder));
                total += found.map_or(0, |folder| folder.len() as u64);
            }
        }
        Ok(total)
    }

    /// Whether its flash holds a text. A source file that can panic is named there.
    ///
    /// # Errors
    /// [`ImageError::Malformed`].
    pub fn holds(&self, text: &str) -> Result<bool, ImageError> {
        let is_in = |data: &&[u8]| data.windows(text.len()).any(|part| part == text.as_bytes());
        Ok(self.loaded()?.iter().any(is_in))
    }

    /// The bytes of the sections that are in the chip's memory.
    fn loaded(&self) -> Result<Vec<&[u8]>, ImageError> {
        let file = self.file()?;
        let mut loaded = Vec::new();
        for section in file.sections() {
            if matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & u64::from(object::elf::SHF_ALLOC) != 0)
            {
                loaded.push(section.data().map_err(|error| self.malformed(error))?);
            }
        }
        Ok(loaded)
    }

    /// What it takes of flash and RAM.
    ///
    /// # Errors
    /// [`ImageError::Malformed`].
    pub fn size(&self) -> Result<Size, ImageError> {
        let mut size = Size::default();
        for section in self.file()?.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else {
                continue;
            };
            if sh_flags & u64::from(object::elf::SHF_ALLOC) == 0 {
                continue;
            }
            let in_ram = RAM.contains(&section.address()) || CORE_COUPLED.contains(&section.address());
            let initialised = section.kind() != object::SectionKind::UninitializedData;
            if in_ram {
                size.ram += section.size();
            }
            // Initial values of RAM are kept in flash.
            if initialised {
                size.flash += section.size();
            }
        }
        Ok(size)
    }

    /// Value of a symbol of the linker.
    ///
    /// # Errors
    /// [`ImageError::Symbol`] when there is none.
    pub fn symbol(&self, name: &str) -> Result<u64, ImageError> {
        let file = self.file()?;
        let symbol = file.symbol_by_name(name);
        symbol
            .map(|symbol| symbol.address())
            .ok_or_else(|| ImageError::Symbol {
                name: name.to_owned(),
                found: 0,
            })
    }

    /// Address of the one function called `name` whose demangled path has `owner` (a type or a module) in it.
    ///
    /// # Errors
    /// [`ImageError::Symbol`] when there is none, or more than one.
    pub fn function(&self, owner: &str, name: &str) -> Result<u64, ImageError> {
        let suffix = format!("::{name}");
        let file = self.file()?;
        let mut addresses: Vec<u64> = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .filter(|symbol| {
                symbol.name().is_ok_and(|mangled| {
                    let path = format!("{:#}", rustc_demangle::demangle(mangled));
                    path.contains(owner) && path.ends_with(&suffix)
                })
            })
            // Bit 0 says Thumb.
            .map(|symbol| symbol.address() & !1)
            .collect();
        addresses.sort_unstable();
        addresses.dedup();
        match addresses[..] {
            [address] => Ok(address),
            _ => Err(ImageError::Symbol {
                name: format!("{owner} .. {name}"),
                found: addresses.len(),
            }),
        }
    }

    /// The addresses that follow the calls of the function at `address`: where it returns to.
    ///
    /// # Errors
    /// [`ImageError::Malformed`].
    pub fn returns_of(&self, address: u64) -> Result<Vec<u64>, ImageError> {
        let file = self.file()?;
        let mut returns = vec![];
        for section in file
            .sections()
            .filter(|section| section.kind() == object::SectionKind::Text)
        {
            let code = section.data().map_err(|error| self.malformed(error))?;
            let halfwords: Vec<u16> = code
                .chunks_exact(2)
                .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
                .collect();
            for (i, pair) in halfwords.windows(2).enumerate() {
                let at = section.address() + 2 * i as u64;
                if branch_with_link([pair[0], pair[1]], at) == Some(address) {
                    returns.push(at + 4);
                }
            }
        }
        Ok(returns)
    }

    pub(crate) fn file(&self) -> Result<object::File<'_>, ImageError> {
        object::File::parse(&*self.elf).map_err(|error| self.malformed(error))
    }

    pub(crate) fn malformed(&self, error: object::Error) -> ImageError {
        ImageError::Malformed(self.path.clone(), error)
    }
}

/// Where a BL at address `at` goes (ARMv7-M ARM A7.7.18, encoding T1), `None` for any other instruction.
fn branch_with_link([first, second]: [u16; 2], at: u64) -> Option<u64> {
    if first >> 11 != 0b11110 || second & 0xd000 != 0xd000 {
        return None;
    }
    let bit = |halfword: u16, n: u16| i32::from(halfword >> n & 1);
    let sign = bit(first, 10);
    let (i1, i2) = (1 ^ bit(second, 13) ^ sign, 1 ^ bit(second, 11) ^ sign);
    let offset =
        -(sign << 24) | i1 << 23 | i2 << 22 | i32::from(first & 0x3ff) << 12 | i32::from(second & 0x7ff) << 1;
    Some(at.wrapping_add(4).wrapping_add_signed(i64::from(offset)))
}

/// The cargo that runs this, or the one in the path.
fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// The executable that cargo's messages name.
fn executable(messages: &str, binary: &str) -> Option<PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter(|message| message["reason"] == "compiler-artifact" && message["target"]["name"] == binary)
        .filter_map(|message| message["executable"].as_str().map(PathBuf::from))
        .next_back()
}

/// Makes sure that the Rust target is there.
fn add_target() -> Result<(), ImageError> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let installed = Command::new(rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .output()
        .is_ok_and(|output| {
            let folder = String::from_utf8_lossy(&output.stdout);
            output.status.success() && Path::new(folder.trim()).is_dir()
        });
    if installed {
        return Ok(());
    }
    eprintln!("adding the Rust target {TARGET} ...");
    match Command::new("rustup").args(["target", "add", TARGET]).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(ImageError::Target(format!("rustup: {status}"))),
        Err(error) => Err(ImageError::Target(format!("rustup: {error}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_where_a_call_goes() {
        // Encoded by hand from the manual: BL to itself, to the next instruction, and a megabyte back.
        assert_eq!(branch_with_link([0xf7ff, 0xfffe], 0x0800_0100), Some(0x0800_0100));
        assert_eq!(branch_with_link([0xf000, 0xf800], 0x0800_0100), Some(0x0800_0104));
        assert_eq!(branch_with_link([0xf700, 0xf800], 0x0810_0000), Some(0x0800_0004));
        // B.W, and a 16-bit pair.
        assert_eq!(branch_with_link([0xf000, 0xb800], 0x0800_0100), None);
        assert_eq!(branch_with_link([0xbf00, 0xbf00], 0x0800_0100), None);
    }

    #[test]
    fn takes_the_executable_from_cargos_messages() {
        let messages = concat!(
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"other\"},\"executable\":\"/a\"}\n",
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"firmware\"},\"executable\":\"/b\"}\n",
            "{\"reason\":\"build-finished\",\"success\":true}\n"
        );
        assert_eq!(executable(messages, "firmware"), Some(PathBuf::from("/b")));
        assert_eq!(executable(messages, "probe"), None);
    }
}
