"""All formats that a release is exported to, in the order in which `--help` names them."""

from pipeline.exporters import coco, kitti, parquet, rerun, tum, webdataset
from pipeline.exporters.base import Exporter

EXPORTERS: tuple[Exporter, ...] = (
    tum.EXPORTER,
    kitti.EXPORTER,
    coco.EXPORTER,
    webdataset.EXPORTER,
    parquet.EXPORTER,
    rerun.EXPORTER,
)
