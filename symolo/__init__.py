"""Datasets in Python: `symolo.load(path)`; docs/reader.md.

The name that people import stands above `pipeline`, where the reader lives, for the exporters there use it too.
"""

from configs.errors import EnvironmentLacking, InputError
from pipeline.reader.dataset import Dataset, load
from pipeline.reader.image import Image
from pipeline.reader.run import Run
from pipeline.reader.torch_frames import Frame, torch_dataset

__all__ = ["Dataset", "EnvironmentLacking", "Frame", "Image", "InputError", "Run", "load", "torch_dataset"]
