"""As whom PostgreSQL runs when we are root, since it refuses to be root itself."""

import os
import pwd
import shutil
import stat
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from deploy.local.errors import LauncherError

# Any account does, as long as the machine knows it by name: initdb looks it up.
CANDIDATES = ("postgres", "nobody")
CAP_DAC_READ_SEARCH = 2  # its bit in the kernel's mask


@dataclass(frozen=True)
class Account:
    """A user of this machine that is not root."""

    name: str
    uid: int
    gid: int

    def own(self, path: Path) -> None:
        os.chown(path, self.uid, self.gid)


def unprivileged_account() -> Account | None:
    """The account to drop to; None where we are no root and stay who we are."""
    if os.geteuid() != 0:
        return None
    if shutil.which("setpriv") is None:
        raise LauncherError(
            "PostgreSQL does not run as root and `setpriv` (util-linux) is missing. Start Dropflow as another user.",
            exit_code=2,
        )
    known = {entry.pw_name: entry for entry in pwd.getpwall()}
    for name in CANDIDATES:
        if name in known:
            return Account(name, known[name].pw_uid, known[name].pw_gid)
    raise LauncherError(
        f"PostgreSQL does not run as root and none of {', '.join(CANDIDATES)} exists. Start Dropflow as another user.",
        exit_code=2,
    )


def switch_to(account: Account | None, paths: Iterable[Path]) -> list[str]:
    """`setpriv` options that become `account`, still able to reach `paths`.

    A checkout or DATA under a closed folder such as /root is out of another user's reach. One capability lets the
    server pass through; it is given only then. Keeping it over the change of user, and in the access() checks that
    PostgreSQL makes of its own files, needs the securebit.
    """
    if account is None:
        return []
    options = ["--reuid", str(account.uid), "--regid", str(account.gid), "--clear-groups"]
    if all(is_reachable_by_all(path) for path in paths):
        return options
    capability = _passing_capability()
    return [
        *("--securebits", "+no_setuid_fixup", *options),
        *("--inh-caps", f"+{capability}", "--ambient-caps", f"+{capability}"),
    ]


def is_reachable_by_all(path: Path) -> bool:
    """Whether every folder above `path` lets anybody pass."""
    return all(parent.stat().st_mode & stat.S_IXOTH for parent in path.resolve().parents)


def _passing_capability() -> str:
    """The smaller capability to search closed folders; root in a container often has only the larger one."""
    status = Path("/proc/self/status").read_text()
    effective = int(next(line for line in status.splitlines() if line.startswith("CapEff")).split()[1], 16)
    return "dac_read_search" if effective & (1 << CAP_DAC_READ_SEARCH) else "dac_override"
