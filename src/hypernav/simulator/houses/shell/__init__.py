"""Shell of the building: walls, floors, ceilings, doors, windows."""
