"""Ray casting: the first triangle that a ray into a scene meets."""

from typing import Any

import numpy as np
from jaxtyping import Float32, Int32

from hypernav.core.errors import MissingExtraError
from hypernav.worlds.scenes.scene import Scene


class RayCaster:
    """Embree's search tree over all triangles of a scene. Safe to use from several threads."""

    def __init__(self, scene: Scene) -> None:
        """Build the tree.

        Raises:
            MissingExtraError: The package embreex is not installed.
        """
        try:
            from embreex.mesh_construction import TriangleMesh
            from embreex.rtcore_scene import EmbreeScene
        except ModuleNotFoundError as error:
            raise MissingExtraError(
                "the simulator needs the package 'embreex', which is not installed (it has no "
                "build for Linux on ARM); everything but the simulator works without it; "
                "elsewhere try: pip install embreex"
            ) from error
        # Embree's robust mode costs a fifth more and shows the same instance in every pixel.
        self._tree: Any = EmbreeScene()
        self._face_instance = scene.face_instance
        TriangleMesh(self._tree, scene.vertices, scene.faces)
        # The tree is built on the first use, which must not happen in two threads at once.
        self.faces(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))

    def faces(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> Int32[np.ndarray, "rays"]:
        """First triangle that each ray meets, -1 where it meets none."""
        return self._tree.run(origins, directions)

    def instances(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> Int32[np.ndarray, "rays"]:
        """First instance that each ray meets, -1 where it meets none."""
        faces = self.faces(origins, directions)
        return np.where(faces >= 0, self._face_instance[faces], np.int32(-1))

    def distances(
        self,
        origins: Float32[np.ndarray, "rays 3"],
        directions: Float32[np.ndarray, "rays 3"],
        reach_m: float,
    ) -> Float32[np.ndarray, "rays"]:
        """Distance to the first triangle in lengths of the direction, at most `reach_m`."""
        reach = np.full(len(origins), reach_m, dtype=np.float32)
        return self._tree.run(origins, directions, reach, query="DISTANCE")
