"""Intel's Open Image Denoise in the build of bpy, with our guides.

Blender offers it only for its own passes. API: https://www.openimagedenoise.org/documentation.html, "RT" filter.
"""

import ctypes
import importlib.util
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np

from blender_scenes.render.lost_light import lost_light_factor
from symolo.core.arrays import FloatImage

_CPU, _FLOAT3 = 1, 3
_QUALITIES = {"BALANCED": 5, "HIGH": 6}
_INPUTS = ("color", "albedo", "normal")


class Denoiser:
    """A denoiser of images with guides that have no noise.

    It keeps a filter with its buffers for each image size, because a new filter takes more time than its use.
    """

    def __init__(self, threads: int, quality: Literal["BALANCED", "HIGH"]) -> None:
        """Load the library; raise FileNotFoundError if bpy or the library is missing."""
        self._library, self._quality = _library(), _QUALITIES[quality]
        self._device = self._library.oidnNewDevice(_CPU)
        self._library.oidnSetDeviceInt(self._device, b"numThreads", threads)
        self._library.oidnSetDeviceBool(self._device, b"setAffinity", False)  # noqa: FBT003 - a C function's
        self._library.oidnCommitDevice(self._device)
        self._filters: dict[tuple[int, ...], tuple[int, dict[str, FloatImage]]] = {}

    def __call__(self, light: FloatImage, normal: FloatImage, albedo: FloatImage | None = None) -> FloatImage:
        """Return linear light (H, W, 3) without its noise; an albedo of None is white.

        Raises:
            RuntimeError: The library reports an error.
        """
        denoise, images = self._filter(light.shape)
        white = np.float32(1.0)
        for name, image in zip(_INPUTS, (light, white if albedo is None else albedo, normal), strict=True):
            images[name][...] = image
        self._library.oidnExecuteFilter(denoise)
        self._require_success()
        return images["output"].copy()

    def keeping_mean(
        self,
        light: FloatImage,
        normal: FloatImage,
        albedo: FloatImage | None = None,
        weight: FloatImage | None = None,
    ) -> FloatImage:
        """Return the same with the mean that the light has with its noise, or nearly so (`lost_light_factor`).

        It is the mean of the light times `weight` (H, W, 3), over all pixels with a weight; None is 1.
        """
        even = self(light, normal, albedo)
        if weight is None:
            return even * np.float32(lost_light_factor(light, even))
        counts = weight.any(axis=-1)
        before, after = (weight[counts] * each[counts] for each in (light, even))
        return even * np.float32(lost_light_factor(before, after)) if counts.any() else even

    def _filter(self, shape: tuple[int, ...]) -> tuple[int, dict[str, FloatImage]]:
        if shape not in self._filters:
            height, width, _ = shape
            images = {name: np.zeros(shape, np.float32) for name in (*_INPUTS, "output")}
            new = self._library.oidnNewFilter(self._device, b"RT")
            for name, image in images.items():
                place = name.encode(), image.ctypes.data, _FLOAT3
                self._library.oidnSetSharedFilterImage(new, *place, width, height, 0, 0, 0)
            # cleanAux: our guides have no noise, so the filter may follow their detail exactly.
            for name in (b"hdr", b"cleanAux"):
                self._library.oidnSetFilterBool(new, name, True)  # noqa: FBT003 - a C function's
            self._library.oidnSetFilterInt(new, b"quality", self._quality)
            self._library.oidnCommitFilter(new)
            self._require_success()
            self._filters[shape] = new, images
        return self._filters[shape]

    def _require_success(self) -> None:
        message = ctypes.c_char_p()
        if self._library.oidnGetDeviceError(self._device, ctypes.byref(message)):
            raise RuntimeError(f"Open Image Denoise: {(message.value or b'').decode()}")


@cache
def _library() -> ctypes.CDLL:
    spec = importlib.util.find_spec("bpy")
    if spec is None or spec.origin is None:
        raise FileNotFoundError("bpy is missing; run ./setup")
    paths = sorted((Path(spec.origin).parent / "lib").glob("libOpenImageDenoise.so*"))
    if not paths:
        raise FileNotFoundError(f"{Path(spec.origin).parent / 'lib'} has no libOpenImageDenoise.so")
    library = ctypes.CDLL(str(paths[0]))
    pointer, size, integer, text = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_char_p
    signatures = {
        "oidnNewDevice": (pointer, [integer]),
        "oidnSetDeviceInt": (None, [pointer, text, integer]),
        "oidnSetDeviceBool": (None, [pointer, text, ctypes.c_bool]),
        "oidnCommitDevice": (None, [pointer]),
        "oidnNewFilter": (pointer, [pointer, text]),
        "oidnSetSharedFilterImage": (None, [pointer, text, pointer, integer, size, size, size, size, size]),
        "oidnSetFilterBool": (None, [pointer, text, ctypes.c_bool]),
        "oidnSetFilterInt": (None, [pointer, text, integer]),
        "oidnCommitFilter": (None, [pointer]),
        "oidnExecuteFilter": (None, [pointer]),
        "oidnGetDeviceError": (integer, [pointer, ctypes.POINTER(text)]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
