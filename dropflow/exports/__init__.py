"""Results in the forms that other programs read, each with its provenance inside, written in a stream."""

from dropflow.exports.kinds import SUFFIX, Kind
from dropflow.exports.write import export

__all__ = ["SUFFIX", "Kind", "export"]
