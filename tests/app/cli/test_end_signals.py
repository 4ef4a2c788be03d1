"""A wish to end is never lost, not even in a callback of a library in C."""

from __future__ import annotations

import ctypes
import os
import signal
from concurrent.futures import ThreadPoolExecutor

import pytest

from app.cli.end_signals import end_signals


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_that_comes_within_a_callback_of_c_is_seen(number):
    def order(one, other):
        os.kill(os.getpid(), number)
        return one[0] - other[0]

    place = ctypes.POINTER(ctypes.c_int)
    callback = ctypes.CFUNCTYPE(ctypes.c_int, place, place)(order)
    numbers = (ctypes.c_int * 2)(2, 1)
    before = signal.getsignal(number)
    with end_signals() as come:
        assert not come
        ctypes.CDLL(None).qsort(numbers, 2, ctypes.sizeof(ctypes.c_int), callback)
        assert number in come
    assert signal.getsignal(number) is before


def test_a_thread_beside_the_main_one_leaves_signals_as_they_are():
    def handler():
        with end_signals():
            return signal.getsignal(signal.SIGINT)

    with ThreadPoolExecutor() as pool:
        assert pool.submit(handler).result() is signal.getsignal(signal.SIGINT)
