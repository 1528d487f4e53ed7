"""Formats that a release is exported to: a module for each, with its `EXPORTER`."""

FORMATS = (
    "tum",
    "kitti",
    "euroc",
    "coco",
    "yolo",
    "webdataset",
    "parquet",
    "mcap",
    "ros1",
    "hdf5",
    "huggingface",
    "lerobot",
    "rerun",
)
"""Names of the formats and of their modules, in the order in which `--help` lists them."""
