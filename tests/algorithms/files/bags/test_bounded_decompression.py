"""A recording that unpacks to more than it may is refused; the others are read as ever (test_bag_reader)."""

from __future__ import annotations

import numpy as np
import pytest
from bags import grid_message, write_bag

from algorithms.common.errors import InputFileError
from algorithms.files.bags import bounded_decompression
from algorithms.files.map_file import read_map
from algorithms.maps.grid_map import GridMap


@pytest.mark.parametrize("kind", ["ros1-bz2", "ros1-lz4", "mcap-zstd"])
def test_a_few_bytes_that_stand_for_many_are_not_unpacked(tmp_path, monkeypatch, kind):
    """The library would unpack them: were it another version, this fails where the bound is not applied."""
    path = write_bag(
        tmp_path, "bag", kind, [grid_message(GridMap(np.zeros((1000, 1000), np.int8), 0.05), 0.0)]
    )
    assert read_map(path).cells.size == 1_000_000
    monkeypatch.setattr(bounded_decompression, "MOST_CHUNK", 900_000)
    with pytest.raises(InputFileError, match="damaged, cut off"):
        read_map(path)
