"""Rooms told by things reach the choice of a block, if they are trusted."""

from hypernav.build.agents import build_agent
from hypernav.build.presets import preset
from hypernav.core.config import layered
from hypernav.core.goal import Goal
from images import thing_before_wall


def first_choice(trust: float, goal: str) -> str:
    config = layered(
        preset("default"),
        assignments=[f"geometric.trust_rooms={trust}", "search.look_around_at_start=false"],
    )
    agent = build_agent(config).agent
    agent.reset(Goal(goal))
    agent.act(thing_before_wall())
    (exchange, *_) = agent.last_step.exchanges  # pyright: ignore[reportAttributeAccessIssue]
    return exchange.answer


def area_in_view(answer: str) -> float:
    return float(answer.split(": ")[1].split(" m²")[0])


def test_geometry_alone_counts_the_unknown_alike():
    assert first_choice(0.0, "oven") == first_choice(0.0, "pillow")
    assert "likely" not in first_choice(0.0, "oven")


def test_around_a_bed_more_of_the_unknown_counts_for_a_pillow_than_for_an_oven():
    pillow, oven = first_choice(0.9, "pillow"), first_choice(0.9, "oven")
    assert "by how likely the goal is there" in pillow
    assert area_in_view(pillow) > area_in_view(first_choice(0.0, "pillow")) > area_in_view(oven)
