"""Who gets in: pure rules on names, origins and the token of a request; viser_server applies them."""

from __future__ import annotations

import hmac
import os
import re
import secrets
import socket
import ssl
import urllib.parse
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from html import escape
from ipaddress import ip_address
from pathlib import Path

from algorithms.common.errors import InputFileError, SettingError, unreadable

LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
TOKEN_VARIABLE = "MAPMELD_TOKEN"
TOKEN_BYTES = 24  # of chance in a generated one: 32 characters, 192 bits
LEAST_TOKEN = 16  # characters of one that is given
LEAST_DIFFERENT = 6  # of these: what has fewer was never drawn by lot
MOST_TOKEN = 200  # it has to fit into a cookie
PORTS = {"http": 80, "https": 443}

# The page is one file with its scripts inside, and viser compiles some of them ("unsafe-eval"). What
# this keeps out: any request to elsewhere, whatever an address or a message asks for; being framed.
PAGE_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; worker-src blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; "
    "connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
TOKEN_PAGE_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; form-action 'self'; "
    "frame-ancestors 'none'",
    "Cache-Control": "no-store",
}
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


@dataclass(frozen=True)
class HttpRequest:
    """What a request says. headers: names in lower case."""

    path: str
    headers: Mapping[str, str]

    @classmethod
    def of(cls, path: str, headers: Iterable[tuple[str, str]]) -> HttpRequest:
        """From its headers one by one; one that comes twice is a list, as anywhere, and so is no host."""
        joined: dict[str, str] = {}
        for key, value in headers:
            name = key.lower()
            between = "; " if name == "cookie" else ", "
            joined[name] = f"{joined[name]}{between}{value}" if name in joined else value
        return cls(path, joined)

    @property
    def upgrade(self) -> bool:
        """Whether it could be taken to ask for a websocket, the only way to do anything."""
        return "websocket" in self.headers.get("upgrade", "").lower()


@dataclass(frozen=True)
class HttpReply:
    """What is answered in place of the page; its body is HTML where it begins with "<", else text."""

    status: int
    body: str = ""
    headers: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Access:
    """Who may talk to the page.

    names : host names it answers to; None: any, and the token alone decides
    token : what a browser must bring; "": nothing
    tls   : the certificate's context, None without
    """

    names: frozenset[str] | None = LOOPBACK
    token: str = ""
    tls: ssl.SSLContext | None = None

    @property
    def cookie(self) -> str:
        """Name of the cookie: browsers send those of one port to the other ones of a host, too."""
        return f"mapmeld_{sha256(self.token.encode()).hexdigest()[:8]}"

    def answer(self, request: HttpRequest) -> HttpReply | None:
        """What is said instead of what was asked for; None: come in."""
        host = request.headers.get("host", "")
        if self.names is not None and _name(host) not in self.names:
            return HttpReply(421, "this page does not answer to that name")
        if request.upgrade and not _same(request.headers.get("origin"), host):
            return HttpReply(403, "only the page itself may connect")
        path, _, query = request.path.partition("?")
        if self.token and not self._known(request.headers.get("cookie", "")):
            given = urllib.parse.parse_qs(query).get("token", [""])[0]
            if request.upgrade or path != "/" or not same(given, self.token):
                return _token_page(wrong=bool(given))
            secure = self.tls is not None or request.headers.get("x-forwarded-proto") == "https"
            # No path: it is then that of the page, which behind a proxy may lie in a folder.
            # No redirection either: whoever follows a link from elsewhere would come without the cookie.
            cookie = f"{self.cookie}={self.token}; HttpOnly; SameSite=Strict{'; Secure' if secure else ''}"
            return HttpReply(200, _ENTER_PAGE, {"Set-Cookie": cookie, **TOKEN_PAGE_HEADERS})
        if query and not request.upgrade:
            # viser's page would connect to, or play, whatever another address in the query names
            return HttpReply(303, headers={"Location": "./"})
        return None

    def _known(self, cookies: str) -> bool:
        found = False
        for cookie in cookies.split(";"):
            name, _, value = cookie.strip().partition("=")
            found |= name == self.cookie and same(value, self.token)
        return found


def same(given: str, wanted: str) -> bool:
    """Whether two words are the same, in a time that does not tell where they differ."""
    # What is no UTF-8 on its way comes as halves of letters, which pass here, and are the same as nothing
    return hmac.compare_digest(given.encode(errors="surrogatepass"), wanted.encode(errors="surrogatepass"))


def is_local(host: str) -> bool:
    """Whether an address to listen at is this machine's alone."""
    return host.lower() == "localhost" or ip_address(numeric(host) or "0.0.0.0").is_loopback


def numeric(host: str) -> str:
    """An address as it is usually written, "127.0.0.1" for "127.1"; "" for a name, which anyone may own."""
    try:
        return str(socket.getaddrinfo(host, None, flags=socket.AI_NUMERICHOST)[0][4][0]) if host else ""
    except (OSError, UnicodeError):
        return ""


def access_for(
    host: str,
    token_file: Path | None = None,
    names: tuple[str, ...] = (),
    certfile: Path | None = None,
    keyfile: Path | None = None,
) -> Access:
    """Who may talk to a page at ``host``: this machine without more, everyone else with a token.

    token_file : holds the token; else $MAPMELD_TOKEN does; else one is made where one is needed
    names      : further host names, those of a proxy in front
    raises     : InputFileError, SettingError
    """
    for name in names:
        if not _name(name):
            raise SettingError(
                f"--proxy-host {name!r}: this is no host name; "
                "give that of the proxy alone, such as robots.example"
            )
    token = _given_token(token_file)
    local = is_local(host)
    if not token and (names or not local):
        token = secrets.token_urlsafe(TOKEN_BYTES)
    own = {host.lower(), numeric(host)} - {""}
    allowed = LOOPBACK | own | {_name(name) for name in names} if local else None
    return Access(allowed, token, _tls(certfile, keyfile))


def _given_token(token_file: Path | None) -> str:
    if token_file is None:
        token, source = os.environ.get(TOKEN_VARIABLE, "").strip(), f"${TOKEN_VARIABLE}"
        if not token:
            return ""
    else:
        source = str(token_file)
        try:
            with token_file.open(encoding="utf-8") as stream:
                token = stream.read(1000).strip()
        except (OSError, ValueError) as error:
            raise unreadable(token_file, error, "give a file that holds the token alone") from error
    known = set(token) <= _TOKEN_LETTERS and len(set(token)) >= LEAST_DIFFERENT
    if not (LEAST_TOKEN <= len(token) <= MOST_TOKEN and known):
        raise SettingError(
            f"{source}: this is no token; give {LEAST_TOKEN} to {MOST_TOKEN} letters, digits, - or _, "
            f"{LEAST_DIFFERENT} different ones at least, such as {secrets.token_urlsafe(TOKEN_BYTES)}"
        )
    return token


_TOKEN_LETTERS = set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_")


def _tls(certfile: Path | None, keyfile: Path | None) -> ssl.SSLContext | None:
    if certfile is None and keyfile is None:
        return None
    if certfile is None:
        raise SettingError("--keyfile needs --certfile: give the certificate that belongs to the key")
    for path in filter(None, (certfile, keyfile)):
        try:
            path.open("rb").close()
        except OSError as error:
            raise unreadable(path, error, "check the path") from error
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2

    def no_password() -> str:
        raise SettingError(f"{keyfile or certfile}: the key has a password; give one without")

    try:
        context.load_cert_chain(certfile, keyfile, no_password)
    except ssl.SSLError as error:
        if error.reason == "KEY_VALUES_MISMATCH":
            raise InputFileError(
                keyfile, "is not the key of the certificate", "give those of a pair"
            ) from error
        raise InputFileError(
            certfile,
            "is no certificate with its key, or the key file is none",
            "give PEM files: --certfile the certificate (and its chain), --keyfile its key",
        ) from error
    return context


_PLACE = re.compile(r"(\[[0-9a-f:.]+\]|[a-z0-9_][a-z0-9_.-]*)(?::([0-9]{1,5}))?")


def _place(host: str) -> tuple[str, int | None]:
    """Name and port, if any, of "name:port", "[::1]:port" or "name"; ("", None) where it is none."""
    found = _PLACE.fullmatch(host.lower())
    if found is None:
        return "", None
    return found[1].strip("[]"), int(found[2]) if found[2] else None


def _name(host: str) -> str:
    return _place(host)[0]


def _same(origin: str | None, host: str) -> bool:
    """Whether a page's origin is the host that it asks; without an origin it is no page's."""
    scheme, _, place = (origin or "").partition("://")
    usual = PORTS.get(scheme)
    (name, port), (asked_name, asked_port) = _place(place), _place(host)
    return bool(usual and name) and (name, port or usual) == (asked_name, asked_port or usual)


_ENTER_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>mapmeld</title>
<meta http-equiv="refresh" content="0;url=./"><p><a href="./">Go on</a></html>"""


def _token_page(wrong: bool) -> HttpReply:
    """The page of those who have no token yet."""
    says = "That is not the token." if wrong else "This page is not open to everyone."
    body = f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>mapmeld</title>
<meta name="viewport" content="width=device-width">
<style>:root{{color-scheme:light dark}}
body{{font:16px/1.5 system-ui,sans-serif;max-width:30em;margin:14vh auto;padding:0 1em}}
input,button{{font:inherit;padding:.4em .6em}}input{{width:16em}}</style>
<h1>mapmeld</h1><p>{escape(says)} Open the whole address that mapmeld printed when it was started,
or give the token from it.</p>
<form action="./">
<input name="token" type="password" autocomplete="off" required aria-label="Token" autofocus>
<button>Open</button></form></html>"""
    return HttpReply(401, body, TOKEN_PAGE_HEADERS)
