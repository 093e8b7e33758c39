"""The search needs nothing of the simulator: neither its code nor its packages."""

import subprocess
import sys

NEEDLESS = ("av", "embreex", "gymnasium", "matplotlib", "trimesh")
WITHOUT = f"""
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {NEEDLESS}:
            raise ModuleNotFoundError(f"{{name}} is not installed", name=name)

sys.meta_path.insert(0, Missing())
"""
IMPORT_ALL = """
import importlib, pkgutil, hypernav.search

for one in pkgutil.walk_packages(hypernav.search.__path__, "hypernav.search."):
    importlib.import_module(one.name)
rooms = {".".join(name.split(".")[:2]) for name in sys.modules if name.startswith("hypernav.")}
print(*sorted(rooms))
"""
SEARCH = """
import hypernav

room = hypernav.BoxRoom()
agent = hypernav.build_agent(hypernav.HyPerNavConfig()).agent
agent.reset(hypernav.Goal("door"))
for steps in range(60):
    action = agent.act(room.observe())
    if action is hypernav.Action.STOP:
        break
    room.step(action)
print(action.name, round(room.pose.x, 1))
"""


def told(program: str) -> list[str]:
    """What a program prints where the packages are missing."""
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT + program], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.split()


def test_a_missing_package_would_be_noticed():
    ended = subprocess.run([sys.executable, "-c", WITHOUT + "import trimesh"], capture_output=True)
    assert b"trimesh is not installed" in ended.stderr


def test_all_of_the_search_loads_without_the_simulator_and_its_packages():
    assert told(IMPORT_ALL) == ["hypernav.core", "hypernav.io", "hypernav.search"]


def test_a_search_finds_its_goal_without_the_packages_of_the_simulator():
    stopped, x = told(SEARCH)
    assert stopped == "STOP"
    assert float(x) > 0.5
