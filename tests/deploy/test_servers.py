"""The embedded servers start, keep what they are given, and go when their starter goes."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import psycopg
import pytest
import redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from deploy.local.errors import LauncherError
from deploy.local.postgres import Installation, Postgres, given_database, installations, new_password, plain
from deploy.local.processes import is_port_free
from deploy.local.valkey import Valkey, given_queue
from tests.services import ROOT, scratch_folder


@pytest.mark.parametrize("installation", installations(), ids=lambda found: f"PostgreSQL-{found.version}")
def test_postgres_keeps_its_data_over_a_restart_in_a_closed_folder(installation: Installation) -> None:
    """Every PostgreSQL of this machine serves a folder that only its owner can enter, which matters to root."""
    with scratch_folder() as folder:
        folder.chmod(0o700)
        server = Postgres(folder, password=new_password(), log=folder / "log", installation=installation)
        first = server.start()
        server.create_database("kept")
        with psycopg.connect(plain(server.url("kept"))) as connection:
            connection.execute("create table droplets as select 7 as n")
        assert first.stop()
        second = server.start()
        with psycopg.connect(plain(server.url("kept"))) as connection:
            assert connection.execute("select n from droplets").fetchone() == (7,)
        assert second.stop()


def test_postgres_asks_for_its_password(postgres_server: Postgres) -> None:
    with pytest.raises(psycopg.OperationalError, match="password authentication failed"):
        psycopg.connect(f"postgresql://dropflow:wrong@127.0.0.1:{postgres_server.port}/postgres")


@pytest.mark.parametrize("url", ["postgresql://nobody@127.0.0.1:1/none", "mysql://127.0.0.1/none"])
def test_an_address_without_postgres_is_refused(url: str) -> None:
    with pytest.raises(LauncherError, match="DATABASE_URL does not lead to a PostgreSQL: ") as refused:
        given_database(url)
    assert refused.value.exit_code == 2


@pytest.mark.parametrize("url", ["redis://127.0.0.1:1/0", "nonsense"])
def test_an_address_without_valkey_is_refused(url: str) -> None:
    with pytest.raises(LauncherError, match="REDIS_URL does not lead to a Redis or Valkey: ") as refused:
        given_queue(url)
    assert refused.value.exit_code == 2


def test_addresses_of_running_servers_are_taken(postgres_server: Postgres, valkey_server: Valkey) -> None:
    assert given_database(postgres_server.url()) == postgres_server.url()
    assert given_queue(valkey_server.url()) == valkey_server.url()


def test_valkey_keeps_a_queued_message_over_a_kill() -> None:
    with scratch_folder() as folder:
        server = Valkey(folder, password=new_password(), log=folder / "log")
        first = server.start()
        with redis.Redis.from_url(server.url()) as client:
            client.rpush("queue", "shard 1")
            time.sleep(1.1)  # the append-only file reaches the disk once a second
            first.process.send_signal(signal.SIGKILL)
            first.process.wait()
        second = server.start()
        with redis.Redis.from_url(server.url()) as client:
            assert client.lrange("queue", 0, -1) == [b"shard 1"]
        assert second.stop()


def test_valkey_asks_for_its_password(valkey_server: Valkey) -> None:
    client = redis.Redis(port=valkey_server.port, retry=Retry(NoBackoff(), 0))
    with client, pytest.raises(redis.AuthenticationError):
        client.ping()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells a child that its parent died")
def test_servers_end_when_their_starter_is_killed(tmp_path: Path) -> None:
    with scratch_folder() as folder:
        script = (
            "import time; from pathlib import Path\n"
            "from deploy.local.postgres import Postgres; from deploy.local.valkey import Valkey\n"
            f"folder = Path({str(folder)!r})\n"
            "a = Postgres(folder / 'p', password='x', log=folder / 'p.log', is_durable=False); a.start()\n"
            "b = Valkey(folder / 'v', password='x', log=folder / 'v.log'); b.start()\n"
            "print(a.port, b.port, flush=True); time.sleep(60)\n"
        )
        starter = subprocess.Popen([sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True)
        assert starter.stdout is not None
        ports = [int(word) for word in starter.stdout.readline().split()]
        starter.kill()
        starter.communicate()
        deadline = time.monotonic() + 10
        while not all(map(is_port_free, ports)) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert len(ports) == 2
        assert all(map(is_port_free, ports))
        assert not (folder / "p" / "cluster" / "postmaster.pid").exists()
