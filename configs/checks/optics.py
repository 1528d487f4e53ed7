"""What is wrong with the lens of a camera, whether it is that of data.csv or a further one."""

from collections.abc import Iterator

from configs.validation.faults import ConfigFault
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.lens import NO_DISTORTION, CameraOptics, coefficients, lens_problem


def optics_faults(camera: CameraOptics, width_px: int, height_px: int) -> Iterator[ConfigFault]:
    """Yield why no image of this size can be made through the lens of a camera; paths begin at the camera."""
    names, values = ("k1", "k2", "p1", "p2", "k3"), coefficients(camera)
    field, cure = "distortion", "take smaller coefficients, a longer focal_length_mm or a smaller sensor_width_mm"
    if camera.fisheye is not None:
        if values != NO_DISTORTION:
            problem = "it is that of a pinhole camera, but the camera has a fisheye lens"
            cure = "the coefficients of a fisheye lens are fisheye.k1 to fisheye.k4"
            yield ConfigFault(("distortion",), problem, cure=cure)
        names, values = ("k1", "k2", "k3", "k4"), Fisheye.from_settings(camera.fisheye).k
        field, cure = "fisheye", "take smaller coefficients or a narrower field of view"
    if problem := lens_problem(camera, width_px, height_px):
        got = ", ".join(f"{name} {value:g}" for name, value in zip(names, values, strict=True) if value)
        yield ConfigFault((field,), problem, got=got, cure=cure)
