"""Surfaces and their colours without light, where rays meet triangles (NVIDIA Warp's functions).

The formulas are those of `ray_kernels` and `shading_kernels`; here one thread follows one
ray, so nothing is kept from one ray to the next. Cameras are rows as for
`ray_kernels.fill_rays`: position; optical axis; change of direction to the next pixel right;
to the next pixel down.
"""

import warp as wp

from hypernav.simulator.worlds.drawing.shading_kernels import FLAG_COLORED, MAX_TAPS

_COLORED = wp.constant(FLAG_COLORED)
_TAPS = wp.constant(MAX_TAPS)


@wp.struct
class Triangles:
    """A scene's triangles and materials, see `Scene`, `TextureSet` and `shading_kernels`."""

    mesh: wp.uint64
    one_sided: bool
    smooth: bool
    vertices: wp.array(dtype=wp.vec3)
    corners: wp.array(dtype=int)  # three a triangle
    normals: wp.array(dtype=wp.vec3, ndim=2)
    uv: wp.array(dtype=wp.vec2, ndim=2)
    colors: wp.array(dtype=wp.vec3ub, ndim=2)
    instance: wp.array(dtype=int)
    material: wp.array(dtype=int)
    flags: wp.array(dtype=wp.uint8)
    color: wp.array(dtype=wp.vec3)
    wrap: wp.array(dtype=wp.vec2ub)
    texture: wp.array(dtype=int)
    texels: wp.array(dtype=wp.uint32)
    levels: wp.array(dtype=int, ndim=3)
    level_count: wp.array(dtype=int)


@wp.struct
class Surface:
    """Where a ray meets a triangle, see the columns of `ray_kernels`."""

    point: wp.vec3
    normal: wp.vec3
    facing: float
    weights: wp.vec3
    uv: wp.vec2
    uv_right: wp.vec2
    uv_down: wp.vec2


@wp.func
def direction_of(
    cameras: wp.array(dtype=wp.vec3, ndim=2), view: int, x: float, y: float
) -> wp.vec3:
    """Direction of the ray through an image point relative to the principal point."""
    return cameras[view, 1] + x * cameras[view, 2] + y * cameras[view, 3]


@wp.func
def depth_of(
    scene: Triangles, cameras: wp.array(dtype=wp.vec3, ndim=2), view: int, face: int, ray: wp.vec3
) -> float:
    """Depth of a triangle along the optical axis; negative where its back is seen."""
    a = scene.vertices[scene.corners[3 * face]] - cameras[view, 0]
    b = scene.vertices[scene.corners[3 * face + 1]] - cameras[view, 0]
    c = scene.vertices[scene.corners[3 * face + 2]] - cameras[view, 0]
    normal = wp.cross(b - a, c - a)
    plane = wp.dot(normal, a)
    axis = cameras[view, 1]
    da, db, dc = wp.dot(axis, a), wp.dot(axis, b), wp.dot(axis, c)
    nearest, farthest = wp.min(da, wp.min(db, dc)), wp.max(da, wp.max(db, dc))
    depth = plane / wp.dot(normal, ray)
    # A thin triangle's plane seen edge-on is ill defined, but depth is between its corners'.
    if not depth >= nearest:
        depth = nearest
    depth = wp.min(depth, farthest)
    return wp.where(plane > 0.0, -depth, depth)


@wp.func
def is_through(
    scene: Triangles, cameras: wp.array(dtype=wp.vec3, ndim=2), view: int, face: int, ray: wp.vec3
) -> bool:
    """Whether a ray from the camera meets a triangle, or its edge, from the front."""
    a = scene.vertices[scene.corners[3 * face]] - cameras[view, 0]
    b = scene.vertices[scene.corners[3 * face + 1]] - cameras[view, 0]
    c = scene.vertices[scene.corners[3 * face + 2]] - cameras[view, 0]
    sides = wp.vec3(
        wp.dot(ray, wp.cross(b, c)), wp.dot(ray, wp.cross(c, a)), wp.dot(ray, wp.cross(a, b))
    )
    return wp.max(sides) <= 0.0 and wp.min(sides) < 0.0


@wp.func
def surface_of(
    scene: Triangles,
    cameras: wp.array(dtype=wp.vec3, ndim=2),
    view: int,
    face: int,
    ray: wp.vec3,
    depth: float,
) -> Surface:
    """The surface where a ray meets a triangle, as `ray_kernels.locate` has it."""
    camera = cameras[view, 0]
    first = scene.vertices[scene.corners[3 * face]] - camera
    edge = scene.vertices[scene.corners[3 * face + 1]] - camera - first
    other = scene.vertices[scene.corners[3 * face + 2]] - camera - first
    normal = wp.cross(edge, other)
    square = wp.max(wp.dot(normal, normal), 1e-30)
    # A corner's weight is linear in space: one gradient gives its value and its change.
    to_second, to_third = wp.cross(other, normal / square), wp.cross(normal / square, edge)
    at = depth * ray
    second = wp.clamp(wp.dot(at - first, to_second), 0.0, 1.0)
    third = wp.clamp(wp.dot(at - first, to_third), 0.0, 1.0 - second)
    found = Surface()
    found.point = at + camera
    found.weights = wp.vec3(1.0 - second - third, second, third)
    corner = scene.uv[face, 0]
    along_second, along_third = scene.uv[face, 1] - corner, scene.uv[face, 2] - corner
    found.uv = corner + second * along_second + third * along_third
    u_change = to_second * along_second[0] + to_third * along_third[0]
    v_change = to_second * along_second[1] + to_third * along_third[1]
    along = 1.0 / wp.dot(normal, ray)
    right, down = cameras[view, 2], cameras[view, 3]
    step = depth * (right - wp.dot(normal, right) * along * ray)
    found.uv_right = wp.vec2(wp.dot(step, u_change), wp.dot(step, v_change))
    step = depth * (down - wp.dot(normal, down) * along * ray)
    found.uv_down = wp.vec2(wp.dot(step, u_change), wp.dot(step, v_change))
    # The normal, of unit length, turned towards the camera.
    flat = normal / wp.sqrt(square)
    if along > 0.0:
        flat = -flat
    found.normal = flat
    if scene.smooth:
        a, b, c = scene.normals[face, 0], scene.normals[face, 1], scene.normals[face, 2]
        least = wp.min(
            wp.abs(wp.dot(a, flat)), wp.min(wp.abs(wp.dot(b, flat)), wp.abs(wp.dot(c, flat)))
        )
        mean = found.weights[0] * a + found.weights[1] * b + found.weights[2] * c
        length = wp.length(mean)
        if least < 0.9999 and length > 1e-6:
            found.normal = mean / wp.where(wp.dot(mean, flat) < 0.0, -length, length)
    found.facing = wp.max(-wp.dot(found.normal, ray) / wp.length(ray), 0.0)
    return found


@wp.func
def wrapped(coordinate: float, mode: wp.uint8) -> float:
    """A texture coordinate mapped into [0, 1]; modes are those of `Wrap`."""
    inside = wp.clamp(coordinate, 0.0, 1.0)
    if mode == wp.uint8(0):
        inside = coordinate - wp.floor(coordinate)
    elif mode == wp.uint8(1):
        inside = coordinate - 2.0 * wp.floor(coordinate * 0.5)
        if inside > 1.0:
            inside = 2.0 - inside
    # A surface seen exactly edge-on gives infinite steps, and those NaN.
    if inside >= 0.0 and inside <= 1.0:
        return inside
    return 0.0


@wp.func
def is_hole(scene: Triangles, material: int, uv: wp.vec2) -> bool:
    """Whether a texture has a hole there."""
    texture = scene.texture[material]
    width, height = scene.levels[texture, 0, 1], scene.levels[texture, 0, 2]
    x = wp.min(int(wrapped(uv[0], scene.wrap[material][0]) * float(width)), width - 1)
    y = wp.min(int((1.0 - wrapped(uv[1], scene.wrap[material][1])) * float(height)), height - 1)
    texel = scene.texels[scene.levels[texture, 0, 0] + y * width + x]
    return wp.rshift(texel, wp.uint32(24)) < wp.uint32(128)


@wp.func
def texel_color(texel: wp.uint32) -> wp.vec3:
    """SRGB codes of a texel."""
    byte = wp.uint32(255)
    return wp.vec3(
        float(texel & byte),
        float(wp.rshift(texel, wp.uint32(8)) & byte),
        float(wp.rshift(texel, wp.uint32(16)) & byte),
    )


@wp.func
def bilinear(scene: Triangles, texture: int, level: int, uv: wp.vec2, wrap: wp.vec2ub) -> wp.vec3:
    """Colour of one level of a texture, sRGB codes 0 to 255; v upwards."""
    first = scene.levels[texture, level, 0]
    width, height = scene.levels[texture, level, 1], scene.levels[texture, level, 2]
    x = wrapped(uv[0], wrap[0]) * float(width) - 0.5
    y = (1.0 - wrapped(uv[1], wrap[1])) * float(height) - 0.5
    x0, y0 = int(wp.floor(x)), int(wp.floor(y))
    right, below = x - float(x0), y - float(y0)
    x1, y1 = x0 + 1, y0 + 1
    if x0 < 0:
        x0 = wp.where(wrap[0] == wp.uint8(0), width - 1, 0)
    if x1 >= width:
        x1 = wp.where(wrap[0] == wp.uint8(0), 0, width - 1)
    if y0 < 0:
        y0 = wp.where(wrap[1] == wp.uint8(0), height - 1, 0)
    if y1 >= height:
        y1 = wp.where(wrap[1] == wp.uint8(0), 0, height - 1)
    top = (1.0 - right) * texel_color(scene.texels[first + y0 * width + x0])
    top += right * texel_color(scene.texels[first + y0 * width + x1])
    bottom = (1.0 - right) * texel_color(scene.texels[first + y1 * width + x0])
    bottom += right * texel_color(scene.texels[first + y1 * width + x1])
    return (1.0 - below) * top + below * bottom


@wp.func
def base_color(scene: Triangles, face: int, surface: Surface) -> wp.vec3:
    """Colour of a surface without light, as `shading_kernels.fill_base_colors` has it."""
    material = scene.material[face]
    color = 255.0 * scene.color[material]
    if (int(scene.flags[material]) & _COLORED) != 0:
        corners = wp.vec3(0.0)
        for corner in range(3):
            codes = scene.colors[face, corner]
            share = surface.weights[corner] / 255.0
            corners += share * wp.vec3(float(codes[0]), float(codes[1]), float(codes[2]))
        color = wp.cw_mul(color, corners)
    texture = scene.texture[material]
    if texture < 0:
        return color
    width, height = float(scene.levels[texture, 0, 1]), float(scene.levels[texture, 0, 2])
    long_axis = surface.uv_right
    long = wp.length(wp.vec2(long_axis[0] * width, long_axis[1] * height))
    short = wp.length(wp.vec2(surface.uv_down[0] * width, surface.uv_down[1] * height))
    if long < short:
        long_axis = surface.uv_down
        swapped = long
        long = short
        short = swapped
    taps = int(1)
    level = int(0)
    blend = float(0.0)
    if long > 1.0:
        if long > 1.5 * short:
            taps = int(wp.min(long / wp.max(short, 1e-9) + 0.5, float(_TAPS)))
        size = float(wp.max(long / float(taps), wp.max(short, 1.0)))
        coarsest = scene.level_count[texture] - 1
        while size >= 1.6 and level < coarsest:
            size *= 0.5
            level += 1
        if level < coarsest:
            blend = wp.max((size - 1.35) * 4.0, 0.0)
    seen = wp.vec3(0.0)
    for tap in range(taps):
        uv = surface.uv + long_axis * ((float(tap) + 0.5) / float(taps) - 0.5)
        own = bilinear(scene, texture, level, uv, scene.wrap[material])
        if blend > 0.0:
            coarse = bilinear(scene, texture, level + 1, uv, scene.wrap[material])
            own = (1.0 - blend) * own + blend * coarse
        seen += own
    return wp.cw_mul(color, seen) / (255.0 * float(taps))
