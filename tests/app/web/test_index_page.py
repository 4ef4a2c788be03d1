"""The page as it is served: words for a browser that cannot draw it, and viser's page otherwise."""

from __future__ import annotations

import gzip
import urllib.request
from pathlib import Path

import pytest
import viser

from app.page.application import make_server
from app.web.index_page import _CHANGES, served, with_words

VISERS = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("before", _CHANGES)
def test_what_is_changed_stands_in_visers_page_once(before):
    assert VISERS.count(before) == 1


def test_everything_else_of_visers_page_is_as_it_was():
    page = with_words(VISERS)
    for before, after in _CHANGES.items():
        assert after in page
        page = page.replace(after, before)
    assert page == VISERS


def test_a_packed_page_is_changed_as_a_plain_one():
    plain = VISERS.encode()
    assert gzip.decompress(served(gzip.compress(plain), True)) == served(plain, False)


@pytest.mark.parametrize("encoding", ["identity", "gzip"])
def test_the_running_server_serves_our_words(encoding):
    server = make_server(port=0)
    try:
        address = f"http://127.0.0.1:{server.get_port()}/"
        request = urllib.request.Request(address, headers={"Accept-Encoding": encoding})
        with urllib.request.urlopen(request, timeout=10) as answer:
            body = answer.read()
            assert int(answer.headers["Content-Length"]) == len(body)
        page = (gzip.decompress(body) if encoding == "gzip" else body).decode()
    finally:
        server.stop()
    assert "<title>mapmeld</title>" in page
    assert "mapmeld merge map1.yaml map2.yaml" in page
