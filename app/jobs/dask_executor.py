"""Work on a Dask cluster that exists already; where a worker has died its scheduler tries the task again."""

from __future__ import annotations

import asyncio
import logging
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from threading import Event
from typing import TYPE_CHECKING, Any

from algorithms.common.errors import SettingError
from app.jobs.executor import Executor, LostTask, Task, Work, unpacked
from app.system.version import code, versions

if TYPE_CHECKING:
    from distributed import Client

PATIENCE_S = 10.0  # until whoever should answer is said not to
LOOK_S = 0.1  # how often it is looked whether an answer is there, by whoever may be stopped
AHEAD = 2  # tasks per thread of a worker: one at hand, one that waits for it
KEPT = 2  # shared values that are kept on the cluster while no task at hand needs them

INSTALL = "install it: pip install 'mapmeld[dask]'"


class DaskExecutor(Executor):
    """The workers of a Dask scheduler, each with the same mapmeld as this process."""

    far = True

    def __init__(self, address: str) -> None:
        """Raises SettingError without Dask, an answer or a worker, or where one has other versions."""
        self._address = address
        with self._client() as client:
            self.jobs = self._checked_threads(client)

    def run(self, work: Work, tasks: Iterable[Task], stop: Event | None = None) -> Iterator[tuple[int, Any]]:
        """As in Executor; raises SettingError where the scheduler goes away."""
        from distributed import as_completed
        from distributed.scheduler import KilledWorker

        with self._client() as client:
            left, running = iter(enumerate(tasks)), {}
            values: OrderedDict[str, Any] = OrderedDict()
            finished = as_completed(loop=client.loop)
            try:
                while True:
                    room = AHEAD * max(1, self._threads(client))
                    while len(running) < room and (found := next(left, None)) is not None:
                        number, task = found
                        value = None
                        if task.shared is not None:
                            value = values.pop(task.shared.key, None) or client.submit(
                                unpacked, task.shared.data, pure=False
                            )
                            values[task.shared.key] = value
                        future = client.submit(work, value, task.order, pure=False)
                        running[future] = number
                        finished.add(future)
                        if len(values) > KEPT:
                            values.popitem(last=False)
                    if not running:
                        return
                    while stop is not None and not finished.has_ready():
                        if stop.wait(LOOK_S):
                            return
                    future = next(finished)
                    try:
                        answer = future.result()
                    except KilledWorker:
                        answer = LostTask("every worker that ran it has died; was there too little memory?")
                    except CancelledError:
                        raise self._gone() from None
                    yield running.pop(future), answer
            finally:
                if running and client.status == "running":
                    client.cancel(list(running), force=True)

    def _client(self) -> Client:
        try:
            from distributed import Client
        except ImportError:
            raise SettingError(f"--scheduler needs Dask, which is not installed; {INSTALL}") from None
        for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
            logging.getLogger(name).setLevel(logging.CRITICAL)  # it is said by us, once and in words
        try:
            # a Client that nobody answers leaves threads behind that complain later
            with ThreadPoolExecutor(1) as apart:  # this thread may have a loop already, as in a notebook
                apart.submit(lambda: asyncio.run(_knock(self._address, PATIENCE_S))).result()
            return Client(self._address, timeout=PATIENCE_S, set_as_default=False)
        except Exception as error:  # whatever may answer at any address that a person can type
            raise SettingError(
                f"--scheduler {self._address}: no Dask scheduler answers there "
                f"({type(error).__name__}, waited {PATIENCE_S:g} s); "
                "give the address that it prints when it starts, e.g. tcp://192.168.0.7:8786"
            ) from error

    def _checked_threads(self, client: Client) -> int:
        try:
            client.wait_for_workers(1, timeout=PATIENCE_S)
        except (OSError, asyncio.TimeoutError):
            raise SettingError(
                f"the Dask scheduler at {self._address} has no workers; "
                f"start some: dask worker {self._address}"
            ) from None
        here = made_with()
        for worker, found in client.run(made_with, on_error="return").items():
            if isinstance(found, Exception):
                raise SettingError(
                    f"the Dask worker at {worker} can't load mapmeld ({type(found).__name__}: {found}); "
                    "install it there, the same version as here"
                )
            for name, version in here.items():
                if found.get(name) != version:
                    raise SettingError(
                        f"the Dask worker at {worker} has {name} {found.get(name)}, here it is {version}: "
                        "results could differ from machine to machine; install the same on both"
                    )
        return self._threads(client)

    def _threads(self, client: Client) -> int:
        try:
            return sum(client.nthreads().values())
        except (OSError, asyncio.TimeoutError):
            raise self._gone() from None

    def _gone(self) -> SettingError:
        return SettingError(
            f"the Dask scheduler at {self._address} has gone; start it again, then this: "
            "a sweep goes on where it was"
        )


async def _knock(address: str, patience_s: float) -> None:
    from distributed.comm import connect

    comm = await asyncio.wait_for(connect(address, timeout=patience_s), patience_s)
    await comm.close()


def made_with() -> dict[str, str]:
    """What may change a number."""
    found = {**versions(), "mapmeld's code": code()}
    found["python"] = found["python"].rpartition(".")[0]
    return found
