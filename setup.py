from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "doormill_ros"
NODES = [
    "door_localizer",
    "recipe_database",
    "path_generator",
    "abb_bridge",
    "bag_recorder",
    "model_monitor",
    "operator_page",
    "cell_simulator",
    "folder_camera",
    "gige_camera",
    "door_sensors",
    "door_shares",
]
TOOLS = [
    "backup",
    "calibrate",
    "cell",
    "health",
    "replay",
    "catalogue",
    "recipes",
    "restore",
    "identify",
    "diagnose",
    "locate",
    "workspace",
    "report",
    "thesis",
]


def share(*folders, scripts=True):
    """Every file below the folders, with or without Python, grouped by the share directory it is installed to."""
    groups = {}
    for folder in folders:
        for path in sorted(Path(folder).rglob("*")):
            if path.suffix == ".py" and not scripts:
                continue
            if path.is_file() and "__pycache__" not in path.parts:
                groups.setdefault(f"share/{PACKAGE}/{path.parent}", []).append(str(path))
    return sorted(groups.items())


setup(
    name=PACKAGE,
    version="0.1.0",
    packages=find_packages(include=[PACKAGE, f"{PACKAGE}.*"]),
    package_data={
        PACKAGE: [
            "py.typed",
            "**/*.lark",
            "**/*.html",
            "**/*.j2",
            "**/*.css",
            "**/*.js",
            "**/*.json",
            "**/*.svg",
            "**/*.ini",
            "**/*.mako",
        ]
    },
    include_package_data=False,
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        *share("config", "launch", "rapid"),
        *share("bags", scripts=False),
    ],
    zip_safe=True,
    maintainer="doormill_ros developers",
    maintainer_email="doormill@example.org",
    description="Mills hinges, lock cases and handle holes into doors with an ABB robot.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            *[f"{name} = {PACKAGE}.nodes.process.executable:{name}" for name in NODES],
            *[f"{name} = {PACKAGE}.tools.{name}:main" for name in TOOLS],
        ]
    },
)
