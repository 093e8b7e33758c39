"""Drawing by rays on a GPU, or on the CPU where there is none (NVIDIA Warp's kernels).

A frame takes four passes: `find_surfaces`, `want_light`, `bake_light`, `shade`. Cameras are those
of `warp_surface_kernels`, [views, 4]; offsets are those of the rays of a pixel from its centre,
``(right, down)`` in pixels, [samples]. The formulas of light are those of `shading_kernels`.
"""

import warp as wp

from hypernav.simulator.worlds.drawing.shading_kernels import FLAG_CUTOUT, FLAG_UNLIT
from hypernav.simulator.worlds.drawing.warp_surface_kernels import (
    Surface,
    Triangles,
    base_color,
    depth_of,
    direction_of,
    is_hole,
    is_through,
    surface_of,
)

UNLIT = wp.constant(FLAG_UNLIT)
_FAR = wp.constant(1e6)
_LAYERS = wp.constant(32)
"""Holes and backs of triangles that one ray may pass."""
_BEYOND = wp.constant(1e-4)
"""Metres beyond what a ray has passed, at depth 0 and for every metre of it, where it goes on."""
_BEFORE_M = wp.constant(2e-6)
"""Metres before a node where its rays begin."""
_CUTOUT = wp.constant(FLAG_CUTOUT)


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
    """The rays by which a node's light is found, see `shading.LightGrid`."""

    directions: wp.array(dtype=wp.vec3)
    sky: wp.array(dtype=float)
    reach_m: float
    contrast: float


@wp.struct
class Look:
    """How light becomes colours, see `shading_kernels.light`."""

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
    """SRGB codes of a surface as lit and as shown, see `shading_kernels.light`."""
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


wp.set_module_options({"enable_backward": False})


@wp.func
def front_near(
    scene: Triangles,
    cameras: wp.array(dtype=wp.vec3, ndim=2),
    view: int,
    ray: wp.vec3,
    depth: float,
    reach: float,
) -> int:
    """The nearest front of a triangle at a depth or little beyond, -1 if there is none.

    Triangles may lie on each other back to back, and a ray that meets one of them has to go on
    from beyond both.
    """
    at = cameras[view, 0] + depth * ray
    box = wp.vec3(2.0 * reach * wp.length(ray))
    near = wp.mesh_query_aabb(scene.mesh, at - box, at + box)
    found = int(-1)
    nearest = float(depth + reach)
    face = int(0)
    while wp.mesh_query_aabb_next(near, face):
        if is_through(scene, cameras, view, face, ray):
            own = depth_of(scene, cameras, view, face, ray)
            if own >= depth - reach and own <= nearest:
                found = face
                nearest = own
    return found


@wp.kernel
def find_surfaces(
    scene: Triangles,
    cameras: wp.array(dtype=wp.vec3, ndim=2),
    cx: float,
    cy: float,
    offsets: wp.array(dtype=wp.vec2),
    faces: wp.array(dtype=int, ndim=4),
    depth: wp.array(dtype=float, ndim=3),
    ids: wp.array(dtype=int, ndim=3),
):
    """First pass: the triangle that every ray shows, and depth and instance of every pixel.

    Args:
        scene: The scene.
        cameras: See this module.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        offsets: See this module; the first is the centre.
        faces: Output: triangles, -1 for none, [views, height, width, samples].
        depth: Output: depth along the optical axis, 0 where nothing is hit, [views, height, width].
        ids: Output: instances, -1 where nothing is hit, [views, height, width].
    """
    view, row, column, sample = wp.tid()
    x = float(column) + 0.5 + offsets[sample][0] - cx
    y = float(row) + 0.5 + offsets[sample][1] - cy
    ray = direction_of(cameras, view, x, y)
    shown_face = int(-1)
    shown_depth = float(0.0)
    start = float(0.0)
    for _ in range(_LAYERS):
        hit = wp.mesh_query_ray(scene.mesh, cameras[view, 0] + start * ray, ray, _FAR)
        if not hit.result:
            break
        face = hit.face
        signed = depth_of(scene, cameras, view, face, ray)
        beyond = _BEYOND * (1.0 + wp.abs(signed))
        if scene.one_sided and signed < 0.0:
            front = front_near(scene, cameras, view, ray, -signed, beyond)
            if front >= 0:
                face = front
                signed = depth_of(scene, cameras, view, face, ray)
        passes = bool(scene.one_sided and signed < 0.0)
        material = scene.material[face]
        if not passes and (int(scene.flags[material]) & _CUTOUT) != 0:
            surface = surface_of(scene, cameras, view, face, ray, wp.abs(signed))
            passes = is_hole(scene, material, surface.uv)
        if not passes:
            shown_face = face
            shown_depth = wp.abs(signed)
            break
        start += hit.t + beyond
    faces[view, row, column, sample] = shown_face
    if sample == 0:
        depth[view, row, column] = shown_depth
        ids[view, row, column] = -1
        if shown_face >= 0:
            ids[view, row, column] = scene.instance[shown_face]


@wp.kernel
def want_light(
    scene: Triangles,
    nodes: LightNodes,
    cameras: wp.array(dtype=wp.vec3, ndim=2),
    cx: float,
    cy: float,
    offsets: wp.array(dtype=wp.vec2),
    faces: wp.array(dtype=int, ndim=4),
    wanted: wp.array(dtype=int),
    count: wp.array(dtype=int),
):
    """Second pass: list the nodes of light that are needed and not known, each once.

    Args:
        scene: The scene.
        nodes: Its light.
        cameras: See this module.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        offsets: See this module.
        faces: From `find_surfaces`.
        wanted: Output: numbers of nodes, in any order, [nodes].
        count: How many there are, [1]; 0 before.
    """
    view, row, column, sample = wp.tid()
    face = faces[view, row, column, sample]
    if face < 0:
        return
    if (int(scene.flags[scene.material[face]]) & UNLIT) != 0:
        return
    x = float(column) + 0.5 + offsets[sample][0] - cx
    y = float(row) + 0.5 + offsets[sample][1] - cy
    ray = direction_of(cameras, view, x, y)
    depth = wp.abs(depth_of(scene, cameras, view, face, ray))
    at = grid_position(nodes, surface_of(scene, cameras, view, face, ray, depth))
    for corner in range(8):
        node = node_number(
            nodes,
            int(at[0]) + (corner & 1),
            int(at[1]) + (wp.rshift(corner, 1) & 1),
            int(at[2]) + wp.rshift(corner, 2),
        )
        if nodes.asked[node] == 0 and wp.atomic_max(nodes.asked, node, 1) == 0:
            wanted[wp.atomic_add(count, 0, 1)] = node


@wp.kernel
def bake_light(scene: Triangles, nodes: LightNodes, rays: LightRays, wanted: wp.array(dtype=int)):
    """Third pass: compute the light of nodes, see `shading_kernels.gather_light`.

    Args:
        scene: The scene.
        nodes: Its light; that of the nodes is filled in.
        rays: By which it is found.
        wanted: Numbers of nodes, one for every thread.
    """
    node = wanted[wp.tid()]
    columns, rows = nodes.x.shape[0], nodes.y.shape[0]
    x, y, z = node % columns, node // columns % rows, node // columns // rows
    position = wp.vec3(nodes.x[x], nodes.y[y], nodes.z[z])
    above, below = wp.vec3(0.0), wp.vec3(0.0)
    for number in range(rays.directions.shape[0]):
        direction = rays.directions[number]
        light = rays.sky[number]
        # A ray that begins on a surface meets it, however the intersection is rounded.
        start = position - _BEFORE_M * direction
        hit = wp.mesh_query_ray(scene.mesh, start, direction, rays.reach_m)
        if hit.result:
            light *= wp.max(hit.t - _BEFORE_M, 0.0) / rays.reach_m
        above += light * wp.max(direction, wp.vec3(0.0))
        below -= light * wp.min(direction, wp.vec3(0.0))
    # The directions are spread evenly: the cosines of one half sum up to a quarter of them.
    scale = 4.0 / float(rays.directions.shape[0])
    for axis in range(3):
        light = wp.pow(wp.min(above[axis] * scale, 1.0), rays.contrast)
        nodes.light[node, 2 * axis] = wp.uint8(light * 255.0 + 0.5)
        light = wp.pow(wp.min(below[axis] * scale, 1.0), rays.contrast)
        nodes.light[node, 2 * axis + 1] = wp.uint8(light * 255.0 + 0.5)


@wp.kernel
def shade(
    scene: Triangles,
    nodes: LightNodes,
    look: Look,
    cameras: wp.array(dtype=wp.vec3, ndim=2),
    cx: float,
    cy: float,
    offsets: wp.array(dtype=wp.vec2),
    faces: wp.array(dtype=int, ndim=4),
    rgb: wp.array(dtype=wp.vec3ub, ndim=3),
):
    """Fourth pass: the colour of every pixel, the mean of its rays'.

    Args:
        scene: The scene.
        nodes: Its light, known wherever `want_light` asked.
        look: How light becomes colours.
        cameras: See this module.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        offsets: See this module.
        faces: From `find_surfaces`.
        rgb: Output: sRGB colours, [views, height, width].
    """
    view, row, column = wp.tid()
    samples = offsets.shape[0]
    background = wp.vec3i(int(look.background[0]), int(look.background[1]), int(look.background[2]))
    total = wp.vec3i(0, 0, 0)
    for sample in range(samples):
        face = faces[view, row, column, sample]
        codes = background
        if face >= 0:
            x = float(column) + 0.5 + offsets[sample][0] - cx
            y = float(row) + 0.5 + offsets[sample][1] - cy
            ray = direction_of(cameras, view, x, y)
            depth = wp.abs(depth_of(scene, cameras, view, face, ray))
            surface = surface_of(scene, cameras, view, face, ray, depth)
            codes = shown(scene, nodes, look, face, surface)
        total += codes
    half = samples // 2
    rgb[view, row, column] = wp.vec3ub(
        wp.uint8((total[0] + half) // samples),
        wp.uint8((total[1] + half) // samples),
        wp.uint8((total[2] + half) // samples),
    )
