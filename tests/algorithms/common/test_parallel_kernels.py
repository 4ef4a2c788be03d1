import importlib
import sys
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common import parallel_kernels as kernels


@given(st.integers(0, 200), st.integers(1, 300))
def test_the_work_is_covered_once_whatever_the_number_of_items(n, at_least):
    done = [0] * n

    def work(start, stop):
        for item in range(start, stop):
            done[item] += 1

    kernels.run_in_threads(work, n, at_least)
    assert done == [1] * n


def test_a_mistake_in_a_part_of_the_work_is_not_swallowed(monkeypatch):
    monkeypatch.setattr(kernels, "cores", lambda: 4)

    def work(start, stop):
        if start > 0:
            raise ValueError("in a thread")

    with pytest.raises(ValueError, match="in a thread"):
        kernels.run_in_threads(work, 100)


def test_two_threads_may_share_the_cores_at_once():
    totals = []

    def caller():
        counts = []
        for _ in range(200):
            kernels.run_in_threads(lambda start, stop: counts.append(stop - start), 50)
        totals.append(sum(counts))

    callers = [threading.Thread(target=caller) for _ in range(4)]
    for thread in callers:
        thread.start()
    for thread in callers:
        thread.join(timeout=60)
    assert totals == [200 * 50] * 4


@pytest.mark.parametrize("compiler", [kernels.kernel, kernels.fast_kernel])
def test_a_loop_whose_code_cannot_be_kept_on_disk_is_compiled_all_the_same(compiler):
    namespace = {}
    exec("def twice(x):\n    return x + x\n", namespace)  # without a file there is no place to keep it
    assert compiler(namespace["twice"])(21) == 42


def test_a_loop_may_call_another_one_that_nobody_has_called_before():
    namespace = {"kernel": kernels.kernel}
    exec(
        "@kernel\ndef twice(x):\n    return x + x\n@kernel\ndef four_times(x):\n    return twice(twice(x))\n",
        namespace,
    )
    assert namespace["four_times"](21) == 84
    assert namespace["twice"](21) == 42


def test_a_loop_that_would_have_to_be_compiled_can_be_told_from_one_that_need_not(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "a_loop_of_a_test.py").write_text("def twice(x):\n    return x + x\n")
    twice = importlib.import_module("a_loop_of_a_test").twice
    monkeypatch.delitem(sys.modules, "a_loop_of_a_test")
    with kernels.kept_only(), pytest.raises(kernels.NotKeptError):
        kernels.kernel(twice)(21)
    assert kernels.kernel(twice)(21) == 42
    with kernels.kept_only():
        assert kernels.kernel(twice)(21) == 42
        with pytest.raises(kernels.NotKeptError):
            kernels.kernel(twice)(21.0)
