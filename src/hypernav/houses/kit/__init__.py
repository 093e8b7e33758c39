"""What everything in a house is made of: meshes, solids, joints."""
