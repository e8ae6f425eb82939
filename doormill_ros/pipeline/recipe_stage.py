"""The first stage of a run: the recipe, made known under the run's id."""

from __future__ import annotations

from doormill_ros.cell.errors import StageRefusedError
from doormill_ros.cell.run.run import Run
from doormill_ros.pipeline.partners import RecipeAnswer, Recipes

ASK_AGAIN = 1.0  # s


def fetch_recipe(run: Run, recipes: Recipes, limit: float) -> int:
    """Version of the recipe that the database has made known under the run's id.

    Args:
        run: In hand.
        recipes: The database.
        limit: Longest wait [s].

    Raises:
        StageTimeoutError: It does not answer.
        StageRefusedError: It has no recipe for this door.
    """
    heard: list[RecipeAnswer] = []
    asked_at = float("-inf")

    def hear(answer: RecipeAnswer) -> None:
        heard.append(answer)
        run.notify()

    def answered() -> bool:
        # A database that was restarted a moment ago may miss the first request.
        nonlocal asked_at
        if not heard and run.clock.monotonic() - asked_at > ASK_AGAIN and recipes.ready:
            asked_at = run.clock.monotonic()
            recipes.ask(run.door_id, run.run_id, hear)
        return bool(heard)

    run.wait_until(
        answered, limit, "the recipe database does not answer; check that /recipe_database is active"
    )
    answer = heard[0]
    if not answer.accepted:
        raise StageRefusedError(answer.reason, answer.error_code)
    return answer.version
