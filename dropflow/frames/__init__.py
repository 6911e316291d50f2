"""Any image stack as lazy frames: one reader a file, one contract (`dropflow.frames.contract.Frames`)."""

from dropflow.frames.choice import Choice
from dropflow.frames.contract import Files, Frame, Frames, Times
from dropflow.frames.findings import Finding
from dropflow.frames.opening import open_frames, open_image, stack_files

__all__ = ["Choice", "Files", "Finding", "Frame", "Frames", "Times", "open_frames", "open_image", "stack_files"]
