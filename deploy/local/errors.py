"""Why an instance cannot start or go on, each said in one line."""


class LauncherError(Exception):
    """Something the person who started us can mend. `exit_code` is 2 where nothing was started."""

    def __init__(self, message: str, *, exit_code: int = 1) -> None:
        super().__init__(message)
        self.exit_code = exit_code
