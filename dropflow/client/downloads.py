"""Downloads that go on where they were cut, and are checked: a file stands under its name only when it is right."""

import base64
import hashlib
import time
import zipfile
from pathlib import Path

from dropflow.client.connection import Connection, pause_s
from dropflow.client.documents import ResultFile
from dropflow.client.errors import Damaged, NotReachable, ServerProblem
from dropflow.client.films import pieces_of
from dropflow.progress import Progress, silent

N_TRIES = 6
_PARTIAL = 206
_BEHIND_THE_END = 416


def download(connection: Connection, path: str, file: ResultFile, target: Path, *, progress: Progress = silent) -> Path:
    """Bring one file to `target`. If it is there already and right, nothing is sent."""
    if target.is_file() and target.stat().st_size == file.size_bytes and file.sha256 in (None, sha256_of(target)):
        progress(file.name, file.size_bytes, file.size_bytes)
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name}.part")
    for n_failures in range(1, N_TRIES + 1):
        try:
            expected = _take(connection, path, file, part, progress)
        except (NotReachable, ServerProblem) as problem:
            if n_failures == N_TRIES or (isinstance(problem, ServerProblem) and problem.status < 500):
                raise
            time.sleep(pause_s(n_failures))
            continue
        if part.stat().st_size == file.size_bytes and expected in (None, sha256_of(part)):
            part.replace(target)
            _tag_file(part).unlink(missing_ok=True)
            return target
        part.unlink()  # begin anew
    raise Damaged("What arrived is not what the server has.", file=file.name, hint="Try again later.")


def unpack(archive: Path, folder: Path) -> Path:
    """Unpack an archive that holds one folder beside itself; the folder is there whole or not at all."""
    name = archive.name.removesuffix(".zip")
    unfinished = folder / f".{name}.unpacking"
    with zipfile.ZipFile(archive) as opened:
        opened.extractall(unfinished)
    target = folder / name
    if target.exists():
        _remove(target)
    (unfinished / name).replace(target)
    _remove(unfinished)
    return target


def sha256_of(path: Path) -> str:
    """The checksum of a file."""
    digest = hashlib.sha256()
    for piece in pieces_of(path):
        digest.update(piece)
    return digest.hexdigest()


def _take(connection: Connection, path: str, file: ResultFile, part: Path, progress: Progress) -> str | None:
    """Take what is missing of a file; the checksum that the whole must have, if the server tells one."""
    headers, start = {}, 0
    if part.exists() and _tag_file(part).exists() and (start := part.stat().st_size):
        headers = {"Range": f"bytes={start}-", "If-Range": _tag_file(part).read_text()}
    try:
        with connection.stream("GET", path, headers=headers) as answer:
            is_rest = answer.status_code == _PARTIAL
            done = start if is_rest else 0
            _tag_file(part).write_text(answer.headers.get("ETag", ""))
            with part.open("ab" if is_rest else "wb") as target:
                for piece in answer.iter_bytes():
                    target.write(piece)
                    done += len(piece)
                    progress(file.name, done, file.size_bytes)
            return _digest(answer.headers.get("Repr-Digest", "")) or file.sha256
    except ServerProblem as problem:
        if problem.status != _BEHIND_THE_END:
            raise
        return file.sha256  # all of it was here


def _digest(header: str) -> str | None:
    for entry in header.split(","):
        kind, _, value = entry.strip().partition("=")
        if kind == "sha-256":
            return base64.b64decode(value.strip(":")).hex()
    return None


def _tag_file(part: Path) -> Path:
    return part.with_suffix(".tag")


def _remove(folder: Path) -> None:
    import shutil

    shutil.rmtree(folder)
