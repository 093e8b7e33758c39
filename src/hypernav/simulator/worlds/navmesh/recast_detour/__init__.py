"""Recast and Detour: navigation meshes from triangles, and queries of them, as in habitat-sim.

Nobody needs to open this folder: `navmesh.Navmesh` and `robot_navmesh.robot_navmesh` use it.

The algorithms are those of Recast and Detour (Mikko Mononen and others, zlib licence; Recast of
commit 6dc1667f of recastnavigation, Detour of release 1.6.0) as habitat-sim's ``PathFinder`` (Meta
Platforms, MIT licence) uses them, reimplemented. Arithmetic is in single precision and all orders
of operations are the same, so that meshes are equal polygon for polygon, and queries have the
results of the C++ code.

The stages of Recast: triangles are voxelised to solid spans; spans on which the robot can't stand
are marked; the open space above the others is linked from column to column, eroded by the robot's
radius and divided into regions; the outlines of the regions are simplified and cut into convex
polygons; each polygon gets a detail mesh that follows the voxels' heights.
"""
