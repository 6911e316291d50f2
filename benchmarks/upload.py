"""Speed of an upload over loopback beside that of `dd` to the same disk, both until the disk has the bytes.

    python -m benchmarks.upload [--megabytes 1000] [--megabytes-a-request 64] [--repeat 3]

The service is the one that is shipped, a process of its own with Postgres and a folder as object store; the sender is
a plain socket, so that nobody but the service is measured. What is sent is one file, checksummed on its way.
"""

import argparse
import os
import socket
import statistics
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlparse

import httpx

from tests.films import EXPERIMENT
from tests.services import (
    MIGRATED,
    RunningService,
    database,
    migrate,
    running_postgres,
    running_service,
    running_valkey,
)

MEGABYTE = 1_000_000


@contextmanager
def service() -> Iterator[RunningService]:
    """The whole of it, on new servers."""
    with running_postgres() as postgres, running_valkey() as valkey:
        postgres.create_database(MIGRATED)
        migrate(postgres.url(MIGRATED))
        with database(postgres, template=MIGRATED) as url, running_service(url, valkey.url(0)) as running:
            yield running


def upload_mb_s(running: RunningService, content: bytes, request_bytes: int) -> float:
    """Megabytes a second of one upload, from the first request to the last answer."""
    with httpx.Client(base_url=f"{running.url}api/v1/", timeout=600) as api:
        experiment = api.post("experiments", json={"experiment": EXPERIMENT}).json()["id"]
        wanted = {"files": [{"name": "film.tif", "size_bytes": len(content)}]}
        (upload,) = api.post(f"experiments/{experiment}/uploads/plan", json=wanted).json()["uploads"]
        started = time.perf_counter()
        _send(running.url, f"/api/v1/{upload['location']}", content, request_bytes)
        took_s = time.perf_counter() - started
        (file,) = api.get(f"experiments/{experiment}/files").json()["items"]
        assert file["size_bytes"] == len(content)
        api.delete(f"experiments/{experiment}", params={"forever": True})
    return len(content) / MEGABYTE / took_s


def _send(url: str, path: str, content: bytes, request_bytes: int) -> None:
    address = urlparse(url)
    view = memoryview(content)
    with socket.create_connection((address.hostname, address.port)) as connection:
        for start in range(0, len(content), request_bytes):
            part = view[start : start + request_bytes]
            head = (
                f"PATCH {path} HTTP/1.1\r\nHost: {address.netloc}\r\nTus-Resumable: 1.0.0\r\nUpload-Offset: {start}\r\n"
                f"Content-Type: application/offset+octet-stream\r\nContent-Length: {len(part)}\r\n\r\n"
            )
            connection.sendall(head.encode())
            connection.sendall(part)
            answer = b""
            while b"\r\n\r\n" not in answer:
                answer += connection.recv(65536)
            assert answer.startswith(b"HTTP/1.1 204"), answer


def dd_mb_s(folder: Path, source: Path, n_bytes: int) -> float:
    """Megabytes a second of `dd` with 4 MB blocks, `fdatasync` at the end."""
    started = time.perf_counter()
    target = folder / "dd"
    command = ["dd", f"if={source}", f"of={target}", "bs=4M", "conv=fdatasync", "status=none"]
    subprocess.run(command, check=True)
    took_s = time.perf_counter() - started
    target.unlink()
    return n_bytes / MEGABYTE / took_s


def main() -> None:
    """Measure both in turn, print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--megabytes", type=int, default=1000)
    parser.add_argument("--megabytes-a-request", type=int, default=64)
    parser.add_argument("--repeat", type=int, default=3)
    asked = parser.parse_args()
    content = b"II*\0" + os.urandom(MEGABYTE - 4) + os.urandom(MEGABYTE) * (asked.megabytes - 1)
    with service() as running:
        folder = Path(urlparse(running.environment["OBJECT_STORE_URL"]).path)
        source = folder / "source"
        source.write_bytes(content)
        rows = []
        for _ in range(asked.repeat):
            by_dd = dd_mb_s(folder, source, len(content))
            rows.append((upload_mb_s(running, content, asked.megabytes_a_request * 1 << 20), by_dd))
    print(f"{asked.megabytes} MB in requests of {asked.megabytes_a_request} MiB")
    print(f"{'upload MB/s':>12} {'dd MB/s':>10} {'ratio':>6}")
    for upload, by_dd in rows:
        print(f"{upload:12.0f} {by_dd:10.0f} {upload / by_dd:6.2f}")
    print(f"median ratio {statistics.median(upload / by_dd for upload, by_dd in rows):.2f}")


if __name__ == "__main__":
    main()
