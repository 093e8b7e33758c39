"""Light around surfaces, and their colours as shown (NVIDIA Warp's functions).

The formulas are those of `light_kernels`.
"""

import warp as wp

from hypernav.worlds.drawing.base_color_kernels import FLAG_UNLIT
from hypernav.worlds.drawing.warp_surface_kernels import Surface, Triangles, base_color

UNLIT = wp.constant(FLAG_UNLIT)


@wp.struct
class LightNodes:
    """The nodes of a light grid, see `LightGrid`: x runs fastest, then y, then z.

    Their coordinates are those of `LightGrid` to the last bit: the scene's lowest corner is a node,
    and a surface that a node lies on shades both sides of it.
    """

    cell_m: float
    x: wp.array(dtype=float)
    y: wp.array(dtype=float)
    z: wp.array(dtype=float)
    light: wp.array(dtype=wp.uint8, ndim=2)  # six sides of every node
    asked: wp.array(dtype=int)  # 1 where a node's light is known, or is listed to be computed


@wp.struct
class LightRays:
    """The rays by which a node's light is found, see `light_grid`."""

    directions: wp.array(dtype=wp.vec3)
    sky: wp.array(dtype=float)
    reach_m: float
    contrast: float


@wp.struct
class Look:
    """How light becomes colours, see `light_kernels.light`."""

    ambient: float
    headlight: float
    tone: wp.array(dtype=wp.uint8)
    background: wp.vec3ub


@wp.func
def grid_position(nodes: LightNodes, surface: Surface) -> wp.vec3:
    """Where a surface reads the light grid, in cells."""
    n = surface.normal
    # So far in front of the surface that no node behind it has any weight.
    lift = wp.abs(n[0]) + wp.abs(n[1]) + wp.abs(n[2])
    origin = wp.vec3(nodes.x[0], nodes.y[0], nodes.z[0])
    at = (surface.point - origin) / nodes.cell_m + n * lift
    return wp.vec3(
        wp.clamp(at[0], 0.0, float(nodes.x.shape[0]) - 1.001),
        wp.clamp(at[1], 0.0, float(nodes.y.shape[0]) - 1.001),
        wp.clamp(at[2], 0.0, float(nodes.z.shape[0]) - 1.001),
    )


@wp.func
def node_number(nodes: LightNodes, x: int, y: int, z: int) -> int:
    """Number of a node."""
    return (z * nodes.y.shape[0] + y) * nodes.x.shape[0] + x


@wp.func
def node_light(nodes: LightNodes, node: int, normal: wp.vec3) -> float:
    """Light that falls from one node on a surface with this normal, 0 to 255."""
    x_side = wp.where(normal[0] > 0.0, nodes.light[node, 0], nodes.light[node, 1])
    y_side = wp.where(normal[1] > 0.0, nodes.light[node, 2], nodes.light[node, 3])
    z_side = wp.where(normal[2] > 0.0, nodes.light[node, 4], nodes.light[node, 5])
    return (
        normal[0] * normal[0] * float(x_side)
        + normal[1] * normal[1] * float(y_side)
        + normal[2] * normal[2] * float(z_side)
    )


@wp.func
def ambient_light(nodes: LightNodes, surface: Surface) -> float:
    """Light of the eight nodes around a surface, 0 to 255."""
    at = grid_position(nodes, surface)
    x, y, z = int(at[0]), int(at[1]), int(at[2])
    total = float(0.0)
    for corner in range(8):
        right, back, up = corner & 1, wp.rshift(corner, 1) & 1, wp.rshift(corner, 2)
        weight = wp.abs(float(1 - right) - at[0] + float(x))
        weight *= wp.abs(float(1 - back) - at[1] + float(y))
        weight *= wp.abs(float(1 - up) - at[2] + float(z))
        node = node_number(nodes, x + right, y + back, z + up)
        total += weight * node_light(nodes, node, surface.normal)
    return total


@wp.func
def linear_of(code: float) -> float:
    """Light of an sRGB code, 0 to 255: a polynomial within 0.002 of the standard's curve."""
    c = code / 255.0
    return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878)


@wp.func
def shown(scene: Triangles, nodes: LightNodes, look: Look, face: int, surface: Surface) -> wp.vec3i:
    """SRGB codes of a surface as lit and as shown, see `light_kernels.light`."""
    color = base_color(scene, face, surface)
    if (int(scene.flags[scene.material[face]]) & UNLIT) != 0:
        return wp.vec3i(
            int(wp.min(color[0] + 0.5, 255.0)),
            int(wp.min(color[1] + 0.5, 255.0)),
            int(wp.min(color[2] + 0.5, 255.0)),
        )
    shine = look.ambient * ambient_light(nodes, surface) / 255.0 + look.headlight * surface.facing
    last = look.tone.shape[0] - 1
    codes = wp.vec3i(0, 0, 0)
    for channel in range(3):
        step = int(shine * linear_of(color[channel]) * float(last) + 0.5)
        codes[channel] = int(look.tone[wp.clamp(step, 0, last)])
    return codes
