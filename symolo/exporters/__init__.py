"""All formats that a release is exported to, in the order in which `--help` names them."""

from symolo.exporters import (
    coco,
    euroc,
    hdf5,
    huggingface,
    kitti,
    mcap,
    parquet,
    ros1,
    tum,
    webdataset,
    yolo,
)
from symolo.exporters.base import Exporter
from symolo.exporters.lerobot import exporter as lerobot
from symolo.exporters.rerun import exporter as rerun

EXPORTERS: tuple[Exporter, ...] = (
    tum.EXPORTER,
    kitti.EXPORTER,
    euroc.EXPORTER,
    coco.EXPORTER,
    yolo.EXPORTER,
    webdataset.EXPORTER,
    parquet.EXPORTER,
    mcap.EXPORTER,
    ros1.EXPORTER,
    hdf5.EXPORTER,
    huggingface.EXPORTER,
    lerobot.EXPORTER,
    rerun.EXPORTER,
)
