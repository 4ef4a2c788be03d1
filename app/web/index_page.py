"""The page as it is served: viser's, with words for those whom the rest of it cannot reach.

viser tells the server of a tab only once the tab draws. A browser without WebGL or without scripts, and
one whose server has gone, must find its words in the page itself: see startup_check.js.
"""

from __future__ import annotations

import gzip
from functools import lru_cache

from app.system.data_paths import asset

_SCRIPT = asset("startup_check.js")

# what stands in viser's page -> what stands there instead; a test holds that each is there once
_CHANGES = {
    "<title>Viser</title>": f"<title>mapmeld</title>\n    <script>\n{_SCRIPT}</script>",
    'content="Viser client"': 'content="Two robots\' grid maps, merged from one sighting"',
    "You need to enable JavaScript to run this app.": (
        '<div style="font:16px/1.5 system-ui,sans-serif;max-width:680px;margin:8vh auto;padding:0 1em">'
        "<h1>mapmeld needs scripts</h1><p>This page is drawn by a script, and scripts are switched off in "
        "this browser. Allow them for this address and reload. It loads nothing from anywhere else.</p>"
        "<p>The command line merges the same maps without a browser:</p>"
        "<pre>mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result</pre></div>"
    ),
    '<div id="root"></div>': (
        '<div id="root"><p style="font:16px system-ui,sans-serif;color:#6B7280;text-align:center;'
        'margin-top:40vh">mapmeld is loading …</p></div>'
    ),
}


def with_words(page: str) -> str:
    """viser's page with our words in it."""
    for before, after in _CHANGES.items():
        page = page.replace(before, after, 1)
    return page


@lru_cache(maxsize=4)
def served(body: bytes, packed: bool) -> bytes:
    """The body of an answer, changed; packed: by gzip, before and after."""
    page = with_words((gzip.decompress(body) if packed else body).decode()).encode()
    return gzip.compress(page, mtime=0) if packed else page
