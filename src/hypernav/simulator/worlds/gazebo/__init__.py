"""Reading of Gazebo worlds (``.world`` and ``.sdf``)."""
