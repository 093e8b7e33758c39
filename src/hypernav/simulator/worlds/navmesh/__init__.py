"""Navigation meshes of habitat-sim as a surface to walk on."""
