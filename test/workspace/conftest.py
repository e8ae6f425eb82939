import pytest

from doormill_ros.robot.description import load_robot


@pytest.fixture(scope="session")
def irb6600():
    return load_robot("irb6600_175_255")


@pytest.fixture(scope="session")
def irb6700():
    return load_robot("irb6700_235_265")
