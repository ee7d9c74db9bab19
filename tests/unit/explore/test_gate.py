"""Requests of other names and other pages are refused, whatever they ask for."""

import pytest
from tornado.httputil import HTTPHeaders
from tornado.web import Application

from mptune.explore.gate import Gate

PORT = 4567
HOME = f"127.0.0.1:{PORT}"


@pytest.fixture(scope="module")
def gate():
    return Gate(Application([]), PORT)


@pytest.mark.parametrize(
    "headers",
    [{}, {"Origin": f"http://{HOME}"}, {"Origin": f"http://localhost:{PORT}"}],
)
def test_its_own_page_is_admitted(gate, headers):
    assert gate.admits(HTTPHeaders({"Host": HOME, **headers}))


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Host": "evil.example"},
        {"Host": f"evil.example:{PORT}"},
        {"Host": "127.0.0.1:80"},
        {"Host": HOME, "Origin": "http://evil.example"},
        {"Host": HOME, "Origin": "null"},
        {"Host": HOME, "Origin": f"https://{HOME}"},
        {"Host": HOME, "Origin": f"http://{HOME}.evil.example"},
        {"Host": HOME, "Sec-WebSocket-Origin": "http://evil.example"},
    ],
)
def test_all_others_are_refused(gate, headers):
    assert not gate.admits(HTTPHeaders(headers))
