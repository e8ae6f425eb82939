"""Conditions that no single picture shows: their poses are accepted and wrong. docs/localization.md says why."""

UNSEEN = frozenset(
    {
        "0.3 mm thicker than its recipe",
        "dark arris",
        "jaw as dark as the background",
        "no door, a plate behind",
    }
)

# Plain to a person, yet refused in more than one of ten pictures, for a doubt that one picture does not settle.
DOUBTFUL = frozenset({"wavy edge", "oak grain"})
