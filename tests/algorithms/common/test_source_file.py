"""Files are told by the hash of their bytes, whichever way they came."""

import hashlib
import io

from hypothesis import given
from hypothesis import strategies as st

from algorithms.common import source_file
from algorithms.common.source_file import SourceFile


@given(st.binary(max_size=300), st.integers(0, 300))
def test_the_hash_is_that_of_all_bytes_wherever_the_file_stood(data, position):
    stream = io.BytesIO(data)
    stream.seek(min(position, len(data)))
    told = SourceFile("map.pgm", hashlib.sha256(data).hexdigest())
    assert SourceFile.of("map.pgm", stream) == SourceFile.of("map.pgm", data) == told


def test_a_file_of_many_parts_is_read_to_its_end(tmp_path, monkeypatch):
    monkeypatch.setattr(source_file, "PART", 7)
    (tmp_path / "map.pgm").write_bytes(bytes(range(100)))
    assert SourceFile.at(tmp_path / "map.pgm").sha256 == hashlib.sha256(bytes(range(100))).hexdigest()


def test_a_name_is_that_of_the_file_alone_and_hides_nothing():
    assert SourceFile.of("fleet.zip: maps/a\u202eb.yaml", b"").name == "a[U+202E]b.yaml"
