"""Random valid recipe documents over the whole range of doors, for hypothesis."""

import math

from hypothesis import strategies as st

GRID = 6
NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.\-]{0,20}", fullmatch=True)
BAR_CODES = st.text(st.characters(min_codepoint=0x21, max_codepoint=0x7E), min_size=1, max_size=30)
AUTHORS = st.text(
    st.characters(codec="utf-8", exclude_categories=("Cc", "Cs", "Cn", "Co", "Cf", "Zl", "Zp")), max_size=30
)


@st.composite
def numbers(draw, low, high):
    """A number on the recipe's grid between two limits."""
    step = 10.0**-GRID
    low, high = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
    nice = [value for value in (round(low / 1e6) * 10**6, (low + high) // 2) if low <= value <= high]
    return round(draw(st.one_of(st.integers(low, high), st.sampled_from([low, high, *nice]))) * step, GRID)


@st.composite
def _work(draw, segments, tool, depth):
    if draw(st.booleans()):
        cutting = {"spindle_speed_rpm": draw(numbers(1000, 18000)), "feed_mm_s": draw(numbers(5, 80))}
    else:
        cutting = {
            "surface_speed_m_min": draw(numbers(20, math.pi * tool["diameter_mm"] * 17.0)),
            "chip_load_mm": draw(numbers(0.01, 0.5)),
        }
    if draw(st.booleans()):
        cutting["plunge_feed_mm_s"] = draw(numbers(1, 50))
    named = draw(st.lists(st.sampled_from(segments), unique=True))
    row = st.lists(numbers(-300, 300), min_size=6, max_size=6)
    return {
        "cutting": cutting,
        "passes": {
            "depth_step_mm": draw(numbers(0.5, max(0.5, min(depth, 100.0)))),
            "finish_allowance_mm": draw(st.sampled_from([0.0, 0.2, 0.5])),
        },
        "direction": draw(st.sampled_from(["climb", "conventional"])),
        "wrench_n_nm": {**{name: draw(row) for name in named}, "default": draw(row)},
        "wrench_point_mm": draw(numbers(0, 300)),
    }


@st.composite
def tools(draw, widest):
    diameter = draw(numbers(2, min(widest, 25.0)))
    tool = {
        "diameter_mm": diameter,
        "flutes": draw(st.integers(1, 4)),
        "cutting_length_mm": 200.0,
        "max_spindle_speed_rpm": 18000.0,
    }
    if draw(st.booleans()):
        tool["max_chip_load_mm"] = 5.0
    return tool


@st.composite
def _hinges(draw, door, used):
    count = draw(st.integers(1, 4))
    slot = door["height_mm"] / count
    half = door["width_mm"] / 2.0
    features = []
    for index in range(count):
        width = draw(numbers(8, min(100.0, half - 10.0)))
        length = draw(numbers(width, min(500.0, slot - 10.0)))
        oblong = draw(st.booleans())
        radius = draw(numbers(3, width / 2.0))
        tool = draw(tools(width - 1.0 if oblong or 2 * radius > width - 1e-5 else 2.0 * radius))
        if not oblong and 2 * radius > width - 1.0:
            tool["diameter_mm"] = min(tool["diameter_mm"], width - 1.0)
        name = f"tool_{len(used)}"
        used[name] = tool
        depth = draw(numbers(0.5, min(60.0, door["thickness_mm"] - 3.0)))
        feature = {
            "kind": "hinge_oblong" if oblong else "hinge_leaf",
            "id": f"hinge_{index}",
            "side": draw(st.sampled_from(["front", "rear"])),
            "height_mm": round(
                draw(numbers(slot * index + length / 2 + 3, slot * (index + 1) - length / 2 - 3)), GRID
            ),
            "backset_mm": draw(numbers(width / 2.0 + 2.0, half - width / 2.0 - 4.0)),
            "width_mm": width,
            "length_mm": length,
            "depth_mm": depth,
            "tool": name,
            **draw(_work(["left_line"] if length > width + 1 else ["plunge"], tool, depth)),
        }
        if oblong:
            points = draw(st.sampled_from([6, 9]))
            feature["points"] = points
            if draw(st.booleans()):
                pair = st.lists(numbers(-5, 5), min_size=2, max_size=2)
                feature["force_displacement_mm"] = draw(st.lists(pair, min_size=points, max_size=points))
        else:
            feature["corner_radius_mm"] = radius
        if draw(st.booleans()):
            feature["height_from"] = "top"
            feature["height_mm"] = round(door["height_mm"] - feature["height_mm"], GRID)
        features.append(feature)
    return features


@st.composite
def _lock(draw, door, used):
    thickness, half = door["thickness_mm"], door["width_mm"] / 2.0
    width = draw(numbers(8, min(60.0, thickness - 8.0)))
    length = draw(numbers(max(width, 80.0), 300.0))
    depth = draw(numbers(45, min(150.0, half - 4.0)))
    middle = draw(numbers(250, door["height_mm"] - 250.0))
    case_tool = draw(tools(width - 1.0))
    used["case_tool"] = case_tool
    features = [
        {
            "kind": "lock_case",
            "id": "case",
            "side": "lock_edge",
            "height_mm": middle,
            "width_mm": width,
            "length_mm": length,
            "depth_mm": depth,
            "tool": "case_tool",
            **draw(_work(["top_turn", "bottom_turn", "plunge"], case_tool, depth)),
        }
    ]
    plate_depth = 0.0
    if draw(st.booleans()):
        plate_depth = draw(numbers(0.5, 6))
        plate_width = draw(numbers(width + 1.0, thickness - 4.0))
        radius = draw(numbers(1.5, plate_width / 2 - 0.6))
        used["plate_tool"] = draw(tools(2.0 * radius))
        features.append(
            {
                "kind": "face_plate",
                "id": "plate",
                "side": "lock_edge",
                "height_mm": middle,
                "width_mm": plate_width,
                "length_mm": draw(numbers(length + plate_width, 400.0)),
                "depth_mm": plate_depth,
                "corner_radius_mm": radius,
                "lock_case": "case",
                "tool": "plate_tool",
                **draw(_work(["left_line", "top_line"], used["plate_tool"], plate_depth)),
            }
        )
    for index in range(draw(st.integers(0, 2))):
        radius = draw(numbers(4, 15))
        backset = draw(numbers(radius + 3.0 + plate_depth, min(depth, half - radius - 3.0)))
        name = f"hole_tool_{index}"
        used[name] = draw(tools(2.0 * radius - 1.0))
        features.append(
            {
                "kind": "handle_hole",
                "id": f"hole_{index}",
                "side": draw(st.sampled_from(["front", "rear"])),
                "height_mm": round(middle + (-1) ** index * 20.0, GRID),
                "backset_mm": backset,
                "diameter_mm": round(2.0 * radius, GRID),
                "from_both_sides": draw(st.booleans()),
                "lock_case": "case",
                "tool": name,
                **draw(_work(["top_turn", "bottom_turn"], used[name], thickness)),
            }
        )
    return features


@st.composite
def documents(draw, door_id=None):
    """A document that a recipe must accept."""
    document = {
        "schema": "doormill/recipe/1",
        "door_id": door_id or draw(NAMES),
        "bar_code": draw(BAR_CODES),
        "version": draw(st.integers(0, 1000)),
        "author": draw(AUTHORS),
        "height_mm": draw(numbers(1000, 3000)),
        "width_mm": draw(numbers(190, 1350)),
        "thickness_mm": draw(numbers(30, 100)),
        "hinge_side": draw(st.sampled_from(["left", "right"])),
        "material": draw(st.sampled_from(["softwood", "hardwood", "plywood", "chipboard", "mdf"])),
        "placement": {"y_mm": draw(numbers(-10, 10)), "rotation_deg": draw(numbers(-2, 2))},
    }
    volume = document["height_mm"] * document["width_mm"] * document["thickness_mm"] * 1e-9
    document["mass_kg"] = draw(numbers(max(0.5, 70 * volume), min(125.0, 1300 * volume)))
    if draw(st.booleans()):
        document["created"] = draw(st.datetimes()).isoformat() + "+00:00"
    used = {}
    features = draw(_hinges(document, used))
    if draw(st.booleans()):
        features += draw(_lock(document, used))
    return {**document, "tools": used, "features": features}


@st.composite
def thesis_documents(draw):
    """A document that the thesis' text table can hold."""
    document = draw(documents())
    hinges = [f for f in document["features"] if f["kind"] == "hinge_oblong"][:1]
    if not hinges:
        document["features"] = [{**document["features"][0], "kind": "hinge_oblong"}]
        document["features"][0].pop("corner_radius_mm", None)
        hinges = document["features"]
        tool = document["tools"][hinges[0]["tool"]]
        tool["diameter_mm"] = min(tool["diameter_mm"], hinges[0]["width_mm"] - 1.0)
    first = {**hinges[0], "id": "hinge_1", "side": "front"}
    if first.pop("height_from", "bottom") == "top":
        first["height_mm"] = round(document["height_mm"] - first["height_mm"], GRID)
    return {**document, "tools": {first["tool"]: document["tools"][first["tool"]]}, "features": [first]}
