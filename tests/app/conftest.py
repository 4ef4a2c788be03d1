"""What tests of panels and of what a browser tells need: a server of viser's, and nobody who comes."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import viser


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()
