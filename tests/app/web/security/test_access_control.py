"""Who is let in, and what is wrong with what an operator gives for it."""

from __future__ import annotations

import base64
from types import SimpleNamespace

import pytest
import trustme
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError, MapMergeError, SettingError
from app.cli.commands.serve import address, reach
from app.web.security.access_control import LEAST_TOKEN, Access, HttpRequest, access_for, is_local, same

TOKEN = "a-token-that-nobody-guesses"


def ask(access: Access, path: str = "/", **headers: str) -> int | None:
    answer = access.answer(
        HttpRequest(path, {key.replace("_", "-"): value for key, value in headers.items()})
    )
    return answer and answer.status


@pytest.mark.parametrize(
    ("host", "origin", "local", "upgrade", "status"),
    [
        ("127.0.0.1:8080", None, True, False, None),
        ("localhost:8080", "http://localhost:8080", True, True, None),
        ("[::1]:8080", "http://[::1]:8080", True, True, None),
        ("localhost", "http://localhost:80", True, True, None),
        ("LocalHost:8080", "http://localhost:8080", True, True, None),
        ("evil.example:8080", None, True, False, 421),  # a foreign name that points here
        ("127.0.0.1.evil.example:8080", None, True, False, 421),
        ("", None, True, False, 421),
        ("[::1", None, True, False, 421),
        ("127.0.0.1:8080", "http://evil.example", True, True, 403),  # a foreign page
        ("127.0.0.1:8080", "http://127.0.0.1:8081", True, True, 403),  # a page of another program
        ("127.0.0.1:8080", None, True, True, 403),
        ("127.0.0.1:8080", "null", True, True, 403),
        ("127.0.0.1:8080", "file://127.0.0.1:8080", True, True, 403),
        ("127.0.0.1:x", "http://127.0.0.1:x", True, True, 421),
        ("127.0.0.1:8080", "http://evil@127.0.0.1:8080", True, True, 403),
        ("127.0.0.1:8080", "http://127.0.0.1:8080#x", True, True, 403),
        ("127.0.0.1:8080", "http://127.0.0.1:8080?x", True, True, 403),
        ("127.0.0.1:8080", "http://127.0.0.1:8080/", True, True, 403),
        ("127.0.0.1:8080, evil.example", None, True, False, 421),
        ("evil.example@127.0.0.1:8080", None, True, False, 421),
        ("127.0.0.1:8080/x", None, True, False, 421),
        ("127.0.0.1:8080 ", None, True, False, 421),
        ("robot.lan, robot.lan", "http://robot.lan, robot.lan", False, True, 403),
        ("robot.lan:8080", "http://robot.lan:8080", False, True, None),
        ("robot.lan", "https://robot.lan", False, True, None),
        ("robot.lan:8080", "http://evil.example", False, True, 403),
    ],
)
def test_only_the_page_itself_may_connect(host, origin, local, upgrade, status):
    headers = {"host": host, **({"origin": origin} if origin is not None else {})}
    if upgrade:
        headers["upgrade"] = "WebSocket"
    access = Access() if local else Access(None)
    assert ask(access, **headers) == status


HALVES = st.characters(exclude_categories=())  # of letters, too: what is no UTF-8 comes as such


@given(st.text(HALVES, max_size=40), st.text(HALVES, max_size=40))
def test_words_are_the_same_only_if_they_are(one, other):
    assert same(one, one)
    assert same(one, other) is (one == other)


def test_nothing_but_a_comparison_in_constant_time_decides_who_has_the_token(monkeypatch):
    """It is told to lie, and what is answered is then the wrong thing, by address and by cookie."""
    access, wrong = Access(None, TOKEN), TOKEN[:-1] + "X"
    compared = []

    def lie(given: bytes, wanted: bytes) -> bool:
        compared.append((given.decode(), wanted.decode()))
        return given not in (b"", wanted)

    monkeypatch.setattr("app.web.security.access_control.hmac", SimpleNamespace(compare_digest=lie))
    for word, by_address, by_cookie in ((TOKEN, 401, 401), (wrong, 200, None)):
        assert ask(access, f"/?token={word}", host="x") == by_address
        assert ask(access, host="x", cookie=f"a=b; {access.cookie}={word}") == by_cookie
        assert compared.count((word, TOKEN)) == 2


@given(st.text(HALVES, max_size=200), st.text(HALVES, max_size=200))
def test_whatever_a_stranger_sends_is_answered_and_never_with_the_page(query, cookie):
    access = Access(None, TOKEN)
    assert ask(access, f"/?{query}", host="x", cookie=cookie) == 401


@given(st.text(HALVES, max_size=40))
def test_no_words_around_the_origin_make_it_the_pages_own(words):
    for origin in (f"http://{words}127.0.0.1:8080", f"http://127.0.0.1:8080{words}"):
        asked = HttpRequest("/", {"host": "127.0.0.1:8080", "origin": origin, "upgrade": "websocket"})
        assert (Access().answer(asked) is None) is (words == "")


def test_what_is_said_twice_is_said_as_a_list():
    headers = [("Host", "a"), ("hOST", "b"), ("Cookie", "a=1"), ("Cookie", "b=2"), ("X", "y")]
    asked = HttpRequest.of("/", headers)
    assert asked.headers == {"host": "a, b", "cookie": "a=1; b=2", "x": "y"}


@pytest.mark.parametrize(
    "upgrade", ["websocket", "WebSocket", ",websocket", "websocket, h2c", "h2c,WEBSOCKET"]
)
def test_whoever_could_get_a_websocket_is_asked_for_the_origin(upgrade):
    assert ask(Access(), host="127.0.0.1", upgrade=upgrade, origin="http://evil.example") == 403


def test_a_server_for_this_machine_needs_no_token_and_any_other_has_one_of_its_own():
    assert access_for("127.0.0.1").token == ""
    assert access_for("::1").token == ""
    one, other = access_for("0.0.0.0"), access_for("0.0.0.0")
    assert one.names is None
    assert len(one.token) >= LEAST_TOKEN
    assert one.token != other.token
    assert access_for("127.0.0.1", names=("robots.example",)).token != ""


def test_a_token_of_ours_cannot_be_guessed_and_passes_as_a_given_one(monkeypatch):
    drawn = [access_for("0.0.0.0").token for _ in range(200)]
    assert len(set(drawn)) == 200
    for token in drawn:
        assert len(base64.urlsafe_b64decode(token)) == 24  # 192 bits, all of them drawn:
    for at in range(32):
        assert len({token[at] for token in drawn}) > 32  # of 64 letters, at every place
    monkeypatch.setenv("MAPMELD_TOKEN", drawn[0])
    assert access_for("127.0.0.1").token == drawn[0]


@pytest.mark.parametrize("length", [16, 200])
def test_a_given_token_may_be_as_short_and_as_long_as_is_said(length, monkeypatch):
    monkeypatch.setenv("MAPMELD_TOKEN", ("a1b2c3d4-_" * 20)[:length])
    assert len(access_for("127.0.0.1").token) == length


def test_a_token_file_that_holds_more_than_a_token_is_refused_not_cut(tmp_path):
    path = tmp_path / "token"
    path.write_text("0123456789" * 10_000)
    with pytest.raises(SettingError, match="token: this is no token"):
        access_for("127.0.0.1", path)


def test_a_name_in_front_is_answered_to_besides_those_of_this_machine(monkeypatch):
    access = access_for("127.0.0.1", names=("robots.example",))
    cookie = f"{access.cookie}={access.token}"
    assert ask(access, host="robots.example", cookie=cookie) is None
    assert ask(access, host="robots.example:8443", cookie=cookie) is None
    assert ask(access, host="127.0.0.1:8080", cookie=cookie) is None
    assert ask(access, host="evil.example", cookie=cookie) == 421


def test_a_token_comes_from_a_file_before_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("MAPMELD_TOKEN", TOKEN)
    assert access_for("0.0.0.0").token == TOKEN
    assert access_for("127.0.0.1").token == TOKEN  # on a machine of many people it keeps the others out
    path = tmp_path / "token"
    path.write_text("  another-token-of-ours\n")
    assert access_for("0.0.0.0", path).token == "another-token-of-ours"


@pytest.mark.parametrize(
    "word",
    [
        "short",
        "short-by-one-ab",
        "with a space in it, and long",
        "äöüÄÖÜß-of-ours-and-long",
        "a;b-of-ours-and-long",
        "12345" * 5,  # long, and one of the first that anybody would try
        "0123456789" * 21,  # more than a browser keeps
    ],
)
def test_a_token_that_could_be_guessed_or_not_be_kept_is_refused(word, monkeypatch):
    monkeypatch.setenv("MAPMELD_TOKEN", word)
    with pytest.raises(
        SettingError, match=r"\$MAPMELD_TOKEN: this is no token; give 16 to 200 letters"
    ) as said:
        access_for("0.0.0.0")
    assert word not in str(said.value)


def test_every_file_that_cannot_be_used_is_named_with_a_remedy(tmp_path):
    missing, text = tmp_path / "missing", tmp_path / "text"
    text.write_text("no certificate")
    binary = tmp_path / "binary"
    binary.write_bytes(b"\xff\xfe\x00")
    one, other = trustme.CA().issue_cert("a.example"), trustme.CA().issue_cert("b.example")
    cert, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    cert.write_bytes(one.cert_chain_pems[0].bytes())
    key.write_bytes(other.private_key_pem.bytes())
    for how, named in (
        ({"token_file": missing}, missing),
        ({"token_file": binary}, binary),
        ({"certfile": missing}, missing),
        ({"certfile": text}, text),
        ({"certfile": cert}, cert),
        ({"certfile": cert, "keyfile": text}, cert),
        ({"certfile": cert, "keyfile": key}, key),
    ):
        with pytest.raises(InputFileError) as said:
            access_for("127.0.0.1", **how)
        assert said.value.source == str(named)
    with pytest.raises(MapMergeError, match="--keyfile needs --certfile"):
        access_for("127.0.0.1", keyfile=key)


def test_a_certificate_and_its_key_may_lie_in_one_file_and_old_protocols_are_not_spoken(tmp_path):
    issued = trustme.CA().issue_cert("127.0.0.1")
    both = tmp_path / "both.pem"
    both.write_bytes(issued.private_key_and_cert_chain_pem.bytes())
    context = access_for("127.0.0.1", certfile=both).tls
    assert context is not None
    assert context.minimum_version.name == "TLSv1_2"


def test_the_start_line_says_where_and_for_whom():
    assert address("127.0.0.1", 8080, Access()) == "http://127.0.0.1:8080/"
    assert reach("127.0.0.1", Access()) == "for this machine alone"
    locked = Access(None, TOKEN)
    assert address("0.0.0.0", 80, locked) == f"http://127.0.0.1:80/?token={TOKEN}"
    assert address("::1", 80, Access()) == "http://[::1]:80/"
    assert address("::", 80, Access()) == "http://[::1]:80/"
    assert address("", 80, Access()) == "http://127.0.0.1:80/"
    assert address("127.1", 80, Access()) == "http://127.0.0.1:80/"
    assert address("robot.lan", 80, Access()) == "http://robot.lan:80/"
    assert reach("LOCALHOST", Access(token=TOKEN)) == "for this machine with the token"
    assert reach("0.0.0.0", locked) == "for everyone on the network with the token, unencrypted"
    assert reach("127.0.0.1", locked) == "for this machine with the token"
    told = reach("127.0.0.1", locked, ["robots.example"])
    assert told == "for this machine, and whom the proxy at robots.example lets through, with the token"


@pytest.mark.parametrize(
    ("host", "local"), [("127.0.0.1", True), ("127.9.9.9", True), ("::1", True), ("localhost", True),
                        ("LOCALHOST", True), ("127.1", True), ("", False), ("0", False), ("a b", False),
                        ("0.0.0.0", False), ("192.168.1.4", False), ("robot.lan", False), ("::", False)]
)  # fmt: skip
def test_only_addresses_that_never_leave_this_machine_are_its_own(host, local):
    assert is_local(host) is local


@pytest.mark.parametrize("host", ["127.1", "LOCALHOST", "127.9.9.9"])
def test_a_page_for_this_machine_answers_to_the_name_it_was_started_with(host):
    access = access_for(host)
    assert access.token == ""
    for name in (host, host.lower(), "127.0.0.1", "localhost"):
        assert ask(access, host=f"{name}:8080") is None
    assert ask(access, host="evil.example") == 421


@pytest.mark.parametrize(
    "name",
    ["", "*", "*.example", "https://x.example/maps", "x.example/maps", "a b", "a,b", "u@x.example", "::1"],
)
def test_what_is_no_host_name_is_not_taken_for_that_of_a_proxy(name):
    with pytest.raises(
        SettingError, match=r"--proxy-host .* this is no host name; give that of the proxy alone"
    ):
        access_for("127.0.0.1", names=("robots.example", name))


@pytest.mark.parametrize("name", ["robots.example", "Robots.Example:8443", "10.0.0.7", "[::1]:80", "robot_1"])
def test_a_proxy_has_a_name_or_an_address_and_a_port_if_it_likes(name):
    access = access_for("127.0.0.1", names=(name,))
    assert ask(access, host=name, cookie=f"{access.cookie}={access.token}") is None


def test_a_websocket_is_not_let_in_by_a_token_in_its_address():
    """A page of elsewhere that has learned it could connect in a person's name; a cookie it cannot send."""
    access = Access(None, TOKEN)
    asked = {"host": "robot.lan", "origin": "http://robot.lan", "upgrade": "websocket"}
    assert ask(access, f"/?token={TOKEN}", **asked) == 401
    assert ask(access, f"/?token={TOKEN}", host="robot.lan") == 200
    assert ask(access, "/", cookie=f"{access.cookie}={TOKEN}", **asked) is None


def test_the_cookie_is_found_wherever_it_stands_among_those_of_other_ports():
    access = Access(None, TOKEN)
    own = f"{access.cookie}={TOKEN}"
    for cookies in (own, f"a=b; {own}", f"{own}; a=b", f"{own};{access.cookie}=old", f"a; {own} ; b=c=d"):
        assert ask(access, host="x", cookie=cookies) is None, cookies
    assert ask(access, host="x", cookie=f"{access.cookie}=old; other={TOKEN}") == 401


def test_who_gave_a_wrong_token_is_told_so_and_who_gave_none_is_asked_for_one():
    def page(path):
        return Access(None, TOKEN).answer(HttpRequest(path, {"host": "x"})).body

    assert page("/?token=wrong") != page("/")
    assert "not the token" in page("/?token=wrong")
    assert "not the token" not in page("/")
