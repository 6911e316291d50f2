"""What keeps objects in the store for a while, although no row needs them any more."""

KEEP_OBJECTS = 0x64726F70666C6F77
"""Advisory lock: backups share it while they copy; who removes objects takes it alone, or leaves them for later."""
