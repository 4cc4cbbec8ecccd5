"""Where units are computed: in this process, in several, or on any `concurrent.futures.Executor`."""

from __future__ import annotations

import multiprocessing
import queue
import signal
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from itertools import islice

from ...engine.jit.threads import available, set_num_threads
from ...errors import ArgumentError, DualpinError
from ...extras import extra
from ..results import NOT_COMPARED, RobotResult
from ..units import Result, Unit

Connect = Callable[[], AbstractContextManager[Executor]]
Work = Callable[[Unit], Result]
Found = Iterator[tuple[Unit, Result]]

WINDOW = 4096
"""Units submitted to a foreign executor at a time: enough for a thousand processes, and quickly cancelled."""
TRIES = 3
"""How often an executor may be lost without a result in between."""


class LostError(DualpinError):
    """The executor went away; what was found before is kept."""


def run(units: Sequence[Unit], work: Work, jobs: int = 1, executor: Executor | Connect | None = None) -> Found:
    """The units with their results, as they come.

    Parameters
    ----------
    work : callable
        What makes the result of a unit; it travels by pickle.
    jobs : int
        Processes of this machine, where no executor is given.
    executor : Executor, or function that returns one, optional
        The function is asked again where the executor it returned was lost.

    Raises
    ------
    LostError
        If the executor was lost and no other is to be had.
    """
    if executor is not None:
        yield from _elsewhere(units, work, executor)
    elif jobs <= 1 or len(units) <= 1:
        for unit in units:
            yield unit, work(unit)
    else:
        yield from _here(units, work, min(jobs, len(units)))


def _on_one_core(unit: Unit, work: Work) -> Result:
    set_num_threads(1)
    return work(unit)


def _here(units: Sequence[Unit], work: Work, jobs: int) -> Found:
    """In processes of this machine.  One that crashes takes the pool with it, and the rest go to a new one."""
    left = list(units)
    while left:
        lost: list[Unit] = []
        done: set[str] = set()
        with _processes(jobs) as pool:
            for unit, result in _through(pool, left, work, 2 * jobs, lost):
                done.add(unit.key)
                yield unit, result
        for unit in lost:
            done.add(unit.key)
            yield unit, _alone(unit, work)
        left = [u for u in left if u.key not in done]


@contextmanager
def _processes(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """So many processes.  What ends the run early, such as Ctrl-C, ends them too: a unit may take minutes, and those
    that were not finished are computed again when the run goes on."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, context, initializer=_one_of, initargs=(jobs,)) as pool:
        try:
            yield pool
        except BaseException:
            processes = list(pool._processes.values())  # `terminate_workers` of Python 3.14
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            raise


def _one_of(jobs: int) -> None:
    """Initialise a worker process, one of so many."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    set_num_threads(max(1, available() // jobs))


def _alone(unit: Unit, work: Work) -> Result:
    """In a process of its own, whose crash is the result."""
    with _processes(1) as pool:
        try:
            return pool.submit(work, unit).result()
        except BrokenExecutor:
            case = unit.case
            return RobotResult(
                case.name, case.floating, case.mimic, 0, unit.samples, unit.seed, True, status=NOT_COMPARED,
                reason="crashed: Pinocchio or dualpin ended the process", engine=case.engine,
            )  # fmt: skip


def _elsewhere(units: Sequence[Unit], work: Work, executor: Executor | Connect) -> Found:
    """On a given executor; where a function makes it, a lost one is made again."""
    connect = (lambda: nullcontext(executor)) if isinstance(executor, Executor) else executor
    left, tries = {u.key: u for u in units}, 0
    while left:
        lost: list[Unit] = []
        try:
            with connect() as pool:
                one = (
                    work if isinstance(pool, ThreadPoolExecutor) else partial(_on_one_core, work=work)
                )  # it has a core, not all
                for unit, result in _through(pool, list(left.values()), one, WINDOW, lost):
                    del left[unit.key]
                    tries = 0
                    yield unit, result
            for unit in lost:
                del left[unit.key]
                yield unit, _alone(unit, work)
        except LostError:
            tries += 1
            if isinstance(executor, Executor) or tries >= TRIES:
                raise


def _through(pool: Executor, units: Iterable[Unit], work: Work, window: int, lost: list[Unit]) -> Found:
    """Units through an executor, `window` of them at a time; those under way in a process that died are `lost`."""
    waiting, finished = iter(units), queue.SimpleQueue[Future[Result]]()
    under_way: dict[Future[Result], Unit] = {}
    broken = False

    def submit(n: int) -> None:
        nonlocal broken
        for unit in islice(waiting, n) if not broken else ():
            try:
                future = pool.submit(work, unit)
            except BrokenExecutor:
                lost.append(unit)
                broken = True
                return
            except RuntimeError as e:  # it was shut down meanwhile
                raise LostError(f"campaign: the executor takes no more work ({e})") from None
            under_way[future] = unit
            future.add_done_callback(finished.put)

    try:
        submit(window)
        while under_way:
            future = finished.get()
            unit = under_way.pop(future)
            try:
                result = future.result()
            except BrokenExecutor:
                lost.append(unit)
                broken = True
            except CancelledError:
                raise LostError("campaign: the executor was lost") from None
            except Exception as e:
                if type(e).__name__ != "KilledWorker":  # Dask raises this for a task that ended several processes
                    raise _failed(unit, e) from e
                lost.append(unit)
            else:
                yield unit, result
            submit(1)
    finally:
        for future in under_way:
            future.cancel()


def _failed(unit: Unit, e: Exception) -> DualpinError:
    if isinstance(e, (OSError, TimeoutError)):  # CommClosedError of Dask is an OSError
        return LostError(f"campaign: the executor was lost ({type(e).__name__}: {e})")
    return ArgumentError(f"campaign: the executor cannot compute {unit.case.name} ({type(e).__name__}: {e})")


def scheduler(address: str) -> Connect:
    """A function that connects to a scheduler.

    Parameters
    ----------
    address : str
        ``tcp://host:port`` of a Dask scheduler (extra ``dask``), or ``mpi`` in a program that was started by
        ``mpiexec -n N python -m mpi4py.futures -m dualpin``.

    Raises
    ------
    ArgumentError
        If there is no such scheduler.
    """
    if address == "mpi":
        pool = extra("mpi4py.futures", "mpi", "validate --scheduler mpi").MPIPoolExecutor
        return lambda: pool()
    if "://" not in address:
        raise ArgumentError(f"validate: --scheduler is {address!r}; tcp://host:port of a Dask scheduler, or mpi")
    distributed = extra("distributed", "dask", "validate --scheduler")

    @contextmanager
    def connect() -> Iterator[Executor]:
        try:
            client = distributed.Client(address, timeout=20, set_as_default=False)
        except (OSError, ValueError) as e:
            raise ArgumentError(f"validate: no Dask scheduler answers at {address} ({e})") from None
        with client:
            yield client.get_executor(retries=2, pure=False)

    return connect
