import json

import numpy as np
import pytest

from doormill_ros.tools.workspace import main

PNG = b"\x89PNG\r\n\x1a\n"


def test_everything_is_written(tmp_path, capsys):
    assert main(["--out", str(tmp_path), "--step", "0.1", "--clamp-height", "800"]) == 0
    document = json.loads((tmp_path / "workspace.json").read_text(encoding="utf-8"))
    assert document["schema"] == "doormill/workspace/1"
    assert document["robot"] == "irb6600_175_255"
    assert document["region"]["travel"] == pytest.approx([0.1, 0.58, 2.7])
    # Table 4.5: the base stands level with the lowest hinge, 150 mm above a door clamped at 800 mm.
    assert document["region"]["thesis"]["pedestal_height"] == pytest.approx(0.95)
    for objective in ("conditioning", "stiffness"):
        best = document["region"][f"best_{objective}"]
        assert best["refusal"] == ""
        assert best["pedestal_height"] == pytest.approx(0.95 + best["base_above_lowest_hinge"])
    pictures = sorted(path.name for path in tmp_path.glob("*.png"))
    assert len(pictures) == 9
    assert all((tmp_path / name).read_bytes().startswith(PNG) for name in pictures)
    with np.load(tmp_path / "maps.npz") as data:
        assert data["nu_p"].max() == pytest.approx(document["maps"]["maps"]["nu_p_max"])
        assert data["joint2_deg"][0] == pytest.approx(-65)
    assert "pedestal" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--robot", "irb1"], "no robot 'irb1'"),
        (["--step", "-1"], "grid step"),
        (["--width", "500", "200"], "door width"),
        (["--width", "190", "1e6"], "largest <= 10 m"),
        (["--height", "nan"], "doors are up to nan m high"),
        (["--clamp-height", "nan"], "--clamp-height is nan mm"),
        (["--clamp-height", "1e9"], "--clamp-height is 1e+09 mm, allowed are -10000 to 10000"),
    ],
)
def test_bad_input_is_one_line_and_status_2(tmp_path, capsys, arguments, says):
    assert main(["--out", str(tmp_path / "out"), *arguments]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert len(error.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("place", "why"), [("", "a file is in the way"), ("below", "Not a directory")])
def test_a_folder_that_cannot_be_made_is_one_line(tmp_path, capsys, place, why):
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    out = tmp_path / "file" / place
    assert main(["--out", str(out)]) == 2
    assert capsys.readouterr().err == f"workspace: {out} cannot be used, {why}; name another --out\n"
    assert (tmp_path / "file").read_text(encoding="utf-8") == "mine"
