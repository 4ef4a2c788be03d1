"""Proxies that stand in front of a page as docs/examples/nginx.conf says: nginx, and one of our own.

Ours knows what that file uses of nginx and no more: where a path goes, and which headers go along.
"""

from __future__ import annotations

import asyncio
import re
import shutil
import socket
import ssl
import subprocess
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from repository import ROOT
from trustme import LeafCert
from wire import until

EXAMPLE = (ROOT / "docs" / "examples" / "nginx.conf").read_text()
NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")


@contextmanager
def nginx(example: str, upstream: int, cert: LeafCert, folder: Path) -> Iterator[int]:
    """nginx with this example, its port and its paths apart; gives the port."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    cert.private_key_and_cert_chain_pem.write_to_path(str(folder / "both.pem"))
    for said, here in (
        ("listen 443", f"listen 127.0.0.1:{port}"),
        ("127.0.0.1:8080", f"127.0.0.1:{upstream}"),
        ("/etc/ssl/robots.example.pem", f"{folder}/both.pem"),
        ("/etc/ssl/robots.example.key", f"{folder}/both.pem"),
        ("/var/log/nginx/mapmeld.log", f"{folder}/access.log"),
    ):
        assert said in example
        example = example.replace(said, here)
    kinds = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    temporary = "".join(f"{kind}_temp_path {folder}/{kind};\n" for kind in kinds)
    whole = (
        f"daemon off; master_process off; pid {folder}/pid; events {{}}\nhttp {{\n{temporary}{example}\n}}"
    )
    (folder / "nginx.conf").write_text(whole)
    command = [str(NGINX), "-p", str(folder), "-e", f"{folder}/error.log", "-c", f"{folder}/nginx.conf"]
    with subprocess.Popen(command) as running:
        try:
            until(lambda: running.poll() is not None or _answers(port), "nginx", 20)
            assert running.poll() is None, (folder / "error.log").read_text()
            yield port
        finally:
            running.terminate()


@contextmanager
def ours(example: str, upstream: int, cert: LeafCert, _: Path) -> Iterator[int]:
    """A proxy that does the same, as far as this example goes; gives its port."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    cert.configure_cert(context)
    sent = dict(re.findall(r"^ *proxy_set_header (\S+) (\S+);", example, re.M))

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        head = (await reader.readuntil(b"\r\n\r\n")).decode()
        (request, *lines), asked = head.strip().split("\r\n"), {}
        for line in lines:
            name, _, value = line.partition(":")
            asked[name.lower()] = value.strip()
        method, target, version = request.split()
        folder, question, query = target.partition("?")
        upgrade = asked.pop("upgrade", "")
        if folder == "/maps" and not upgrade:
            place = f"https://{asked['host']}/maps/{question}{query}"
            writer.write(f"{version} 301 Moved\r\nLocation: {place}\r\nConnection: close\r\n\r\n".encode())
            writer.close()
            return
        known = {"$http_host": asked["host"], "$scheme": "https", "$http_upgrade": upgrade}
        known["$connection_upgrade"] = "upgrade" if upgrade else "close"
        asked |= {"host": f"127.0.0.1:{upstream}", "connection": "close"}
        asked |= {name.lower(): known[value] for name, value in sent.items()}
        path = "/" + folder.removeprefix("/maps").removeprefix("/") + question + query
        told = "".join(f"{name}: {value}\r\n" for name, value in asked.items() if value)
        behind, before = await asyncio.open_connection("127.0.0.1", upstream)
        before.write(f"{method} {path} {version}\r\n{told}\r\n".encode())
        await asyncio.gather(_pass(reader, before), _pass(behind, writer))

    began: Future[tuple[int, Callable[[], object]]] = Future()

    async def stand() -> None:
        loop, end = asyncio.get_running_loop(), asyncio.Event()
        server = await asyncio.start_server(serve, "127.0.0.1", 0, ssl=context)
        began.set_result((server.sockets[0].getsockname()[1], lambda: loop.call_soon_threadsafe(end.set)))
        await end.wait()
        server.close()

    thread = Thread(target=asyncio.run, args=(stand(),))
    thread.start()
    port, end = began.result()
    try:
        yield port
    finally:
        end()
        thread.join()


async def _pass(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await reader.read(65536):
        writer.write(data)
        await writer.drain()
    writer.close()


def _answers(port: int) -> bool:
    with socket.socket() as knock:
        return knock.connect_ex(("127.0.0.1", port)) == 0


PROXIES = {"ours": ours, **({"nginx": nginx} if NGINX else {})}
