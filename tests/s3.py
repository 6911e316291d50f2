"""A real S3 server, and a way to it on which every tenth request fails."""

import http.client
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from deploy.local.processes import free_port
from tests.services import scratch_folder

BUCKET = "frames"
_WEED = Path(sys.executable).with_name("weed")


@contextmanager
def running_s3(address: str = "127.0.0.1") -> Iterator[int]:
    """SeaweedFS from its wheel; yields its port."""
    with scratch_folder() as folder:
        port = free_port()
        ports = {name: free_port() for name in ("master", "volume", "filer")}
        command = [
            _WEED, "mini", f"-dir={folder}", f"-ip={address}", f"-ip.bind={address}", f"-s3.port={port}",
            *(f"-{name}.port={number}" for name, number in ports.items()),
            "-webdav=false", "-admin.ui=false", "-master.telemetry=false", f"-bucket={BUCKET}",
        ]  # fmt: skip
        with (folder / "log").open("wb") as log:
            server = subprocess.Popen(command, env={**os.environ, **KEYS}, stdout=log, stderr=log, cwd=folder)
        try:
            _await_bucket(address, port, server, folder / "log")
            yield port
        finally:
            server.terminate()
            server.wait(20)


KEYS = {"AWS_ACCESS_KEY_ID": "tester", "AWS_SECRET_ACCESS_KEY": "only-for-tests"}


def use(monkeypatch: pytest.MonkeyPatch, port: int) -> None:
    """Have stores of this process speak to the S3 server on `port`."""
    about = {"AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}", "AWS_ALLOW_HTTP": "true", "AWS_REGION": "us-east-1"}
    for name, value in {**KEYS, **about}.items():
        monkeypatch.setenv(name, value)


@contextmanager
def failing_way(port: int, *, every: int = 10) -> Iterator[int]:
    """Pass requests on to `port`, but answer every tenth with an error of the server; yields the port."""
    counted = threading.Lock()
    n_requests = 0

    class Way(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def _pass_on(self) -> None:
            nonlocal n_requests
            content = self.rfile.read(int(self.headers.get("Content-Length") or 0))
            with counted:
                n_requests += 1
                is_failing = n_requests % every == 0
            if is_failing:
                self._answer(503, {}, b"")
                return
            with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=30)) as onward:
                onward.request(self.command, self.path, content, dict(self.headers))
                answer = onward.getresponse()
                body = answer.read()
            left_out = {"transfer-encoding", "connection", "content-length"}
            headers = {name: value for name, value in answer.getheaders() if name.lower() not in left_out}
            length = answer.getheader("Content-Length") if self.command == "HEAD" else str(len(body))
            self._answer(answer.status, {**headers, "Content-Length": length or "0"}, body)

        def _answer(self, status: int, headers: dict[str, str], body: bytes) -> None:
            self.send_response_only(status)
            for name, value in ({"Content-Length": "0"} | headers).items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        do_GET = do_PUT = do_POST = do_DELETE = do_HEAD = _pass_on  # noqa: N815 - the base class calls them so

        def log_message(self, *_: object) -> None:
            """Say nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Way)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_address[1]
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def _await_bucket(address: str, port: int, server: subprocess.Popen[bytes], log: Path) -> None:
    deadline = time.monotonic() + 60
    while True:
        assert server.poll() is None, log.read_text(errors="replace")[-3000:]
        assert time.monotonic() < deadline, log.read_text(errors="replace")[-3000:]
        connection = http.client.HTTPConnection(address, port, timeout=2)
        with closing(connection), suppress(OSError, http.client.HTTPException):
            connection.request("HEAD", f"/{BUCKET}")
            if connection.getresponse().status in (200, 403):
                return
        time.sleep(0.2)
