"""Who is answered, with what; and what is said where nothing can listen."""

import socket
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from typer.testing import CliRunner

from remqa_data.cli import app

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")


def ask(address: str, host: str | None = None, tag: str | None = None) -> tuple[int, str, dict[str, str]]:
    headers = {"Host": host, "If-None-Match": tag}
    request = urllib.request.Request(address, headers={name: value for name, value in headers.items() if value})
    try:
        with urllib.request.urlopen(request, timeout=30) as answer:
            return answer.status, answer.read().decode("utf-8", "replace"), dict(answer.headers)
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), dict(error.headers)


def test_every_answer_forbids_scripts_of_others(served: str) -> None:
    for address in ("", "style/browse.js", "nothing"):
        headers = {name.lower(): value for name, value in ask(served + address)[2].items()}
        assert "default-src 'none'" in headers["content-security-policy"]
        assert "unsafe" not in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"


def test_what_a_browser_has_kept_is_asked_for_again(served: str) -> None:
    """Another dataset, served from the same port, has other pictures at the same addresses."""
    for address in ("", "style/browse.js"):
        _, _, headers = ask(served + address)
        assert "no-cache" in headers["cache-control"]
        for tag, status in ((headers["etag"], 304), ('"other"', 200)):
            assert ask(served + address, tag=tag)[0] == status


def test_a_page_that_is_not_there_is_404_with_a_way_back(served: str) -> None:
    status, page, _ = ask(served + "q/nothing.html")
    assert status == 404
    assert 'href="../index.html"' in page


def test_who_asks_for_another_host_is_not_answered(served: str) -> None:
    assert ask(served, "evil.example")[0] == 400
    assert ask(served, "localhost")[0] == 200


def test_a_taken_port_is_one_line(hostile: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        done = CliRunner().invoke(app, ["browse", str(hostile), "--port", str(port)])
    assert done.exit_code == 2
    assert f"cannot listen on 127.0.0.1, port {port}: " in done.output
    assert "name another with --port" in done.output
