"""Reading of COLLADA files (``.dae``)."""
