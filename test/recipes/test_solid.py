"""`Prism.meets` against counting points of a fine random cloud, which knows nothing of polygons."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.solid import prism


def inside(feature, size, points):
    """True for points of the wood that the feature takes away, from its definition alone."""
    T = feature.T_door_feature(size)
    x, y, z = ((points - T[:3, 3]) @ T[:3, :3]).T
    w, h, r = feature.shape.width / 2, feature.shape.length / 2, feature.shape.radius
    corner = np.hypot(np.maximum(np.abs(x) - (w - r), 0), np.maximum(np.abs(y) - (h - r), 0)) <= r
    flat = (np.abs(x) <= w) & (np.abs(y) <= h) & (corner if r > 0 else True)
    return flat & (z >= 0) & (z <= feature.cut_depth(size))


def random_feature(document, rng, index):
    """A feature of the document at a random place near the lock."""
    item = {**document["features"][index], "id": f"f{rng.integers(10**9)}"}
    item.pop("lock_case", None)
    item["height_mm"] = 1000 + rng.uniform(-200, 200)
    item.pop("height_from", None)
    if "backset_mm" in item:
        item["backset_mm"] = rng.uniform(20, 110) if item["kind"] == "handle_hole" else rng.uniform(690, 780)
        item["depth_mm"] = rng.uniform(2, 30)
    if item["kind"] == "handle_hole":
        del item["depth_mm"]
    return item


def shrunk(item, distance):
    """The prism with less on every side, or None when nothing is left."""
    low, high, polygon = item.low + distance, item.high - distance, item.polygon.buffer(-distance)
    if low >= high or polygon.is_empty:
        return None
    small = replace(item, low=low, high=high)
    small.__dict__["polygon"] = polygon
    return small


@pytest.mark.parametrize("pair", [(0, 2), (1, 2), (4, 2), (0, 1), (0, 4), (2, 3)])
def test_meeting_is_what_a_point_cloud_says(document, pair):
    rng = np.random.default_rng(sum(pair) + 7)
    size = Recipe.from_document(document).size
    document["tools"]["mill_16"]["cutting_length_mm"] = 200
    met = apart = 0
    for _ in range(40):
        features = []
        for index in pair:
            single = {**document, "features": [random_feature(document, rng, index)]}
            features.append(Recipe.from_document(single).features[0])
        first, second = (prism(feature, size) for feature in features)
        low, high = np.array(first.box).T
        cloud = rng.uniform(low, high, (40000, 3))
        cloud = cloud[inside(features[0], size, cloud)]
        hits = int(inside(features[1], size, cloud).sum())
        assert first.meets(second) == second.meets(first)
        if hits:
            assert first.meets(second)
            met += 1
        else:
            # The cloud may miss a sliver; but with 2.5 mm less of each on every side none must meet.
            small = [shrunk(item, 2.5e-3) for item in (first, second)]
            assert None in small or not small[0].meets(small[1])
            apart += 1
    assert apart >= 3
    assert met >= 3  # the case was really tried
