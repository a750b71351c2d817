"""Sweeps: many designs of one space to Parquet, on this machine or on a Dask cluster (model-tables/SWEEP.md).

::

    python -m fingertip.sweep SPACE.toml --out DIR
    python -m fingertip.sweep SPACE.toml --out DIR --scheduler tcp://HOST:8786

The files are those of ``designer sweep``, byte for byte: a run that was killed goes on with either, and workers come and go. A worker
needs this package and nothing else: a part comes to it as text and goes back as the bytes of a file, which this process writes, whole
or not at all. ``pip install 'fingertip[cluster]'`` brings Dask.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import importlib
import itertools
import os
import signal
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _fingertip
from .errors import SweepError

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Swept", "run"]

#: Parts on their way for each thread of the cluster: one that is computed, one that waits.
AHEAD = 2
#: Workers that may die over one part before the sweep ends: it may be the part that kills them.
DEATHS = 3
#: How long to wait for a scheduler, and then for its first worker, s.
PATIENCE = 30
#: How often progress is told, s.
TELL_EVERY = 2.0


@dataclass(frozen=True, slots=True)
class Swept:
    """What a run did."""

    #: Designs of the sweep.
    designs: int
    #: Of those, what an earlier run had left ready.
    before: int
    #: Designs computed by this run.
    computed: int
    #: Of those, refused: rows with a reason.
    refused: int
    #: The line that refused the first of them.
    first_reason: str | None
    #: Files of the sweep.
    parts: int


def run(
    space: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    scheduler: str | Client | None = None,
) -> Swept:
    """Computes the parts of a sweep that are not there yet.

    Args:
        space: the file of the sweep.
        out: the folder of the parts, on this machine; made if it is not there, continued if it is this sweep's.
        scheduler: address of a Dask scheduler, or a client of one; left out, the cores of this machine compute.

    Raises:
        SweepError: the file cannot be, the folder holds another sweep, or the cluster ended. Parts that are there stay.
    """
    space, out = os.fspath(space), os.fspath(out)
    if scheduler is None:
        return Swept(*_fingertip.sweep(space, out))
    # First, so that a wrong file is refused before a cluster is sought.
    folder = _fingertip.SweepFolder(space, out)
    try:
        # Dask has annotations in parts only: to type checkers it is anything.
        distributed: Any = importlib.import_module("distributed")
    except ImportError:
        raise SweepError("a cluster needs Dask, which is not installed: pip install 'fingertip[cluster]'") from None
    if isinstance(scheduler, distributed.Client):
        return _on_cluster(folder, scheduler, distributed)
    try:
        # A scheme that there is none of would leave a half-made client behind.
        distributed.comm.resolve_address(scheduler)
        client = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise SweepError(
            f"{scheduler}: no Dask scheduler answers there ({_line(error)}); start one with `dask scheduler`"
        ) from error
    with client:
        return _on_cluster(folder, client, distributed)


def _line(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def part_of(text: str, part: int, manifest: str) -> tuple[bytes, int, int, str | None]:
    """On a worker: the bytes of a part, its designs, those refused, the first reason."""
    return _fingertip.sweep_part(text, part, manifest)


def _on_cluster(folder: _fingertip.SweepFolder, client: Any, distributed: Any) -> Swept:
    designs, parts, per_part = folder.size
    left = folder.left()
    in_part = {part: min(per_part, designs - part * per_part) for part in left}
    before = designs - sum(in_part.values())
    print(f"progress: {before} of {designs} designs are there", file=sys.stderr)
    if not left:
        return Swept(designs, before, 0, 0, None, parts)
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise SweepError("the cluster has no worker; start some with `dask worker ADDRESS`") from None
    threads = sum(client.nthreads().values())
    text, manifest = folder.text, folder.manifest
    started = f"{os.getpid()}-{time.time_ns()}"

    def submit(part: int) -> Any:
        # A key of this run: another run's part of that number may be of another space.
        return client.submit(part_of, text, part, manifest, key=f"fingertip-part-{part}-{started}")

    waiting = iter(left)
    of = {}
    for part in itertools.islice(waiting, AHEAD * threads):
        of[submit(part)] = part
    computed = refused = 0
    first: tuple[int, str] | None = None
    begun = told = time.monotonic()
    done = distributed.as_completed(list(of))
    try:
        for future in done:
            part = of.pop(future)
            try:
                content, rows, refusals, reason = future.result()
            except distributed.KilledWorker as error:
                raise SweepError(
                    f"part {part} was on each of {DEATHS} workers that died; look at their memory, and run again: the parts that are "
                    f"there stay ({_line(error)})"
                ) from error
            except concurrent.futures.CancelledError as error:
                raise SweepError(f"the scheduler is gone ({_line(error)}); run again: the parts that are there stay") from error
            # The folder is this process's alone; what a worker that was thought dead sends again is passed over by Dask.
            folder.write(part, content)
            future.release()
            computed, refused = computed + rows, refused + refusals
            if reason is not None and (first is None or part < first[0]):
                first = (part, reason)
            for following in itertools.islice(waiting, 1):
                another = submit(following)
                of[another] = following
                done.add(another)
            now = time.monotonic()
            if now - told > TELL_EVERY:
                told, rate = now, computed / (now - begun)
                remaining = (designs - before - computed) / rate if rate else 0.0
                print(
                    f"progress: {computed} of {designs - before} designs, {rate:.1f} a second, {remaining:.0f} s left",
                    file=sys.stderr,
                )
    finally:
        client.cancel(list(of))
    return Swept(designs, before, computed, refused, first[1] if first else None, parts)


def main(arguments: list[str] | None = None) -> int:
    """The command line: exit status 0, or 1 with one line on standard error."""
    parser = argparse.ArgumentParser(
        prog="python -m fingertip.sweep",
        description="Many designs of one space to Parquet. Killed or stopped, the same command goes on where it was.",
    )
    parser.add_argument("space", metavar="SPACE.toml", help="the file of the sweep: base design, what varies, what is computed")
    parser.add_argument("--out", metavar="DIR", required=True, help="the folder of the parts; made if it is not there")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, as tcp://127.0.0.1:8786; left out: this machine")
    options = parser.parse_args(arguments)
    if options.scheduler is None:
        # The compiled part asks nobody while it computes: an interrupt ends it as a kill does, and nothing that is there is lost.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        swept = run(options.space, options.out, scheduler=options.scheduler)
    except SweepError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("error: interrupted; the same command goes on with the parts that are there", file=sys.stderr)
        return 130
    if swept.first_reason is not None:
        print(
            f"note: {swept.refused} of {swept.computed} designs are refused, the first as: {swept.first_reason}", file=sys.stderr
        )
    print("designs,ready_before,computed,refused,parts")
    print(f"{swept.designs},{swept.before},{swept.computed},{swept.refused},{swept.parts}")
    return 0


if __name__ == "__main__":
    # By its name, which workers can import.
    sys.exit(importlib.import_module("fingertip.sweep").main())
