"""Contradictions in a look: floors without an image, windows that do not fit, and rooms without light."""

from collections.abc import Iterator

from configs.schema.appearance.camera_look import CameraLook
from configs.schema.appearance.look import LookConfig
from configs.validation.faults import ConfigFault
from symolo.core.yaml.tree import FieldPath

LINTEL_M = 0.1
"""Smallest height of wall between a window and the ceiling; a window that is too high is made lower."""
MIN_WINDOW_M = 0.2


def exposure_faults(camera: CameraLook) -> Iterator[ConfigFault]:
    """Yield a manual exposure that takes no time."""
    if camera.manual_exposure is not None and not camera.exposure_time_s:
        allowed = "more than 0 with manual_exposure, such as 0.01 for 1/100 s"
        path: FieldPath = ("look", "camera", "exposure_time_s")
        yield ConfigFault(path, got=camera.exposure_time_s, allowed=allowed, against=(*path[:2], "manual_exposure"))


def _gain_faults(camera: CameraLook) -> Iterator[ConfigFault]:
    """Yield an ISO speed at which the sensor would be full before white."""
    manual = camera.manual_exposure
    if manual is not None and manual.iso < manual.base_iso:
        path: FieldPath = ("look", "camera", "manual_exposure", "iso")
        allowed = f"at least the base_iso of {manual.base_iso:g}, at which the sensor is full when it is white"
        cure = "for darker images, make exposure_time_s shorter; if the sensor has a lower base ISO, set base_iso"
        yield ConfigFault(path, got=manual.iso, allowed=allowed, against=(*path[:3], "base_iso"), cure=cure)


def look_faults(look: LookConfig) -> Iterator[ConfigFault]:
    """Yield what is wrong with a look, whatever arena it shows."""
    if look.floor.material == "image" and look.floor.image.file is None:
        cure = "name an image in the folder of look.assets, or choose another look.floor.material"
        yield ConfigFault(("look", "floor", "image", "file"), "missing, because the floor is an image", cure=cure)
    yield from exposure_faults(look.camera)
    yield from _gain_faults(look.camera)
    max_sill_m = look.room.height_m - LINTEL_M - MIN_WINDOW_M
    if look.window.sill_m > max_sill_m + 1e-9:
        problem = "the window does not fit below the ceiling"
        allowed = f"at most {max_sill_m:.6g}, room.height_m less {MIN_WINDOW_M} of window and {LINTEL_M} of wall"
        against: FieldPath = ("look", "room", "height_m")
        yield ConfigFault(("look", "window", "sill_m"), problem, look.window.sill_m, allowed, against=against)
    lamps = look.lamps.rows * look.lamps.flux_klm
    lamps += min(look.desk_lamps.count, look.room.furniture.tables) * look.desk_lamps.flux_klm
    if not (lamps or look.sun.illuminance_klx or look.sky.luminance_kcd_m2):
        allowed = "a value above 0 for lamps.rows and lamps.flux_klm, sun.illuminance_klx or sky.luminance_kcd_m2, "
        allowed += "or a desk lamp and a table for it"
        yield ConfigFault(("look", "lamps"), "there is no light", allowed=allowed)
