"""Light with and without what moves, out of two images of few samples with the same random numbers."""

import numpy as np

from blender_scenes.hybrid.denoiser import Denoiser
from symolo.core.arrays import FloatImage


def denoised_pair(
    moved: FloatImage, still: FloatImage, normal: FloatImage, denoised: Denoiser, share: FloatImage
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
        share: (h, w, 3) predicted share of the light that what moves lets through, which is 1 far from it. It guides
            the denoiser as a colour of the floor would, so that it leaves the borders of shadows as they are.
    """
    # A denoiser of light takes no negative values, which are where a thing that moves throws light.
    taken, added = np.maximum(still - moved, 0), np.maximum(moved - still, 0)
    if taken.any():
        taken = denoised(taken, normal, 1 - share if (share < 1).any() else None)
    if added.any():
        added = denoised(added, normal)
    rest = denoised(moved, normal, share)
    return rest, np.maximum(rest + taken - added, 0)
