"""Intel's Open Image Denoise as bpy brings it, with guides of our own.

API: https://www.openimagedenoise.org/documentation.html, "RT" filter.
"""

import ctypes
import importlib.util
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.float32]
_CPU, _FLOAT3, _HIGH, _YES = 1, 3, 6, 1


def denoise(colour: Image, albedo: Image, normal: Image) -> Image:
    """(H, W, 3) linear light without its noise; the guides are taken for free of noise.

    Raises:
        FileNotFoundError: bpy is missing, or brings no such library.
        RuntimeError: The library reports an error.
    """
    library = _library()
    device = library.oidnNewDevice(_CPU)
    library.oidnCommitDevice(device)
    found = library.oidnNewFilter(device, b"RT")
    out = np.empty(colour.shape, np.float32)
    height, width, _ = colour.shape
    kept = {"color": colour, "albedo": albedo, "normal": normal}
    images = {name: np.ascontiguousarray(image, np.float32) for name, image in kept.items()} | {"output": out}
    for name, image in images.items():
        library.oidnSetSharedFilterImage(found, name.encode(), image.ctypes.data, _FLOAT3, width, height, 0, 0, 0)
    library.oidnSetFilterBool(found, b"hdr", _YES)
    library.oidnSetFilterBool(found, b"cleanAux", _YES)
    library.oidnSetFilterInt(found, b"quality", _HIGH)
    library.oidnCommitFilter(found)
    library.oidnExecuteFilter(found)
    message = ctypes.c_char_p()
    failed = library.oidnGetDeviceError(device, ctypes.byref(message))
    text = (message.value or b"").decode()
    library.oidnReleaseFilter(found)
    library.oidnReleaseDevice(device)
    if failed:
        raise RuntimeError(f"Open Image Denoise: {text}")
    return out


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
        "oidnCommitDevice": (None, [pointer]),
        "oidnNewFilter": (pointer, [pointer, text]),
        "oidnSetSharedFilterImage": (None, [pointer, text, pointer, integer, size, size, size, size, size]),
        "oidnSetFilterBool": (None, [pointer, text, ctypes.c_bool]),
        "oidnSetFilterInt": (None, [pointer, text, integer]),
        "oidnCommitFilter": (None, [pointer]),
        "oidnExecuteFilter": (None, [pointer]),
        "oidnGetDeviceError": (integer, [pointer, ctypes.POINTER(text)]),
        "oidnReleaseFilter": (None, [pointer]),
        "oidnReleaseDevice": (None, [pointer]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
