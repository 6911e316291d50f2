"""Results in the forms that other programs read, each with its provenance inside, written in a stream."""
