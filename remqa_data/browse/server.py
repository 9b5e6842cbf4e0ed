"""The pages served on this machine: Starlette and uvicorn, one request after the other, nothing kept between them."""

from __future__ import annotations

import hashlib
import socket
from collections.abc import Callable
from typing import Any

from remqa_data.browse.site import Site
from remqa_data.errors import OutputError, RemqaError
from remqa_data.extras import require

LOOPBACK = ("127.0.0.1", "localhost", "[::1]", "::1")
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; img-src 'self' blob:; connect-src blob:; style-src 'self'; "
    "script-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


def make_app(site: Site, host: str = "127.0.0.1") -> Any:
    """The pages as an ASGI application, which answers only who asks for this host or for this machine by its name.

    Raises
    ------
    MissingExtraError
        If Starlette is not installed.
    """
    applications, responses = (require(f"starlette.{part}", "browse") for part in ("applications", "responses"))
    routing, hosts = (require(f"starlette.{part}", "browse") for part in ("routing", "middleware.trustedhost"))
    middleware = require("starlette.middleware", "browse")

    async def answer(request: Any) -> Any:
        path = request.path_params["path"]
        try:
            found = site.get(path, request.query_params)
        except RemqaError as error:  # a damaged file: the rest can still be looked at
            return responses.PlainTextResponse(f"{error}\n", status_code=500, headers=HEADERS)
        status, found = (200, found) if found is not None else (404, site.missing(path))
        # Another dataset has other pictures at the same addresses: a browser asks each time whether they are still these.
        tag = f'"{hashlib.sha256(found.body).hexdigest()}"'
        headers = HEADERS | {"Cache-Control": "private, no-cache", "ETag": tag}
        if status == 200 and request.headers.get("if-none-match") == tag:
            return responses.Response(status_code=304, headers=headers)
        return responses.Response(found.body, status, headers, media_type=found.media_type)

    # A page of another site that calls itself by a name for this machine (DNS rebinding) gets nothing.
    allowed = ["*"] if host in ("0.0.0.0", "::") else [host, *LOOPBACK]
    return applications.Starlette(
        routes=[routing.Route("/{path:path}", answer, methods=["GET"])],
        middleware=[middleware.Middleware(hosts.TrustedHostMiddleware, allowed_hosts=allowed)],
    )


def serve(site: Site, host: str, port: int, ready: Callable[[str], None]) -> None:
    """Serve until the command is stopped.

    Parameters
    ----------
    site : Site
    host : str
        What to listen on.
    port : int
        0 for any that is free.
    ready : callable
        Told the address once it can be opened.

    Raises
    ------
    OutputError
        If nothing can listen there.
    MissingExtraError
        If uvicorn or Starlette is not installed.
    """
    uvicorn = require("uvicorn", "browse")
    app = make_app(site, host)
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as listening:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((host, port))
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            msg = f"cannot listen on {host}, port {port}: {reason}; name another with --port or --host"
            raise OutputError(msg) from None
        listening.listen()
        shown = f"[{host}]" if ":" in host else host
        ready(f"http://{shown}:{listening.getsockname()[1]}/")
        config = uvicorn.Config(app, log_level="warning", access_log=False, server_header=False)
        uvicorn.Server(config).run(sockets=[listening])
