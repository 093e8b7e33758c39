"""A room with a bed and its ObjectNav episodes on disk, and habitat-lab's configuration of them."""

from pathlib import Path
from typing import Any

from box_scenes import room_glb
from scan_writers.episodes import episode, habitat, write_json

START = (1.0, 1.0, 0.0)
VIEW_POINT = (3.5, 1.0, 0.0)
CATEGORIES = {"chair": 0, "bed": 1, "tv_monitor": 4}


def write_room(folder: Path) -> Path:
    """Two episodes, each in a room of its own: first the bed of "b", 2.5 m ahead, then of "a"."""
    scenes = folder / "scene_datasets"
    scenes.mkdir(parents=True)
    for name in ("a", "b"):
        room_glb(scenes / f"{name}.glb")
    state = {"position": habitat(VIEW_POINT), "rotation": [0.0, 0.0, 0.0, 1.0]}
    bed = {
        "position": habitat((5.0, 0.9, 0.2)),
        "object_id": 6,
        "object_name": "bed_06",
        "object_category": "bed",
        "view_points": [{"agent_state": state, "iou": 0.1}],
    }
    content = {
        "goals_by_category": {"a.glb_bed": [bed], "b.glb_bed": [bed]},
        "episodes": [
            episode(0, "b.glb", "bed", START),
            episode(1, "a.glb", "bed", START),
            episode(2, "b.glb", "bed", START, yaw=2.0),
        ],
        "category_to_task_category_id": CATEGORIES,
        "category_to_scene_annotation_category_id": CATEGORIES,
    }
    write_json(folder / "val" / "val.json.gz", content)
    return folder


def habitat_config(folder: Path) -> dict[str, Any]:
    """What ``habitat.get_config`` of ``objectnav_hm3d.yaml`` holds, with a small camera."""
    view = {
        "width": 64,
        "height": 48,
        "hfov": 79,
        "position": [0.0, 0.88, 0.0],
        "orientation": [0.0, 0.0, 0.0],
        "noise_model": "None",
        "sensor_subtype": "PINHOLE",
    }
    habitat = {
        "seed": 100,
        "environment": {
            "max_episode_steps": 500,
            "iterator_options": {"shuffle": False, "group_by_scene": True},
        },
        "simulator": {
            "type": "Sim-v0",
            "forward_step_size": 0.25,
            "turn_angle": 30,
            "agents": {
                "main_agent": {
                    "height": 0.88,
                    "radius": 0.18,
                    "max_climb": 0.2,
                    "max_slope": 45.0,
                    "sim_sensors": {
                        "rgb_sensor": {"type": "HabitatSimRGBSensor", **view},
                        "depth_sensor": {
                            "type": "HabitatSimDepthSensor",
                            **view,
                            "min_depth": 0.5,
                            "max_depth": 5.0,
                            "normalize_depth": True,
                        },
                    },
                }
            },
            "habitat_sim_v0": {"allow_sliding": False},
        },
        "task": {
            "type": "ObjectNav-v1",
            "reward_measure": "distance_to_goal_reward",
            "success_measure": "spl",
            "slack_reward": -0.01,
            "success_reward": 2.5,
            "lab_sensors": {
                "objectgoal_sensor": {
                    "type": "ObjectGoalSensor",
                    "goal_spec": "TASK_CATEGORY_ID",
                },
                "compass_sensor": {"type": "CompassSensor"},
                "gps_sensor": {"type": "GPSSensor", "dimensionality": 2},
            },
            "measurements": {
                "distance_to_goal": {"type": "DistanceToGoal", "distance_to": "VIEW_POINTS"},
                "success": {"type": "Success", "success_distance": 0.1},
                "spl": {"type": "SPL"},
                "soft_spl": {"type": "SoftSPL"},
                "distance_to_goal_reward": {"type": "DistanceToGoalReward"},
            },
            "actions": {
                "stop": {"type": "StopAction"},
                "move_forward": {"type": "MoveForwardAction", "tilt_angle": 15},
                "turn_left": {"type": "TurnLeftAction", "tilt_angle": 15},
                "turn_right": {"type": "TurnRightAction", "tilt_angle": 15},
                "look_up": {"type": "LookUpAction", "tilt_angle": 30},
                "look_down": {"type": "LookDownAction", "tilt_angle": 30},
            },
        },
        "dataset": {
            "type": "ObjectNav-v1",
            "split": "val",
            "scenes_dir": str(folder / "scene_datasets"),
            "content_scenes": ["*"],
            "data_path": str(folder / "{split}" / "{split}.json.gz"),
        },
    }
    return {"habitat": habitat}
