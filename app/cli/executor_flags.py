"""Flags --jobs and --scheduler, and the executor that they ask for."""

from __future__ import annotations

from app.cli.argument_parser import Parser, whole_number
from app.jobs.executor import Executor, SerialExecutor


def add_workers(parser: Parser, jobs: int | None) -> None:
    """Add ``--jobs``, by default ``jobs`` or one per core, and ``--scheduler``."""
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
    """So many processes, by default one per core, or the workers of a Dask scheduler; raises SettingError."""
    if scheduler is not None:
        from app.jobs.dask_executor import DaskExecutor

        return DaskExecutor(scheduler)
    from algorithms.common import parallel_kernels as kernels
    from app.jobs.process_executor import ProcessExecutor

    jobs = kernels.cores() if jobs is None else jobs
    return SerialExecutor() if jobs == 1 else ProcessExecutor(jobs)
