"""Random valid doors over the whole range of sizes, with process forces of the size of table 4.8."""

import math
from dataclasses import replace

from hypothesis import strategies as st

from doormill_ros.recipes.force_origin import ForceModel
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.wrench import WrenchTable

TOOLS = {  # diameter, cutting length in mm
    "mill_6": (6.0, 30.0),
    "mill_10": (10.0, 60.0),
    "mill_16": (16.0, 160.0),
    "mill_19": (19.0, 110.0),
}

#: Drawn forces are exactly what acts, so that what is judged is how they are corrected.
KNOWN = {"measured": True, "std_n_nm": [0] * 6, "source": "drawn for a test"}

TABLE_4_8 = {
    "left_line": (-209.0, 29.0, 12.0, -5.0, -43.0, 3.0),
    "top_turn": (-100.0, 13.0, 25.0, -3.0, -26.0, 2.0),
    "right_line": (-62.0, 3.0, -11.0, -1.0, -8.0, 2.0),
    "bottom_turn": (-13.0, 2.0, -22.0, -1.0, 4.0, 0.0),
}


def exactly_known(feature):
    """The feature under forces that are exactly what acts: those of its table, of table 4.8 if it has none."""
    if feature.wrench_table is None:
        rows = tuple(sorted((name, TABLE_4_8[name]) for name in TABLE_4_8 if name in feature.segment_names))
        table = WrenchTable((*rows, ("default", (0.0,) * 6)))
        feature = replace(feature, wrench_table=table, wrench_point=0.208, forces=None)
    known = replace(
        feature.force_origin, model=ForceModel.TABLE, measured=True, std=(0.0,) * 6, source="taken as exact"
    )
    return replace(feature, forces=known)


@st.composite
def _work(draw, segments, tool, depth):
    force = st.floats(-150.0, 150.0).map(lambda v: round(v, 3))
    small = st.floats(-5.0, 5.0).map(lambda v: round(v, 3))
    rows = {}
    for name in (*segments, "plunge", "clearing"):
        fx, fy, fz = draw(force), draw(force), draw(st.floats(-40.0, 40.0).map(lambda v: round(v, 3)))
        # The moment at the sensor is that of the force at the tool tip, plus a little.
        arm = 0.208
        rows[name] = [
            fx,
            fy,
            fz,
            round(-arm * fy + draw(small), 3),
            round(arm * fx + draw(small), 3),
            draw(small),
        ]
    return {
        "tool": tool,
        "cutting": {"spindle_speed_rpm": 6000, "feed_mm_s": draw(st.sampled_from([20, 50, 80]))},
        "passes": {
            "depth_step_mm": min(100.0, max(0.5, round(depth / draw(st.integers(1, 3)) + 0.01, 3))),
            "finish_allowance_mm": draw(st.sampled_from([0.0, 0.3, 1.0])),
        },
        "direction": draw(st.sampled_from(["climb", "conventional"])),
        "wrench_n_nm": rows,
        "wrench_point_mm": 208,
        "forces": KNOWN,
    }


RECT = [f"{a}_{b}_corner" for a in ("top", "bottom") for b in ("left", "right")] + [
    f"{s}_line" for s in ("top", "bottom", "left", "right")
]
OBLONG = ["top_turn", "bottom_turn", "left_line", "right_line"]


def mm(low, high):
    return st.floats(low, high).map(lambda v: round(min(max(v, low), high), 3))


def whole_range(low, high):
    """Any value between the limits, often a limit itself."""
    return st.one_of(st.sampled_from([low, high]), mm(low, high), mm(low, high), mm(low, high))


@st.composite
def _hinges(draw, door):
    count = draw(st.integers(1, 4))
    slot = door["height_mm"] / count
    features = []
    for k in range(count):
        oblong = draw(st.booleans())
        tool = draw(st.sampled_from(["mill_6", "mill_10", "mill_16", "mill_19"]))
        d = TOOLS[tool][0]
        width = draw(mm(max(d + 1.0, 12.0), 45.0))
        length = draw(mm(width + 2.0, min(220.0, slot - 20.0)))
        depth = draw(mm(1.0, min(12.0, door["thickness_mm"] - 5.0)))
        low, high = slot * k + length / 2 + 5, slot * (k + 1) - length / 2 - 5
        feature = {
            "kind": "hinge_oblong" if oblong else "hinge_leaf",
            "id": f"hinge_{k + 1}",
            "side": draw(st.sampled_from(["front"] * 7 + ["rear"])),
            "height_mm": draw(mm(low, high)),
            "backset_mm": draw(mm(width / 2 + 2.5, width / 2 + 25.0)),
            "width_mm": width,
            "length_mm": length,
            "depth_mm": depth,
        }
        if oblong:
            feature["points"] = draw(st.sampled_from([6, 9]))
        else:
            # Square, round and, by a hair, too round for the tool's path to keep an arc.
            radius = draw(st.sampled_from([d / 2, d / 2 + 0.05, (d / 2 + width / 2) / 2]))
            feature["corner_radius_mm"] = round(min(radius, width / 2 - 0.6), 3)
            if 2 * feature["corner_radius_mm"] < d:
                feature["corner_radius_mm"] = d / 2
                feature["width_mm"] = width = max(width, d + 1.2)
                feature["backset_mm"] = width / 2 + 5.0
        features.append(feature | draw(_work(OBLONG if oblong else RECT, tool, depth)))
    return features


@st.composite
def _lock(draw, door, side):
    """A lock case, perhaps with a face plate round its mouth and a hole that leads through it."""
    thickness = door["thickness_mm"]
    width = draw(mm(17.0, min(26.0, thickness - 6.0)))
    length, depth = draw(mm(100.0, 240.0)), draw(mm(40.0, 80.0))
    middle = draw(mm(400.0, door["height_mm"] - 400.0))
    case = {
        "kind": "lock_case",
        "id": "case",
        "side": side,
        "height_mm": middle,
        "width_mm": width,
        "length_mm": length,
        "depth_mm": depth,
    }
    features = [case | draw(_work(OBLONG, "mill_16", depth))]
    if draw(st.booleans()):
        features.append(draw(_plate(door, case)))
    if draw(st.booleans()):
        hole = {
            "kind": "handle_hole",
            "id": "hole",
            "side": draw(st.sampled_from(["front", "front", "front", "rear"])),
            "height_mm": middle,
            "backset_mm": 35.0 if side == "lock_edge" else round(door["width_mm"] - 35.0, 3),
            "diameter_mm": draw(mm(17.0, 50.0)),
            "from_both_sides": draw(st.booleans()),
            "lock_case": "case",
        }
        features.append(hole | draw(_work(["top_turn", "bottom_turn"], "mill_16", thickness)))
    return features


@st.composite
def _plate(draw, door, case):
    width = draw(mm(case["width_mm"] + 1.0, min(case["width_mm"] + 12.0, door["thickness_mm"] - 4.5)))
    # Square, half round, and the full half-turn.
    radius = draw(st.sampled_from([8.0, (8.0 + width / 2) / 2, width / 2]))
    depth = draw(mm(1.5, 6.0))
    round_end = 2 * radius >= width
    plate = {
        "kind": "face_plate",
        "id": "plate",
        "side": case["side"],
        "height_mm": case["height_mm"],
        "width_mm": width,
        "length_mm": draw(mm(case["length_mm"] + 15.0, case["length_mm"] + 80.0)),
        "depth_mm": depth,
        "corner_radius_mm": width / 2 if round_end else round(radius, 3),
        "lock_case": "case",
    }
    return plate | draw(_work(OBLONG if round_end else RECT, "mill_16", depth))


@st.composite
def _features(draw, door):
    """Hinges, with or without a lock in the other edge; or a lock in the hinge edge alone."""
    content = draw(st.sampled_from(["hinges", "both", "both", "lock_edge", "hinge_edge"]))
    if content in ("lock_edge", "hinge_edge"):
        return draw(_lock(door, content))
    return draw(_hinges(door)) + (draw(_lock(door, "lock_edge")) if content == "both" else [])


def _document(door):
    """A recipe but for its features; the density is 200 kg/m^3, less where 125 kg would be exceeded."""
    volume = door["height_mm"] * door["width_mm"] * door["thickness_mm"]
    return {
        "schema": "doormill/recipe/1",
        "door_id": "random",
        "bar_code": "1",
        "hinge_side": "right",
        "material": "softwood",
        "mass_kg": round(min(125.0, 2e-7 * volume), 3),
        **door,
        "tools": {
            name: {"diameter_mm": d, "flutes": 2, "cutting_length_mm": cut, "max_spindle_speed_rpm": 18000}
            for name, (d, cut) in TOOLS.items()
        },
    }


@st.composite
def _sizes(draw):
    return {
        "height_mm": draw(whole_range(1000.0, 3000.0)),
        "width_mm": draw(whole_range(190.0, 1350.0)),
        "thickness_mm": draw(whole_range(30.0, 100.0)),
    }


@st.composite
def _placements(draw):
    edge = st.one_of(st.sampled_from([-1.0, 0.0, 1.0]), st.floats(-1.0, 1.0))
    return 0.010 * draw(edge), 0.010 * draw(edge), math.radians(2.0) * draw(edge)


@st.composite
def doors(draw):
    """A recipe document and a placement (y, z [m], rotation [rad])."""
    door = draw(_sizes())
    document = {**_document(door), "features": draw(_features(door))}
    return document, draw(_placements())


@st.composite
def thesis_doors(draw):
    """Any door that the thesis' Path_20 can mill, and a placement; see `doors`."""
    door = draw(_sizes())
    features = []
    for k in range(2):
        width, depth = draw(mm(20.5, 38.0)), draw(mm(1.0, 12.0))
        length = draw(mm(width + 2.0, 220.0))
        low = door["height_mm"] / 2 * k + length / 2 + 5
        hinge = {
            "kind": "hinge_oblong",
            "id": f"hinge_{k + 1}",
            "side": "front",
            "height_mm": draw(mm(low, low + door["height_mm"] / 2 - length - 10)),
            "backset_mm": draw(mm(width / 2 + 2.5, width / 2 + 25.0)),
            "width_mm": width,
            "length_mm": length,
            "depth_mm": depth,
            "points": 6,
        }
        hinge |= draw(_work(OBLONG, "mill_19", depth))
        features.append(hinge | {"passes": {"depth_step_mm": depth}, "direction": "climb"})
    document = {**_document(door), "program": "path_20", "features": features}
    document["tools"]["mill_19"] |= {"centre_cutting": True}  # Path_20 goes straight down
    return document, draw(_placements())


def door_with(kind, height, width, thickness, centre_cutting=False):
    """A door of a given size with one feature of a kind, under the forces of table 4.8 all round."""
    features = {
        "hinge_oblong": {"backset_mm": 25, "width_mm": 30, "length_mm": 120, "depth_mm": 5, "points": 6},
        "hinge_leaf": {
            "backset_mm": 25,
            "width_mm": 30,
            "length_mm": 100,
            "depth_mm": 5,
            "corner_radius_mm": 10,
        },
        "lock_case": {"width_mm": 18, "length_mm": 160, "depth_mm": 60},
        "face_plate": {"width_mm": 24, "length_mm": 220, "depth_mm": 3, "corner_radius_mm": 9},
        "handle_hole": {"backset_mm": 50, "diameter_mm": 22},
    }
    side = "lock_edge" if kind in ("lock_case", "face_plate") else "front"
    work = {
        "tool": "mill_16",
        "cutting": {"spindle_speed_rpm": 6000, "feed_mm_s": 50},
        "passes": {"depth_step_mm": 30},
        "wrench_n_nm": {"default": [-209, 29, 12, -5, -43, 3], "plunge": [0, 0, -30, 0, 0, 0]},
        "wrench_point_mm": 208,
        "forces": KNOWN,
    }
    document = _document({"height_mm": height, "width_mm": width, "thickness_mm": thickness})
    document["tools"]["mill_16"] |= {"centre_cutting": centre_cutting}
    feature = {"kind": kind, "id": kind, "side": side, "height_mm": 500}
    return Recipe.from_document({**document, "features": [feature | features[kind] | work]})
