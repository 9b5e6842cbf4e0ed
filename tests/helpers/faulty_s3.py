"""A proxy before an S3 server that does to chosen requests what networks and servers do on bad days."""

from __future__ import annotations

import http.client
import socket
import struct
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from urllib.parse import parse_qs, urlsplit

HANG_S = 3.0
"""Longer than an impatient client waits for an answer."""
ALWAYS = 10**6
STATUS = {"500": "InternalError", "503": "SlowDown", "403": "AccessDenied", "404": "NoSuchKey"}


@dataclass
class Fault:
    """What happens to requests of a kind, and how often.

    Attributes
    ----------
    request : {"initiate", "part", "complete", "put", "get", "head", "list", "delete"}
    does : str
        A status of `STATUS`, or "reset", "reset afterwards", "hang", "cut body", "lost", "error in 200", "cut answer",
        "short answer", "flip".
    times : int
    key : str
        Only of objects whose path holds this.
    """

    request: str
    does: str
    times: int = ALWAYS
    key: str = ""


@dataclass
class FaultyS3:
    """The proxy.

    Attributes
    ----------
    faults : list of Fault
        Of now.
    on_delete : callable
        Called with the path before a deletion goes through.
    """

    host: str
    port: int
    faults: list[Fault] = field(default_factory=list)
    hits: int = 0
    on_delete: Callable[[str], None] = lambda path: None

    def strike(self, request: str, path: str) -> str | None:
        for fault in self.faults:
            if fault.request == request and fault.key in path and fault.times > 0:
                fault.times -= 1
                self.hits += 1
                return fault.does
        return None


@contextmanager
def faulty_s3(host: str, port: int) -> Iterator[tuple[str, FaultyS3]]:
    """Start the proxy before a server; its URL, and the proxy."""
    proxy = FaultyS3(host, port)
    handler = type("Handler", (_Handler,), {"proxy": proxy})
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    server.daemon_threads = True
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}", proxy
    finally:
        server.shutdown()
        server.server_close()


def _kind(method: str, path: str) -> str:
    parts = urlsplit(path)
    query = parse_qs(parts.query, keep_blank_values=True)
    if method == "POST":
        return "initiate" if "uploads" in query else "delete" if "delete" in query else "complete"
    if method == "PUT":
        return "part" if "partNumber" in query else "put"
    if method == "GET":
        return "list" if "list-type" in query or "prefix" in query else "get"
    return {"HEAD": "head", "DELETE": "abort" if "uploadId" in query else "delete"}[method]


class _Handler(BaseHTTPRequestHandler):
    proxy: FaultyS3
    protocol_version = "HTTP/1.1"

    def log_message(self, *args: object) -> None:
        """Be quiet."""

    def do_request(self) -> None:
        self.close_connection = True
        body = self._body()
        kind = _kind(self.command, self.path)
        does = self.proxy.strike(kind, self.path)
        if does in STATUS:
            text = f"<Error><Code>{STATUS[does]}</Code><Message>on a bad day</Message></Error>".encode()
            self._answer(int(does), {}, text)
        elif does == "reset":
            self._reset()
        elif does == "hang":
            time.sleep(HANG_S)
            self._reset()
        elif does == "lost":
            self._answer(200, {"ETag": '"0123456789abcdef0123456789abcdef"'}, _DONE if kind == "complete" else b"")
        elif does == "error in 200":
            self._answer(200, {}, b"<Error><Code>InternalError</Code><Message>after all</Message></Error>")
        else:
            self._forward(kind, body[: len(body) // 2] if does == "cut body" else body, does)

    do_GET = do_PUT = do_POST = do_DELETE = do_HEAD = do_request

    def _forward(self, kind: str, body: bytes, does: str | None) -> None:
        if kind == "delete":
            self.proxy.on_delete(self.path)
        dropped = ("transfer-encoding", "content-length", "connection", "expect")
        headers = {name: value for name, value in self.headers.items() if name.lower() not in dropped}
        connection = http.client.HTTPConnection(self.proxy.host, self.proxy.port)
        connection.request(self.command, self.path, body, headers)
        answer = connection.getresponse()
        data, status = answer.read(), answer.status
        kept = {name: value for name, value in answer.getheaders() if name.lower() not in dropped}
        length = int(answer.getheader("Content-Length") or len(data))
        if does == "reset afterwards":
            self._reset()
        elif does == "cut answer":
            self._answer(status, kept, data[: len(data) // 2], length)
        elif does == "short answer":
            self._answer(status, kept, data[: len(data) // 2], length // 2)
        elif does == "flip" and data:
            at = len(data) // 2
            self._answer(status, kept, data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1 :])
        else:
            self._answer(status, kept, data, length)

    def _body(self) -> bytes:
        if self.headers.get("Transfer-Encoding", "").lower() != "chunked":
            return self.rfile.read(int(self.headers.get("Content-Length") or 0))
        body = b""
        while size := int(self.rfile.readline().split(b";")[0], 16):
            body += self.rfile.read(size)
            self.rfile.readline()
        self.rfile.readline()
        return body

    def _answer(self, status: int, headers: dict[str, str], body: bytes, length: int | None = None) -> None:
        with suppress(OSError):
            self.send_response_only(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(body) if length is None else length))
            self.send_header("Connection", "close")
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(body)

    def _reset(self) -> None:
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.connection.close()


_DONE = (
    b'<CompleteMultipartUploadResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/"><Location>x</Location>'
    b"<Bucket>x</Bucket><Key>x</Key><ETag>x</ETag></CompleteMultipartUploadResult>"
)
