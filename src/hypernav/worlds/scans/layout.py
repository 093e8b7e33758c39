"""The files of a scanned building, with the names of HM3D and Matterport3D.

HM3D: ``00802-wcojb4TFT35/`` with ``wcojb4TFT35.basis.glb`` (textures compressed) or
``wcojb4TFT35.glb``, ``wcojb4TFT35.basis.navmesh``, ``wcojb4TFT35.semantic.glb`` and
``wcojb4TFT35.semantic.txt``. Matterport3D: ``17DRP5sb8fy/`` with ``17DRP5sb8fy.glb``, ``.navmesh``,
``.house`` and ``17DRP5sb8fy_semantic.ply``.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from hypernav.worlds.scenes.loading import OBJECTS_FILE

HOUSE_SUFFIX = ".house"
"""Suffix of Matterport3D's annotation."""

_SCENE = re.compile(r"(?P<stem>.+?)(?:\.basis)?\.glb", re.IGNORECASE)


@dataclass(frozen=True)
class ScanFiles:
    """The files of one scan.

    Attributes:
        mesh: Triangles and textures.
        semantic_mesh: Triangles with the marks of their instances; None if there is none.
        semantic_text: Instance and category of every mark; None if there is none.
        navmesh: Walkable surface as Habitat computed it; None if there is none.
    """

    mesh: Path
    semantic_mesh: Path | None = None
    semantic_text: Path | None = None
    navmesh: Path | None = None

    @staticmethod
    def of(mesh: Path) -> "ScanFiles | None":
        """The files of a scan; None for a scene that is not a scan.

        Args:
            mesh: Path of a scene's file.
        """
        match = _SCENE.fullmatch(mesh.name)
        if match is None:
            return None
        stem, folder = match["stem"], mesh.parent
        is_hm3d = (
            mesh.name.lower().endswith(".basis.glb")
            or re.fullmatch(rf"\d{{5}}-{re.escape(stem)}", folder.name) is not None
            or _there(folder / f"{stem}.semantic.txt") is not None
        )
        if _there(folder / OBJECTS_FILE) is not None:
            return None  # our export, y up, with the annotation for Habitat
        house = _there(folder / f"{stem}{HOUSE_SUFFIX}")
        if not is_hm3d and house is None:
            return None
        return ScanFiles(
            mesh,
            _there(folder / (f"{stem}.semantic.glb" if is_hm3d else f"{stem}_semantic.ply")),
            _there(folder / f"{stem}.semantic.txt") if is_hm3d else house,
            _there(folder / f"{stem}.basis.navmesh") or _there(folder / f"{stem}.navmesh"),
        )


def _there(path: Path) -> Path | None:
    return path if path.is_file() else None
