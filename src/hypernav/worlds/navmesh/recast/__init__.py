"""Navigation meshes from triangles, as habitat-sim computes them with Recast.

The algorithms are those of Recast and Detour (Mikko Mononen and others, zlib licence, commit
6dc1667f of recastnavigation) as habitat-sim's ``PathFinder::build`` (Meta Platforms, MIT licence)
uses them, reimplemented. Arithmetic is in single precision and all orders of operations are the
same, so that the meshes are equal polygon for polygon.

The stages: triangles are voxelised to solid spans; spans on which the robot can't stand are marked;
the open space above the others is linked from column to column, eroded by the robot's radius and
divided into regions; the outlines of the regions are simplified and cut into convex polygons; each
polygon gets a detail mesh that follows the voxels' heights.
"""
