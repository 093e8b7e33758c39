"""Depth to points to voxels to a top-down map; frontiers, blocks, exports."""
