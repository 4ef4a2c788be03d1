"""Tasks for executors: other processes find them by the name of this module."""

from __future__ import annotations

import os
import time
from pathlib import Path

import cv2

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import SettingError


def add(shared, order):
    return shared + order


def fragile(folder, order):
    """Dies the first time that it is asked for 3, and each time for 5."""
    if order == 5:
        os._exit(1)
    if order == 3 and not (folder / "died").exists():
        (folder / "died").touch()
        os._exit(1)
    return order * order


def fail(_, order):
    raise SettingError(f"{order} is none of ours")


def who(_, order):
    return os.getpid(), kernels.threads(), cv2.getNumThreads()


def linger(folder, order):
    (folder / f"began_{os.getpid()}").touch()
    if order != "quick":
        time.sleep(60)


def until(true, seconds=30.0):
    """Wait for something to become true; whether it did."""
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.02)
    return true()


def pid(began):
    return int(began.name.removeprefix("began_"))


def alive(number):
    try:
        return Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def meet(folder, order):
    """Waits until both workers are at work; tells who did it."""
    (folder / f"{order}_{os.getpid()}").touch()
    assert until(lambda: len({path.name.split("_")[1] for path in folder.iterdir()}) >= 2)
    return order, os.getpid()


def stay(folder, order):
    """Waits until it is let go."""
    (folder / f"{order}_{os.getpid()}").touch()
    assert until((folder / "go").exists)
    return order


def process_id(_, order):
    return os.getpid()


def die_at_two(_, order):
    if order == 2:
        os._exit(1)
    return order
