"""`dropflow-server restore FOLDER`: a backup into an empty database and an empty object store."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from alembic import command
from alembic.util import CommandError
from sqlalchemy import Engine, inspect

from backend.operations.backup import FORM, MANIFEST, OBJECTS, Report, listed, moments_of
from backend.operations.errors import OperationError
from backend.operations.migrated import alembic_config
from backend.operations.tables import VERSION_TABLE, checksum, follow_identities, read_table, table_names
from backend.platform.object_store import ObjectStore


def restore(
    engine: Engine, store: ObjectStore, folder: Path, *, moment: str | None = None, report: Report
) -> dict[str, Any]:
    """Bring back a backup (the newest, or that of `moment`) and return its manifest.

    Everything is checked before anything is written. The database takes all or nothing; objects that an interrupted
    restore has brought are kept and the rest follow when it is asked again.

    Raises
    ------
    OperationError
        There is no such backup, it is damaged or of a later version, or there is data where it should go.
    """
    chosen = _choose(folder, moment)
    manifest: dict[str, Any] = json.loads((chosen / MANIFEST).read_text(encoding="utf-8"))
    _check(folder, chosen, manifest)
    _check_empty(engine)
    _restore_objects(store, folder / OBJECTS, chosen, report)
    _restore_database(engine, chosen, manifest, report)
    return manifest


def _choose(folder: Path, moment: str | None) -> Path:
    moments = moments_of(folder)
    if moment is not None:
        moments = [path for path in moments if path.name == moment]
    if not moments:
        raise OperationError(f"There is no finished backup{f' {moment}' if moment else ''} in {folder}.")
    return moments[-1]


def _check(folder: Path, moment: Path, manifest: Mapping[str, Any]) -> None:
    if manifest["form"] != FORM:
        raise OperationError(f"This backup is of Dropflow {manifest['version']}; restore it with that or a later.")
    for name, table in manifest["tables"].items():
        file = moment / "database" / f"{name}.copy"
        if not file.is_file() or checksum(file) != table["sha256"]:
            raise OperationError(f"{file} is damaged. Use another moment (--moment).")
    for size, key in listed(moment):
        file = folder / OBJECTS / key
        if not file.is_file() or file.stat().st_size != size:
            raise OperationError(f"{file} is missing or not of {size} bytes. Use another moment (--moment).")


def _check_empty(engine: Engine) -> None:
    with engine.connect() as connection:
        tables = [name for name in inspect(connection).get_table_names() if name != VERSION_TABLE]
        # A database that was only migrated is as good as empty; a fresh service has made its own person and group.
        if "experiment" in tables and connection.exec_driver_sql("SELECT 1 FROM experiment LIMIT 1").first():
            raise OperationError("The database has experiments already. Restore into an empty one.")


def _restore_objects(store: ObjectStore, source: Path, moment: Path, report: Report) -> None:
    there = dict(store.list(""))
    wanted = list(listed(moment))
    for number, (size, key) in enumerate(wanted, 1):
        if there.get(key) != size:
            store.put(key, source / key)
        if number % 1000 == 0:
            report(f"objects: {number:,} of {len(wanted):,}")
    report(f"objects: {len(wanted):,}")


def _restore_database(engine: Engine, moment: Path, manifest: Mapping[str, Any], report: Report) -> None:
    config = alembic_config()
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        # One transaction for all of it: tables as they were then, their rows, and the steps to this version's form.
        connection.exec_driver_sql("DROP SCHEMA public CASCADE")
        connection.exec_driver_sql("CREATE SCHEMA public")
        try:
            command.upgrade(config, manifest["revision"])
        except CommandError:
            raise OperationError(
                f"This version does not know the backup's form {manifest['revision']}: "
                f"restore it with Dropflow {manifest['version']} or a later one."
            ) from None
        for name in table_names(connection):
            connection.exec_driver_sql(f'TRUNCATE "{name}" CASCADE')
        for name in table_names(connection):
            if name in manifest["tables"]:
                n_rows = read_table(connection, name, moment / "database" / f"{name}.copy")
                expected = manifest["tables"][name]["rows"]
                if n_rows != expected:
                    raise OperationError(f"Table {name} has {n_rows} rows instead of {expected}.")
                follow_identities(connection, name)
        command.upgrade(config, "head")
    report(f"database: {len(manifest['tables'])} tables")
