"""Flags --jobs and --scheduler, and the executor that they ask for."""

from __future__ import annotations

from app.cli.argument_parser import Parser, whole_number
from app.jobs.executor import Executor, SerialExecutor


def add_workers(parser: Parser, jobs: int | None) -> None:
    """Add ``--jobs`` and ``--scheduler``: who does the work.

    jobs : processes unless told otherwise; None: one per core
    """
    who = parser.add_mutually_exclusive_group()
    who.add_argument(
        "--jobs",
        type=whole_number(1),
        default=jobs,
        metavar="N",
        help=f"merges at a time, a process each, which share the cores (default: {jobs or 'one per core'})",
    )
    who.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="let the workers of a Dask cluster do it, e.g. tcp://192.168.0.7:8786; "
        "needs pip install 'mapmeld[dask]', here and there",
    )


def executor_for(jobs: int | None = None, scheduler: str | None = None) -> Executor:
    """Whoever is asked for.

    jobs      : processes on this machine; None: one per core
    scheduler : address of a Dask scheduler, whose workers then do it all
    raises    : SettingError where Dask is not installed or nobody answers there
    """
    if scheduler is not None:
        from app.jobs.dask_executor import DaskExecutor

        return DaskExecutor(scheduler)
    from algorithms.common import parallel_kernels as kernels
    from app.jobs.process_executor import ProcessExecutor

    jobs = kernels.cores() if jobs is None else jobs
    return SerialExecutor() if jobs == 1 else ProcessExecutor(jobs)
