//! Sweeps: parts of many designs, as `designer sweep` writes them.

use crate::SweepError;
use designer::sweep::folder::{Folder, Shard, manifest_of};
use designer::sweep::space::Space;
use designer::sweep::{Swept, SweptPart, inline, part as compute_part, run};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

fn refuse(error: impl std::fmt::Display) -> PyErr {
    SweepError::new_err(error.to_string())
}

/// The text of a sweep with its design in it, which a process on another machine can read.
#[pyfunction]
pub(crate) fn sweep_text(path: PathBuf) -> PyResult<String> {
    inline::whole(&path).map_err(refuse)
}

/// The whole sweep on the cores of this machine: designs, ready before, computed, refused, first reason, parts.
#[pyfunction]
pub(crate) fn sweep(
    python: Python<'_>,
    path: PathBuf,
    out: PathBuf,
) -> PyResult<(u64, u64, u64, u64, Option<String>, u64)> {
    let Swept {
        designs,
        before,
        computed,
        refused,
        first_reason,
        parts,
    } = python
        .detach(|| {
            let space = Space::read(&path).map_err(|error| error.to_string())?;
            run(&space, &out, Shard::WHOLE).map_err(|refusal| refusal.0)
        })
        .map_err(refuse)?;
    Ok((designs, before, computed, refused, first_reason, parts))
}

/// The bytes of a part, on the calling thread alone: rows, refused, first reason. `manifest` is that of the folder: a program that
/// would write other rows refuses.
#[pyfunction]
pub(crate) fn sweep_part<'py>(
    python: Python<'py>,
    text: &str,
    part: u64,
    manifest: &str,
) -> PyResult<(Bound<'py, PyBytes>, u64, u64, Option<String>)> {
    let made: Result<SweptPart, String> = python.detach(|| {
        let space = Space::parse(text, "the sweep").map_err(|error| error.to_string())?;
        let own = manifest_of(&space);
        if own != manifest {
            let differs = own
                .lines()
                .zip(manifest.lines())
                .find(|(own, asked)| own != asked);
            let (own, asked) = differs.unwrap_or(("another text", "the folder's"));
            return Err(format!(
                "this worker has {own}, the folder {asked}: install the same version of fingertip everywhere"
            ));
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map_err(|error| error.to_string())?;
        pool.install(|| compute_part(&space, part))
            .map_err(|refusal| refusal.0)
    });
    let SweptPart {
        content,
        designs,
        refused,
        first_reason,
    } = made.map_err(refuse)?;
    Ok((PyBytes::new(python, &content), designs, refused, first_reason))
}

/// A sweep's folder, held until this is gone.
#[pyclass(frozen)]
pub(crate) struct SweepFolder {
    space: Space,
    folder: Folder,
    #[pyo3(get)]
    text: String,
}

#[pymethods]
impl SweepFolder {
    #[new]
    fn new(path: PathBuf, out: PathBuf) -> PyResult<Self> {
        let text = inline::whole(&path).map_err(refuse)?;
        let space = Space::read(&path).map_err(refuse)?;
        let folder = Folder::open(&out, &space, Shard::WHOLE).map_err(|refusal| refuse(refusal.0))?;
        Ok(Self { space, folder, text })
    }

    /// What the folder states of the sweep and the program.
    #[getter]
    fn manifest(&self) -> String {
        manifest_of(&self.space)
    }

    /// Designs and parts of the sweep, designs of a part.
    #[getter]
    fn size(&self) -> (u64, u64, u64) {
        (
            self.space.sample.count,
            self.space.parts(),
            self.space.designs_per_part,
        )
    }

    /// The parts that are not there yet.
    fn left(&self) -> PyResult<Vec<u64>> {
        self.folder
            .left(&self.space, Shard::WHOLE)
            .map_err(|refusal| refuse(refusal.0))
    }

    /// Moves a part in, whole or not at all.
    fn write(&self, python: Python<'_>, part: u64, content: Vec<u8>) -> PyResult<()> {
        python
            .detach(|| self.folder.write(part, &content))
            .map_err(|refusal| refuse(refusal.0))
    }
}
