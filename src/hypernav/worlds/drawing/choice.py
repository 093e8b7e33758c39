"""The renderer of a scene, chosen by name."""

from hypernav.worlds.config import RendererName
from hypernav.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.worlds.drawing.warp_renderer import WarpRenderer
from hypernav.worlds.scenes.scene import Scene

SceneRenderer = CpuRenderer | WarpRenderer


def renderer_of(
    scene: Scene, name: RendererName, config: RenderConfig | None = None
) -> SceneRenderer:
    """A renderer of a scene.

    Args:
        scene: Scene to draw.
        name: Which renderer.
        config: How it draws.

    Raises:
        MissingExtraError: A package that it needs is not installed.
    """
    return WarpRenderer(scene, config) if name == "warp" else CpuRenderer(scene, config)
