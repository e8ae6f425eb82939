"""The first message that a process logs is not the one for which all its modules are looked up."""

from __future__ import annotations

import subprocess
import sys

LOGS = """
import inspect
from doormill_ros.nodes import recipe_database
from doormill_ros.nodes.process.log_places import tell_places
from doormill_ros.nodes.process.run import init
looked_up = []
place = inspect.getabsfile
inspect.getabsfile = lambda thing, *name: looked_up.append(thing) or place(thing, *name)
init(["recipe_database"])
{told}
recipe_database.RecipeDatabaseNode().leave_word()
print(sum(inspect.ismodule(thing) for thing in looked_up), flush=True)
import os; os._exit(0)
"""
SPEAKS = """
recipe_database.RecipeDatabaseNode.leave_word = lambda node: node.attempt("speak", lambda: 1 / 0)
"""


def modules_looked_up(told: str) -> int:
    code = LOGS.replace("{told}", SPEAKS + told)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "ZeroDivisionError" in done.stderr
    return int(done.stdout)


def test_no_module_is_looked_up_for_the_first_message() -> None:
    assert modules_looked_up("tell_places()") == 0


def test_all_of_them_were() -> None:
    """What `inspect` does otherwise; once it does so no more, this module of ours is not needed."""
    assert modules_looked_up("") > 500
