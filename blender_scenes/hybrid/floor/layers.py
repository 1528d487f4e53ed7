"""What lies on the floor, in texels of the map of the reflectance: lines on sheets on the floor.

A texel is sampled in its middle. Where an edge crosses it, it would have one colour or the other, and the edge would be
jagged. There the texel mixes the colours around it by the shares of it that the layers cover, in closed form.
"""

from collections.abc import Sequence

import cv2
import numpy as np

from blender_scenes.hybrid.floor.footprints import covered
from blender_scenes.hybrid.floor.tiled_map import Tile
from blender_scenes.scene.description import Mesh
from symolo.core.arrays import Array, FloatImage

_BORDER = 1e-3
"""Share from which on a texel counts as one that an edge crosses."""


class FloorLayers:
    """Line and sheets on the floor, in their order from the top downwards."""

    def __init__(self, meshes: Sequence[Mesh], turn_rad: float) -> None:
        """Take the mesh named "floor" and those of the line upon it, as the scene has them.

        Args:
            meshes: Meshes with faces counter-clockwise seen from above. The first face of the floor is the floor
                itself; its other surfaces are those of sheets.
            turn_rad: Angle of the tiles in W.
        """
        (floor,) = (mesh for mesh in meshes if mesh.name == "floor")
        line = [mesh for mesh in meshes if mesh is not floor]
        names = list(dict.fromkeys(name for mesh in meshes for name in mesh.face_surface))
        sheets = set(floor.face_surface) - {floor.face_surface[0]}
        lines = {name for mesh in line for name in mesh.face_surface}
        from_W = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
        self._layers = [
            (np.concatenate([np.zeros((0, 2, 2)), *(_edges(mesh, on_top) for mesh in these)]) @ from_W, numbers)
            for these, on_top in ((line, lines), ([floor], sheets))
            if (numbers := [names.index(name) for name in sorted(on_top)])
        ]
        """Edges (K, 2, 2) in the coordinates of the tiles, and numbers of the surfaces, from the top downwards."""

    def blended(self, tile: Tile, values: FloatImage, numbers: FloatImage) -> FloatImage:
        """Return the texels (N, N, K) of a tile, with a mixture where an edge crosses one.

        Args:
            tile: Tile.
            values: Samples (N+2, N+2, K) in the middle of the texels of the widened tile.
            numbers: Numbers (N+2, N+2) of the surfaces there, as `meshes` has them one after the other.
        """
        covers = [covered(edges, tile) for edges, _ in self._layers]
        inner = values[1:-1, 1:-1]
        crossed = np.any([(cover > _BORDER) & (cover < 1 - _BORDER) for cover in covers], axis=0)
        if not crossed.any():
            return inner
        upper = [np.isin(numbers, surfaces) for _, surfaces in self._layers]
        left, total, weights = np.ones_like(crossed, np.float32), np.zeros_like(inner), np.float32(1e-6)
        for cover, shown in zip([*covers, 1.0], [*upper, ~np.any(upper, axis=0)], strict=True):
            if shown.any():
                total = total + left * cover * _around(values, shown)
                weights = weights + left * cover
            left = left * (1 - cover)
        return np.where(crossed, total / weights, inner).astype(np.float32)


def _edges(mesh: Mesh, names: set[str]) -> Array:
    """Return begin and end (K, 2, 2) of the edges around the faces of some surfaces; faces may share edges."""
    faces = [face for face, name in zip(mesh.faces, mesh.face_surface, strict=True) if name in names]
    pairs = {pair for face in faces for pair in zip(face, (*face[1:], face[0]), strict=True)}
    around = [pair for pair in sorted(pairs) if pair[::-1] not in pairs]
    return np.array(mesh.vertices)[np.array(around, int).reshape(-1, 2), :2]


def _around(values: FloatImage, shown: np.ndarray) -> FloatImage:
    """Return the mean (N, N, K) of those of 3 x 3 samples (N+2, N+2, K) that count, or of all that count in the tile.

    The second is for a gap between two tapes that lies between the samples.
    """
    chosen = np.concatenate([np.where(shown[..., None], values, 0), shown[..., None]], axis=-1).astype(np.float32)
    sums = cv2.boxFilter(chosen, -1, (3, 3), normalize=False)[1:-1, 1:-1]
    count = sums[..., -1:]
    return np.where(count > 0, sums[..., :-1] / np.maximum(count, 1), values[shown].mean(axis=0))
