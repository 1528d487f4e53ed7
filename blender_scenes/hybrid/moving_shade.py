"""Light with and without what moves, out of two images of few samples with the same random numbers."""

import numpy as np

from blender_scenes.hybrid.denoiser import Denoiser
from symolo.core.arrays import FloatImage


def denoised_pair(
    moved: FloatImage, still: FloatImage, normal: FloatImage, denoised: Denoiser
) -> tuple[FloatImage, FloatImage]:
    """Return light (h, w, 3) with and without what moves, without noise.

    Where nothing that moves matters, both images have the same noise, so their difference is 0 without any. It is
    denoised in place of the second image: otherwise, their ratio would have the errors of two denoised images there,
    which differ, because the denoiser treats the noise of a pixel by what is around it.

    Args:
        moved: Light with what moves.
        still: Light without it.
        normal: Normals (h, w, 3) of the surfaces.
        denoised: Denoiser.
    """
    # A denoiser of light takes no negative values, which are where a thing that moves throws light.
    taken, added = (
        denoised(part, normal) if part.any() else part
        for part in (np.maximum(still - moved, 0), np.maximum(moved - still, 0))
    )
    rest = denoised(moved, normal)
    return rest, np.maximum(rest + taken - added, 0)
