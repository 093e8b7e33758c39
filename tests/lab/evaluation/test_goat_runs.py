"""GOAT-Bench from a data folder to a report with its two rules."""

import json

import pytest

from certainty import certain
from eval_runs import SMALL, apart, record
from hypernav.app.cli.main import main
from hypernav.core.goal import Goal
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.lab.evaluation.report.lives import ALL, GOAT_RULES, by_goal_type
from hypernav.lab.evaluation.report.report_page import write_report
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore, read_configuration, read_records
from hypernav.simulator.houses.export.building_files import export_building
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.houses.named_scenes import building_of
from hypernav.simulator.worlds.simulation import SimulatedWorld
from scan_writers.goat import goat_life, goat_object, write_goat

WHO = {"agent": "hypernav", "preset": "default", "detector": "truth", "reasoner": "geometric"}
CODE, README = range(2)


def hypernav(*arguments):
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


def run_with(folder, records):
    plan = RunPlan(
        "goat:data", who=WHO, goal_types=("object", "description"), left_out={"image": 3}
    )
    with RunStore(folder, plan.configuration([])) as store:
        for line in records:
            store.add(line)
    return load_runs([folder])[0]


def goal(life, number, kind, **values):
    near = {"distance_to_goal_m": 0.2, "distance_to_object_m": 0.8, "life": life, "group": kind}
    return record(f"{life}.{number}", "scene", goal_number=number, **(near | values))


RECORDS = [
    goal("0", 1, "object"),  # good by both rules
    goal("0", 2, "object", steps=501),  # too late for the README
    goal("0", 3, "description", distance_to_goal_m=0.3),  # too far for the code
    goal("1", 1, "object", stopped=False),
]


def test_the_same_goals_are_scored_by_both_rules(tmp_path):
    rows = by_goal_type(run_with(tmp_path, RECORDS))
    assert [(row.name, row.count) for row in rows] == [
        *((ALL, 4), ("description", 1), ("object", 3))
    ]
    rates = [[certain(score).success.mean for score in row.scores] for row in rows]
    assert rates == [[0.5, 0.5], [0.0, 1.0], [pytest.approx(2 / 3), pytest.approx(1 / 3)]]
    whole = certain(rows[0].scores[CODE])
    assert certain(whole.partial_success).mean == pytest.approx((2 / 3 + 0.0) / 2)
    assert certain(whole.whole_success).mean == 0.0


def test_a_life_that_was_cut_short_counts_by_its_goals_alone(tmp_path):
    away = apart("1.2", "scene").model_copy(update={"life": "1", "goal_number": 2})
    code = certain(by_goal_type(run_with(tmp_path / "one", [*RECORDS, away]))[0].scores[CODE])
    assert code.success.count == 4
    assert certain(code.partial_success).mean == pytest.approx(2 / 3)
    run = run_with(tmp_path / "none", [RECORDS[3], away])
    assert certain(by_goal_type(run)[0].scores[CODE]).partial_success is None
    assert write_report(tmp_path / "report", [run])


def test_without_annotations_there_is_no_distance_to_an_object(tmp_path):
    blind = [r.model_copy(update={"distance_to_object_m": None}) for r in RECORDS]
    scores = by_goal_type(run_with(tmp_path, blind))[0].scores
    assert scores[CODE] is not None
    assert scores[README] is None


def test_the_report_has_both_rules_and_says_what_is_left_out(tmp_path):
    run = run_with(tmp_path / "run", RECORDS)
    page = write_report(tmp_path / "report", [run]).read_text()
    assert all(rule in page for rule in GOAT_RULES)
    assert "leaves out 3 image goals of GOAT-Bench" in page
    assert BENCHMARKS["goat"].caveats[0] in page


@pytest.mark.slow
def test_a_run_says_what_it_leaves_out_and_keeps_it(benchmark_data, tmp_path, capsys):
    out, options = tmp_path / "run", ("--workers", "1", "--max-steps", "3", *SMALL)
    command = ("eval", f"goat:{benchmark_data}#val_unseen", "--out", out, *options)
    assert hypernav(*command) == 0
    said = capsys.readouterr().err
    assert "goal types: object, description; left out: 1 image goal" in said
    assert "1 life with 3 goals, memory: kept between goals" in said
    assert "GOAT-Bench has two rules that contradict each other" in said
    configuration = read_configuration(out)
    assert configuration["goal_types"] == {
        "run": ["object", "description"],
        "left_out": {"image": 1},
    }
    assert configuration["lives"]["max_steps"] == 5000
    assert [r.group for r in read_records(out)] == ["object", "description", "object"]


@pytest.mark.slow
def test_goal_types_are_chosen_and_image_goals_refused(benchmark_data, tmp_path, capsys):
    quick = ("--workers", "1", "--max-steps", "1", "--quiet", *SMALL, "--out", tmp_path / "run")
    where = ("eval", f"goat:{benchmark_data}#val_seen", *quick)
    assert hypernav(*where, "--goal-types", "image") == 2
    assert "can't be run yet" in capsys.readouterr().err
    assert hypernav(*where, "--goal-types", "description") == 0
    assert [r.episode_id for r in read_records(tmp_path / "run")] == ["0.2"]


def test_a_plan_of_a_program_leaves_image_goals_out_too(benchmark_data):
    plan, episodes = RunPlan(f"goat:{benchmark_data}#val_seen", benchmark="ovon").chosen()
    assert [e.group for e in episodes] == ["object", "description", "object"]
    assert plan.left_out == {"image": 1}
    assert RunPlan("scene:builtin#1", benchmark="goat").chosen()[0].goal_types == ()


def test_other_data_sets_have_no_goal_types(benchmark_data, capsys):
    assert hypernav("eval", f"ovon:{benchmark_data}#val_seen", "--goal-types", "object") == 2
    assert "of one type" in capsys.readouterr().err


@pytest.mark.slow
def test_a_life_of_goat_bench_in_an_exported_house_runs_to_its_end(tmp_path):
    building, scene_id = building_of("houses:5"), "hm3d/val/house-5/house-5.glb"
    data = tmp_path / "data"
    files = export_building(building, data / "scene_datasets" / "hm3d" / "val" / "house-5")
    files.glb.rename(data / "scene_datasets" / scene_id)
    scene = cached_building(building)
    world = SimulatedWorld(scene, embodiment=BENCHMARKS["goat"].embodiment)
    objects, rows = [], []
    for name in ("bed", "sofa", "toilet", "refrigerator", "sink"):
        region = world.regions.of(Goal(name))
        for thing in region.instances:
            points = [(x, y, z) for x, y, z in world.regions.view_points(thing).tolist()]
            if points:
                said = f"the {name} that is called {thing.name}"
                objects.append(goat_object(thing.name, name, points[0], points, said))
        if region.is_reachable:
            rows.append((name, "object", None))
    first = objects[0]
    rows.append((first["object_category"], "description", first["object_id"]))
    rows.append((first["object_category"], "image", first["object_id"], 0))
    x, y = world.walkable.centres()[0].tolist()
    lives = [goat_life(0, scene_id, (x, y, world.walkable.height_at(x, y)), rows)]
    world.close()
    write_goat(data / "datasets" / "goat_bench" / "hm3d" / "v1" / "val_unseen", lives, objects)
    assert hypernav("eval", f"goat:{data}", "--out", tmp_path / "run", "--workers", "1") == 0
    records = read_records(tmp_path / "run")
    assert len(records) == len(rows) - 1
    assert all(one.counts for one in records)
    assert sum(one.steps for one in records) <= 5000
    assert sum(one.success for one in records) >= len(records) - 1
    report = write_report(tmp_path / "run", load_runs([tmp_path / "run"]))
    assert "By the two rules of GOAT-Bench" in report.read_text()
    (life,) = json.loads((tmp_path / "run" / "lives.json").read_text())["runs"]["hypernav"]
    assert life["goals"] == len(rows) - 1
