"""With a picture of the empty clamp its jaws are no edges, its plates no doors, and doors are found as without."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.empty_clamp.clamp_lines import FaceInClamp
from doormill_ros.localization.empty_clamp.empty_clamp import empty_clamp_for
from doormill_ros.localization.errors import BadCameraFile, LocalizationError, NoDoor, WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.overlay import draw_refusal
from doormill_ros.localization.pictures.picture_file import write_picture
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from support.pictures.empty_clamps import CLAMPS, clamp_pictures, render_empty
from support.source_tree import ROOT

COUNT, SEED = 3, 40
GOOD = [name for name, kind in CLAMPS.items() if kind.fair]
PLATES = [name for name, kind in CLAMPS.items() if not kind.stands]
JAWS = [name for name in CLAMPS if "jaw" in name]


def find(picture, known, item, layout):
    """The pose, or the refusal."""
    try:
        return localize(picture, known, layout, item.scene.width, item.scene.thickness)
    except LocalizationError as refused:
        return refused


@pytest.fixture(scope="module")
def looked(layout, camera):
    """By kind: item, picture, camera, what is found without the picture of the empty clamp and with it."""
    table = {}
    for name in CLAMPS:
        # Most ordinary jaws are told without, too: more of them are drawn.
        for item in clamp_pictures(name, 2 * COUNT if name in JAWS else COUNT, SEED):
            known, picture = item.camera(), render_picture(item.scene, item.seed)
            both = [find(picture, one, item, layout) for one in (replace(known, empty=()), known)]
            table.setdefault(name, []).append((item, picture, known, *both))
    return table


@pytest.mark.parametrize("name", PLATES)
def test_a_plate_in_the_plane_of_the_face_is_no_door(name, looked):
    taken = [row for row in looked[name] if not isinstance(row[3], LocalizationError)]
    assert len(taken) >= 2
    for *_, refused in taken:
        assert isinstance(refused, NoDoor), refused
        assert refused.message.startswith("no door stands there: the picture is as of the empty clamp")
        assert [edge for edge, _ in refused.data["marks"]] == ["hinge", "bottom"]


def test_the_border_of_a_jaw_is_no_edge(looked):
    wrong = []
    for name in JAWS:
        for item, _, _, without, refused in looked[name]:
            if isinstance(without, LocalizationError):
                continue
            assert (
                np.hypot(without.offset.y - item.scene.offset.y, without.offset.z - item.scene.offset.z)
                > 1e-3
            )
            wrong.append(refused)
    assert len(wrong) >= COUNT
    for refused in wrong:
        assert isinstance(refused, WrongEdge)
        assert "is at the same place in the picture of the empty clamp" in refused.message
        ((edge, _),) = refused.data["marks"]
        assert refused.data["edge"] == edge
        assert f"the {edge} edge" in refused.message


@pytest.mark.parametrize("name", GOOD)
def test_a_door_is_found_as_without(name, looked):
    right = 0
    for item, _, _, without, found in looked[name]:
        if isinstance(without, LocalizationError):
            assert type(found) is type(without)
            continue
        off = np.hypot(without.offset.y - item.scene.offset.y, without.offset.z - item.scene.offset.z)
        if off > 1e-4:
            assert isinstance(found, LocalizationError)
            continue
        assert found.offset == without.offset
        np.testing.assert_array_equal(found.covariance, without.covariance)
        right += 1
    assert right >= COUNT - 1


def test_the_place_of_a_refusal_is_drawn(looked):
    _, picture, _, _, refused = looked[PLATES[1]][0]
    drawn, plain = draw_refusal(picture, refused), np.repeat(picture[..., None], 3, axis=2)
    middles = np.rint([pixels[4] for _, pixels in refused.data["marks"]]).astype(int)
    assert len(middles) == 2
    assert all((drawn[v, u] != plain[v, u]).any() for u, v in middles)


@pytest.mark.parametrize("level", [0.7, 1.3])
def test_other_light_does_not_make_a_door_of_a_plate(level, looked, layout):
    refused = []
    for item, picture, known, *_ in looked["no door, a plate with texture"]:
        light = replace(item.empty.light, level=level, gradient=(0.2, -0.2))
        empty = render_empty(replace(item.empty, light=light), item.seed)
        other = replace(known, empty=(replace(known.empty[0], picture=empty),))
        refused.append(find(picture, other, item, layout))
    assert [type(one) for one in refused] == COUNT * [NoDoor]


def test_the_pattern_of_an_empty_clamp_is_known_again_and_a_door_is_not_it(looked, layout):
    alike = {True: [], False: []}
    for name in ("no door, a plate with texture", "clean"):
        for item, picture, known, *_ in looked[name]:
            clamp, true = known.empty[0], item.scene.offset
            pose = np.array([true.y, true.z, true.rotation])
            view = face_view(known, layout, item.scene.width, item.scene.thickness)
            face = FaceInClamp(picture, view, clamp, view, pose)
            alike[item.stands].append(face.likeness())
    assert min(alike[False]) > 0.8
    assert max(alike[True]) < 0.3


def test_a_part_of_the_sensor_is_compared_with_that_part(looked, layout):
    left, top, width, height = 140, 60, 1600, 960
    refused = []
    for item, picture, known, *_ in looked["no door, a plate with texture"]:
        k = known.k - np.array([[0, 0, left], [0, 0, top], [0, 0, 0]])
        part = np.ascontiguousarray(picture[top : top + height, left : left + width])
        sent = known.with_intrinsics(k, known.distortion, (width, height))
        refused.append(find(part, sent, item, layout))
    assert [type(one) for one in refused] == COUNT * [NoDoor]


def test_pictures_of_another_width_are_not_compared(looked, layout):
    item, picture, known, without, _ = looked["no door, a plate with texture"][0]
    other = replace(known, empty=(replace(known.empty[0], width=item.scene.width + 1e-3),))
    assert empty_clamp_for(other.empty, item.scene.width) is None
    assert find(picture, other, item, layout).offset == without.offset


def camera_file(folder, entries):
    path = folder / "camera.yaml"
    document = yaml.safe_load((ROOT / "config" / "camera.yaml").read_text(encoding="utf-8"))
    path.write_text(yaml.safe_dump(document | {"empty_clamp": entries}), encoding="utf-8")
    return path


def test_a_camera_file_names_pictures_from_its_own_folder(tmp_path, looked):
    (known,) = (row[2] for row in looked["clean"][:1])
    write_picture(np.repeat(known.empty[0].picture[..., None], 3, axis=2), tmp_path / "empty.png")
    found = load_camera(camera_file(tmp_path, [{"width": 0.826, "picture": "empty.png"}]))
    (clamp,) = found.empty
    assert clamp.width == 0.826
    np.testing.assert_array_equal(clamp.picture, known.empty[0].picture)
    assert load_camera().empty == ()


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"width": 0.8, "picture": "none.png"}, "empty_clamp.0: "),
        ({"width": 0.8, "picture": "small.png"}, "has 64 x 48 px, allowed are the camera's 1920 x 1080"),
        ({"width": -1.0, "picture": "small.png"}, "empty_clamp.0.width is -1.0"),
        ({"width": 0.8, "file": "small.png"}, "file is unknown"),
    ],
)
def test_an_entry_that_is_of_no_use_is_told(entry, said, tmp_path):
    write_picture(np.zeros((48, 64, 3), np.uint8), tmp_path / "small.png")
    with pytest.raises(BadCameraFile, match=r"camera\.yaml") as refused:
        load_camera(camera_file(tmp_path, [entry]))
    assert said in refused.value.message
