"""Histograms as bytes in a row of the database."""

import io
from dataclasses import fields

import numpy as np

from dropflow.statistics.histograms import FrameHistograms


def pack_histograms(histograms: FrameHistograms) -> bytes:
    """A compressed archive of the arrays."""
    packed = io.BytesIO()
    np.savez_compressed(packed, **{field.name: getattr(histograms, field.name) for field in fields(histograms)})
    return packed.getvalue()


def unpack_histograms(content: bytes) -> FrameHistograms:
    """What `pack_histograms` packed."""
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        return FrameHistograms(**{field.name: arrays[field.name] for field in fields(FrameHistograms)})
