"""What can go wrong in operations, each said in one line."""


class OperationError(Exception):
    """Why a command did not do what it was asked for, and what to do."""
