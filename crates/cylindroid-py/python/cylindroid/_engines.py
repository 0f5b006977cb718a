"""Sweeps on other processes and machines: parts are the unit of work.

The driver hands out numbers of parts, a few for each worker at a time. A worker makes the same plan
from the same arguments, checks that its recipe is that of the driver, and writes the file of the
part; the driver collects sizes and checksums and writes the manifest. Ray is imported only for an
engine 'ray', pyarrow only for a URI.
"""

from __future__ import annotations

import concurrent.futures
import contextlib
import importlib
import itertools
import os
import pathlib
import pickle
import time
import uuid
from collections.abc import Generator, Iterator
from typing import Any

import numpy as np

from ._core import SweepPlan
from ._errors import CylindroidError, UnreadableFileError, refused

#: Parts of each worker that are handed out at a time: it never waits for the driver.
AHEAD = 4
#: Seconds between two manifests.
BETWEEN_MANIFESTS = 1.0
#: How often Ray computes a part again whose worker died.
RETRIES = 10
MANIFEST = "manifest.json"
#: Size and XXH3 checksum (128 bits, hexadecimal) of a part.
Listed = tuple[int, str]


class _Uri:
    """A folder in a storage of pyarrow, by its URI."""

    #: Storage whose files appear when they are closed, and which cannot rename them.
    WHOLE = ("s3", "gcs", "abfs")

    def __init__(self, uri: str) -> None:
        try:
            fs: Any = importlib.import_module("pyarrow.fs")
        except ImportError as error:
            raise refused(
                "out", f"'{uri}' needs pyarrow: pip install pyarrow, or this package with [ray]"
            ) from error
        self.uri = uri
        try:
            self.system, self.path = fs.FileSystem.from_uri(uri)
        except Exception as error:
            raise refused("out", f"pyarrow does not open '{uri}': {error}") from error
        self.missing = fs.FileType.NotFound

    def create(self) -> None:
        with self._named(""):
            self.system.create_dir(self.path, recursive=True)

    def exists(self, name: str) -> bool:
        with self._named(name):
            return bool(self.system.get_file_info(f"{self.path}/{name}").type != self.missing)

    def read(self, name: str) -> bytes:
        with self._named(name), self.system.open_input_stream(f"{self.path}/{name}") as file:
            return bytes(file.read())

    def write(self, name: str, content: bytes) -> None:
        path = f"{self.path}/{name}"
        own = path
        if self.system.type_name not in self.WHOLE:
            own = f"{self.path}/.{name}.{uuid.uuid4().hex}.tmp"
        with self._named(name):
            with self.system.open_output_stream(own) as file:
                file.write(content)
            if own != path:
                self.system.move(own, path)

    @contextlib.contextmanager
    def _named(self, name: str) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise UnreadableFileError(
                f"out: {self.uri}/{name}: {error}; finished parts are kept, resume continues after them"
            ) from error


def _write_part(
    plan: SweepPlan, out: Any, part: int, listed: Listed | None
) -> tuple[Listed, bool]:
    """Writes the file of a part; whether it was computed, and not already there."""
    if not is_uri(out):
        return plan.write_part(out, part, listed)
    storage, name = _Uri(out), plan.part_name(part)
    if listed is not None and storage.exists(name):
        content = storage.read(name)
        if plan.listed(content) == listed:
            return listed, False
    content, own = plan.part_file(part)
    storage.write(name, content)
    return own, True


def is_uri(out: Any) -> bool:
    return isinstance(out, str) and "://" in out


#: The plan of the last sweep of which this process computed a part.
_PLANS: dict[str, SweepPlan] = {}


class _Work:
    """Computes parts, in the process of the driver or, pickled, in any other."""

    def __init__(self, plan: SweepPlan, arguments: dict[str, Any], out: Any) -> None:
        self.plan: SweepPlan | None = plan
        self.arguments, self.out = arguments, out
        self.key, self.recipe = uuid.uuid4().hex, plan.recipe
        self.pickle: Any = pickle
        self.packed: Any = None

    def __getstate__(self) -> dict[str, Any]:
        if self.packed is None:
            # An array, of which Ray's workers on one machine share the memory.
            self.packed = np.frombuffer(self.pickle.dumps(self.arguments), np.uint8)
        kept = ("out", "key", "recipe", "packed")
        return {"plan": None, **{name: getattr(self, name) for name in kept}}

    def _plan(self) -> SweepPlan:
        if self.plan is not None:
            return self.plan
        plan = _PLANS.get(self.key)
        if plan is None:
            plan = SweepPlan(**pickle.loads(self.packed.data))
            difference = plan.difference(self.recipe)
            if difference is not None:
                raise refused(
                    "engine",
                    f"a worker has another sweep than the driver: {difference}; install the same "
                    "version and model files, and use processors of one arithmetic, or set "
                    "CYLINDROID_SIMD alike",
                )
            _PLANS.clear()
            _PLANS[self.key] = plan
        return plan

    def __call__(self, part: int, listed: Listed | None) -> Any:
        """The columns of a part, or what `_write_part` returns."""
        plan = self._plan()
        return plan.part(part) if self.out is None else _write_part(plan, self.out, part, listed)


class _Executor:
    """Workers of an executor."""

    def __init__(self, executor: concurrent.futures.Executor) -> None:
        self.executor = executor
        self.workers = getattr(executor, "_max_workers", None) or os.cpu_count() or 1

    def prepare(self, work: _Work) -> None:
        self.work = work

    def submit(self, part: int, listed: Listed | None) -> concurrent.futures.Future[Any]:
        return self.executor.submit(self.work, part, listed)

    def cancel(self, future: concurrent.futures.Future[Any]) -> None:
        future.cancel()

    def result(self, future: concurrent.futures.Future[Any]) -> Any:
        try:
            return future.result()
        except concurrent.futures.BrokenExecutor as error:
            raise CylindroidError(
                f"a worker of the engine died: {error}; finished parts are kept, resume continues "
                "after them"
            ) from error
        except CylindroidError:
            raise
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise refused(
                "engine",
                f"{error}; what goes to another process is pickled: columns need functions of a "
                "module, and the shapes of collision= stay in one process"
            ) from error


class _Ray:
    """Workers of a Ray cluster: the one that the caller has connected, otherwise that of
    `ray.init()`."""

    def __init__(self) -> None:
        try:
            ray: Any = importlib.import_module("ray")
        except ImportError as error:
            raise refused(
                "engine",
                "'ray' needs Ray: pip install ray, or this package with [ray]"
            ) from error
        self.ray = ray
        if not ray.is_initialized():
            ray.init()
        self.workers = max(1, int(ray.cluster_resources().get("CPU", 1)))
        self.references: dict[concurrent.futures.Future[Any], Any] = {}

    def prepare(self, work: _Work) -> None:
        work.pickle = self.ray.cloudpickle
        self.work = self.ray.put(work)
        # Also after a failure of the machine; an error of the function is not repeated.
        self.function = self.ray.remote(max_retries=RETRIES)(_call)

    def submit(self, part: int, listed: Listed | None) -> concurrent.futures.Future[Any]:
        reference = self.function.remote(self.work, part, listed)
        future: concurrent.futures.Future[Any] = reference.future()
        self.references[future] = reference
        return future

    def cancel(self, future: concurrent.futures.Future[Any]) -> None:
        self.ray.cancel(self.references.pop(future))

    def result(self, future: concurrent.futures.Future[Any]) -> Any:
        self.references.pop(future, None)
        try:
            return future.result()
        except self.ray.exceptions.RayTaskError as error:
            raise error.cause from error
        except self.ray.exceptions.RayError as error:
            raise CylindroidError(
                f"Ray could not compute a part: {error}; finished parts are kept, resume continues "
                "after them"
            ) from error


def _call(work: _Work, part: int, listed: Listed | None) -> Any:
    return work(part, listed)


@contextlib.contextmanager
def opened(engine: Any, threads: Any) -> Iterator[_Executor | _Ray]:
    """The workers of an engine; threads of this process for none."""
    if engine is None:
        if threads is not None and (not isinstance(threads, int) or threads < 1):
            raise refused("threads", "a whole number is needed, one at least")
        with concurrent.futures.ThreadPoolExecutor(threads or os.cpu_count()) as executor:
            yield _Executor(executor)
    elif isinstance(engine, concurrent.futures.Executor):
        yield _Executor(engine)
    elif isinstance(engine, str) and engine == "ray":
        yield _Ray()
    else:
        raise refused("engine", f"{engine!r:.99} is neither 'ray' nor a concurrent.futures.Executor")


def run(
    workers: _Executor | _Ray, plan: SweepPlan, arguments: dict[str, Any], out: Any, resume: bool
) -> Any:
    """All parts, computed by the workers: the summary of a folder, or the columns."""
    if out is None:
        plan.check_memory()
        tables: list[Any] = [None] * plan.parts
        for part, table in _finished(workers, _Work(plan, arguments, None), plan.parts, []):
            tables[part] = table
        tables = tables or [plan.part(0)]
        return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
    with _folder(plan, out, resume) as (listed, write_manifest):
        parts, computed, last = list(listed), [], time.monotonic()
        place = out if is_uri(out) else os.path.abspath(out)
        finished = _finished(workers, _Work(plan, arguments, place), plan.parts, listed)
        try:
            for part, (own, is_new) in finished:
                parts[part] = own
                if is_new:
                    computed.append(part)
                if time.monotonic() - last > BETWEEN_MANIFESTS:
                    write_manifest(parts)
                    last = time.monotonic()
        finally:
            finished.close()
            write_manifest(parts)
        return plan.summary(out if is_uri(out) else pathlib.Path(out), parts, computed)


def _finished(
    workers: _Executor | _Ray, work: _Work, count: int, listed: list[Listed | None]
) -> Generator[tuple[int, Any], None, None]:
    """Parts as they are finished, with their results; an end before the last cancels the others. Of
    several parts with an error that of the first is raised, whatever the workers: parts before it
    are waited for, those after it cancelled."""
    workers.prepare(work)
    left = iter(range(count))
    pending: dict[concurrent.futures.Future[Any], int] = {}
    failed: tuple[int, concurrent.futures.Future[Any]] | None = None
    try:
        while True:
            if failed is None:
                for part in itertools.islice(left, AHEAD * workers.workers - len(pending)):
                    known = listed[part] if listed else None
                    pending[workers.submit(part, known)] = part
            else:
                for future, part in [own for own in pending.items() if own[1] > failed[0]]:
                    del pending[future]
                    if future.done() and future.exception() is None:
                        yield part, workers.result(future)
                    else:
                        workers.cancel(future)
            if not pending:
                if failed is not None:
                    workers.result(failed[1])
                return
            # A limit, so that Ctrl-C is noticed.
            done, _ = concurrent.futures.wait(pending, 1.0, concurrent.futures.FIRST_COMPLETED)
            for future in done:
                part = pending.pop(future)
                if future.exception() is None:
                    yield part, workers.result(future)
                elif failed is None or part < failed[0]:
                    failed = part, future
    finally:
        for future in pending:
            workers.cancel(future)


@contextlib.contextmanager
def _folder(plan: SweepPlan, out: Any, resume: bool) -> Iterator[Any]:
    """The listed parts of a folder, and a function that writes its manifest."""
    if not is_uri(out):
        folder = plan.open_folder(out, resume)
        try:
            yield folder.listed(), lambda parts: folder.write_manifest(plan, parts)
        finally:
            folder.close()
        return
    storage = _Uri(out)
    storage.create()
    listed: list[Listed | None] = [None] * plan.parts
    if storage.exists(MANIFEST):
        text = storage.read(MANIFEST).decode(errors="replace")
        listed = plan.listed_parts(out, text, resume)
    elif storage.exists(plan.part_name(0)) and not resume:
        raise refused(
            "out", f"{out}: it has parts of a sweep, but no manifest; name another folder"
        )

    def write_manifest(parts: list[Listed | None]) -> None:
        storage.write(MANIFEST, plan.manifest(parts).encode())

    write_manifest(listed)
    yield listed, write_manifest
