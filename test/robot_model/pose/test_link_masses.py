"""Published masses of links: read from a file that says where they come from."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.robot_model.errors import LinkMassError
from doormill_ros.robot_model.pose.link_masses import FOLDER, published_masses, read_masses
from support.source_tree import ROOT


def test_the_ur10_weighs_what_its_maker_publishes() -> None:
    links = published_masses("ur10")
    assert sum(link.mass for link in links) == pytest.approx(7.1 + 12.7 + 4.27 + 2.0 + 2.0 + 0.365)
    np.testing.assert_array_equal(links[1].com, [0.38, 0.0, 0.158])


@pytest.mark.parametrize("robot", ["irb6600_175_255", "../robots/ur10", ""])
def test_of_another_robot_nothing_is_known(robot: str) -> None:
    assert published_masses(robot) == ()


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("mass: 12.7", "mass: -1", "links.1.mass is -1"),
        ("0.38, 0.0, 0.158", "0.38, 0.158", "links.1.com is"),
        ("  - {mass: 0.365, com: [0.0, 0.0, -0.026]}\n", "", "links has 5 entries"),
        ("link-masses/1", "link-masses/7", "schema is"),
    ],
)
def test_a_file_that_is_wrong_is_told(tmp_path, old, new, complaint) -> None:
    text = (ROOT / FOLDER / "ur10.yaml").read_text(encoding="utf-8")
    assert text.count(old) == 1
    path = tmp_path / "spoilt.yaml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(LinkMassError) as caught:
        read_masses(path)
    assert caught.value.message.startswith(f"{path}: {complaint}")
